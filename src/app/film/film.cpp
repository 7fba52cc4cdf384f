#include "app/film/film.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/memory.h"
#include "app/console/say.h"
#include "app/film/frame_renderer.h"
#include "app/film/join.h"
#include "app/film/ordered_pipeline.h"
#include "app/film/store.h"
#include "app/film/subtitles.h"
#include "app/run/ahead.h"
#include "app/run/checkpoint.h"
#include "app/run/description.h"
#include "app/run/origin.h"
#include "app/run/simulation.h"
#include "app/run/telling.h"
#include "app/run/trouble.h"
#include "draw/picture/prose.h"
#include "media/error.h"
#include "media/file.h"
#include "media/part.h"
#include "media/png.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

// The memory of frames that have been written, for those to come.
class SpareFrames {
 public:
  std::vector<std::uint8_t> take() {
    const std::lock_guard lock(mutex_);
    if (frames_.empty()) return {};
    std::vector<std::uint8_t> last = std::move(frames_.back());
    frames_.pop_back();
    return last;
  }
  void give(std::vector<std::uint8_t> frame) {
    const std::lock_guard lock(mutex_);
    frames_.push_back(std::move(frame));
  }

 private:
  std::mutex mutex_;
  std::vector<std::vector<std::uint8_t>> frames_;
};

// Makes one film, or a share of it.
class Filming {
 public:
  Filming(const scene::Scene& scene, const Shots& shots, const Output& output, const FilmOptions& options);
  int run();

 private:
  // a take, drawn
  struct DrawnSegment {
    std::int64_t number = 0;
    int frames = 0;
    bool whole = true;                               // false: an interrupt cut it short
    std::vector<std::vector<std::uint8_t>> piped{};  // frames of a pipe
  };

  bool movie() const { return output_.form == Output::Form::movie; }
  bool pictures() const {
    return output_.form == Output::Form::frames || output_.form == Output::Form::still;
  }
  int frames_of(std::int64_t take) const {
    return int(std::min<std::int64_t>(journal_.take_frames, shots_.size() - take * journal_.take_frames));
  }
  bool whole(std::int64_t take);
  bool has_frames(std::int64_t take) const;
  bool already_whole() const;
  void clear_leftovers() const;
  SimulationOptions simulating();
  int prepare(Simulation& simulation);
  std::function<DrawnSegment(FilmSegment)> hire();
  DrawnSegment print(FilmSegment take, FrameRenderer& darkroom);
  std::string description(const FrameRenderer& darkroom, const FilmSegment& take, std::size_t i) const;
  void shoot(Simulation& simulation, Progress& progress);
  void clear_longer() const;
  int finish(Progress& progress, const Simulation& simulation, std::int64_t wanted);
  std::string cut_part() const {
    return (fs::path(store_->folder()) / ("cut." + media::part_ending(output_.path, spec_))).string();
  }

  const scene::Scene& scene_of_run(std::size_t number) const {
    return ahead_.runs ? (*ahead_.runs)[number].scene : scene_;
  }

  const scene::Scene& scene_;
  const Shots& shots_;
  const Output& output_;
  const FilmOptions& options_;
  media::MovieSpec spec_;
  Journal journal_;
  Ahead ahead_;
  std::int64_t first_ = 0, last_ = 0;  // takes that are wanted: [first_, last_)
  std::optional<Store> store_;
  std::optional<std::int64_t> cut_;    // the take that an interrupt cut short
  std::int64_t done_ = 0, found_ = 0;  // frames: made, and there before
  std::atomic<std::int64_t> drawn_ = 0;
  bool open_ = true;  // the pipe's other end
  SpareFrames spare_;
};

