#include "app/film.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "app/conduct.h"
#include "app/darkroom.h"
#include "app/exit.h"
#include "app/interrupt.h"
#include "app/origin.h"
#include "app/plots.h"
#include "app/simulation.h"
#include "app/trouble.h"
#include "media/error.h"
#include "media/file.h"
#include "media/png.h"

namespace obscura::app {

namespace {

// the same, drawn
struct Print {
  int frames = 0;
  bool whole = true;                      // false: an interrupt cut it short
  std::optional<media::Segment> segment;  // of a movie
  std::vector<media::Image> images;       // of a pipe
  Origin origin;                          // of its first frame
};

std::string size_text(std::uintmax_t bytes) {
  if (bytes < 1'000'000) return fmt::format("{:.0f} kB", double(bytes) / 1e3);
  if (bytes < 1'000'000'000) return fmt::format("{:.1f} MB", double(bytes) / 1e6);
  return fmt::format("{:.2f} GB", double(bytes) / 1e9);
}

int take_frames(const Output& output, const media::MovieSpec& spec) {
  switch (output.form) {
    case Output::Form::movie:
      return media::segment_frames(spec);
    case Output::Form::frames:
      return 4;
    case Output::Form::pipe:
      return 2;
    case Output::Form::still:
      return 1;
  }
  return 1;
}

}  // namespace

media::MovieSpec movie_spec(const scene::Scene& scene) {
  media::MovieSpec spec;
  spec.width = scene.film.width, spec.height = scene.film.height;
  spec.fps_num = scene.film.fps.num, spec.fps_den = scene.film.fps.den;
  spec.codec = scene.film.codec, spec.preset = scene.film.preset, spec.crf = scene.film.crf;
  return spec;
}

int film(const scene::Scene& scene, const Shots& shots, const Output& output, const FilmOptions& options) {
  media::MovieSpec spec = movie_spec(scene);
  if (output.form == Output::Form::movie) media::check(output.path, spec);
  if (output.form == Output::Form::pipe && options.pipe == media::PipeFormat::y4m)
    media::check("pipe.y4m", spec);

  // what stands in the way of the files is told before anything is simulated
  namespace fs = std::filesystem;
  if (output.form != Output::Form::pipe) {
    const std::string first = output.form == Output::Form::movie ? output.path : output.file(shots[0].frame);
    if (!options.overwrite && fs::exists(first)) {
      throw media::Error(fmt::format("{}: is there already, and --no-overwrite was asked for", first));
    }
    media::make_folder_of(first);
  }

  Origin origin = origin_of(scene);
  origin.native = options.context.native, origin.transparent = options.transparent;
  origin.shots = shots.text();
  if (output.form == Output::Form::movie) {
    origin.encoder = media::codec_name(output.path, spec);
    origin.preset = spec.preset, origin.crf = spec.crf;
  }

  const bool pictures = output.form == Output::Form::frames || output.form == Output::Form::still;
  const int workers =
      options.workers > 0 ? options.workers : std::max(1, int(std::thread::hardware_concurrency()));
  const int needed = int(std::min<std::int64_t>(
      workers, (shots.size() + take_frames(output, spec) - 1) / take_frames(output, spec)));
  const draw::Charts charts = app::charts(scene);
  Simulation simulation(scene, shots, depictor(scene, charts),
                        {.frames = take_frames(output, spec), .hash_each = pictures});
  Progress progress(options.progress, output.path == "-" ? "standard output" : output.path, shots.size(),
                    1 / sim::value(scene.film.fps));
  std::atomic<std::int64_t> drawn = 0;

  Conduct<Take, Print> parts;
  parts.produce = [&] { return simulation.next(); };
  parts.wait = [&] { progress.at(drawn); };

  // a worker: a context of its own, and for each take a closed piece of film
  parts.hire = [&] {
    auto darkroom = std::make_shared<Darkroom>(scene, charts, options.context);
    return [&, darkroom](Take take) {
      Print print;
      print.origin = origin;
      print.origin.gl_version = darkroom->renderer().version();
      print.origin.gl_renderer = darkroom->renderer().device();
      print.origin.shot = take.shots[0], print.origin.state = take.states[0];
      std::optional<media::SegmentEncoder> encoder;
      if (output.form == Output::Form::movie) encoder.emplace(output.path, spec);
      for (std::size_t i = 0; i < take.shots.size(); ++i) {
        if (interrupted() && i > 0) {
          print.whole = false;
          break;
        }
        const media::Image& image = darkroom->print(take, i, pictures && options.transparent);
        if (encoder) encoder->add(image);
        if (output.form == Output::Form::pipe) print.images.push_back(image);
        if (pictures) {
          Origin of_frame = print.origin;
          of_frame.shot = take.shots[i], of_frame.state = take.states[i];
          media::write_png(output.file(take.shots[i].frame), image,
                           {.alpha = options.transparent, .tags = of_frame.tags(scene.look.title)});
        }
        ++print.frames;
        ++drawn;
      }
      if (encoder) print.segment = encoder->finish();
      return print;
    };
  };

  // the joiner: segments into the movie, frames into the pipe, in order
  std::optional<media::MovieWriter> movie;
  std::optional<media::PipeWriter> pipe;
  if (output.form == Output::Form::pipe) pipe.emplace(STDOUT_FILENO, options.pipe, spec);
  std::int64_t done = 0;
  bool open = true, whole = true;
  parts.consume = [&](Print print) {
    if (print.segment) {
      if (!movie) {
        print.origin.frames = shots.size();
        spec.tags = print.origin.tags(scene.look.title);
        movie.emplace(output.path, spec);
      }
      movie->add(*print.segment);
    }
    for (const media::Image& image : print.images) {
      if (open && !pipe->write(image)) open = false;
    }
    done += print.frames;
    whole = print.whole;
    return whole && open;
  };
  conduct(parts, needed);

  // a film that ended early stands under a name that says so
  const bool cut = interrupted() || simulation.trouble();
  std::string made = output.path;
  if (movie) {
    if (cut) made = output.partial();
    movie->close(cut ? std::optional(made) : std::nullopt);
  }
  if (simulation.trouble()) {
    progress.finish(done, "", false);
    throw TroubleError(scene.file, *simulation.trouble(),
                       done > 0 && output.form != Output::Form::pipe
                           ? fmt::format("{} frame{} up to then {} in {}", done, done == 1 ? "" : "s",
                                         done == 1 ? "is" : "are", made)
                           : "");
  }
  if (interrupted()) {
    progress.finish(done,
                    done > 0 ? fmt::format("interrupted: {} of {} frames are in {}", done, shots.size(), made)
                             : "interrupted: nothing was written",
                    false);
    return kInterrupted;
  }
  std::string summary;
  std::error_code error;
  if (output.form == Output::Form::still) {
    summary = fmt::format("{}: {}x{} at t = {:g} s", output.file(shots[0].frame), spec.width, spec.height,
                          sim::value(shots[0].time));
  } else if (open) {
    const double seconds = double(done) / sim::value(scene.film.fps);
    summary =
        fmt::format("{}: {} frame{}, {:g} s at {:g} fps, {}x{}{}, made in {:.1f} s", made, done,
                    done == 1 ? "" : "s", seconds, sim::value(scene.film.fps), spec.width, spec.height,
                    output.form == Output::Form::movie ? ", " + size_text(fs::file_size(made, error)) : "",
                    progress.seconds());
  }
  if (!summary.empty()) progress.finish(done, summary, output.form != Output::Form::pipe);
  return kDone;
}

}  // namespace obscura::app
