// Joints with C(q) = 0 leave a linkage, to the first order, the velocities N of J v = 0. These go on to the
// second order if some acceleration a has
//   J a = -c(v)      c(v) = J' v
// Forces l that are in balance among themselves, J' l = 0 (transposed), as tension in a chain that is
// straight between two walls, rule out those of which l . c(v) is not zero. Where l . c is of one sign for
// all v, and not zero for some, these v lead nowhere: the linkage is rigid to the second order (Connelly and
// Whiteley 1996), but what acts along v is answered by l without bound. Where it has both signs, as of a
// parallelogram that lies flat, some v between go on. Bodies are weighed by their masses, so that nothing
// hangs on units.

#include "sim/motion/infinitesimal_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/constraint/joints/joint.h"
#include "sim/math/full_rank.h"
#include "sim/math/islands.h"
#include "sim/motion/stability.h"

namespace obscura::sim {

namespace {

constexpr int kMostLinkageRows = 400;
constexpr double kOfRankNone = 1e-12;  // of the largest: eigenvalues of rows of unit length
constexpr double kMayDepend = 1e-9;    // of the largest: pivots of what may have such eigenvalues
constexpr double kOneSign = 1e-6;      // of the largest: eigenvalues that are none of the other sign
constexpr double kBends = 1e-6;        // of v^2 / L: less is no bend
constexpr double kShortest = 1e-9;     // of the room: an arm
constexpr double kTakesPart = 1e-6;    // of a unit of balanced forces

// compiled once, not for each expression
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }

template <int D>
constexpr int kFreedoms = D + kAngular<D>;

// the joints of bodies that hang together, and what they leave free
template <int D>
class Linkage {
 public:
  Linkage(const Model<D>& model, const State<D>& state, std::vector<int> joints)
      : model_(model), state_(state), joints_(std::move(joints)), column_(model.bodies.size(), -1) {
    for (const int i : joints_) {
      model.joints[std::size_t(i)].each_body([&](int body) {
        if (body < 0 || model.bodies[std::size_t(body)].fixed || column_[std::size_t(body)] >= 0) return;
        column_[std::size_t(body)] = kFreedoms<D> * int(bodies_.size()), bodies_.push_back(body);
      });
      rows_ += equations<D>(model.joints[std::size_t(i)].kind).rows;
    }
    at_.resize(model.bodies.size());
    for (std::size_t body = 0; body < at_.size(); ++body) {
      at_[body] = body_motion(state, int(body));
      at_[body].v.setZero(), at_[body].w.setZero();
    }
  }

  int rows() const { return rows_; }

  // a body that balanced forces hold so, and how many they are; -1: none
  std::pair<int, int> held_straight() {
    const int n = kFreedoms<D> * int(bodies_.size());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows_, n);
    int first = 0;
    for (const int i : joints_) {
      Row<D> its[kMostHeld<D>];
      const int count = rows_of(i, its);
      for (int r = 0; r < count; ++r)
        each_side(its[r], [&](int body, const Vec<D>& along, const AngularVec<D>& angular) {
          if (body < 0 || column_[std::size_t(body)] < 0) return;
          J.row(first + r).segment(column_[std::size_t(body)], kFreedoms<D>) += weighed(body, along, angular);
        });
      first += count;
    }
    Eigen::VectorXd size(rows_);  // of rows that hold nothing that moves: none
    for (int r = 0; r < rows_; ++r) {
      size[r] = J.row(r).norm();
      if (size[r] > 0) J.row(r) /= size[r];
    }
    const Eigen::MatrixXd K = product(J, J.transpose());
    FullRank rank;
    rank.symmetric({K.data(), std::size_t(K.size())}, rows_, kMayDepend);
    if (rank.rank() == rows_) return {-1, 0};
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> forces(K), ways(product(J.transpose(), J));
    const double zero = kOfRankNone * std::max(1.0, forces.eigenvalues()[rows_ - 1]);
    const auto zeros = [&](const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& of) {
      return int((of.eigenvalues().array() <= zero).count());
    };
    const int balanced = zeros(forces), free = zeros(ways);
    if (balanced == 0 || free == 0) return {-1, 0};
    const Eigen::MatrixXd stress = forces.eigenvectors().leftCols(balanced),
                          motions = ways.eigenvectors().leftCols(free);
    for (int k = 0; k < free; ++k) {
      Eigen::VectorXd l = product(stress.transpose(), bends(motions.col(k)).cwiseProduct(inverse(size)));
      const double passes = fastest(motions.col(k));
      if (!(l.norm() > kBends * passes * passes / longest_arm())) continue;
      l.normalize();
      const Eigen::VectorXd balance = product(stress, l);
      const Eigen::MatrixXd form =
          product(motions.transpose(), product(bend_form(balance.cwiseProduct(inverse(size))), motions));
      const Eigen::VectorXd signs =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(form, Eigen::EigenvaluesOnly).eigenvalues();
      const double least = signs.minCoeff(), most = signs.maxCoeff();
      const double large = std::max(std::fabs(least), std::fabs(most));
      if (std::min(std::fabs(std::min(least, 0.0)), std::max(most, 0.0)) > kOneSign * large) continue;
      return named_of(balance);
    }
    return {-1, 0};
  }

