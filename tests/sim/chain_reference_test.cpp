// Chains against the tables of tests/reference, stepped by classical Runge-Kutta.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "chain_cases.h"
#include "reference.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

double number(const nlohmann::json& text) { return std::stod(text.get<std::string>()); }

Vec3 vec3(const nlohmann::json& list) { return {number(list[0]), number(list[1]), number(list[2])}; }

std::vector<double> numbers(const nlohmann::json& list) {
  std::vector<double> out;
  for (const auto& x : list) out.push_back(number(x));
  return out;
}

nlohmann::json six_joint_tree() {
  auto file = open_reference("articulated_tree_6dof.json");
  return nlohmann::json::parse(file);
}

Swinging<3> tree_of(const nlohmann::json& from) {
  std::vector<Link<3>> links(6);
  for (int i = 0; i < 6; ++i) {
    links[i].parent = from["parent"][i];
    links[i].joint.axis = vec3(from["axes"][i]);
    links[i].joint.on_parent.place = vec3(from["porg"][i]);
    links[i].mass = number(from["mass"][i]);
    links[i].com = vec3(from["com"][i]);
    for (int k = 0; k < 3; ++k) links[i].inertia.row(k) = vec3(from["Ic"][i][k]);
  }
  Swinging<3> tree{Chain<3>(links)};
  tree.q = numbers(from["q"]);
  tree.v = numbers(from["qd"]);
  tree.refresh();
  return tree;
}

TEST(ChainReference, SixJointTreeHasItsMassMatrixAndForces) {
  const auto from = six_joint_tree();
  Swinging<3> tree = tree_of(from);
  const Eigen::MatrixXd m = tree.mass();
  // a few roundings of sums up to 2 and to 20
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(m(j, k), number(from["M"][j][k]), 2e-15);
  }
  const std::vector<double> still(6);
  std::vector<double> h(6);
  inverse<3>(tree.chain, tree.stance, tree.v, still, tree.gravity, tree.dynamics, h);
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(h[j], number(from["h"][j]), 2e-14);
  const auto sums = tree.sums();
  EXPECT_NEAR(sums.kinetic + sums.potential, number(from["total_energy"]), 4e-14);
}

TEST(ChainReference, SixJointTreeAccelerates) {
  const auto from = six_joint_tree();
  Swinging<3> tree = tree_of(from);
  tree.tau = numbers(from["tau"]);
  const std::vector<double> rate = tree.rate();
  // relative to the largest, 61 rad/s^2; M's condition is some hundreds
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(rate[j], number(from["qdd"][j]), 1e-12);
}

// The largest error against the free swing at 0.1, 0.5 and 1 s, at so many steps a second.
std::vector<double> free_swing_errors(int rate) {
  const auto from = six_joint_tree();
  Swinging<3> tree = tree_of(from);
  std::vector<double> errors;
  int done = 0;
  for (int row = 0; row < 3; ++row) {
    const auto& swing = from["free_swing_tau0"];
    const int until = int(std::lround(rate * number(swing["t"][row])));
    for (; done < until; ++done) tree.step(1.0 / rate);
    double worst = 0;
    for (int j = 0; j < 6; ++j) {
      worst = std::max(worst, std::abs(tree.q[j] - number(swing["state"][row][j])));
      worst = std::max(worst, std::abs(tree.v[j] - number(swing["state"][row][6 + j])));
    }
    errors.push_back(worst);
  }
  return errors;
}

TEST(ChainReference, SixJointTreeSwingsFreely) {
  const std::vector<double> coarse = free_swing_errors(2000), fine = free_swing_errors(4000);
  for (int row = 0; row < 3; ++row) {
    // Runge-Kutta's own error: 5e-11 at 1 s and 1/4000 s, sixteen times that at twice the step
    EXPECT_LE(fine[row], 1e-10);
    EXPECT_NEAR(coarse[row] / fine[row], 16, 1);
  }
}

TEST(ChainReference, FreeTopFlips) {
  std::vector<Link<3>> links(1);
  links[0].joint.freedom = JointType::free;
  links[0].inertia.diagonal() << 1, 2, 3;
  Swinging<3> top{Chain<3>(links)};
  top.gravity.setZero();
  top.v = {0.01, 5, 0.02, 0, 0, 0};  // the body's axes are the room's at the start
  int done = 0;
  // to 10 s: at 20 s a step of 1 ms ends 1.2e-9 from the table, a little more than its bar in space asks
  for (const auto& row : table("dzhanibekov_free_top.csv")) {
    if (row[0] > 10) break;
    const int until = int(std::lround(row[0] * 1000));
    for (; done < until; ++done) top.step(1e-3);
    top.refresh();
    const Vec3 w = top.stance.joint[0].turn.transpose() * top.stance.twist[0].w;
    const Eigen::Vector4d q = {top.q[0], top.q[1], top.q[2], top.q[3]},
                          want = {row[5], row[6], row[7], row[4]};
    const double apart = std::min((q - want).norm(), (q + want).norm());  // q and -q are one turn
    EXPECT_LE((w - Vec3(row[1], row[2], row[3])).norm(), 1e-9) << row[0];
    EXPECT_LE(apart, 1e-9) << row[0];
  }
}

// Four times from the turning point to the lowest, found by Newton's method in the last step.
template <int D>
double period(Swinging<D> swing, double amplitude) {
  swing.q[0] = amplitude;
  const double h = 1.0 / 2000;
  double t = 0;
  Swinging<D> before = swing;
  while (swing.q[0] > 0) {
    before = swing;
    swing.step(h);
    t += h;
  }
  double part = h;
  for (int pass = 0; pass < 4; ++pass) {
    swing = before;
    swing.step(part);
    part -= swing.q[0] / swing.v[0];
  }
  return 4 * (t - h + part);
}

TEST(ChainReference, PendulumsHaveTheirPeriods) {
  for (const int degrees : {1, 10, 30, 60, 90, 120, 150, 170, 179}) {
    const std::string amplitude = "amplitude=" + std::to_string(degrees) + " deg";
    const double point = closed_form({"simple_pendulum_period", amplitude})[0];
    const double rod = closed_form({"rod_pendulum_period", amplitude})[0];
    // RK4's error at 1/2000 s
    EXPECT_NEAR(period(Swinging<2>(Chain<2>(pendulum(1, 1, 1, false))), degrees * kDegree), point,
                2e-11 * point);
    EXPECT_NEAR(period(Swinging<2>(Chain<2>(pendulum(1, 1, 1, true))), degrees * kDegree), rod, 2e-11 * rod);
    Swinging<3> deep(Chain<3>(in_space(pendulum(1, 1, 1, true), false)));
    deep.gravity = {0, -9.81, 0};
    EXPECT_NEAR(period(deep, degrees * kDegree), rod, 2e-11 * rod);
  }
}

}  // namespace
}  // namespace obscura::sim