Filming::Filming(const scene::Scene& scene, const Shots& shots, const Output& output,
                 const FilmOptions& options)
    : scene_(scene), shots_(shots), output_(output), options_(options), spec_(movie_spec(scene)) {
  spec_.alpha = movie() && options.transparent;
  if (movie()) media::check(output.path, spec_);
  if (output.form == Output::Form::pipe && options.pipe == media::PipeFormat::y4m)
    media::check("pipe.y4m", spec_);
  journal_.take_frames = app::take_frames(output.form, spec_);
  journal_.takes = (shots.size() + journal_.take_frames - 1) / journal_.take_frames;
  last_ = journal_.takes;
  if (options.shard)
    std::tie(first_, last_) = Store::share(last_, options.shard->first, options.shard->second);
  journal_.shards = options.prepare.value_or(options.shard ? options.shard->second : 0);

  Origin& origin = journal_.origin;
  origin = origin_of(scene);
  origin.native = options.context.native, origin.transparent = options.transparent;
  origin.shots = shots.text(), origin.shot = shots[0];
  origin.frames = shots.size();
  if (movie()) {
    // by its name, for a part may lie in another container
    origin.encoder = spec_.codec = media::codec_name(output.path, spec_);
    origin.preset = spec_.preset, origin.crf = spec_.crf;
  }

  if (!scene.film.vary.empty() && (options.from_checkpoint || options.checkpoint_every.num > 0))
    throw UsageError("--checkpoint-every and --from-checkpoint are of one run; film.vary films several");

  // report obstacles to the files before simulating
  if (output.form == Output::Form::pipe) return;
  const std::string first = movie() ? output.path : output.file(shots[0].frame);
  if (fs::is_directory(first)) throw media::Error(first + ": is a folder");
  if (!options.overwrite) {
    if (movie()) require_fresh(output.path);
    if (movie() && !scene.film.titles.captions.empty()) require_fresh(captions_of(output.path));
    for (std::int64_t i = 0; !movie() && i < shots.size(); ++i) require_fresh(output.file(shots[i].frame));
  }
  media::make_folder_of(first);
  if (output.form == Output::Form::still || already_whole()) return;
  store_.emplace(output, journal_, first_, last_,
                 options.anew                                         ? Earlier::discard
                 : options.resume || options.shard || options.prepare ? Earlier::go_on
                                                                      : Earlier::replace);
  if (!store_->note().empty()) say(stderr, "{}\n", store_->note());
  clear_leftovers();
}

// a killed process wrote these files: we hold their lock
void Filming::clear_leftovers() const {
  std::set<std::string> names;
  if (movie() && last_ - first_ == journal_.takes) names.insert(fs::path(output_.path).filename().string());
  for (std::int64_t i = first_ * journal_.take_frames; pictures() && i < shots_.size(); ++i) {
    if (i / journal_.take_frames >= last_) break;
    names.insert(fs::path(output_.file(shots_[i].frame)).filename().string());
  }
  media::remove_leftovers(fs::path(output_.path).parent_path().string(),
                          [&](const std::string& name) { return names.contains(name); });
}

// whether a take needs not be made
bool Filming::whole(std::int64_t take) {
  if (!store_ || (!options_.resume && !options_.shard)) return false;
  if (!(movie() ? store_->part(take).has_value() : has_frames(take))) return false;
  found_ += frames_of(take), drawn_ += frames_of(take);
  return true;
}

// whether all frames of a take are there, of this film
bool Filming::has_frames(std::int64_t take) const {
  for (int i = 0; i < frames_of(take); ++i) {
    const Shot shot = shots_[take * journal_.take_frames + i];
    const std::string file = output_.file(shot.frame);
    if (!fs::exists(file)) return false;
    try {
      const auto there = origin_in(media::read_png(file).tags);
      if (!there || there->shot->frame != shot.frame) return false;
      Origin here = journal_.origin;
      here.shots = there->shots, here.gl_version = there->gl_version, here.gl_renderer = there->gl_renderer;
      if (!discord(*there, here).empty()) return false;
    } catch (const media::Error&) {
      return false;
    }
  }
  return true;
}

SimulationOptions Filming::simulating() {
  SimulationOptions how{.frames = int(journal_.take_frames), .hash_each = movie() || pictures()};
  how.first = first_, how.last = last_;
  how.skip = [this](std::int64_t take) { return whole(take); };
  const bool asked = options_.from_checkpoint.has_value();
  how.nearer = [this, asked](std::size_t number, std::int64_t since,
                             std::int64_t until) -> std::unique_ptr<sim::Run> {
    if (asked && since == 0) {
      auto run = run_from(*options_.from_checkpoint, scene_);
      if (sim::floor(run->now() * run->rate()) <= until) return run;
      throw UsageError(fmt::format("{}: is of t = {:g} s, too late for the first frame{}: --from films later",
                                   *options_.from_checkpoint, sim::value(run->now()),
                                   until < 0 ? " and its trails" : ""));
    }
    return store_ ? store_->run_between(scene_of_run(number), since, until, number) : nullptr;
  };
  if (store_) {
    // once a second of film
    const std::int64_t each = std::max<std::int64_t>(1, media::segment_frames(spec_) / journal_.take_frames);
    how.begin_take = [this, each, n = std::int64_t(0)](const std::vector<const sim::Run*>& runs) mutable {
      if (n++ % each != 0) return;
      for (std::size_t i = 0; i < runs.size(); ++i) store_->keep(scene_of_run(i), *runs[i], i);
    };
  }
  how.every = options_.checkpoint_every;
  how.at_every = [this](const sim::Run& run, sim::Rational t) {
    const fs::path file = fs::path(output_.checkpoints()) / fmt::format("{}.checkpoint", sim::value(t));
    media::make_folder_of(file.string());
    write_checkpoint(file.string(), scene_, run, true);
  };
  return how;
}

