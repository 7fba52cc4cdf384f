// What the cameras of shipped scenes show: bodies that do not fly off stay whole in every panel.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/run/ahead.h"
#include "app/run/simulation.h"
#include "draw/space/outmost_places.h"
#include "program.h"
#include "scene/scene.h"
#include "where.h"

namespace obscura::app {
namespace {

class Framing : public testing::TestWithParam<std::pair<const char*, const char*>> {};

// four times a second
std::vector<sim::Snapshot> moments(const scene::Scene& scene) {
  std::vector<sim::Snapshot> all;
  const auto run = scene.run();
  for (std::int64_t k = 0; sim::rational(k) / sim::rational(4) <= scene.duration; ++k)
    all.push_back(moment(*run, sim::rational(k) / sim::rational(4), scene));
  return all;
}

// looks at all bodies but those whose names begin with `leaves`; `movers`: at none that is fixed either
void keep(const std::string& name, const scene::Scene& scene, const std::vector<sim::Snapshot>& moments,
          const std::string& leaves, bool movers) {
  const draw::Illustrator artist = depictor(scene, ahead(scene));
  sim::SceneInfo cast = scene.run()->scene_info();
  for (sim::SceneInfo::Body& body : cast.bodies) {
    if ((!leaves.empty() && body.name.rfind(leaves, 0) == 0) || (movers && body.fixed)) body.bare = true;
  }
  for (const sim::Snapshot& now : moments) {
    draw::OutmostPlaces places;
    places.add(cast, now);
    for (int panel = 0; panel < artist.panels(); ++panel) {
      const draw::CameraProjection lens = artist.lens(now, panel);
      const draw::Rect& w = lens.window;
      for (const sim::Vec3& at : places.places()) {
        const draw::Point p = lens.page(at);
        EXPECT_TRUE(p.x() > w.x && p.x() < w.x + w.width && p.y() > w.y && p.y() < w.y + w.height)
            << name << ", panel " << panel << ", " << now.time << " s: " << at.transpose();
      }
    }
  }
}

TEST_P(Framing, KeepsBodiesInEachPanel) {
  const auto& [name, leaves] = GetParam();
  const std::string path = std::string(OBSCURA_SOURCE_DIR) + "/scenes/" + name + ".toml";
  const std::string text = contents(path);
  const scene::Scene shipped = scene::parse(text, path);
  const std::vector<sim::Snapshot> now = moments(shipped);
  keep(name, shipped, now, leaves, text.find("\nkeys ") != text.npos);
  // the camera of a scene that leads it by hand may leave what stands still behind; by itself it does not
  for (const char* instead : {"", "\nfit = \"run\""}) {
    std::string led = text;
    for (std::size_t keys; (keys = led.find("\nkeys ")) != led.npos;) {
      std::size_t end = led.find('\n', keys + 1);
      if (led[end - 1] == '[') end = led.find("\n]", keys) + 2;
      led.replace(keys, end - keys, instead);
    }
    keep(name, scene::parse(led, path), now, leaves, false);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Framing,
                         testing::Values(std::pair("explosion", "ball"), std::pair("tumble", ""),
                                         std::pair("stairs", "")),
                         [](const auto& it) { return std::string(it.param.first); });

}  // namespace
}  // namespace obscura::app
