// obscura render: a scene goes in, a movie, pictures, one picture or a stream comes out.

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/memory.h"
#include "app/console/options.h"
#include "app/console/progress.h"
#include "app/console/say.h"
#include "app/film/estimate.h"
#include "app/film/film.h"
#include "app/film/film_page.h"
#include "app/film/pages.h"
#include "app/film/subtitles.h"
#include "app/run/imported_run.h"
#include "app/run/origin.h"
#include "app/run/run_marks.h"
#include "app/run/shard.h"
#include "app/run/trouble.h"
#include "media/error.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

struct RenderFlags {
  std::string scene;
  std::vector<std::string> sets;
  std::optional<std::string> out, size, fps, from, to, at, frames, theme, preset, codec, camera, states;
  std::optional<std::string> shard, checkpoint_every;
  std::optional<std::string> poster, under;
  std::optional<double> crf;
  bool draft = false, no_overwrite = false, interpolate = false;
  FilmOptions film;
};

sim::Rational seconds(const std::string& flag, const std::string& text) {
  const auto time = sim::parse_rational(text);
  if (!time || *time < sim::Rational{0, 1} || kLongest < *time)
    throw UsageError(fmt::format("{} {}: expected seconds from 0 to 1e6", flag, text));
  return *time;
}

// small, where no flag says otherwise: 480 lines, at most 30 frames a second
void make_draft(const RenderFlags& flags, scene::Film& film) {
  if (!flags.size && film.height > 480) {
    film.width = std::max(2, int(std::lround(480.0 * film.width / film.height / 2)) * 2);
    film.height = 480;
  }
  while (!flags.fps && 30 < sim::value(film.fps)) film.fps = film.fps / sim::rational(2);
}

// and quick: the quickest preset of an encoder that has presets
void make_quick(const RenderFlags& flags, const Output& out, scene::Scene& scene) {
  if (flags.preset || out.form != Output::Form::movie) return;
  scene.film.preset.clear();
  media::MovieSpec spec = movie_spec(scene);
  spec.alpha = flags.film.transparent;
  const std::string encoder = media::codec_name(out.path, spec);
  if (encoder == "libx264" || encoder == "libx265") scene.film.preset = "ultrafast";
}

// flags override the scene
void override_film(const RenderFlags& flags, scene::Scene& scene) {
  if (flags.draft) make_draft(flags, scene.film);
  if (flags.size) std::tie(scene.film.width, scene.film.height) = parse_size(*flags.size);
  if (flags.fps) scene.film.fps = parse_fps(*flags.fps);
  if (flags.theme) scene.look.theme = *flags.theme == "screen" ? draw::Theme::screen : draw::Theme::paper;
  if (flags.crf) scene.film.crf = flags.crf;
  if (flags.preset) scene.film.preset = *flags.preset;
  if (flags.codec) scene.film.codec = *flags.codec;
}

// pages are turned by hand or by a viewer that is slow
void suit_pages(const std::string& out, scene::Film& film) {
  if (!out.ends_with(".pdf") || sim::value(film.fps) <= 15) return;
  while (sim::value(film.fps) > 15) film.fps = film.fps / sim::rational(2);
  say(stderr, "{}: at {:g} pages per second of film; --fps says otherwise\n", out, sim::value(film.fps));
}

Output poster_of(const Output& movie) {
  return {Output::Form::still, std::filesystem::path(movie.path).replace_extension(".poster.png").string(),
          true};
}

// the film, and a still of it for where it does not play
int film_and_poster(const scene::Scene& scene, const Shots& shots, const Output& out,
                    const RenderFlags& flags) {
  const int exit = film(scene, shots, out, flags.film);
  if (exit != kDone || !flags.poster || flags.film.prepare) return exit;
  if (flags.film.shard && flags.film.shard->first > 1) return exit;
  FilmOptions options = flags.film;
  options.shard.reset(), options.from_checkpoint.reset();
  options.resume = options.anew = false, options.checkpoint_every = {0, 1};
  return film(scene, Shots::still(seconds("--poster", *flags.poster), scene.film.fps, scene.film.speed),
              poster_of(out), options);
}

