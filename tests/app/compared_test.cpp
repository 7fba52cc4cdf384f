// Films of several runs: each run is what it is alone, panels have one scale, and shards, resumed films and
// verify know them. A run that diverges is shown to its last finite state.

#include <algorithm>
#include <cmath>
#include <deque>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "app/console/exit.h"
#include "app/run/ahead.h"
#include "app/run/compared.h"
#include "app/run/origin.h"
#include "app/run/simulation.h"
#include "draw/compose/annotate.h"
#include "draw/page/titles.h"
#include "media/png.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::Each;
using testing::HasSubstr;

using Compared = Program;

// a mass on a spring: at 30 steps a second Euler's scheme makes (1 + h^2 k/m) of its energy in each step
constexpr const char* kSpring = R"(
title = "A spring"
duration = 4
[room]
size = [4, 2]
walls = "none"
gravity = [0, 0]
[physics]
rate = 30
[[particle]]
name = "ball"
position = [2.5, 1]
[[spring]]
between = ["ball", [1, 1]]
stiffness = 40
rest_length = 1
)";
constexpr const char* kVary =
    "[film]\nvary = \"physics.integrator=euler,rk4\"\nvary_names = \"Euler; RK4\"\n";
constexpr const char* kEnergy = "[[film.plot]]\nquantity = [\"energy\"]\n";
constexpr const char* kSmallPanels = " --size 160x90 --fps 10 --progress none";

std::string words_of(const draw::Text& text) {
  std::string all;
  for (const draw::Span& span : text.spans) all += span.text;
  return all;
}

int count(const draw::List& list, const std::string& words) {
  return int(std::count_if(list.texts.begin(), list.texts.end(),
                           [&](const draw::Text& text) { return words_of(text) == words; }));
}

TEST_F(Compared, EachRunIsWhatItIsAlone) {
  const scene::Scene scene = scene::parse(std::string(kSpring) + kVary, "spring.toml", {});
  const Shots shots = Shots::film(scene.duration, sim::rational(10), {});
  const Ahead ahead = app::ahead(scene);
  ASSERT_TRUE(ahead.runs);
  ASSERT_EQ(ahead.runs->size(), 2u);
  Simulation simulation(scene, shots, ahead, {.frames = 40, .hash_each = true});
  const auto take = simulation.next();
  ASSERT_TRUE(take);
  ASSERT_EQ(take->others.size(), 1u);
  const char* names[] = {"euler", "rk4"};
  std::vector<std::unique_ptr<sim::Run>> alone;
  for (const char* name : names)
    alone.push_back(scene::parse(kSpring, "spring.toml", {std::string("physics.integrator=") + name}).run());
  for (std::size_t frame = 0; frame < take->shots.size(); ++frame) {
    std::vector<std::string> hashes;
    for (std::size_t i = 0; i < 2; ++i) {
      const sim::Snapshot now = moment(*alone[i], take->shots[frame].time, scene);
      hashes.push_back(state_hash(alone[i]->words()));
      EXPECT_EQ(now.bodies[0].position, take->run(i).moments[frame].bodies[0].position);
    }
    EXPECT_EQ(take->states[frame], hash_of_states(hashes));
  }
  // two runs that are one would pass as well
  EXPECT_GT((take->run(0).moments.back().bodies[0].position - take->run(1).moments.back().bodies[0].position)
                .norm(),
            0.1);
}

