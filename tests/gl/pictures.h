#pragma once

#include "draw/picture/list.h"
#include "gl/renderer.h"
#include "media/image.h"

namespace obscura::gl {

constexpr draw::Color kWhite{255, 255, 255}, kBlack{0, 0, 0};

/// A picture with nothing on it.
inline draw::Picture blank(const media::Image& size, draw::Color ground = kWhite) {
  draw::Picture picture;
  picture.aspect = double(size.width) / size.height;
  picture.ground = ground;
  return picture;
}

/// What a small renderer makes of a list; `units` page units a pixel.
inline media::Image drawn(Renderer& renderer, const draw::Picture& picture) {
  media::Image image;
  renderer.draw(picture, image);
  return image;
}

/// How dark a pixel of a white picture is, 0 to 1.
inline double ink(const media::Image& image, int x, int y) { return (255 - image.row(y)[4 * x]) / 255.0; }

}  // namespace obscura::gl
