#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include <nlohmann/json.hpp>

#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using States = Program;

const char* const kParabola = R"(
duration = 3
[room]
size = [100, 100]
[[particle]]
name = "ball"
position = [10, 51]
velocity = [3, 4]
)";

TEST_F(States, AThrownBallIsWhereTheParabolaSays) {
  // RK4 is exact for a parabola; 1e-12 is a few roundings of numbers near 50
  scene(kParabola);
  const Outcome run = obscura("states scene.toml --at 0,0.5,1");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["states"].size(), 3u);
  for (const auto& state : json["states"]) {
    const double t = state["time"];
    const auto& ball = state["bodies"][0];
    EXPECT_EQ(ball["name"], "ball");
    EXPECT_NEAR(ball["position"][0], 10 + 3 * t, 1e-12);
    EXPECT_NEAR(ball["position"][1], 51 + 4 * t - 9.81 * t * t / 2, 1e-12);
    EXPECT_NEAR(ball["velocity"][1], 4 - 9.81 * t, 1e-12);
    EXPECT_NEAR(state["energy"]["total"], json["states"][0]["energy"]["total"], 1e-10);
  }
}

// The ball is 51 + 4 t - 4.905 t^2 high: it comes back to 51 m after 4/4.905 s, and passes 50 m later.
TEST_F(States, AreOfMarks) {
  scene(std::string(kParabola) +
        "[physics]\ncollision = \"event\"\n"
        "[[when]]\nvalue = \"ball.y < 50.99999\"\ndo = [{ mark = \"back\" }]\n"
        "[[when]]\nvalue = \"ball.y < 50\"\ndo = [{ mark = \"lower\" }]\n");
  const Outcome run = obscura("states scene.toml --at 0.5,back,lower");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["states"].size(), 3u);
  // to the microsecond after
  EXPECT_NEAR(json["states"][1]["bodies"][0]["position"][1], 50.99999, 5e-6);
  EXPECT_NEAR(json["states"][2]["bodies"][0]["position"][1], 50, 7e-6);
  EXPECT_EQ(obscura("render scene.toml --at back --size 160x90 -o a.png").exit, 0);
  EXPECT_EQ(obscura("render scene.toml --from back --to lower --size 160x90 -o a.mp4").exit, 0);
  const Outcome other = obscura("states scene.toml --at bac");
  EXPECT_EQ(other.exit, 2);
  EXPECT_NE(other.err.find("did you mean 'back'?"), std::string::npos) << other.err;
  const Outcome never = obscura("render scene.toml --at 'back[2]' -o b.png");
  EXPECT_EQ(never.exit, 2);
  EXPECT_NE(never.err.find("does not come to 'back[2]'"), std::string::npos) << never.err;
}

// A limit of a solver's work that a step meets is told at the end, and counted on from a checkpoint.
TEST_F(States, TellWhereALimitOfWorkWasMet) {
  const std::string bridge = OBSCURA_SOURCE_DIR "/scenes/bridge.toml";
  EXPECT_EQ(obscura("states " + bridge + " --at 0.5").err, "");
  const Outcome met = obscura("states " + bridge + " --at 0.6");
  EXPECT_NE(met.err.find("at t = 0.568333 s, met a limit of the direct solver's work"), std::string::npos)
      << met.err;
  EXPECT_EQ(obscura("states " + bridge + " --measure energy.total@0.6").err, met.err);
  scene(
      "duration = 1\n[room]\nsize = [2, 2]\ngravity = [0, 0]\n[physics]\nsolver = \"iterative\"\n"
      "[[ball]]\nradius = 0.01\nposition = [1, 1]\nvelocity = [90, 0]\nelasticity = 1\n");
  const Outcome fast = obscura("states scene.toml --at 0.1");
  EXPECT_NE(fast.err.find("had bodies meet faster than 4,800 substeps a second follow"), std::string::npos)
      << fast.err;
  EXPECT_EQ(obscura("states scene.toml --at 0.1 --set 'ball[0].velocity=[1,0]'").err, "");
}

