#pragma once

#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "draw/page/chart.h"
#include "draw/page/titles.h"
#include "draw/picture/lens.h"
#include "draw/picture/list.h"
#include "draw/picture/look.h"
#include "draw/picture/view.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

class Annotations;
class Projection;
struct SpaceStage;
struct Sheet;
struct WorldLine;
struct SpaceGhost;
struct ComparedRun;
struct RunsOver;

/// How strong the earlier instant of a mark is.
inline constexpr double kGhost = 0.4;

/// A frame of a film: its instant, when it is shown (s of the film), and how fast the run goes by then.
struct FrameInstant {
  const sim::Snapshot& now;
  double film = 0;
  double speed = 1;
  Fate fate = Fate::well;
  const RunsOver* over = nullptr;  // in the plane: several runs over each other
};

/// Draws instants of one run. Holds what does not change: the look's colours, the room's walls as polygons,
/// the still list.
class Illustrator {
 public:
  /// `extent` is what the camera fits; `aspect` the picture's width over its height.
  Illustrator(const sim::SceneInfo& cast, const Look& look, const Camera& camera, const Extent& extent,
              double aspect);

  /// In space: several cameras look at one run, in panels beside each other with their names over them.
  /// Charts of the run stand beside its picture.
  Illustrator(const sim::SceneInfo& cast, const Look& look, const std::vector<Camera>& cameras,
              const Extent& extent, double aspect, const Charts& charts = {});

  /// In the plane, for print: a picture of `sheet`, whose size follows from what it shows
  /// (draw/page/sheet.h).
  Illustrator(const sim::SceneInfo& cast, const Look& look, const Extent& extent, const Sheet& sheet);

  /// In the plane: the view from the world to the page at time t (s).
  View view(double t) const;

  /// What pictures in space have in common; null in the plane.
  const SpaceStage* space() const { return space_.get(); }

  /// In space: how it lies in a panel.
  CameraProjection lens(const sim::Snapshot& now, int panel = 0) const;

  /// The picture of one instant. `ways`: the tracks that hold the last `trail` seconds before it, oldest
  /// first.
  Picture depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways) const;

  /// The same, with the clock, the charts, the marks and the titles of the frame that `now` is a moment of.
  Picture depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways,
                 const FrameInstant& frame) const;

  /// The picture of one instant with lines through the world; in space with earlier instants as well.
  Picture depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways,
                 std::span<const WorldLine> lines, std::span<const SpaceGhost> ghosts = {}) const;

  /// In the plane: the bodies of a run alone, with their trails and springs.
  void draw_bodies(const View& view, const sim::Snapshot& now,
                   std::span<const std::shared_ptr<const sim::Track>> ways, List& list) const;

  /// From now on every picture has these marks and titles.
  void annotate(std::shared_ptr<const Annotations> annotations) { annotations_ = std::move(annotations); }
  void entitle(const Titles& titles) { titles_ = titles; }

  /// What marks need to know: the run's cast, the theme's colours, the weight of lines, how many panels there
  /// are and how the world lies in one of them, and page units a metre.
  const sim::SceneInfo& scene_info() const;
  const Palette& colours() const;
  double weight() const;
  const Look& look() const { return look_; }
  /// The colour of a body's lines.
  Color line_color(int body) const;
  /// What a body is called, as mathematics: its words, or its name.
  std::string called(int body) const;
  int panels() const;
  Projection projection(int panel, const sim::Snapshot& now) const;
  double scale(const sim::Snapshot& now) const;

  /// How far anything that is seen moves on the page in the next `seconds` if it goes straight on, page
  /// units.
  double travel(const sim::Snapshot& now, double seconds) const;

  /// In the plane: the bodies alone as they were at another instant, `strength` (0 to 1) of the way from the
  /// ground to their own colours; `only` these, where there are any.
  void ghosts(const sim::Snapshot& then, double strength, List& list,
              const std::vector<int>& only = {}) const;

  /// In the plane: lines through the world as it lies on the page.
  void draw_lines(const View& view, std::span<const WorldLine> lines, bool front, List& list) const;

  /// The part of the page that shows the world: in space all panels.
  Rect window() const;

  /// In the plane: how the page is laid out.
  const Layout& layout() const;

  /// The longest trail, s: how far back depict's `ways` must reach.
  double longest_trail() const;

  /// The bodies with trails, which a run must track.
  std::vector<int> trailed() const;

 private:
  struct Plan;
  void ghosts(const sim::Snapshot& then, double strength, List& list, const std::vector<int>& only,
              const View& view) const;
  void draw_names(const sim::Snapshot& now, List& list) const;

  Look look_;
  std::shared_ptr<const Annotations> annotations_;
  Titles titles_;
  // one of them
  std::shared_ptr<const Plan> plan_;
  std::shared_ptr<const SpaceStage> space_;
};

/// Several runs over each other on one page of the plane, the first of them that of the picture itself.
struct RunsOver {
  struct Run {
    const Illustrator* artist = nullptr;  // of the same page
    const sim::Snapshot *now = nullptr, *frame = nullptr;
    std::span<const std::shared_ptr<const sim::Track>> ways{};
    Fate fate = Fate::well;
  };
  const std::vector<ComparedRun>* names = nullptr;
  std::vector<Run> runs;  // all of them
  double time = 0;        // of the clock
};

}  // namespace obscura::draw