// a GIF of at most so many bytes: smaller until it fits, by what the last one took
int film_under(scene::Scene scene, const Shots& shots, const Output& out, const RenderFlags& flags) {
  constexpr double kAim = 0.94;  // of what is allowed
  constexpr int kLeast = 64;     // px
  const double most = parse_bytes(*flags.under);
  const Output trial{Output::Form::movie, out.path + ".sizing.gif", true};
  FilmOptions options = flags.film;
  options.anew = options.overwrite = true;
  options.progress = ProgressKind::none;  // of the GIF, not of its trials
  if (!flags.film.overwrite) require_fresh(out.path);
  Progress progress(flags.film.progress, out.path, shots.size(), 1 / sim::value(scene.film.fps));
  const double aspect = double(scene.film.width) / scene.film.height;
  double height = scene.film.height;
  const auto discard = [&] {
    std::error_code none;
    for (const std::string& left : {trial.path, captions_of(trial.path), trial.partial()})
      std::filesystem::remove(left, none);
    std::filesystem::remove_all(trial.parts(), none);
  };
  for (;;) {
    scene.film.height = std::max(2, int(std::lround(height)));
    scene.film.width = std::max(2, int(std::lround(height * aspect)));
    if (const int exit = film(scene, shots, trial, options); exit != kDone) {
      discard();
      progress.finish(0, "interrupted: nothing was written", false);
      return exit;
    }
    const double size = double(std::filesystem::file_size(trial.path));
    if (size <= most) break;
    // bytes grow with edges and with areas
    height = std::min(height - 2, height * std::pow(kAim * most / size, 0.7));
    if (height * std::min(aspect, 1.0) < kLeast) {
      discard();
      throw UsageError(
          fmt::format("--under {}: {} of it at {}x{}; fewer frames (--fps, --from, --to) take less",
                      *flags.under, bytes_text(size), scene.film.width, scene.film.height));
    }
  }
  const auto put = [](const std::string& from, const std::string& to) {
    if (std::rename(from.c_str(), to.c_str()) != 0)
      throw media::Error(fmt::format("{}: cannot rename into place", to));
  };
  if (std::filesystem::exists(captions_of(trial.path))) put(captions_of(trial.path), captions_of(out.path));
  put(trial.path, out.path);
  progress.finish(shots.size(),
                  fmt::format("{}: {}x{}, {}", out.path, scene.film.width, scene.film.height,
                              bytes_text(double(std::filesystem::file_size(out.path)))),
                  true);
  return kDone;
}

// a file for each camera: their names in OUT's {camera}
int render_each(const scene::Scene& scene, const Shots& shots, const RenderFlags& flags) {
  for (const draw::Camera& camera : scene.cameras) {
    if (camera.name.empty())
      throw UsageError(fmt::format("-o {}: the scene's camera has no name", *flags.out));
    scene::Scene one = scene;
    one.cameras = {camera};
    std::string name = *flags.out;
    name.replace(name.find("{camera}"), 8, camera.name);
    const Output out = output(name, scene.name, flags.at.has_value(), shots.size());
    if (const int exit = film_and_poster(one, shots, out, flags); exit != kDone) return exit;
  }
  return kDone;
}

// GIF counts in hundredths of a second: another rate becomes the next lower one, with a message
void suit_gif(const std::string& out, scene::Film& film) {
  if (!out.ends_with(".gif")) return;
  for (const int fps : {50, 25, 20, 10}) {
    if (sim::floor(film.fps) < fps) continue;
    if (film.fps == sim::rational(fps)) return;
    film.fps = sim::rational(fps);
    say(stderr, "{}: at {} frames per second, for GIF counts in hundredths of a second\n", out, fps);
    return;
  }
}

Shots shots_of(const RenderFlags& flags, const scene::Scene& scene) {
  if (flags.at) {
    if (flags.frames || flags.from || flags.to)
      throw UsageError("--at names one instant: leave out --frames, --from and --to");
    return Shots::still(seconds("--at", *flags.at), scene.film.fps, scene.film.speed);
  }
  Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  if (shots.size() == 0) throw UsageError(fmt::format("{}: a film of 0 s has no frames", scene.file));
  if (flags.from || flags.to) {
    shots.between(flags.from ? seconds("--from", *flags.from) : sim::Rational{0, 1},
                  flags.to ? seconds("--to", *flags.to) : scene.duration);
  }
  if (flags.frames) shots.only(*flags.frames);
  return shots;
}

