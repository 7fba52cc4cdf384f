// Free motion in space. Forces that depend on the motion see that under the forces that contacts had last.
// These are taken out again, so that the iterations find them anew.

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/math/exponential.h"
#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

constexpr double kLasts = 2;  // times what it was before: a force that is more was of a blow
constexpr double kMoves = 4;  // of what a push moves a centre by, how far it moves what is pushed

Vec<3> lasting(const Contact<3>& contact) {
  const double now = contact.force.squaredNorm(), before = kLasts * kLasts * contact.before.squaredNorm();
  return now <= before ? contact.force : Vec<3>(std::sqrt(before / now) * contact.force);
}

}  // namespace

// the contacts that bore in the last substep
void SpaceIterative::find_bearing(const State<D>& state, double h) {
  begin_bearing(state);
  const int n = int(model_.bodies.size());
  bearing_touches_.clear(), rubbed_.assign(std::size_t(n) + 1, 0);
  auto known = state.contacts.begin();
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const ContactConstraint& touch = touches_[i];
    if (!bears(touch.a, touch.b)) continue;
    while (known != state.contacts.end() && known->key < touch.key) ++known;
    if (known == state.contacts.end()) break;
    if (known->key != touch.key || known->force.isZero(0) || known->before.isZero(0)) continue;
    PersistentContact<D>& contact = bearing_.emplace_back();
    contact.a = touch.a, contact.b = touch.b == n ? -1 : touch.b;
    contact.gap = features_[i], contact.belt = touch.belt;
    contact.normal = touch.n, contact.point = touch.point, contact.force = lasting(*known);
    contact.begin(stances_[std::size_t(touch.a)]);
    const double pressed = touch.n.dot(contact.force);
    const Vec<D> rubs = contact.force - pressed * touch.n;
    contact.slides = rubs_fully(touch, contact.force);
    for (const int body : {touch.a, touch.b})
      rubbed_[std::size_t(body)] += moving_[body].inverse_mass * std::sqrt(rubs.squaredNorm());
    bearing_touches_.push_back(int(i));
  }
  // as long as friction, of all that rubs there, does not bring it to rest
  for (std::size_t k = 0; k < bearing_.size(); ++k) {
    const ContactConstraint& touch = touches_[std::size_t(bearing_touches_[k])];
    const Vec<D> slips = slip(touch);
    const double stops = kMoves * h * (rubbed_[std::size_t(touch.a)] + rubbed_[std::size_t(touch.b)]);
    bearing_[k].slides =
        bearing_[k].slides && (slips - touch.n * touch.n.dot(slips)).squaredNorm() > stops * stops;
  }
  find_borne(state, h);
}

void SpaceIterative::gather_bodies(const State<D>& state) {
  dynamics_.gather(state, true);
  dynamics_.bear(state, bearing_);
  stages_.reserve(std::size_t(dynamics_.size()));
}

// friction of what slides, into borne_, as it is at the end of the free motion
void SpaceIterative::turn_friction(const State<D>& state) {
  const auto slides = [](const PersistentContact<D>& contact) { return contact.slides; };
  if (std::none_of(bearing_.begin(), bearing_.end(), slides)) return;
  for (PersistentContact<D>& contact : bearing_) {
    if (!contact.slides) continue;
    const Vec<D> force = contact.ended(body_motion(state, contact.a),
                                       contact.b < 0 ? BodyMotion<D>() : body_motion(state, contact.b));
    // in place of friction against the slip with which the step begins
    const Vec<D> more =
        force - contact.ended(begun(contact.a), contact.b < 0 ? BodyMotion<D>() : begun(contact.b));
    add_borne(contact.a, more, Vec<D>(contact.point - begun(contact.a).x));
    if (contact.b >= 0) add_borne(contact.b, -more, Vec<D>(contact.point - begun(contact.b).x));
  }
}

// of h^2 times an acceleration, what the scheme moves a body by
double SpaceIterative::leads() const {
  if (model_.integrator == Integrator::euler) return 0;
  return model_.integrator == Integrator::semi_implicit ? 1 : 0.5;
}

// Of what is on joints they stay in: a joint's forces answer them.
void SpaceIterative::take_out_contacts(State<D>& state, double h) {
  turn_friction(state);
  const int n = int(model_.bodies.size());
  for (int i = 0; i < n; ++i) {
    if (!gives(i) || joints_.has(i)) continue;
    const int k = turning(state, i);
    take_out(i, h, state.x[std::size_t(i)], state.v[std::size_t(i)],
             k < 0 ? nullptr : &state.turn[std::size_t(k)], k < 0 ? nullptr : &state.spin[std::size_t(k)]);
  }
}

