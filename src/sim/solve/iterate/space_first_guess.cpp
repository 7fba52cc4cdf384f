// What contacts of space begin a substep with: what each wants of it, and the forces that it had in the last.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

// what each touch wants of the step, and the forces it had in the last
void SpaceIterative::warm_start_contacts(const State<D>& state, double h) {
  const int count = int(touches_.size());
  known_force_.resize(touches_.size()), free_slips_.resize(touches_.size());
  find_middles(state, h);
  each(workers(), count, kTouchPiece, [&](int begin, int end) { set_aims(begin, end, state, h); });
  share_loads();
  order_blows(h);
  closing_.assign(model_.bodies.size() + 1, 0), all_.resize(touches_.size());
  std::iota(all_.begin(), all_.end(), 0);
  for (const ContactConstraint& touch : touches_)
    if (touch.closing) closing_[touch.a] = closing_[touch.b] = 1;
  batches_.sort(touches_, all_, moving_);
  batches_.each_pair([&](int first, int end) {
    for (int i = first; i < end; ++i) {
      const ContactConstraint& touch = touches_[i];
      if (known_force_[i]) push(touch, touch.normal_impulse * touch.n + touch.tangent_impulse);
    }
  });
  each(workers(), count, kTouchPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) foresee_slip(i);
  });
}

// Whether a touch that closes with `before` m/s ends faster than it goes on the way, and so meets only after
// the substep: its row sees the end alone.
bool SpaceIterative::meets_later(const ContactConstraint& touch, double before, double h) const {
  const double ends = touch.n.dot(slip(touch) - touch.belt - touch.drift);
  return touch.gap + h * ends < 0 && touch.gap + 0.5 * h * (before + ends) > 0;
}

// of touches from `begin` on before `end`
void SpaceIterative::set_aims(int begin, int end, const State<D>& state, double h) {
  static const BodyMotion<D> room;
  const int n = int(model_.bodies.size());
  auto known = std::lower_bound(state.contacts.begin(), state.contacts.end(), touches_[begin].key,
                                [](const auto& contact, const ContactKey& key) { return contact.key < key; });
  for (int i = begin; i < end; ++i) {
    ContactConstraint& touch = touches_[i];
    known_force_[i] = 0;
    const BodyMotion<D>& b = touch.b == n ? room : stances_[touch.b];
    const Vec<D> passes = stances_[touch.a].velocity(touch.arm_a) - b.velocity(touch.arm_b);
    const double before = touch.n.dot(passes);
    touch.rate = touch.per_width * std::sqrt(passes.squaredNorm());
    while (known != state.contacts.end() && known->key < touch.key) ++known;
    const bool known_one = known != state.contacts.end() && known->key == touch.key;
    const bool lasting = known_one && lasts(touch, known->force);
    touch.slides = lasting && !touch.after && slides_on(touch, known->force, passes, h);
    if (touch.after) {
      // what is left of the step
    } else if (!lasting && before < -strike_speed(touch) && touch.gap + h * (before - g_ * h) < 0) {
      touch.least = touch.passes ? kNoAim : -touch.bounce * before;
      touch.blow = !touch.passes;
      touch.bounces = !touch.passes && touch.bounce > 0;
      touch.closes = std::clamp(-touch.gap / before, 0.0, h);
      touch.closing = !touch.passes && touch.bounce == 0;
    } else if (!lasting && before < -strike_speed(touch) && meets_later(touch, before, h)) {
      touch.least = kNoAim;
    } else {
      touch.least = std::min(-touch.gap / h, 0.0);
      touch.closing = !lasting && before < -0.05 * restitution_threshold_ && touch.gap + h * before < 0;
    }
    if (touch.gap * touch.per_width < kNearby && (touch.rests || !touch.after) && !strikes(touch, passes))
      center(i, known_one && touch.n.dot(known->force) > 0);
    if (touch.slides) {
      free_slips_[i] = slip(touch);
      const Vec<D> changes = free_slips_[i] - touch.belt - passes;
      touch.half_change = 0.5 * (changes - touch.n * touch.n.dot(changes));
    }
    if (!known_one) continue;
    touch.before = known->force;
    touch.normal_impulse = std::max(0.0, h * known->force.dot(touch.n));
    touch.tangent_impulse = h * (known->force - touch.n * touch.n.dot(known->force));
    const double size = std::sqrt(touch.tangent_impulse.squaredNorm()),
                 most = touch.mu * touch.normal_impulse;
    if (size > most) touch.tangent_impulse *= most / size;
    known_force_[i] = 1;
  }
}

// Contacts of a pair neither of whose bodies turns have the same row, and any shares of the load hold it:
// each begins with as much, or iterations leave all to the first, and only that one would rub.
void SpaceIterative::share_loads() {
  constexpr double kSame = 1e-9;  // of normals
  const auto turns = [&](int body) { return !moving_[body].inverse_inertia.isZero(0); };
  const int count = int(touches_.size());
  for (int first = 0, end = 0; first < count; first = end) {
    const ContactConstraint& one = touches_[first];
    double load = 0;
    bool alike = !turns(one.a) && !turns(one.b);
    for (; end < count && touches_[end].a == one.a && touches_[end].b == one.b; ++end) {
      alike = alike && known_force_[end] && touches_[end].n.dot(one.n) > 1 - kSame;
      load += touches_[end].normal_impulse;
    }
    if (!alike || end - first < 2) continue;
    for (int i = first; i < end; ++i) touches_[i].normal_impulse = load / (end - first);
  }
}

void SpaceIterative::moderate_warm_start() {
  if (!warm_start_.gave(moving_, bounding_radius_)) return;
  const auto each_pair = [&](auto&& act) {
    for (const ContactConstraint& touch : touches_) {
      if (touch.normal_impulse > 0) act(touch.a, touch.b);
    }
  };
  if (!warm_start_.moderate(
          moving_, each_pair, [&](int body) { return shares_forces(body); },
          [&](int body) { return stances_[std::size_t(body)].room_from_body; }))
    return;
  for (ContactConstraint& touch : touches_) {
    const int body = moving_[touch.a].inverse_mass > 0 ? touch.a : touch.b;
    if (moving_[body].inverse_mass == 0) continue;
    const double share = warm_start_.share(body);
    touch.normal_impulse *= share, touch.tangent_impulse *= share;
  }
}

}  // namespace obscura::sim
