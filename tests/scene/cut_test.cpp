// A run cut in two equals the run in one, bit for bit: every shipped scene is stopped at some step, saved,
// loaded into a run of its own, and both go on. Contacts, joints, hands, explosions, bonds and what sleeps
// are all among them.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>

#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/energy/energy.h"
#include "sim/force/explosion.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/stepper.h"
#include "where.h"

namespace obscura::scene {
namespace {

class EveryScene : public ::testing::TestWithParam<std::string> {};

constexpr std::size_t kCrowd = 200;  // bodies: of more, runs are shorter, that none takes half a minute

TEST_P(EveryScene, CutInTwoIsTheSame) {
  const Scene scene = read(GetParam());
  const auto one = scene.run();
  const sim::Rational rate = one->rate();
  const bool crowd = one->scene_info().bodies.size() > kCrowd;
  // neither on a frame nor where solvers look about themselves; of a crowd that has fallen for half a second
  using Steps = std::vector<std::int64_t>;
  for (const std::int64_t cut : crowd ? Steps{1, 307} : Steps{1, 143, 331, 707}) {
    ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(one->at(sim::rational(cut) / rate)));
    const std::vector<std::uint64_t> saved = one->saved();
    const auto other = scene.run(saved);
    ASSERT_TRUE(other) << "step " << cut;
    EXPECT_EQ(other->saved(), saved);
    const sim::Rational later = sim::rational(cut + (crowd ? 20 : 80)) / rate;
    ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(other->at(later)));
    ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(one->at(later)));
    EXPECT_EQ(other->saved(), one->saved()) << "cut at step " << cut;
  }
}

// What hands, motors, belts and explosions give apart, no step of `contact` or `event` adds energy
template <int D>
void expect_only_losses(const sim::World<D>& world, double slack) {
  const sim::Model<D>& model = world.model;
  if (model.collision == sim::Collision::handout || !model.drives.empty()) return;
  for (const sim::Body<D>& body : model.bodies) {
    if (body.handout) return;
  }
  for (const sim::Joint<D>& joint : model.joints) {
    if (joint.motor) return;
  }
  sim::State<D> state = world.state;
  sim::Stepper<D> stepper(model);
  stepper.begin(state);
  const auto driven = [&] {
    return sim::blasting(state) || std::any_of(state.grips.begin(), state.grips.end(),
                                               [](const auto& grip) { return grip.body >= 0; });
  };
  const bool belts = std::any_of(model.bodies.begin(), model.bodies.end(),
                                 [](const sim::Body<D>& body) { return body.carries(); });
  double size = 0;
  for (const sim::Body<D>& body : model.bodies)
    size += body.fixed ? 0 : body.mass * model.gravity.norm() * model.scale;
  // beside the booked work of pushing overlaps apart, and of belts
  const auto own = [&](const sim::Energies& now) {
    return now.total() - state.ledger.displacement - (belts || model.changed ? now.work : 0);
  };
  double before = own(sim::energies(model, state, stepper.paths(), 0)), worst = 0;
  int at = 0;
  for (int i = 0; i < 600; ++i) {
    const bool was = driven();
    ASSERT_FALSE(stepper.step(state)) << i;
    const sim::Energies now =
        sim::energies(stepper.model(state), state, stepper.paths(), double(state.step) / value(model.rate));
    const double left = own(now);
    if (!was && !driven() && left - before > worst * (size + now.kinetic))
      worst = (left - before) / (size + now.kinetic), at = i;
    before = left;
  }
  EXPECT_LE(worst, slack) << "step " << at;
}

TEST_P(EveryScene, GainsNoEnergyByContact) {
  const Scene scene = read(GetParam());
  std::visit(
      [](const auto& world) {
        // flight under gravity is exact; a joint of the direct solver is held by Runge and Kutta's steps, one
        // of the iterative solver by a symmetric scheme of second order, which gives and takes; and heaps of
        // the plane sink between two looks, and are granted the way up
        const bool jointed = !world.model.joints.empty(),
                   plane = std::is_same_v<decltype(world), const sim::World<2>&>;
        const bool direct = sim::solver(world.model) == sim::Solver::direct;
        expect_only_losses(world, direct ? (jointed ? 1e-9 : 1e-12) : jointed ? 1e-4 : plane ? 1e-6 : 1e-12);
      },
      scene.world);
}

std::vector<std::string> shipped() {
  std::vector<std::string> all;
  for (const auto& entry : std::filesystem::directory_iterator(OBSCURA_SOURCE_DIR "/scenes"))
    if (entry.path().extension() == ".toml") all.push_back(entry.path().string());
  std::sort(all.begin(), all.end());
  return all;
}

