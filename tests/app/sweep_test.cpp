#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include <nlohmann/json.hpp>

#include "app/study/mosaic.h"
#include "media/png.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

class Sweep : public Program {};

const char* const kThrow = R"(
duration = 1
[room]
size = [100, 100]
[[particle]]
name = "ball"
position = [10, 50]
velocity = [3, 4]
)";

TEST_F(Sweep, RowsHaveAllCombinationsInOrderAndWhatStatesSay) {
  scene(kCrateAndBall);
  const Outcome run = obscura(
      "sweep scene.toml --vary crate.elasticity=0:0.2:0.1,1 --vary seed=7:8 "
      "--measure 'energy.total@0.7, crate.position.y@end,hash@end' --set crate.mass=2");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto rows = cells(run.out);
  ASSERT_EQ(rows.size(), 1u + 8u);
  EXPECT_EQ(run.out.substr(0, run.out.find('\n')),
            "run,crate.elasticity,seed,energy.total@0.7,crate.position.y@end,hash@end,trouble");
  const std::vector<std::string> elasticities{"0", "0", "0.1", "0.1", "0.2", "0.2", "1", "1"};
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][0], std::to_string(i));
    EXPECT_EQ(rows[i][1], elasticities[i - 1]);
    EXPECT_EQ(rows[i][2], i % 2 ? "7" : "8");
  }
  const auto states = cells(obscura("states scene.toml --at 0.7,1 --format csv --set crate.mass=2 "
                                    "--set crate.elasticity=0.1 --set seed=7")
                                .out);
  const auto of = [&](const std::string& name, std::size_t row) {
    const auto column = std::find(states[0].begin(), states[0].end(), name) - states[0].begin();
    return states[row][std::size_t(column)];
  };
  // the same bits, written shorter
  EXPECT_EQ(std::stod(rows[3][3]), std::stod(of("energy.total", 1)));
  EXPECT_EQ(std::stod(rows[3][4]), std::stod(of("crate.position.y", 2)));
  EXPECT_EQ(rows[3][5], of("hash", 2));
}

TEST_F(Sweep, OverARunAreTheEndsOfItsSteps) {
  // y = 50 + 4 t - g t^2 / 2. Of a parabola the highest end of a step lies at most g h^2 / 8 below its top
  // and half a step beside it, and the mean of straight lines g h^2 / 12 below its own.
  scene(kThrow);
  const double g = 9.81, h = 1.0 / 600;
  const Outcome run = obscura(
      "sweep scene.toml --vary ball.velocity.x=3 --measure ball.position.y@max,ball.position.y@argmax "
      "--measure ball.position.y@mean,ball.position.y@min,time@argmin,ball.speed@0.5,ball.position.y@2");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto row = cells(run.out)[1];
  const auto value = [&](std::size_t i) { return std::stod(row[2 + i]); };
  EXPECT_NEAR(value(0), 50 + 16 / (2 * g), g * h * h / 8 + 1e-12);
  EXPECT_NEAR(value(1), 4 / g, h / 2 + 1e-12);
  EXPECT_NEAR(value(2), 50 + 2 - g / 6, g * h * h / 12 + 1e-10);
  EXPECT_NEAR(value(3), 50 + 4 - g / 2, 1e-11);
  EXPECT_EQ(value(4), 0);
  EXPECT_NEAR(value(5), std::hypot(3, 4 - g / 2), 1e-11);
  EXPECT_NEAR(value(6), 50 + 8 - 2 * g, 1e-11);  // an instant may lie beyond the duration
}

TEST_F(Sweep, BytesDoNotDependOnWorkersAndSharesAreTheWhole) {
  scene(kCrateAndBall);
  const std::string asked =
      "sweep scene.toml --vary crate.spin=0:90:15 --vary seed=1:2 --measure hash@end,energy.kinetic@max ";
  const Outcome one = obscura(asked + "-j 1");
  EXPECT_EQ(one.exit, 0) << one.err;
  EXPECT_EQ(obscura(asked + "-j 5").out, one.out);
  ASSERT_EQ(obscura(asked + "-o all.csv --progress none").exit, 0);
  EXPECT_EQ(contents(path("all.csv")), one.out);
  EXPECT_EQ(obscura(asked + "--shard 1/3").out + obscura(asked + "--shard 2/3").out +
                obscura(asked + "--shard 3/3").out,
            one.out);
  EXPECT_EQ(obscura(asked + "--shard 4/3").exit, 2);
}

