// What a film says about its run: arrows end where the quantity says, numbers are the run's, words stay clear
// of what is there and do not jump, and a frame is the same whoever draws it.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/run/ahead.h"
#include "app/run/measures.h"
#include "app/run/simulation.h"
#include "draw/compose/annotations.h"
#include "draw/page/measure.h"
#include "draw/page/readings.h"
#include "draw/picture/formula.h"
#include "draw/picture/type.h"
#include "draw/plane/stage.h"
#include "needs.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kScenes = OBSCURA_SOURCE_DIR "/scenes/";

/// A film's frames as lists of things, at their times.
struct Filmed {
  scene::Scene scene;
  Ahead ahead;
  draw::Illustrator artist;
  std::unique_ptr<sim::Run> run;
  Shots shots;

  explicit Filmed(const std::string& file, const std::vector<std::string>& sets = {})
      : Filmed(scene::read(file, sets)) {}
  explicit Filmed(scene::Scene read)
      : scene(std::move(read)),
        ahead(app::ahead(scene)),
        artist(depictor(scene, ahead)),
        run(scene.run()),
        shots(Shots::film(scene.duration, scene.film.fps, scene.film.speed)) {}

  double film(std::int64_t frame) const { return double(frame) / sim::value(scene.film.fps); }
  sim::Snapshot now(std::int64_t frame) { return moment(*run, shots[frame].time, scene); }
  draw::List marks(const sim::Snapshot& now, std::int64_t frame) const {
    draw::List list;
    ahead.annotations->draw(0, artist.projection(0, now), now, film(frame), list);
    return list;
  }
};

/// Everything a line of type says.
std::string said(const draw::Text& text) {
  std::string all;
  for (const draw::Span& span : text.spans) all += span.text;
  return all;
}

/// The tips of the arrows of a list: the first corner of each head in ink.
std::vector<draw::Point> tips(const draw::List& list, draw::Color color) {
  std::vector<draw::Point> all;
  for (const draw::Polygon& polygon : list.polygons)
    if (polygon.fill == color && polygon.end - polygon.begin == 4)
      all.push_back(list.points[std::size_t(polygon.begin)]);
  return all;
}

/// One arrow of every quantity on the bodies of shipped scenes: at ten frames its tip is where tail, value
/// and scale say. A pixel of a film at 1080p is a unit.
TEST(Marks, AnArrowsTipLiesWhereTheQuantitySays) {
  const std::array<std::pair<const char*, const char*>, 10> films{{{"slope", "block"},
                                                                   {"swing", "bob"},
                                                                   {"bounce", ""},
                                                                   {"spring", ""},
                                                                   {"pendulum", "bob"},
                                                                   {"drag", ""},
                                                                   {"chain", ""},
                                                                   {"energy", "ball"},
                                                                   {"top", ""},
                                                                   {"cradle", ""}}};
  int arrows = 0;
  for (const auto& [name, named] : films) {
    scene::Scene scene = scene::read(kScenes + name + ".toml");
    scene.film.marks = {};
    scene.film.speed = {};
    scene.film.titles = {};
    scene.film.charts.clear();
    scene.duration = std::min(scene.duration, sim::Rational{3, 1}, [](auto a, auto b) { return a < b; });
    const auto run = scene.run();
    int body = -1;
    for (std::size_t i = 0; i < run->scene_info().bodies.size(); ++i) {
      const auto& each = run->scene_info().bodies[i];
      if (!each.fixed && (body < 0 || each.name == named)) body = int(i);
    }
    ASSERT_GE(body, 0) << name;
    const draw::Color ink{1, 2, 3};
    for (const std::string& word : draw::arrows()) {
      const draw::Quantity quantity = *draw::measure(word)->arrow;
      draw::Scales any;
      if (!draw::scale_of(quantity, any)) continue;
      draw::Marks::Vector vector;
      vector.quantity = quantity, vector.body = body, vector.color = ink;
      scene.film.marks.vectors = {vector};
      Filmed film(scene);
      for (int k = 1; k <= 4; ++k) {
        const std::int64_t frame = k * film.shots.size() / 5;
        const sim::Snapshot now = film.now(frame);
        const draw::Projection page = film.artist.projection(0, now);
        const std::vector<draw::Point> found = tips(film.marks(now, frame), ink);
        draw::Scales scales = film.ahead.annotations->scales();
        const double scale = *draw::scale_of(quantity, scales);
        std::size_t shown = 0;
        for (const draw::Reading& each : draw::readings(vector, film.artist.scene_info(), now)) {
          const draw::Point tail = page.page(each.tail), tip = page.page(each.tail + scale * each.value);
          const draw::Rect& window = page.window();
          const auto inside = [&](const draw::Point& p) {
            return p.x() > window.x + 9 && p.y() > window.y + 9 && p.x() < window.x + window.width - 9 &&
                   p.y() < window.y + window.height - 9;
          };
          if ((tip - tail).norm() < 12 || !inside(tail) || !inside(tip)) continue;
          ++shown, ++arrows;
          double nearest = 1e300;
          for (const draw::Point& p : found) nearest = std::min(nearest, (p - tip).norm());
          EXPECT_LT(nearest, 0.5) << name << " " << word << " at " << now.time;
        }
        EXPECT_LE(shown, found.size()) << name << " " << word;
      }
    }
  }
  EXPECT_GT(arrows, 150) << "too few were looked at";
}

/// A force of a contact begins where it acts, or where the scene has it.
TEST(Marks, AForceBeginsWhereItActsOrAtItsPlace) {
  Filmed film(scene::read(std::string(kScenes) + "slope.toml"));
  const sim::Snapshot now = film.now(0);
  draw::Marks::Vector vector;
  vector.body = 0;
  for (const draw::Quantity quantity : {draw::Quantity::normal_force, draw::Quantity::friction}) {
    vector.quantity = quantity, vector.at.reset();
    const auto acts = draw::readings(vector, film.artist.scene_info(), now);
    vector.at.emplace(), vector.at->body = 0;
    const auto moved = draw::readings(vector, film.artist.scene_info(), now);
    ASSERT_EQ(acts.size(), 1u);
    ASSERT_EQ(moved.size(), 1u);
    // the block is 0.6 m thick
    const sim::Vec3 normal(0.5, std::sqrt(0.75), 0);
    EXPECT_NEAR((now.bodies[0].position - acts[0].tail).dot(normal), 0.3, 1e-6);
    EXPECT_EQ(moved[0].tail, now.bodies[0].position);
    EXPECT_EQ(moved[0].value, acts[0].value);
  }
}

