// [[chain]]: which links a scene makes of its bodies and joints, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "scene/error.h"
#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/model/body_motion.h"
#include "sim/multibody/chain.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/stepper.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// a trunk with two arms, the second on a slider, and a foot on a rope
const std::string kFigure = R"([[box]]
name = "trunk"
position = [3, 2]
velocity = [1, 2]
angle = 370
[[box]]
name = "arm"
size = [0.5, 0.1]
position = [3.8, 2]
velocity = [1, 2]
copies = { count = 2, offset = [-1.6, 0] }
[[ball]]
name = "foot"
position = [3, 1]
[[joint]]
type = "pin"
between = ["arm[0]", "trunk"]
at = [3.5, 2]
limits = [-30, 45]
[[joint]]
type = "slider"
between = ["trunk", "arm[1]"]
axis = [1, 0]
[[joint]]
name = "string"
type = "rope"
between = ["foot", "trunk"]
)";

std::vector<std::string> wrong_chains(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    parse(text, "a.toml", sets);
  } catch (const Error& error) {
    std::vector<std::string> lines;
    for (const Complaint& complaint : error.complaints) lines.push_back(complaint.message);
    return lines;
  }
  return {};
}

TEST(Chains, AreMadeOfBodiesAndTheirJoints) {
  const Scene it = parse(kFigure + "[[chain]]\nof = [\"arm[*]\", \"trunk\"]", "a.toml");
  const auto& model = it.plane().model;
  ASSERT_EQ(model.chains.size(), 1u);
  const auto& chain = model.chains[0];
  // balls come before boxes: the foot is 0
  EXPECT_THAT(chain.bodies, ElementsAre(2, 1, 3)) << "the first flies, and carries what is joined to it";
  EXPECT_THAT(chain.joints, ElementsAre(-1, 0, 1));
  EXPECT_EQ((*chain.tree)[0].joint.freedom, sim::JointType::free);
  EXPECT_EQ((*chain.tree)[1].joint.freedom, sim::JointType::revolute);
  EXPECT_EQ((*chain.tree)[2].joint.freedom, sim::JointType::prismatic);
  EXPECT_TRUE(model.joints[0].linked && model.joints[1].linked);
  EXPECT_FALSE(model.joints[2].linked) << "a rope is no joint of a chain";
  EXPECT_FALSE(model.bodies[0].linked);
  EXPECT_EQ(sim::solver(model), sim::Solver::direct);

  // they stand where they stood, rounds and all, and move on as they moved
  auto run = it.run();
  const auto now = std::get<sim::Snapshot>(run->at({0, 1}));
  EXPECT_DOUBLE_EQ(now.bodies[1].angle, 370 * std::numbers::pi / 180);
  for (int i = 0; i < 4; ++i) {
    EXPECT_LE((now.bodies[i].position - Eigen::Vector3d(i == 2   ? 3.8
                                                        : i == 3 ? 2.2
                                                                 : 3,
                                                        i == 0 ? 1 : 2, 0))
                  .norm(),
              1e-15 * 4);
    if (i > 0) {
      EXPECT_LE((now.bodies[i].velocity - Eigen::Vector3d(1, 2, 0)).norm(), 1e-14);
    }
  }
}

TEST(Chains, WhatIsJoinedToTheRoomHangsThere) {
  const Scene it = parse(kFigure +
                             "[[joint]]\ntype = \"pin\"\nbetween = [\"arm[1]\", \"room\"]\nat = [2, 2]\n"
                             "[[chain]]\nof = [\"trunk\", \"arm[*]\"]",
                         "a.toml");
  const auto& chain = it.plane().model.chains[0];
  EXPECT_THAT(chain.bodies, ElementsAre(3, 1, 2));
  EXPECT_THAT(chain.joints, ElementsAre(3, 1, 0));
  EXPECT_EQ(chain.tree->velocities(), 3);
}

TEST(Chains, PinsOfSpaceAreBalls) {
  const Scene it = parse(R"([room]
size = [4, 4, 4]
[[box]]
name = "a"
position = [0, 2, 0]
[[capsule]]
name = "b"
position = [1, 2, 0]
[[joint]]
type = "ball"
between = ["a", "b"]
at = [0.6, 2, 0]
[[chain]]
of = ["a", "b"]
)",
                         "a.toml");
  const auto& chain = it.space().model.chains[0];
  EXPECT_EQ((*chain.tree)[1].joint.freedom, sim::JointType::ball);
  EXPECT_EQ(chain.tree->velocities(), 9);
}