TEST_F(Sweep, ARunInTroubleHasItInItsRowAndTheOthersGoOn) {
  scene(kTorn);
  const std::string asked = "sweep scene.toml --measure ball.position.y@0,energy.total@end,time@max --vary ";
  const Outcome run = obscura(asked + "'spring[0].stiffness=20,40000,30'");
  EXPECT_EQ(run.exit, 6);
  const auto rows = cells(run.out);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[2][2], "2");
  EXPECT_EQ(rows[2][3], "");
  EXPECT_EQ(rows[2][4], "");
  EXPECT_NE(run.out.find("the energy of ball grew"), std::string::npos) << run.out;
  EXPECT_EQ(rows[3][4], "5");

  const Outcome refused = obscura(asked + "ball.mass=1,-1,2 --set 'spring[0].stiffness=20'");
  EXPECT_EQ(refused.exit, 3);
  EXPECT_EQ(cells(refused.out).size(), 4u);
  EXPECT_NE(refused.out.find("--vary ball.mass=-1: 'mass' must be"), std::string::npos) << refused.out;
}

TEST_F(Sweep, AnInterruptKeepsItsRowsAndResumeGoesOnToTheSameBytes) {
  scene(kRoom);
  const std::string asked =
      "sweep scene.toml --vary seed=1:40 --measure energy.total@max -j 2 --progress none";
  ASSERT_EQ(obscura(asked + " -o whole.csv").exit, 0);
  // where the sixth piece of it is written
  const Outcome cut = shell(meeting("TERM", 6, "write") + asked + " -o out/cut.csv");
  EXPECT_EQ(cut.exit, 130);
  EXPECT_FALSE(std::filesystem::exists(path("out/cut.csv")));
  const std::string left = contents(path("out/cut.partial.csv")), whole = contents(path("whole.csv"));
  EXPECT_GT(left.size(), 0u);
  EXPECT_LT(left.size(), whole.size());
  EXPECT_EQ(whole.substr(0, left.size()), left);
  // a line that a power cut tore is made again
  std::ofstream(path("out/cut.partial.csv"), std::ios::app | std::ios::binary) << "9,9,1.2";
  ASSERT_EQ(obscura(asked + " -o out/cut.csv --resume").exit, 0);
  EXPECT_EQ(contents(path("out/cut.csv")), whole);
  EXPECT_FALSE(std::filesystem::exists(path("out/cut.partial.csv")));

  std::ofstream(path("out/cut.partial.csv"), std::ios::binary) << left;
  const Outcome other = obscura(asked + " --set ball.mass=3 -o out/cut.csv --resume");
  EXPECT_EQ(other.exit, 4);
  EXPECT_NE(other.err.find("is of another scene"), std::string::npos) << other.err;
  EXPECT_EQ(contents(path("out/cut.partial.csv")), left);
}

TEST_F(Sweep, JsonLinesAreObjectsWithNumbersAndNull) {
  scene(kThrow);
  ASSERT_EQ(obscura("sweep scene.toml --vary 'ball.velocity=[1,2],[0,0]' --measure ball.position.y@0,hash@0 "
                    "-o runs.jsonl --progress none")
                .exit,
            0);
  std::istringstream lines(contents(path("runs.jsonl")));
  std::vector<nlohmann::json> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["ball.velocity"], (nlohmann::json{1, 2}));
  EXPECT_EQ(rows[1]["run"], 2);
  EXPECT_EQ(rows[1]["ball.position.y@0"], 50);
  EXPECT_TRUE(rows[1]["trouble"].is_null());
  EXPECT_TRUE(rows[1]["hash@0"].is_string());
}

TEST_F(Sweep, AMistypedRequestIsToldWhatWasMeantBeforeAnyRun) {
  scene(kThrow);
  const auto said = [&](const std::string& arguments, int exit, const std::string& text) {
    const Outcome run = obscura("sweep scene.toml " + arguments);
    EXPECT_EQ(run.exit, exit) << arguments;
    EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  };
  said("--vary seed=1:2", 2, "--measure");
  said("--vary seed=1:2 --measure energy.totl@5", 2, "did you mean 'energy.total'?");
  said("--vary seed=1:2 --measure energy.total@mx", 2, "did you mean 'max'?");
  said("--vary seed=1:2 --measure energy.total", 2, "expected NAME@WHEN");
  said("--vary seed=1:2 --vary seed=3 --measure hash@0", 2, "varied twice");
  said("--vary seed=1:2 --set seed=3 --measure hash@0", 2, "--set seed: it is varied");
  said("--vary seed=1:2 --set 'seed = 3' --measure hash@0", 2, "--set seed: it is varied");
  said("--vary 'ball.position=[1,1]' --set ball.position.x=2 --measure hash@0", 2,
       "--set ball.position.x: it is varied");
  said("--vary seed=2:1 --measure hash@0", 2, "runs backwards");
  said("--vary ball.radius=0.1:0.25 --measure hash@0", 2,
       "goes by 1, and so not to 0.25: give a stride, as in 0.1:0.25:0.015");
  said("--vary ball.mas=1,2 --measure hash@0", 3, "did you mean");
  said("--vary seed=1:2 --measure hash@0 -o runs.xls", 2, ".csv, .jsonl");
}

