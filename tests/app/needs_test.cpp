// What films are said to take against what they take. Of time nothing is held here: a clock would decide.

#include "app/film/estimate.h"

#include <filesystem>

#include "app/film/film.h"
#include "program.h"

namespace obscura::app {
namespace {

constexpr double kAllPatience = 1e9;  // s: every step is seen

class NeedsOf : public Program {
 protected:
  // bytes said, and bytes there are, of two seconds of a shipped scene
  std::pair<double, double> disk(const std::string& name, const std::string& out,
                                 const std::string& preset = "") const {
    scene::Scene scene = scene::read(OBSCURA_SOURCE_DIR "/scenes/" + name + ".toml",
                                     {"duration=2", "film.size=[640,360]", "film.fps=25"});
    scene.film.preset = preset;
    const bool movie = out.find('{') == std::string::npos;
    const Output output{movie ? Output::Form::movie : Output::Form::frames, path(out)};
    const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
    const Needs said = needs(scene, shots, output, kAllPatience);
    FilmOptions options;
    options.progress = ProgressKind::none;
    EXPECT_EQ(film(scene, shots, output, options), 0);
    double bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      if (entry.is_regular_file()) bytes += double(entry.file_size());
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) std::filesystem::remove_all(entry);
    return {said.disk, bytes};
  }
};

TEST_F(NeedsOf, DiskIsRightWithinAFactorOfTwo) {
  const std::tuple<const char*, const char*, const char*> films[] = {
      {"room", "a.mp4", ""},       {"room", "a.mkv", "ultrafast"}, {"room", "a.gif", ""},
      {"room", "{frame}.png", ""}, {"stack", "a.mp4", ""},         {"net", "a.mp4", ""},
      {"explosion", "a.mp4", ""},  {"stairs", "a.mp4", ""},        {"top", "a.mp4", "ultrafast"},
      {"top", "{frame}.png", ""},
  };
  for (const auto& [scene, out, preset] : films) {
    const auto [said, there] = disk(scene, out, preset);
    EXPECT_GT(said, there / 2) << scene << " " << out << " " << preset;
    EXPECT_LT(said, there * 2) << scene << " " << out << " " << preset;
  }
}

TEST_F(NeedsOf, WhatMovesMoreTakesMore) {
  const auto said = [](const std::string& text) {
    const scene::Scene scene = scene::parse(text, "a.toml");
    return needs(scene, Shots::film(scene.duration, scene.film.fps), {Output::Form::movie, "a.mp4"},
                 kAllPatience)
        .disk;
  };
  const std::string still = "duration = 2\n[room]\ngravity = [0, 0]\n[[ball]]\nposition = [1, 2]\n";
  const double rest = said(still), flies = said(still + "velocity = [1, 0]"),
               many = said(still + "velocity = [1, 0]\ncopies = { count = 8, offset = [0.5, 0] }");
  EXPECT_LT(rest, flies);
  EXPECT_LT(flies, many);
}

}  // namespace
}  // namespace obscura::app