// A rope over a wheel that stands still: of what does not move no beginning of a step was kept, and what
// memory held before said how far the rope was wound.
TEST_F(States, DoNotDependOnWhatMemoryHeld) {
  scene(
      "duration = 2\n[room]\nsize = [4, 3]\nwalls = \"none\"\n[physics]\nrate = 120\n[[ball]]\nname = "
      "\"bob\"\nradius = 0.08\nposition = [1.2, 1.8]\n[[ball]]\nname = \"post\"\nradius = 0.15\nposition = "
      "[2.2, 1.9]\nfixed = true\n[[joint]]\ntype = \"pulley\"\nbetween = [[2, 2.8], \"bob\"]\nover = "
      "[\"post\"]\n");
  const std::string states = obscura("states scene.toml --at 1.4").out;
  EXPECT_NE(states.find("\"hash\""), std::string::npos);
  // glibc fills what it gives out with these
  for (const char* with : {"85", "170"})
    EXPECT_EQ(
        shell(std::string("MALLOC_PERTURB_=") + with + " " OBSCURA_BINARY " states scene.toml --at 1.4").out,
        states);
}

TEST_F(States, NumbersReadBackToTheBit) {
  scene(kParabola);
  const Outcome once = obscura("states scene.toml --at 0.7");
  const auto json = nlohmann::json::parse(once.out);
  const double x = json["states"][0]["bodies"][0]["position"][1];
  const Outcome csv = obscura("states scene.toml --at 0.7 --format csv");
  const auto rows = cells(csv.out);
  ASSERT_GE(rows.size(), 2u);
  ASSERT_EQ(rows[1].size(), 12u + 6u);
  EXPECT_EQ(std::strtod(rows[1][13].c_str(), nullptr), x);
}

TEST_F(States, GoIntoAFileWhoseEndingIsTheFormat) {
  scene(kParabola);
  const std::string csv = obscura("states scene.toml --every 1 --format csv").out,
                    json = obscura("states scene.toml --every 1").out;
  const Outcome run = obscura("states scene.toml --every 1 -o new/folder/a.csv");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(contents(path("new/folder/a.csv")), csv);
  EXPECT_EQ(obscura("states scene.toml --every 1 -o a.json").exit, 0);
  EXPECT_EQ(contents(path("a.json")), json);
  EXPECT_EQ(obscura("states scene.toml --every 1 -o a.txt --format csv").exit, 0);
  EXPECT_EQ(contents(path("a.txt")), csv);
  EXPECT_EQ(obscura("states scene.toml --every 1 -o -").out, json);
  EXPECT_EQ(obscura("states scene.toml -o a.png").exit, 2);
  EXPECT_FALSE(std::filesystem::exists(path("a.png")));
  // of a run that cannot go on there is no file
  scene(kTorn, "torn.toml");
  EXPECT_EQ(obscura("states torn.toml -o torn.csv").exit, 6);
  EXPECT_FALSE(std::filesystem::exists(path("torn.csv")));
}

TEST_F(States, ARangeThatRunsBackwardsIsRefused) {
  scene(kParabola);
  const Outcome run = obscura("states scene.toml --at 1:0:0.1");
  EXPECT_EQ(run.exit, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.err.find("the range 1:0:0.1 runs backwards: expected from:to:stride"), std::string::npos)
      << run.err;
  EXPECT_EQ(obscura("states scene.toml --at 1:1:0.1").exit, 0);
}