TEST_F(Sweep, OpensNoGl) {
  scene(kThrow);
  const Outcome run =
      shell("LD_DEBUG=files " OBSCURA_BINARY " sweep scene.toml --vary seed=1:2 --measure hash@0");
  EXPECT_EQ(run.exit, 0);
  EXPECT_EQ(run.err.find("OSMesa"), std::string::npos);
  EXPECT_EQ(run.err.find("libEGL"), std::string::npos);
}

int head_of_crate_and_ball() {
  return mosaic_head(scene::parse(kCrateAndBall, "scene.toml", {"film.size=[320,180]"}));
}

// the words over a run have another decimal mark, and at "." the same as always
TEST_F(Sweep, WordsOverAPictureHaveTheScenesDecimalMark) {
  scene(kCrateAndBall);
  const auto words = [&](const std::string& mark) {
    const Outcome drawn = obscura(
        "sweep scene.toml --set film.size=[320,180] --vary crate.elasticity=0.25,0.5 "
        "--at 0 -o a.png --set 'look.decimal=\"" +
        mark + "\"'");
    EXPECT_EQ(drawn.exit, 0) << drawn.err;
    const media::Image all = media::read_png(path("a.png")).image;
    const Mosaic mosaic(2, 320, 180, head_of_crate_and_ball());
    return std::string(all.row(mosaic.top(0) - mosaic.words), all.row(mosaic.top(0)));
  };
  EXPECT_EQ(words("."), words("."));
  EXPECT_NE(words("."), words(","));
}

TEST_F(Sweep, APictureAndAMovieHaveAllRunsBesideEachOther) {
  // tiles of equal runs are equal, of others are not; the movie's bytes are the same for all workers
  scene(kCrateAndBall);
  const std::string asked = "sweep scene.toml --set film.size=[320,180] --set film.fps=10 --vary ";
  ASSERT_EQ(obscura(asked + "seed=1:2 --vary ball.velocity.x=-1,1 --at 0.5 -o all.png").exit, 0);
  const media::Image all = media::read_png(path("all.png")).image;
  const Mosaic mosaic(4, 320, 180, head_of_crate_and_ball());
  EXPECT_EQ(mosaic.columns, 2);
  // under one title and clock
  ASSERT_EQ(obscura(asked + "seed=1:2 --vary ball.velocity.x=-1,1 --at 0 -o start.png").exit, 0);
  const media::Image start = media::read_png(path("start.png")).image;
  ASSERT_GT(mosaic.head, 5);
  EXPECT_NE(std::string(start.row(0), start.row(mosaic.head)), std::string(all.row(0), all.row(mosaic.head)));
  ASSERT_EQ(all.width, 320);
  int like = 0, unlike = 0;
  for (int y = 0; y < mosaic.height; ++y) {
    const auto row = [&](int i) { return all.row(mosaic.top(i) + y) + 4 * mosaic.left(i); };
    like += std::memcmp(row(0), row(2), std::size_t(4) * mosaic.width) == 0;
    unlike += std::memcmp(row(0), row(1), std::size_t(4) * mosaic.width) != 0;
  }
  EXPECT_EQ(like, mosaic.height);
  EXPECT_GT(unlike, 5);

  for (const char* workers : {"1", "3"}) {
    const Outcome movie =
        obscura(asked + "crate.elasticity=0:1:0.5 --set duration=2.5 -o " + workers + ".mp4 -j " + workers);
    ASSERT_EQ(movie.exit, 0) << movie.err;
    EXPECT_NE(movie.out.find("3 runs beside each other, 25 frames, 320x180"), std::string::npos) << movie.out;
  }
  EXPECT_EQ(contents(path("1.mp4")), contents(path("3.mp4")));
  EXPECT_EQ(obscura(asked + "seed=1:2 -o all.png").exit, 2);
  EXPECT_EQ(obscura(asked + "seed=1:200 -o all.mp4").exit, 2);
}

}  // namespace
}  // namespace obscura::app
