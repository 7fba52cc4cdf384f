#include "sim/force/close_passages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "sim/force/formula.h"
#include "sim/math/lanes.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kSlightChange = 1e-6;  // of a velocity in a step

constexpr double kFar2 = PassageLimits::kFar * PassageLimits::kFar;

// Negative where two points at r^2 = `r2` with the relative speed v^2 = `v2` and the relative acceleration A
// / r^n pass each other closely: h/tau > kFar. `far`: r^(2 n + 2). By signs, so that many pairs go side by
// side.
OBSCURA_INLINE std::int64_t passes(double r2, double v2, double A, double far, double h) {
  const double h2 = h * h, pull2 = A * h2 * (A * h2), way2 = v2 * h2;
  const auto sign = [](double x) { return std::bit_cast<std::int64_t>(x); };
  // a h^2 / r is the square of the ratio, and so is v^2 h^2 / r^2
  return sign(kFar2 * kFar2 * far - pull2) |
         (sign(kFar2 * r2 - way2) & sign(kSlightChange * kSlightChange * way2 * far - pull2 * r2));
}

// their h/tau, or 0
double passage_ratio(double r2, double v2, double A, int twice_n, double h) {
  const double steep = std::max(1.0, 0.25 * twice_n);  // e
  A *= steep, v2 *= steep * steep;
  double far = twice_n % 2 == 0 ? 1 : std::sqrt(r2);
  for (int i = 0; i < twice_n / 2 + 1; ++i) far *= r2;
  if (passes(r2, v2, A, far, h) >= 0) return 0;
  const double h2 = h * h, pull2 = A * h2 * (A * h2), way2 = v2 * h2;
  const double pull = pull2 > kFar2 * kFar2 * far ? std::sqrt(pull2 / far) : 0;
  const double way = pull2 * r2 > kSlightChange * kSlightChange * way2 * far ? way2 / r2 : 0;
  return std::sqrt(std::max(pull, way));
}

// how points i and j of a group meet; `rows` of n: x, v, weight and inverse mass
struct Meeting {
  double r2, v2, A;
};
template <int D>
OBSCURA_INLINE Meeting meeting(std::size_t n, std::size_t i, std::size_t j, const double* rows,
                               double strength, double softening2) {
  Meeting it{softening2, 0, 0};
  for (std::size_t k = 0; k < std::size_t(D); ++k) {
    const double d = rows[k * n + j] - rows[k * n + i], u = rows[(D + k) * n + j] - rows[(D + k) * n + i];
    it.r2 += d * d, it.v2 += u * u;
  }
  const double *const weights = rows + 2 * D * n, *const inverses = weights + n;
  it.A = strength * weights[i] * weights[j] * (inverses[i] + inverses[j]);
  return it;
}

// whether point i of a group passes one of those behind it closely, where forces fall as 1/r^2
template <int D>
bool any_near(std::size_t n, std::size_t i, const double* __restrict rows, double strength, double softening2,
              double h) {
  std::int64_t near = 0;
  for (std::size_t j = i + 1; j < n; ++j) {
    const Meeting it = meeting<D>(n, i, j, rows, strength, softening2);
    near |= passes(it.r2, it.v2, it.A, it.r2 * it.r2 * it.r2, h);
  }
  return near < 0;
}

// A force of a formula as |f| = A / r^n near its centre, or between two: by its values at two small
// distances. None where it does not grow at least as 1 / sqrt(r).
struct PowerLaw {
  double strength;
  int twice_n;
};
template <int D>
std::optional<PowerLaw> power_law(const Force<D>& force, const Subject<D>& a, const Subject<D>& b,
                                  double scale) {
  constexpr double kDirection[2][3] = {{0.6, 0.8, 0}, {0.48, 0.6, 0.64}};
  constexpr int kApart = 10;     // the distances differ by 2^10
  constexpr int kSteepest = 40;  // 2n
  const bool each = force.on == Force<D>::On::each;
  Evaluation evaluation(force.formula->force);
  std::array<double, std::size_t(each_slot::end)> uniform{};
  evaluation.begin(uniform);
  std::array<std::array<double, 2>, 16> values{};
  std::array<const double*, 16> inputs;
  const double r[2] = {std::ldexp(scale, -kApart), std::ldexp(scale, -2 * kApart)};
  for (std::size_t slot = 0; slot < values.size(); ++slot) inputs[slot] = values[slot].data();
  for (std::size_t k = 0; k < 2; ++k) {
    for (int axis = 0; axis < D; ++axis) values[std::size_t(axis)][k] = kDirection[D - 2][axis] * r[k];
    if (each) {
      values[each_slot::mass][k] = a.mass, values[each_slot::charge][k] = a.charge;
      values[each_slot::copy][k] = a.copy;
      values[each_slot::drag][k] = a.drag, values[each_slot::quadratic_drag][k] = a.quadratic_drag;
    } else {
      values[pair_slot::mass1][k] = a.mass, values[pair_slot::charge1][k] = a.charge;
      values[pair_slot::mass2][k] = b.mass, values[pair_slot::charge2][k] = b.charge;
    }
  }
  evaluation.run(2, inputs);
  double f[2] = {0, 0};
  for (std::size_t k = 0; k < 2; ++k) {
    for (int axis = 0; axis < D; ++axis) f[k] = std::max(f[k], std::fabs(evaluation.output(axis)[k]));
  }
  int exponent = 0;
  if (!(f[0] > 0 && f[1] < 1e300)) return {};
  // 2^(kApart n) is their ratio
  std::frexp(f[1] / f[0] * (1 + 1e-9), &exponent);
  const int twice_n = std::min((2 * (exponent - 1) + kApart / 2) / kApart, kSteepest);
  if (twice_n < 1) return {};
  double strength = f[0];
  for (int i = 0; i < twice_n / 2; ++i) strength *= r[0];
  return PowerLaw{twice_n % 2 == 0 ? strength : strength * std::sqrt(r[0]), twice_n};
}

}  // namespace

