#pragma once

#include <span>

#include "draw/picture/color.h"
#include "draw/picture/look.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

/// The colours of a theme: two grounds, and inks from loud to quiet.
struct Palette {
  Color ground;  // of the page
  Color room;    // of the room's inside: what halos are made of
  Color ink;     // title, time, pointer
  Color wall;
  Color quiet;  // subtitle
  Color spring;
  Color way;  // the hand's dotted path
  Color hatch;
  Color velocity;        // arrows of velocity
  Color force;           // and of forces
  Color water, surface;  // a fluid in the plane, and the line of its surface
};

/// The colours of one body; `small`: of the fill where the body is small.
struct Paint {
  Color fill, outline, axis, trail, small;
};

/// Weights in page units at the weight 1 of a landscape page (layout.h), as in print on a slide.
inline constexpr double kWallLine = 3.2, kOutline = 2.8, kAxisLine = 2.4, kSpringLine = 3.2,
                        kThinSpring = 2.2, kNetLine = 2.0, kArrowLine = 4.0, kHatchLine = 1.6, kRod = 5.2,
                        kRope = 2.4, kTrailLine = 6.4, kSurfaceLine = 2.4;
inline constexpr double kHatchStep = 14,
                        kBand = 24;  // along an upright wall; from the wall to the band's edge
inline constexpr double kDot = 8, kJoint = 5,
                        kPin = 7;  // radius of a point, of where a spring is made fast, of a pin

/// The colours of the paper or of the screen.
Palette palette(Theme theme);

/// Fill, outline, axes and trail of a body of this colour.
Paint paint(Color color, Theme theme);

/// Brings all of a body's colours so far towards another, 0 to 1.
void fade(Paint& paint, Color toward, double part);

/// Makes a grey body recede further: others are to be looked at. How far towards the room's colour.
void hush(Paint& paint, const Palette& colours);
inline constexpr double kHushed = 0.35;

/// The colour of what ties bodies, or bodies and the room (-1). It recedes where none of them is to be looked
/// at.
Color link_color(const Look& look, const Palette& colours, std::span<const int> bodies);

/// The same of a joint: all that a rope hangs on and lies on and the wheels of a belt are among its bodies.
Color joint_color(const Look& look, const Palette& colours, const sim::SceneInfo& cast, std::size_t joint);

/// Of what is fixed in the plane. If it has no colour of its own, its fill on the dark is near to the room's
/// colour, as fills are on paper, so that it is ground for what moves and for words; small things keep
/// theirs.
Paint fixed_paint(const BodyLook& own, Theme theme);

/// What a trail of this colour fades to: nearer to the room's colour than it, but by contrast as far from it
/// as 15 % of the way to the ink is, or not faded at all.
Color faintest(Color strong, const Palette& colours);

/// The colour of words of a thing of this colour: so near to the ink that they are read, by WCAG's contrast
/// of 4.5 to the room's colour. Its alpha stays.
Color legible(Color own, const Palette& colours);

/// A shade of a colour of lines: from `part` 0, nearer to the ink, to 1, nearer to the room, from which it
/// still stands out.
Color shade(Color own, double part, const Palette& colours);

/// The colours that bodies without one take in turn. Vermilion is left to forces.
Color turn(int index);

/// The grey of what is not a body to look at: a net's knots, what is held fast.
Color neutral(Theme theme);

}  // namespace obscura::draw
