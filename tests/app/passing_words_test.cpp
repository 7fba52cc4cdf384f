// Words of films on the way of others, beside the bodies of other runs, and where no picture shows them.

#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/run/ahead.h"
#include "app/run/compared.h"
#include "app/run/outside.h"
#include "app/run/simulation.h"
#include "draw/compose/annotations.h"
#include "draw/picture/type.h"
#include "scene/scene.h"

namespace obscura::app {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::string spans_of_text(const draw::Text& text) {
  std::string all;
  for (const draw::Span& span : text.spans) all += span.text;
  return all;
}

/// The words of a film of one run, frame by frame: see(list, projection, now).
template <class See>
void for_each_frame(const scene::Scene& scene, See&& see) {
  const Ahead ahead = app::ahead(scene);
  const draw::Illustrator artist = depictor(scene, ahead);
  const auto run = scene.run();
  const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  for (std::int64_t frame = 0; frame < shots.size(); ++frame) {
    const sim::Snapshot now = moment(*run, shots[frame].time, scene);
    const draw::Projection page = artist.projection(0, now);
    draw::List list;
    ahead.annotations->draw(0, page, now, double(frame) / sim::value(scene.film.fps), list);
    see(list, page, now);
  }
}

/// Words over which those of a quick arrow pass go and come slowly: none blinks.
TEST(PassingWords, FadeSlowly) {
  const scene::Scene scene = scene::parse(R"(title = "Three"
duration = 6
[room]
size = [4, 3]
[[ball]]
name = "a"
radius = 0.12
position = [2.6, 1.6]
[[ball]]
name = "b"
radius = 0.12
position = [3.2, 1.6]
[[ball]]
name = "c"
radius = 0.2
position = [0.6, 2.4]
velocity = [1.5, 0]
elasticity = 0.98
[[joint]]
type = "rod"
between = [[2, 1.6], "a"]
[[joint]]
type = "rod"
between = ["a", "b"]
[film]
size = [640, 360]
[[film.point]]
at = "b"
label = "Bob"
dot = false
[[film.point]]
at = "c"
label = "Cat"
dot = false
[[film.vector]]
quantity = "velocity"
of = "b"
label = "v"
[[film.vector]]
quantity = "joint_force"
of = "a"
label = "T"
)",
                                          "three.toml");
  constexpr int kMost = 40;  // of 255 a frame: a smooth step over 0.3 s goes 1.5 / 18 of the whole
  int frames = 0;
  std::map<std::string, int> before{{"Bob", 255}, {"Cat", 255}};
  for_each_frame(scene, [&](const draw::List& list, const draw::Projection&, const sim::Snapshot& now) {
    std::map<std::string, int> seen{{"Bob", 0}, {"Cat", 0}};
    for (const draw::Text& text : list.texts)
      if (const auto it = seen.find(spans_of_text(text)); it != seen.end())
        it->second = text.spans[0].color.a;
    for (const auto& [words, strength] : seen)
      EXPECT_LE(std::abs(strength - before[words]), kMost) << words << " at " << now.time;
    before = seen, ++frames;
  });
  EXPECT_EQ(frames, 360);
}

/// Of all words of a film of balls alone, those that are read and lie in one by more than a quarter of its
/// radius: letters' own boxes.
struct OverBalls {
  int covered = 0, looked = 0;
};
OverBalls words_over_balls(const scene::Scene& scene) {
  OverBalls sum;
  const sim::SceneInfo cast = scene.run()->scene_info();
  for_each_frame(scene, [&](const draw::List& list, const draw::Projection& page, const sim::Snapshot& now) {
    for (const draw::Text& text : list.texts) {
      if (text.spans[0].color.a < 100) continue;
      const double wide = shape(text).width, size = text.spans[0].size;
      const draw::Point half(wide / 2, 0.3 * size), middle = text.at + draw::Point(wide / 2, -0.3 * size);
      ++sum.looked;
      for (std::size_t i = 0; i < now.bodies.size(); ++i) {
        const sim::Vec3& center = now.bodies[i].position;
        const double radius = page.scale_at(center) * cast.bodies[i].radius;
        const draw::Point off = ((page.page(center) - middle).cwiseAbs() - half).cwiseMax(draw::Point(0, 0));
        if (off.norm() > 0.75 * radius) continue;
        ++sum.covered;
        break;
      }
    }
  });
  return sum;
}

