#pragma once

#include <deque>
#include <memory>
#include <span>

#include "draw/page/chart.h"
#include "draw/picture/lens.h"
#include "draw/picture/list.h"
#include "draw/picture/look.h"
#include "draw/picture/view.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

struct Layout;
struct SpaceStage;
struct Sheet;

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

  /// In space: how it lies in a panel.
  CameraProjection lens(const sim::Snapshot& now, int panel = 0) const;

  /// The picture of one instant. `ways`: the tracks that hold the last `trail` seconds before it, oldest
  /// first.
  Picture depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways) const;

  /// The same, with the clock and the charts of another instant: that of the frame in which `now` is a
  /// moment.
  Picture depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways,
                 const sim::Snapshot& frame) const;

  /// How far anything that is seen moves on the page in the next `seconds` if it goes straight on, page
  /// units.
  double travel(const sim::Snapshot& now, double seconds) const;

  /// In the plane: the bodies alone as they were at another instant, `strength` (0 to 1) of the way from the
  /// ground to their own colours.
  void ghosts(const sim::Snapshot& then, double strength, List& list) const;

  /// In the plane: how the page is laid out.
  const Layout& layout() const;

  /// The longest trail, s: how far back depict's `ways` must reach.
  double longest_trail() const;

  /// The bodies with trails, which a run must track.
  std::vector<int> trailed() const;

 private:
  struct Plan;
  Look look_;
  // one of them
  std::shared_ptr<const Plan> plan_;
  std::shared_ptr<const SpaceStage> space_;
};

}  // namespace obscura::draw
