// Moments of inertia about the centre, handout §3.1; extents of shapes.
//   plane   I = m K / A               A  content,  K = int |r - c|^2 dA
//   space   I = m (tr C - C) / V      V  content,  C = int (r - c)(r - c)' dV; its eigenvectors are the
//                                     principal axes
// with K and C of each form in its own file.

#include "sim/shape/shape.h"

#include <algorithm>
#include <cmath>

#include "sim/shape/form_concept.h"

namespace obscura::sim {

static_assert(all_forms_answer<2>() && all_forms_answer<3>(), "a form leaves out an answer");

// Jacobi's rotations: turns a symmetric matrix into a diagonal one, smallest turns first to last, so that
// axes stay as near to those of the frame as they can. The axes it finds, as a turn.
Orientation<3> principal_axes(Eigen::Matrix3d& a) {
  Orientation<3> turn = no_rotation<3>();
  for (int sweep = 0; sweep < 50; ++sweep) {
    // off-diagonal entries of the size of rounding count as zero: a shape whose axes are its frame's keeps
    // them
    const double small = 1e-14 * a.trace();
    bool done = true;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (std::fabs(a(p, q)) <= small) continue;
        done = false;
        const double tau = (a(q, q) - a(p, p)) / (2 * a(p, q));
        const double t = (tau < 0 ? -1 : 1) / (std::fabs(tau) + std::sqrt(1 + tau * tau));
        const double c = 1 / std::sqrt(1 + t * t), s = t * c;
        Eigen::Matrix3d j = Eigen::Matrix3d::Identity();
        j(p, p) = c, j(q, q) = c, j(p, q) = s, j(q, p) = -s;
        a = (j.transpose() * a * j).eval();
        // the same as a quaternion about the third axis: half the angle from its cosine
        const int axis = 3 - p - q;
        const double half_cos = std::sqrt(0.5 * (1 + c)), half_sin = s / (2 * half_cos);
        Orientation<3> by = Orientation<3>::Zero();
        by[axis] = axis == 1 ? half_sin : -half_sin, by[3] = half_cos;
        turn = product(turn, by);
      }
    }
    if (done) break;
  }
  return turn / std::sqrt(turn.squaredNorm());
}

template <int D>
MassProperties<D> mass_properties(const Shape<D>& shape) {
  Spread<D> whole = of_form(shape, [](const auto& form) { return form.spread(); });
  MassProperties<D> out;
  out.content = whole.content, out.center = whole.center;
  if constexpr (D == 2) {
    out.second[0] = whole.second(0);
  } else {
    out.axes = principal_axes(whole.second);
    const Vec3 c = whole.second.diagonal();
    out.second = Vec3(c[1] + c[2], c[2] + c[0], c[0] + c[1]);
  }
  return out;
}

template <int D>
AngularVec<D> solid_inertia(const Shape<D>& shape, double mass) {
  // the handout's own words for a box, to the bit
  if (const Box<D>* box = form<Box<D>>(shape)) {
    const Vec<D> side = 2 * box->half;
    AngularVec<D> moments;
    for (int axis = 0; axis < kAngular<D>; ++axis) {
      const double x = side[(axis + 1) % D], y = side[(axis + 2) % D];
      moments[axis] =
          D == 2 ? mass * (side[0] * side[0] + side[1] * side[1]) / 12 : mass * (x * x + y * y) / 12;
    }
    return moments;
  }
  if (const Ball<D>* ball = form<Ball<D>>(shape)) {
    return AngularVec<D>::Constant(D == 2 ? mass * ball->radius * ball->radius / 2
                                          : 2 * mass * ball->radius * ball->radius / 5);
  }
  const MassProperties<D> whole = mass_properties(shape);
  return whole.content > 0 ? AngularVec<D>(mass * whole.second / whole.content) : AngularVec<D>::Zero();
}

template <int D>
AngularVec<D> inertia(const Shape<D>& shape, double mass) {
  return round_radius(shape) ? AngularVec<D>::Zero() : solid_inertia(shape, mass);
}

template <int D>
Shape<D> seated(const Shape<D>& shape, const MassProperties<D>& bulk) {
  const bool turns = bulk.axes != no_rotation<D>();
  const Rotation<D> back = turns ? Rotation<D>(rotation<D>(bulk.axes).transpose()) : Rotation<D>::Identity();
  const auto seen = [&](const Vec<D>& place) {
    const Vec<D> off = place - bulk.center;
    return turns ? Vec<D>(back * off) : off;
  };
  return moved<D>(shape, seen, turns ? inverse<D>(bulk.axes) : no_rotation<D>());
}

template <int D>
std::vector<SupportVertex<D>> support_vertices(const Shape<D>& shape) {
  std::vector<SupportVertex<D>> all;
  of_form(shape, [&](const auto& form) { form.add_support_vertices(all); });
  return all;
}

template <int D>
int SupportVertices<D>::most() const {
  int most = 0;
  for (std::size_t i = 1; i < first_.size(); ++i) most = std::max(most, first_[i] - first_[i - 1]);
  return most;
}

template <int D>
double half_thickness(const Shape<D>& shape) {
  return of_form(shape, [](const auto& form) { return form.half_thickness(); });
}

template <int D>
double bounding_radius(const Shape<D>& shape) {
  return of_form(shape, [](const auto& form) { return form.bounding_radius(); });
}

template <int D>
Bounds<D> bounds(const Shape<D>& shape, const BodyMotion<D>& at) {
  return of_form(shape, [&](const auto& form) { return form.bounds(at.x, at.room_from_body); });
}

template MassProperties<2> mass_properties<2>(const Shape<2>&);
template AngularVec<2> solid_inertia<2>(const Shape<2>&, double);
template AngularVec<2> inertia<2>(const Shape<2>&, double);
template Shape<2> seated<2>(const Shape<2>&, const MassProperties<2>&);
template std::vector<SupportVertex<2>> support_vertices<2>(const Shape<2>&);
template class SupportVertices<2>;
template double half_thickness<2>(const Shape<2>&);
template double bounding_radius<2>(const Shape<2>&);
template Bounds<2> bounds<2>(const Shape<2>&, const BodyMotion<2>&);
template MassProperties<3> mass_properties<3>(const Shape<3>&);
template AngularVec<3> solid_inertia<3>(const Shape<3>&, double);
template AngularVec<3> inertia<3>(const Shape<3>&, double);
template Shape<3> seated<3>(const Shape<3>&, const MassProperties<3>&);
template std::vector<SupportVertex<3>> support_vertices<3>(const Shape<3>&);
template class SupportVertices<3>;
template double half_thickness<3>(const Shape<3>&);
template double bounding_radius<3>(const Shape<3>&);
template Bounds<3> bounds<3>(const Shape<3>&, const BodyMotion<3>&);

}  // namespace obscura::sim
