#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/figure/figure_builder.h"
#include "gl/context.h"
#include "media/image.h"
#include "page/page.h"

namespace obscura::app {

/// A figure as pixels, `width` points wide, at `dpi` pixels an inch. Throws gl::Error.
media::Image pixels(const Page& page, double width, double dpi, const gl::ContextOptions& context);

/// Lit surfaces of a figure, which no vector says.
struct LitSurfaces {
  media::Image image;
  double pixel = 0;  // pt
  std::vector<std::uint8_t> png{};

  page::Raster raster() const { return {image.width, image.height, pixel, image.pixels.data(), png}; }
};

/// Those of a page, at their places on it; none where it has none.
std::optional<LitSurfaces> lit_surfaces(const Page& page, double width, double dpi,
                                        const gl::ContextOptions& context);

}  // namespace obscura::app