/// Numbers in labels are those of `states`, rounded as the label says: over ten films.
TEST(Marks, PrintedNumbersAreTheRuns) {
  for (const auto& [file, word, body, path] :
       {std::tuple("slope", "normal_force", "block", "block.normal_force"),
        std::tuple("slope", "friction", "block", "block.friction"),
        std::tuple("slope", "net_force", "block", "block.net_force"),
        std::tuple("slope", "weight", "block", "block.weight"),
        std::tuple("swing", "joint_force", "bob", "bob.joint_force"),
        std::tuple("swing", "momentum", "bob", "bob.momentum"),
        std::tuple("pendulum", "spring_force", "bob", "bob.spring_force"),
        std::tuple("pendulum", "acceleration", "bob", "bob.acceleration"),
        std::tuple("swing", "kinetic", "bob", "bob.kinetic"),
        std::tuple("energy", "height", "ball", "ball.position.y"),
        std::tuple("bounce", "height", "ball[2]", "ball[2].position.y"),
        std::tuple("spring", "spring_force", "weight[1]", "weight[1].spring_force"),
        std::tuple("drag", "vx", "ball[3]", "ball[3].velocity.x"),
        std::tuple("planets", "momentum", "planet_1", "planet_1.momentum"),
        std::tuple("atwood", "vy", "left", "left.velocity.y"),
        std::tuple("cradle", "kinetic", "swung", "swung.kinetic")}) {
    scene::Scene scene = scene::read(kScenes + file + ".toml");
    scene.film.marks = {};
    scene.film.charts.clear();
    scene.duration = std::min(scene.duration, sim::Rational{3, 1}, [](auto a, auto b) { return a < b; });
    const auto run = scene.run();
    int index = -1;
    for (std::size_t i = 0; i < run->scene_info().bodies.size(); ++i)
      if (run->scene_info().bodies[i].name == body) index = int(i);
    ASSERT_GE(index, 0) << file;
    scene.film.marks.labels = {{{-1, {1, 1, 0}}, "Q = {:.3}", word, index}};
    Filmed film(scene);
    for (int k = 1; k <= 6; ++k) {
      const std::int64_t frame = k * film.shots.size() / 7;
      const sim::Snapshot now = film.now(frame);
      const draw::List list = film.marks(now, frame);
      ASSERT_EQ(list.texts.size(), 1u);
      std::string shown = said(list.texts[0]);
      shown = shown.substr(shown.find("=") + 1);
      if (const auto minus = shown.find("−"); minus != shown.npos) shown.replace(minus, 3, "-");
      const auto asked = questions(std::string(path) + "@" + sim::text(film.shots[frame].time));
      const double value = std::stod(answers(scene, asked).values[0]);
      EXPECT_NEAR(std::stod(shown), value, 0.0005 + 1e-9) << file << " " << word << " at " << now.time;
    }
  }
}

double width_of(const draw::Text& text) {
  double width = 0;
  for (const draw::Span& span : text.spans)
    width += span.lead + draw::width_of(span.text, span.face, span.size, span.tabular);
  return width;
}

/// The words of a film, frame by frame: how far each goes by itself.
void walk(const std::string& name, const std::vector<std::string>& sets = {}) {
  Filmed film(kScenes + name + ".toml", sets);
  const double most = 2, near = 250;
  std::map<std::string, std::vector<draw::Point>> before;
  std::vector<draw::Point> anchors_before;
  int looked = 0;
  for (std::int64_t frame = 0; frame < film.shots.size(); ++frame) {
    const sim::Snapshot now = film.now(frame);
    const draw::Projection page = film.artist.projection(0, now);
    const draw::List list = film.marks(now, frame);
    // what words can belong to: bodies, ends of arrows
    std::vector<draw::Point> anchors;
    for (const sim::Snapshot::Body& body : now.bodies) anchors.push_back(page.page(body.position));
    for (const draw::Marks::Vector& vector : film.scene.film.marks.vectors) {
      draw::Scales scales = film.ahead.annotations->scales();
      const double* scale = draw::scale_of(vector.quantity, scales);
      for (const draw::Reading& each : draw::readings(vector, film.artist.scene_info(), now)) {
        anchors.push_back(page.page(each.tail));
        anchors.push_back(page.page(each.tail + (scale ? *scale : 1) * each.value));
      }
    }
    // alike ones in their order, where there are as many as before
    std::map<std::string, std::vector<draw::Point>> words;
    for (const draw::Text& text : list.texts)
      words[said(text).substr(0, 3)].push_back(text.at + draw::Point(width_of(text) / 2, 0));
    for (const auto& [letters, places] : words) {
      const std::vector<draw::Point>& then = before[letters];
      if (then.size() != places.size() || anchors.size() != anchors_before.size()) continue;
      for (std::size_t i = 0; i < places.size(); ++i) {
        // what they name is not far; the end of an arrow turns the words at its side as well
        double moved = 0;
        for (std::size_t k = 0; k < anchors.size(); ++k)
          if ((anchors_before[k] - then[i]).norm() < near)
            moved = std::max(moved, (anchors[k] - anchors_before[k]).norm());
        ++looked;
        EXPECT_LT((places[i] - then[i]).norm(), most + 1.6 * moved)
            << name << ": \"" << letters << "\" at frame " << frame;
      }
    }
    before = std::move(words), anchors_before = std::move(anchors);
  }
  EXPECT_GT(looked, 50) << name;
}

TEST(Marks, WordsDoNotJump) {
  for (const char* name : {"slope", "swing", "atwood", "conveyor", "gears", "kapitza", "loop_the_loop",
                           "platform", "crossed_fields"})
    walk(name);
  walk("slope", {"film.fps=30"});
}

/// Words of one page do not cover each other: boxes that reach so far up and down from the baseline, ems.
void expect_apart(const draw::List& list, const std::string& where, double up = 0.7, double down = 0.2) {
  std::vector<draw::Rect> all;
  for (const draw::Text& text : list.texts) {
    double size = 0;
    for (const draw::Span& span : text.spans) size = std::max(size, span.size);
    all.push_back({text.at.x(), text.at.y() - up * size, width_of(text), (up + down) * size});
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const double w =
          std::min(all[i].x + all[i].width, all[k].x + all[k].width) - std::max(all[i].x, all[k].x);
      const double h =
          std::min(all[i].y + all[i].height, all[k].y + all[k].height) - std::max(all[i].y, all[k].y);
      // those that have all but gone do not count
      const int seen = std::min(list.texts[i].spans[0].color.a, list.texts[k].spans[0].color.a);
      EXPECT_FALSE(w > 1 && h > 1 && seen > 50)
          << seen << " \"" << said(list.texts[i]) << "\" and \"" << said(list.texts[k]) << "\" " << where;
    }
}

TEST(Marks, WordsKeepClearOfEachOther) {
  for (const char* name : {"slope", "swing", "atwood", "conveyor", "drag", "gears", "kapitza",
                           "loop_the_loop", "platform", "three_bodies"}) {
    Filmed film(kScenes + name + ".toml");
    for (std::int64_t frame = 0; frame < film.shots.size(); frame += 5)
      expect_apart(film.marks(film.now(frame), frame), name + (" at frame " + std::to_string(frame)));
  }
}

/// The words of runs beside each other, frame by frame.
void expect_runs_apart(const char* toml, std::size_t runs) {
  const scene::Scene scene = scene::parse(toml, "beside.toml");
  const Ahead ahead = app::ahead(scene);
  const std::vector<draw::Illustrator> artists = depictors(scene, ahead);
  ASSERT_EQ(artists.size(), runs);
  for (std::size_t i = 0; i < artists.size(); ++i) {
    const Ahead::Run& one = (*ahead.runs)[i];
    const auto run = one.scene.run();
    const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
    for (std::int64_t frame = 0; frame < shots.size(); ++frame) {
      const sim::Snapshot now = moment(*run, shots[frame].time, one.scene);
      draw::List list;
      one.annotations->draw(0, artists[i].projection(0, now), now,
                            film_time(shots[frame], scene.film.fps, scene.film.speed), list);
      expect_apart(list, "of run " + std::to_string(i) + " at frame " + std::to_string(frame), 0.65, 0);
    }
  }
}

