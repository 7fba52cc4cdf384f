#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "draw/page/marks.h"
#include "draw/picture/theme.h"

namespace obscura::draw {

/// The value of an arrow, before it is scaled.
struct Reading {
  sim::Vec3 tail, value;
  double signed_value = 0;  // of what turns: in the plane counter-clockwise, in space how much about `value`
  int part = 0;  // which of the body's: the joint, the spring, what it touches (a wall as -1 - wall)
};

/// The arrows that a vector stands for at an instant: one a spring, one a joint, one a thing touched.
std::vector<Reading> readings(const Marks::Vector& vector, const sim::SceneInfo& cast,
                              const sim::Snapshot& now);

/// Numbers the arrows of each vector that is shown with several at one of `moments`: they have one label, and
/// are told apart by their numbers. `films`: s of the film of each moment; none: of a figure.
void number_arrows(Marks& marks, const sim::SceneInfo& cast, std::span<const sim::Snapshot> moments,
                   std::span<const double> films = {});

/// The value of a quantity of a body at an instant: the sum of its arrows.
sim::Vec3 sum(Quantity quantity, int body, const sim::SceneInfo& cast, const sim::Snapshot& now);

std::string_view unit(Quantity quantity);

/// Whether places and velocities are not enough to know it: contacts, joints and explosions give it, or part
/// of it.
bool of_steps(Quantity quantity);

/// What is rounding's and shown as 0, of values in a unit: 1e-9 of it, or where that is less, 1e-9 of what a
/// body's mass, the room's height and its gravity make of it. `body`: whose value it is; -1: the heaviest's.
double negligible(std::string_view unit, const sim::SceneInfo& cast, int body = -1);

/// Whether it turns: its readings are arcs.
constexpr bool turns(Quantity quantity) {
  return quantity == Quantity::spin || quantity == Quantity::torque || quantity == Quantity::joint_torque;
}

/// How long arrows are, one scale a kind for a whole page: m a unit. 0: none is drawn.
struct Scales {
  double velocity = 0;      // m/s
  double force = 0;         // N
  double impulse = 0;       // N s
  double momentum = 0;      // kg m/s
  double acceleration = 0;  // m/s^2
};

/// The scale of its kind; null: it has none.
double* scale_of(Quantity quantity, Scales& scales);

Color color_of(const Marks::Vector& vector, const Palette& colours);
/// The colour of a mark: black is the page's ink, for a picture has one.
Color inked(Color color, const Palette& colours);

}  // namespace obscura::draw