 private:
  static Eigen::VectorXd inverse(const Eigen::VectorXd& size) {
    return size.unaryExpr([](double it) { return it > 0 ? 1 / it : 0.0; });
  }

  // the rows of a joint at the velocities that bodies have
  int rows_of(int number, Row<D>* its) const {
    double off[kMostHeld<D>];
    return sim::rows<D>(model_.joints[std::size_t(number)], std::size_t(number), state_, at_, its, off);
  }

  // what a row has of a body whose velocities are in units of sqrt(2 J)
  Eigen::Matrix<double, 1, kFreedoms<D>> weighed(int body, const Vec<D>& along,
                                                 const AngularVec<D>& angular) const {
    const Body<D>& its = model_.bodies[std::size_t(body)];
    Eigen::Matrix<double, 1, kFreedoms<D>> all = Eigen::Matrix<double, 1, kFreedoms<D>>::Zero();
    all.template head<D>() = along.transpose() / std::sqrt(its.mass);
    if (!its.turns()) return all;
    const AngularVec<D> own = from_room<D>(at_[std::size_t(body)].room_from_body, angular);
    for (int i = 0; i < kAngular<D>; ++i) all[D + i] = own[i] / std::sqrt(its.inertia[i]);
    return all;
  }

  // adds to a body's velocity in such units
  void add(int body, const Eigen::Matrix<double, kFreedoms<D>, 1>& q) {
    const Body<D>& its = model_.bodies[std::size_t(body)];
    BodyMotion<D>& at = at_[std::size_t(body)];
    at.v += Vec<D>(q.template head<D>() / std::sqrt(its.mass));
    if (!its.turns()) return;
    AngularVec<D> own;
    for (int i = 0; i < kAngular<D>; ++i) own[i] = q[D + i] / std::sqrt(its.inertia[i]);
    at.w += to_room<D>(at.room_from_body, own);
  }
  void stop() {
    for (const int body : bodies_) at_[std::size_t(body)].v.setZero(), at_[std::size_t(body)].w.setZero();
  }

  // c of all rows
  Eigen::VectorXd bends(const Eigen::VectorXd& q) {
    for (const int body : bodies_) add(body, q.template segment<kFreedoms<D>>(column_[std::size_t(body)]));
    Eigen::VectorXd c(rows_);
    int first = 0;
    for (const int i : joints_) {
      Row<D> its[kMostHeld<D>];
      const int count = rows_of(i, its);
      for (int r = 0; r < count; ++r) c[first + r] = its[r].velocity_product;
      first += count;
    }
    stop();
    return c;
  }

  // how fast joints move in a motion, at most, m/s
  double fastest(const Eigen::VectorXd& q) {
    double most = 0;
    const double far = longest_arm();
    for (const int body : bodies_) {
      add(body, q.template segment<kFreedoms<D>>(column_[std::size_t(body)]));
      const BodyMotion<D>& at = at_[std::size_t(body)];
      most = std::max(most, at.v.norm() + far * at.w.norm());
    }
    stop();
    return most;
  }

  double longest_arm() const {
    double most = kShortest * model_.scale;
    for (const int i : joints_) {
      const Joint<D>& joint = model_.joints[std::size_t(i)];
      most = std::max({most, joint.a.local.norm(), joint.b.local.norm(), joint.length});
    }
    return most;
  }

