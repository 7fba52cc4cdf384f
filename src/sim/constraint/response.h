#pragma once

// Response of bodies to an impulse p along a row of the Jacobian J = (s, r x s), M^-1 J' p:
//   free body                dv = p s / m,  dw = p I^-1 (r x s)
//   link of a chain          M^-1 J' of its whole tree, by Featherstone's algorithm (sim/multibody/chains.h)
//   wall; fixed, sleeping    nothing
// and of a row i by a row j, K_ij = J_i M^-1 J_j'; 1 / K_ii is the effective mass of row i. The solvers keep
// three forms of it, which round differently: Side, RowResponse and PointBody.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §8.5; Catto, Iterative Dynamics with Temporal
// Coherence (2005), §3.

#include <span>
#include <vector>

#include "sim/constraint/row.h"
#include "sim/math/spatial.h"
#include "sim/multibody/chains.h"

namespace obscura::sim {

/// I^-1 times a moment (both in the room's frame): the spin that an impulse gives to a free body. Zero of a
/// body that does not turn.
template <int D>
AngularVec<D> angular_response(const Body<D>& body, const Rotation<D>& room_from_body,
                               const AngularVec<D>& moment) {
  if (!body.turns()) return AngularVec<D>::Zero();
  return inverse_inertia_times<D>(body.inertia, room_from_body, moment);
}

/// One side of a row that is kept as vectors: its part of J and of M^-1 J' for one free body.
template <int D>
struct Side {
  using Way = Eigen::Matrix<double, D + kAngular<D>, 1>;  // velocity, then spin

  int column = -1;  // of the body in the lists of the solver; -1: does not move
  Way J = Way::Zero(), response = Way::Zero();

  Side() = default;
  /// `along` and `moment`: the row's linear and angular part for this body, with their sign.
  Side(int place, const Body<D>& body, const Rotation<D>& room_from_body, const Vec<D>& along,
       const AngularVec<D>& moment)
      : column(place) {
    J << along, moment;
    response << along / body.mass, angular_response<D>(body, room_from_body, moment);
  }
};

/// M^-1 J' of a row for two free bodies. The linear part is stored as 1/m alone: its direction is Row::along.
/// Zero for a body that is not free.
template <int D>
struct RowResponse {
  double inverse_mass_a = 0, inverse_mass_b = 0;  // 1/kg
  AngularVec<D> angular_a = AngularVec<D>::Zero(), angular_b = AngularVec<D>::Zero();
  // of each of Row::more
  struct Another {
    double inverse_mass = 0;
    AngularVec<D> angular = AngularVec<D>::Zero();
  };
  std::vector<Another> more;
};

/// act(body, change of velocity, spin by a unit, impulse) for each free body of a row under an impulse p
/// along it; the spin changes by impulse times spin by a unit, and the impulse is -p of b.
template <int D, class Act>
void each_response(const Row<D>& row, const RowResponse<D>& response, double p, Act&& act) {
  if (response.inverse_mass_a > 0)
    act(row.a, Vec<D>(p * response.inverse_mass_a * row.along), response.angular_a, p);
  if (response.inverse_mass_b > 0)
    act(row.b, Vec<D>(-p * response.inverse_mass_b * row.along), response.angular_b, -p);
  for (std::size_t i = 0; i < response.more.size(); ++i) {
    const double m = response.more[i].inverse_mass;
    if (m > 0) act(row.more[i].body, Vec<D>(p * m * row.more[i].along), response.more[i].angular, p);
  }
}

/// K_ij = J_j M^-1 J_i' of two rows of free bodies, 1/kg.
template <int D>
double coupling(const Row<D>& i, const RowResponse<D>& response, const Row<D>& j) {
  const double ma = response.inverse_mass_a, mb = response.inverse_mass_b;
  const AngularVec<D>&wa = response.angular_a, &wb = response.angular_b;
  double k = 0;
  if (ma > 0 && i.a == j.a) k += ma * i.along.dot(j.along) + wa.dot(j.angular_a);
  if (mb > 0 && i.b == j.b) k += mb * i.along.dot(j.along) + wb.dot(j.angular_b);
  if (ma > 0 && i.a == j.b) k -= ma * i.along.dot(j.along) + wa.dot(j.angular_b);
  if (mb > 0 && i.b == j.a) k -= mb * i.along.dot(j.along) + wb.dot(j.angular_a);
  if (i.more.empty() && j.more.empty()) return k;
  // mechanisms: each side of one against each of the other
  for (std::size_t s = 0; s < response.more.size(); ++s) {
    const RowSide<D>& side = i.more[s];
    const double m = response.more[s].inverse_mass;
    if (!(m > 0)) continue;
    each_side(j, [&](int body, const Vec<D>& along, const AngularVec<D>& angular) {
      if (body == side.body) k += m * side.along.dot(along) + response.more[s].angular.dot(angular);
    });
  }
  for (const RowSide<D>& side : j.more) {
    if (ma > 0 && side.body == i.a) k += ma * i.along.dot(side.along) + wa.dot(side.angular);
    if (mb > 0 && side.body == i.b) k -= mb * i.along.dot(side.along) + wb.dot(side.angular);
  }
  return k;
}

/// The bodies of a system and how each responds to an impulse: free bodies, links of chains, bodies that do
/// not move.
template <int D>
class Response {
 public:
  /// Kept by reference. Nothing moves yet.
  explicit Response(const Model<D>& model) : model_(model), inverse_mass_(model.bodies.size(), 0.0) {}

