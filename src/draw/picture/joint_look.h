#pragma once

#include <array>

#include "sim/model/model.h"

namespace obscura::draw {

/// The mark that a joint is drawn as: a dot at its place; a line between its ends; such a line that sags if
/// it is slack; a rail along its axis; a line over points and around wheels; teeth around two wheels.
enum class JointMark { none, dot, line, rope, rail, pulley, teeth };

/// How joints of a kind are drawn.
struct JointLook {
  sim::JointKind kind;
  JointMark plane, space;
};

inline constexpr auto kJointLooks = std::to_array<JointLook>({
    {sim::JointKind::pin, JointMark::dot, JointMark::dot},
    {sim::JointKind::weld, JointMark::none, JointMark::dot},
    {sim::JointKind::slider, JointMark::rail, JointMark::rail},
    {sim::JointKind::rod, JointMark::line, JointMark::line},
    {sim::JointKind::rope, JointMark::rope, JointMark::rope},
    {sim::JointKind::hinge, JointMark::dot, JointMark::dot},
    {sim::JointKind::pulley, JointMark::pulley, JointMark::pulley},
    {sim::JointKind::gear, JointMark::teeth, JointMark::none},
    {sim::JointKind::screw, JointMark::none, JointMark::rail},
    {sim::JointKind::wire, JointMark::none, JointMark::none},
});
static_assert(sim::in_order(kJointLooks), "each kind of joint has a look");

constexpr const JointLook& joint_look(sim::JointKind kind) { return kJointLooks[std::size_t(kind)]; }

/// Whether a mark goes from one end of its joint to the other.
constexpr bool spans(JointMark mark) {
  return mark == JointMark::line || mark == JointMark::rope || mark == JointMark::pulley;
}

}  // namespace obscura::draw
