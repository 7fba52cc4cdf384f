// The touches of an island at rest, J their rows (normal, then tangent), M of the bodies:
//   K f + b = w,   K = J M^-1 J',   b = J g        f in the cones, w obeys their laws (sim/cone_law.h)
//   a = g + M^-1 J' f = 0                          is what rest is

#include "sim/iterative_statics.h"

#include <cmath>

#include "sim/gap.h"

namespace obscura::sim::sweep {

namespace {

constexpr double kStatic = 1e-9;  // of g

}  // namespace

Statics::Statics(const Model<2>& model) : model_(model), columns_(model.bodies.size(), -1) {
  cone_.thorough = false;
}

bool Statics::hold(State<2>& state, const std::vector<Touch>& touches, const std::vector<char>& free) {
  const int rows = 2 * int(touches.size());
  const double g = std::sqrt(model_.gravity.squaredNorm());
  if (touches.empty() || int(touches.size()) > kMost || g == 0) return false;
  bodies_.clear();
  for (const Touch& touch : touches) {
    const ContactKey& key = state.contacts[touch.contact].key;
    for (const int body : {key.a, key.b}) {
      if (body < 0 || !free[body] || columns_[body] >= 0) continue;
      columns_[body] = int(bodies_.size());
      bodies_.push_back(body);
    }
  }

  // J M^-1/2, two sides a row, and sqrt(M) g
  const auto light = [&](int body) { return 1 / std::sqrt(model_.bodies[body].mass); };
  const auto swing = [&](int body) {
    return model_.bodies[body].turns() ? 1 / std::sqrt(model_.bodies[body].inertia[0]) : 0;
  };
  rows_.assign(std::size_t(rows), {});
  a_.assign(bodies_.size(), Vec3::Zero());
  for (const int body : bodies_) a_[columns_[body]].head<2>() = model_.gravity / light(body);
  blocks_.clear();
  modes_.assign(touches.size(), {});
  f_.resize(rows);
  for (int i = 0; i < int(touches.size()); ++i) {
    const Contact<2>& contact = state.contacts[touches[i].contact];
    const Vec<2> axes[2] = {contact.normal, perpendicular<2>(contact.normal)};
    for (int k = 0; k < 2; ++k) {
      f_[2 * i + k] = contact.force.dot(axes[k]);
      for (const int sign : {1, -1}) {
        const int body = sign > 0 ? contact.key.a : contact.key.b;
        if (body < 0 || !free[body]) continue;
        Side& side = rows_[2 * i + k][sign > 0 ? 0 : 1];
        side.column = columns_[body];
        side.push.head<2>() = sign * light(body) * axes[k];
        side.push[2] = sign * swing(body) * moment<2>(contact.point - state.x[body], axes[k])[0];
      }
    }
    ConeBlock<2> block;
    block.mu = touches[i].friction;
    blocks_.push_back(block);
  }
  K_.resize(rows, rows), b_.resize(rows);
  for (int i = 0; i < rows; ++i) {
    b_[i] = 0;
    for (const Side& side : rows_[i]) b_[i] += side.column < 0 ? 0 : side.push.dot(a_[side.column]);
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (const Side& one : rows_[i]) {
        for (const Side& other : rows_[j]) {
          if (one.column >= 0 && one.column == other.column) sum += one.push.dot(other.push);
        }
      }
      K_(i, j) = K_(j, i) = sum;
    }
  }
  bool held = cone_.solve(K_, b_, blocks_, modes_, f_).found;
  for (int i = 0; i < rows; ++i) {
    for (const Side& side : rows_[i]) {
      if (side.column >= 0) a_[side.column] += f_[i] * side.push;
    }
  }
  for (const int body : bodies_) {
    const Vec3& a = a_[columns_[body]];
    const double rim = swing(body) * reach(model_.bodies[body].shape);
    held = held && light(body) * std::sqrt(a.head<2>().squaredNorm()) + rim * std::fabs(a[2]) <= kStatic * g;
    columns_[body] = -1;
  }
  if (!held) return false;
  for (int i = 0; i < int(touches.size()); ++i) {
    Contact<2>& contact = state.contacts[touches[i].contact];
    contact.force = f_[2 * i] * contact.normal + f_[2 * i + 1] * perpendicular<2>(contact.normal);
    contact.impulse.setZero();
    contact.touching = f_[2 * i] <= 0 ? Touching::open : Touching::stick;
  }
  return true;
}

}  // namespace obscura::sim::sweep
