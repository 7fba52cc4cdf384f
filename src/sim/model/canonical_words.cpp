#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sim/model/state.h"

namespace obscura::sim {

namespace {

struct Words {
  std::vector<std::uint64_t> all;

  void integer(std::int64_t n) { all.push_back(std::uint64_t(n)); }
  void number(double x) { all.push_back(x == 0 ? 0 : std::bit_cast<std::uint64_t>(x)); }
  template <int N>
  void numbers(const Eigen::Matrix<double, N, 1>& v) {
    for (int i = 0; i < N; ++i) number(v[i]);
  }
  template <int N>
  void list(const std::vector<Eigen::Matrix<double, N, 1>>& vectors) {
    integer(std::int64_t(vectors.size()));
    for (const auto& v : vectors) numbers<N>(v);
  }
};

}  // namespace

template <int D>
std::vector<std::uint64_t> words(const State<D>& state) {
  Words w;
  w.integer(state.step);
  w.number(state.beyond);
  w.list(state.x);
  w.list(state.v);
  w.list(state.turn);
  w.list(state.spin);
  w.integer(std::int64_t(state.grips.size()));
  for (const Grip<D>& grip : state.grips) {
    w.integer(grip.body);
    w.template numbers<D>(grip.local);
  }
  w.integer(std::int64_t(state.touches.size()));
  for (const Touch<D>& touch : state.touches) {
    w.integer(touch.body);
    w.integer(touch.wall);
    w.template numbers<D>(touch.point);
    w.template numbers<D>(touch.impulse);
  }
  w.integer(std::int64_t(state.contacts.size()));
  for (const Contact<D>& contact : state.contacts) {
    w.integer(contact.key.a);
    w.integer(contact.key.b);
    w.integer(contact.key.feature);
    w.integer(std::int64_t(contact.touching));
    w.template numbers<D>(contact.force);
    w.template numbers<D>(contact.impulse);
  }
  w.integer(std::int64_t(state.frozen.size()));
  for (std::size_t i = 0; i < state.frozen.size(); ++i) {
    w.integer(state.frozen[i]);
    w.number(state.quiet[i]);
  }
  w.integer(std::int64_t(state.broken.size()));
  for (const char broken : state.broken) w.integer(broken);
  w.list(state.joint_forces);
  if constexpr (D == 3) {
    for (const BodySpin<D>& own : state.body_spin) {
      w.template numbers<kAngular<D>>(own.w);
      w.template numbers<kAngular<D>>(own.residual);
    }
  }
  for (const Blast<D>& blast : state.blasts) {
    w.integer(blast.on);
    w.list(blast.forces);
    w.list(blast.torques);
  }
  for (const ChainState& posture : state.chain_states) {
    for (const double x : posture.q) w.number(x);
    for (const double x : posture.v) w.number(x);
  }
  for (const double work : state.work) w.number(work);
  for (const char released : state.released) w.integer(released);
  if (!state.events.on.empty()) {
    for (const char on : state.events.on) w.integer(on);
    for (const char done : state.events.done) w.integer(done);
    w.integer(std::int64_t(state.events.happenings.size()));
    for (const Happening& it : state.events.happenings) {
      w.integer(it.when), w.integer(it.which), w.integer(it.step);
      w.number(it.fraction);
    }
    w.integer(std::int64_t(state.events.changes.size()));
    for (const int change : state.events.changes) w.integer(change);
    w.integer(state.events.stopped);
  }
  for (const int piece : state.on_piece) w.integer(piece);
  // the rest of it is said by the poses
  for (std::size_t i = 0; i < state.wound.size(); ++i) {
    const auto rounds = [](double angle) { return std::llround(angle / (2 * std::numbers::pi)); };
    const std::int64_t a = rounds(state.wound[i].a), b = rounds(state.wound[i].b);
    if (a != 0 || b != 0) w.integer(std::int64_t(i)), w.integer(a), w.integer(b);
    const Wound& it = state.wound[i];
    if (it.drag != 0) w.number(it.drag);
    if (it.off_a == 0 && it.off_b == 0 && it.with == 0 && it.given == 0) continue;
    w.integer(std::int64_t(i)), w.integer(it.off_a), w.integer(it.off_b), w.integer(it.with);
    w.number(it.given);
  }
  for (const WheelLeft& it : state.wheels_left)
    w.integer(it.joint), w.integer(it.wheel), w.integer(std::llround(it.wrap / (2 * std::numbers::pi)));
  for (const Made<D>& it : state.made) {
    w.template numbers<D>(it.place);
    w.template numbers<kAngular<D>>(it.turn);
    w.number(it.length);
  }
  for (const char intact : state.intact) w.integer(intact);
  for (const PartPose<D>& pose : state.part_poses) {
    w.template numbers<D>(pose.x);
    w.template numbers<Orientation<D>::RowsAtCompileTime>(pose.turn);
  }
  for (const State<D>& bonded : state.bonded) {
    const std::vector<std::uint64_t> more = words(bonded);
    w.all.insert(w.all.end(), more.begin(), more.end());
  }
  w.number(state.ledger.displacement);
  w.number(state.ledger.impacts);
  return w.all;
}

template std::vector<std::uint64_t> words<2>(const State<2>&);
template std::vector<std::uint64_t> words<3>(const State<3>&);

}  // namespace obscura::sim