TEST_F(Compared, PanelsHaveOneScaleOneClockAndALineEach) {
  const scene::Scene scene = scene::parse(std::string(kSpring) + kVary + kEnergy, "spring.toml", {});
  const Ahead ahead = app::ahead(scene);
  const std::vector<draw::Illustrator> artists = depictors(scene, ahead);
  ASSERT_EQ(artists.size(), 2u);
  std::vector<sim::Snapshot> nows;
  std::vector<draw::Rect> panels;
  std::vector<draw::ComparedRun> names;
  for (const Ahead::Run& run : *ahead.runs) {
    auto own = run.scene.run();
    nows.push_back(moment(*own, sim::rational(3), scene));
    panels.push_back(run.panel), names.push_back(run.look);
  }
  for (const sim::Vec3& place : {sim::Vec3(0, 0, 0), sim::Vec3(3, 1.5, 0)})
    EXPECT_EQ(artists[0].projection(0, nows[0]).page(place), artists[1].projection(0, nows[1]).page(place));
  EXPECT_EQ(panels[0].width, panels[1].width);
  EXPECT_EQ(panels[0].height, panels[1].height);
  EXPECT_NE(panels[0].x, panels[1].x);

  const double aspect = 16.0 / 9;
  const draw::Comparison page(names, artists, panels, scene.look, aspect, ahead.charts,
                              draw::laid_out(scene.film.titles, aspect));
  const draw::Picture picture = page.depict({{nows[0], nows[0], {}}, {nows[1], nows[1], {}}}, 3, 3, 1);
  EXPECT_EQ(count(picture.moving, "t = 3.00 s"), 1);
  // over their panels, and at the heads of their lines
  EXPECT_EQ(count(*picture.still, "Euler"), 1);
  EXPECT_EQ(count(*picture.still, "RK4"), 1);
  EXPECT_EQ(count(picture.moving, "Euler"), 1);
  EXPECT_EQ(count(picture.moving, "RK4"), 1);
  // nothing of a panel is drawn outside it
  for (const draw::Batch& batch : picture.still->batches) {
    if (batch.kind == draw::Kind::text || batch.clip < 0) continue;
    const draw::Rect& clip = picture.still->clips[std::size_t(batch.clip)];
    EXPECT_TRUE(std::any_of(panels.begin(), panels.end(), [&](const draw::Rect& panel) {
      return clip.x >= panel.x - 1e-9 && clip.x + clip.width <= panel.x + panel.width + 1e-9;
    }));
  }
}

// The names over the panels are as dark as words are, whatever their runs' colours: 4.5 to the page at least.
TEST_F(Compared, NamesOverPanelsAreRead) {
  for (const char* theme : {"paper", "screen"}) {
    const scene::Scene scene = scene::parse(std::string(kSpring) + "[look]\ntheme = \"" + theme +
                                                "\"\n[film]\nvary = \"physics.rate=30:100:10\"\n",
                                            "a.toml", {});
    const Ahead ahead = app::ahead(scene);
    const std::vector<draw::Illustrator> artists = depictors(scene, ahead);
    std::vector<draw::Rect> panels;
    std::vector<draw::ComparedRun> names;
    std::deque<sim::Snapshot> snapshots;
    std::vector<draw::Comparison::Instant> nows;
    for (const Ahead::Run& run : *ahead.runs) {
      auto own = run.scene.run();
      const sim::Snapshot& now = snapshots.emplace_back(moment(*own, sim::rational(0), scene));
      nows.push_back({now, now, {}});
      panels.push_back(run.panel), names.push_back(run.look);
    }
    const double aspect = 16.0 / 9;
    const draw::Comparison page(names, artists, panels, scene.look, aspect, ahead.charts,
                                draw::laid_out(scene.film.titles, aspect));
    const draw::Picture picture = page.depict(nows, 0, 0, 1);
    for (const draw::ComparedRun& run : names) {
      EXPECT_EQ(count(*picture.still, run.name), 1) << run.name;
      for (const draw::Text& text : picture.still->texts) {
        if (words_of(text) != run.name) continue;
        for (const draw::Span& span : text.spans)
          EXPECT_GE(draw::contrast(span.color, picture.ground), 4.5) << theme << ": " << run.name;
      }
    }
  }
}

// A panel of nine is so small that its words would be too: they are at least 1/54 of the page high.
TEST_F(Compared, WordsInSmallPanelsAreRead) {
  const scene::Scene scene = scene::parse(
      std::string(kSpring) + "[film]\nvary = \"physics.rate=30:110:10\"\n" + kEnergy, "a.toml", {});
  const std::vector<Ahead::Run> runs = app::compared(scene);
  ASSERT_EQ(runs.size(), 9u);
  for (const Ahead::Run& run : runs) {
    const double aspect = double(run.scene.film.width) / run.scene.film.height;
    const double weight = draw::page_weight(aspect) * run.scene.look.weight;
    const double em = draw::kAnnotationType * draw::film_lettering(weight, run.scene.look.type_scale).point;
    EXPECT_GE(em * run.panel.height / 1080, 1080.0 / 54);
    EXPECT_LE(em * run.panel.height / 1080, 1080.0 / 38);
  }
}

