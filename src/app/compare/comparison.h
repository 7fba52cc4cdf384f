#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/run/diagnosis.h"
#include "media/image.h"
#include "media/pixels.h"

namespace obscura::app {

/// The differences of two pictures or sequences of them.
struct Comparison {
  /// A frame that differs.
  struct Frame {
    std::int64_t number = 0;  // in the order of the sequence
    std::string name;         // of its file, or "frame 12"; of two files that are paired by order both
    std::optional<double> time;
    media::Difference difference;
    bool sizes = false;  // the two are of other sizes: `difference` says nothing
    std::string size_a, size_b;
    std::optional<Origin> origin_a, origin_b;
    media::Image a, b;  // of the first and the worst frame; else empty
  };

  std::string a, b;
  bool still = true;
  bool same_bytes = false;    // of the files
  std::int64_t compared = 0;  // frames
  bool by_order = false;      // of two folders without a name in common
  std::vector<Frame> differing;
  int first = -1, worst = -1;       // of `differing`
  std::vector<std::string> plain;   // what else is not the same: numbers of frames, files that one alone has
  std::vector<std::string> others;  // what their origins say otherwise where pictures are the same
  std::optional<Cause> cause;

  bool same() const { return differing.empty() && plain.empty(); }
};

/// Compares what lies at two paths: two stills, or two folders, movies, or one of each. Hash first, then
/// pixels, then why. Throws media::Error where something is not readable, UsageError for a still against a
/// sequence.
Comparison compare(const std::string& a, const std::string& b);

/// How one frame differs, in a sentence: "12 pixels differ, by up to 3 levels, ...".
std::string sentence(const Comparison::Frame& frame);

/// "12 pixels differ by up to 3 of 255 levels, most at (10, 20); within 40x20 pixels at (3, 4)".
std::string sentence(const media::Difference& difference);

/// The whole as lines for a person, as a JSON object for a program.
std::string text(const Comparison& comparison);
std::string json(const Comparison& comparison);

}  // namespace obscura::app