template <int D>
ClosePassages<D>::ClosePassages(const Model<D>& model)
    : model_(model), drives_(model), may_touch_(model), of_body_(model.bodies.size()) {
  for (const Body<D>& body : model.bodies) radius_.push_back(bounding_radius(body.shape));
  for (const Joint<D>& joint : model.joints) {
    if (joint.a.body >= 0 && joint.b.body >= 0 && joint.kind != JointKind::pulley &&
        joint.kind != JointKind::gear)
      joined_.push_back(std::minmax(joint.a.body, joint.b.body));
  }
  std::sort(joined_.begin(), joined_.end());
  using Kind = typename Force<D>::Law;
  for (const Force<D>& force : model.forces) {
    const double s2 = force.softening * force.softening, c = std::fabs(force.strength);
    if (force.law == Kind::gravitation || force.law == Kind::coulomb) {
      Group& group = groups_.emplace_back(Group{{}, {c, 4, s2}});
      for (const Subject<D>& it : force.subjects) {
        group.points.push_back(point(it));
        group.points.back().weight = force.law == Kind::gravitation ? it.mass : std::fabs(it.charge);
      }
    } else if (force.attractor()) {
      for (const Subject<D>& it : force.subjects) add(point(it), point(*force.center), {c * it.mass, 4, s2});
    } else if (force.law == Kind::formula) {
      add_formula(force);
    }
  }
}

template <int D>
void ClosePassages<D>::add(Point a, Point b, const Law& law) {
  if ((a.inverse == 0 && b.inverse == 0) || a.body == b.body) return;
  if (b.body < 0) of_body_[std::size_t(a.body)].push_back(int(pairs_.size()));
  pairs_.push_back({a, b, law});
}

template <int D>
void ClosePassages<D>::add_formula(const Force<D>& force) {
  const std::vector<Subject<D>>& all = force.subjects;
  const auto near = [&](const Subject<D>& a, const Subject<D>& b) {
    return power_law(force, a, b, model_.scale);
  };
  if (force.on == Force<D>::On::between) {
    for (std::size_t k = 0; k + 1 < all.size(); k += 2) {
      if (const auto law = near(all[k], all[k + 1]))
        add(point(all[k]), point(all[k + 1]), {law->strength, law->twice_n, 0});
    }
  } else if (force.on == Force<D>::On::each) {
    for (std::size_t k = 0; force.center && k < all.size(); ++k) {
      if (const auto law = near(all[k], all[k]))
        add(point(all[k]), point(*force.center), {law->strength, law->twice_n, 0});
    }
  } else if (!all.empty()) {
    // among them the two that pull most
    Subject<D> most = all[0];
    for (const Subject<D>& it : all)
      most.mass = std::max(most.mass, it.mass), most.charge = std::max(most.charge, std::fabs(it.charge));
    const auto law = near(most, most);
    if (!law) return;
    Group& group = groups_.emplace_back(Group{{}, {law->strength, law->twice_n, 0}});
    for (const Subject<D>& it : all) group.points.push_back(point(it));
  }
}

template <int D>
typename ClosePassages<D>::Point ClosePassages<D>::point(const Subject<D>& subject) const {
  const bool yields = subject.body >= 0 && !model_.bodies[std::size_t(subject.body)].fixed;
  return {subject.body, subject.local, yields ? 1 / model_.bodies[std::size_t(subject.body)].mass : 0};
}