TEST_F(Compared, OverEachOtherThePageIsThatOfOneRun) {
  scene(std::string(kSpring) + kVary + "vary_place = \"over\"\n" + kEnergy);
  const Outcome run = obscura("render scene.toml --at 1 -o over.png --size 320x180 --progress none");
  ASSERT_EQ(run.exit, 0) << run.err;
  // at its beginning both are at one place: the second run covers the first
  const scene::Scene read =
      scene::parse(std::string(kSpring) + kVary + "vary_place = \"over\"\n", "a.toml", {});
  const std::vector<draw::Illustrator> artists = depictors(read, app::ahead(read));
  ASSERT_EQ(artists.size(), 2u);
  auto own = read.run();
  const sim::Snapshot now = moment(*own, sim::rational(0), read);
  EXPECT_EQ(artists[0].view(0).scale, artists[1].view(0).scale);
  EXPECT_EQ(artists[0].view(0).origin, artists[1].view(0).origin);
  EXPECT_NE(artists[0].line_color(0).r, artists[1].line_color(0).r);
  // in space it is told that this cannot be
  scene(
      "[[ball]]\nradius = 1\nposition = [0, 2, 0]\n[film]\nvary = \"ball.mass=1,2\"\nvary_place = "
      "\"over\"\n");
  const Outcome space = obscura("check scene.toml");
  EXPECT_EQ(space.exit, kScene);
  EXPECT_THAT(space.err, HasSubstr("beside each other"));
}

TEST_F(Compared, ShardsAndResumedFilmsAreTheFilm) {
  scene(std::string(kSpring) + "[look]\ntrails = 0.5\n" + kVary + kEnergy);
  const std::string film = std::string("render scene.toml") + kSmallPanels;
  ASSERT_EQ(obscura(film + " -o whole.mp4 -j 1").exit, 0);
  ASSERT_EQ(obscura(film + " -o s.mp4 --prepare 3").exit, 0);
  for (const char* shard : {"2/3", "1/3", "3/3"})
    ASSERT_EQ(obscura(film + " -o s.mp4 --shard " + shard).exit, 0) << shard;
  ASSERT_EQ(obscura("join s.mp4").exit, 0);
  EXPECT_EQ(contents(path("whole.mp4")), contents(path("s.mp4")));

  // a part is lost: resumed from the states of both runs
  ASSERT_EQ(obscura(film + " -o r.mp4 --shard 1/1").exit, 0);
  ASSERT_EQ(shell("rm r.mp4.parts/take-000002-*").exit, 0);
  ASSERT_EQ(obscura(film + " -o r.mp4 --resume").exit, 0);
  EXPECT_EQ(contents(path("whole.mp4")), contents(path("r.mp4")));

  const Outcome verdict = obscura("verify whole.mp4");
  EXPECT_EQ(verdict.exit, 0) << verdict.out;
  EXPECT_EQ(obscura("verify whole.mp4 --states").exit, 0);
  // a still is the film's frame
  ASSERT_EQ(obscura(film + " --at 1.5 -o a.png").exit, 0);
  ASSERT_EQ(obscura(film + " --frames 15 -o 'b/{frame}.png'").exit, 0);
  EXPECT_EQ(media::read_png(path("a.png")).image, media::read_png(path("b/15.png")).image);
}

// forces of marks go by the run's longest, not by what bodies' own arrows have
TEST_F(Compared, ForcesHaveArrowsThatAreSeen) {
  const scene::Scene scene = scene::parse(
      "duration = 1\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"ball\"\nposition = [2, 2]\n"
      "[film]\nvary = \"ball.mass=1,2\"\n[[film.vector]]\nquantity = \"weight\"\nof = \"ball\"\nlabel = "
      "\"W\"\n",
      "weights.toml", {});
  const Ahead ahead = app::ahead(scene);
  const std::vector<draw::Illustrator> artists = depictors(scene, ahead);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto run = (*ahead.runs)[i].scene.run();
    const draw::Projection view = artists[i].projection(0, moment(*run, sim::rational(0), scene));
    const double longest = 2 * 9.81 * (*ahead.runs)[i].annotations->scales().force * view.scale_at({2, 2, 0});
    EXPECT_GT(longest, 0.2 * std::min(view.window().width, view.window().height)) << i;
  }
}

