#pragma once

#include <optional>
#include <string>
#include <vector>

#include "draw/picture/color.h"
#include "draw/picture/view.h"
#include "sim/math/rational.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

enum class Theme { paper, screen };

/// What the surface of a body in space looks like, in its own colour.
enum class Material { matte, metal, wood, checks };

/// The scene's looks of one body.
struct BodyLook {
  std::optional<Color> color;  // none: the palette's next
  double trail = 0;            // s; 0: none
  bool velocity = false;       // draw its velocity as an arrow
  bool contact = false;        // draw the forces where it touches as arrows
  std::string label = {};      // words beside it
  bool quiet = false;          // grey, for others are to be looked at
  Material material = Material::matte;
};

/// The scene's looks of the picture.
struct Look {
  Theme theme = Theme::paper;
  std::string title, subtitle;
  bool clock = true;     // the time at the right of the caption
  double duration = 10;  // s of the run: in which unit the clock tells it
  bool badge = false;    // before it, how fast the film goes
  bool caption = true;   // the caption strip at all
  bool hatching = true;
  bool axes = true;                   // the frame of each box
  bool pointer = true;                // mouse, its spring and its path
  double velocity_scale = 0.1;        // s: arrow length in metres a metre per second
  bool velocity_scale_given = false;  // by the scene
  double force_scale = 0;          // m/N: arrow length in metres a newton; 0: chosen by the bodies' weights
  bool force_scale_given = false;  // by the scene
  std::vector<std::pair<std::string, Color>> tracks;  // those that have a colour, by name
  std::vector<BodyLook> bodies;                       // as in the Cast
  // in space
  sim::Vec3 light{-0.6, 1, 0.42};  // towards the light
  bool ground = true;              // the grid, and shadows on it
  bool drop_lines = false;         // from what flies to the ground under it
  double tile = 0;                 // m from one line of the grid to the next; 0: chosen by the camera
  double type_scale = 1;           // of all type but formulas above a figure
  double weight = 1;          // of lines and type, beside that of the page: a small panel has heavier ones
  std::string decimal = ".";  // what stands in numbers on the picture
  enum class Springs { automatic, coils, lines } springs = Springs::automatic;
};

/// The camera at one time; between two keys it moves with the ease of the later one.
struct CameraKey {
  enum class Ease { linear, in, out, in_out, hold };
  double time = 0;                       // s
  std::optional<sim::Vec3> center = {};  // m; none: the room's
  std::optional<double> width = {};   // m that the picture shows of the world across; none: all of the room
  std::optional<double> height = {};  // m, instead of the width: a wider window shows more; in space
  Ease ease = Ease::in_out;
  // in space; left out: as the camera says
  std::optional<double> azimuth = {}, elevation = {};  // rad: from where it looks, see Camera
  std::optional<sim::Vec3> eye = {};  // m: instead of both; a perspective camera's width, too
};

/// Without keys the camera shows as much as fits the room. In space it looks at a key's `center` from a
/// direction: azimuth 0 is from +z, a quarter turn from +x, counter-clockwise seen from above; elevation 0 is
/// level, a quarter turn is from above. `width` is what it shows across at the centre's distance, and so the
/// eye's distance follows from the field of view.
struct Camera {
  std::vector<CameraKey> keys;  // by time
  std::vector<int> follow;      // bodies whose common centre of mass it keeps in the middle
  // in space
  enum class Projection { perspective, orthographic };
  std::string name;  // over its panel, where there are several
  Projection projection = Projection::perspective;
  double field = 0.5235987755982988;      // rad, of a perspective camera, over the longer side of its window
  double azimuth = 0.5235987755982988;    // rad: where no key says otherwise
  double elevation = 0.3839724354387525;  // rad
  double orbit = 0;                     // rad/s, added to the azimuth, about the vertical through the centre
  bool fits_run = false;                // instead of the room: where bodies go in the whole run
  std::vector<sim::Vec3> reached = {};  // by the bodies of that run, where it is known: the outmost places, m
};

/// The place that a camera keeps in the middle, m; none where it follows nothing.
std::optional<sim::Vec3> followed(const Camera& camera, const sim::SceneInfo& cast, const sim::Snapshot& now);

}  // namespace obscura::draw