/// Nor while they go to another place. In the low windows of nine runs the label of a ball that bounces has
/// the other one on its way.
TEST(Marks, WordsKeepClearOfEachOtherOnTheirWay) {
  expect_runs_apart(R"(duration = 2
[room]
size = [4, 2]
[[ball]]
name = "ball"
radius = 0.15
position = [0.4, 1.5]
velocity = [1, 0]
[[when]]
touches = ["ball", "floor"]
do = [{ mark = "hit" }]
[look]
trails = 1
[film]
size = [1280, 720]
fps = 30
vary = "ball.elasticity=0.2:1:0.1"
speed = [{ time = "hit", freeze = 0.5 }]
[[film.vector]]
quantity = "velocity"
of = "ball"
label = "v = {:.2} m/s"
[[film.label]]
at = [2, 1.8]
text = "E = {:.2} J"
quantity = "energy"
)",
                    9);
}

/// Two labels of short arrows have each other in the way soon after the film begins and when the body leaves
/// the window: a plan of places that they cannot be at in time would let them lie on each other for long.
TEST(Marks, WordsKeepClearOfEachOtherWhereWaysTakeLong) {
  expect_runs_apart(R"(duration = 2
[room]
walls = [{ point = [0, 0], normal = [0, 1] }]
[[box]]
name = "block"
size = [0.5, 0.5]
position = [-1, 0.25]
velocity = [4, 0]
friction = 0.2
[camera]
center = [0.5, 1]
width = 5
[film]
vary = "block.friction=0,0.05,0.1,0.15,0.2,0.3,0.4,0.6,0.8"
[[film.vector]]
quantity = "velocity"
of = "block"
label = "v = {:.2} m/s"
[[film.vector]]
quantity = "friction"
of = "block"
label = "f = {:.1} N"
[[film.vector]]
quantity = "normal_force"
of = "block"
label = "N = {:.1} N"
[[film.vector]]
quantity = "weight"
of = "block"
label = "G = {:.1} N"
)",
                    9);
}

/// Where a line from a to b enters a rectangle, if it does.
bool crosses(const draw::Rect& rect, const draw::Point& a, const draw::Point& b) {
  double from = 0, to = 1;
  const auto cut = [&](double start, double way, double low, double high) {
    if (std::abs(way) < 1e-12) {
      if (start < low || start > high) to = -1;
      return;
    }
    const double s = (low - start) / way, t = (high - start) / way;
    from = std::max(from, std::min(s, t)), to = std::min(to, std::max(s, t));
  };
  cut(a.x(), b.x() - a.x(), rect.x, rect.x + rect.width);
  cut(a.y(), b.y() - a.y(), rect.y, rect.y + rect.height);
  return from < to;
}

/// The corners of a body's forms on the page, one list a form.
std::vector<std::vector<draw::Point>> outlines(const sim::SceneInfo::Body& body, int index,
                                               const sim::Snapshot& now, const draw::Projection& page) {
  const auto at = [&](const sim::Vec3& local) { return page.page(draw::place({index, local}, now)); };
  std::vector<std::vector<draw::Point>> all;
  const auto add = [&](const auto& form, const sim::Vec3& center, const Eigen::Quaterniond& turn) {
    std::vector<draw::Point>& outline = all.emplace_back();
    for (int k = 0; k < 24 && form.kind != sim::ShapeKind::polygon; ++k) {
      const double way = k * 0.26179938779914941;
      sim::Vec3 local = form.radius * sim::Vec3(std::cos(way), std::sin(way), 0);
      if (form.kind == sim::ShapeKind::box)
        local = form.half.cwiseProduct(sim::Vec3(k / 6 == 0 || k / 6 == 3 ? 1 : -1, k / 6 < 2 ? 1 : -1, 0));
      outline.push_back(at(center + turn * local));
    }
    for (const sim::Vec3& vertex : form.vertices) outline.push_back(at(center + turn * vertex));
  };
  for (const auto& part : body.parts) add(part, part.center, part.turn);
  if (body.parts.empty()) add(body, sim::Vec3::Zero(), Eigen::Quaterniond::Identity());
  return all;
}

/// What words should keep off in a picture of a film in the plane.
std::vector<std::pair<draw::Point, draw::Point>> lines_there(const Filmed& film, const sim::Snapshot& now,
                                                             double at) {
  std::vector<std::pair<draw::Point, draw::Point>> lines;
  const draw::Projection page = film.artist.projection(0, now);
  const sim::SceneInfo& cast = film.artist.scene_info();
  for (std::size_t i = 0; i < cast.bodies.size(); ++i)
    for (const auto& outline : outlines(cast.bodies[i], int(i), now, page))
      for (std::size_t k = 0; k < outline.size(); ++k)
        lines.emplace_back(outline[k], outline[(k + 1) % outline.size()]);
  // the hatching behind the walls
  for (const draw::HalfPlane& wall : draw::half_planes(cast, *page.view())) {
    const draw::Point along(-wall.normal.y(), wall.normal.x());
    for (const double deep : {2.0, 8.0, 14.0, 20.0}) {
      const draw::Point on = wall.point - deep * film.artist.weight() * wall.normal;
      lines.emplace_back(on - 1e4 * along, on + 1e4 * along);
    }
  }
  draw::Scales scales = film.ahead.annotations->scales();
  for (const draw::Marks::Vector& vector : film.scene.film.marks.vectors) {
    if (!vector.shown.has(now.time, at)) continue;
    const double* scale = draw::scale_of(vector.quantity, scales);
    for (const draw::Reading& each : draw::readings(vector, cast, now))
      lines.emplace_back(page.page(each.tail), page.page(each.tail + (scale ? *scale : 1) * each.value));
  }
  return lines;
}

/// Words cover no body's outline, no arrow and no hatching: letters' own boxes, a pixel in. Shipped scenes of
/// the plane that say something, each tenth of a second: of the ten of a lecturer's list all but two,
/// whose words are in their plots alone. Where many bodies pass by, some may pass under words, which have a
/// plate then.
TEST(Marks, WordsKeepClearOfBodiesAndArrows) {
  const std::array<std::pair<const char*, double>, 18> films{{{"slope", 0},
                                                              {"conveyor", 0},
                                                              {"gears", 0},
                                                              {"platform", 0},
                                                              {"ballistic_pendulum", 0},
                                                              {"stick_slip", 0},
                                                              {"bounce", 0},
                                                              {"swing", 0},
                                                              {"energy", 0},
                                                              {"kapitza", 0},
                                                              {"loop_the_loop", 0},
                                                              {"spring", 0},
                                                              {"atwood", 0},
                                                              {"crossed_fields", 0.004},
                                                              {"pendulum", 0.003},
                                                              {"brachistochrone", 0.01},
                                                              {"block_and_tackle", 0},
                                                              {"drag", 0}}};
  for (const auto& [name, most] : films) {
    Filmed film(kScenes + name + ".toml");
    int looked = 0, covered = 0;
    std::map<std::string, std::vector<double>> where;
    for (std::int64_t frame = 0; frame < film.shots.size(); frame += 6) {
      const sim::Snapshot now = film.now(frame);
      const draw::List list = film.marks(now, frame);
      const auto lines = lines_there(film, now, film.film(frame));
      for (const draw::Text& text : list.texts) {
        // words of an arrow that has all but gone have too
        if (text.spans[0].color.a < 100) continue;
        double size = 0;
        for (const draw::Span& span : text.spans) size = std::max(size, span.size);
        const draw::Rect rect{text.at.x() + 1, text.at.y() - 0.62 * size, width_of(text) - 2, 0.6 * size};
        ++looked;
        if (std::none_of(lines.begin(), lines.end(),
                         [&](const auto& line) { return crosses(rect, line.first, line.second); }))
          continue;
        ++covered, where[said(text).substr(0, 4)].push_back(now.time);
      }
    }
    std::string told;
    for (const auto& [words, times] : where) {
      told += " \"" + words + "\" at";
      for (std::size_t k = 0; k < times.size(); k += std::max<std::size_t>(1, times.size() / 8))
        told += " " + std::to_string(times[k]).substr(0, 4);
    }
    EXPECT_GT(looked, 20) << name;
    EXPECT_LE(covered, most * looked) << name << ": " << covered << " of " << looked << told;
  }
}