// a worker: a context of its own, and for each take a closed piece of film
std::function<Filming::DrawnSegment(FilmSegment)> Filming::hire() {
  auto darkroom = std::make_shared<FrameRenderer>(scene_, ahead_, options_.context);
  if (const auto before = store_ ? store_->drawn() : std::nullopt) {
    Origin here = journal_.origin;
    here.gl_version = darkroom->renderer().version(), here.gl_renderer = darkroom->renderer().device();
    if (const std::string why = discord(*before, here); !why.empty())
      throw media::Error(fmt::format("{}: holds parts that do not fit these: {}", store_->folder(), why));
  }
  return [this, darkroom](FilmSegment take) { return print(std::move(take), *darkroom); };
}

Filming::DrawnSegment Filming::print(FilmSegment take, FrameRenderer& darkroom) {
  DrawnSegment print;
  print.number = take.number;
  Origin origin = journal_.origin;
  origin.gl_version = darkroom.renderer().version(), origin.gl_renderer = darkroom.renderer().device();
  origin.shot = take.shots[0], origin.state = take.states[0];
  Checksums states(shots_.size(), take.all_bodies(0).bodies.size());
  std::optional<media::SegmentEncoder> encoder;
  if (movie()) encoder.emplace(output_.path, spec_);
  std::optional<media::PipeFrames> pipe_frames;
  if (output_.form == Output::Form::pipe) pipe_frames.emplace(options_.pipe, spec_);
  for (std::size_t i = 0; i < take.shots.size(); ++i) {
    if (interrupted() && i > 0) {
      print.whole = false;
      break;
    }
    const media::Image& image = darkroom.print(take, i, (pictures() || movie()) && options_.transparent);
    if (encoder) {
      encoder->add(image, darkroom.changed());
      states.add(take.number * journal_.take_frames + std::int64_t(i), take.states[i], take.all_bodies(i));
    }
    if (pipe_frames) {
      print.piped.push_back(spare_.take());
      pipe_frames->make(image, i > 0 ? darkroom.changed() : nullptr, print.piped.back());
    }
    if (pictures()) {
      Origin of_frame = origin;
      of_frame.shot = take.shots[i], of_frame.state = take.states[i], of_frame.frames = 0;
      of_frame.states = checksums(take.states[i], take.all_bodies(i));
      media::Tags tags = of_frame.tags(draw::in_letters(scene_.look.title));
      tags["Description"] = description(darkroom, take, i);
      media::write_png(output_.file(take.shots[i].frame), image,
                       {.alpha = options_.transparent, .tags = tags});
    }
    ++print.frames;
    ++drawn_;
  }
  if (encoder) {
    // an interrupt, or trouble on the way, leaves fewer frames than the take is to have
    print.whole = print.whole && print.frames == frames_of(take.number);
    origin.states = states;
    media::MovieSpec spec = spec_;
    spec.tags = origin.tags(draw::in_letters(scene_.look.title));
    const media::Segment segment = encoder->finish();
    if (print.whole)
      store_->put(take.number, output_.path, spec, segment);
    else
      media::write_part(cut_part(), spec, segment);
  }
  return print;
}

// a frame in words; of several runs each by its name
std::string Filming::description(const FrameRenderer& darkroom, const FilmSegment& take,
                                 std::size_t i) const {
  if (!ahead_.runs) return picture_text(scene_, darkroom.scene_info(), take.moments[i]);
  std::string all = scene_.look.title.empty() ? "" : telling::headline(scene_.look);
  for (std::size_t run = 0; run < ahead_.runs->size(); ++run)
    all += fmt::format("{}{}: {}", all.empty() ? "" : " ", draw::in_letters((*ahead_.runs)[run].look.name),
                       instant_text(darkroom.scene_info(run), take.run(run).moments[i]));
  return all;
}