  // The matrix of l . c: joint by joint from c of pairs of its freedoms, for c is quadratic.
  Eigen::MatrixXd bend_form(const Eigen::VectorXd& l) {
    const int n = kFreedoms<D> * int(bodies_.size());
    Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n, n);
    int first = 0;
    for (const int i : joints_) {
      const int count = equations<D>(model_.joints[std::size_t(i)].kind).rows;
      std::vector<std::pair<int, int>> freedoms;  // body, which of its
      model_.joints[std::size_t(i)].each_body([&](int body) {
        for (int k = 0; body >= 0 && column_[std::size_t(body)] >= 0 && k < kFreedoms<D>; ++k)
          freedoms.emplace_back(body, k);
      });
      const auto of = [&](std::size_t p, std::size_t q) {
        for (const std::size_t each : {p, q})
          add(freedoms[each].first, Eigen::Matrix<double, kFreedoms<D>, 1>::Unit(freedoms[each].second));
        Row<D> its[kMostHeld<D>];
        rows_of(i, its);
        stop();
        double sum = 0;
        for (int r = 0; r < count; ++r) sum += l[first + r] * its[r].velocity_product;
        return sum;
      };
      std::vector<double> own(freedoms.size());  // c of twice a unit is four of one
      for (std::size_t p = 0; p < freedoms.size(); ++p) own[p] = 0.25 * of(p, p);
      for (std::size_t p = 0; p < freedoms.size(); ++p)
        for (std::size_t q = 0; q <= p; ++q) {
          const double both = p == q ? own[p] : 0.5 * (of(p, q) - own[p] - own[q]);
          const int row = column_[std::size_t(freedoms[p].first)] + freedoms[p].second,
                    column = column_[std::size_t(freedoms[q].first)] + freedoms[q].second;
          form(row, column) += both;
          if (p != q) form(column, row) += both;
        }
      first += count;
    }
    return form;
  }

  // the first body that balanced forces go through, and through how many they go
  std::pair<int, int> named_of(const Eigen::VectorXd& forces) const {
    std::vector<char> takes(model_.bodies.size(), 0);
    int first = 0;
    for (const int i : joints_) {
      const int count = equations<D>(model_.joints[std::size_t(i)].kind).rows;
      if (forces.segment(first, count).cwiseAbs().maxCoeff() > kTakesPart)
        model_.joints[std::size_t(i)].each_body([&](int body) {
          if (body >= 0 && column_[std::size_t(body)] >= 0) takes[std::size_t(body)] = 1;
        });
      first += count;
    }
    const auto all = std::count(takes.begin(), takes.end(), 1);
    return {int(std::find(takes.begin(), takes.end(), 1) - takes.begin()), int(all)};
  }

  const Model<D>& model_;
  const State<D>& state_;
  std::vector<int> joints_;
  std::vector<int> bodies_, column_;  // those that move; where each begins among the freedoms, or -1
  std::vector<BodyMotion<D>> at_;
  int rows_ = 0;
};

template <int D>
std::vector<Trouble> found(const Model<D>& model, const State<D>& state) {
  const int n = int(model.bodies.size());
  const auto moves = [&](int body) { return body >= 0 && !model.bodies[std::size_t(body)].fixed; };
  Islands together, closed;  // without and with what is fixed, which is one
  together.reset(n + 1), closed.reset(n + 1);
  std::vector<int> held;
  std::vector<char> loops(std::size_t(n) + 1, 0);
  for (int i = 0; i < int(model.joints.size()); ++i) {
    const Joint<D>& joint = model.joints[std::size_t(i)];
    const JointEquations<D>& its = equations<D>(joint.kind);
    if (its.mechanism || its.one_sided || joint.later || joint.kind == JointKind::wire) continue;
    if (!moves(joint.a.body) && !moves(joint.b.body)) continue;
    held.push_back(i);
    if (moves(joint.a.body) && moves(joint.b.body)) together.join(joint.a.body, joint.b.body);
  }
  const auto of = [&](int i) {
    const Joint<D>& joint = model.joints[std::size_t(i)];
    return together.root(moves(joint.a.body) ? joint.a.body : joint.b.body);
  };
  // only loops have forces in balance
  for (const int i : held) {
    const Joint<D>& joint = model.joints[std::size_t(i)];
    const int a = moves(joint.a.body) ? joint.a.body : n, b = moves(joint.b.body) ? joint.b.body : n;
    if (closed.root(a) == closed.root(b)) loops[std::size_t(of(i))] = 1;
    closed.join(a, b);
  }
  std::vector<Trouble> all;
  std::vector<std::vector<int>> linkages(std::size_t(n) + 1);
  for (const int i : held)
    if (loops[std::size_t(of(i))]) linkages[std::size_t(of(i))].push_back(i);
  for (std::vector<int>& joints : linkages) {
    if (joints.empty()) continue;
    Linkage<D> linkage(model, state, std::move(joints));
    if (linkage.rows() > kMostLinkageRows) continue;
    const auto [body, count] = linkage.held_straight();
    if (body < 0) continue;
    std::string bodies = named(model, body);
    if (count > 1) bodies += " and " + std::to_string(count - 1) + (count > 2 ? " others" : " other");
    all.push_back({0, named(model, body), "joints", "hold it straight",
                   "the joints of " + bodies + " hold " + (count > 1 ? "them" : "it") +
                       " straight, and no finite force bears a load across that: give them slack, or put a "
                       "spring in place of one"});
  }
  return all;
}

}  // namespace

std::vector<Trouble> infinitesimal_motions(const Model<2>& model, const State<2>& state) {
  return found(model, state);
}
std::vector<Trouble> infinitesimal_motions(const Model<3>& model, const State<3>& state) {
  return found(model, state);
}

}  // namespace obscura::sim
