// Tracks: a line along the curve, and on the side that nothing touches short lines at 45 degrees to it, which
// move with the track.

#include <algorithm>
#include <cmath>

#include "draw/picture/rope_way.h"
#include "draw/plane/stage.h"

namespace obscura::draw {

namespace {

constexpr double kDeep = 0.7;  // of the band of a wall

}  // namespace

std::optional<Color> track_color(const Look& look, const std::string& name) {
  const auto known = std::find_if(look.tracks.begin(), look.tracks.end(),
                                  [&](const auto& each) { return each.first == name; });
  return known == look.tracks.end() ? std::nullopt : std::optional(known->second);
}

void draw_tracks(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight;
  for (const sim::SceneInfo::Rail& rail : stage.cast.rails) {
    std::vector<Point> way;
    for (const sim::Vec3& place : rail.places) way.push_back(view.page(place_of(now, {rail.body, place})));
    const bool wire = !rail.left && !rail.right;
    const Color color =
        track_color(stage.look, rail.name).value_or(wire ? stage.colours.spring : stage.colours.wall);

    // hatching, each line as far from the one before
    if (rail.left != rail.right && stage.look.hatching) {
      const double step = kHatchStep * weight, depth = kDeep * kBand * weight;
      double next = step / 2, along = 0;
      for (std::size_t i = 1; i < way.size(); ++i) {
        const Point d = way[i] - way[i - 1];
        const double length = d.norm();
        if (!(length > 0)) continue;
        const Point t = d / length;
        // the page's y goes down: to the left of the way is (t.y, -t.x)
        const Point far = rail.left ? Point(-t.y(), t.x()) : Point(t.y(), -t.x());
        const Point slant = (far + (rail.left ? -t : t)) * depth;
        for (; next <= along + length; next += step) {
          const Point at = way[i - 1] + (next - along) * t;
          list.add({{at, kHatchLine * weight, stage.colours.hatch},
                    {Point(at + slant), kHatchLine * weight, stage.colours.hatch}},
                   Cap::butt);
        }
        along += length;
      }
    }
    std::vector<Node> line;
    const double width = (wire ? kSpringLine : kWallLine) * weight;
    for (const Point& at : way) line.push_back({at, width, color});
    if (rail.closed && line.size() > 3) line.pop_back();
    list.add(line, wire ? Cap::round : Cap::butt, Blend::over, rail.closed && line.size() > 2);
  }
}

}  // namespace obscura::draw
