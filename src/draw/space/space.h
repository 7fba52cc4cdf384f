#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "draw/picture/solids.h"
#include "draw/picture/world_line.h"
#include "draw/plane/stage.h"
#include "draw/space/camera.h"
#include "draw/space/light.h"
#include "draw/space/polyhedron.h"
#include "draw/space/sight.h"

namespace obscura::draw {

/// A convex piece of a body, in the body's frame.
struct Piece {
  enum class Form { polyhedron, ball, capsule };
  Form form = Form::ball;
  int body = 0;
  Polyhedron flat;                              // of a polyhedron,
  std::vector<std::vector<sim::Vec3>> normals;  // and round_normals of it
  // at each side of each face: 1 where another piece of the body continues it, -1 where a neighbour of it is
  // continued and hides it
  std::vector<std::vector<std::int8_t>> goes_on;
  sim::Vec3 a = sim::Vec3::Zero(), b = a;               // a ball's centre; the ends of a capsule's axis
  double radius = 0;                                    // m; 0: a point, drawn as a dot
  double reach = 0;                                     // from the body's centre, m
  double least = 0;                                     // half its thickness, m
  Eigen::Matrix3d grain = Eigen::Matrix3d::Identity();  // body frame to that of its material's pattern
  bool marked = false;                                  // a round body with lines that show how it turns
};

/// A window on the page and the camera that looks out of it.
struct Panel {
  Camera camera;
  Rect window;
  Aim aim;
  double shown = 1;  // m: how wide it shows the world as the run begins
  std::vector<Text> words;
};

/// Data common to the pictures of one run in space.
struct SpaceStage {
  sim::SceneInfo cast;
  Look look;
  Palette colours;
  Layout layout;  // the caption, weights
  Charts charts;
  std::vector<Panel> panels;
  Light light;
  std::vector<Piece> pieces;  // by body
  bool grained = false;       // whether one of them is of wood or checks,
  bool marked = false;        // and whether one is marked
  std::vector<Color> own;     // one a body
  std::vector<double> dots;   // as Stage's
  Polyhedron room;            // what the walls leave of space
  bool closed = false;
  std::optional<Ground> ground;
  std::vector<Ground> slopes;  // walls that rise from it
  int ground_face = -1;        // of the room
  double reach = 1;            // m: how far what is fitted is across
  double force_scale = 0;
  std::vector<Coil> coils, hands;  // turns 0: a plain line

  SpaceStage(const sim::SceneInfo& cast, const Look& look, const std::vector<Camera>& cameras,
             const Extent& extent, double aspect, const Charts& charts = {});
  BodyLook looks(int body) const { return body < int(look.bodies.size()) ? look.bodies[body] : BodyLook{}; }

  // the last still list, and what it is of
  mutable std::mutex mutex;
  mutable std::vector<CameraProjection> seen;
  mutable std::shared_ptr<const List> still;
};

/// How a panel sees space at an instant.
CameraProjection lens_of(const SpaceStage& stage, const Panel& panel, const sim::Snapshot& now);

/// `frame`: of which the clock and the charts are. `paths`: lines among the bodies.
Picture depict_space(const SpaceStage& stage, const sim::Snapshot& now, Ways ways, const sim::Snapshot& frame,
                     std::span<const WorldLine> paths = {}, std::span<const SpaceGhost> ghosts = {});

/// A stroke, and how near it is: the farther is drawn first.
struct Trace {
  std::vector<Node> nodes;
  bool closed = false;
  double near = 0;
};

/// Triangles of one thing.
struct Chunk {
  std::size_t begin = 0, end = 0;  // into SpaceFrame::triangles
  sim::Vec3 center = sim::Vec3::Zero();
  double reach = 0;  // of a ball around it, m
  int piece = -1;    // a thing's own number: -1 casts nothing on others
};

/// A corner of a triangle before the light has seen it.
struct Corner {
  sim::Vec3 place, normal;
  Shaded color;
  int piece = -1;  // of which it is the surface
};

/// The shadow of a spring, rod or rope on the ground: that of a round rod that stops a share of the light.
struct Rod {
  sim::Vec3 a, b;
  double radius = 0, share = 1;
};

/// One panel at one instant, while it is drawn.
struct SpaceFrame {
  const SpaceStage& stage;
  const Panel& panel;
  const CameraProjection lens;
  const sim::Snapshot& now;
  List& list;
  double zoom;  // page scale over that at the start
  HiddenLines sight;
  Solids solids;
  std::vector<Polyhedron> placed;  // polyhedra in the world, one a piece; empty ones of other forms
  std::vector<Corner> corners;
  std::vector<std::uint32_t> triangles;  // into corners
  std::vector<Chunk> chunks;
  std::vector<Trace> lines;
  std::vector<Rod> rods;
  std::vector<Polyhedron> brackets;
};

/// Page units at the weight 1: between two panels, with a line in the middle.
inline constexpr double kCameraGap = 22;

/// Grid, room, caption, lines between panels: the things that stand still while the camera does.
void draw_space_still(const SpaceStage& stage, const std::vector<CameraProjection>& lenses, List& list);

/// The hairlines of the room that lie between it and the eye.
void draw_room_front(const SpaceStage& stage, const CameraProjection& lens, List& list);

/// A round rod along `way`, of this radius (m), into the solids; `number`: in sight. `rings`: of corners,
/// from one place of the way to the next. `coil`: what it is, where it is the wire of one.
void add_tube(SpaceFrame& scenery, const std::vector<sim::Vec3>& way, double radius, Color color, int number,
              int rings = 1, const Solids::Tube* coil = nullptr);
void add_ball(SpaceFrame& scenery, const sim::Vec3& center, double radius, Color color, int number);

/// Bodies: first the regions that they hide, then their visible parts.
void add_bodies(SpaceFrame& scenery);
/// Springs, rods, ropes, pins, the hands' springs; before lines are traced, since they hide them.
void add_links(SpaceFrame& scenery);
/// Pieces of ceiling over the places of the room from which something hangs.
void add_brackets(SpaceFrame& scenery);
/// The surface of a fluid, and the line around it.
void add_water(SpaceFrame& scenery);
void trace_water(SpaceFrame& scenery);
/// The edges of bodies that are seen, and of those pieces.
void trace_edges(SpaceFrame& scenery);
void trace_ghost(SpaceFrame& scenery, const SpaceGhost& ghost);
void trace_trails(SpaceFrame& scenery, Ways ways);
void trace_paths(SpaceFrame& scenery, std::span<const WorldLine> paths, bool front);
/// Lines from what flies to the ground.
void trace_drops(SpaceFrame& scenery);
/// The shadows on the ground and on each other.
void add_shadows(SpaceFrame& scenery);
/// The lines that were traced, the farthest first, and arrows over them.
void draw_space_arrows(SpaceFrame& scenery);
/// Arrows at the window's edge to bodies with trails that have left it.
void draw_space_gone(SpaceFrame& scenery);
void draw_space_hands(SpaceFrame& scenery);

/// The parts of a line through `way` that are seen, as lines of this width and colour.
void trace(SpaceFrame& scenery, const std::vector<sim::Vec3>& way, bool closed, int own, int too,
           double width, Color color, std::span<const sim::Vec3> faces = {});

}  // namespace obscura::draw
