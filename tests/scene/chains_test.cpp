// [[chain]]: which links a scene makes of its bodies and joints, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "scene/error.h"
#include "scene/scene.h"
#include "sim/multibody/chain.h"
#include "sim/solve/contact_solver.h"

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

std::vector<std::string> wrong(const std::string& text, const std::vector<std::string>& sets = {}) {
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
  EXPECT_THAT(wrong(kFigure + of), IsEmpty());
  EXPECT_THAT(wrong(kFigure + of, {"arm[0].fixed=true"}), ElementsAre(HasSubstr("'arm[0]' is fixed")));
  EXPECT_THAT(wrong(kFigure + of, {"trunk.rotation=false"}), testing::Contains(HasSubstr("does not turn")));
  EXPECT_THAT(wrong(kFigure + of + of), testing::Contains("'trunk' is a link of another chain"));
  EXPECT_THAT(wrong(kFigure + of, {"joint[0].breaks=5"}), ElementsAre(HasSubstr("'joint[0]' breaks")));
  EXPECT_THAT(wrong(kFigure + of, {"string.breaks=5"}), IsEmpty());
  EXPECT_THAT(wrong(kFigure + of, {"physics.solver=iterative"}), ElementsAre(HasSubstr("direct solver's")));
  EXPECT_THAT(wrong(kFigure + "[[chain]]\nof = [\"trunk\", \"foot\"]"),
              ElementsAre(HasSubstr("joins any of these")));
  EXPECT_THAT(wrong(kFigure + of + "[[bond]]\nof = [\"trunk\", \"foot\"]\nwithin = 1"),
              ElementsAre(HasSubstr("not both yet")));
  EXPECT_THAT(wrong("[[particle]]\nname = \"p\"\n[[chain]]\nof = [\"p\"]"),
              ElementsAre(HasSubstr("a link needs a [[ball]]")));
  EXPECT_THAT(wrong("[[box]]\n[[chain]]\n"), ElementsAre(HasSubstr("needs 'of'")));
  EXPECT_THAT(wrong("[[box]]\n[[chain]]\nof = [\"bx\"]"), ElementsAre(HasSubstr("bx")));
  EXPECT_THAT(wrong(kFigure + of + "[physics]\ncollision = \"handout\""),
              testing::Contains(HasSubstr("[[chain]] is not in")));
}

}  // namespace
}  // namespace obscura::scene