// simulates, draws and writes what is wanted
void Filming::shoot(Simulation& simulation, Progress& progress) {
  const int cores = std::max(1, int(std::thread::hardware_concurrency()));
  const int workers =
      int(std::min<std::int64_t>(options_.workers > 0 ? options_.workers : cores, last_ - first_));
  std::optional<media::PipeWriter> pipe;
  if (output_.form == Output::Form::pipe) pipe.emplace(STDOUT_FILENO, options_.pipe, spec_);

  gl::ready(options_.context);
  Conduct<FilmSegment, DrawnSegment> parts;
  parts.produce = [&] { return simulation.next(); };
  parts.wait = [&] { progress.at(drawn_); };
  parts.hire = [&] { return hire(); };
  parts.consume = [&](DrawnSegment print) {
    for (std::vector<std::uint8_t>& frame : print.piped) {
      if (open_ && !pipe->write(frame)) open_ = false;
      spare_.give(std::move(frame));
    }
    done_ += print.frames;
    if (store_) store_->worked();
    if (movie() && !print.whole) cut_ = print.number;
    if (store_ && !options_.shard)
      for (std::size_t i = 0; i < simulation.runs(); ++i)
        store_->forget_before(simulation.step_before(shots_[print.number * journal_.take_frames].time, i), i);
    return print.whole && open_;
  };
  conduct(parts, workers);
}

// whether --resume finds the film whole: no parts are left, and the movie is this one
bool Filming::already_whole() const {
  if (!options_.resume || !movie() || options_.shard || options_.prepare) return false;
  if (fs::exists(output_.parts()) || !fs::exists(output_.path)) return false;
  try {
    const auto there = origin_in(media::read_part(output_.path).tags);
    if (!there) return false;
    Origin here = journal_.origin;
    here.gl_version = there->gl_version, here.gl_renderer = there->gl_renderer;
    return there->frames == here.frames && discord(*there, here).empty();
  } catch (const media::Error&) {
    return false;
  }
}

// nothing is drawn: the states that shards begin with
int Filming::prepare(Simulation& simulation) {
  const int n = *options_.prepare;
  Progress progress(options_.progress, store_->folder(), shots_.size(), 1 / sim::value(scene_.film.fps));
  for (std::size_t number = 0; number < simulation.runs(); ++number) {
    const scene::Scene& scene = scene_of_run(number);
    auto run = scene.shown_run();
    run->heed(interrupted);
    const auto here = [&] { return sim::floor(run->now() * run->rate()); };
    for (int i = 2; i <= n; ++i) {
      const std::int64_t first = Store::share(journal_.takes, i, n).first * journal_.take_frames;
      if (first >= shots_.size()) break;
      const std::int64_t step = simulation.step_before(shots_[first].time, number);
      if (step <= here() || store_->kept(step, number)) continue;
      if (auto nearer = store_->run_between(scene, here(), step, number)) {
        run = std::move(nearer);
        if (scene.show_divergence) run->show_divergence();
        run->heed(interrupted);
      }
      moment(*run, sim::rational(step) / run->rate(), scene);
      store_->keep(scene, *run, number);
      if (number == 0) progress.at(first);
    }
  }
  progress.finish(
      shots_.size(),
      fmt::format("{}: ready for {} shards of {} frames: --shard 1/{} and on, then obscura join {}",
                  store_->folder(), n, shots_.size(), n, output_.path),
      true);
  return kDone;
}

int Filming::run() {
  if (already_whole()) {
    say(stdout, "{}: is whole already\n", output_.path);
    return kDone;
  }
  ahead_ = app::ahead(scene_);
  Simulation simulation(scene_, shots_, ahead_, simulating());
  if (options_.prepare) return prepare(simulation);
  std::int64_t wanted = 0;
  for (std::int64_t take = first_; take < last_; ++take) wanted += frames_of(take);
  Progress progress(options_.progress, output_.path == "-" ? "standard output" : output_.path, wanted,
                    1 / sim::value(scene_.film.fps));
  try {
    shoot(simulation, progress);
  } catch (const media::Error& error) {
    // finished parts stay for another try
    if (!store_ || done_ + found_ == 0) throw;
    throw media::Error(
        fmt::format("{}; {} frames are complete: --resume continues", error.what(), done_ + found_));
  }
  return finish(progress, simulation, wanted);
}

// A sequence takes the place of an earlier one of this scene, and of the frames that this film has no more.
void Filming::clear_longer() const {
  std::int64_t end = Shots::film(scene_.duration, scene_.film.fps, scene_.film.speed).size(), gone = 0;
  for (std::int64_t i = 0; i < shots_.size(); ++i) end = std::max(end, shots_[i].frame + 1);
  for (std::int64_t n = end;; ++n, ++gone) {
    const std::string file = output_.file(n);
    std::error_code none;
    if (!fs::is_regular_file(file, none)) break;
    try {
      const auto there = origin_in(media::read_png(file).tags);
      if (!there || !there->shot || there->shot->frame != n) break;
      if (fs::path(there->scene_file).stem() != fs::path(journal_.origin.scene_file).stem()) break;
    } catch (const media::Error&) {
      break;  // someone else's
    }
    if (!fs::remove(file, none)) break;
  }
  if (gone > 0 && options_.progress != ProgressKind::json)
    say(stderr, "{}{} removed: of a longer film that lay there\n", output_.file(end),
        gone == 1 ? " is" : fmt::format(" to {} are", output_.file(end + gone - 1)));
}

