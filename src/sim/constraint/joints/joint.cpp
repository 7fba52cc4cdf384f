#include "sim/constraint/joints/joint.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "sim/constraint/joints/gear.h"
#include "sim/constraint/joints/hinge.h"
#include "sim/constraint/joints/pin.h"
#include "sim/constraint/joints/pulley.h"
#include "sim/constraint/joints/rod.h"
#include "sim/constraint/joints/rope.h"
#include "sim/constraint/joints/screw.h"
#include "sim/constraint/joints/slider.h"
#include "sim/constraint/joints/weld.h"
#include "sim/constraint/joints/wire.h"
#include "sim/math/lie_step.h"

namespace obscura::sim {

namespace {

// the turn of a body of a state, whole rounds included
template <int D>
struct RoundsIn {
  const State<D>& state;

  AngularVec<D> operator()(int body) const {
    const int k = body < 0 ? -1 : turning(state, body);
    return k < 0 ? AngularVec<D>(AngularVec<D>::Zero())
                 : AngularVec<D>(rounds<D>(state.turn[std::size_t(k)]));
  }
};

}  // namespace

// in the order of JointKind
template <int D>
const JointEquations<D>& equations(JointKind kind) {
  static constexpr auto kTable =
      std::to_array<JointEquations<D>>({kPin<D>, kWeld<D>, kSlider<D>, kRod<D>, kRope<D>, kHinge<D>,
                                        kPulley<D>, kGear<D>, kScrew<D>, kWire<D>});
  static_assert(in_order(kTable) && std::ranges::all_of(kTable, [](const auto& its) {
                  return its.rows > 0 && its.rows <= kMostHeld<D>;
                }));
  return kTable[std::size_t(kind)];
}

template <int D>
int rows(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
         const std::type_identity_t<JointTurn<D>>& turn, Row<D>* out, double* off,
         std::type_identity_t<std::span<const BodyMotion<D>>> all) {
  const JointEquations<D>& its = equations<D>(joint.kind);
  its.hold({joint, a, b, turn.between, all, turn.wound}, out, off);
  for (int i = 0; i < its.rows && !its.mechanism; ++i) out[i].a = joint.a.body, out[i].b = joint.b.body;
  return its.rows;
}

template <int D>
AngularVec<D> turn_between(const Joint<D>& joint, const State<D>& state) {
  return joint.turn_between(RoundsIn<D>{state});
}

template <int D>
AngularVec<D> turn_between(const Joint<D>& joint, std::size_t number, const State<D>& state) {
  return turn_between(joint, wound(state, number), RoundsIn<D>{state});
}

template <int D>
int rows(const Joint<D>& joint, std::size_t number, const State<D>& state,
         std::type_identity_t<std::span<const BodyMotion<D>>> at, Row<D>* out, double* off) {
  static const BodyMotion<D> room;
  const auto side = [&](int body) -> const BodyMotion<D>& { return body < 0 ? room : at[std::size_t(body)]; };
  return rows(joint, side(joint.a.body), side(joint.b.body),
              {turn_between(joint, number, state), wound(state, number)}, out, off, at);
}

template <int D>
bool free_row(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
              const std::type_identity_t<JointTurn<D>>& turn, Row<D>& out, double& way) {
  const JointEquations<D>& its = equations<D>(joint.kind);
  if (!its.coordinate) return false;
  way = its.coordinate({joint, a, b, turn.between}, out);
  out.a = joint.a.body, out.b = joint.b.body;
  return true;
}

template <int D>
Wrench<D> load_on_a(const Joint<D>& joint, const Row<D>& row, const BodyMotion<D>& a,
                    const BodyMotion<D>& b) {
  const Vec<D> place = a.x + a.arm(joint.a.local);
  Wrench<D> load{AngularVec<D>::Zero(), row.along};
  const int body = joint.a.body >= 0 ? joint.a.body : joint.b.body;
  const double sign = joint.a.body >= 0 ? 1 : -1;  // the room is a: the opposite of what b gets
  const Vec<D> arm = place - (joint.a.body >= 0 ? a.x : b.x);
  each_side(row, [&](int side, const Vec<D>& along, const AngularVec<D>& angular) {
    if (side == body) load.n += sign * (angular - moment<D>(arm, along));
  });
  return load;
}

template <int D>
Wrench<D> coil_load(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
                    const std::type_identity_t<JointTurn<D>>& turn) {
  if (!joint.coil) return {};
  Row<D> row;
  double c = 0;
  free_row(joint, a, b, turn, row, c);
  const double rate =
      (row.along.dot(a.v) + row.angular_a.dot(a.w)) - (row.along.dot(b.v) + row.angular_b.dot(b.w));
  return load_on_a(joint, row, a, b) * joint.coil->force(c, rate);
}

namespace {

AngularVec<2> between(const Orientation<2>& a, const Orientation<2>& b) { return a - b; }
AngularVec<3> between(const Orientation<3>& a, const Orientation<3>& b) {
  return logarithm(composed<3>(inverse<3>(b), a));
}

}  // namespace

template <int D>
Made<D> as_it_stands(const Joint<D>& joint, const State<D>& state, std::size_t number) {
  const auto motion = [&](int body) { return body < 0 ? BodyMotion<D>() : body_motion(state, body); };
  const auto turn = [&](int body) {
    const int k = body < 0 ? -1 : turning(state, body);
    return k < 0 ? no_rotation<D>() : state.turn[std::size_t(k)];
  };
  const BodyMotion<D> a = motion(joint.a.body), b = motion(joint.b.body);
  Made<D> so;
  if (equations<D>(joint.kind).mechanism) {
    std::vector<BodyMotion<D>> all(state.x.size());
    each_body_held(joint, wound(state, number), [&](int body) {
      if (body >= 0) all[std::size_t(body)] = motion(body);
    });
    Row<D> J[kMostHeld<D>];
    double C[kMostHeld<D>];
    rows<D>(joint, number, state, all, J, C);
    so.turn = joint.turn;
    if (joint.kind == JointKind::pulley)
      so.length = joint.length - C[0];
    else if (D == 2)
      so.turn[0] += C[0];
    else
      so.length = joint.lower + C[0];
    return so;
  }
  const Vec<D> at = a.x + a.arm(joint.a.local);
  so.turn = between(turn(joint.a.body), turn(joint.b.body));
  if (equations<D>(joint.kind).apart)
    so.length = std::sqrt((at - b.x - b.arm(joint.b.local)).squaredNorm());
  else
    so.place = b.room_from_body.transpose() * (at - b.x);
  return so;
}

template <int D>
void join_as(Joint<D>& joint, const Made<D>& so) {
  joint.later = false;
  joint.turn = so.turn;
  if (equations<D>(joint.kind).apart)
    joint.length = joint.length > 0 ? std::max(joint.length, so.length) : so.length;
  else if (!equations<D>(joint.kind).mechanism)
    joint.b.local = so.place;
  else if (D == 3)
    joint.lower = so.length;
}

template const JointEquations<2>& equations<2>(JointKind);
template AngularVec<2> turn_between<2>(const Joint<2>&, const State<2>&);
template AngularVec<2> turn_between<2>(const Joint<2>&, std::size_t, const State<2>&);
template int rows<2>(const Joint<2>&, const BodyMotion<2>&, const BodyMotion<2>&, const JointTurn<2>&,
                     Row<2>*, double*, std::span<const BodyMotion<2>>);
template int rows<2>(const Joint<2>&, std::size_t, const State<2>&, std::span<const BodyMotion<2>>, Row<2>*,
                     double*);
template bool free_row<2>(const Joint<2>&, const BodyMotion<2>&, const BodyMotion<2>&, const JointTurn<2>&,
                          Row<2>&, double&);
template Wrench<2> load_on_a<2>(const Joint<2>&, const Row<2>&, const BodyMotion<2>&, const BodyMotion<2>&);
template Wrench<2> coil_load<2>(const Joint<2>&, const BodyMotion<2>&, const BodyMotion<2>&,
                                const JointTurn<2>&);
template const JointEquations<3>& equations<3>(JointKind);
template AngularVec<3> turn_between<3>(const Joint<3>&, const State<3>&);
template AngularVec<3> turn_between<3>(const Joint<3>&, std::size_t, const State<3>&);
template int rows<3>(const Joint<3>&, const BodyMotion<3>&, const BodyMotion<3>&, const JointTurn<3>&,
                     Row<3>*, double*, std::span<const BodyMotion<3>>);
template int rows<3>(const Joint<3>&, std::size_t, const State<3>&, std::span<const BodyMotion<3>>, Row<3>*,
                     double*);
template bool free_row<3>(const Joint<3>&, const BodyMotion<3>&, const BodyMotion<3>&, const JointTurn<3>&,
                          Row<3>&, double&);
template Wrench<3> load_on_a<3>(const Joint<3>&, const Row<3>&, const BodyMotion<3>&, const BodyMotion<3>&);
template Wrench<3> coil_load<3>(const Joint<3>&, const BodyMotion<3>&, const BodyMotion<3>&,
                                const JointTurn<3>&);

template Made<2> as_it_stands<2>(const Joint<2>&, const State<2>&, std::size_t);
template Made<3> as_it_stands<3>(const Joint<3>&, const State<3>&, std::size_t);
template void join_as<2>(Joint<2>&, const Made<2>&);
template void join_as<3>(Joint<3>&, const Made<3>&);

}  // namespace obscura::sim