/// The friction on a body that is hardly longer than the body is wide is named past the body, not on what it
/// lies on.
TEST(Marks, FrictionIsNamedPastItsBody) {
  Filmed film(kScenes + "stick_slip.toml");
  int looked = 0;
  for (std::int64_t frame = 0; frame < film.shots.size(); frame += 10) {
    const sim::Snapshot now = film.now(frame);
    const draw::Projection page = film.artist.projection(0, now);
    const double belt = page.page({4.3, 1, 0}).y();
    for (const draw::Text& text : film.marks(now, frame).texts)
      if (said(text).starts_with("f")) {
        ++looked;
        EXPECT_LT(text.at.y(), belt) << "frame " << frame;
      }
  }
  EXPECT_GT(looked, 50);
}

/// The words of an arrow that swings among others stand by its body, not as far off as it is long.
TEST(Marks, WordsOfAnArrowThatSwingsStandByItsBody) {
  Filmed film(scene::parse(R"(title = "A charge in a field and a spring"
duration = 3
[room]
size = [6, 4]
walls = "none"
gravity = [0, -9.81]
electric = [3, 0]
[[ball]]
name = "q"
radius = 0.18
mass = 0.5
charge = 1
position = [3, 1.6]
drag = 0.2
[[spring]]
between = ["q", [3, 3.4]]
stiffness = 12
rest_length = 1.2
[[film.vector]]
quantity = "weight"
of = "q"
label = "m g = {:.1} N"
[[film.vector]]
quantity = "spring_force"
of = "q"
label = "F_s = {:.1} N"
[[film.vector]]
quantity = "field"
of = "q"
label = "q E = {:.1} N"
[[film.vector]]
quantity = "acceleration"
of = "q"
label = "a = {:.1} m/s²"
[[film.length]]
between = [[3, 3.4], "q"]
label = "l = {:.2} m"
offset = 8
[[film.path]]
at = "q"
)",
                           "swings.toml"));
  double off = 0;
  int looked = 0;
  for (std::int64_t frame = 0; frame < film.shots.size(); frame += 5) {
    const sim::Snapshot now = film.now(frame);
    const draw::Point body = film.artist.projection(0, now).page(now.bodies[0].position);
    for (const draw::Text& text : film.marks(now, frame).texts)
      if (said(text).starts_with("a")) {
        const draw::Point middle = text.at + draw::Point(70, -10);
        ++looked, off += (middle - body).norm();
      }
  }
  ASSERT_GT(looked, 20);
  EXPECT_LT(off / looked, 250);
}

TEST(Marks, WordsLieOnWhatIsFixedAndPale) {
  const auto look = [](const std::string& theme, const std::string& color) {
    std::vector<std::string> sets{"look.theme=" + theme};
    if (!color.empty()) sets.push_back("wedge.color=" + color);
    Filmed film(scene::read(kScenes + "slope.toml", sets));
    const std::int64_t frame = 200;  // 1 s
    const sim::Snapshot now = film.now(frame);
    const draw::List list = film.marks(now, frame);
    const draw::Projection page = film.artist.projection(0, now);
    int on = 0, plates = 0;
    for (const draw::Text& text : list.texts) {
      // right of the wedge's upright side, under its slope
      const sim::Vec3 low(0, 0, 0), high(0, 2.4, 0), toe(4.156922, 0, 0);
      const draw::Point a = page.page(high), b = page.page(toe);
      const double slope = (b.y() - a.y()) / (b.x() - a.x());
      const bool under = text.at.x() > page.page(low).x() && text.at.y() < page.page(low).y() &&
                         text.at.y() > a.y() + slope * (text.at.x() - a.x());
      if (!under || !said(text).starts_with("G")) continue;
      ++on;
      for (const draw::Box& box : list.boxes)
        plates += box.fill.a < 255 && std::abs(box.center.y() - text.at.y()) < box.half.y() &&
                  std::abs(box.center.x() - text.at.x()) < box.half.x();
    }
    EXPECT_GT(on, 0) << theme << " " << color;
    return plates > 0;
  };
  EXPECT_FALSE(look("paper", ""));
  EXPECT_FALSE(look("screen", ""));
  EXPECT_FALSE(look("paper", "grey"));
  EXPECT_TRUE(look("screen", "yellow"));
}

/// The forces by their kinds add up, and to what the motion shows: the change of velocity over a step.
TEST(Marks, TheKindsOfForcesAddUpToTheAcceleration) {
  for (const char* name :
       {"slope", "swing", "pendulum", "drag_particle", "spring", "planets", "crossed_fields"}) {
    const scene::Scene scene = scene::read(kScenes + name + ".toml");
    const auto run = scene.run();
    const sim::SceneInfo& cast = run->scene_info();
    const sim::Rational h = sim::Rational{1, 1} / run->rate();
    for (const std::int64_t step : {200, 331}) {
      const sim::Snapshot before = moment(*run, h * sim::rational(step - 1), scene);
      const sim::Snapshot now = moment(*run, h * sim::rational(step), scene);
      const sim::Snapshot after = moment(*run, h * sim::rational(step + 1), scene);
      for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
        if (cast.bodies[i].fixed) continue;
        const sim::Vec3 a = (after.bodies[i].velocity - before.bodies[i].velocity) / (2 * sim::value(h));
        const sim::Vec3 found = draw::sum(draw::Quantity::acceleration, int(i), cast, now);
        EXPECT_LT((found - a).norm(), 0.02 * (1 + a.norm())) << name << ", " << cast.bodies[i].name;
        const auto of = [&](draw::Quantity q) { return draw::sum(q, int(i), cast, now); };
        EXPECT_LT(
            (of(draw::Quantity::normal_force) + of(draw::Quantity::friction) - of(draw::Quantity::contact))
                .norm(),
            1e-12 * (1 + of(draw::Quantity::contact).norm()));
      }
    }
  }
}

using MarkedFilm = Program;

const char* const kMarkedFilm = R"(duration = 1
[room]
size = [4, 2.25]
[[ball]]
name = "ball"
radius = 0.1
position = [0.5, 1]
velocity = [2, 2]
[film]
speed = [{ time = 0.5, freeze = 0.5 }]
badge = true
[[film.vector]]
quantity = "velocity"
of = "ball"
label = "v = {:.2} m/s"
[[film.label]]
at = "ball"
text = "it stands"
start = 0.5
end = { time = 0.5, after = 0.25 }
[[film.path]]
at = { body = "ball", local = [0.1, 0] }
[[film.ghost]]
time = 0.25
[[film.caption]]
text = "A ball flies."
end = 0.5
[[film.card]]
title = "First"
lasting = 0.2
[[film.card]]
time = 1
text = "Last"
lasting = 0.2
)";