// a film that ended early stands under a name that says so
int Filming::finish(Progress& progress, const Simulation& simulation, std::int64_t wanted) {
  const bool whole = !interrupted() && !simulation.trouble() && open_;
  std::string made = output_.path;
  std::int64_t frames = done_ + found_;
  if (movie() && !options_.shard) {
    Joining joining{.takes = journal_.takes};
    if (!whole) {
      // up to the first that is missing
      joining.takes = 0;
      while (joining.takes < journal_.takes && store_->part(joining.takes)) ++joining.takes;
      if (cut_ == joining.takes) joining.cut = cut_part();
      joining.instead = made = output_.partial();
    }
    frames = joining.takes > 0 || joining.cut ? join(*store_, output_.path, joining) : 0;
  }
  if (store_ && !options_.shard && (whole || simulation.trouble())) store_->remove();
  if (output_.form == Output::Form::frames && whole && !options_.shard && options_.overwrite) clear_longer();
  // words of the film that lay there before, unless they are someone else's
  if (std::error_code none; movie() && whole && !options_.shard && scene_.film.titles.captions.empty() &&
                            fs::is_regular_file(captions_of(output_.path), none))
    say(stderr, "{}: note: lies beside the film, which has no captions: it is of an earlier one\n",
        captions_of(output_.path));
  // what was there before it was gone on with is a part of it
  if (movie() && whole && options_.resume && !options_.shard) {
    std::error_code none;
    fs::remove(output_.partial(), none), fs::remove(captions_of(output_.partial()), none);
  }

  if (simulation.trouble()) {
    progress.finish(frames, "", false);
    throw TroubleError(scene_.file, *simulation.trouble(),
                       frames > 0 && output_.form != Output::Form::pipe
                           ? fmt::format("{} frame{} up to then {} in {}", frames, frames == 1 ? "" : "s",
                                         frames == 1 ? "is" : "are", made)
                           : "");
  }
  if (interrupted()) {
    progress.finish(frames,
                    frames > 0 ? fmt::format("interrupted: {} of {} frames are in {}{}", frames, wanted, made,
                                             store_ ? "; --resume continues" : "")
                               : "interrupted: nothing was written",
                    false);
    return kInterrupted;
  }
  std::string summary;
  std::error_code error;
  if (options_.shard) {
    summary = fmt::format("{}: shard {} of {} is whole, {} frames, made in {:.1f} s", store_->folder(),
                          options_.shard->first, options_.shard->second, wanted, progress.seconds());
  } else if (output_.form == Output::Form::still) {
    summary = fmt::format("{}: {}x{} at t = {:g} s", output_.file(shots_[0].frame), spec_.width, spec_.height,
                          sim::value(shots_[0].time));
  } else if (open_) {
    const double seconds = double(frames) / sim::value(scene_.film.fps);
    summary =
        fmt::format("{}: {} frame{}, {:g} s at {:g} fps, {}x{}{}, made in {:.1f} s", made, frames,
                    frames == 1 ? "" : "s", seconds, sim::value(scene_.film.fps), spec_.width, spec_.height,
                    movie() ? ", " + bytes_text(double(fs::file_size(made, error))) : "", progress.seconds());
  }
  if (!summary.empty()) progress.finish(frames, summary, output_.form != Output::Form::pipe);
  for (std::size_t i = 0; i < simulation.runs(); ++i)
    tell_limits(scene_of_run(i), limit_notes(simulation.run(i)));
  return kDone;
}

}  // namespace

media::MovieSpec movie_spec(const scene::Scene& scene) {
  media::MovieSpec spec;
  spec.width = scene.film.width, spec.height = scene.film.height;
  spec.fps_num = scene.film.fps.num, spec.fps_den = scene.film.fps.den;
  spec.codec = scene.film.codec, spec.preset = scene.film.preset, spec.crf = scene.film.crf;
  return spec;
}

int take_frames(Output::Form form, const media::MovieSpec& spec) {
  switch (form) {
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

int film(const scene::Scene& scene, const Shots& shots, const Output& output, const FilmOptions& options) {
  return Filming(scene, shots, output, options).run();
}

}  // namespace obscura::app
