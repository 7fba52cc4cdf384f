#include "app/film/store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/film/estimate.h"
#include "app/film/spent.h"
#include "app/run/checkpoint.h"
#include "app/run/frames.h"
#include "media/error.h"
#include "media/file.h"
#include "media/part.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 1;
constexpr std::int64_t kMostInATake = 1'000'000, kMostShards = 1'000'000;  // beyond what any journal says

std::string text(const Journal& journal) {
  nlohmann::ordered_json json;
  json["format"] = kFormat;
  json["takes"] = journal.takes, json["take_frames"] = journal.take_frames;
  if (journal.shards > 0) json["shards"] = journal.shards;
  json["origin"] = nlohmann::ordered_json::parse(journal.origin.tags("").at("obscura"));
  return json.dump(1) + "\n";
}

// for a record that cannot be read
struct Damaged : media::Error {
  using media::Error::Error;
};

Journal journal_in(const std::string& path) {
  const auto refuse = [&](const char* why) {
    return Damaged(fmt::format(
        "{}: {}; the same render with --resume rewrites it and keeps the complete parts", path, why));
  };
  try {
    const auto json = nlohmann::json::parse(file_bytes(path));
    if (json.at("format") != kFormat)
      throw media::Error(path +
                         ": is of another version of obscura; render --anew begins anew with this one");
    const auto origin = origin_in({{"obscura", json.at("origin").dump()}});
    if (!origin) throw refuse("is damaged: it does not say which film this is");
    const auto takes = whole(json.at("takes"), 1, origin->frames),
               frames = whole(json.at("take_frames"), 1, kMostInATake),
               shards = json.contains("shards") ? whole(json["shards"], 1, kMostShards) : 0;
    if (!takes || !frames || !shards || *takes != (origin->frames + *frames - 1) / *frames)
      throw refuse("is damaged: it does not say in which pieces the film is made");
    return {*origin, *takes, *frames, int(*shards)};
  } catch (const nlohmann::json::exception&) {
    throw refuse("is damaged");
  }
}

// the number that a name begins with, after `prefix`
std::optional<std::int64_t> number_in(const std::string& name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return {};
  std::int64_t n = 0;
  const char* begin = name.data() + prefix.size();
  const auto [end, error] = std::from_chars(begin, name.data() + name.size(), n);
  if (error != std::errc() || end == begin) return {};
  return n;
}

constexpr const char* kTake = "take-";
constexpr const char* kFresh = "fresh-";  // a take before its hash is known
constexpr const char* kStep = "step-";
constexpr const char* kCheckpoint = ".checkpoint";
constexpr const char* kRun = "-run-";  // of a film of several runs: which, from the second on

std::string checkpoint_name(std::int64_t step, std::size_t run) {
  return fmt::format("{}{:012}{}{}", kStep, step, run > 0 ? fmt::format("{}{}", kRun, run) : "", kCheckpoint);
}

std::size_t run_in(const std::string& name) {
  const auto at = name.find(kRun);
  return at == name.npos ? 0 : std::size_t(number_in(name.substr(at), kRun).value_or(0));
}

std::string named(std::int64_t take, const std::string& hash, const std::string& ending) {
  return fmt::format("{}{:06}-{}{}", kTake, take, hash.substr(0, 16), ending);
}

}  // namespace

struct Store::Impl {
  std::string folder;
  Journal journal;
  int lock = -1;
  std::mutex mutex;                                                        // of parts, and of spent
  std::map<std::int64_t, std::string> parts;                               // names, by take
  std::map<std::size_t, std::map<std::int64_t, std::string>> checkpoints;  // by run and by step
  std::optional<Spent> spent;
  std::string note;

  ~Impl() {
    if (lock >= 0) ::close(lock);
  }
  std::string at(const std::string& name) const { return (fs::path(folder) / name).string(); }

  // does not wait for the lock
  void take_lock(std::int64_t first, std::int64_t last) {
    const std::string path = at("lock");
    do lock = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    while (lock < 0 && errno == EINTR);
    if (lock < 0) throw media::Error(path + ": cannot write: " + std::generic_category().message(errno));
    struct flock range {};
    range.l_type = F_WRLCK, range.l_whence = SEEK_SET;
    range.l_start = first, range.l_len = last - first;
    if (::fcntl(lock, F_OFD_SETLK, &range) == 0) return;
    // a file system without locks is no reason not to make a film
    if (errno == EAGAIN || errno == EACCES)
      throw media::Error(folder + ": another obscura is making this film");
  }

