#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/run/shots.h"
#include "draw/compose/annotate.h"
#include "draw/compose/depict.h"
#include "draw/page/plot.h"
#include "draw/picture/list.h"
#include "draw/picture/look.h"
#include "draw/picture/prose.h"
#include "draw/picture/world_line.h"
#include "scene/scene.h"
#include "sim/model/snapshot.h"

namespace obscura::app {

/// The command line's settings of a figure; the scene's [figure] has the others.
struct AlbumOptions {
  std::vector<sim::Rational> at;  // s, one a panel
  std::optional<double> width;    // pt
  std::optional<sim::Rational> every;
  std::optional<int> columns;
  std::vector<std::string> vary;  // "crate.elasticity=0,0.5,1"
  std::optional<draw::Theme> theme;
  bool latex = false;  // words are set apart, for LaTeX
};

/// The part of a page that is pixels: surfaces, their light and their shadows.
struct Lit {
  draw::Rect where;       // in the page's units
  draw::Picture picture;  // without what moves
};

/// A figure: its picture is what is drawn on what is lit.
struct Page {
  draw::Picture picture;
  std::vector<Lit> lit;
};

/// The instants that a figure shows, simulated: one panel for each, of one run or of several that differ in a
/// value; in space one for each by each camera.
class FigureBuilder {
 public:
  /// Reads the scene and runs it as far as the figure needs. Throws UsageError, scene::Error, TroubleError.
  FigureBuilder(const std::string& scene, const std::vector<std::string>& sets, const AlbumOptions& options);
  /// The same of a scene that is read.
  FigureBuilder(const scene::Scene& scene, const AlbumOptions& options);

  Page page() const;
  double width() const { return width_; }  // pt
  /// What it shows, in sentences.
  std::string text() const;
  const scene::Scene& scene() const { return panels_.front().scene; }
  std::string title() const { return draw::in_letters(panels_.front().scene.look.title); }

 private:
  struct Panel {
    scene::Scene scene;
    sim::SceneInfo cast;
    sim::Snapshot now;
    std::vector<sim::Snapshot> before;                    // exposures, oldest first
    std::vector<std::optional<sim::Snapshot>> ghosts;     // one a ghost of the figure; none: of later
    std::vector<std::shared_ptr<const sim::Track>> ways;  // of trails
    std::string words;                                    // what sets it apart from the others
  };
  using Read = std::function<scene::Scene(const std::vector<std::string>& sets)>;
  FigureBuilder(const std::string& file, const std::vector<std::string>& sets, const Read& read,
                const AlbumOptions& options);
  void take(const scene::Scene& scene, const std::vector<sim::Rational>& times, const std::string& words);
  /// The content of one place of the page.
  struct Cell {
    const Panel* panel = nullptr;
    int camera = 0, index = 0;
    std::string words, title;
  };
  std::vector<Cell> cells() const;
  draw::Illustrator depictor(const Cell& cell, double width) const;
  void tell_wide(const std::string& what, double width, double room) const;
  static std::vector<draw::SpaceGhost> ghosts_of(const Cell& cell);
  /// What lies outside of what panels show, and these panels' letters.
  using Unseen = std::map<std::string, std::string>;
  draw::List in_plane(const draw::Illustrator& depictor, const Cell& cell, const draw::Scales& scales,
                      double& height, Unseen& unseen) const;
  draw::List in_space(const draw::Illustrator& depictor, const Cell& cell, const draw::Scales& scales,
                      double width, double& height, Lit& lit, Unseen& unseen) const;
  void annotate(const Cell& cell, const draw::Marks& marks, const draw::Scales& scales,
                const std::vector<draw::SpaceGhost>& ghosts, const std::vector<draw::WorldLine>& paths,
                const draw::Projection& projection, Unseen& unseen, draw::List& list) const;

  /// One of the runs that differ in a value, and what it is called in a plot.
  struct Variant {
    scene::Scene scene;
    std::string name;
    std::string words;  // key and value, as in "e = 0.5", where there is room
  };
  std::vector<draw::Plot> plots() const;

  std::vector<Panel> panels_;
  std::vector<Variant> variants_;
  double width_ = 0;
  int columns_ = 1;
  bool apart_ = false;
  std::optional<sim::Rational> every_;
};

}  // namespace obscura::app
