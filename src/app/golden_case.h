#pragma once

#include <string>
#include <vector>

#include "app/pictures.h"
#include "app/report.h"
#include "scene/scene.h"

namespace obscura::app {

/// One moment of a scene, held against its reference.
struct GoldenCase {
  std::string scene;                     // its name, of golden_name
  std::string time;                      // "2.5"
  std::string state;                     // "same", "tolerated", "differs", "missing", "updated", "failed"
  std::string file;                      // the reference
  std::vector<std::string> lines;        // what is to be said, the verdict first
  std::vector<std::string> attachments;  // pictures that were written of it
  std::optional<media::Image> expected, actual;
  std::string expected_by, actual_by;  // what drew them
  double seconds = 0;  // its share of the time that its scene took
  int exit = 0;        // of "failed": the exit code

  bool good() const { return state == "same" || state == "tolerated" || state == "updated"; }
};

struct GoldenOptions {
  std::string root;        // the folder that scenes' names begin from; empty: the current one
  std::string references;  // a folder; empty: golden/ beside the scene
  std::string actual = "render_out/golden";  // where pictures of what fails go
  bool update = false;
  bool states_only_on_other_gl = false;  // where the reference was drawn by another OpenGL
  PictureOptions picture;
};

/// Draws the moments of a scene and compares each with its reference, states first. Writes references where
/// that is asked for, and of what fails the picture and the difference.
std::vector<GoldenCase> check_golden(const scene::Scene& scene, const GoldenOptions& options);

/// What a scene is called among others: its path from the root, without its ending, as in "wheels/car".
/// Outside of the current folder, where no root is given, the file's stem. Throws UsageError where the scene
/// lies outside of the root, or --references needs a root to tell scenes apart.
std::string golden_name(const std::string& scene_file, const GoldenOptions& options);

/// A scene's references, and pictures of what fails, without "-SECONDS.png": "golden/car",
/// "render_out/golden/wheels/car".
std::string references_of(const std::string& scene_file, const GoldenOptions& options);
std::string actual_of(const std::string& scene_file, const GoldenOptions& options);

/// All cases as JUnit's XML.
std::string junit(const std::vector<GoldenCase>& cases);

}  // namespace obscura::app
