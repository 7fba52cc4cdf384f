#pragma once

// What the library's own files know of the objects of its interface; not installed.

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/film/film.h"
#include "app/run/columns.h"
#include "app/run/shots.h"
#include "app/run/simulation.h"
#include "obscura/obscura.h"
#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura {

struct Scene::Inside {
  scene::Scene scene;
  std::vector<Body> bodies;
};

/// That an object is being worked on, as long as this is there. Throws UsageError where it is already: by
/// another thread, or by the step that asks, through a force.
class Work {
 public:
  Work(std::atomic<bool>& going, const char* what) : going_(going) {
    if (going_.exchange(true))
      throw UsageError(std::string(what) + " is at work, in another thread or in the force that asks");
  }
  Work(const Work&) = delete;
  ~Work() { going_ = false; }

 private:
  std::atomic<bool>& going_;
};

/// What an object of the interface holds. Throws UsageError where it was moved into another.
template <class Inside>
Inside& held(const std::unique_ptr<Inside>& inside, const char* what) {
  if (!inside) throw UsageError(std::string(what) + " was moved into another");
  return *inside;
}

struct World::Inside {
  Inside(const Scene& of, int threads);
  Work work() const { return {going, "this World"}; }

  /// The instant at which it stands.
  sim::Snapshot now() const;
  void go(std::int64_t step);
  std::vector<Pair> touching() const;
  void keep_ways();

  Scene scene;
  std::unique_ptr<sim::Run> run;
  std::vector<app::Column> columns;
  std::vector<Pair> touched;  // as contact_changes() saw them last
  double trail = 0;           // s, the longest
  app::Ways ways;
  mutable std::atomic<bool> going = false;
};

/// A value as TOML.
std::string literal(const Value& value);

/// A scene as a film's options have it, and the shots that they leave.
struct Filmed {
  scene::Scene scene;
  app::Shots shots;
  app::FilmOptions how;
};
Filmed filmed(const Scene& scene, const FilmOptions& options);
/// The same of one instant.
Filmed filmed_at(const Scene& scene, const FilmOptions& options, sim::Rational t);

/// A time (s) as exactly as it was typed. Throws UsageError for one that is not finite or below 0.
sim::Rational exact(double t, const char* what);

/// RunError of a trouble.
RunError run_error(const std::string& scene, const sim::Trouble& trouble);

/// Rethrows what the rooms throw as errors of the interface. To be called from a handler.
[[noreturn]] void rethrow();

/// act(), with errors of the interface.
template <class Act>
auto guarded(Act&& act) {
  try {
    return act();
  } catch (...) {
    rethrow();
  }
}

}  // namespace obscura
