#pragma once

#include <algorithm>
#include <string_view>

#include "sim/model/model.h"

namespace obscura::scene {

/// A word of `joint.type`: the kind that it means in the plane and in space, and a line for the page of keys;
/// empty for a second word for the same kind.
struct JointWord {
  std::string_view word;
  sim::JointKind plane, space;
  std::string_view doc;

  constexpr sim::JointKind kind(int dimension) const { return dimension == 2 ? plane : space; }
};

/// All words, in the order of the page.
inline constexpr JointWord kJointWords[] = {
    {"pin", sim::JointKind::pin, sim::JointKind::pin,
     "both turn about one point, in space about any axis, the same as `ball`"},
    {"hinge", sim::JointKind::pin, sim::JointKind::hinge, "about one axis, in the plane a pin"},
    {"ball", sim::JointKind::pin, sim::JointKind::pin, ""},
    {"weld", sim::JointKind::weld, sim::JointKind::weld, "no relative motion"},
    {"slider", sim::JointKind::slider, sim::JointKind::slider, "the first slides along a line of the second"},
    {"rod", sim::JointKind::rod, sim::JointKind::rod, "the distance of two points is constant"},
    {"rope", sim::JointKind::rope, sim::JointKind::rope, "it has a maximum"},
    {"pulley", sim::JointKind::pulley, sim::JointKind::pulley, "a rope over points and wheels"},
    {"screw", sim::JointKind::screw, sim::JointKind::screw,
     "in space: the first slides along an axis of the second and turns about it, by `pitch` a turn"},
    {"gear", sim::JointKind::gear, sim::JointKind::gear,
     "one joint's angle, or way, is a ratio times another's"},
};

static_assert(
    [] {
      for (int i = 0; i < sim::kJointKinds; ++i)
        if (sim::JointKind(i) != sim::JointKind::wire &&  // that is a [[track]]'s
            std::ranges::none_of(kJointWords,
                                 [&](const JointWord& each) { return each.space == sim::JointKind(i); }))
          return false;
      return true;
    }(),
    "each kind of joint has a word");

}  // namespace obscura::scene