INSTANTIATE_TEST_SUITE_P(Cut, EveryScene, ::testing::ValuesIn(shipped()), [](const auto& scene) {
  return std::filesystem::path(scene.param).stem().string();
});

TEST(Cut, WordsThatAreNoStateOfTheSceneAreRefused) {
  const Scene scene = read(OBSCURA_SOURCE_DIR "/scenes/crate.toml");
  const auto run = scene.run();
  ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(run->at({1, 1})));
  const std::vector<std::uint64_t> good = run->saved();
  ASSERT_TRUE(scene.run(good));
  // too few, too many, and any word turned into a large number: taken or refused, never a fault
  EXPECT_FALSE(scene.run(std::span(good).first(good.size() - 1)));
  std::vector<std::uint64_t> words = good;
  words.push_back(0);
  EXPECT_FALSE(scene.run(words));
  // the first is the step: what bonds hold would be stepped until it has come there
  words = good, ++words[0];
  EXPECT_FALSE(scene.run(words));
  // the fourth is where the first body is: a run that has come so far has ended
  words = good, words[3] = std::bit_cast<std::uint64_t>(1e12);
  EXPECT_FALSE(scene.run(words));
  EXPECT_FALSE(read(OBSCURA_SOURCE_DIR "/scenes/room.toml").run(good));
  EXPECT_FALSE(read(OBSCURA_SOURCE_DIR "/scenes/racket.toml").run(good));
  for (std::size_t i = 0; i < good.size(); i += 1 + i / 64) {
    words = good;
    words[i] = 0x7ff0'0000'0000'0001;
    if (const auto odd = scene.run(words)) odd->at({1001, 1000});
  }
}

// A frame shortly after a step: by the solver for many, too, what the step has left is put back as within a
// whole one. Its way is not a speed of a thousandth of a second, nor its force one of a nanosecond.
TEST(Cut, ShortlyAfterAStepAllIsAsAtItsEnd) {
  const TextRun scene(
      "duration = 2\n[room]\nsize = [6, 4]\ngravity = [0, 0]\nwalls = \"none\"\n[physics]\nsolver = "
      "\"iterative\"\n[[ball]]\nname = \"a\"\nradius = 0.1\nmass = 4\nposition = [4, 1.4]\nvelocity = [-2.5, "
      "0]\nfriction = 0\nelasticity = 0\n[[box]]\nname = \"b\"\nsize = [0.3, 0.1]\nmass = 8\nposition = [3, "
      "2]\nfriction = 0\nelasticity = 0\nspin = 70\n[[box]]\nname = \"c\"\nsize = [0.3, 0.1]\nmass = "
      "0.2\nposition "
      "= [2.4, 2]\nvelocity = [1.7, 0]\nspin = 280\nfriction = 0\nelasticity = 0\n[[joint]]\ntype = "
      "\"pulley\"\nbetween = [\"a\", \"c\"]\nover = [{ body = \"b\", local = [0.1, 0.1] }]\n");
  const sim::Snapshot at = scene.at(1.1);
  for (const double later : {1e-9, 1e-8, 1e-6, 1e-5}) {
    const sim::Snapshot then = scene.at(1.1 + later);
    for (std::size_t i = 0; i < at.bodies.size(); ++i) {
      EXPECT_LT((then.bodies[i].position - at.bodies[i].position).norm(), 5 * later + 1e-12) << later;
      EXPECT_LT((then.bodies[i].velocity - at.bodies[i].velocity).norm(), 0.05) << later;
    }
    EXPECT_LT((then.joints[0].force - at.joints[0].force).norm(), 1e-9) << later;
    for (const auto& contact : then.contacts) EXPECT_LT(contact.force.norm(), 15) << later;
  }
}

// Within the first step, before which there is none, what lies there bears what it weighs.
TEST(Cut, WithinTheFirstStepWhatLiesThereHasItsWeight) {
  for (const double part : {0.1, 0.5, 0.9}) {
    const TextRun scene(
        "duration = 1\n[physics]\nsolver = \"iterative\"\nrate = 60\n[room]\nsize = [4, 4]\ngravity = [0, "
        "-10]\n[[box]]\nname = \"low\"\nsize = [0.4, 0.4]\nmass = 1\nelasticity = 0\nposition = [2, "
        "0.2]\n[[box]]\nname = \"high\"\nsize = [0.4, 0.4]\nmass = 2\nelasticity = 0\nposition = [2.01, "
        "0.6]\nspin = 0.01\n");
    const sim::Snapshot now = scene.at(part / 60);
    double floor = 0;
    for (const auto& contact : now.contacts)
      if (contact.wall >= 0) floor += contact.force.y();
    EXPECT_NEAR(floor, 30, 1) << part;
  }
}

}  // namespace
}  // namespace obscura::scene
