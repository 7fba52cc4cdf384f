#pragma once

#include <optional>
#include <string>
#include <vector>

#include "draw/color.h"
#include "sim/rational.h"
#include "sim/snapshot.h"

namespace obscura::draw {

enum class Theme { paper, screen };

/// What the scene says about the looks of one body.
struct BodyLook {
  std::optional<Color> color;  // none: the palette's next
  double trail = 0;            // s; 0: none
  bool velocity = false;       // draw its velocity as an arrow
  bool contact = false;        // draw the forces where it touches as arrows
};

/// What the scene says about the looks of the picture.
struct Look {
  Theme theme = Theme::paper;
  std::string title, subtitle;
  bool clock = true;    // the time at the right of the caption
  bool caption = true;  // the caption strip at all
  bool hatching = true;
  bool axes = true;              // the frame of each box
  bool pointer = true;           // mouse, its spring and its path
  double velocity_scale = 0.1;   // s: arrow length in metres a metre per second
  double force_scale = 0;        // m/N: arrow length in metres a newton; 0: chosen by the bodies' weights
  std::vector<BodyLook> bodies;  // as in the Cast
  enum class Springs { automatic, coils, lines } springs = Springs::automatic;
};

/// Where the camera is at one time; between two keys it moves with the ease of the later one.
struct CameraKey {
  enum class Ease { linear, in, out, in_out, hold };
  double time = 0;                  // s
  std::optional<sim::Vec3> center;  // m; none: the room's
  std::optional<double>
      width;  // m that the picture's world region shows across; none: as much as fits the room
  Ease ease = Ease::in_out;
};

/// Without keys the camera shows as much as fits the room.
struct Camera {
  std::vector<CameraKey> keys;  // by time
  std::optional<int> follow;    // the body that it keeps in the middle
};

}  // namespace obscura::draw