TEST_F(States, TimesThatItPrintsItTakesBack) {
  scene(kCrateAndBall);
  for (const char* every : {"1/60", "1/7", "0.1", "1001/30000", "1/300", "0.0123"}) {
    const Outcome printed = obscura(std::string("states scene.toml --format csv --every ") + every);
    ASSERT_EQ(printed.exit, 0) << every;
    std::istringstream lines(printed.out);
    std::string line, times;
    std::getline(lines, line);
    while (std::getline(lines, line)) times += (times.empty() ? "" : ",") + line.substr(0, line.find(','));
    const Outcome again = obscura("states scene.toml --format csv --at " + times);
    EXPECT_EQ(again.out, printed.out) << every << again.err;
  }
  // a measure's time is one too: when the crate is highest
  const Outcome when =
      obscura("sweep scene.toml --vary seed=1 --measure crate.position.y@argmax,crate.position.y@max");
  std::istringstream cells(when.out.substr(when.out.find('\n') + 1));
  std::string run, seed, t, most;
  for (std::string* cell : {&run, &seed, &t, &most}) std::getline(cells, *cell, ',');
  const auto json = nlohmann::json::parse(obscura("states scene.toml --at " + t).out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << t << when.err;
  for (const auto& body : json["states"][0]["bodies"]) {
    if (body["name"] != "crate") continue;
    EXPECT_EQ(body["position"][1].get<double>(), std::stod(most));
  }
}

TEST_F(States, CsvHasOneRowAnInstantUnderThePathsOfTheLanguage) {
  scene(kParabola);
  const Outcome run = obscura("states scene.toml --every 0.1 --format csv");
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1 + 31);
  EXPECT_NE(
      run.out.find(",ball.position.x,ball.position.y,ball.angle,ball.velocity.x,ball.velocity.y,ball.spin\n"),
      std::string::npos);
}

// The numbers that sweeps measure, of one run: between two steps, at a mark, over the whole run.
TEST_F(States, MeasuresAreThoseOfASweep) {
  scene(kParabola + std::string("[[when]]\nvalue = \"ball.vy < 0\"\ndo = [{ mark = \"top\" }]\n"));
  const std::string list = "ball.position.x@1.2345,ball.position.y@max,ball.velocity.y@top,hash@end";
  const Outcome refused = obscura("states scene.toml --measure ball.position.x@1 --at 2");
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.err.find("exclude each other"), std::string::npos) << refused.err;
  const Outcome run = obscura("states scene.toml --measure " + list);
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto found = nlohmann::json::parse(run.out)["measures"];
  const Outcome sweep = obscura("sweep scene.toml --vary seed=0 --measure " + list);
  std::istringstream cells(sweep.out.substr(sweep.out.find('\n') + 1));
  std::string cell;
  std::getline(cells, cell, ','), std::getline(cells, cell, ',');
  for (const char* name : {"ball.position.x@1.2345", "ball.position.y@max", "ball.velocity.y@top"}) {
    std::getline(cells, cell, ',');
    EXPECT_EQ(found[name].get<double>(), std::stod(cell)) << name << sweep.out << sweep.err;
  }
  EXPECT_EQ(found["hash@end"].get<std::string>().size(), 32u);
  const Outcome rows = obscura("states scene.toml --format csv --measure ball.position.x@1.2345");
  EXPECT_EQ(rows.out.substr(0, rows.out.find('\n')), "ball.position.x@1.2345");
}

TEST_F(States, SetChangesAKeyFromOutside) {
  scene(kParabola);
  const auto json = nlohmann::json::parse(
      obscura("states scene.toml --at 0 --set ball.position.y=60 --set ball.mass=3").out);
  EXPECT_EQ(json["states"][0]["bodies"][0]["position"][1], 60.0);
}

TEST_F(States, TroubleExitsWithSixAfterWhatWasGood) {
  scene(kTorn);
  const Outcome run = obscura("states scene.toml --at 0,5");
  EXPECT_EQ(run.exit, 6);
  EXPECT_EQ(nlohmann::json::parse(run.out)["states"].size(), 1u);
}

