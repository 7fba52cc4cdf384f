// obscura join: a film that was made in shares, or was stopped, from the parts that are whole.

#include "app/film/join.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/say.h"
#include "app/console/scripts.h"
#include "app/film/film.h"
#include "app/film/output.h"
#include "app/film/subtitles.h"
#include "app/run/run_marks.h"
#include "media/error.h"
#include "media/file.h"
#include "media/part.h"

namespace obscura::app {

namespace {

constexpr std::size_t kMostOfMov = 60'000;  // bytes of an origin, with what stands around it

Origin origin_of_part(const std::string& path, const media::Tags& tags) {
  auto origin = origin_in(tags);
  if (!origin) throw media::Error(path + ": does not say which film it belongs to");
  return std::move(*origin);
}

// the origin common to all parts, because a movie's origin precedes its frames; none if a part has none
std::optional<Checksums> states_of(const std::vector<std::string>& parts) {
  std::optional<Checksums> all;
  for (const std::string& path : parts) {
    const Origin origin = origin_of_part(path, media::part_tags(path));
    if (!origin.states) return {};
    if (all)
      all->append(*origin.states);
    else
      all = origin.states;
  }
  if (all) all->close();
  return all;
}

}  // namespace

std::int64_t join(Store& store, const std::string& movie, const Joining& joining) {
  std::vector<std::string> parts;
  bool gaps = false;  // behind one that is missing frames have other numbers
  for (std::int64_t take = 0; take < joining.takes; ++take) {
    if (const auto path = store.part(take))
      parts.push_back(*path), gaps = gaps || std::int64_t(parts.size()) != take + 1;
  }
  if (joining.cut) parts.push_back(*joining.cut);

  std::optional<media::MovieWriter> writer;
  std::optional<scene::Scene> scene;
  std::optional<Shots> shots;
  Subtitles said;
  std::optional<Origin> first;
  media::MovieSpec spec;
  const auto add = [&](const std::string& path) {
    const media::Part part = media::read_part(path);
    const Origin origin = origin_of_part(path, part.tags);
    if (!first) {
      first = origin;
      first->states = gaps ? std::nullopt : states_of(parts);
      const sim::Rational fps = sim::parse_rational(origin.fps).value_or(sim::Rational{60, 1});
      spec.width = origin.width, spec.height = origin.height;
      spec.fps_num = fps.num, spec.fps_den = fps.den;
      spec.codec = origin.encoder, spec.preset = origin.preset, spec.crf = origin.crf;
      spec.alpha = origin.transparent;
      const auto title = part.tags.find("Title");
      const auto tags = [&] { return first->tags(title == part.tags.end() ? "" : title->second); };
      spec.tags = tags();
      // QuickTime leaves out what is too long: rather the checksums than all of the origin
      if (std::filesystem::path(movie).extension() == ".mov" && spec.tags.at("obscura").size() > kMostOfMov)
        first->states.reset(), spec.tags = tags();
      // behind a gap captions would come too early
      try {
        if (!gaps) scene = scene_of(*first), shots = shots_of(*first, *scene);
      } catch (const scene::Error&) {
        // parts of another version: joined without
      }
      if (scene)
        said = subtitles(*scene, *shots, first->frames,
                         joining.instead ? decltype(scene->passed){} : passed_marks(*scene));
      spec.captions = said.captions;
      if (!joining.instead) spec.chapters = said.chapters;
      writer.emplace(movie, spec);
    }
    if (const std::string why = discord(*first, origin); !why.empty())
      throw media::Error(fmt::format("{}: does not fit the parts before it: {}", path, why));
    writer->add(part.segment);
  };
  for (const std::string& path : parts) add(path);
  if (!writer) throw media::Error(store.folder() + ": no part is whole yet");
  const std::int64_t frames = writer->frames();
  writer->close(joining.instead);
  if (said.captions.empty()) return frames;
  // beside the movie, for players that take them so
  const std::string text = webvtt(subtitles(*scene, *shots, frames).captions);
  media::File file(captions_of(joining.instead.value_or(movie)));
  file.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  file.place(true);
  return frames;
}

namespace {

// the missing frames, in words: "frames 120 to 179 (shard 2 of 4)"
std::string missing(const Journal& journal, const std::vector<std::int64_t>& takes) {
  std::string text;
  int told = 0;
  for (std::size_t i = 0; i < takes.size();) {
    std::size_t end = i + 1;
    while (end < takes.size() && takes[end] == takes[end - 1] + 1) ++end;
    if (++told > 5) return text + " and more";
    const std::int64_t first = takes[i] * journal.take_frames;
    const std::int64_t last = std::min((takes[end - 1] + 1) * journal.take_frames, journal.origin.frames) - 1;
    text += fmt::format("{}frames {} to {}", text.empty() ? "" : ", ", first, last);
    std::string shards;
    for (int k = 1; k <= journal.shards; ++k) {
      const auto [from, to] = Store::share(journal.takes, k, journal.shards);
      if (from <= takes[end - 1] && takes[i] < to)
        shards += (shards.empty() ? fmt::format(" (of {} shards: ", journal.shards) : std::string(", ")) +
                  fmt::format("{}", k);
    }
    if (!shards.empty()) text += shards + ")";
    i = end;
  }
  return text;
}

// the shards that make these takes
std::vector<int> shards_of(const Journal& journal, const std::vector<std::int64_t>& takes) {
  std::vector<int> shards;
  for (int k = 1; k <= journal.shards; ++k) {
    const auto [from, to] = Store::share(journal.takes, k, journal.shards);
    const auto first = std::lower_bound(takes.begin(), takes.end(), from);
    if (first != takes.end() && *first < to) shards.push_back(k);
  }
  return shards;
}

struct JoinFlags {
  std::string out;
  bool partial = false, missing = false;
};

int join_command(const JoinFlags& flags) {
  const Output out = output(flags.out, "", false, 2);
  if (out.form != Output::Form::movie && out.form != Output::Form::frames)
    throw UsageError(fmt::format("{}: join takes a movie or a sequence of pictures", flags.out));
  Store store(out);
  const Journal& journal = store.journal();
  const bool pictures = out.form == Output::Form::frames;
  std::optional<scene::Scene> scene;
  std::optional<Shots> shots;
  if (pictures) scene = scene_of(journal.origin), shots = shots_of(journal.origin, *scene);
  std::vector<std::int64_t> absent;
  for (std::int64_t take = 0; take < journal.takes; ++take) {
    if (pictures) {
      const std::int64_t end = std::min((take + 1) * journal.take_frames, journal.origin.frames);
      for (std::int64_t i = take * journal.take_frames; i < end; ++i) {
        if (std::filesystem::exists(out.file((*shots)[i].frame))) continue;
        absent.push_back(take);
        break;
      }
    } else if (!store.part(take)) {
      absent.push_back(take);
    }
  }
  if (flags.missing) {
    if (journal.shards == 0)
      throw media::Error(
          fmt::format("{}: is not made in shards; render --resume makes what is missing", flags.out));
    const std::vector<int> shards = shards_of(journal, absent);
    if (!shards.empty()) say(stdout, "{}\n", ranges(shards));
    return kDone;
  }
  if (!absent.empty() && !flags.partial)
    throw media::Error(fmt::format("{}: missing: {}", flags.out, missing(journal, absent)));
  if (pictures) {
    say(stdout, "{}: all {} frames are there\n", flags.out, journal.origin.frames);
    store.remove();
    return kDone;
  }
  Joining joining{.takes = journal.takes};
  if (!absent.empty()) joining.instead = out.partial();
  const std::int64_t frames = join(store, out.path, joining);
  say(stdout, "{}: {} of {} frames\n", joining.instead.value_or(out.path), frames, journal.origin.frames);
  if (absent.empty()) store.remove();
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(20, join) {
  const Command command(program, exit, "join", "Join the parts of all shards into the movie");
  auto flags = std::make_shared<JoinFlags>();
  command.option("OUT", flags->out, "The movie, as `render -o` named it, or the pattern of its pictures")
      .required()
      .type("");
  command.flag("--partial", flags->partial,
               "Join the finished parts into a movie whose name says that it is partial");
  command.flag("--missing", flags->missing,
               "Join nothing: print the missing shards, in the form of sbatch's --array");
  command.footer(
      "If parts are missing, join says which shards make them, and exits with 4.\n\n"
      "Examples:\n"
      "  for i in 1 2 3 4; do obscura render scenes/room.toml -o room.mp4 --shard $i/4; done\n"
      "  obscura join room.mp4\n"
      "  sbatch --array=$(obscura join room.mp4 --missing) room.mp4.slurm/shards.sbatch");
  command.run([flags] { return join_command(*flags); });
}

}  // namespace obscura::app
