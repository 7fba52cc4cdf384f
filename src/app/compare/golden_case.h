#pragma once

#include <string>
#include <vector>

#include "app/compare/report.h"
#include "app/film/pictures.h"
#include "app/run/diagnosis.h"
#include "media/pixels.h"
#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::app {

/// One moment of a scene, held against its reference.
struct GoldenCase {
  std::string scene;               // its name, of golden_name
  std::string time;                // "2.5"
  std::string state;               // "same", "tolerated", "differs", "missing", "unreadable", "updated",
                                   // "failed"
  std::string file;                // the reference: a picture, or the record of a scene that keeps hashes
  std::vector<std::string> lines;  // what is to be said, the verdict first
  std::vector<std::string> attachments;  // pictures that were written of it
  std::optional<media::Image> expected, actual;
  std::string expected_by, actual_by;           // what drew them
  std::string choice;                           // what --only takes to mean this picture: "room@2.5:0f3a..."
  std::string scene_file;                       // as it was named
  int line = 0;                                 // of its [golden]; 0: it has none
  std::optional<media::Difference> difference;  // where pictures of one size differ
  std::optional<Cause> cause;
  std::optional<scene::Error> error;  // of "failed": what is wrong with the scene
  double seconds = 0;                 // its share of the time that its scene took
  int exit = 0;  // of "failed", "unreadable", and where its pictures cannot be written: the exit code

  bool good() const { return state == "same" || state == "tolerated" || state == "updated"; }
};

/// A moment that --only names, and the picture that is meant.
struct GoldenChoice {
  std::string scene;  // its name, of golden_name
  sim::Rational time;
  std::string hash;  // of the picture and its state, as in a report; empty: whatever it is

  /// "room@2.5", "room@2.5:0f3a...". Throws UsageError.
  static GoldenChoice parse(const std::string& text);
};

struct GoldenOptions {
  std::string root;        // the folder that scenes' names begin from; empty: the current one
  std::string references;  // a folder; empty: golden/ beside the scene
  std::string actual = "render_out/golden";  // where pictures of what fails go
  std::string states;                        // the CSV of another program's run; empty: what the scene says
  bool update = false;
  std::vector<GoldenChoice> only;        // moments; empty: all
  bool states_only_on_other_gl = false;  // where the reference was drawn by another OpenGL
  PictureOptions picture;
};

/// Draws the moments of a scene, or of another program's run of it, and compares each with its reference,
/// states first. Writes references where that is asked for, and of what fails the picture and the difference.
/// Throws UsageError where `only` names a moment that the scene has not, media::Error where the run has no
/// row at a moment.
std::vector<GoldenCase> check_golden(const scene::Scene& scene, const GoldenOptions& options);

/// The name of a scene among others: its path from the root, without its ending, as in "wheels/car".
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