// another program's run instead of the simulation
void take_run(const RenderFlags& flags, scene::Scene& scene) {
  std::vector<std::string> notes;
  show_run(read_table(*flags.states), flags.interpolate, scene, notes);
  if (scene.film.shutter > 0)
    notes.push_back(
        fmt::format("{} has no instants between its rows: filmed without motion blur", *flags.states));
  scene.film.shutter = 0;
  for (const std::string& note : notes) say(stderr, "{}\n", note);
}

// instants without rows cannot be filmed
void suit_run(const RenderFlags& flags, const scene::Scene& scene, Shots& shots) {
  const sim::Trajectory& run = *scene.trajectory;
  if (!flags.at && !flags.to) {
    // up to its last row
    const draw::Pace& speed = scene.film.speed;
    const double end = sim::value(speed.film(sim::rational(std::llround(run.times.back() * 1e6), 1'000'000)));
    const auto last = std::int64_t(std::floor(end * sim::value(scene.film.fps) + 1e-6));
    shots.between({0, 1}, speed.world(sim::rational(last + 1) / scene.film.fps));
  }
  for (std::int64_t i = 0; i < shots.size(); ++i) {
    const double t = sim::value(shots[i].time);
    if (run.has(t)) continue;
    const bool outside = t < run.times.front() || t > run.times.back();
    throw UsageError(fmt::format(
        "{} has no row at t = {:g} s (frame {}){}", *flags.states, t, shots[i].frame,
        outside ? fmt::format("; it goes from {:g} s to {:g} s", run.times.front(), run.times.back())
                : "; --interpolate takes straight lines between rows, --fps films its own"));
  }
}

// the part of a film that is made, and where it starts
void divide(RenderFlags& flags, const Output& out) {
  if (flags.shard) {
    const Shard shard = parse_shard(*flags.shard);
    flags.film.shard = {int(shard.number), int(shard.of)};
  }
  if (flags.checkpoint_every)
    flags.film.checkpoint_every = seconds("--checkpoint-every", *flags.checkpoint_every);
  if (flags.checkpoint_every && flags.film.checkpoint_every.num == 0)
    throw UsageError("--checkpoint-every 0: expected seconds above 0");
  if (flags.film.shard && flags.film.prepare) throw UsageError("--shard and --prepare exclude each other");
  const bool whole = out.form == Output::Form::pipe || out.form == Output::Form::still;
  if (whole && (flags.film.shard || flags.film.prepare || flags.film.resume || flags.film.anew))
    throw UsageError("--resume, --anew, --shard and --prepare are for movies and sequences of pictures");
  if (flags.film.resume && flags.film.anew) throw UsageError("--resume and --anew exclude each other");
  if (flags.film.shard && flags.film.anew)
    throw UsageError("--anew discards what all shards made: it is for --prepare, or for the whole film");
  if (out.form == Output::Form::pipe && flags.checkpoint_every)
    throw UsageError("--checkpoint-every needs an output with a name");
}

// estimates the resources first; prints them if the film takes longer than a minute
void see_what_it_needs(scene::Scene& scene, const Shots& shots, const Output& out, FilmOptions& film) {
  constexpr double kPatience = 0.03, kLong = 60;
  const Needs all = needs(scene, shots, out, kPatience);
  film.workers = fitting_workers(scene, all, film.workers);
  // Threads share the steps where these, not the pictures, are what is waited for. What piles up takes longer
  // than its first steps say.
  if (2 * all.simulate * film.workers > all.simulate + all.draw) scene.share_steps(film.workers);
  const double seconds = all.seconds(film.workers);
  if (seconds < kLong || film.progress == ProgressKind::none) return;
  if (film.progress == ProgressKind::json) return;  // says what is left as it goes
  say(stderr, "{}: {} frames, about {}{}: an estimate, from its first steps\n", scene.file, all.frames,
      time_text(seconds), all.disk > 0 ? " and " + bytes_text(all.disk) : "");
}

