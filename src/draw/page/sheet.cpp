// A sheet, from the top: free space, margin, band of the hatching, world, band, margin, free space.

#include "draw/page/sheet.h"

#include <algorithm>

namespace obscura::draw {
namespace {

constexpr double kSheetMargin = 2;  // pt: half a line's width is never cut off

}  // namespace

Layout lay_out(const sim::SceneInfo& cast, const Look& look, const Extent& extent, const Sheet& sheet) {
  Layout layout;
  layout.weight = kPrint;
  layout.width = sheet.width * kPoint;
  Fitted world = fitted_world(cast, extent);
  if (sheet.region) world = {false, sheet.region->low, sheet.region->high};
  layout.closed = world.closed;
  layout.clipped = !world.closed;
  layout.center = (world.low + world.high) / 2;

  const double band = cast.walls.empty() ? 0 : kPrint * (look.hatching ? kBand : kWallLine);
  const double around = kSheetMargin * kPoint + band;
  const Point size = (world.high - world.low).head<2>();
  const double left = kPoint * sheet.left, wide = layout.width - left;
  layout.scale =
      std::min((wide - 2 * around) / size.x(), (sheet.tallest * layout.width - 2 * around) / size.y());
  const double high = layout.scale * size.y() + 2 * around;
  layout.height = high + kPoint * (sheet.above + sheet.below);
  layout.aspect = layout.width / layout.height;
  layout.window = {left, kPoint * sheet.above, wide, high};
  layout.middle = {left + wide / 2, kPoint * sheet.above + high / 2};
  return layout;
}

}  // namespace obscura::draw
