// Ways of points of bodies against closed forms: between two samples far apart they are as round as the
// motion.

#include "draw/picture/way.h"

#include <gtest/gtest.h>

#include <cmath>

namespace obscura::draw {
namespace {

using sim::Vec3;

/// A wheel of radius r that rolls to the right with the spin w, sampled every `dt`.
std::vector<sim::Track::Point> rolling(double r, double w, double dt, double until) {
  std::vector<sim::Track::Point> track;
  for (double t = 0; t < until; t += dt)
    track.push_back({t,
                     {r * w * t, r, 0},
                     Eigen::Quaterniond(Eigen::AngleAxisd(-w * t, Vec3::UnitZ())),
                     {r * w, 0, 0},
                     {0, 0, -w},
                     true});
  return track;
}

TEST(Way, OfARimThatRollsIsACycloid) {
  const double r = 0.5, tolerance = 1e-3;
  // less than a radian a sample, and more than a turn
  for (const double w : {90.0, 1000.0}) {
    const auto way = refined(rolling(r, w, 1.0 / 120, 0.2), {0, -r, 0}, tolerance);
    double low = 1, sharpest = 1;
    for (std::size_t k = 0; k + 1 < way.size(); ++k) {
      const auto cycloid = [&](double t) {
        return Vec3(r * (w * t - std::sin(w * t)), r * (1 - std::cos(w * t)), 0);
      };
      EXPECT_LT((way[k].place - cycloid(way[k].time)).norm(), 1e-9);
      const double middle = (way[k].time + way[k + 1].time) / 2;
      EXPECT_LT(((way[k].place + way[k + 1].place) / 2 - cycloid(middle)).norm(), 1.1 * tolerance);
      if (k == 0) continue;
      low = std::min(low, way[k].place.y());
      const Vec3 in = way[k].place - way[k - 1].place, out = way[k + 1].place - way[k].place;
      // away from the ground nothing turns sharply, a cusp does
      if (way[k].place.y() > 0.2 * r)
        EXPECT_GT(in.dot(out), 0.9 * in.norm() * out.norm());
      else
        sharpest = std::min(sharpest, in.dot(out) / (in.norm() * out.norm()));
    }
    EXPECT_LT(low, tolerance);
    EXPECT_LT(sharpest, 0);
  }
}

/// A body that goes round a circle, and turns about an axis aslant, at a growing rate: the cubic and the
/// turn.
TEST(Way, InSpaceFollowsTheMotion) {
  const Vec3 axis = Vec3(1, 2, -0.5).normalized(), local(0.1, 0.2, 0.3);
  const auto angle = [](double t) { return 20 * t + 30 * t * t; };
  const auto centre = [&](double t) { return Vec3(std::cos(angle(t)), std::sin(angle(t)), t); };
  const auto turn = [&](double t) { return Eigen::Quaterniond(Eigen::AngleAxisd(3 * angle(t), axis)); };
  std::vector<sim::Track::Point> track;
  for (int k = 0; k <= 60; ++k) {
    const double t = k / 120.0, rate = 20 + 60 * t;
    const Vec3 velocity = rate * Vec3(-std::sin(angle(t)), std::cos(angle(t)), 0) + Vec3::UnitZ();
    track.push_back({t, centre(t), turn(t), velocity, 3 * rate * axis, true});
  }
  const auto way = refined(track, local, 1e-3);
  EXPECT_GT(way.size(), 3 * track.size());
  for (const auto& p : way)
    EXPECT_LT((p.place - centre(p.time) - turn(p.time) * local).norm(), 2e-3) << p.time;
}

TEST(Way, HasTheCornerOfABounceBetweenTwoSamples) {
  // it falls at 3 m/s, meets the ground a third of the piece later, and rises at 2 m/s
  const double dt = 1.0 / 120, met = dt / 3;
  const std::vector<sim::Track::Point> track{
      {0, {0, 3 * met, 0}, Eigen::Quaterniond::Identity(), {1, -3, 0}, Vec3::Zero(), true},
      {dt, {dt, 2 * (dt - met), 0}, Eigen::Quaterniond::Identity(), {1, 2, 0}, Vec3::Zero(), false}};
  const auto way = refined(track, Vec3::Zero(), 1e-4);
  ASSERT_EQ(way.size(), 3u);
  EXPECT_NEAR(way[1].time, met, 1e-12);
  EXPECT_LT((way[1].place - Vec3(met, 0, 0)).norm(), 1e-12);
}

TEST(Way, WithoutVelocitiesIsThePointsThemselves) {
  std::vector<sim::Track::Point> track = rolling(0.5, 90, 1.0 / 120, 0.1);
  for (auto& p : track) p.velocity = p.spin = Vec3::Zero(), p.smooth = false;
  const auto way = refined(track, {0, -0.5, 0}, 1e-3);
  ASSERT_EQ(way.size(), track.size());
  for (std::size_t k = 0; k < way.size(); ++k)
    EXPECT_EQ(way[k].place, Vec3(track[k].place + track[k].orientation * Vec3(0, -0.5, 0)));
}

}  // namespace
}  // namespace obscura::draw