int render(RenderFlags flags) {
  flags.film.overwrite = !flags.no_overwrite;
  scene::Scene scene = scene::read(flags.scene, flags.sets);
  if (!flags.states)
    scene = with_run_marks(std::move(scene));
  else if (!scene.marks.empty())
    say(stderr, "{}: events are of its own run, and {} is another: what waits for marks is not shown\n",
        scene.file, *flags.states);
  for (const auto& [flag, at] : {std::pair("--at", &flags.at), std::pair("--from", &flags.from),
                                 std::pair("--to", &flags.to), std::pair("--poster", &flags.poster)}) {
    if (*at && !flags.states) *at = with_instants(scene, flag, **at);
  }
  override_film(flags, scene);
  if (flags.out && !flags.fps) suit_gif(*flags.out, scene.film), suit_pages(*flags.out, scene.film);
  if (flags.interpolate && !flags.states) throw UsageError("--interpolate is for --states");
  if (flags.states) take_run(flags, scene);
  Shots shots = shots_of(flags, scene);
  if (flags.states) suit_run(flags, scene, shots);
  if (flags.camera) choose_camera(*flags.camera, scene);
  // a draft never takes the film's place
  const bool each = flags.out && flags.out->find("{camera}") != std::string::npos;
  if (flags.out && flags.out->ends_with(".pdf")) {
    if (each) throw UsageError("-o '{camera}.pdf': pages are of one camera, or of all; --camera chooses");
    if (flags.shard || flags.film.prepare || flags.film.resume || flags.film.anew || flags.checkpoint_every ||
        flags.poster || flags.under || flags.film.from_checkpoint)
      throw UsageError("pages are made at once: no shards, no --resume, no checkpoints, no --poster");
    return film_pages(scene, shots, *flags.out, flags.film);
  }
  if (flags.out && flags.out->ends_with(".html")) {
    if (each) throw UsageError("-o '{camera}.html': a page is of one camera, or of all; --camera chooses");
    if (flags.at || flags.shard || flags.film.prepare || flags.film.resume || flags.film.anew ||
        flags.checkpoint_every || flags.poster || flags.under || flags.film.from_checkpoint ||
        flags.film.transparent)
      throw UsageError(
          "a page is made at once, of a film: no --at, no shards, no --resume, no checkpoints, no --poster");
    return film_page(scene, shots, *flags.out, flags.film);
  }
  const Output out =
      output(flags.out, flags.draft ? scene.name + ".draft" : scene.name, flags.at.has_value(), shots.size());
  if (flags.film.transparent &&
      (out.form == Output::Form::pipe ||
       (out.form == Output::Form::movie && !out.path.ends_with(".webm") && !out.path.ends_with(".mov"))))
    throw UsageError("--transparent is for .webm (VP9), .mov (ProRes 4444) and PNG: others have no alpha");
  if (flags.draft) make_quick(flags, out, scene);
  scene.film.titles.still = out.form == Output::Form::still;
  if (flags.poster && out.form != Output::Form::movie)
    throw UsageError("--poster is a still beside a movie; --at makes one alone");
  if (flags.poster) {
    seconds("--poster", *flags.poster);
    if (flags.no_overwrite) require_fresh(poster_of(out).path);
  }
  const bool under = flags.under.has_value();
  if (under && (each || out.form != Output::Form::movie || !out.path.ends_with(".gif")))
    throw UsageError("--under is for one GIF: --crf makes other movies smaller");
  if (under && (flags.shard || flags.film.prepare || flags.film.resume || flags.poster))
    throw UsageError("--under makes a GIF several times: no shards, no --resume, no --poster");
  if (under) parse_bytes(*flags.under);
  divide(flags, out);
  warn_of_steps(scene);
  see_what_it_needs(scene, shots, out, flags.film);
  const int code = under  ? film_under(scene, shots, out, flags)
                   : each ? render_each(scene, shots, flags)
                          : film_and_poster(scene, shots, out, flags);
  warn_of_letters(scene);
  return code;
}

}  // namespace

