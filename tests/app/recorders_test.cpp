// docs/recorders: what they wrote with their engines is filmed and held; and where an engine is installed,
// what its recorder writes today.

#include <fstream>

#include <gmock/gmock.h>

#include "needs.h"
#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;

const std::string kRecorders = OBSCURA_SOURCE_DIR "/docs/recorders/";
const std::string kRecorded = OBSCURA_SOURCE_DIR "/tests/recorders/";

std::string first_line(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

class Recorders : public Program {
 protected:
  /// Whether run.toml and run.csv of the folder make a still, a film and a golden.
  void expect_film_and_golden(const std::string& film) const {
    EXPECT_EQ(obscura("check run.toml").exit, 0);
    ASSERT_EQ(obscura("golden run.toml --update").exit, 0);
    Outcome run = obscura("golden run.toml");
    EXPECT_EQ(run.exit, 0) << run.out;
    EXPECT_EQ(run.out.find("left out"), std::string::npos) << run.out;
    run = obscura("render run.toml --states run.csv --size 160x90 -o run.mp4");
    EXPECT_EQ(run.exit, 0) << run.err;
    EXPECT_THAT(run.out + run.err, HasSubstr(film));
    // a number that is another one is another state
    std::string table = contents(path("run.csv"));
    const std::size_t last = table.find_first_of("123456789", table.rfind(','));
    table[last] = table[last] == '9' ? '8' : char(table[last] + 1);
    scene(table, "run.csv");
    EXPECT_EQ(obscura("golden run.toml").exit, 1);
  }
  /// The engine's run of its recorder's example, whose table has the columns of the recorded one.
  void expect_like_recorded(const std::string& engine) const {
    EXPECT_EQ(first_line(path("run.csv")), first_line(kRecorded + engine + "/run.csv"));
    EXPECT_EQ(shell("wc -l < run.csv").out, shell("wc -l < " + kRecorded + engine + "/run.csv").out);
  }
  void take(const std::string& engine) const {
    for (const char* file : {"/run.csv", "/run.toml"})
      std::filesystem::copy(kRecorded + engine + file, folder_);
  }
};

TEST_F(Recorders, AreShort) {
  for (const char* name : {"obscura_pymunk.py", "obscura_box2d.h", "obscura_mujoco.h", "obscura_rapier.mjs"})
    EXPECT_LE(std::stoi(shell("wc -l < " + kRecorders + name).out), 150) << name;
}

TEST_F(Recorders, OfPymunkMadeAFilmAndAGolden) {
  take("pymunk");
  expect_film_and_golden("91 frames");
}

TEST_F(Recorders, OfBox2dMadeAFilmAndAGolden) {
  take("box2d");
  expect_film_and_golden("91 frames");
}

TEST_F(Recorders, OfMujocoMadeAFilmAndAGolden) {
  take("mujoco");
  expect_film_and_golden("26 frames");
}

TEST_F(Recorders, OfRapierMadeAFilmAndAGolden) {
  take("rapier");
  expect_film_and_golden("91 frames");
}

TEST_F(Recorders, WithMujocoItself) {
  if (!installed("cc") || !std::filesystem::exists("/usr/include/mujoco/mujoco.h"))
    GTEST_SKIP() << "needs libmujoco-dev, which not every Debian has";
  const Outcome run = shell("cc -std=c11 -Wall -Wextra -Werror -I" + kRecorders + " " + kRecorders +
                            "examples/falling_mujoco.c -o falling -lmujoco -lm && ./falling");
  ASSERT_EQ(run.exit, 0) << run.err;
  expect_like_recorded("mujoco");
  expect_film_and_golden("26 frames");
}

TEST_F(Recorders, WithPymunkItself) {
  if (shell("python3 -c 'import pymunk'").exit != 0) GTEST_SKIP() << "needs pymunk, which Debian has not";
  const Outcome run = shell("PYTHONPATH=$PYTHONPATH:" + kRecorders + " python3 -B " + kRecorders +
                            "examples/falling_pymunk.py");
  ASSERT_EQ(run.exit, 0) << run.err;
  expect_like_recorded("pymunk");
  expect_film_and_golden("91 frames");
}

TEST_F(Recorders, WithBox2dItself) {
  const Outcome flags = shell("pkg-config --cflags --libs 'box2d >= 3'");
  if (flags.exit != 0) GTEST_SKIP() << "needs Box2D 3, which Debian has not";
  const std::string line = flags.out.substr(0, flags.out.find('\n'));
  const Outcome run = shell("cc -std=c11 -Wall -Wextra -Werror -I" + kRecorders + " " + kRecorders +
                            "examples/falling_box2d.c -o falling " + line + " -lm && ./falling");
  ASSERT_EQ(run.exit, 0) << run.err;
  expect_like_recorded("box2d");
  expect_film_and_golden("91 frames");
}

TEST_F(Recorders, WithRapierItself) {
  // a folder in which `npm install @dimforge/rapier2d-compat` was run
  const char* folder = std::getenv("OBSCURA_RAPIER");
  if (!folder) GTEST_SKIP() << "needs OBSCURA_RAPIER, a folder with node_modules/@dimforge/rapier2d-compat";
  const Outcome run =
      shell("ln -s " + std::string(folder) + "/node_modules . && cp " + kRecorders + "obscura_rapier.mjs " +
            kRecorders + "examples/falling_rapier.mjs . && node falling_rapier.mjs");
  ASSERT_EQ(run.exit, 0) << run.err;
  expect_like_recorded("rapier");
  expect_film_and_golden("91 frames");
}

}  // namespace
}  // namespace obscura::app