TEST_F(Compared, AFrameIsDescribedRunByRunInTheScenesNumbers) {
  scene(std::string(kSpring) + "[look]\ndecimal = \",\"\n[film]\nvary = \"ball.mass=0.5,2\"\n");
  ASSERT_EQ(obscura(std::string("render scene.toml --at 1 -o a.png") + kSmallPanels).exit, 0);
  const std::string said = media::read_png(path("a.png")).tags["Description"];
  EXPECT_THAT(said, HasSubstr("A spring. mass = 0,5: One particle and one spring at 1 s."));
  EXPECT_THAT(said, HasSubstr(" mass = 2: One particle"));
}

TEST_F(Compared, WhatCannotBeIsSaid) {
  const auto told = [&](const std::string& film) {
    scene(std::string(kSpring) + "[film]\n" + film);
    const Outcome run = obscura("check scene.toml");
    EXPECT_NE(run.exit, 0) << film;
    return run.err;
  };
  EXPECT_THAT(told("vary = \"physics.integratr=euler,rk4\"\n"), HasSubstr("integratr"));
  EXPECT_THAT(told("vary = \"physics.integrator=euler,rk5\"\n"), HasSubstr("rk5"));
  EXPECT_THAT(told("vary = \"euler,rk4\"\n"), HasSubstr("a path and its values"));
  // in the file, not of a flag that was not given
  const std::string here =
      "scene.toml:" + std::to_string(std::count(kSpring, kSpring + std::strlen(kSpring), '\n') + 2) +
      ":8: 'vary': ";
  EXPECT_THAT(told("vary = \"ball.mas=1,2\"\n"),
              HasSubstr(here + "ball.mas=1: unknown key 'mas' in [[particle]]; did you mean 'mass'?"));
  EXPECT_THAT(told("vary = \"ball.mass=3:1\"\n"), HasSubstr(here + "ball.mass=3:1: 3:1 runs backwards"));
  EXPECT_THAT(told("vary = \"ball.mass=1:100\"\n"), HasSubstr(here + "100 runs"));
  EXPECT_THAT(told("vary = \"ball.mass=1,2\"\nvary_names = \"one\"\n"), HasSubstr("1 names for 2 runs"));
}

TEST_F(Compared, ARunThatDivergesIsShownToItsLastFiniteState) {
  const std::vector<std::string> euler{"physics.integrator=euler", "physics.rate=12"};
  // by default it is an error
  scene(kSpring);
  const std::string sets = " --set physics.integrator=euler --set physics.rate=12 --set duration=30";
  EXPECT_EQ(obscura("render scene.toml --at 29 -o a.png --size 96x54 --progress none" + sets).exit,
            kDiverged);
  const Outcome shown = obscura(
      "render scene.toml --at 29 -o a.png --size 96x54 --progress none --set physics.diverge=show" + sets);
  EXPECT_EQ(shown.exit, 0) << shown.err;
  EXPECT_EQ(obscura("verify a.png").exit, 0);

  // the state is finite, the last of its run, and the same however one comes there
  const auto at = [&](std::vector<double> times, double* when, std::string* hash, draw::Fate* fate) {
    std::vector<std::string> all = euler;
    all.emplace_back("physics.diverge=show");
    const auto run = scene::parse(kSpring, "spring.toml", all).shown_run();
    sim::Snapshot now;
    for (const double t : times) now = moment(*run, sim::rational(std::llround(t * 1000), 1000), {});
    *when = now.time, *hash = state_hash(run->words()), *fate = app::fate(*run);
    EXPECT_TRUE(std::isfinite(now.bodies[0].position.norm()));
    return now;
  };
  double t1 = 0, t2 = 0;
  std::string h1, h2;
  draw::Fate f1{}, f2{};
  const sim::Snapshot last = at({29}, &t1, &h1, &f1);
  at({0.01, 3.333, 28.99, 29, 30}, &t2, &h2, &f2);
  EXPECT_EQ(f1, draw::Fate::ended);
  EXPECT_EQ(f2, draw::Fate::ended);
  EXPECT_EQ(t1, t2);
  EXPECT_EQ(h1, h2);
  // one step more would be beyond all limits: a million times the room's height
  EXPECT_GT(last.bodies[0].position.norm() + last.bodies[0].velocity.norm(), 1e5);
  // long before that its energy says that it diverges, and at first that it does not
  at({5}, &t1, &h1, &f1);
  EXPECT_EQ(f1, draw::Fate::diverges);
  at({0.25}, &t1, &h1, &f1);
  EXPECT_EQ(f1, draw::Fate::well);

  // its states end there
  const Outcome states =
      obscura("states scene.toml --every 1 --format csv --set physics.diverge=show" + sets);
  EXPECT_EQ(states.exit, 0);
  EXPECT_THAT(states.err, HasSubstr("its states end there"));
  const auto rows = std::count(states.out.begin(), states.out.end(), '\n');
  EXPECT_GT(rows, 5);
  EXPECT_LT(rows, 31);
}