OBSCURA_COMMAND(10, render) {
  const Command command(program, exit, "render",
                        "Film a scene: a movie, a sequence of PNGs, one PNG or a stream");
  auto flags = std::make_shared<RenderFlags>();
  add_scene(command, flags->scene);
  command
      .option(
          "-o,--output", flags->out,
          "The output; its form decides what is made: movie.mp4 (.mkv .mov .webm .gif), "
          "frames/{frame:04}.png or "
          "frames/%04d.png, pages.pdf (one a frame), page.html (plays in a browser, without a network), one "
          "picture.png with --at, - for a stream. Left "
          "out: render_out/SCENE.mp4")
      .type("OUT");
  add_sets(command, flags->sets);
  command.option("--camera", flags->camera, "Only this camera; -o '{camera}.mp4' writes a file for each")
      .type("NAME");
  command
      .option("--at", flags->at,
              "One picture, at this instant (s), which may be after the duration, or at a mark of the run")
      .type("SECONDS");
  command.option("--from", flags->from, "The first instant (s of the run, or a mark) that is filmed")
      .type("SECONDS");
  command.option("--to", flags->to, "The end of the film (s, or a mark); this instant is not filmed")
      .type("SECONDS");
  command.option("--frames", flags->frames, "Only these frames, counted from 0, as in 1,3,5..9").type("LIST");
  command.option("--size", flags->size, "Pixels, as in 1280x720; even for movies").type("WxH");
  command.option("--fps", flags->fps, "Frames per second, as in 60 or 30000/1001").type("RATE");
  command.option("--theme", flags->theme, "paper (white, for print) or screen (dark, for projectors)")
      .one_of({"paper", "screen"});
  command
      .option("--states", flags->states,
              "Film another program's run instead of simulating: a table as `obscura states --format csv` "
              "writes it, with the names of the scene's bodies")
      .type("RUN.csv");
  command.flag("--interpolate", flags->interpolate, "With --states: straight lines between its rows");
  command.flag("--draft", flags->draft,
               "Small and quick: 480 lines, at most 30 frames per second, ultrafast");
  command.flag("--transparent", flags->film.transparent,
               "Leave the page's colour out: of PNG, .webm (VP9) and .mov (ProRes 4444)");
  command.flag("--no-overwrite", flags->no_overwrite, "Refuse to overwrite an earlier render");
  command.option("--crf", flags->crf, "Quality of the movie, lower is better [18]").range(1.0, 63.0);
  command.option("--preset", flags->preset, "x264's preset [fast settings with medium's quality]");
  command.option("--codec", flags->codec, "The encoder, by libavcodec's name, as in libx264 or libvpx-vp9");
  command
      .choice("--pipe", flags->film.pipe,
              {{"y4m", media::PipeFormat::y4m}, {"rgba", media::PipeFormat::rgba}},
              "With -o -: y4m or rgba, raw frames [y4m]")
      .type("FORM");
  command
      .option(
          "--poster", flags->poster,
          "Also a still of this instant (s, or a mark), for where the movie does not play: movie.poster.png")
      .type("SECONDS");
  command
      .option("--under", flags->under,
              "Of a GIF: at most so large, as in 5MB; its picture is made smaller until it is")
      .type("SIZE");
  command.flag("--resume", flags->film.resume,
               "Continue a film that was stopped from its finished parts, to the same bytes");
  command.flag("--anew", flags->film.anew,
               "Start again and discard what an earlier render left, even shards and hours of work");
  command
      .option("--shard", flags->shard,
              "Make only this shard of the film, as in 2/4; obscura join makes the movie of all")
      .type("I/N");
  command
      .option("--prepare", flags->film.prepare,
              "Draw nothing: simulate once, and write the state at the beginning of each of N shards")
      .type("N")
      .range(1, 100000);
  command
      .option("--checkpoint-every", flags->checkpoint_every,
              "Keep the whole state this often (s of the run), in OUT.checkpoints")
      .type("SECONDS");
  command
      .option("--from-checkpoint", flags->film.from_checkpoint,
              "Start from the state in this file; --from must be at its time or later")
      .type("FILE");
  add_memory_limit(command);
  command
      .option(
          "-j,--jobs", flags->film.workers,
          "Workers that draw and encode in parallel, and share the steps where these are slow [one per core]")
      .range(1, 256);
  add_backend(command, flags->film.context.backend);
  command.flag("--native", flags->film.context.native,
               "Use all instructions of this processor: a tenth faster, but pixels may differ by a level on "
               "other machines");
  add_progress(command, flags->film.progress);
  command.footer(
      "Examples:\n"
      "  obscura render scenes/room.toml\n"
      "  obscura render scenes/room.toml -o room.mp4 --size 1280x720 --fps 30\n"
      "  obscura render scenes/room.toml --at 2.5 -o room.png --theme screen\n"
      "  obscura render scenes/room.toml -o 'frames/{frame:04}.png' --from 2 --to 3\n"
      "  obscura render scenes/room.toml --draft --set ball.elasticity=1\n"
      "  obscura render scenes/room.toml --states student.csv --fps 30\n"
      "  obscura render scenes/room.toml -o - | ffplay -\n"
      "  obscura render scenes/room.toml --resume       after a power cut\n"
      "While a film is made, its finished parts lie in OUT.parts: they can be played, and --resume continues "
      "from them.");
  command.run([flags] { return render(*flags); });
}

}  // namespace obscura::app
