#include "draw/picture/slider_rail.h"

#include <gtest/gtest.h>

#include <cmath>

namespace obscura::draw {
namespace {

// A wheel's hub slides up and down in a car of 1.6 by 0.3 m, at a corner of it: the rail goes from the hub to
// the top of the car, however the car is turned, and to its limits where it has some.
TEST(SliderRail, OfTwoBodiesThatMoveEndsWithThem) {
  for (const double angle : {0.0, 0.7}) {
    sim::SceneInfo cast;
    sim::Snapshot now;
    sim::SceneInfo::Body car, hub;
    car.kind = sim::ShapeKind::box, car.half = {0.8, 0.15, 0.2}, car.turns = true;
    hub.kind = sim::ShapeKind::ball, hub.radius = 0.05;
    cast.bodies = {car, hub}, now.bodies.resize(2);
    now.bodies[0].orientation = Eigen::AngleAxisd(angle, sim::Vec3::UnitZ());
    now.bodies[0].position = {3, 0.9, 0};
    const auto in_car = [&](double x, double y) {
      return sim::Vec3(now.bodies[0].position + now.bodies[0].orientation * sim::Vec3(x, y, 0));
    };
    sim::SceneInfo::Joint slider;
    slider.kind = sim::JointKind::slider, slider.a = 1, slider.b = 0, slider.axis = sim::Vec3::UnitY();
    cast.joints = {slider}, now.joints.resize(1);
    now.joints[0].b = in_car(-0.6, -0.4), now.joints[0].a = in_car(-0.6, -0.45);
    SliderRail rail = slider_rail(cast, now, 0);
    EXPECT_NEAR(rail.from, -0.05, 1e-12);
    EXPECT_NEAR(rail.to, 0.4 + 0.15, 1e-12);

    cast.joints[0].upper = 0.1;
    EXPECT_EQ(slider_rail(cast, now, 0).to, 0.1);
    cast.joints[0].lower = -0.2;
    EXPECT_EQ(slider_rail(cast, now, 0).from, -0.2);

    // of the room, or what is fixed, it has no end
    cast.joints[0].upper = 1e300, cast.bodies[0].fixed = true;
    EXPECT_TRUE(std::isinf(slider_rail(cast, now, 0).to));
    cast.joints[0].b = -1;
    EXPECT_TRUE(std::isinf(slider_rail(cast, now, 0).to));
  }
}

}  // namespace
}  // namespace obscura::draw
