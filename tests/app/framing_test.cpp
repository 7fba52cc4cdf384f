// What the cameras of shipped scenes show: bodies that do not fly off stay whole in every panel.

#include <gtest/gtest.h>

#include <string>

#include "app/run/plots.h"
#include "app/run/simulation.h"
#include "draw/space/outmost_places.h"
#include "program.h"
#include "scene/scene.h"
#include "where.h"

namespace obscura::app {
namespace {

class Framing : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Framing, KeepsBodiesInEachPanel) {
  const auto& [name, leaves] = GetParam();
  const std::string path = std::string(OBSCURA_SOURCE_DIR) + "/scenes/" + name + ".toml";
  std::string text = contents(path);
  // a camera that is led by hand is the scene's own matter
  if (const std::size_t keys = text.find("\nkeys "); keys != text.npos)
    text.erase(keys, text.find("\n]", keys) + 2 - keys);
  const scene::Scene scene = scene::parse(text, path);
  const draw::Illustrator artist = depictor(scene, ahead(scene));
  const auto run = scene.run();
  sim::SceneInfo cast = run->scene_info();
  // what flies off is not looked at
  for (sim::SceneInfo::Body& body : cast.bodies)
    if (*leaves != 0 && body.name.rfind(leaves, 0) == 0) body.bare = true;
  for (std::int64_t k = 0; sim::rational(k) / sim::rational(4) <= scene.duration; ++k) {
    const sim::Snapshot now = moment(*run, sim::rational(k) / sim::rational(4), scene);
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

INSTANTIATE_TEST_SUITE_P(Scenes, Framing,
                         testing::Values(std::pair("explosion", "ball"), std::pair("tumble", ""),
                                         std::pair("stairs", "")),
                         [](const auto& it) { return std::string(it.param.first); });

}  // namespace
}  // namespace obscura::app