  void set(int body, bool moves) { inverse_mass_[body] = moves ? 1 / model_.bodies[body].mass : 0; }

  /// 1/kg; zero of what does not move, and of the room (body < 0).
  double inverse_mass(int body) const { return body < 0 ? 0 : inverse_mass_[body]; }
  bool moves(int body) const { return inverse_mass(body) > 0; }
  bool free(int body) const { return moves(body) && !model_.bodies[body].linked; }
  bool linked(int body) const { return moves(body) && model_.bodies[body].linked; }

  /// M^-1 J' of a row for the free ones of its bodies, at the poses in `bodies`.
  RowResponse<D> of(const Row<D>& row, const std::vector<BodyMotion<D>>& bodies) const {
    static const BodyMotion<D> room;
    RowResponse<D> out = of(row, row.a < 0 ? room : bodies[row.a], row.b < 0 ? room : bodies[row.b]);
    for (const RowSide<D>& side : row.more) {
      typename RowResponse<D>::Another& another = out.more.emplace_back();
      if (!free(side.body)) continue;
      another.inverse_mass = inverse_mass_[side.body];
      another.angular =
          angular_response<D>(model_.bodies[side.body], bodies[side.body].room_from_body, side.angular);
    }
    return out;
  }
  /// The same at the poses of its two bodies, where it has no more.
  RowResponse<D> of(const Row<D>& row, const BodyMotion<D>& a, const BodyMotion<D>& b) const {
    RowResponse<D> out;
    if (free(row.a)) {
      out.inverse_mass_a = inverse_mass_[row.a];
      out.angular_a = angular_response<D>(model_.bodies[row.a], a.room_from_body, row.angular_a);
    }
    if (free(row.b)) {
      out.inverse_mass_b = inverse_mass_[row.b];
      out.angular_b = angular_response<D>(model_.bodies[row.b], b.room_from_body, row.angular_b);
    }
    return out;
  }