/// Words of points and arrows go around their balls, not over them, and off the others where there is room.
TEST(PassingWords, GoAroundBalls) {
  const OverBalls words = words_over_balls(scene::parse(R"(duration = 6
[room]
size = [4, 3]
gravity = [0, 0]
[[ball]]
name = "a"
radius = 0.2
position = [0.5, 0.5]
velocity = [[0.7, 0.5], [-0.6, 0.8], [-0.9, -0.3], [0.5, -0.8], [0.2, -0.9], [-0.8, 0.1]]
elasticity = 1
copies = { count = [3, 2], offset = [[1.1, 0.2], [0.1, 1.2]] }
[film]
fps = 20
[[film.point]]
at = "a[0]"
label = "One"
dot = false
[[film.point]]
at = "a[1]"
label = "Two"
dot = false
[[film.vector]]
quantity = "velocity"
of = "a[0]"
label = "v_0 = {:.1} m/s"
[[film.vector]]
quantity = "velocity"
of = "a[1]"
label = "v_1 = {:.1} m/s"
[[film.vector]]
quantity = "velocity"
of = "a[2]"
label = "v_2 = {:.1} m/s"
[[film.vector]]
quantity = "velocity"
of = "a[3]"
label = "v_3 = {:.1} m/s"
)",
                                                        "many.toml"));
  EXPECT_GT(words.looked, 700);
  EXPECT_LE(words.covered, words.looked / 25);
}

/// Names that are too wide to stand side by side stand over each other, within the walls, and none on the
/// body of the other.
TEST(PassingWords, OfWideNamesNoneLiesOnAnotherBody) {
  const OverBalls words = words_over_balls(scene::parse(R"(duration = 1
[room]
size = [4, 3]
[[ball]]
name = "a"
position = [1, 1]
label = "the first ball of the two that we throw"
[[ball]]
name = "b"
position = [3, 1]
label = "the second ball of the two that we throw"
[[film.plot]]
quantity = ["height"]
of = ["a", "b"]
place = "below"
)",
                                                        "wide.toml"));
  EXPECT_EQ(words.looked, 2 * 60);
  EXPECT_EQ(words.covered, 0);
}

const char* const kAFilmOfALabel = R"(duration = 0.1
[room]
size = [4, 3]
[[ball]]
name = "a"
radius = 0.3
position = [1, 1]
[[film.label]]
at = [9, 9]
text = "far away"
[[film.label]]
at = [1, 2]
text = "here"
)";

/// A label or point at a place that no picture shows is told of, by check as by render.
TEST(PassingWords, OutsideOfThePictureAreTold) {
  const scene::Scene scene = scene::parse(kAFilmOfALabel, "a.toml");
  EXPECT_THAT(never_shown(scene),
              ElementsAre("the label 'far away' is never shown: its place is outside of the picture"));
  testing::internal::CaptureStderr();
  app::ahead(scene);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "a.toml: note: the label 'far away' is never shown: its place is outside of the picture\n");
  // a camera that goes there shows it
  const std::string camera = kAFilmOfALabel + std::string("[camera]\n");
  EXPECT_THAT(never_shown(scene::parse(camera + "center = [9, 8]\nwidth = 4\n", "a.toml")),
              ElementsAre("the label 'here' is never shown: its place is outside of the picture"));
  EXPECT_THAT(never_shown(scene::parse(camera + "keys = [{ time = 0, center = [1, 1], width = 4 }, "
                                                "{ time = 0.1, center = [9, 8], width = 4 }]\n",
                                       "a.toml")),
              IsEmpty());
}

/// Of runs over each other words keep off the bodies of all.
TEST(PassingWords, KeepOffTheBodiesOfOtherRuns) {
  const scene::Scene scene = scene::parse(R"(duration = 1.5
[room]
size = [4, 3]
[[ball]]
name = "a"
radius = 0.2
position = [1, 1.5]
velocity = [1, 0]
label = "a"
[film]
vary = "a.elasticity=0.2,0.6,1"
vary_place = "over"
fps = 15
[[film.vector]]
quantity = "velocity"
of = "a"
label = "v = {:.1}"
)",
                                          "over.toml");
  const Ahead ahead = app::ahead(scene);
  ASSERT_TRUE(ahead.runs);
  const std::vector<draw::Illustrator> artists = depictors(scene, ahead);
  const draw::Annotations& annotations = *ahead.runs->front().annotations;
  std::vector<std::unique_ptr<sim::Run>> runs;
  for (const Ahead::Run& each : *ahead.runs) runs.push_back(each.scene.run());
  const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  int looked = 0, covered = 0;
  for (std::int64_t frame = 0; frame < shots.size(); ++frame) {
    std::vector<sim::Snapshot> nows;
    for (std::size_t i = 0; i < runs.size(); ++i)
      nows.push_back(moment(*runs[i], shots[frame].time, (*ahead.runs)[i].scene));
    const draw::Projection page = artists.front().projection(0, nows.front());
    draw::List list;
    annotations.draw(0, page, nows.front(), double(frame) / sim::value(scene.film.fps), list);
    for (const draw::Text& text : list.texts) {
      const double size = text.spans[0].size;
      const draw::Point middle = text.at + draw::Point(shape(text).width / 2, -0.3 * size);
      ++looked;
      covered += std::any_of(nows.begin(), nows.end(), [&](const sim::Snapshot& now) {
        const sim::Vec3& center = now.bodies[0].position;
        return (page.page(center) - middle).norm() < 0.2 * page.scale_at(center);
      });
    }
  }
  EXPECT_GT(looked, 30);
  EXPECT_EQ(covered, 0) << "of " << looked;
}

}  // namespace
}  // namespace obscura::app
