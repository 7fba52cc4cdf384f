// Equilibrium of an island. J has the rows of its contacts (normal, then tangents), M the bodies' masses:
//   K f + b = w,   K = J M^-1 J',   b = J g        f in the cones, w obeys their laws (cone_law.h)
//   a = g + M^-1 J' f = 0                          at rest

#include "sim/solve/cone/statics.h"

#include <algorithm>
#include <cmath>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

namespace {

constexpr double kStaticResidual = 1e-9;  // of g

// What holds is found in a few systems where bodies rest on each other, in hundreds on a rope over a drum.
// For a large pile that rocks still they would be solved for seconds, and in vain: fewer with the fourth
// power of the rows, of which the cube is the time of a system.
constexpr double kWork = 3e11;  // systems times rows to the fourth
constexpr int kFewestSystems = 2, kMostSystems = 2000;

}  // namespace

template <int D>
Statics<D>::Statics(const Model<D>& model) : model_(model), columns_(model.bodies.size(), -1) {
  cone_.thorough = false;
}

template <int D>
bool Statics<D>::in_equilibrium(std::vector<BearingContact<D>>& touches,
                                const std::vector<Rotation<D>>& turns) {
  const double g = std::sqrt(model_.gravity.squaredNorm());
  if (touches.empty() || int(touches.size()) > kMost || g == 0) return false;
  bodies_.clear();
  for (const BearingContact<D>& touch : touches) {
    for (const int body : {touch.a, touch.b}) {
      if (body < 0 || columns_[body] >= 0) continue;
      columns_[body] = int(bodies_.size());
      bodies_.push_back(body);
    }
  }
  rates_.assign(bodies_.size(), Way::Zero());
  for (Way& rate : rates_) rate.template head<D>() = model_.gravity;

  const int rows = D * int(touches.size());
  rows_.assign(std::size_t(rows), {});
  blocks_.assign(touches.size(), {});
  modes_.assign(touches.size(), {});
  f_.resize(rows);
  const auto axes = [](const BearingContact<D>& touch) {
    Eigen::Matrix<double, D, D> all;
    all.col(0) = touch.normal, all.col(1) = perpendicular<D>(touch.normal);
    if constexpr (D == 3) all.col(2) = all.col(0).cross(all.col(1));
    return all;
  };
  for (int i = 0; i < int(touches.size()); ++i) {
    const BearingContact<D>& touch = touches[i];
    blocks_[i].mu = touch.friction;
    const auto ways = axes(touch);
    for (int k = 0; k < D; ++k) {
      f_[D * i + k] = touch.force.dot(ways.col(k));
      for (const bool first : {true, false}) {
        const int at = first ? touch.a : touch.b;
        if (at < 0) continue;
        const Vec<D> push = first ? Vec<D>(ways.col(k)) : Vec<D>(-ways.col(k));
        const AngularVec<D> turn = moment<D>(first ? touch.arm_a : touch.arm_b, push);
        rows_[D * i + k][first ? 0 : 1] = {columns_[at], model_.bodies[at], turns[at], push, turn};
      }
    }
  }

  K_.resize(rows, rows), b_.resize(rows);
  for (int i = 0; i < rows; ++i) {
    b_[i] = 0;
    for (const Side<D>& side : rows_[i]) b_[i] += side.column < 0 ? 0 : side.J.dot(rates_[side.column]);
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (const Side<D>& one : rows_[i]) {
        for (const Side<D>& other : rows_[j]) {
          if (one.column >= 0 && one.column == other.column) sum += one.J.dot(other.response);
        }
      }
      K_(i, j) = K_(j, i) = sum;
    }
  }
  const double cubed = double(rows) * rows * rows;
  cone_.patience = cone_.most_systems =
      int(std::clamp(kWork / (cubed * rows), double(kFewestSystems), double(kMostSystems)));
  bool held = cone_.solve(K_, b_, blocks_, modes_, f_).found;
  for (int i = 0; i < rows; ++i) {
    for (const Side<D>& side : rows_[i]) {
      if (side.column >= 0) rates_[side.column] += f_[i] * side.response;
    }
  }
  for (const int body : bodies_) {
    const Way& rate = rates_[columns_[body]];
    const double a = std::sqrt(rate.template head<D>().squaredNorm()) +
                     bounding_radius(model_.bodies[body].shape) *
                         std::sqrt(rate.template tail<kAngular<D>>().squaredNorm());
    held = held && a <= kStaticResidual * g;
    columns_[body] = -1;
  }
  for (int i = 0; i < int(touches.size()); ++i) touches[i].force = axes(touches[i]) * f_.segment<D>(D * i);
  return held;
}

template class Statics<2>;
template class Statics<3>;

}  // namespace obscura::sim
