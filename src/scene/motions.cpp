#include "scene/motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "sim/model/body_motion.h"
#include "sim/model/drives.h"
#include "sim/model/trouble.h"

namespace obscura::scene {

namespace {

constexpr const char* kMotionWays[] = {"x", "y", "z"};

// a velocity of the surface as it was typed: a number in the plane, a vector of the typed frame in space
sim::AngularVec<2> belt(const Node& node, const Seat<2>&) { return sim::AngularVec<2>(node.number()); }
sim::AngularVec<3> belt(const Node& node, const Seat<3>& seat) {
  return turned<3>(vector<3>(node), sim::inverse<3>(seat.axes));
}

sim::AngularVec<2> axis_of(const Fields&, const sim::AngularVec<2>&) { return sim::AngularVec<2>(1.0); }
sim::AngularVec<3> axis_of(const Fields& fields, const sim::AngularVec<3>&) {
  return fields.vector<3>("axis").stableNormalized();
}

// what a body with a motion must not have beside it
template <int D>
bool contradicted(const Fields& fields, Diagnostics& complaints) {
  bool wrong = false;
  for (const char* key : {"velocity", "spin"}) {
    if (!fields.given(key)) continue;
    complaints.add(fields.place(key), fmt::format("'{}' of a body with a 'motion' follows from that", key));
    wrong = true;
  }
  if (const Node* fixed = fields.given("fixed");
      fixed && (fixed->is_text() || std::get<bool>(fixed->value))) {
    complaints.add(fixed->place,
                   "'fixed' holds it where it starts, and its 'motion' moves it; leave one out");
    wrong = true;
  }
  return wrong;
}

}  // namespace

template <int D>
std::optional<sim::Vec<D>> path_start(const Fields& fields) {
  const Node* motion = fields.given("motion");
  const Node* path = motion ? motion->find("path") : nullptr;
  if (!path || path->list().empty()) return {};
  sim::Vec<D> at;
  for (int axis = 0; axis < D; ++axis) at[axis] = path->list()[0].list()[std::size_t(axis) + 1].number();
  return at;
}

template <int D>
void motion(const Fields& fields, const std::string& kind, int copy, bool copied, const Seat<D>& seat,
            Constants& constants, sim::World<D>& world, Diagnostics& complaints) {
  const int index = int(world.model.bodies.size()) - 1;
  sim::Body<D>& body = world.model.bodies.back();
  sim::State<D>& state = world.state;
  if (const Node* surface = fields.given("surface_speed")) {
    body.belt = belt(*surface, seat);
    if (world.model.collision == sim::Collision::handout || body.handout)
      complaints.add(surface->place,
                     "'surface_speed' needs bodies that touch each other: [physics] collision = \"contact\"");
  }
  const Node *given = fields.given("motion"), *release = fields.given("release");
  if (!given && !release) return;

  sim::Drive<D> drive;
  drive.body = index;
  drive.start = state.x.back();
  drive.turn = sim::no_rotation<D>();
  if (body.turns()) drive.turn = state.turn.back();
  if (release) {
    if (!given && !body.fixed) {
      if (!copied)
        complaints.add(release->place,
                       "'release' lets go what is 'fixed' or has a 'motion', and this is free");
      return;
    }
    drive.release = exact(*release);
  }
  if (given) {
    if (contradicted<D>(fields, complaints)) return;
    const Fields own(*given, kind + ".motion");
    const Node *path = own.given("path"), *angle = own.given("angle");
    sim::MotionText text;
    bool ways = false;
    for (int k = 0; k < D; ++k) {
      const Node* way = own.given(kMotionWays[k]);
      text.ways.push_back(way ? typed(*way) : "");
      if (!way) continue;
      ways = true;
      constants.read_by(text.ways.back());
      if (path)
        complaints.add(way->place,
                       fmt::format("'{}' and 'path' both say where it is; leave one out", kMotionWays[k]));
    }
    if (!ways && !path && !angle) {
      complaints.add(given->place, "'motion' moves nothing: give x, y, an angle or a path");
      return;
    }
    if (angle) {
      if (!body.turns()) {
        complaints.add(angle->place, "'angle' of a body that does not turn");
        return;
      }
      text.angle = typed(*angle), text.angle_unit = std::numbers::pi / 180;
      constants.read_by(text.angle);
    }
    drive.axis = axis_of(own, sim::AngularVec<D>());
    if (!seat.center.isZero(0) && body.turns()) {
      // it turns about its origin, which its 'position' gives
      const sim::Orientation<D> typed_turn = sim::composed<D>(drive.turn, sim::inverse<D>(seat.axes));
      drive.pivot = -turned<D>(seat.center, typed_turn);
    }
    if (path) {
      if (fields.given("position") || copied) {
        complaints.add(path->place, copied
                                        ? "copies would all go along one 'path'; x and y of a 'motion' may "
                                          "read the copy's number i"
                                        : "'path' says where it is; leave out 'position'");
        return;
      }
      for (const Node& knot : path->list()) {
        sim::Vec<D> at;
        for (int axis = 0; axis < D; ++axis) at[axis] = knot.list()[std::size_t(axis) + 1].number();
        drive.path.push_back({exact(knot.list()[0]), at});
      }
    }
    sim::NamedNumbers numbers = constants.numbers();
    numbers.emplace_back("i", double(copy));
    auto made = sim::drive_formula<D>(text, numbers);
    if (const auto* fault = std::get_if<sim::MotionFault>(&made)) {
      std::vector<std::string> names{"t"};
      for (const auto& [name, value] : numbers) names.push_back(name);
      for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
      for (const std::string_view name : sim::expression_numbers()) names.emplace_back(name);
      const char* key = fault->component < 0 ? "angle" : kMotionWays[fault->component];
      if (copy == 0) complain(*own.given(key), key, fault->fault, names, complaints);
      return;
    }
    drive.formula = std::make_shared<const sim::Program>(std::get<sim::Program>(std::move(made)));
    body.fixed = body.driven = true;
  }
  world.model.drives.push_back(std::move(drive));
  if (!given) return;

  // where its motion begins
  sim::Model<D> alone;
  alone.bodies = {body}, alone.drives = {world.model.drives.back()};
  alone.drives[0].body = 0;
  try {
    const sim::DrivenMotion<D> now = sim::Drives<D>(alone).at(0, 0);
    state.x.back() = now.at.x, state.v.back() = now.at.v;
    if (body.turns()) state.turn.back() = now.turn, state.spin.back() = now.at.w;
  } catch (const sim::NotFinite&) {
    complaints.add(given->place,
                   "the place, velocity or acceleration of this 'motion' is not finite at the start");
  }
}

template std::optional<sim::Vec<2>> path_start<2>(const Fields&);
template std::optional<sim::Vec<3>> path_start<3>(const Fields&);
template void motion<2>(const Fields&, const std::string&, int, bool, const Seat<2>&, Constants&,
                        sim::World<2>&, Diagnostics&);
template void motion<3>(const Fields&, const std::string&, int, bool, const Seat<3>&, Constants&,
                        sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