template <int D>
typename ClosePassages<D>::Place ClosePassages<D>::place(const State<D>& state, double t,
                                                         const Point& point) {
  if (point.body < 0) return {point.local, Vec<D>::Zero()};
  const int drive = drives_.number(point.body);
  if (drive < 0 && point.local.isZero(0))
    return {state.x[std::size_t(point.body)], state.v[std::size_t(point.body)]};
  const BodyMotion<D> at = drive < 0 ? body_motion(state, point.body) : drives_.at(drive, t).at;
  const Vec<D> arm = at.arm(point.local);
  return {at.x + arm, at.velocity(arm)};
}

// whether two bodies, or a body and a place, are no passage: they are about to touch, or hold each other
template <int D>
bool ClosePassages<D>::meet(int a, int b, double r2) const {
  constexpr double kNear = 1.5;  // of the sum of their radii
  if (a < 0 || b < 0) return false;
  if (a == b || std::binary_search(joined_.begin(), joined_.end(), std::pair<int, int>(std::minmax(a, b))))
    return true;
  const double near = kNear * (radius_[std::size_t(a)] + radius_[std::size_t(b)]);
  return model_.collision != Collision::handout && r2 < near * near && may_touch_(a, b);
}

template <int D>
double ClosePassages<D>::of_pair(const State<D>& state, double t, double h, const Pair& pair) {
  const Place a = place(state, t, pair.a), b = place(state, t, pair.b);
  const double r2 = (a.x - b.x).squaredNorm() + pair.law.softening2;
  const double ratio =
      passage_ratio(r2, (a.v - b.v).squaredNorm(), pair.law.strength * (pair.a.inverse + pair.b.inverse),
                    pair.law.twice, h);
  return ratio > 0 && meet(pair.a.body, pair.b.body, r2) ? 0 : ratio;
}

template <int D>
double ClosePassages<D>::fastest(const State<D>& state, double h, int body) {
  double most = 0;
  for (const int pair : of_body_[std::size_t(body)])
    most = std::max(most, of_pair(state, 0, h, pairs_[std::size_t(pair)]));
  return most;
}

template <int D>
double ClosePassages<D>::fastest(const State<D>& state, double t, double h, std::span<const int> member) {
  double most = 0;
  const auto moves = [&](const Point& point) {
    return point.body >= 0 && member[std::size_t(point.body)] >= 0;
  };
  for (const Pair& pair : pairs_) {
    if (moves(pair.a) || moves(pair.b)) most = std::max(most, of_pair(state, t, h, pair));
  }
  for (const Group& group : groups_) most = std::max(most, of_group(state, t, h, group, member));
  return most;
}

// all pairs with a member, from rows of components; pairs that are far, nearly all, are passed over side by
// side
template <int D>
double ClosePassages<D>::of_group(const State<D>& state, double t, double h, const Group& group,
                                  std::span<const int> member) {
  const std::size_t n = group.points.size();
  order_.clear();
  std::size_t members = 0;
  for (const bool moves : {true, false}) {
    for (std::size_t i = 0; i < n; ++i)
      if ((member[std::size_t(group.points[i].body)] >= 0) == moves) order_.push_back(int(i));
    if (moves) members = order_.size();
  }
  rows_.resize(n * (2 * D + 2));
  double* const weights = rows_.data() + 2 * D * n;
  double* const inverses = weights + n;
  for (std::size_t i = 0; i < n; ++i) {
    const Point& point = group.points[std::size_t(order_[i])];
    const Place it = place(state, t, point);
    for (std::size_t k = 0; k < std::size_t(D); ++k)
      rows_[k * n + i] = it.x[int(k)], rows_[(D + k) * n + i] = it.v[int(k)];
    weights[i] = point.weight, inverses[i] = point.inverse;
  }
  const double* const rows = rows_.data();
  double most = 0;
  for (std::size_t i = 0; i < members; ++i) {
    if (group.law.twice == 4 && !any_near<D>(n, i, rows, group.law.strength, group.law.softening2, h))
      continue;
    const int body = group.points[std::size_t(order_[i])].body;
    for (std::size_t j = i + 1; j < n; ++j) {
      const Meeting it = meeting<D>(n, i, j, rows, group.law.strength, group.law.softening2);
      const double ratio = passage_ratio(it.r2, it.v2, it.A, group.law.twice, h);
      if (ratio > most && !meet(body, group.points[std::size_t(order_[j])].body, it.r2)) most = ratio;
    }
  }
  return most;
}

template class ClosePassages<2>;
template class ClosePassages<3>;

}  // namespace obscura::sim
