#include "media/movie.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <png.h>

#include <algorithm>
#include <variant>

#include "media/codec.h"
#include "media/encoder.h"
#include "media/error.h"
#include "media/gif.h"
#include "media/mux.h"

namespace obscura::media {

namespace {

bool present(const std::string& name) {
  return libav().avcodec_find_encoder_by_name(name.c_str()) != nullptr;
}

}  // namespace

void check(const std::string& path, const MovieSpec& spec) {
  const Container& kind = container(path);
  encoder_name(path, spec, present);
  if (kind.ending == "gif") {
    check_gif(path, spec);
  } else if (kind.ending == "y4m") {
    check_frame(path, spec, "y4m");
  } else {
    open_encoder(path, spec);
  }
}

std::string codec_name(const std::string& path, const MovieSpec& spec) {
  return encoder_name(path, spec, present);
}

int segment_frames(const MovieSpec& spec) {
  const std::int64_t frames = (2 * spec.fps_num + spec.fps_den) / (2 * spec.fps_den);
  return int(std::clamp<std::int64_t>(frames, 1, 1000));
}

struct MovieWriter::Impl {
  template <typename Writer>
  Impl(std::in_place_type_t<Writer> type, const std::string& path, const MovieSpec& spec)
      : writer(type, path, spec) {}
  std::variant<Muxer, GifWriter> writer;
};

MovieWriter::MovieWriter(const std::string& path, const MovieSpec& spec)
    : impl_(container(path).ending == "gif" ? new Impl(std::in_place_type<GifWriter>, path, spec)
                                            : new Impl(std::in_place_type<Muxer>, path, spec)) {}

MovieWriter::~MovieWriter() = default;
MovieWriter::MovieWriter(MovieWriter&&) noexcept = default;

void MovieWriter::add(const Segment& segment) {
  std::visit([&](auto& writer) { writer.add(segment); }, impl_->writer);
}

void MovieWriter::close(const std::optional<std::string>& instead) {
  std::visit([&](auto& writer) { writer.close(instead.value_or("")); }, impl_->writer);
}

std::int64_t MovieWriter::frames() const {
  return std::visit([](const auto& writer) { return writer.frames(); }, impl_->writer);
}

std::string libraries() {
  const std::string png = fmt::format("libpng {}", png_get_libpng_ver(nullptr));
  try {
    libav();
  } catch (const Error& error) {
    return fmt::format("{}\n{}", error.what(), png);
  }
  const unsigned v = libav().avcodec_version();
  std::vector<std::string> encoders;
  for (const char* name : {"libx264", "libopenh264", "libx265", "libvpx-vp9"}) {
    if (present(name)) encoders.push_back(name);
  }
  return fmt::format("libavcodec {}.{}.{} ({}), encoders: {}\n{}", v >> 16, v >> 8 & 255, v & 255,
                     libav().avcodec_license(),
                     encoders.empty() ? "none" : fmt::format("{}", fmt::join(encoders, ", ")), png);
}

}  // namespace obscura::media
