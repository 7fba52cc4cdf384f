#include "app/figure/figure_raster.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "app/console/memory.h"
#include "draw/picture/solids.h"
#include "gl/renderer.h"
#include "media/png.h"

namespace obscura::app {

namespace {

struct Size {
  int width, height;
  double per_unit;  // pixels a page unit
};

// a page's size at a density: exactly so many pixels a point, the last ones cut where it ends between two
Size size_at(const draw::Picture& picture, double width, double dpi) {
  const double across = width / 72 * dpi, down = across / picture.aspect;
  return {std::max(1, int(std::ceil(across - 0.01))), std::max(1, int(std::ceil(down - 0.01))), down / 1080};
}

// solids are placed as the lines over them, to a fraction of a pixel
media::Image pixels(const draw::Picture& picture, const std::vector<Lit>& lit, const Size& size,
                    const gl::ContextOptions& context) {
  require_memory_to_draw(double(size.width) * size.height);
  gl::Renderer renderer(size.width, size.height, context);
  draw::Picture exact;
  exact.aspect = double(size.width) / size.height;
  exact.ground = picture.ground;
  exact.transparent = picture.transparent;
  const double k = size.per_unit * 1080 / size.height;
  draw::List still;
  for (const Lit& each : lit) {
    const double scale = k * each.where.height / 1080;
    const draw::Point at(k * each.where.x, k * each.where.y);
    still.add(*each.picture.still, scale, at);
    for (const auto& solids : each.picture.solids)
      exact.solids.push_back(std::make_shared<const draw::Solids>(draw::placed(*solids, scale, at)));
  }
  exact.still = std::make_shared<const draw::List>(std::move(still));
  exact.moving.add(picture.moving, k, {0, 0});
  return renderer.draw(exact);
}

}  // namespace

media::Image pixels(const Page& page, double width, double dpi, const gl::ContextOptions& context) {
  return pixels(page.picture, page.lit, size_at(page.picture, width, dpi), context);
}

std::optional<LitSurfaces> lit_surfaces(const Page& page, double width, double dpi,
                                        const gl::ContextOptions& context) {
  if (page.lit.empty()) return {};
  // so many pixels that a panel has whole ones: its lines, which are vectors, then lie on its edges
  Size grid = size_at(page.picture, width, dpi);
  const double rows = page.lit.front().where.height;
  grid.per_unit = std::ceil(rows * grid.per_unit) / rows;
  grid.width = int(std::ceil(1080 * page.picture.aspect * grid.per_unit));
  grid.height = int(std::ceil(1080 * grid.per_unit));
  draw::Picture blank;
  blank.ground = page.picture.ground;
  LitSurfaces made;
  made.image = pixels(blank, page.lit, grid, context);
  made.pixel = width / page.picture.aspect / 1080 / grid.per_unit;
  made.png = media::encode_png(made.image);
  return made;
}

}  // namespace obscura::app