TEST_F(MarkedFilm, WithMarksIsTheSameByShardsAndResumedAndInStills) {
  scene(kMarkedFilm);
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o whole.mp4").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o parts.mp4 --shard 1/2").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o parts.mp4 --shard 2/2").exit, 0);
  ASSERT_EQ(obscura("join parts.mp4").exit, 0);
  EXPECT_EQ(contents(path("whole.mp4")), contents(path("parts.mp4")));
  const Outcome compared = obscura("compare whole.mp4 parts.mp4");
  EXPECT_EQ(compared.exit, 0) << compared.out;
  // 0.2 s of a card, 0.5 s, 0.5 s still, 0.5 s, 0.2 s of a card
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o frames/{frame}.png").exit, 0);
  int frames = 0;
  for (const auto& each : std::filesystem::directory_iterator(path("frames")))
    frames += each.is_regular_file();
  EXPECT_EQ(frames, 38);
  // still a frame of the film
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 --at 0.75 -o still.png").exit, 0);
  const Outcome still = obscura("compare still.png frames/29.png");
  EXPECT_EQ(still.exit, 0) << still.out;
}

/// The captions of a film lie beside it and in it, to the frame, with its cards as chapters.
TEST_F(MarkedFilm, HasItsCaptionsAsText) {
  scene(std::string(kMarkedFilm) + "[[film.caption]]\ntext = \"a < b & c\"\nstart = 0.25\n");
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o whole.mp4").exit, 0);
  const std::string words = contents(path("whole.vtt"));
  EXPECT_EQ(words, R"(WEBVTT

00:00:00.200 --> 00:00:00.450
A ball flies.

00:00:00.450 --> 00:00:00.700
A ball flies.
a &lt; b &amp; c

00:00:00.700 --> 00:00:01.700
a &lt; b &amp; c
)");
  for (int shard = 1; shard <= 2; ++shard)
    ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o parts.mp4 --shard " +
                      std::to_string(shard) + "/2")
                  .exit,
              0);
  ASSERT_EQ(obscura("join parts.mp4").exit, 0);
  EXPECT_EQ(contents(path("parts.vtt")), words);
  const std::string movie = contents(path("whole.mp4"));
  EXPECT_EQ(contents(path("parts.mp4")), movie);
  EXPECT_THAT(movie, HasSubstr("tx3g"));
  EXPECT_THAT(movie, HasSubstr("A ball flies.\na < b & c"));
  // a chapter a card
  EXPECT_THAT(movie, HasSubstr("chpl"));
  EXPECT_THAT(movie, HasSubstr("First"));
  // it is whole, and a film like others
  EXPECT_THAT(obscura("render scene.toml --size 320x180 --fps 20 -o whole.mp4 --resume").out,
              HasSubstr("is whole already"));
  const Outcome verified = obscura("verify whole.mp4");
  EXPECT_EQ(verified.exit, 0) << verified.out << verified.err;
  for (const char* other : {"whole.mkv", "whole.mov"})
    EXPECT_EQ(obscura(std::string("render scene.toml --size 320x180 --fps 20 -o ") + other).exit, 0) << other;
  EXPECT_THAT(contents(path("whole.mkv")), HasSubstr("S_TEXT/UTF8"));
  // and has every frame: words come in between packets
  if (installed("ffprobe")) {
    ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o frames/{frame}.png").exit, 0);
    int frames = 0;
    for (const auto& each : std::filesystem::directory_iterator(path("frames")))
      frames += each.is_regular_file();
    for (const char* name : {"whole.mp4", "whole.mkv", "whole.mov"})
      EXPECT_EQ(shell(std::string("ffprobe -v error -count_packets -select_streams v -show_entries "
                                  "stream=nb_read_packets -of csv=p=0 ") +
                      name)
                    .out,
                std::to_string(frames) + "\n")
          << name;
  }
  // without captions there is no such file
  scene("duration = 0.1\n[room]\nsize = [4, 2.25]\n");
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o mute.mp4").exit, 0);
  EXPECT_FALSE(std::filesystem::exists(path("mute.vtt")));
}

/// Words that come and go with an arrow that is never long enough are never read: that is told; nor is it of
/// what is not there at all.
TEST_F(MarkedFilm, TellsWhichArrowIsNeverSeen) {
  const std::string vectors =
      "[[film.vector]]\nquantity = \"drag\"\nof = \"ball\"\nlabel = \"D\"\n"
      "[[film.vector]]\nquantity = \"friction\"\nof = \"ball\"\nlabel = \"f\"\n"
      "[[film.vector]]\nquantity = \"weight\"\nof = \"ball\"\nlabel = \"G\"\n";
  const std::string ball =
      "duration = 0.2\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [2, 2]\n"
      "velocity = [0.1, 0]\ndrag = 0.0003\n";
  scene(ball + vectors);
  const Outcome run = obscura("render scene.toml --at 0.1 --size 320x180 -o a.png");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.err,
              HasSubstr("scene.toml: note: the arrow 'D' is never long enough for its words to be read"));
  EXPECT_THAT(run.err, HasSubstr("a larger look.force_scale makes it longer"));
  EXPECT_THAT(run.err, Not(HasSubstr("'f'")));
  EXPECT_THAT(run.err, Not(HasSubstr("'G'")));
  EXPECT_THAT(run.err, Not(HasSubstr("of the picture's height")));
}

/// The more it is missing, the less should that be passed over.
TEST_F(MarkedFilm, TellsOfAnArrowThatIsAThousandTimesTooShort) {
  scene(
      "duration = 0.2\n[room]\nsize = [4, 3]\n[[box]]\nname = \"crate\"\nsize = [0.4, 0.3]\nmass = 0.1\n"
      "position = [1, 0.15]\n[[ball]]\nname = \"ball\"\nradius = 0.3\nmass = 100\nposition = [3, 0.3]\n"
      "[[film.vector]]\nquantity = \"weight\"\nof = \"crate\"\nlabel = \"W_1\"\n"
      "[[film.vector]]\nquantity = \"weight\"\nof = \"ball\"\nlabel = \"W_2\"\n");
  const Outcome run = obscura("render scene.toml --at 0.1 --size 320x180 -o a.png");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the arrow 'W_1' is never long enough"));
  EXPECT_THAT(run.err, Not(HasSubstr("'W_2'")));
}

/// What only rounds to something is not there: nothing is said of a box that rests, nor of a run in space.
TEST_F(MarkedFilm, SaysNothingOfArrowsThatAreNone) {
  std::string vectors;
  for (const char* quantity : {"friction", "net_force", "velocity", "acceleration", "torque"})
    vectors +=
        "[[film.vector]]\nquantity = \"" + std::string(quantity) + "\"\nof = \"box\"\nlabel = \"{:.2}\"\n";
  scene(
      "duration = 0.2\n[room]\nsize = [4, 3]\n[[box]]\nname = \"box\"\nsize = [0.4, 0.3]\n"
      "position = [2, 0.15]\n" +
      vectors);
  const Outcome rests = obscura("render scene.toml --at 0.1 --size 320x180 -o a.png");
  EXPECT_EQ(rests.exit, 0) << rests.err;
  EXPECT_EQ(rests.err, "");
  scene(
      "duration = 0.2\n[room]\nsize = [4, 3, 4]\n[[ball]]\nname = \"box\"\nradius = 0.2\n"
      "position = [0, 1, 0]\n[[film.plot]]\nquantity = [\"height\"]\nof = \"box\"\n" +
      vectors);
  const Outcome space = obscura("render scene.toml --at 0.1 --size 320x180 -o a.png");
  EXPECT_EQ(space.exit, 0) << space.err;
  EXPECT_EQ(space.err, "");
}

