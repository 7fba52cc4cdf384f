#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "draw/compose/depict.h"
#include "draw/page/figure.h"
#include "draw/picture/look.h"
#include "draw/picture/pace.h"
#include "scene/error.h"
#include "scene/run_marks.h"
#include "sim/math/rational.h"
#include "sim/model/state.h"
#include "sim/step/playback.h"
#include "sim/step/run.h"

namespace obscura::scene {

/// How the scene asks to be filmed. Flags of the command line override it.
struct Film {
  int width = 1920, height = 1080;
  sim::Rational fps{60, 1};
  draw::Pace speed;    // which instant each frame shows
  double shutter = 0;  // deg: of 360 how much of a frame's time is seen
  std::optional<double> crf;
  std::string preset, codec;
  std::vector<draw::Chart> charts;  // beside the picture, in step with it
  draw::Marks marks;                // over it
  draw::Titles titles;              // cards, captions, badge
  std::vector<std::string>
      vary;  // "physics.integrator=euler,rk4": the runs that are filmed together; none: one
  std::vector<std::string> vary_names;  // what they are called; none: by their values
  Complaint vary_at;                    // where `vary` stands: of what is wrong with it
  bool over = false;                    // in the plane: over each other
  bool rows = true;  // its words keep to whole pixels of its height; not where that is not known yet
};

/// The moments of a scene that are drawn and compared with references.
struct Golden {
  std::vector<sim::Rational> at;  // s, increasing
  int width = 320, height = 180;
  int level = 0;        // difference of a channel that is let pass everywhere
  int pixels = 0;       // how many may differ by more
  bool states = true;   // must be the same
  std::string run;      // the CSV of another program's run, as seen from the scene's folder; empty: simulated
  bool hashes = false;  // kept as references instead of pictures
  std::string reason;   // why anything is let pass
  bool given = false;   // the scene has a [golden]
  int line = 0;         // of it in the file; 0: not in the file
};

/// A scene, read, checked and built: its world, its look and its film.
struct Scene {
  // each compiled once, in scene.cpp
  Scene();
  Scene(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(const Scene&);
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  std::string file;               // as given
  std::string name;               // the file's stem
  std::string text;               // the file's bytes, for its hash and the origin
  std::vector<std::string> sets;  // the --set overrides, as given
  sim::Rational duration{10, 1};  // s
  std::uint64_t seed = 0;
  std::variant<sim::World<2>, sim::World<3>> world;
  std::vector<Eigen::Quaterniond> axes;  // one a body: its own axes, seen from those in which it was typed
  draw::Look look;
  std::vector<draw::Camera> cameras;  // one; in space as many as there are
  draw::Extent extent;                // what the camera fits
  Film film;
  draw::Figure figure;
  Golden golden;
  std::shared_ptr<const sim::Trajectory> trajectory;  // another program's run, shown instead of the scene's
  std::string trajectory_file;                        // its name
  bool show_divergence = false;                       // physics.diverge
  int observer = -1;                                  // the body that sees it; -1: the room
  std::vector<std::string> marks;                     // of its run that film and figure name
  bool marked = false;                                // their times, and that of a stop, are in place
  std::vector<std::pair<std::string, sim::Rational>>
      passed;                 // marks that its run comes to, s, where it is known
  bool figure_waits = false;  // its figure is of a mark that the run does not come to

  int dimension() const { return world.index() == 0 ? 2 : 3; }
  /// A run of it from its start, or from a state that was saved of one; null if that is no state of this
  /// scene. The troubles that are known beforehand: springs too stiff for the step, joints that are straight.
  /// See sim/step/run.h.
  std::unique_ptr<sim::Run> run(std::span<const std::uint64_t> saved = {}) const;
  /// The same for a picture: where the scene says so, it goes on when it diverges.
  std::unique_ptr<sim::Run> shown_run(std::span<const std::uint64_t> saved = {}) const;
  std::vector<sim::Trouble> stability_warnings() const;

  /// From now on, the steps of its runs are shared by so many threads, as far as there is enough to share; 0:
  /// one a core. No bit hangs on it.
  void share_steps(int threads);

  /// The same scene read again from its text with other overrides; forces of programs stay. Throws Error.
  Scene again(const std::vector<std::string>& sets, const RunMarks* marks = nullptr) const;
  /// Adds a force that a program computes. Requires D = dimension().
  template <int D>
  void add_force(const std::string& name, sim::ForceFunction<D> function);
  /// The names of those.
  std::vector<std::string> programs() const;

  /// The world of a scene in the plane, of one in space.
  const sim::World<2>& plane() const { return std::get<sim::World<2>>(world); }
  const sim::World<3>& space() const { return std::get<sim::World<3>>(world); }
};

/// Reads, validates and builds the scene in `file` ("-": standard input), with `sets`
/// ("crate.elasticity=0.5") over its keys. Throws scene::Error with everything that is wrong, each with its
/// place.
Scene read(const std::string& file, const std::vector<std::string>& sets = {});

/// The same from text; `file` names it in complaints. With `marks`, what its run says: film and figure have
/// their times in the place of names.
Scene parse(const std::string& text, const std::string& file, const std::vector<std::string>& sets = {},
            const RunMarks* marks = nullptr);

}  // namespace obscura::scene
