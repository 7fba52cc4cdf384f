// The forms of M^-1 J' against M as a whole, and on chains against free bodies held together by rows.

#include "sim/constraint/response.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "sim/constraint/joints/joint.h"
#include "sim/jointed.h"
#include "sim/rooms.h"
#include "sim/solids.h"

namespace obscura::sim {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// two bodies of space, as they happen to lie, and a third that is fixed
struct ThreeBodies {
  Model<3> model;
  std::vector<BodyMotion<3>> at;

  explicit ThreeBodies(SpaceDice& dice) {
    for (int i = 0; i < 3; ++i) {
      Body<3> body;
      body.mass = 0.5 + i;
      body.inertia = {0.2 + i, 0.7, 0.4 + 0.5 * i};
      body.fixed = i == 2;
      model.bodies.push_back(body);
      at.push_back(dice.place(1));
    }
  }
  Response<3> response() const {
    Response<3> all(model);
    for (int i = 0; i < 3; ++i) all.set(i, !model.bodies[i].fixed);
    return all;
  }
  // 18 x 18, velocity and spin of each body; zero of what does not move
  Matrix inverse_mass() const {
    Matrix all = Matrix::Zero(18, 18);
    for (int i = 0; i < 2; ++i) {
      const Rotation<3>& R = at[i].room_from_body;
      all.block<3, 3>(6 * i, 6 * i) = Rotation<3>::Identity() / model.bodies[i].mass;
      all.block<3, 3>(6 * i + 3, 6 * i + 3) =
          R * model.bodies[i].inertia.cwiseInverse().asDiagonal() * R.transpose();
    }
    return all;
  }
};

template <int D>
Row<D> row_of(int a, int b, const Vec<D>& s, const Vec<D>& arm_a, const Vec<D>& arm_b) {
  Row<D> row;
  row.a = a, row.b = b, row.along = s;
  row.angular_a = moment<D>(arm_a, s), row.angular_b = moment<D>(arm_b, s);
  return row;
}

// J of a row as numbers of all bodies
template <int D>
Vector jacobian(const Row<D>& row, int bodies) {
  constexpr int n = D + kAngular<D>;
  Vector all = Vector::Zero(n * bodies);
  if (row.a >= 0) all.segment<D>(n * row.a) += row.along;
  if (row.a >= 0) all.segment<kAngular<D>>(n * row.a + D) += row.angular_a;
  if (row.b >= 0) all.segment<D>(n * row.b) -= row.along;
  if (row.b >= 0) all.segment<kAngular<D>>(n * row.b + D) -= row.angular_b;
  return all;
}

TEST(Response, OfARowIsThatOfTheWholeMassMatrix) {
  SpaceDice dice(1);
  for (int n = 0; n < 100; ++n) {
    const ThreeBodies three(dice);
    const Response<3> response = three.response();
    const std::pair<int, int> pairs[] = {{0, 1}, {1, 0}, {0, 2}, {1, -1}};
    std::vector<Row<3>> rows;
    for (const auto& [a, b] : pairs)
      rows.push_back(row_of<3>(a, b, dice.vec(1).normalized(), dice.vec(1), dice.vec(1)));
    for (const Row<3>& p : rows) {
      const Vector change = three.inverse_mass() * jacobian(p, 3);
      Vector given = Vector::Zero(18);
      each_response(p, response.of(p, three.at), 2.0,
                    [&](int body, const Vec3& dv, const Vec3& spin, double impulse) {
                      given.segment<3>(6 * body) += dv, given.segment<3>(6 * body + 3) += impulse * spin;
                    });
      EXPECT_LE((given - 2 * change).cwiseAbs().maxCoeff(), 1e-13);
      for (const Row<3>& q : rows) {
        const double K = jacobian(q, 3).dot(change);
        EXPECT_NEAR(coupling(p, response.of(p, three.at), q), K, 1e-13);
        EXPECT_NEAR(response.coupling(p, q, three.at), K, 1e-13);
      }
    }
  }
}

TEST(Response, OfASideAndOfPointsIsThatOfTheRow) {
  SpaceDice dice(2);
  for (int n = 0; n < 100; ++n) {
    const ThreeBodies three(dice);
    const Response<3> response = three.response();
    const Vec3 s = dice.vec(1), t = dice.vec(1), arm_a = dice.vec(1), arm_b = dice.vec(1);
    const Row<3> p = row_of<3>(0, 1, s, arm_a, arm_b), q = row_of<3>(0, 1, t, arm_a, arm_b);
    const double K = response.coupling(p, q, three.at);

    PointBody<3> a(three.model.bodies[0], three.at[0]), b(three.model.bodies[1], three.at[1]);
    const double before = speed(p, three.at);
    a.push(t, arm_a), b.push(-t, arm_b);
    std::vector<BodyMotion<3>> after = three.at;
    after[0].v = a.v, after[0].w = a.w, after[1].v = b.v, after[1].w = b.w;
    EXPECT_NEAR(speed(p, after) - before, K, 1e-13);

    double sides = 0;
    for (const int i : {0, 1}) {
      const double sign = i == 0 ? 1 : -1;
      const Rotation<3>& R = three.at[i].room_from_body;
      const Side<3> of_p(i, three.model.bodies[i], R, sign * s, sign * (i == 0 ? p.angular_a : p.angular_b));
      const Side<3> of_q(i, three.model.bodies[i], R, sign * t, sign * (i == 0 ? q.angular_a : q.angular_b));
      sides += of_p.J.dot(of_q.response);
    }
    EXPECT_NEAR(sides, K, 1e-13);
  }
}

TEST(Response, OfWhatDoesNotMoveIsNothing) {
  SpaceDice dice(3);
  const ThreeBodies three(dice);
  const Response<3> response = three.response();
  const Row<3> row = row_of<3>(2, -1, Vec3(0, 1, 0), dice.vec(1), dice.vec(1));
  EXPECT_FALSE(response.moves(2) || response.moves(-1) || response.free(2));
  EXPECT_EQ(response.coupling(row, row, three.at), 0);
  EXPECT_EQ(coupling(row, response.of(row, three.at), row), 0);
  each_response(row, response.of(row, three.at), 1.0,
                [](int body, const Vec3&, const Vec3&, double) { ADD_FAILURE() << body; });
}

// of free bodies: K_pq = p M^-1 q' - p M^-1 J' (J M^-1 J')^-1 J M^-1 q', J the rows of their joints
TEST(Response, OfAChainIsThatOfFreeBodiesWithTheRowsOfItsJoints) {
  World<2> world = room();
  add_box(world, {0.3, 1}, 1, {0, 0}, {0, 0}, 0.3);
  add_box(world, {0.2, 1}, 2, {0.5, -0.7}, {0, 0}, -0.4);
  add_box(world, {0.2, 0.6}, 0.5, {0.2, 1}, {0, 0}, 1);
  const auto joint = [&](int a, int b, const Vec<2>& at) {
    const auto seen = [&](int body) {
      const BodyMotion<2> motion = body_motion(world.state, body);
      return End<2>{body, motion.room_from_body.transpose() * (at - motion.x)};
    };
    world.model.joints.push_back(pin(seen(a), seen(b)));
  };
  joint(0, 1, {0.3, -0.4}), joint(0, 2, {0.1, 0.6});
  const Model<2> loose = world.model;
  std::vector<BodyMotion<2>> at;
  for (int i = 0; i < 3; ++i) at.push_back(body_motion(world.state, i));
  articulate(world, {0, 1, 2});

  std::vector<Row<2>> rows = {row_of<2>(0, 1, {0.6, 0.8}, {0.1, 0.2}, {-0.3, 0.1}),
                              row_of<2>(2, -1, {0, 1}, {0.2, -0.1}, {0, 0}),
                              row_of<2>(1, 2, {1, 0}, {0, 0.5}, {0.2, 0.2})};
  Response<2> links(world.model), bodies(loose);
  for (int i = 0; i < 3; ++i) links.set(i, true), bodies.set(i, true);
  EXPECT_TRUE(links.linked(0) && !links.free(0) && bodies.free(0));

  std::vector<Row<2>> holds;
  for (const Joint<2>& pinned : loose.joints) {
    Row<2> out[kMostHeld<2>];
    double off[kMostHeld<2>];
    const int n =
        sim::rows(pinned, at[pinned.a.body], at[pinned.b.body], AngularVec<2>::Zero().eval(), out, off);
    holds.insert(holds.end(), out, out + n);
  }
  const auto free_K = [&](const Row<2>& p, const Row<2>& q) { return bodies.coupling(p, q, at); };
  Matrix JJ(holds.size(), holds.size()), JR(holds.size(), rows.size());
  for (std::size_t i = 0; i < holds.size(); ++i) {
    for (std::size_t j = 0; j < holds.size(); ++j) JJ(i, j) = free_K(holds[i], holds[j]);
    for (std::size_t j = 0; j < rows.size(); ++j) JR(i, j) = free_K(holds[i], rows[j]);
  }
  const Matrix taken = JR.transpose() * JJ.fullPivLu().solve(JR);

  Articulated<2> chains(world.model);
  chains.gather(world.state, std::vector<int>{0});
  chains.stand(world.state);
  ChainResponse<2> response;
  response.build(rows, links, chains);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(response.moves(i));
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(response.coupling(i, j), free_K(rows[i], rows[j]) - taken(i, j), 1e-13) << i << ' ' << j;
  }
}

}  // namespace
}  // namespace obscura::sim