TEST_F(States, AForceThatIsNoNumberExitsWithSixAndSaysWhere) {
  scene(R"scene(
[room]
gravity = [0, 0]
[[particle]]
name = "ball"
position = [1, 1]
velocity = [-1, 0]
[[force]]
components = ["sqrt(x - 0.5)", 0]
)scene");
  const Outcome run = obscura("states scene.toml --at 5");
  EXPECT_EQ(run.exit, 6);
  EXPECT_NE(run.err.find("ball"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("the force of ball is not a number"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("force[0] at x = 0.49"), std::string::npos) << run.err;
}

TEST_F(States, EnergiesHaveFieldsAndWorkWhereThereAreForces) {
  scene(R"(
[[particle]]
position = [1, 1]
[[force]]
potential = "2*x"
)");
  const auto with = nlohmann::json::parse(obscura("states scene.toml --at 0").out)["states"][0]["energy"];
  EXPECT_EQ(with["fields"], 2.0);
  EXPECT_EQ(with["work"], 0.0);
  EXPECT_NE(obscura("states scene.toml --at 0 --format csv").out.find("energy.fields,energy.work"),
            std::string::npos);
  scene(kParabola);
  EXPECT_FALSE(nlohmann::json::parse(obscura("states scene.toml --at 0").out)["states"][0]["energy"].contains(
      "fields"));
}

TEST_F(States, ReportWhatHoldsABlockOnASlidingOneAndAJoint) {
  // a block at rest on the floor bears half of g m at each corner (1e-9: the direct solver's); a sled slides
  // with mu m g against it; a lamp hangs on a rod
  scene(R"(
[room]
size = [8, 4]
[[box]]
name = "block"
size = [1, 1]
mass = 2
position = [1, 0.5]
[[box]]
name = "lid"
size = [0.5, 0.5]
mass = 1
position = [1, 1.25]
[[box]]
name = "sled"
size = [1, 0.2]
mass = 1
position = [3, 0.1]
velocity = [3, 0]
friction = 0.3
[[particle]]
name = "lamp"
position = [6, 3]
mass = 0.5
[[joint]]
name = "cord"
type = "rod"
between = ["lamp", [6, 4]]
)");
  const Outcome run = obscura("states scene.toml --at 0.5");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["solver"], "direct");
  const auto& state = json["states"][0];
  EXPECT_EQ(state["bodies"][1]["name"], "block");
  EXPECT_EQ(state["bodies"][1]["at_rest"], true);
  EXPECT_EQ(state["bodies"][3]["at_rest"], false);
  double block = 0, lid = 0, drag = 0;
  int slides = 0, sticks = 0;
  for (const auto& contact : state["contacts"]) {
    const bool wall = contact.contains("wall");
    if (contact["body"] == "block" && wall) block += double(contact["force"][1]);
    if (!wall) lid += double(contact["force"][1]) * (contact["other"] == "block" ? 1 : -1);
    if (contact["body"] == "sled") drag += double(contact["force"][0]);
    (contact["mode"] == "sliding" ? slides : sticks)++;
    EXPECT_NEAR(contact["gap"], 0, 1e-8);
  }
  EXPECT_NEAR(block, 3 * 9.81, 1e-9);
  EXPECT_NEAR(std::abs(lid), 9.81, 1e-9);
  EXPECT_NEAR(drag, -std::sqrt(0.3 * 0.3) * 9.81, 1e-9);
  EXPECT_EQ(slides, 2);
  EXPECT_EQ(sticks, 4);
  EXPECT_EQ(state["joints"][0]["name"], "cord");
  EXPECT_EQ(state["joints"][0]["broken"], false);
  EXPECT_NEAR(state["joints"][0]["force"][1], 0.5 * 9.81, 1e-11);

  const Outcome csv = obscura("states scene.toml --at 0.5 --format csv");
  EXPECT_NE(csv.out.find(",cord.force.x,cord.force.y,cord.torque\n"), std::string::npos);
  const Outcome whole = obscura("states scene.toml --measure cord.force@0.5");
  ASSERT_EQ(whole.exit, 0) << whole.err;
  EXPECT_NEAR(nlohmann::json::parse(whole.out)["measures"]["cord.force@0.5"].get<double>(), 0.5 * 9.81,
              1e-11);
}

TEST_F(States, NameTheSolver) {
  const std::string crowd =
      "duration = 1\n[room]\nsize = [8, 8]\n[[ball]]\nradius = 0.1\nposition = [1, 1]\n"
      "copies = { count = [7, 6], offset = [[0.3, 0], [0, 0.3]] }\n";
  scene(crowd);
  EXPECT_EQ(nlohmann::json::parse(obscura("states scene.toml --at 0").out)["solver"], "iterative");
  const std::string said = obscura("check scene.toml").out;
  EXPECT_NE(said.find("iterative solver: 42 bodies and 0 points that move; up to 20 and 400"),
            std::string::npos);
  EXPECT_NE(said.find("impacts of up to 8 contacts are solved together"), std::string::npos);
  EXPECT_NE(obscura("check scene.toml --set physics.impacts=sequential")
                .out.find("impacts are solved pair after pair"),
            std::string::npos);
  scene(kParabola);
  EXPECT_NE(obscura("check scene.toml").out.find("direct solver: "), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(
                obscura("states scene.toml --at 0 --set physics.collision=handout").out)["solver"],
            nullptr);
}

TEST_F(States, OpenNoGl) {
  scene(kParabola);
  const Outcome run = shell("LD_DEBUG=files " OBSCURA_BINARY " states scene.toml --at 0");
  EXPECT_EQ(run.exit, 0);
  EXPECT_EQ(run.err.find("OSMesa"), std::string::npos);
  EXPECT_EQ(run.err.find("libEGL"), std::string::npos);
}

using Check = Program;

TEST_F(Check, SaysWhatWouldBeDone) {
  scene(kRoom);
  const Outcome run = obscura("check scene.toml");
  EXPECT_EQ(run.exit, 0) << run.err;
  for (const char* fact : {"1 particle", "1 box", "1 spring", "4 walls", "1 mouse", "6000 steps",
                           "600 frames", "1920x1080", "MB"}) {
    EXPECT_NE(run.out.find(fact), std::string::npos) << fact << "\n" << run.out;
  }
}

TEST_F(Check, CallsBodiesWhatTheyAreAlsoWhereTheyStandAskewAndDoNotTurn) {
  scene(
      "duration = 1\n[room]\nsize = [8, 4, 8]\n[physics]\nrotation = false\n"
      "[[box]]\nsize = [0.5, 0.5, 0.5]\nposition = [2, 1, 0]\n"
      "copies = { count = 8, turn = 45, around = [0, 0, 0] }\n"
      "[[capsule]]\nlength = 0.5\nradius = 0.1\nposition = [0, 2, 0]\norientation = [0, 0, 30]\n");
  const Outcome run = obscura("check scene.toml");
  EXPECT_NE(run.out.find("0 particles, 8 boxes, 1 capsule, 0 springs"), std::string::npos)
      << run.out << run.err;
}

TEST_F(Check, ReadsAllScenesAndFailsIfOneIsBad) {
  scene(kRoom);
  scene("duration = -1\n", "bad.toml");
  const Outcome run = obscura("check bad.toml scene.toml");
  EXPECT_EQ(run.exit, 3);
  EXPECT_NE(run.out.find("scene.toml: good"), std::string::npos);
  EXPECT_NE(run.err.find("bad.toml:1:"), std::string::npos);
}

using New = Program;

TEST_F(New, WritesASceneThatCanBeFilmedAndNeverOverAnother) {
  ASSERT_EQ(obscura("new ball").exit, 0);
  EXPECT_EQ(obscura("check ball.toml").exit, 0);
  EXPECT_EQ(obscura("render ball.toml --at 1 --size 160x90").exit, 0);
  EXPECT_EQ(obscura("new ball.toml").exit, 4);
}

using Help = Program;

TEST_F(Help, OfEachCommandShowsExamples) {
  EXPECT_EQ(obscura("--help").exit, 0);
  for (const char* command :
       {"render", "new", "check", "states", "sweep", "compare", "verify", "golden", "docs"}) {
    const Outcome run = obscura(std::string(command) + " --help");
    EXPECT_EQ(run.exit, 0);
    EXPECT_NE(run.out.find("Examples:"), std::string::npos) << command;
    EXPECT_NE(run.out.find(std::string("obscura ") + command), std::string::npos) << command;
  }
}

TEST_F(Help, VersionNamesWhatDrawsAndEncodes) {
  const Outcome run = obscura("--version");
  EXPECT_EQ(run.exit, 0);
  for (const char* part : {"obscura ", "OpenGL ", "Mesa", "libavcodec", "libpng"}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part << "\n" << run.out;
  }
}

}  // namespace
}  // namespace obscura::app
