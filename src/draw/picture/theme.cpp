#include "draw/picture/theme.h"

#include <array>
#include <vector>

namespace obscura::draw {

namespace {

constexpr Color kWhite{0xFF, 0xFF, 0xFF}, kBlack{0, 0, 0};
constexpr double kFaint = 0.75;  // luminance: white is 1
constexpr double kFaintestInk = 0.15;
constexpr double kSettled = 0.76;  // of the way to the room's colour: the fill of what is fixed, on the dark
constexpr double kHushedLink = 0.5;
constexpr double kLegible = 4.5;                       // contrast
constexpr double kStrongShade = 0.5, kFaintShade = 3;  // part of the way to the ink; contrast to the room

}  // namespace

Palette palette(Theme theme) {
  const Color green = *color("green");
  if (theme == Theme::paper) {
    return {.ground = kWhite,
            .room = kWhite,
            .ink = {0x1F, 0x23, 0x28},
            .wall = {0x1F, 0x23, 0x28},
            .quiet = {0x66, 0x6F, 0x78},
            .spring = {0x4A, 0x51, 0x59},
            .way = {0x88, 0x8E, 0x95},
            .hatch = {0x8B, 0x94, 0x9E},
            .velocity = green,
            .force = *color("vermilion"),
            .water = mix(kWhite, *color("sky"), 0.17),
            .surface = mix(kWhite, *color("blue"), 0.62)};
  }
  return {.ground = {0x0E, 0x13, 0x18},
          .room = {0x13, 0x1A, 0x21},
          .ink = {0xE8, 0xED, 0xF2},
          .wall = {0xD7, 0xDE, 0xE5},
          .quiet = {0x8A, 0x97, 0xA4},
          .spring = {0xB3, 0xBD, 0xC7},
          .way = {0x72, 0x7E, 0x8A},
          .hatch = {0x5A, 0x67, 0x74},
          // lighter, to be seen on a green body
          .velocity = mix(green, kWhite, 0.4),
          .force = *color("vermilion"),
          .water = mix({0x13, 0x1A, 0x21}, *color("sky"), 0.16),
          .surface = mix({0x13, 0x1A, 0x21}, *color("sky"), 0.7)};
}

Paint paint(Color own, Theme theme) {
  if (theme == Theme::paper) {
    const Color dark = mix(own, kBlack, 0.3);
    // a trail that would hardly be seen on white has the outline's colour
    Color trail = mix(kWhite, own, 0.52);
    if (luminance(trail) > kFaint) trail = mix(kWhite, dark, 0.52);
    return {mix(own, kWhite, 0.62), dark, dark, trail, mix(own, kWhite, 0.2)};
  }
  // axes darker than the fill: lighter ones were too faint
  return {own, mix(own, kWhite, 0.25), mix(own, kBlack, 0.6), mix(palette(theme).room, own, 0.72), own};
}

void fade(Paint& paint, Color toward, double part) {
  for (Color* color : {&paint.fill, &paint.outline, &paint.axis, &paint.trail, &paint.small})
    *color = mix(*color, toward, part);
}

void hush(Paint& paint, const Palette& colours) { fade(paint, colours.room, kHushed); }

Paint fixed_paint(const BodyLook& own, Theme theme) {
  Paint made = paint(own.color && !own.quiet ? *own.color : neutral(theme), theme);
  if (own.quiet) {
    hush(made, palette(theme));
  } else if (!own.color && theme == Theme::screen) {
    made.fill = mix(made.fill, palette(theme).room, kSettled);
  }
  return made;
}

Color link_color(const Look& look, const Palette& colours, std::span<const int> bodies) {
  bool any = false;
  for (const int body : bodies) {
    if (body < 0) continue;
    if (std::size_t(body) >= look.bodies.size() || !look.bodies[std::size_t(body)].quiet)
      return colours.spring;
    any = true;
  }
  return any ? mix(colours.spring, colours.room, kHushedLink) : colours.spring;
}

Color joint_color(const Look& look, const Palette& colours, const sim::SceneInfo& cast, std::size_t joint) {
  const sim::SceneInfo::Joint& own = cast.joints[joint];
  std::vector<int> bodies;
  const auto add = [&](const sim::SceneInfo::Joint& piece) {
    bodies.push_back(piece.a), bodies.push_back(piece.b);
    for (const sim::SceneInfo::Joint::Place& place : piece.places) bodies.push_back(place.body);
  };
  add(own);
  for (const sim::SceneInfo::Joint& other : cast.joints)
    if (own.kind == sim::JointKind::pulley && other.kind == own.kind && other.rope == own.rope) add(other);
  return link_color(look, colours, bodies);
}

Color faintest(Color strong, const Palette& colours) {
  const double least = contrast(mix(colours.room, colours.ink, kFaintestInk), colours.room);
  for (int percent = 5; percent < 100; percent += 5)
    if (const Color c = mix(colours.room, strong, percent / 100.0); contrast(c, colours.room) >= least)
      return c;
  return strong;
}

Color legible(Color own, const Palette& colours) {
  for (int percent = 0; percent < 100; percent += 5) {
    Color words = mix(own, colours.ink, percent / 100.0);
    if (words.a = 255; contrast(words, colours.room) < kLegible) continue;
    words.a = own.a;
    return words;
  }
  return colours.ink;
}

Color shade(Color own, double part, const Palette& colours) {
  const Color strong = mix(own, colours.ink, kStrongShade);
  Color faint = own;
  for (int percent = 5; percent <= 60; percent += 5)
    if (const Color c = mix(own, colours.room, percent / 100.0); contrast(c, colours.room) >= kFaintShade)
      faint = c;
  return part < 0.5 ? mix(strong, own, 2 * part) : mix(own, faint, 2 * part - 1);
}

Color turn(int index) {
  // in grey, too, the first four are told apart
  static const std::array<Color, 6> order{*color("orange"), *color("blue"), *color("green"),
                                          *color("yellow"), *color("sky"),  *color("purple")};
  return order[std::size_t(index) % order.size()];
}

Color neutral(Theme theme) { return theme == Theme::paper ? *color("grey") : Color{0x9A, 0xA7, 0xB4}; }

}  // namespace obscura::draw
