#pragma once

// The crowd of crowd.toml, as a person would write it down who films it by hand with other libraries.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace crowd {

inline constexpr double kRoomWidth = 8, kRoomHeight = 4.5;  // m
inline constexpr double kBallRadius = 0.03, kBoxWidth = 0.24, kBoxHeight = 0.14;
inline constexpr double kElasticity = 0.8, kGravity = -9.81;
inline constexpr int kWidth = 1920, kHeight = 1080, kFps = 60;  // the picture
inline constexpr double kScale = 202, kLeft = 152,
                        kTop = 96;                    // px a metre; where the room lies in the picture
inline constexpr double kOutline = 2.8, kWall = 3.2;  // px

struct Rgb {
  double r, g, b;
};

inline Rgb mix(Rgb a, Rgb b, double t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}
inline Rgb fill(Rgb color) { return mix(color, {1, 1, 1}, 0.62); }
inline Rgb outline(Rgb color) { return mix(color, {0, 0, 0}, 0.30); }

struct Start {
  double x, y, vx, vy, spin;  // m, m/s, rad/s
  Rgb color;
};

// A uniform number in [-1, 1].
class Jitter {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return double(state_ >> 11) / double(std::uint64_t(1) << 52) - 1;
  }

 private:
  std::uint64_t state_ = 1;
};

inline double mix(double a, double b, double t) { return a + (b - a) * t; }

inline std::vector<Start> balls() {
  static constexpr Rgb colors[5] = {
      {0, .447, .698}, {.835, .369, 0}, {0, .620, .451}, {.941, .894, .259}, {.5, .5, .5}};
  std::vector<Start> all;
  Jitter jitter;
  for (int i = 0; i < 500; ++i) {
    const double t = i / 499.0;
    all.push_back({0.4 + 0.3 * (i % 25) + 0.05 * jitter(), 0.4 + 0.19 * (i / 25) + 0.05 * jitter(),
                   mix(-1.5, 1.5, t), mix(2.0, -1.0, t), 0, colors[i % 5]});
  }
  return all;
}

inline std::vector<Start> boxes() {
  static constexpr Rgb colors[4] = {{.902, .624, 0}, {.337, .706, .914}, {.8, .475, .655}, {0, .620, .451}};
  std::vector<Start> all;
  Jitter jitter;
  for (int i = 0; i < 200; ++i) {
    const double t = i / 199.0, turns = 2 * 3.14159265358979 / 360;
    all.push_back({0.48 + 0.37 * (i % 20) + 0.05 * jitter(), 0.5 + 0.38 * (i / 20) + 0.05 * jitter(),
                   mix(1.0, -1.0, t), mix(2.0, 0.0, t), mix(-120.0, 120.0, t) * turns, colors[i % 4]});
  }
  return all;
}

/// A pipe into the ffmpeg command, the usual way: raw frames in, H.264 at CRF 18 and preset medium out. With
/// the file "-" the raw frames go to standard output.
inline std::FILE* film(const std::string& file, const std::string& pixel_format) {
  if (file == "-") {
    std::FILE* out = fdopen(dup(1), "wb");
    dup2(2, 1);  // what a library says of itself goes elsewhere
    return out;
  }
  const std::string command =
      "ffmpeg -v error -y -f rawvideo -pix_fmt " + pixel_format + " -s " + std::to_string(kWidth) + "x" +
      std::to_string(kHeight) + " -r " + std::to_string(kFps) +
      " -i - -c:v libx264 -preset medium -crf 18 -pix_fmt yuv420p -movflags +faststart '" + file + "'";
  return popen(command.c_str(), "w");
}

}  // namespace crowd