  /// K_pq = J_p M^-1 J_q' of two rows of free bodies, 1/kg, as coupling() but summed term by term: the joint
  /// solver's states (tests/reference/states.csv) are of this order.
  double coupling(const Row<D>& p, const Row<D>& q, const std::vector<BodyMotion<D>>& bodies) const {
    double sum = 0;
    const auto side = [&](int body, const AngularVec<D>& moment, double sign) {
      if (!free(body)) return;
      const auto with = [&](int other, const AngularVec<D>& its, double s) {
        if (other != body) return;
        const Body<D>& b = model_.bodies[body];
        sum += sign * s * inverse_mass_[body] * p.along.dot(q.along);
        if (b.turns()) sum += sign * s * moment.dot(angular_response<D>(b, bodies[body].room_from_body, its));
      };
      with(q.a, q.angular_a, 1), with(q.b, q.angular_b, -1);
    };
    side(p.a, p.angular_a, 1), side(p.b, p.angular_b, -1);
    if (p.more.empty() && q.more.empty()) return sum;
    // mechanisms: each side of one against each of the other
    sum = 0;
    each_side(p, [&](int body, const Vec<D>& along, const AngularVec<D>& angular) {
      if (!free(body)) return;
      const Body<D>& b = model_.bodies[body];
      each_side(q, [&](int other, const Vec<D>& its, const AngularVec<D>& turn) {
        if (other != body) return;
        sum += inverse_mass_[body] * along.dot(its);
        if (b.turns()) sum += angular.dot(angular_response<D>(b, bodies[body].room_from_body, turn));
      });
    });
    return sum;
  }

 private:
  const Model<D>& model_;
  std::vector<double> inverse_mass_;  // 1/kg; 0 of what does not move
};

/// J and M^-1 J' of the rows that move chains, in the joint velocities of all chains.
template <int D>
class ChainResponse {
 public:
  /// Builds the responses of `rows` at the present poses of `chains`. Adds to the velocity-product term of a
  /// row on a link the acceleration that the link has if no joint accelerates.
  void build(std::vector<Row<D>>& rows, const Response<D>& bodies, Articulated<D>& chains);

  /// Whether a row moves a chain.
  bool moves(int row) const { return number_[row] >= 0; }
  /// J and M^-1 J' of a row that does: one number a joint velocity.
  std::span<const double> jacobian(int row) const { return of(J_, row); }
  std::span<const double> response(int row) const { return of(U_, row); }
  /// K_ij = J_i M^-1 J_j' of the chains alone, 1/kg; zero where either moves none.
  double coupling(int i, int j) const;

 private:
  std::span<const double> of(const std::vector<double>& numbers, int row) const {
    return {numbers.data() + size_ * std::size_t(number_[row]), size_};
  }

  std::size_t size_ = 0;     // joint velocities
  std::vector<int> number_;  // one a row: its place among those that move chains, or -1
  std::vector<double> J_, U_;
};

/// A body under impulses at points: its velocity, and its response p / m and I^-1 (r x p) to an impulse p at
/// an arm r from its centre. Default-constructed it is static: a wall, a fixed or sleeping body. In space it
/// is laid out for vectors of four numbers: v and 1/m, w, and the inverse inertia
/// (solve/iterate/space_batches).
template <int D>
struct alignas(D == 3 ? 32 : 8) PointBody {
  Vec<D> v = Vec<D>::Zero();
  double inverse_mass = 0;  // 1/kg
  AngularVec<D> w = AngularVec<D>::Zero();
  double padding = 0;
  SpinTensor<D> inverse_inertia = SpinTensor<D>::Zero();  // 1/(kg m^2), room's frame

  PointBody() = default;
  PointBody(const Body<D>& body, const BodyMotion<D>& at) : v(at.v), inverse_mass(1 / body.mass), w(at.w) {
    if (!body.turns()) return;
    for (int axis = 0; axis < kAngular<D>; ++axis) {
      inverse_inertia.col(axis) =
          angular_response<D>(body, at.room_from_body, AngularVec<D>(AngularVec<D>::Unit(axis)));
    }
  }

  /// An impulse (N s) at an arm (m) from its centre, both in the room's frame. What does not move is not
  /// written.
  void push(const Vec<D>& impulse, const Vec<D>& arm) {
    if (!(inverse_mass > 0)) return;
    v += inverse_mass * impulse, w += inverse_inertia * moment<D>(arm, impulse);
  }
};

}  // namespace obscura::sim