// the same of one body, and of where it is at the end of the free motion
void SpaceIterative::take_out(int body, double h, Vec<D>& x, Vec<D>& v, Orientation<D>* turn,
                              AngularVec<D>* spin) const {
  const Twist<D>& its = borne_[std::size_t(body)];
  v -= h * its.v, x -= leads() * h * h * its.v;
  if (!turn) return;
  // as place() gives it back: angular momentum stays where a body turns
  const AngularVec<D>&inertia = model_.bodies[std::size_t(body)].inertia, change = h * its.w;
  const Rotation<D> with = rotation<D>(*turn);
  *turn = turned<D>(*turn, AngularVec<D>(-leads() * h * change));
  const Rotation<D> now = rotation<D>(*turn);
  *spin = carried_spin<D>(inertia, with, now, *spin) -
          carried_spin<D>(inertia, stances_[std::size_t(body)].room_from_body, now, change);
}

// By the scene's scheme, which for the whole step is shared out where it is of first order: of Euler's or the
// semi-implicit one five substeps would be another motion. Bodies on joints go by substeps.
void SpaceIterative::move_unconstrained(StepPart<D> part) {
  State<D>& state = part.state;
  const bool shared =
      joints_.empty() && substeps_ > 1 &&
      (model_.integrator == Integrator::euler || model_.integrator == Integrator::semi_implicit);
  if (varies_ && (part.substep == 0 || !shared)) find_bearing(state, shared ? substeps_ * part.h : part.h);
  double work = 0;
  if (shared) {
    if (part.substep == 0) work = integrate_step(part);
    share_free_motion(state, part.h);
  } else if (joints_.empty()) {
    gather_bodies(state);
    dynamics_.step(integrate(model_.integrator), state, part.t, part.h, stages_);
    work = dynamics_.work();
    take_out_contacts(state, part.h);
  } else {
    gather_bodies(state);
    poses_to_joints();
    work = joints_.step(dynamics_, integrate(model_.integrator), state, part.t, part.h, stages_);
    take_out_contacts(state, part.h);
  }
  if (!state.work.empty()) state.work[0] += work;
  move_driven(state, part.t, part.h);
  v_free_ = state.v, w_free_ = state.spin, x_free_ = state.x, turn_free_ = state.turn;
  energy_guard_.open(state);
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (inactive_[i]) continue;
    moving_[i].v = state.v[i];
    if (const int k = turning(state, i); k >= 0) moving_[i].w = state.spin[k];
  }
}

// gains_ and bends_: by how much the scheme changes each velocity in the step without contacts, and leads
// each body aside of the mean velocity's way. The work of forces, J.
double SpaceIterative::integrate_step(StepPart<D> part) {
  State<D>& state = part.state;
  const double h = substeps_ * part.h;
  gather_bodies(state);
  const std::vector<Vec<D>> v = state.v, w = state.spin;
  const std::vector<Orientation<D>> turn = state.turn;
  const std::vector<BodySpin<D>> own = state.body_spin;
  dynamics_.step(integrate(model_.integrator), state, part.t, h, stages_);
  turn_friction(state);
  const std::size_t n = v.size(), turning = w.size();
  gains_.resize(n), bends_.resize(n), spin_gains_.resize(turning), turn_bends_.resize(turning);
  for (std::size_t i = 0; i < n; ++i) {
    gains_[i] = state.v[i] - v[i];
    bends_[i] = state.x[i] - x_[i] - h * (v[i] + 0.5 * gains_[i]);
    if (gives(int(i))) gains_[i] -= h * borne_[i].v, bends_[i] -= (leads() - 0.5) * h * h * borne_[i].v;
  }
  for (std::size_t k = 0; k < turning; ++k) {
    spin_gains_[k] = state.spin[k] - w[k];
    const auto mean = turned<D>(turn[k], AngularVec<D>(h * (w[k] + 0.5 * spin_gains_[k])));
    turn_bends_[k] = logarithm(product(state.turn[k], inverse<D>(mean)));
    if (!gives(int(n - turning + k))) continue;
    const AngularVec<D>& its = borne_[n - turning + k].w;
    spin_gains_[k] -= h * its, turn_bends_[k] -= (leads() - 0.5) * h * h * its;
  }
  state.x = x_, state.v = v, state.spin = w, state.turn = turn, state.body_spin = own;
  return dynamics_.work();
}

// the part of these that falls to a substep of h s
void SpaceIterative::share_free_motion(State<D>& state, double h) {
  const double part = 1 / double(substeps_);
  const std::size_t still = state.v.size() - state.spin.size();
  const auto share = [&](std::size_t i) {
    if (inactive_[i]) return;
    const Vec<D> gain = part * gains_[i];
    state.x[i] += h * (state.v[i] + 0.5 * gain) + part * bends_[i];
    state.v[i] += gain;
    if (i < still) return;
    const std::size_t k = i - still;
    const AngularVec<D> more = part * spin_gains_[k];
    state.turn[k] =
        turned<D>(state.turn[k], AngularVec<D>(h * (state.spin[k] + 0.5 * more) + part * turn_bends_[k]));
    state.spin[k] += more;
  };
  each(workers(), int(state.v.size()), kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) share(std::size_t(i));
  });
}

}  // namespace obscura::sim
