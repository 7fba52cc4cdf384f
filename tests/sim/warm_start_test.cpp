// What iterations begin with.

#include "sim/solve/iterate/warm_start.h"

#include <gtest/gtest.h>

namespace obscura::sim {
namespace {

// two discs that fall, one with twice the mass
struct Falling {
  Model<2> model;
  std::vector<MovingBody<2>> bodies;

  Falling() {
    for (const double mass : {1.0, 2.0}) {
      Body<2> body;
      body.shape = Ball<2>{0.5}, body.mass = mass, body.inertia[0] = mass / 8;
      model.bodies.push_back(body), bodies.push_back({0, -1, 0, 1 / mass});
    }
    bodies.push_back({});
  }
  // forces change the velocity of each
  void push(double by) {
    for (int i : {0, 1}) bodies[std::size_t(i)].y += by;
  }
  bool moderate(WarmStart<2>& warm, bool joined, int exempt = -1) {
    return warm.moderate(
        bodies,
        [&](auto&& act) {
          if (joined) act(0, 1);
          act(0, 2), act(1, 2);
        },
        [&](int body) { return body == exempt; }, [](int) { return Rotation<2>(Rotation<2>::Identity()); });
  }
};

TEST(WarmStart, KeepsForcesThatGiveNoEnergy) {
  for (const double by : {0.5, 1.0, 1.9}) {
    Falling it;
    WarmStart<2> warm(it.model);
    warm.begin(it.bodies), it.push(by);
    EXPECT_EQ(warm.gave(it.bodies, {0.5, 0.5}), false) << by;
    EXPECT_FALSE(it.moderate(warm, true)) << by;
    EXPECT_EQ(it.bodies[0].y, by - 1);
  }
}

TEST(WarmStart, TakesOfABlowWhatStopsTheIsland) {
  Falling it;
  WarmStart<2> warm(it.model);
  warm.begin(it.bodies), it.push(20);
  EXPECT_TRUE(warm.gave(it.bodies, {0.5, 0.5}));
  EXPECT_TRUE(it.moderate(warm, true));
  EXPECT_NEAR(warm.share(0), 0.05, 1e-15);
  EXPECT_NEAR(it.bodies[0].y, 0, 1e-15);
  EXPECT_NEAR(it.bodies[1].y, 0, 1e-15);
}

// that one gains what another loses is the way of contacts; each island alone
TEST(WarmStart, LooksAtIslandsAndNotAtBodies) {
  for (const bool joined : {true, false}) {
    Falling it;
    WarmStart<2> warm(it.model);
    warm.begin(it.bodies), it.bodies[0].y += 2.5, it.bodies[1].y += 1;
    EXPECT_EQ(it.moderate(warm, joined), !joined);
    EXPECT_NEAR(it.bodies[0].y, joined ? 1.5 : 0, 1e-15);
    EXPECT_NEAR(it.bodies[1].y, 0, 1e-15);
  }
}

TEST(WarmStart, LeavesOutWhatMayGiveEnergy) {
  for (const int exempt : {0, 1}) {
    Falling it;
    WarmStart<2> warm(it.model);
    warm.begin(it.bodies), it.push(20);
    EXPECT_FALSE(it.moderate(warm, true, exempt));
    EXPECT_EQ(it.bodies[0].y, 19);
  }
}

}  // namespace
}  // namespace obscura::sim
