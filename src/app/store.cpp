#include "app/store.h"

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
#include <nlohmann/json.hpp>

#include "app/checkpoint.h"
#include "app/frames.h"
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

Journal journal_in(const std::string& path) {
  const auto refuse = [&](const char* why) { return media::Error(path + ": " + why); };
  try {
    const auto json = nlohmann::json::parse(file_bytes(path));
    if (json.at("format") != kFormat) throw refuse("is of another version of obscura");
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
constexpr const char* kStep = "step-";
constexpr const char* kCheckpoint = ".checkpoint";

std::string named(std::int64_t take, const std::string& hash, const std::string& ending) {
  return fmt::format("{}{:06}-{}{}", kTake, take, hash.substr(0, 16), ending);
}

}  // namespace

struct Store::Impl {
  std::string folder;
  Journal journal;
  int lock = -1;
  std::mutex mutex;                                        // of parts
  std::map<std::int64_t, std::string> parts, checkpoints;  // names, by take and by step

  ~Impl() {
    if (lock >= 0) ::close(lock);
  }
  std::string at(const std::string& name) const { return (fs::path(folder) / name).string(); }

  // waits for nobody
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

  // what is there
  void look() {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      if (const auto take = number_in(name, kTake)) parts[*take] = name;
      if (const auto step = number_in(name, kStep); step && name.ends_with(kCheckpoint))
        checkpoints[*step] = name;
    }
  }

  // all but the lock
  void clear() {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      std::error_code ignored;
      if (entry.path().filename() != "lock") fs::remove(entry.path(), ignored);
    }
    parts.clear(), checkpoints.clear();
  }
};

Store::~Store() = default;
Store::Store(Store&&) noexcept = default;

Store::Store(const Output& output, const Journal& journal, std::int64_t first, std::int64_t last, bool keep)
    : impl_(std::make_unique<Impl>()) {
  Impl& it = *impl_;
  it.folder = output.parts(), it.journal = journal;
  const std::string path = it.at("journal.json");
  media::make_folder_of(path);
  it.take_lock(first, last);
  if (keep && fs::exists(path)) {
    const Journal there = journal_in(path);
    // what draws is not known yet: each part tells
    Origin ours = journal.origin;
    ours.gl_version = there.origin.gl_version, ours.gl_renderer = there.origin.gl_renderer;
    if (const std::string why = discord(there.origin, ours); !why.empty())
      throw media::Error(
          fmt::format("{}: holds parts of another film: {}; remove it to begin anew", it.folder, why));
    it.journal.shards = std::max(journal.shards, there.shards);
    it.look();
    if (it.journal.shards == there.shards) return;
  } else {
    it.clear();
  }
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
  const std::string ending = "." + media::part_ending(movie);
  const std::string fresh = impl_->at(fmt::format("fresh-{:06}{}", take, ending));
  media::write_part(fresh, spec, segment);
  const std::string name = named(take, file_hash(fresh), ending), whole = impl_->at(name);
  if (std::rename(fresh.c_str(), whole.c_str()) != 0)
    throw media::Error(whole + ": cannot rename into place: " + std::generic_category().message(errno));
  const std::lock_guard guard(impl_->mutex);
  impl_->parts[take] = name;
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

bool Store::kept(std::int64_t step) const { return impl_->checkpoints.contains(step); }

void Store::keep(const scene::Scene& scene, const sim::Run& run) {
  const std::int64_t step = sim::floor(run.now() * run.rate());
  if (step == 0 || kept(step)) return;
  const std::string name = fmt::format("{}{:012}{}", kStep, step, kCheckpoint);
  // one that a power cut damages is known by its hash, and one before it is as good
  write_checkpoint(impl_->at(name), scene, run, false);
  impl_->checkpoints[step] = name;
}

void Store::forget_before(std::int64_t step) {
  auto& all = impl_->checkpoints;
  while (all.size() > 1 && std::next(all.begin())->first <= step) {
    std::error_code ignored;
    fs::remove(impl_->at(all.begin()->second), ignored);
    all.erase(all.begin());
  }
}

std::unique_ptr<sim::Run> Store::run_between(const scene::Scene& scene, std::int64_t since,
                                             std::int64_t until) const {
  const auto& all = impl_->checkpoints;
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
  impl_->clear();
  std::error_code ignored;
  fs::remove(impl_->at("lock"), ignored);
  fs::remove(impl_->folder, ignored);
}

}  // namespace obscura::app