TEST(Chains, RefuseWhatTheyCannotHold) {
  const std::string of = "[[chain]]\nof = [\"trunk\", \"arm[*]\"]\n";
  EXPECT_THAT(wrong_chains(kFigure + of), IsEmpty());
  EXPECT_THAT(wrong_chains(kFigure + of, {"arm[0].fixed=true"}), ElementsAre(HasSubstr("'arm[0]' is fixed")));
  EXPECT_THAT(wrong_chains(kFigure + of, {"trunk.rotation=false"}),
              testing::Contains(HasSubstr("does not turn")));
  EXPECT_THAT(wrong_chains(kFigure + of + of), testing::Contains("'trunk' is a link of another chain"));
  EXPECT_THAT(wrong_chains(kFigure + of, {"joint[0].breaks=5"}), ElementsAre(HasSubstr("'joint[0]' breaks")));
  EXPECT_THAT(wrong_chains(kFigure + of, {"string.breaks=5"}), IsEmpty());
  EXPECT_THAT(wrong_chains(kFigure + "[[chain]]\nof = [\"trunk\", \"foot\"]"),
              ElementsAre(HasSubstr("joins any of these")));
  EXPECT_THAT(wrong_chains(kFigure + of + "[[bond]]\nof = [\"trunk\", \"foot\"]\nwithin = 1"),
              ElementsAre(HasSubstr("not both yet")));
  EXPECT_THAT(wrong_chains("[[particle]]\nname = \"p\"\n[[chain]]\nof = [\"p\"]"),
              ElementsAre(HasSubstr("a link needs a [[ball]]")));
  EXPECT_THAT(wrong_chains("[[box]]\n[[chain]]\n"), ElementsAre(HasSubstr("needs 'of'")));
  EXPECT_THAT(wrong_chains("[[box]]\n[[chain]]\nof = [\"bx\"]"), ElementsAre(HasSubstr("bx")));
  EXPECT_THAT(wrong_chains(kFigure + of + "[physics]\ncollision = \"handout\""),
              testing::Contains(HasSubstr("[[chain]] is not in")));
}

// A pendulum of three arms, held to the room, and boxes far off beside it.
std::string pendulum(int boxes) {
  return R"([room]
size = [40, 8]
[[box]]
name = "arm"
size = [0.6, 0.1]
position = [2.3, 6]
copies = { count = 3, offset = [0.6, 0] }
[[joint]]
type = "pin"
between = ["arm[0]", [2, 6]]
[[joint]]
type = "pin"
between = ["arm[0]", "arm[1]"]
at = [2.6, 6]
[[joint]]
type = "pin"
between = ["arm[1]", "arm[2]"]
at = [3.2, 6]
[[chain]]
of = ["arm[*]"]
[[box]]
name = "far"
size = [0.3, 0.3]
position = [10, 0.15]
copies = { count = )" +
         std::to_string(boxes) + ", offset = [0.5, 0] }\n";
}

template <int D>
sim::State<D> after(const sim::World<D>& world, double time) {
  sim::State<D> state = world.state;
  sim::Stepper<D> stepper(world.model);
  stepper.begin(state);
  while (double(state.step) < time * sim::value(world.model.rate) - 0.5) EXPECT_FALSE(stepper.step(state));
  return state;
}

// how far the ends of a joint are from each other, m, of those that hold two points together
template <int D>
double gape(const sim::World<D>& world, const sim::State<D>& state) {
  double worst = 0;
  for (const sim::Joint<D>& joint : world.model.joints) {
    const auto place = [&](const sim::End<D>& end) -> sim::Vec<D> {
      if (end.body < 0) return end.local;
      const sim::BodyMotion<D> at = sim::body_motion(state, end.body);
      return at.x + at.room_from_body * end.local;
    };
    worst = std::max(worst, (place(joint.a) - place(joint.b)).norm());
  }
  return worst;
}

TEST(Chains, BesideManyBodiesTheirJointsHoldAsOthers) {
  const auto solver = [](const Scene& scene) { return sim::solver(scene.plane().model); };
  const Scene few = parse(pendulum(20), "a.toml"), many = parse(pendulum(21), "a.toml");
  EXPECT_EQ(few.plane().model.chains.size(), 1u);
  EXPECT_EQ(solver(few), sim::Solver::direct) << "links do not count as the bodies beside them";
  EXPECT_TRUE(many.plane().model.chains.empty());
  EXPECT_EQ(solver(many), sim::Solver::iterative);
  for (const sim::Body<2>& body : many.plane().model.bodies) EXPECT_FALSE(body.linked);
  const auto by = [](const std::string& name) {
    return parse(pendulum(1), "a.toml", {"physics.solver=" + name});
  };
  EXPECT_EQ(by("direct").plane().model.chains.size(), 1u);
  EXPECT_TRUE(by("iterative").plane().model.chains.empty());
  EXPECT_EQ(parse(pendulum(60), "a.toml", {"physics.solver=direct"}).plane().model.chains.size(), 1u);
  EXPECT_EQ(parse(pendulum(60), "a.toml", {"physics.collision=event"}).plane().model.chains.size(), 1u);
}