/// Large words and plots may leave hardly any of the picture to the room.
TEST_F(MarkedFilm, TellsWhereItsRoomIsCrowdedOut) {
  const std::string plot = "[[film.plot]]\nquantity = [\"height\"]\nof = \"ball\"\n";
  scene(std::string(kMarkedFilm) + plot + plot);
  const std::string still = "render scene.toml --at 0.1 --size 320x180 -o a.png";
  EXPECT_THAT(obscura(still).err, Not(HasSubstr("of the picture's height")));
  const Outcome large = obscura(still + " --set look.type_scale=2");
  EXPECT_EQ(large.exit, 0) << large.err;
  EXPECT_THAT(large.err, HasSubstr("of the picture's height to the room"));
}

/// Marks of the run begin chapters, also where the film names none of them.
TEST_F(MarkedFilm, OfAShippedSceneComesToAllOfItsMarks) {
  int seen = 0;
  for (const auto& file : std::filesystem::directory_iterator(kScenes)) {
    if (file.path().extension() != ".toml") continue;
    if (contents(file.path()).find("mark = ") == std::string::npos) continue;
    ++seen;
    const Outcome run = obscura("check " + file.path().string());
    EXPECT_EQ(run.exit, 0) << file.path();
    EXPECT_THAT(run.err, Not(HasSubstr("does not come to"))) << file.path();
  }
  EXPECT_GT(seen, 4);
}

TEST_F(MarkedFilm, HasChaptersOfItsMarks) {
  if (!installed("ffprobe")) GTEST_SKIP() << "needs ffprobe";
  scene(R"(title = "A fall"
duration = 4
[room]
size = [4, 3]
[[ball]]
name = "ball"
radius = 0.25
position = [2, 1.25]
elasticity = 0.9
[[when]]
touches = ["ball", "floor"]
again = true
do = [{ mark = "hit" }]
)");
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 -o film.mp4").exit, 0);
  const std::string chapters = shell("ffprobe -v error -show_chapters -of csv film.mp4").out;
  EXPECT_THAT(chapters, HasSubstr("A fall"));
  // at the first frame after sqrt(2 h / g) = 0.4515 s
  EXPECT_THAT(chapters, HasSubstr(",0.500000,"));
  EXPECT_THAT(chapters, HasSubstr(",hit\n"));
  EXPECT_THAT(chapters, HasSubstr(",hit (3)\n"));
  EXPECT_THAT(chapters, Not(HasSubstr(",hit (2)\n"))) << "it is less than a second behind the first";
}

/// Captions have a strip of the page for themselves: the picture, and the plots below it, end above.
TEST(Captions, StandBelowThePicture) {
  const std::string plot = "[[film.plot]]\nquantity = [\"height\"]\nof = \"ball\"\n";
  for (const std::string& more : {std::string(), plot}) {
    Filmed film(scene::parse(kMarkedFilm + more, "marked.toml", {"film.fps=20"}));
    const sim::Snapshot now = film.now(8);
    const draw::Picture picture = film.artist.depict(now, {}, {now, film.film(8), 1});
    double words = 0, lowest = 0;
    for (const draw::Text& text : picture.moving.texts)
      (said(text) == "A ball flies." ? words : lowest) = std::max(lowest, text.at.y());
    for (const draw::Text& text : picture.still->texts) lowest = std::max(lowest, text.at.y());
    for (const draw::Node& node : picture.still->nodes) lowest = std::max(lowest, node.at.y());
    EXPECT_GT(words, 1000);
    EXPECT_LT(lowest, words - 20) << more;
    // and stay until the captions are gone
    const draw::Projection early = film.artist.projection(0, now),
                           late = film.artist.projection(0, film.now(30));
    EXPECT_EQ(early.page({0, 0, 0}), late.page({0, 0, 0}));
  }
}

/// The limits of a sum are within the strip, too: it is higher by what they reach below the line.
TEST(Captions, HaveRoomForTheirMathematics) {
  const auto strip = [](const std::string& words) {
    draw::Titles titles;
    titles.captions.push_back({.text = words});
    return draw::laid_out(titles, 16.0 / 9, 1);
  };
  const draw::Titles plain = strip("The momentum stays."),
                     sum = strip("The momentum $\\sum_i m_i v_i$ stays.");
  ASSERT_EQ(sum.captions[0].room.size(), 1u);
  EXPECT_GT(sum.captions[0].room[0].y(), plain.captions[0].room[0].y() + 5);
  EXPECT_NEAR(sum.foot - plain.foot, (sum.captions[0].room[0] - plain.captions[0].room[0]).sum(), 1e-9);
}

TEST(Fade, ComesFromThePageAndGoesToIt) {
  Filmed film(scene::parse(kMarkedFilm, "marked.toml", {"film.fps=20", "film.fade=0.4"}));
  std::vector<int> cover;
  for (std::int64_t frame = 0; frame < film.shots.size(); ++frame) {
    const sim::Snapshot now = film.now(frame);
    const draw::Picture picture = film.artist.depict(now, {}, {now, film.film(frame), 1});
    // it lies over all else: the last polygon
    const draw::Polygon& last = picture.moving.polygons.back();
    const bool page = picture.moving.points[std::size_t(last.begin)] == draw::Point(0, 0);
    cover.push_back(page && last.fill ==
                                draw::Color{picture.ground.r, picture.ground.g, picture.ground.b, last.fill.a}
                        ? last.fill.a
                        : 0);
  }
  ASSERT_EQ(cover.size(), 38u);
  EXPECT_EQ(cover[0], 255);
  EXPECT_EQ(cover[20], 0);
  EXPECT_GT(cover[37], 200);
  for (int i = 1; i < 8; ++i) EXPECT_LE(cover[std::size_t(i)], cover[std::size_t(i) - 1]);
}

TEST(Freeze, StandsStillForExactlySoManyFrames) {
  const scene::Scene scene = scene::parse(kMarkedFilm, "marked.toml");
  const Shots shots = Shots::film(scene.duration, {20, 1}, scene.film.speed);
  ASSERT_EQ(shots.size(), 38);
  int still = 0, first = 0, last = 0;
  for (std::int64_t i = 0; i < shots.size(); ++i) {
    still += shots[i].time == sim::Rational{1, 2};
    first += shots[i].time == sim::Rational{0, 1};
    last += shots[i].time == sim::Rational{1, 1};
    if (i > 0) {
      EXPECT_LE(shots[i - 1].time, shots[i].time);
    }
  }
  // the card's four, and the run's own first one
  EXPECT_EQ(first, 5);
  EXPECT_EQ(still, 11);
  EXPECT_EQ(last, 4);
}

TEST(Freeze, WordsComeAndGoMeanwhile) {
  Filmed film(scene::parse(kMarkedFilm, "marked.toml", {"film.fps=20"}));
  std::string shown;
  for (std::int64_t frame = 0; frame < film.shots.size(); ++frame) {
    const sim::Snapshot now = film.now(frame);
    const draw::List list = film.marks(now, frame);
    const bool there = std::any_of(list.texts.begin(), list.texts.end(), [](const draw::Text& text) {
      return said(text).find("stands") != std::string::npos;
    });
    shown += there ? '#' : '.';
  }
  // 0.2 s of a card and 0.5 s before; then 0.25 s of 0.5 s that it stands still
  EXPECT_EQ(shown, "..............#####...................");
}

