// The free motion is found by conjugate gradients on
//   J M^-1 J' l = J v         each row weighed by its own response
// after Hestenes and Stiefel (1952): redundant rows do no harm, and the number of iterations grows with the
// height of a heap, not with its square.

#include "sim/constraint/mobility.h"

#include <algorithm>
#include <cmath>

#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kAsked = 0.002;     // s of gravity
constexpr double kNone = 1e-8;       // of sqrt(g L)
constexpr double kAtOnce = 0.01;     // s: what friction stops within
constexpr double kSolved = 1e-3;     // of Slow::none: how much rows may still be off
constexpr int kRowRounds = 1000000;  // rows times rounds
constexpr int kFewestRounds = 100;   // of many rows
constexpr int kMostRounds = 2000;    // of few

}  // namespace

template <int D>
Slow slow(const Model<D>& model) {
  const double g = std::sqrt(model.gravity.squaredNorm());
  return {.asked = kAsked * g, .none = kNone * std::sqrt(g * model.scale)};
}

template <int D>
Mobility<D>::Mobility(const Model<D>& model)
    : model_(model),
      slow_(slow(model)),
      g_(std::sqrt(model.gravity.squaredNorm())),
      columns_(model.bodies.size(), -1) {
  for (const Body<D>& body : model.bodies) bounding_radius_.push_back(bounding_radius(body.shape));
}

template <int D>
void Mobility<D>::clear() {
  for (const Moving& it : bodies_) columns_[it.body] = -1;
  bodies_.clear(), rows_.clear();
}

template <int D>
void Mobility<D>::add(int body, const Vec<D>& v, const AngularVec<D>& w, const Rotation<D>& room_from_body) {
  columns_[body] = int(bodies_.size());
  Moving it{.body = body, .room_from_body = room_from_body, .v = Way::Zero(), .change = Way::Zero()};
  it.v << v, w;
  bodies_.push_back(it);
}

template <int D>
Side<D> Mobility<D>::side(int body, const Vec<D>& along, const AngularVec<D>& turn) const {
  const int column = body < 0 ? -1 : columns_[body];
  if (column < 0) return {};
  return {column, model_.bodies[body], bodies_[column].room_from_body, along, turn};
}

// J v
template <int D>
double Mobility<D>::moves(const Held& row) const {
  double sum = 0;
  each_side(row,
            [&](const Side<D>& side) { sum += side.column < 0 ? 0 : side.J.dot(bodies_[side.column].v); });
  return sum;
}

template <int D>
void Mobility<D>::keep(Held row) {
  double answer = 0;
  each_side(row, [&](const Side<D>& side) { answer += side.J.dot(side.response); });
  if (!(answer > 0)) return;
  row.give = 1 / answer;
  rows_.push_back(row);
}

template <int D>
void Mobility<D>::add_contact(const BearingContact<D>& touch) {
  const double presses = touch.force.dot(touch.normal);
  if (!(presses > 0)) return;
  const auto row = [&](const Vec<D>& along) {
    Held it;
    it.sides[0] = side(touch.a, along, moment<D>(touch.arm_a, along));
    it.sides[1] = side(touch.b, Vec<D>(-along), AngularVec<D>(-moment<D>(touch.arm_b, along)));
    return it;
  };
  keep(row(touch.normal));
  std::array<Held, D - 1> across;
  across[0] = row(perpendicular<D>(touch.normal));
  if constexpr (D == 3) across[1] = row(touch.normal.cross(perpendicular<D>(touch.normal)));
  double slip2 = 0;
  for (const Held& it : across) slip2 += moves(it) * moves(it);
  const double drag = std::sqrt((touch.force - presses * touch.normal).squaredNorm());
  const double spare = g_ * (touch.friction - drag / presses);
  if (!(touch.friction > 0) || !(std::sqrt(slip2) <= kAtOnce * spare)) return;
  for (const Held& it : across) keep(it);
}

template <int D>
void Mobility<D>::add_row(const Row<D>& row, double spare) {
  Held it;
  it.sides[0] = side(row.a, row.along, row.angular_a);
  it.sides[1] = side(row.b, Vec<D>(-row.along), AngularVec<D>(-row.angular_b));
  for (const RowSide<D>& more : row.more) it.more.push_back(side(more.body, more.along, more.angular));
  if (std::fabs(moves(it)) <= kAtOnce * spare) keep(it);
}

// an upper bound on the speed of a body's fastest point
template <int D>
double Mobility<D>::fastest() const {
  double most = 0;
  for (const Moving& it : bodies_) {
    most = std::max(
        most, std::sqrt(it.v.template head<D>().squaredNorm()) +
                  bounding_radius_[it.body] * std::sqrt(it.v.template tail<kAngular<D>>().squaredNorm()));
  }
  return most;
}

template <int D>
Mobile Mobility<D>::mobile() {
  double before = 0;  // r' z, z = r / (J M^-1 J') of each row alone
  for (Held& row : rows_) {
    row.off = moves(row);
    row.way = row.give * row.off;
    before += row.off * row.way;
  }
  const int most = std::clamp(kRowRounds / std::max(1, int(rows_.size())), kFewestRounds, kMostRounds);
  for (int round = 0; round < most; ++round) {
    if (fastest() <= slow_.none) return Mobile::no;
    const bool solved = std::all_of(rows_.begin(), rows_.end(), [&](const Held& row) {
      return std::fabs(row.off) <= kSolved * slow_.none;
    });
    if (solved) return Mobile::yes;

    // along the direction, as far as it helps
    for (Moving& it : bodies_) it.change.setZero();
    for (const Held& row : rows_) {
      each_side(row, [&](const Side<D>& side) {
        if (side.column >= 0) bodies_[side.column].change += row.way * side.response;
      });
    }
    double bends = 0;
    for (Held& row : rows_) {
      row.by = 0;
      each_side(row, [&](const Side<D>& side) {
        if (side.column >= 0) row.by += side.J.dot(bodies_[side.column].change);
      });
      bends += row.way * row.by;
    }
    if (!(bends > 0)) return Mobile::unknown;
    const double far = before / bends;
    double now = 0;
    for (Moving& it : bodies_) it.v -= far * it.change;
    for (Held& row : rows_) {
      row.off -= far * row.by;
      now += row.off * row.give * row.off;
    }
    for (Held& row : rows_) row.way = row.give * row.off + now / before * row.way;
    before = now;
  }
  return Mobile::unknown;
}

template Slow slow<2>(const Model<2>&);
template Slow slow<3>(const Model<3>&);
template class Mobility<2>;
template class Mobility<3>;

}  // namespace obscura::sim
