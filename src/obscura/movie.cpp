#include <unistd.h>

#include <atomic>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "media/file.h"
#include "media/movie.h"
#include "obscura/inside.h"

namespace obscura {

struct Movie::Inside {
  Inside(const std::string& to, const FilmOptions& options) : path(to) {
    spec.width = options.width, spec.height = options.height;
    if (spec.width <= 0 || spec.height <= 0)
      throw UsageError(to + ": a movie of frames needs width and height");
    const auto fps = sim::parse_rational(options.fps);
    if (!fps || fps->num <= 0)
      throw UsageError(
          fmt::format("{}: fps {}: expected frames a second, as in 60 or 30000/1001", to, options.fps));
    spec.fps_num = fps->num, spec.fps_den = fps->den;
    spec.codec = options.codec, spec.preset = options.preset, spec.crf = options.crf;
    spec.alpha = options.transparent;
    media::check(path, spec);
    spec.codec = media::codec_name(path, spec);
    // no origin: what made these frames is not known
    spec.tags = {{"Software", "obscura " OBSCURA_VERSION}};
    media::make_folder_of(path);
    writer.emplace(path, spec);
  }

  Work work() { return {going, "this Movie"}; }
  void refuse_fork() const {
    if (::getpid() != process)
      throw UsageError(
          path + ": this Movie was made before fork(): its file is the parent's; make one in the child");
  }

  void end_segment() {
    if (!encoder) return;
    writer->add(encoder->finish());
    encoder.reset();
    within = 0;
  }

  std::string path;
  pid_t process = ::getpid();
  media::MovieSpec spec;
  std::optional<media::MovieWriter> writer;
  std::optional<media::SegmentEncoder> encoder;  // of the second at hand
  int within = 0;                                // frames of it
  std::int64_t frames = 0;
  media::Image image;
  std::atomic<bool> going = false;
};

namespace {

FilmOptions sized(FilmOptions options, const Renderer& renderer) {
  options.width = renderer.width(), options.height = renderer.height();
  options.fps = renderer.fps_text();
  return options;
}

}  // namespace

Movie::Movie(const std::string& path, const Renderer& renderer, const FilmOptions& options)
    : Movie(path, sized(options, renderer)) {}
Movie::Movie(const std::string& path, const FilmOptions& options)
    : inside_(guarded([&] { return std::make_unique<Inside>(path, options); })) {}
Movie::Movie(Movie&&) noexcept = default;
Movie::~Movie() {
  // the file of a parent is left to it
  if (inside_ && ::getpid() != inside_->process) (void)inside_.release();
}

Movie::Inside& Movie::inside() const { return held(inside_, "this Movie"); }

void Movie::add(const Frame& frame) {
  guarded([&] {
    Inside& it = inside();
    it.refuse_fork();
    const Work here = it.work();
    if (!it.writer) throw UsageError(it.path + ": is closed");
    if (frame.width != it.spec.width || frame.height != it.spec.height)
      throw UsageError(fmt::format("{}: a frame of {}x{}, expected {}x{}", it.path, frame.width, frame.height,
                                   it.spec.width, it.spec.height));
    if (const std::size_t whole = std::size_t(4) * std::size_t(frame.width) * std::size_t(frame.height);
        frame.pixels.size() != whole)
      throw UsageError(fmt::format("{}: a frame of {}x{} with {} bytes, expected {}", it.path, frame.width,
                                   frame.height, frame.pixels.size(), whole));
    if (!it.encoder) it.encoder.emplace(it.path, it.spec);
    it.image.width = frame.width, it.image.height = frame.height;
    it.image.pixels.assign(frame.pixels.begin(), frame.pixels.end());
    it.encoder->add(it.image);
    ++it.frames;
    if (++it.within == media::segment_frames(it.spec)) it.end_segment();
  });
}

std::int64_t Movie::frames() const { return inside().frames; }

void Movie::close() {
  guarded([&] {
    Inside& it = inside();
    it.refuse_fork();
    const Work here = it.work();
    if (!it.writer) return;
    if (it.frames == 0) throw UsageError(it.path + ": a movie of no frames");
    it.end_segment();
    it.writer->close();
    it.writer.reset();
  });
}

}  // namespace obscura