TEST_F(MarkedFilm, MarksThatCannotBeAreErrorsWithTheirPlace) {
  scene(std::string(kMarkedFilm) + R"([[film.vector]]
quantity = "velocity"
label = "v"
[[film.vector]]
quantity = "normal_force"
of = "bal"
[[film.label]]
at = [1, 1]
text = "F = {:2.1f} N"
quantity = "kinetic"
[[film.path]]
at = [1, 1]
[[film.label]]
at = [1, 1]
text = "late"
start = 2
end = 1
)");
  const Outcome run = obscura("check scene.toml");
  EXPECT_EQ(run.exit, 3);
  EXPECT_THAT(run.err, HasSubstr("scene.toml:35:1: this vector needs 'of', the body that has it"));
  EXPECT_THAT(run.err, HasSubstr("did you mean 'ball'?"));
  EXPECT_THAT(run.err, HasSubstr("'text': expected {} or {:.2}, the number of decimals, got \"{:2.1f}\""));
  EXPECT_THAT(run.err, HasSubstr("a place of the room has no path: expected a body"));
  EXPECT_THAT(run.err, HasSubstr("'end' comes before 'start': it would never be shown"));
}

/// What `check` says of the length of a film counts where its run makes it stand still, and where it ends.
TEST_F(MarkedFilm, CheckCountsTheFreezesAtMarks) {
  const auto frames = [&](const std::string& more) {
    scene(
        "duration = 1\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = [1, 1]\n"
        "[[when]]\ntouches = [\"ball\", \"floor\"]\ndo = [{ " +
        more);
    const Outcome run = obscura("check scene.toml");
    EXPECT_EQ(run.exit, 0) << run.err;
    EXPECT_THAT(run.out, Not(HasSubstr("warning")));
    const std::size_t at = run.out.find(" frames");
    return std::stoi(run.out.substr(run.out.rfind(' ', at - 1)));
  };
  EXPECT_EQ(frames("mark = \"hit\" }]\n[film]\nfps = 20\n"), 20);
  EXPECT_EQ(frames("mark = \"hit\" }]\n[film]\nfps = 20\nspeed = [{ time = \"hit\", freeze = 0.5 }]\n"), 30);
  // 0.8 m take 0.404 s
  EXPECT_EQ(frames("stop = true }]\n[film]\nfps = 20\n"), 9);
}

/// A label that is longer than the room beside what it names moves over, and stays on the page.
TEST(Marks, WordsStayOnThePage) {
  const std::string text = R"(duration = 2
[room]
size = [0.02, 0.03]
[[ball]]
name = "bead"
radius = 0.001
position = [0.01, 0.02]
[film]
size = [720, 1280]
axes = true
[[film.vector]]
quantity = "weight"
of = "bead"
label = "a label that is quite long, weight = {:.8} N"
[[film.plot]]
quantity = ["height"]
of = "bead"
[[film.plot]]
quantity = ["energy", "kinetic"]
)";
  Filmed film(scene::parse(text, "long.toml", {}));
  for (std::int64_t frame = 0; frame < film.shots.size(); frame += 10) {
    const sim::Snapshot now = film.now(frame);
    const draw::Rect window = film.artist.projection(0, now).window();
    int words = 0;
    for (const draw::Text& each : film.marks(now, frame).texts) {
      words += said(each).find("quite long") != std::string::npos;
      EXPECT_GE(each.at.x(), window.x) << said(each) << " in frame " << frame;
      EXPECT_LE(each.at.x() + draw::shape(each).width, window.x + window.width) << said(each);
    }
    EXPECT_EQ(words, 1);
  }
}

/// Whatever digits a value has: what stands before it and behind it stays to the hundredth of a pixel.
TEST(Marks, ALabelWithAValueDoesNotMove) {
  const std::string text = R"(duration = 2
[room]
size = [6, 6]
[[ball]]
name = "ball"
radius = 0.2
position = [3, 0.5]
velocity = [0, 10.5]
[film]
size = [1280, 720]
[[film.label]]
at = [1.5, 4]
text = "v_y = {:.2} m/s"
quantity = "vy"
of = "ball"
)";
  Filmed film(scene::parse(text, "jump.toml", {}));
  std::set<std::size_t> lengths;
  std::set<std::int64_t> lefts, rights;
  for (std::int64_t frame = 0; frame < film.shots.size(); ++frame)
    for (const draw::Text& each : film.marks(film.now(frame), frame).texts) {
      lengths.insert(said(each).size());
      lefts.insert(std::llround(100 * each.at.x()));
      rights.insert(std::llround(100 * (each.at.x() + draw::shape(each).width)));
    }
  EXPECT_GE(lengths.size(), 3u);  // 10.01, 9.99, -9.99
  EXPECT_EQ(lefts.size(), 1u);
  EXPECT_EQ(rights.size(), 1u);
}

/// What the arrows of a label belong to is told by their numbers, in films and in figures, from the first
/// frame on; one thing alone has its arrow without one.
TEST(Marks, ArrowsOfOneLabelAreNumbered) {
  const std::string text = R"(duration = 0.5
[room]
size = [4, 3]
[physics]
collision = "event"
[[box]]
name = "ladder"
size = [0.1, 2.4]
position = [0.6434, 1.0643]
angle = 30
friction = 0.9
elasticity = 0
mass = 5
[[ball]]
name = "bob"
radius = 0.05
mass = 0.5
position = [0.6434, 0.5643]
[[joint]]
type = "rod"
name = "cord"
between = ["ladder", "bob"]
[[spring]]
name = "band"
between = ["ladder", [0.6434, 2.9]]
stiffness = 5
rest_length = 1
[film]
figure = true
[[figure.vector]]
quantity = "normal_force"
of = "ladder"
label = "N = {:.1} N"
[[film.vector]]
quantity = "friction"
of = "ladder"
label = "f_r"
[[film.vector]]
quantity = "contact"
of = "ladder"
label = "both together"
[[film.vector]]
quantity = "contact"
of = "ladder"
with = "floor"
label = "F"
[[film.vector]]
quantity = "spring_force"
of = "ladder"
with = "band"
label = "S"
[[film.vector]]
quantity = "joint_force"
of = "ladder"
with = "cord"
label = "T"
[figure]
at = [0.4]
)";
  Filmed film(scene::parse(text, "ladder.toml"));
  ASSERT_EQ(film.scene.film.marks.vectors.size(), 6u);
  const sim::Snapshot late = film.now(24);
  std::string words;
  for (const draw::Text& line : film.marks(late, 24).texts) words += said(line) + "|";
  for (const char* each : {"N1 = ", "N2 = ", "fr1", "fr2", "both together", "F|", "S|", "T|"})
    EXPECT_THAT(words, HasSubstr(each));
  draw::Marks marks = film.scene.film.marks;
  const std::vector<sim::Snapshot> moments{late};
  draw::number_arrows(marks, film.artist.scene_info(), moments, std::vector<double>{0.4});
  std::vector<std::size_t> numbers, arrows;
  for (const draw::Marks::Vector& vector : marks.vectors) {
    numbers.push_back(vector.numbered.size());
    arrows.push_back(draw::readings(vector, film.artist.scene_info(), moments[0]).size());
  }
  EXPECT_EQ(numbers, (std::vector<std::size_t>{2, 2, 2, 0, 0, 0}));
  EXPECT_EQ(arrows, (std::vector<std::size_t>{2, 2, 2, 1, 1, 1}));
  EXPECT_EQ(draw::readings(marks.vectors[3], film.artist.scene_info(), moments[0])[0].part, -1);
  // the same number for the same thing
  EXPECT_EQ(marks.vectors[0].numbered, marks.vectors[1].numbered);

  EXPECT_EQ(draw::with_number("N = {:.1} N", 2), "N_{2} = {:.1} N");
  EXPECT_EQ(draw::with_number("f_r", 1), "f_{r1}");
  EXPECT_EQ(draw::with_number("f_{AB}'", 1), "f_{AB1}'");
  EXPECT_EQ(draw::with_number("\\tau^2", 3), "\\tau_{3}^2");
  EXPECT_EQ(draw::with_number("both together", 1), "both together");
  EXPECT_EQ(draw::with_number("", 1), "");
}

