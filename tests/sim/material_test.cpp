// One mixing rule for what touches, in every solver and in the snapshot.

#include "sim/constraint/material.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/rooms.h"

namespace obscura::sim {
namespace {

TEST(Material, OfAPairIsTheRootOfTheProduct) {
  const Material rubber(0.9, 0.8), ice(0.1, 0.2);
  const Material pair = mixed(rubber, ice);
  EXPECT_EQ(pair.friction, std::sqrt(0.9 * 0.1));
  EXPECT_EQ(pair.elasticity, std::sqrt(0.8 * 0.2));
  EXPECT_EQ(mixed(ice, rubber).friction, pair.friction);
  EXPECT_EQ(mixed(rubber, Material(0, 0)).friction, 0);
}

// 1e-200 squared is out of range, as is 1e200
TEST(Material, OfTwoAlikeIsTheirs) {
  for (const double mu : {0.3, 0.1, 1e-200, 1e200}) EXPECT_EQ(mixed(mu, mu), mu);
}

TEST(Material, OfAWallWithNoneIsTheBodys) {
  Wall<2> wall;
  wall.elasticity = 0.5;
  const Material pair = mixed(Material(0.3, 0.2), wall);
  EXPECT_EQ(pair.friction, 0.3);
  EXPECT_EQ(pair.elasticity, std::sqrt(0.2 * 0.5));
}

TEST(Material, IsOfTheBodyOrWallThatAKeyNames) {
  World<2> world = room();
  for (const double mu : {0.2, 0.8}) {
    const int body = add_particle(world, {0, 0});
    world.model.bodies[body].friction = mu;
  }
  add_wall(world, {0, 0}, {0, 1}), add_wall(world, {0, 0}, {1, 0});
  world.model.walls[1].friction = 0.4;
  EXPECT_EQ(material(world.model, 0, 1).friction, std::sqrt(0.2 * 0.8));
  EXPECT_EQ(material(world.model, 1, -1).friction, 0.8);
  EXPECT_EQ(material(world.model, 1, -2).friction, std::sqrt(0.8 * 0.4));
}

}  // namespace
}  // namespace obscura::sim
