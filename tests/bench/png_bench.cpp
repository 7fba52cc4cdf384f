// A frame of the crowd as PNG: ours beside libpng as it is out of the box. Bars: a third of its time, bytes
// within a tenth.

#include <benchmark/benchmark.h>
#include <png.h>

#include <random>

#include "gl/renderer.h"
#include "media/png.h"

namespace {

using namespace obscura;

// Flat ground with outlined discs and boxes at places of no pattern, as our pictures are.
media::Image body_counts() {
  draw::Picture picture;
  picture.ground = {255, 255, 255};
  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random()) / 4294967296.0;
  };
  for (int i = 0; i < 500; ++i)
    picture.moving.add(draw::Disc{.center = {uniform(100, 1820), uniform(100, 1000)},
                                  .radius = 6,
                                  .line = 2.8,
                                  .fill = {160, 200, 225},
                                  .outline = {0, 80, 125}});
  for (int i = 0; i < 200; ++i) {
    const double turn = uniform(0, 6.28);
    picture.moving.add(draw::Box{.center = {uniform(100, 1820), uniform(100, 1000)},
                                 .x_axis = {std::cos(turn), std::sin(turn)},
                                 .half = {24, 14},
                                 .line = 2.8,
                                 .axis = 8,
                                 .axis_line = 2.8,
                                 .fill = {250, 218, 158},
                                 .outline = {161, 111, 0},
                                 .axis_color = {161, 111, 0}});
  }
  media::Image image;
  gl::Renderer(1920, 1080).draw(picture, image);
  return image;
}

const media::Image& frame() {
  static const media::Image image = body_counts();
  return image;
}

void ours(benchmark::State& state) {
  std::size_t bytes = 0;
  frame();
  for (auto _ : state) bytes = media::encode_png(frame()).size();
  state.counters["bytes"] = double(bytes);
}
BENCHMARK(ours)->Unit(benchmark::kMillisecond);

void libpng(benchmark::State& state) {
  const media::Image& image = frame();
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < image.pixels.size(); i += 4)
    rgb.insert(rgb.end(), &image.pixels[i], &image.pixels[i + 3]);
  std::vector<std::uint8_t> file;
  for (auto _ : state) {
    file.clear();
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &file,
        [](png_structp to, png_bytep bytes, png_size_t size) {
          auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(to));
          out.insert(out.end(), bytes, bytes + size);
        },
        nullptr);
    png_set_IHDR(png, info, png_uint_32(image.width), png_uint_32(image.height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (int y = 0; y < image.height; ++y)
      png_write_row(png, &rgb[std::size_t(3) * std::size_t(image.width) * std::size_t(y)]);
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
  }
  state.counters["bytes"] = double(file.size());
}
BENCHMARK(libpng)->Unit(benchmark::kMillisecond);

}  // namespace
