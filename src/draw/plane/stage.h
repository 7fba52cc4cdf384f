#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "draw/page/chart.h"
#include "draw/page/layout.h"
#include "draw/picture/theme.h"
#include "draw/picture/view.h"
#include "draw/plane/springs.h"

namespace obscura::draw {

/// Which of the bodies with flat sides: what is fixed lies below what moves, and the arms of gears lie over
/// both.
enum class Rank : std::uint8_t { fixed, free, arm };

/// Data common to the pictures of one run, and the layers they are made of.
struct Stage {
  sim::SceneInfo cast;
  Look look;
  Camera camera;
  Palette colours;
  Layout layout;
  Charts charts;
  std::vector<Paint> paints;                      // one a body
  std::vector<double> dots;                       // radius in page units of a body without one, 0 for others
  std::vector<int> boxes, polygons, rounds;       // bodies by form; a compound is among the polygons
  std::vector<std::vector<std::uint64_t>> seams;  // of each body's parts: bit e of part p is set where its
                                                  // edge e lies within another part
  std::vector<char> arm;    // one a body: slender, and carries toothed wheels, so that it lies
                            // over them
  std::vector<int> arrows;  // bodies with velocity arrows
  double force_scale = 0;   // m/N
  std::vector<Coil> coils;  // one a spring; turns 0: a plain line
  std::vector<Coil> hands;  // one a mouse

  Stage(const sim::SceneInfo& cast, const Look& look, const Camera& camera, const Layout& layout,
        const Charts& charts = {});

  /// The looks of a body, also where the scene says nothing.
  BodyLook looks(int body) const { return body < int(look.bodies.size()) ? look.bodies[body] : BodyLook{}; }

  /// Whether a body has points of its own to be held at.
  bool solid(int body) const { return body >= 0 && cast.bodies[body].turns; }

  Rank rank(int body) const {
    const auto i = std::size_t(body);
    return cast.bodies[i].fixed ? Rank::fixed : arm[i] ? Rank::arm : Rank::free;
  }
};

/// For each part of a body, the edges that lie within another part, see draw/plane/polygons.cpp.
std::vector<std::uint64_t> seams_of(const sim::SceneInfo::Body& body);

using Ways = std::span<const std::shared_ptr<const sim::Track>>;

/// The way of a body since `from` (s), up to now, as round as its motion to `tolerance` (m).
std::vector<sim::Track::Point> way_of(int body, double from, const sim::Snapshot& now, Ways ways,
                                      double tolerance);

/// The points of a way between two of its points that its curve needs to be no farther than `least` (m) from
/// the line through them, in order.
void bends(const std::vector<sim::Track::Point>& way, std::size_t a, std::size_t b, double least,
           const std::function<void(std::size_t)>& add);

/// Which bodies are knots of a net: particles with three springs or more, and those with two that hang on
/// one.
std::vector<char> knots(const sim::SceneInfo& cast);

/// How long the arrow of a newton is, m.
double newton(const sim::SceneInfo& cast);

/// More springs than these, nets apart, are drawn as lines.
inline constexpr int kMany = 12;

/// How much of its whole size the head of an arrow has, 0 to 1.
double growth(const Point& tail, const Point& tip, double weight);
/// Of an arrow's growth: smaller ones are not drawn.
inline constexpr double kSmallest = 0.2;

/// The fill of a body that reaches so far from its middle, page units: that of a small one is its strong
/// colour, for its outline is hardly seen.
Color fill_of(const Paint& paint, double half, double weight);

/// An arrow from `tail` to `tip` on the page.
struct Arrow {
  Point tail, tip;
  double grow = 1;                // of its head and shaft
  double bare = 2;                // from here on along its way (0 to 1) it has no halo: 2: all of it has
  bool cut = false;               // it would be longer, but ends at the window's edge
  std::optional<Hang> hang = {};  // in space
};

/// An arrow, if it is large enough to be seen. One that begins in the window ends there; if it is shorter for
/// that, two strokes across its shaft say so.
void offer(const Point& tail, Point tip, const Rect& window, double weight, std::vector<Arrow>& arrows);

/// An arrow at a window's edge to what lies outside it, `away` from its middle.
Arrow at_edge(const Rect& window, const Point& away, double weight);

/// Halos of all below all arrows, but not over small discs with an outline that are in
/// the list.
void draw_arrows(const std::vector<Arrow>& arrows, double weight, Color room, Color color, List& list);

/// Pieces of ceiling, floor or wall at places of the room where springs, rods and ropes are made fast.
void draw_brackets(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

/// The same, each in its own colour.
void draw_arrows(const std::vector<Arrow>& arrows, const std::vector<Color>& inks, double weight, Color room,
                 List& list);

/// A force where two touch: all that one gives to the other, at their centre of pressure.
struct Push {
  sim::Vec3 point, force;
  bool quiet = false;  // others are to be looked at
};

/// The forces of contacts that the look asks for.
std::vector<Push> pushes(const sim::SceneInfo& cast, const Look& look, const sim::Snapshot& now);

/// The pointer of a hand, its tip at `at`.
void draw_pointer(const Point& at, double alpha, double weight, const Palette& colours, List& list);

/// How strongly a hand is shown at a time: it appears before the press and leaves after the release.
double shown(const sim::SceneInfo::Mouse& mouse, double time);

/// The hand's place at a time, also before the press and after the release.
sim::Vec3 pointer(const sim::SceneInfo::Mouse& mouse, const sim::Snapshot::Mouse& now, double time);

/// Hatching, room, walls, title: the things that stand still while the camera does.
void draw_still(const Stage& stage, const View& view, List& list);

void draw_trails(const Stage& stage, const View& view, const sim::Snapshot& now, Ways ways, List& list);

/// The marks of surfaces that run around bodies, of flat ones of a rank, or of round ones.
void draw_belts(const Stage& stage, const View& view, const sim::Snapshot& now, Rank rank, bool rounds,
                List& list);

/// Springs that no body with points of its own holds, drawn behind the bodies, or those that one does, in
/// front of the boxes; with a dot where they are made fast.
void draw_springs(const Stage& stage, const View& view, const sim::Snapshot& now, bool solids, List& list);

/// Arrows at the picture's edge towards bodies with trails that have left it.
void draw_gone(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

void draw_polygons(const Stage& stage, const View& view, const sim::Snapshot& now, Rank rank, List& list);
void draw_velocities(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

/// The forces where bodies touch that have such arrows: one arrow for two that touch, at their centre of
/// pressure, the force on the one that is pushed up.
void draw_contacts(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

/// The tracks of a scene: lines, hatched on the side that is not touched.
void draw_tracks(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

/// The colour that the scene gives to a track.
std::optional<Color> track_color(const Look& look, const std::string& name);

/// The rails of sliders, behind the bodies; rods and ropes, in front of boxes; pins, in front of all.
void draw_rails(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_arms(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_rods(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_pulleys(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_pins(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

/// The dotted paths of the mice, and, in front of everything, their springs and pointers.
void draw_ways(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_hands(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

}  // namespace obscura::draw