/// A plot against a quantity is in step with the film: its head is where both quantities are now, the line
/// behind it is that of the time gone by.
TEST_F(Compared, APlotAgainstAQuantityHasItsHeadWhereBothAreNow) {
  const scene::Scene scene = scene::parse(R"(
duration = 3
[room]
size = [4, 3]
[[ball]]
name = "ball"
radius = 0.1
position = [1, 2.5]
[[film.plot]]
quantity = ["vy"]
against = "height"
of = "ball"
)",
                                          "ball.toml", {});
  const Ahead ahead = app::ahead(scene);
  const auto run = scene.run();
  // an axis is linear: the head's place is that of two instants, carried on
  struct Head {
    double height, speed;
    draw::Point at;
  };
  std::vector<Head> heads;
  std::size_t nodes = 0;
  for (int k = 1; k <= 12; ++k) {
    const sim::Snapshot now = moment(*run, sim::rational(k, 7), scene);
    draw::List list;
    ahead.charts.draw_lines(now, list);
    ASSERT_EQ(list.discs.size(), 1u);
    ASSERT_FALSE(list.nodes.empty());
    EXPECT_EQ(list.nodes.back().at, list.discs[0].center);
    EXPECT_GT(list.nodes.size(), nodes);
    nodes = list.nodes.size();
    heads.push_back({now.bodies[0].position.y(), now.bodies[0].velocity.y(), list.discs[0].center});
  }
  const Head &a = heads[0], &b = heads[2];
  for (const Head& head : heads) {
    EXPECT_NEAR((head.at.x() - a.at.x()) * (b.height - a.height),
                (b.at.x() - a.at.x()) * (head.height - a.height), 1e-6);
    EXPECT_NEAR((head.at.y() - a.at.y()) * (b.speed - a.speed),
                (b.at.y() - a.at.y()) * (head.speed - a.speed), 1e-6);
  }
  // the axes turn neither quantity around
  EXPECT_GT((b.at.x() - a.at.x()) * (b.height - a.height), 0);
  EXPECT_LT((b.at.y() - a.at.y()) * (b.speed - a.speed), 0);
}

TEST_F(Compared, TheShippedSceneShowsBoth) {
  const std::string scene = std::string(OBSCURA_SOURCE_DIR) + "/scenes/euler_and_rk4.toml";
  const scene::Scene read = scene::read(scene);
  const auto euler = filmed(read)[0].shown_run(), rk4 = filmed(read)[1].shown_run();
  const sim::Snapshot a = moment(*euler, read.duration, read), b = moment(*rk4, read.duration, read);
  EXPECT_EQ(fate(*rk4), draw::Fate::well);
  // (1 + h^2 k/m) a step for Euler, to the rounding of so many products; RK4 loses (h w)^6 / 72 a step
  auto start = filmed(read)[0].run();
  const double e0 = moment(*start, sim::rational(0), read).energies.total();
  const double growth = std::pow(1 + 39.4784176043574 / 900, 75);
  EXPECT_NEAR(a.energies.total() / (growth * e0), 1, 1e-9);
  EXPECT_NEAR(b.energies.total() / e0, 1, 1e-3);
}

}  // namespace
}  // namespace obscura::app