  // the parts on disk
  void look() {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      if (const auto take = number_in(name, kTake)) parts[*take] = name;
      if (const auto step = number_in(name, kStep); step && name.ends_with(kCheckpoint))
        checkpoints[run_in(name)][*step] = name;
    }
  }

  // all that is ours but the lock
  void clear() {
    const auto ours = [](const std::string& name) {
      return name == "journal.json" || name == "seconds" || name.starts_with(kTake) ||
             name.starts_with(kFresh) || name.starts_with(kStep) || name.starts_with("cut.");
    };
    media::remove_leftovers(folder, ours);
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      std::error_code ignored;
      if (ours(entry.path().filename().string())) fs::remove(entry.path(), ignored);
    }
    parts.clear(), checkpoints.clear();
  }

  // why a film is not this one; which OpenGL draws is not known yet: each part tells
  std::string discord_with(const Origin& there) const {
    Origin ours = journal.origin;
    ours.gl_version = there.gl_version, ours.gl_renderer = there.gl_renderer;
    return discord(there, ours);
  }
  [[noreturn]] void refuse_other(const std::string& why) const {
    throw media::Error(fmt::format("{}: holds parts of another film: {}; --anew discards them", folder, why));
  }

  // the parts say themselves which film they are of
  void refuse_other_parts() const {
    for (const auto& [take, name] : parts) {
      std::optional<Origin> there;
      try {
        there = origin_in(media::read_part(at(name)).tags);
      } catch (const media::Error&) {
        continue;  // a damaged one is thrown away later
      }
      if (!there) continue;
      if (const std::string why = discord_with(*there); !why.empty()) refuse_other(why);
    }
  }

  // "20 of 100 frames, work of 4 shards, 12 s of work"
  std::string held(const Journal& there) const {
    std::vector<std::string> all;
    std::int64_t frames = 0;
    for (const auto& [take, name] : parts)
      frames +=
          std::clamp<std::int64_t>(there.origin.frames - take * there.take_frames, 0, there.take_frames);
    if (frames > 0) all.push_back(fmt::format("{} of {} frames", frames, there.origin.frames));
    if (there.shards > 0)
      all.push_back(fmt::format("{} {} shards", frames > 0 ? "work of" : "the states of", there.shards));
    if (const auto seconds = spent->before(); seconds && *seconds >= 1)
      all.push_back(time_text(*seconds) + " of work");
    return all.empty() ? "the beginning" : fmt::format("{}", fmt::join(all, ", "));
  }

  // throws away what an earlier process left, where that may be
  void replace(const std::optional<Journal>& there) {
    const bool any = !parts.empty() || !checkpoints.empty() || (there && there->shards > 0) ||
                     spent->before().value_or(0) > kWorthKeeping;
    if (!any) return clear();
    if (!there)
      throw media::Error(
          fmt::format("{}: holds parts, and its journal.json cannot be read: --resume continues with those "
                      "of this film, --anew discards them",
                      folder));
    const std::string why = discord_with(there->origin);
    const bool much = spent->before().value_or(2 * kWorthKeeping) > kWorthKeeping;
    const bool edited =
        there->origin.scene_file == journal.origin.scene_file &&
        (there->origin.scene_hash != journal.origin.scene_hash || there->origin.sets != journal.origin.sets);
    if (there->shards > 0 || (much && !edited))
      throw media::Error(
          why.empty()
              ? fmt::format("{}: holds {}: --resume continues from there, --anew discards it", folder,
                            held(*there))
              : fmt::format(
                    "{}: holds {} of another film: {}; --anew discards it, --resume continues from there "
                    "with the scene and flags that it was begun with",
                    folder, held(*there), why));
    if (!why.empty()) note = fmt::format("{}: replaces {} of an earlier film: {}", folder, held(*there), why);
    clear();
  }

  // goes on with what an earlier process left
  void go_on(std::optional<Journal>& there, bool damaged) {
    if (there) {
      if (const std::string why = discord_with(there->origin); !why.empty()) refuse_other(why);
    }
    if (there && there->take_frames == journal.take_frames) {
      journal.shards = std::max(journal.shards, there->shards);
      return;
    }
    refuse_other_parts();
    if (damaged) note = fmt::format("{}: was damaged, and is written anew", at("journal.json"));
    // prepared states do not say which film they belong to
    std::error_code ignored;
    for (const auto& [run, all] : checkpoints)
      for (const auto& [step, name] : all) fs::remove(at(name), ignored);
    checkpoints.clear(), there.reset();
  }
};

Store::~Store() = default;
Store::Store(Store&&) noexcept = default;

Store::Store(const Output& output, const Journal& journal, std::int64_t first, std::int64_t last,
             Earlier earlier)
    : impl_(std::make_unique<Impl>()) {
  Impl& it = *impl_;
  it.folder = output.parts(), it.journal = journal;
  const std::string path = it.at("journal.json");
  media::make_folder_of(path);
  it.take_lock(first, last);
  it.look();
  it.spent.emplace(it.at("seconds"));
  std::optional<Journal> there;
  bool damaged = false;
  try {
    if (earlier != Earlier::discard && fs::exists(path)) there = journal_in(path);
  } catch (const Damaged&) {
    damaged = true;
  }
  if (earlier == Earlier::go_on)
    it.go_on(there, damaged);
  else if (earlier == Earlier::replace)
    it.replace(there);
  else
    it.clear();
  it.spent->begin(earlier == Earlier::go_on ? it.spent->before().value_or(0) : 0);
  if (earlier == Earlier::go_on && there && there->shards == it.journal.shards) return;
  const std::string words = text(it.journal);
  media::File file(path);
  file.write({reinterpret_cast<const std::uint8_t*>(words.data()), words.size()});
  file.place(true);
}

