// How many substeps a step has.

#include "sim/solve/iterate/substeps.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "sim/touching.h"

namespace obscura::sim {
namespace {

// 1 to 20 widths a second, whatever their order
std::vector<double> twenty_rates() {
  std::vector<double> rates(20);
  std::iota(rates.begin(), rates.end(), 1.0);
  std::swap(rates[3], rates[19]), std::swap(rates[0], rates[11]);
  return rates;
}

double ruling(std::vector<double> rates, std::size_t contacts) { return ruling_rate(rates, contacts); }

TEST(Substeps, FollowTheFastestOfFewContacts) {
  EXPECT_EQ(ruling(twenty_rates(), 20), 20);
  EXPECT_EQ(ruling(twenty_rates(), 199), 20);
  EXPECT_EQ(ruling({}, 1000), 0);
}

// one in two hundred may be up to twice as fast
TEST(Substeps, LetFewOfManyContactsCloseTwiceAsFast) {
  EXPECT_EQ(ruling(twenty_rates(), 1000), 15);  // five of them
  EXPECT_EQ(ruling(twenty_rates(), 3000), 10);  // fifteen are faster than 5, and the first of them four times
  EXPECT_EQ(ruling(twenty_rates(), 4000), 10);  // all of them
}

// no pair comes nearer by more than a fortieth of its width, between 240 and 4,800 a second
TEST(Substeps, DivideAStepByHowFastPairsClose) {
  EXPECT_EQ(substeps_for(0, 1.0 / 60), 4);
  EXPECT_EQ(substeps_for(0, 1.0 / 600), 1);
  EXPECT_EQ(substeps_for(60, 1.0 / 60), 40);
  EXPECT_EQ(substeps_for(1e9, 1.0 / 60), 80);
}

// in a substep nothing falls farther than a fiftieth of the narrowest width
TEST(Substeps, AreAsManyAsTinyBodiesNeedToLieAtRest) {
  World<2> world = touching_room();
  EXPECT_EQ(resting_substeps(world.model), 240);
  add_ball(world, 0.05, 1, {1, 1});
  EXPECT_EQ(resting_substeps(world.model), 240);
  add_ball(world, 5e-5, 1, {2, 1});
  const double fewest = resting_substeps(world.model);
  EXPECT_NEAR(9.81 / (fewest * fewest), 1e-4 / 50, 1e-12);
  EXPECT_EQ(substeps_for(0, 1.0 / 60, fewest), 37);
  // of many, a few do not rule
  for (int i = 0; i < 200; ++i) add_ball(world, 0.05, 1, {1, 1});
  EXPECT_EQ(resting_substeps(world.model), 240);
}

}  // namespace
}  // namespace obscura::sim
