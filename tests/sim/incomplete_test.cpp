// A world that is not whole is an error with a name, not a crash.

#include "sim/model/incomplete.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <variant>

#include "sim/step/run.h"

namespace obscura::sim {
namespace {

template <int D>
World<D> whole() {
  World<D> world;
  Body<D> point, box;
  point.name = "point", box.name = "box";
  box.inertia.setOnes();
  world.model.bodies = {point, box};
  world.state.x.assign(2, Vec<D>::Zero()), world.state.v.assign(2, Vec<D>::Zero());
  world.state.turn.assign(1, no_rotation<D>()), world.state.spin.assign(1, AngularVec<D>::Zero());
  return world;
}

template <int D>
void each_lack_has_its_name() {
  struct Case {
    void (*harm)(World<D>&);
    const char *quantity, *body;
  };
  const Case cases[] = {
      {[](World<D>& w) { w.state.v.clear(); }, "velocity", "point"},
      {[](World<D>& w) { w.state.v.pop_back(); }, "velocity", "box"},
      {[](World<D>& w) { w.state.x.clear(); }, "position", "point"},
      {[](World<D>& w) { w.state.turn.clear(); }, "orientation", "box"},
      {[](World<D>& w) { w.state.spin.clear(); }, "spin", "box"},
      {[](World<D>& w) { w.state.v[1][0] = std::numeric_limits<double>::quiet_NaN(); }, "velocity", "box"},
      {[](World<D>& w) { w.state.x.push_back(w.state.x[0]); }, "position", "the world"},
      {[](World<D>& w) { w.model.bodies[1].mass = 0; }, "mass", "box"},
      {[](World<D>& w) { std::swap(w.model.bodies[0], w.model.bodies[1]); }, "place in the list", "point"},
      {[](World<D>& w) {
         w.model.rate = {0, 1};
       },
       "rate", "the world"},
      {[](World<D>& w) { w.model.springs.resize(1), w.model.springs[0].a.body = 7; }, "spring", "the world"},
  };
  for (const Case& each : cases) {
    World<D> world = whole<D>();
    EXPECT_FALSE(incomplete(world)) << each.quantity;
    each.harm(world);
    const auto lack = incomplete(world);
    ASSERT_TRUE(lack) << each.quantity;
    EXPECT_EQ(lack->quantity, each.quantity);
    EXPECT_EQ(lack->body, each.body) << each.quantity;
    // a run of it says so at every instant
    const auto run = sim::run(world);
    ASSERT_TRUE(run);
    EXPECT_EQ(std::get<Trouble>(run->at({1, 10})).quantity, each.quantity);
    EXPECT_EQ(std::get<Trouble>(run->go(3)).quantity, each.quantity);
  }
}

TEST(Incomplete, EachLackOfAWorldOfThePlaneHasItsName) { each_lack_has_its_name<2>(); }
TEST(Incomplete, EachLackOfAWorldOfSpaceHasItsName) { each_lack_has_its_name<3>(); }

}  // namespace
}  // namespace obscura::sim