Store::Store(const Output& output) : impl_(std::make_unique<Impl>()) {
  Impl& it = *impl_;
  it.folder = output.parts();
  const std::string path = it.at("journal.json");
  if (!fs::exists(path))
    throw media::Error(fmt::format("{}: has no parts of a film: there is no {}", output.path, path));
  it.journal = journal_in(path);
  it.take_lock(0, it.journal.takes);
  it.look();
}

const std::string& Store::note() const { return impl_->note; }
const std::string& Store::folder() const { return impl_->folder; }
const Journal& Store::journal() const { return impl_->journal; }

std::pair<std::int64_t, std::int64_t> Store::share(std::int64_t takes, int i, int n) {
  return {takes * (i - 1) / n, takes * i / n};
}

std::optional<std::string> Store::part(std::int64_t take) {
  const std::lock_guard guard(impl_->mutex);
  const auto found = impl_->parts.find(take);
  if (found == impl_->parts.end()) return {};
  const std::string path = impl_->at(found->second);
  std::error_code error;
  if (fs::is_regular_file(path, error) &&
      found->second == named(take, file_hash(path), fs::path(path).extension().string()))
    return path;
  fs::remove(path, error);
  impl_->parts.erase(found);
  return {};
}

void Store::put(std::int64_t take, const std::string& movie, const media::MovieSpec& spec,
                const media::Segment& segment) {
  const std::string ending = "." + media::part_ending(movie, spec);
  const std::string fresh = impl_->at(fmt::format("{}{:06}{}", kFresh, take, ending));
  media::write_part(fresh, spec, segment);
  const std::string name = named(take, file_hash(fresh), ending), whole = impl_->at(name);
  if (std::rename(fresh.c_str(), whole.c_str()) != 0)
    throw media::Error(whole + ": cannot rename into place: " + std::generic_category().message(errno));
  const std::lock_guard guard(impl_->mutex);
  impl_->parts[take] = name;
  if (impl_->spent) impl_->spent->note();
}

void Store::worked() {
  const std::lock_guard guard(impl_->mutex);
  if (impl_->spent) impl_->spent->note();
}

std::optional<Origin> Store::drawn() const {
  // workers ask while others put
  const auto parts = [this] {
    const std::lock_guard guard(impl_->mutex);
    return impl_->parts;
  }();
  for (const auto& [take, name] : parts) {
    try {
      return origin_in(media::read_part(impl_->at(name)).tags);
    } catch (const media::Error&) {
    }
  }
  return {};
}

bool Store::kept(std::int64_t step, std::size_t number) const {
  const auto its = impl_->checkpoints.find(number);
  return its != impl_->checkpoints.end() && its->second.contains(step);
}

void Store::keep(const scene::Scene& scene, const sim::Run& run, std::size_t number) {
  const std::int64_t step = sim::floor(run.now() * run.rate());
  if (step == 0 || kept(step, number)) return;
  const std::string name = checkpoint_name(step, number);
  // one that a power cut damages is known by its hash, and one before it is as good
  write_checkpoint(impl_->at(name), scene, run, false);
  impl_->checkpoints[number][step] = name;
}

void Store::forget_before(std::int64_t step, std::size_t number) {
  auto& all = impl_->checkpoints[number];
  while (all.size() > 1 && std::next(all.begin())->first <= step) {
    std::error_code ignored;
    fs::remove(impl_->at(all.begin()->second), ignored);
    all.erase(all.begin());
  }
}

std::unique_ptr<sim::Run> Store::run_between(const scene::Scene& scene, std::int64_t since,
                                             std::int64_t until, std::size_t number) const {
  const auto its = impl_->checkpoints.find(number);
  if (its == impl_->checkpoints.end()) return {};
  const auto& all = its->second;
  for (auto it = all.upper_bound(until); it != all.begin() && std::prev(it)->first > since; --it) {
    try {
      return run_from(impl_->at(std::prev(it)->second), scene);
    } catch (const media::Error&) {
      // damaged: an earlier one, or the start, is as good
    }
  }
  return {};
}

void Store::remove() {
  if (impl_->spent) impl_->spent->remove();
  impl_->clear();
  std::error_code ignored;
  fs::remove(impl_->at("lock"), ignored);
  fs::remove(impl_->folder, ignored);
}

}  // namespace obscura::app
