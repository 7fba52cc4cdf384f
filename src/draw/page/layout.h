#pragma once

#include <string>
#include <utility>
#include <vector>

#include "draw/picture/convex.h"
#include "draw/picture/prose.h"
#include "draw/picture/theme.h"
#include "draw/picture/view.h"

namespace obscura::draw {

/// The arrangement of the page, computed once for a whole run: the caption strip, the window below it that
/// shows the world, and the scale of the world if the camera fits it.
struct Layout {
  double width = 1920;            // of the page, less what charts take of it
  double height = 1080;           // the same; a sheet's is another, see draw/page/sheet.h
  double aspect = 1920 / 1080.0;  // of the page, width over height
  double weight = 1;              // of lines and type: 1 on a landscape page, less where the page is narrow
  Rect window;                    // shows the world
  bool clipped = false;           // the world may reach over the window's edge
  double scale = 1;               // page units a metre, where the camera fits
  Point middle;                   // where the centre of what is fitted lies
  sim::Vec3 center = sim::Vec3::Zero();  // and which place of the world it is
  double room_height = 0;                // page units: what caption, captions and charts leave to the world
  bool closed = false;                   // the walls close
  bool caption = false;
  std::vector<Text> words;  // title and subtitle
  std::vector<std::pair<Formula, Point>>
      prose;              // those of their lines that have mathematics, at their left ends
  Text clock;             // its span's text is the instant's
  double clock_left = 0;  // where its widest text begins, page units
};

/// The fitted region: the room if its walls close, else the extent, and the ground near it.
struct Fitted {
  bool closed = false;
  sim::Vec3 low, high;
};
Fitted fitted_world(const sim::SceneInfo& cast, const Extent& extent);

/// Lays the page out: the caption above, aligned to the room's edges, the room centred and as large as
/// caption and hatching allow. Throws draw::Error where a font is missing.
/// `right` and `below` are left free at those edges, page units.
Layout lay_out(const sim::SceneInfo& cast, const Look& look, const Camera& camera, const Extent& extent,
               double aspect, double right = 0, double below = 0);

/// Writes the caption over a page without a room on it, and says how high its strip is.
double lay_caption(Layout& layout, const Look& look);

/// The weight of lines and type on a page of this aspect.
double page_weight(double aspect);

/// How much room the badge of a film's speed takes before the clock, page units, where `type` is the weight
/// of type.
inline constexpr double kBadge = 23;  // em
double badge_room(double type);

/// Draws title and subtitle.
void draw_words(const Layout& layout, List& list);

/// How wide words are set, and the mathematics between dollars in them, page units; `tabular`: with figures
/// of equal width.
double width_of(const std::string& words, Face face, double size, bool tabular = false);

/// A time (s) of a run of a duration (s): "t = 3.42 s"; of one of less than 0.2 s in ms, of still shorter
/// ones in µs, ns, ps or fs.
std::string clock_text(double time, double duration);

/// The walls as half planes of the page, as `view` shows them.
std::vector<HalfPlane> half_planes(const sim::SceneInfo& cast, const View& view);

/// Nothing within `reach` of p lies in the rectangle.
bool outside(const Rect& rect, const Point& p, double reach);

/// As many lines as words need to be no wider than `width`.
std::vector<std::string> wrapped(const std::string& words, Face face, double size, double width);

/// As much of `words` as fits `width`, with an ellipsis where something is left out.
std::string fitted(const std::string& words, Face face, double size, double width);

}  // namespace obscura::draw