TEST_F(MarkedFilm, WhatAVectorIsWithIsLookedUp) {
  const auto said = [&](const std::string& more) {
    scene(std::string(kMarkedFilm) + "[[film.vector]]\nof = \"ball\"\n" + more);
    return obscura("check scene.toml").err;
  };
  EXPECT_THAT(said("quantity = \"normal_force\"\nwith = \"flor\""), HasSubstr("no body is called 'flor'"));
  EXPECT_THAT(said("quantity = \"spring_force\"\nwith = \"band\""), HasSubstr("no spring is called 'band'"));
  EXPECT_THAT(said("quantity = \"joint_force\"\nwith = \"rod\""),
              HasSubstr("no joint or bond is called 'rod'"));
  EXPECT_THAT(said("quantity = \"weight\"\nwith = \"floor\""),
              HasSubstr("'with' is of forces that have one arrow for each thing"));
}

/// A path of a wheel's rim after twenty turns is as round as at first: every vertex of it on the circle, and
/// none so far from the next that the line between them is half a pixel off.
TEST(Path, IsRoundAfterTwentySeconds) {
  const char* const text = R"(duration = 21
[room]
size = [4, 2.25]
gravity = [0, 0]
[[ball]]
name = "wheel"
radius = 0.5
position = [2, 1]
spin = 360
[[film.path]]
at = { body = "wheel", local = [0.4, 0] }
)";
  Filmed film(scene::parse(text, "wheel.toml"));
  const sim::Snapshot now = moment(*film.run, {20, 1}, film.scene);
  const auto lines = film.ahead.annotations->lines(now, 20);
  ASSERT_EQ(lines.size(), 1u);
  const draw::Projection page = film.artist.projection(0, now);
  double off = 0;
  for (std::size_t k = 0; k + 1 < lines[0].nodes.size(); ++k) {
    const sim::Vec3 half = (lines[0].nodes[k].at + lines[0].nodes[k + 1].at) / 2;
    off = std::max(off, std::abs((half - sim::Vec3(2, 1, 0)).norm() - 0.4) * page.scale_at(half));
  }
  EXPECT_LT(off, 0.5);
  EXPECT_GT(lines[0].nodes.size(), 20u * 20u);
}

TEST(Trail, IsRoundAfterTwentySeconds) {
  const char* const text = R"(duration = 21
[room]
size = [4, 2.25]
gravity = [0, 0]
[[particle]]
name = "bob"
position = [2.5, 1]
velocity = [0, 3.141592653589793]
trail = 20
[[joint]]
type = "rod"
between = [[2, 1], "bob"]
)";
  const scene::Scene scene = scene::parse(text, "circle.toml");
  const draw::Illustrator artist = depictor(scene, {});
  const auto run = scene.run();
  run->track(artist.trailed());
  const sim::Snapshot now = moment(*run, {20, 1}, scene);
  const auto track = std::make_shared<const sim::Track>(run->take_track());
  const std::shared_ptr<const sim::Track> ways[] = {track};
  const draw::Picture picture = artist.depict(now, ways);
  const draw::View view = artist.view(20);
  const draw::Point center = view.page({2, 1, 0});
  const draw::Stroke& trail = picture.moving.strokes.at(0);
  double off = 0;
  for (int k = trail.begin; k + 1 < trail.end; ++k) {
    const draw::Point half =
        (picture.moving.nodes[std::size_t(k)].at + picture.moving.nodes[std::size_t(k) + 1].at) / 2;
    off = std::max(off, std::abs((half - center).norm() - 0.5 * view.scale));
  }
  EXPECT_LT(off, 0.5);
}

TEST(Emphasis, LeavesTheRestGrey) {
  const auto grey = [](const scene::Scene& scene, int body) {
    const draw::Illustrator artist = depictor(scene, {});
    const auto run = scene.run();
    const draw::Picture picture = artist.depict(moment(*run, {0, 1}, scene), {});
    const draw::Color c = picture.moving.discs.at(std::size_t(body)).fill;
    return std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}) < 25;
  };
  const char* const text = R"([room]
size = [4, 2.25]
[[ball]]
name = "a"
radius = 0.2
position = [1, 1]
[[ball]]
name = "b"
radius = 0.2
position = [2, 1]
color = "orange"
)";
  const scene::Scene plain = scene::parse(text, "a.toml"),
                     taught = scene::parse(text, "a.toml", {"look.emphasis=[\"b\"]"});
  EXPECT_FALSE(grey(plain, 0));
  EXPECT_TRUE(grey(taught, 0));
  EXPECT_FALSE(grey(taught, 1));
}

/// What ties grey bodies recedes with them: a rope over a wheel, a belt, the arrows of what presses them. A
/// rope on which something hangs that is taught does not.
TEST(Emphasis, LeavesWhatTiesGreyBodiesGrey) {
  const char* const text = R"([room]
size = [8, 4.5]
[look]
arrows = ["contact"]
[[ball]]
name = "wheel"
radius = 0.3
position = [2, 3.5]
fixed = true
[[ball]]
name = "a"
radius = 0.1
position = [1.7, 2]
[[ball]]
name = "b"
radius = 0.1
position = [2.3, 2]
[[joint]]
type = "pulley"
between = ["a", "b"]
over = ["wheel"]
[[ball]]
name = "c"
radius = 0.3
position = [4, 3]
[[ball]]
name = "d"
radius = 0.5
position = [6, 3]
[[joint]]
name = "first"
type = "pin"
between = ["c", "room"]
[[joint]]
name = "second"
type = "pin"
between = ["d", "room"]
[[joint]]
type = "gear"
joints = ["first", "second"]
ratio = 1.6666666666666667
[[box]]
name = "crate"
size = [0.5, 0.5]
position = [1, 0.25]
[[box]]
name = "taught"
size = [0.5, 0.5]
position = [7, 0.25]
)";
  struct Seen {
    std::set<int> ropes{}, forces{};  // how light; how red
  };
  const auto seen = [&](const std::vector<std::string>& sets) {
    const scene::Scene scene = scene::parse(text, "a.toml", sets);
    const draw::Illustrator artist = depictor(scene, {});
    const auto run = scene.run();
    const draw::List list = artist.depict(moment(*run, {1, 10}, scene), {}).moving;
    Seen all;
    const auto about = list.about(draw::Kind::stroke);
    for (std::size_t k = 0; k < list.strokes.size(); ++k)
      if (about[k].subject.what == draw::Subject::What::joint)
        all.ropes.insert(list.nodes[std::size_t(list.strokes[k].begin)].color.g);
    for (const draw::Polygon& head : list.polygons) all.forces.insert(head.fill.r - head.fill.b);
    return all;
  };
  const Seen plain = seen({}), one = seen({"look.emphasis=[\"taught\"]"}),
             rope = seen({"look.emphasis=[\"taught\", \"a\"]"});
  ASSERT_EQ(plain.ropes.size(), 1u);
  ASSERT_EQ(one.ropes.size(), 1u);
  EXPECT_GT(*one.ropes.begin(), *plain.ropes.begin() + 40);
  EXPECT_EQ(rope.ropes.size(), 2u);
  EXPECT_EQ(*rope.ropes.begin(), *plain.ropes.begin());
  EXPECT_GT(one.forces.size(), plain.forces.size());
}

}  // namespace
}  // namespace obscura::app
