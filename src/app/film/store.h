#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/film/output.h"
#include "app/run/origin.h"
#include "media/movie.h"
#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::app {

/// The properties of a film in the making that stay the same from the first part to the last.
struct Journal {
  Origin origin;                 // but for what one frame alone has, and OpenGL
  std::int64_t takes = 0;        // closed pieces it is made in, numbered from 0
  std::int64_t take_frames = 1;  // of each but the last
  int shards = 0;                // how many were prepared for; 0: none
};

/// How to treat the parts that an earlier process left of an unfinished film.
enum class Earlier {
  go_on,    // it is gone on with
  replace,  // it is thrown away where not much is lost, else that is refused
  discard,  // it is thrown away
};

/// The folder of a film in the making, and what of it is whole: a journal, each take that is done as a part
/// (media/part.h), checkpoints to go on from. All of it is written whole or not at all, a part's name holds
/// the hash of its bytes, and no other process makes the same takes at the same time: they are locked, on
/// shared file systems too.
class Store {
 public:
  /// Makes or opens the folder for the takes [first, last). Throws media::Error if another process makes
  /// these takes already; if `go_on` finds parts of another film; if `replace` would lose shards, prepared
  /// states, or more than a minute of work, except those of one process alone at a scene that was edited
  /// since.
  Store(const Output& output, const Journal& journal, std::int64_t first, std::int64_t last, Earlier earlier);
  /// Opens the folder of a film to take all of it. Throws media::Error where there is none.
  explicit Store(const Output& output);
  ~Store();
  Store(Store&&) noexcept;

  /// A message about the earlier parts: that they were replaced, or repaired. Empty: none.
  const std::string& note() const;
  const std::string& folder() const;
  const Journal& journal() const;
  /// The takes of shard i of n, counted from 1: [first, last).
  static std::pair<std::int64_t, std::int64_t> share(std::int64_t takes, int i, int n);

  /// The file of a take, where it is whole. A damaged one is thrown away.
  std::optional<std::string> part(std::int64_t take);
  /// Adds a take; from any thread. Throws media::Error.
  void put(std::int64_t take, const std::string& movie, const media::MovieSpec& spec,
           const media::Segment& segment);
  /// The origin of any take that is there: it tells which OpenGL drew it.
  std::optional<Origin> drawn() const;

  /// Keeps the state at which a run stands, for run_between; not its start, which the scene is enough for.
  /// Of a film of several runs each has its own.
  void keep(const scene::Scene& scene, const sim::Run& run, std::size_t number = 0);
  bool kept(std::int64_t step, std::size_t number = 0) const;
  /// Removes checkpoints that are not needed to go on at this step or later.
  void forget_before(std::int64_t step, std::size_t number = 0);
  /// A run that goes on from the latest checkpoint of the steps (since, until]; none where there is none that
  /// is whole and of this scene.
  std::unique_ptr<sim::Run> run_between(const scene::Scene& scene, std::int64_t since, std::int64_t until,
                                        std::size_t number = 0) const;

  /// Some of the work is done: puts down how long it took so far.
  void worked();
  /// Removes the folder: the film is whole.
  void remove();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace obscura::app