// the pendulum swings as in reduced coordinates, by the same scheme
TEST(Chains, BesideManyBodiesTheySwingAsAlone) {
  for (const int rate : {300, 600, 1200}) {
    const std::vector<std::string> sets = {"physics.rate=" + std::to_string(rate)};
    const sim::State<2> alone = after(parse(pendulum(1), "a.toml", sets).plane(), 0.7);
    const Scene crowd = parse(pendulum(40), "a.toml", sets);
    const sim::State<2> beside = after(crowd.plane(), 0.7);
    double off = 0;
    for (int link = 0; link < 3; ++link) off = std::max(off, (alone.x[link] - beside.x[link]).norm());
    EXPECT_LT(gape(crowd.plane(), beside), 1e-13) << rate;
    EXPECT_LT(off, 1.5e-9 * std::pow(600.0 / rate, 4)) << rate;
  }
}

// a figure falls onto a heap and lies there, in one piece
TEST(Chains, LieInPiles) {
  const Scene plane = parse(R"([room]
size = [4, 4]
[[box]]
name = "limb"
size = [0.5, 0.12]
position = [1.3, 3]
copies = { count = 4, offset = [0.5, 0] }
[[joint]]
type = "pin"
between = ["limb[0]", "limb[1]"]
at = [1.55, 3]
[[joint]]
type = "pin"
between = ["limb[1]", "limb[2]"]
at = [2.05, 3]
limits = [-60, 60]
[[joint]]
type = "pin"
between = ["limb[2]", "limb[3]"]
at = [2.55, 3]
[[chain]]
of = ["limb[*]"]
[[box]]
name = "box"
size = [0.2, 0.2]
position = [0.5, 0.2]
copies = { count = [10, 6], offset = [[0.3, 0], [0.02, 0.25]], jitter = 0.02 }
)",
                            "a.toml");
  const sim::State<2> lies = after(plane.plane(), 3);
  EXPECT_LT(gape(plane.plane(), lies), 1e-12);
  for (int limb = 0; limb < 4; ++limb) {
    EXPECT_GT(lies.x[limb].y(), 0.05) << limb;
    EXPECT_LT(lies.x[limb].y(), 2.0) << limb;
    EXPECT_LT(lies.v[limb].norm(), 0.05) << limb;
  }
}

// Velocities that joints do not allow are corrected at once, those of chains too, by the joints that close
// their loops and by those to bodies that are moved: at the start they are what they are without a chain.
TEST(Chains, BeginAsAllJointsAllow) {
  const std::string bars =
      "duration = 1\n[room]\nwalls = \"none\"\n[[box]]\nname = \"a\"\nsize = [1, 0.1]\nposition = [0, 0]\n"
      "[[box]]\nname = \"b\"\nsize = [1, 0.1]\nposition = [1, 0]\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [\"a\", \"b\"]\nat = [0.5, 0]\n";
  const std::string loop =
      bars +
      "[[box]]\nname = \"d\"\nsize = [1, 0.1]\nposition = [0.5, 0.5]\nspin = 90\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [\"a\", \"d\"]\nat = [0, 0.25]\n"
      "[[joint]]\ntype = \"rod\"\nbetween = [\"b\", { body = \"d\", local = [0.5, 0] }]\n";
  const std::string trolley =
      bars +
      "[[box]]\nname = \"t\"\nsize = [0.4, 0.2]\nposition = [-0.5, 0]\nmotion = { y = \"2*t\" }\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [\"a\", \"t\"]\nat = [-0.5, 0]\n";
  const std::pair<std::string, std::string> cases[] = {{loop, "[[chain]]\nof = [\"a\", \"b\", \"d\"]\n"},
                                                       {trolley, "[[chain]]\nof = [\"a\", \"b\"]\n"}};
  for (const auto& [bodies, chain] : cases) {
    const TextRun with(bodies + chain), without(bodies);
    for (const double t : {0.0, 0.3}) {
      const sim::Snapshot one = with.at(t), other = without.at(t);
      for (std::size_t i = 0; i < one.bodies.size(); ++i) {
        const double near = t == 0 ? 1e-14 : 1e-9;
        EXPECT_LT((one.bodies[i].velocity - other.bodies[i].velocity).norm(), near) << t << " " << i;
        EXPECT_LT((one.bodies[i].spin - other.bodies[i].spin).norm(), 10 * near) << t << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene
