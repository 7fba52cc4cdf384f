#include "sim/shape/submerged.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/math/orientation.h"
#include "sim/shape/shape.h"

namespace obscura::sim {
namespace {

template <int D>
BodyMotion<D> standing(const Vec<D>& x, const Orientation<D>& turn) {
  BodyMotion<D> at;
  at.x = x, at.room_from_body = rotation<D>(turn);
  return at;
}

template <int D>
struct Floating {
  const char* name;
  Shape<D> shape;
};

std::vector<Floating<2>> plane() {
  return {{"ball", Ball<2>{0.7, {0.1, 0.2}}},
          {"box", Box<2>{{0.5, 0.3}}},
          {"polygon", Polygon{{{-0.5, -0.4}, {0.6, -0.3}, {0.4, 0.5}, {-0.2, 0.6}}}},
          {"compound", Compound<2>{{Ball<2>{0.3, {0.9, 0}}, Box<2>{{0.5, 0.1}}}}}};
}

std::vector<Floating<3>> space() {
  Hull wedge;
  wedge.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0.8, 0}, {0, 0, 1.2}};
  wedge.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return {{"ball", Ball<3>{0.7, {0.1, 0.2, -0.1}}},
          {"box", Box<3>{{0.5, 0.3, 0.2}, {0.1, 0, 0.2}, exponential(Vec3(0.3, -0.5, 0.7))}},
          {"capsule", Capsule{0.4, 0.25, {0.1, 0.05, 0}, exponential(Vec3(0.2, 0.1, 0.4))}},
          {"hull", wedge},
          {"compound", Compound<3>{{Ball<3>{0.3, {0.9, 0, 0}}, Box<3>{{0.5, 0.1, 0.1}}}}}};
}

// the pressure's work: d(rho g A (level - c_y))/dy = -rho g A, and its turning moment likewise
template <int D>
void derives(const Floating<D>& one, const Vec<D>& x, const Orientation<D>& turn, double level) {
  const auto held = [&](const Vec<D>& at, const Orientation<D>& turned) {
    const Displaced<D> wet = displaced(one.shape, standing<D>(at, turned), level);
    return wet.content * (level - wet.center[1]);
  };
  const Displaced<D> wet = displaced(one.shape, standing<D>(x, turn), level);
  const double h = 1e-5;
  const Vec<D> up = Vec<D>::Unit(1) * h;
  EXPECT_NEAR((held(x + up, turn) - held(x - up, turn)) / (2 * h), -wet.content, 1e-8) << one.name;
  for (int axis = 0; axis < kAngular<D>; ++axis) {
    const AngularVec<D> by = AngularVec<D>::Unit(axis) * h;
    const double slope =
        (held(x, turned<D>(turn, by)) - held(x, turned<D>(turn, AngularVec<D>(-by)))) / (2 * h);
    const AngularVec<D> torque = moment<D>(Vec<D>(wet.center - x), Vec<D>(Vec<D>::Unit(1) * wet.content));
    EXPECT_NEAR(slope, -torque[axis], 1e-8) << one.name << " about " << axis;
  }
}

TEST(Displaced, AboveNothingAndBelowAll) {
  for (const Floating<2>& one : plane()) {
    const MassProperties<2> whole = mass_properties(one.shape);
    const BodyMotion<2> at = standing<2>({3, 5}, Orientation<2>(0.8));
    EXPECT_EQ(displaced(one.shape, at, 1).content, 0) << one.name;
    const Displaced<2> wet = displaced(one.shape, at, 9);
    EXPECT_NEAR(wet.content, whole.content, 1e-14) << one.name;
    EXPECT_NEAR((wet.center - (at.x + at.arm(whole.center))).norm(), 0, 1e-14) << one.name;
  }
  for (const Floating<3>& one : space()) {
    const MassProperties<3> whole = mass_properties(one.shape);
    const BodyMotion<3> at = standing<3>({3, 5, 1}, exponential(Vec3(0.8, 0.3, -1)));
    EXPECT_EQ(displaced(one.shape, at, 1).content, 0) << one.name;
    const Displaced<3> wet = displaced(one.shape, at, 9);
    EXPECT_NEAR(wet.content, whole.content, 1e-13) << one.name;
    EXPECT_NEAR((wet.center - (at.x + at.arm(whole.center))).norm(), 0, 1e-13) << one.name;
  }
  EXPECT_EQ(displaced<2>(Point<2>{}, standing<2>({0, 0}, no_rotation<2>()), 1).content, 0);
}

TEST(Displaced, IsTheSlopeOfTheWorkAgainstThePressure) {
  for (const double level : {-0.3, 0.05, 0.2, 0.41}) {
    for (const double angle : {0.1, 0.9, 2.2}) {
      for (const Floating<2>& one : plane()) derives<2>(one, {0.3, 0.1}, Orientation<2>(angle), level);
      for (const Floating<3>& one : space())
        derives<3>(one, {0.3, 0.1, 0.2}, exponential(angle * Vec3(0.6, 0.64, 0.48)), level);
    }
  }
}

// a capsule that stands or lies, in closed form
TEST(Displaced, OfAnUprightAndALyingCapsule) {
  const Capsule rod{0.5, 0.2};
  const double cap = 2.0 / 3 * M_PI * 0.008, slice = M_PI * 0.04;
  EXPECT_NEAR(displaced<3>(rod, standing<3>(Vec3::Zero(), no_rotation<3>()), 0.1).content, cap + slice * 0.6,
              1e-14);
  const Displaced<3> lying =
      displaced<3>(rod, standing<3>(Vec3::Zero(), exponential(Vec3(0, 0, M_PI / 2))), 0.05);
  const double disc = 0.04 * std::acos(-0.25) + 0.05 * std::sqrt(0.04 - 0.0025);
  const double ball = M_PI * 0.25 * 0.25 * (0.4 - 0.05) / 3;
  EXPECT_NEAR(lying.content, disc * 1.0 + ball, 1e-13);
  EXPECT_NEAR(displaced<3>(rod, standing<3>(Vec3::Zero(), no_rotation<3>()), 0.6).content,
              cap + slice + M_PI * (0.2 * 0.2 * 0.1 - 0.001 / 3), 1e-13);
}

}  // namespace
}  // namespace obscura::sim
