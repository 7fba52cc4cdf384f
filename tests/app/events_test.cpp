// Events as a user of the program sees them: their list, measures at marks, figures, films that stop.

#include <algorithm>
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "program.h"

namespace obscura::app {
namespace {

using EventsOfRuns = Program;

const char* const kBounces = R"(
duration = 4
[room]
size = [4, 3]
[physics]
collision = "event"
[[ball]]
name = "ball"
radius = 0.1
position = [1, 2]
velocity = [2.3, 0]
[[when]]
name = "landing"
touches = ["ball", "floor"]
again = true
do = [{ mark = "hit" }]
[[when]]
value = "ball.x > 3"
do = [{ mark = "far" }, { set = "room.gravity", to = [0, -5] }]
[[when]]
time = "5/2"
do = [{ stop = true }]
[film]
size = [160, 120]
fps = 20
speed = [{ time = "hit", freeze = 0.5 }]
[[film.label]]
at = "ball"
text = "hit"
start = "hit"
end = { time = "hit", after = 1 }
[figure]
mark = "hit"
)";

TEST_F(EventsOfRuns, AreListed) {
  scene(kBounces);
  const Outcome run = obscura("states scene.toml --events");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto events = nlohmann::json::parse(run.out)["events"];
  ASSERT_GE(events.size(), 4u);
  EXPECT_EQ(events[0]["event"], "landing");
  EXPECT_EQ(events[0]["condition"], "touches");
  EXPECT_EQ(events[0]["of"], nlohmann::json({"ball", "wall[0]"}));
  EXPECT_EQ(events[0]["marks"], nlohmann::json({"hit"}));
  // sqrt(2 h / g)
  EXPECT_NEAR(events[0]["time"], std::sqrt(2 * 1.9 / 9.81), 1e-9);
  EXPECT_EQ(events.back()["time"], 2.5);
  // up to an instant; and as a table
  const Outcome early = obscura("states scene.toml --events --at 0,0.7 --format csv");
  EXPECT_EQ(std::count(early.out.begin(), early.out.end(), '\n'), 2);
  EXPECT_TRUE(early.out.starts_with("time,event,condition,of,marks\n0.622382")) << early.out;
}

TEST_F(EventsOfRuns, AreMeasuredAtTheirMarks) {
  scene(kBounces);
  const Outcome run = obscura(
      "sweep scene.toml --vary physics.rate=300,600 --measure "
      "time@hit,ball.position.y@hit,ball.velocity.y@hit,ball.position.x@far,time@hit[50]");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto rows = cells(run.out);
  for (std::size_t i = 1; i <= 2; ++i) {
    ASSERT_GT(rows.size(), i) << run.out;
    const std::vector<std::string>& row = rows[i];
    ASSERT_GE(row.size(), 6u) << run.out;
    const double t = std::sqrt(2 * 1.9 / 9.81);
    EXPECT_NEAR(std::stod(row[2]), t, 1e-9);
    EXPECT_NEAR(std::stod(row[3]), 0.1, 1e-9);
    // right after it: e = 0.8 of what it fell with
    EXPECT_NEAR(std::stod(row[4]), 0.8 * 9.81 * t, 1e-9);
    EXPECT_NEAR(std::stod(row[5]), 3, 1e-9);
    EXPECT_TRUE(row.size() == 6 || row[6].empty()) << run.out;
  }
  const Outcome wrong = obscura("sweep scene.toml --measure time@hat");
  EXPECT_EQ(wrong.exit, 2);
  EXPECT_NE(wrong.err.find("makes a mark 'hat'; did you mean 'hit'?"), std::string::npos) << wrong.err;
}

TEST_F(EventsOfRuns, AFigureIsOfItsMark) {
  scene(kBounces);
  EXPECT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  EXPECT_EQ(obscura("figure scene.toml -o b.svg --at 0.622383").exit, 0);
  EXPECT_EQ(contents(path("a.svg")), contents(path("b.svg")));
  const Outcome never = obscura("figure scene.toml -o c.svg --set 'figure.mark=hit[50]'");
  EXPECT_NE(never.exit, 0);
  EXPECT_NE(never.err.find("does not come to the mark"), std::string::npos) << never.err;
}

// One film and one list for every number of workers, shards, and a run that goes on.
TEST_F(EventsOfRuns, AFilmIsOneAndStopsWithItsRun) {
  scene(kBounces);
  const Outcome whole = obscura("render scene.toml -o a.mp4 -j 1");
  ASSERT_EQ(whole.exit, 0) << whole.err;
  // 2.5 s and half a second of standing still, at 20 frames a second
  EXPECT_NE((whole.out + whole.err).find("60 frames"), std::string::npos) << whole.out << whole.err;
  ASSERT_EQ(obscura("render scene.toml -o b.mp4 --shard 1/2").exit, 0);
  ASSERT_EQ(obscura("render scene.toml -o b.mp4 --shard 2/2").exit, 0);
  ASSERT_EQ(obscura("join b.mp4").exit, 0);
  EXPECT_EQ(contents(path("a.mp4")), contents(path("b.mp4")));
  ASSERT_EQ(obscura("render scene.toml -o c.mp4 -j 2").exit, 0);
  EXPECT_EQ(contents(path("a.mp4")), contents(path("c.mp4")));
}

}  // namespace
}  // namespace obscura::app
