#pragma once

#include <span>
#include <vector>

#include "draw/depict.h"
#include "draw/layout.h"
#include "draw/springs.h"
#include "draw/theme.h"

namespace obscura::draw {

/// What the pictures of one run have in common, and the layers they are made of.
struct Stage {
  sim::Cast cast;
  Look look;
  Camera camera;
  Palette colours;
  Layout layout;
  std::vector<Paint> paints;       // one a body
  std::vector<double> dots;        // radius in page units of a body without one, 0 for others
  std::vector<int> boxes, rounds;  // bodies by form
  std::vector<int> arrows;         // bodies with velocity arrows
  std::vector<Coil> coils;         // one a spring; turns 0: a plain line
  std::vector<Coil> hands;         // one a mouse

  Stage(const sim::Cast& cast, const Look& look, const Camera& camera, const Extent& extent, double aspect);

  /// The looks of a body, also where the scene says nothing.
  BodyLook looks(int body) const { return body < int(look.bodies.size()) ? look.bodies[body] : BodyLook{}; }
};

using Ways = std::span<const std::shared_ptr<const sim::Track>>;

/// Hatching, room, walls, title: what stands still while the camera does.
void draw_still(const Stage& stage, const View& view, List& list);

void draw_trails(const Stage& stage, const View& view, const sim::Snapshot& now, Ways ways, List& list);

/// Springs that no box holds, drawn behind the bodies, or those that one does, in front of the boxes; with a
/// dot where they are made fast.
void draw_springs(const Stage& stage, const View& view, const sim::Snapshot& now, bool boxes, List& list);

void draw_boxes(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_rounds(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_velocities(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

/// The dotted paths of the mice, and, in front of everything, their springs and pointers.
void draw_ways(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);
void draw_hands(const Stage& stage, const View& view, const sim::Snapshot& now, List& list);

}  // namespace obscura::draw
