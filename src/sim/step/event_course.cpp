// Conditions are looked for along the course of a step, which solvers note as cubics between impacts:
//   s(t) = n . (x(t) - p)          crosses: all roots of the cubic, from one extremum to the next
// and as the spans for which two touch.

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/collide/pair_candidates.h"
#include "sim/constraint/row.h"
#include "sim/model/drives.h"
#include "sim/step/events.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

namespace {

constexpr double kSmooth = 0.2;      // of its speeds: how far they differ in a smooth step
constexpr double kLettingGo = 1e-5;  // of a step

// how fast the gap of a row opens, m/s
template <int D>
double opening(const Row<D>& J, const BodyMotion<D>& a, const BodyMotion<D>& b) {
  return J.along.dot(a.v - b.v) + J.angular_a.dot(a.w) - J.angular_b.dot(b.w);
}

// how fast the rim of a body goes as it turns, m/s; of a wall not at all
template <int D>
double way_of_rim(const Model<D>& model, int body, const BodyMotion<D>& at) {
  return body < 0 ? 0
                  : bounding_radius(model.bodies[std::size_t(body)].shape) * std::sqrt(at.w.squaredNorm());
}

}  // namespace

// finds all that becomes true in the course at hand, from begun_ to `state`, or of it the touches of what is
// joined by them, which are known at any time
template <int D>
void Events<D>::find(const State<D>& state, double from, double to, bool only_joining) {
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    if (only_joining && !joins(when)) continue;
    switch (when.on) {
      case On::touches:
      case On::leaves:
        find_touches(state, w, from, to);
        break;
      case On::crosses:
        find_crossings(state, w, from, to);
        break;
      case On::value:
        find_values(state, w, from, to);
        break;
      case On::breaks:
        find_breaks(state, w, from, to);
        break;
      case On::time:
        break;
    }
  }
}

template <int D>
void Events<D>::find_times(const State<D>& state, double from, double to) {
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    if (model_.whens[std::size_t(w)].on != On::time || state.events.done[std::size_t(w)]) continue;
    const TimeStamp at = times_[std::size_t(w)];
    double fraction = -1;
    if (at.step == state.step) fraction = at.fraction;
    if (at == TimeStamp{state.step + 1, 0}) fraction = 1;
    if (fraction > from && fraction <= to) found_.push_back({fraction, w, 0, true, 0});
  }
}

template <int D>
void Events<D>::find_breaks(const State<D>& state, int w, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(w)];
  for (int k = 0; k < int(when.those.size()); ++k) {
    const int joint = when.those[std::size_t(k)];
    if (!broken(state, joint) || state.events.on[std::size_t(slot(w, k))]) continue;
    double at = to;
    for (const auto& it : course_.breaks)
      if (exact_ && it.joint == joint) at = std::min(to, from + it.at / step_length(model_.rate));
    found_.push_back({at, w, k, true, 0});
  }
}

// spans_ of a pair in the course at hand
template <int D>
void Events<D>::spans(const State<D>& state, std::pair<int, int> pair, bool touched, double from, double to) {
  meet(state, pair, touched, from, to);
  if (!touched || !iterates_ || to < 1) return;
  // what touched, and bears again within the step, was not away
  if (!spans_.empty()) spans_.front().begun = from;
  if ((!spans_.empty() && to - spans_.back().ended <= kSameInstant) || !returns(state, pair)) return;
  if (spans_.empty())
    spans_.push_back({from, to});
  else
    spans_.back().ended = to;
}

// spans_ as they are told
template <int D>
void Events<D>::meet(const State<D>& state, std::pair<int, int> pair, bool touched, double from, double to) {
  spans_.clear();
  const double h = step_length(model_.rate);
  const auto before = [](const auto& it, std::pair<int, int> of) { return std::pair(it.a, it.b) < of; };
  for (auto it = std::lower_bound(course_.meetings.begin(), course_.meetings.end(), pair, before);
       it != course_.meetings.end() && std::pair(it->a, it->b) == pair; ++it)
    spans_.push_back({std::min(to, from + it->begun / h), std::min(to, from + it->ended / h)});
  if (spans_.empty()) {
    bool holds = false, struck = false;
    auto contact = state.contacts.begin();
    // those of bonded parts are in another order
    const bool sorted = model_.bonds.empty();
    if (sorted)
      contact = std::lower_bound(
          contact, state.contacts.end(), pair,
          [](const Contact<D>& it, std::pair<int, int> of) { return std::pair(it.key.a, it.key.b) < of; });
    for (; contact != state.contacts.end(); ++contact) {
      const bool its = std::pair(contact->key.a, contact->key.b) == pair;
      if (sorted && !its) break;
      holds = holds || (its && contact->touching != ContactMode::open);
      struck = struck || (its && !contact->impulse.isZero(0));
    }
    // by the handout's law what rests is struck in each step
    for (const Touch<D>& touch : state.touches)
      holds = holds || (touch.body == pair.first && -1 - touch.wall == pair.second);
    if (holds) spans_.push_back({touched ? from : to, to});
    if (!holds && struck) spans_.push_back({to, to});
    return;
  }
  std::sort(spans_.begin(), spans_.end(), [](const Span& a, const Span& b) { return a.begun < b.begun; });
  // what sleeps holds until something strikes it
  const auto stays = [&](int body) {
    return body < 0 || model_.bodies[std::size_t(body)].fixed ||
           (std::size_t(body) < begun_.frozen.size() && begun_.frozen[std::size_t(body)]);
  };
  if (touched && stays(pair.first) && stays(pair.second))
    spans_.insert(spans_.begin(), {from, spans_.front().begun});
  std::size_t kept = 0;
  for (std::size_t i = 1; i < spans_.size(); ++i) {
    if (spans_[i].begun - spans_[kept].ended <= kSameInstant)
      spans_[kept].ended = std::max(spans_[kept].ended, spans_[i].ended);
    else
      spans_[++kept] = spans_[i];
  }
  spans_.resize(kept + 1);
  // what has just left is held for a moment more, see ExactSolver::note_contacts
  const Span& first = spans_.front();
  if (!touched && first.begun - from <= kSameInstant && first.ended > first.begun &&
      first.ended - first.begun < kLettingGo)
    spans_.erase(spans_.begin());
}

// Whether two that touched, and bear nothing at the end of a step, do so only because a step is straight
// where their way is curved: by gravity, the motion of what is moved and their way, a = J a0 + J' v < 0, the
// gap closes again within a step, J v + a h < 0, and it is as small as that makes it, |a| h^2.
template <int D>
bool Events<D>::returns(const State<D>& state, std::pair<int, int> pair) {
  const Model<D>& model = stepper_->model(state);
  const double h = step_length(model.rate), ends = time({begun_.step + 1, 0}, model.rate);
  const int a = pair.first, b = pair.second;
  const BodyMotion<D> one = body_motion(state, a), other = b < 0 ? BodyMotion<D>() : body_motion(state, b);
  const auto near = pair_candidates(model, state, a, b, std::sqrt(model.gravity.squaredNorm()) * h * h);
  const double falls =
      (model.bodies[std::size_t(a)].fixed ? 0 : 1) - (b < 0 || model.bodies[std::size_t(b)].fixed ? 0 : 1);
  return std::any_of(near.begin(), near.end(), [&](const ContactCandidate<D>& gap) {
    Row<D> J[D];
    const EvaluatedContact<D> now = rows(gap, one, other, J);
    double a_n = falls * J[0].along.dot(model.gravity) + J[0].velocity_product;
    Drives<D>& drives = stepper_->drives_;
    if (const int i = drives.number(a); i >= 0) {
      const DrivenMotion<D> moved = drives.at(i, ends);
      a_n += J[0].along.dot(moved.a) + J[0].angular_a.dot(moved.alpha);
    }
    if (const int i = drives.number(b); i >= 0) {
      const DrivenMotion<D> moved = drives.at(i, ends);
      a_n -= J[0].along.dot(moved.a) + J[0].angular_b.dot(moved.alpha);
    }
    return a_n < 0 && opening(J[0], one, other) + a_n * h < 0 && now.value <= -a_n * h * h;
  });
}

template <int D>
void Events<D>::find_touches(const State<D>& state, int w, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(w)];
  for (int k = 0; k < int(when.pairs.size()); ++k) {
    if (joins(when) && joined(begun_, when, k)) continue;
    bool touched = state.events.on[std::size_t(slot(w, k))] != 0;
    spans(state, when.pairs[std::size_t(k)], touched, from, to);
    const auto met = [&](double at) {
      if (when.on == On::touches) found_.push_back({exact_ ? at : to, w, k, true, 0});
    };
    const auto left = [&](double at) {
      if (when.on == On::leaves) found_.push_back({exact_ ? at : to, w, k, true, 0});
    };
    double ended = from;
    // two that stand at each other with a gap of rounding touch from the start, before they press
    if (touched && begun_.step == 0 && from == 0 && !spans_.empty()) ended = spans_.front().begun;
    for (const Span& span : spans_) {
      if (touched && span.begun - ended > kSameInstant) left(ended), touched = false;
      if (!touched) met(span.begun);
      touched = true, ended = span.ended;
    }
    if (touched && to - ended > kSameInstant) left(ended);
  }
}

// whether two are joined when they come to touch
template <int D>
bool Events<D>::joins(const When<D>& when) const {
  if (when.on != On::touches) return false;
  for (const Action& action : when.actions)
    for (const int of : action.of)
      if (action.what == Action::Do::change && of >= 0 &&
          model_.changes[std::size_t(of)].of == Change<D>::Of::join)
        return true;
  return false;
}

// The instant at which two that will be joined come to touch: they are not to bounce first. Where the course
// knows it, they are held apart by up to a gap that is taken for none, which is why it is looked for from
// there back.
template <int D>
void Events<D>::search_touch(Found& found, double from, double to) {
  const std::pair<int, int> pair = model_.whens[std::size_t(found.when)].pairs[std::size_t(found.which)];
  const Course<D> known = course_;
  bool fails = false;
  const auto touch_until = [&](double part) {
    course_.clear();
    tried_ = begun_;
    fails = stepper_->go(tried_, from, part).has_value();
    sort_meetings();
    if (!fails) spans(tried_, pair, false, from, part);
    return !fails && !spans_.empty();
  };
  if (exact_) {
    double before = kBefore;
    while (found.at - before > from && touch_until(found.at - before)) before *= 4;
    if (!fails) found.before = std::min(before, found.at - from);
  } else {
    double low = from, high = to;
    while (high - low > kTouchTime && !fails) {
      const double middle = 0.5 * (low + high);
      (touch_until(middle) ? high : low) = middle;
    }
    found.at = high, found.before = high - low;
  }
  course_ = known;
}

// Two that are joined when they come to touch do so for their other conditions in the same instant: joined,
// they touch no more.
template <int D>
void Events<D>::touch_with_these(const State<D>& state) {
  const std::size_t many = exact_ ? 0 : found_.size();
  for (std::size_t i = 0; i < many; ++i) {
    const Found joined = found_[i];
    if (!joins(model_.whens[std::size_t(joined.when)])) continue;
    const auto pair = model_.whens[std::size_t(joined.when)].pairs[std::size_t(joined.which)];
    for (int w = 0; w < int(model_.whens.size()); ++w) {
      const When<D>& when = model_.whens[std::size_t(w)];
      for (int k = 0; when.on == On::touches && k < int(when.pairs.size()); ++k) {
        if (w == joined.when || when.pairs[std::size_t(k)] != pair ||
            state.events.on[std::size_t(slot(w, k))])
          continue;
        const auto its = std::find_if(found_.begin(), found_.end(),
                                      [&](const Found& it) { return it.when == w && it.which == k; });
        Found& touch = its == found_.end() ? found_.emplace_back() : *its;
        touch.at = joined.at, touch.when = w, touch.which = k, touch.exact = true,
        touch.before = joined.before;
      }
    }
  }
}

// What is to be joined and comes to touch a moment from now joins with what does now: it would bounce in the
// jerk of that.
template <int D>
void Events<D>::join_with_these(State<D>& state, TimeStamp at, std::vector<Due>& actions) {
  if (exact_ || std::none_of(actions.begin(), actions.end(),
                             [](const Due& due) { return due.action->what == Action::Do::change; }))
    return;
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    for (int k = 0; joins(when) && k < int(when.pairs.size()); ++k) {
      char& on = state.events.on[std::size_t(slot(w, k))];
      if (on || joined(state, when, k) || !meets(state, when.pairs[std::size_t(k)])) continue;
      on = 1;
      if (!note_fired(state, Found{at.fraction, w, k, true, 0}, at)) continue;
      for (const Action& action : when.actions) actions.push_back({&action, k});
    }
  }
}

// whether a pair is held together by a joint that its touch makes
template <int D>
bool Events<D>::joined(const State<D>& state, const When<D>& when, int pair) const {
  for (const Action& action : when.actions) {
    if (action.what != Action::Do::change) continue;
    for (std::size_t i = 0; i < action.of.size(); ++i) {
      if (action.of[i] < 0 || (action.of_pair && int(i) != pair)) continue;
      const Change<D>& made = model_.changes[std::size_t(action.of[i])];
      if (made.of == Change<D>::Of::join && !state.broken[std::size_t(made.index)]) return true;
    }
  }
  return false;
}

// whether two that are apart touch within a moment
template <int D>
bool Events<D>::meets(const State<D>& state, std::pair<int, int> pair) const {
  const auto [a, b] = pair;
  const BodyMotion<D> one = body_motion(state, a), other = b < 0 ? BodyMotion<D>() : body_motion(state, b);
  const double moment = 4 * kTouchTime * step_length(model_.rate);
  const double fast =
      std::sqrt((one.v - other.v).squaredNorm()) + way_of_rim(model_, a, one) + way_of_rim(model_, b, other);
  const auto near = pair_candidates(model_, state, a, b, moment * fast + kTouchingGap * model_.scale);
  return std::any_of(near.begin(), near.end(), [&](const ContactCandidate<D>& gap) {
    Row<D> J[D];
    rows(gap, one, other, J);
    return opening(J[0], one, other) < 0;
  });
}

// how a body stands at a fraction of the step within the course at hand, on the piece that has `inside`
template <int D>
Instant<D> Events<D>::pose_at(const State<D>& state, int body, double from, double to, double at,
                              double inside) const {
  const double t = seconds(at - from), middle = seconds(inside - from);
  const auto& pieces = course_.pieces[std::size_t(body)];
  for (const CoursePiece<D>& piece : pieces)
    if (middle <= piece.ended) return piece.at(t);
  if (!pieces.empty()) return pieces.back().at(t);
  const CoursePiece<D> whole{0, seconds(to - from), instant(begun_, body), instant(state, body)};
  Instant<D> it = whole.at(t);
  // struck on its way, as far as is known: a cubic would go far beyond both ends
  const double jump = std::sqrt((whole.to.v - whole.from.v).squaredNorm()),
               fast = std::sqrt(whole.from.v.squaredNorm()) + std::sqrt(whole.to.v.squaredNorm()),
               fall = whole.ended * std::sqrt(model_.gravity.squaredNorm());
  if (whole.ended > 0 && jump > kSmooth * fast + 4 * fall) {
    const double s = t / whole.ended;
    it.x = whole.from.x + s * (whole.to.x - whole.from.x);
    it.v = whole.from.v + s * (whole.to.v - whole.from.v);
  }
  return it;
}

// knots_: where smooth pieces of any of these bodies end, fractions of the step, with both ends
template <int D>
void Events<D>::stretches(const std::vector<int>& bodies, double from, double to) {
  const double h = step_length(model_.rate);
  knots_.assign({from, to});
  for (const int body : bodies)
    for (const CoursePiece<D>& piece : course_.pieces[std::size_t(body)])
      knots_.push_back(std::clamp(from + piece.ended / h, from, to));
  std::sort(knots_.begin(), knots_.end());
  std::size_t kept = 0;
  for (std::size_t i = 1; i < knots_.size(); ++i)
    if (knots_[i] - knots_[kept] > 1e-15) knots_[++kept] = knots_[i];
  knots_.resize(kept + 1);
  knots_.back() = to;
}

// the signed distance of a place from the line or plane of a gate, m
template <int D>
double Events<D>::side_of(const When<D>& when, const Vec<D>& x) const {
  if constexpr (D == 2) {
    const Vec<D> along = when.to - when.from, from = x - when.from;
    return (along[0] * from[1] - along[1] * from[0]) / std::sqrt(along.squaredNorm());
  } else {
    for (int axis = 0; axis < D; ++axis)
      if (when.from[axis] == when.to[axis]) return x[axis] - when.from[axis];
    return 0;
  }
}

// whether a place on it is between its ends
template <int D>
bool Events<D>::within(const When<D>& when, const Vec<D>& x) const {
  if constexpr (D == 2) {
    const Vec<D> along = when.to - when.from;
    const double part = along.dot(x - when.from);
    return part >= 0 && part <= along.squaredNorm();
  } else {
    for (int axis = 0; axis < D; ++axis) {
      const double low = std::min(when.from[axis], when.to[axis]),
                   high = std::max(when.from[axis], when.to[axis]);
      if (low < high && (x[axis] < low || x[axis] > high)) return false;
    }
    return true;
  }
}

template <int D>
void Events<D>::find_crossings(const State<D>& state, int w, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(w)];
  for (int k = 0; k < int(when.those.size()); ++k) {
    const int body = when.those[std::size_t(k)];
    char side = state.events.on[std::size_t(slot(w, k))];
    const auto place = [&](double at, double inside) { return pose_at(state, body, from, to, at, inside).x; };
    // one more place on the way: on which side it is
    const auto pass = [&](double before, double at, double inside) {
      const double s = side_of(when, place(at, inside));
      const char now = s > 0 ? 2 : s < 0 ? 1 : side;
      if (now == side) return;
      const char old = side;
      side = now;
      if (old == 0) return;
      double low = before, high = at;
      for (int i = 0; i < kNarrowings; ++i) {
        const double middle = 0.5 * (low + high), value = side_of(when, place(middle, inside));
        (value != 0 && (value > 0) == (now == 2) ? high : low) = middle;
      }
      if (within(when, place(high, inside))) found_.push_back({exact_ ? high : to, w, k, false, now});
    };
    stretches({body}, from, to);
    const std::vector<double> knots = knots_;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      const double a = knots[i], b = knots[i + 1], inside = 0.5 * (a + b);
      // its cubic from four of its values, in u from 0 to 1; extrema between
      const double p0 = side_of(when, place(a, inside)), p1 = side_of(when, place(a + (b - a) / 3, inside)),
                   p2 = side_of(when, place(a + 2 * (b - a) / 3, inside)),
                   p3 = side_of(when, place(b, inside));
      const double c1 = -5.5 * p0 + 9 * p1 - 4.5 * p2 + p3, c2 = 9 * p0 - 22.5 * p1 + 18 * p2 - 4.5 * p3,
                   c3 = -4.5 * p0 + 13.5 * p1 - 13.5 * p2 + 4.5 * p3;
      std::array<double, 2> turns{2, 2};
      const double A = 3 * c3, B = 2 * c2, under = B * B - 4 * A * c1;
      if (under > 0) {
        const double q = -0.5 * (B + (B < 0 ? -1 : 1) * std::sqrt(under));
        if (A != 0) turns[0] = q / A;
        if (q != 0) turns[1] = c1 / q;
        if (turns[0] > turns[1]) std::swap(turns[0], turns[1]);
      }
      double before = a;
      pass(a, a, inside);
      for (const double u : turns) {
        if (!(u > 0 && u < 1)) continue;
        pass(before, a + u * (b - a), inside);
        before = a + u * (b - a);
      }
      pass(before, b, inside);
    }
    // what moved it last, beside its solver
    const double s = side_of(when, state.x[std::size_t(body)]);
    if (side != 0 && s != 0 && (s > 0) != (side == 2) && within(when, state.x[std::size_t(body)]))
      found_.push_back({to, w, k, true, char(s > 0 ? 2 : 1)});
  }
}

template void Events<2>::find(const State<2>& state, double from, double to, bool only_joining);
template bool Events<2>::joins(const When<2>& when) const;
template void Events<2>::touch_with_these(const State<2>&);
template void Events<3>::touch_with_these(const State<3>&);
template void Events<2>::search_touch(typename Events<2>::Found& found, double from, double to);
template void Events<3>::find(const State<3>& state, double from, double to, bool only_joining);
template bool Events<3>::joins(const When<3>& when) const;
template void Events<3>::search_touch(typename Events<3>::Found& found, double from, double to);
template void Events<2>::find_times(const State<2>& state, double from, double to);
template void Events<3>::find_times(const State<3>& state, double from, double to);
template void Events<2>::find_breaks(const State<2>& state, int w, double from, double to);
template void Events<3>::find_breaks(const State<3>& state, int w, double from, double to);
template void Events<2>::spans(const State<2>& state, std::pair<int, int> pair, bool touched, double from,
                               double to);
template void Events<3>::spans(const State<3>& state, std::pair<int, int> pair, bool touched, double from,
                               double to);
template void Events<2>::find_touches(const State<2>& state, int w, double from, double to);
template void Events<3>::find_touches(const State<3>& state, int w, double from, double to);
template Instant<2> Events<2>::pose_at(const State<2>& state, int body, double from, double to, double at,
                                       double inside) const;
template Instant<3> Events<3>::pose_at(const State<3>& state, int body, double from, double to, double at,
                                       double inside) const;
template void Events<2>::stretches(const std::vector<int>& bodies, double from, double to);
template void Events<3>::stretches(const std::vector<int>& bodies, double from, double to);
template double Events<2>::side_of(const When<2>& when, const Vec<2>& x) const;
template double Events<3>::side_of(const When<3>& when, const Vec<3>& x) const;
template bool Events<2>::within(const When<2>& when, const Vec<2>& x) const;
template bool Events<3>::within(const When<3>& when, const Vec<3>& x) const;
template void Events<2>::find_crossings(const State<2>& state, int w, double from, double to);
template void Events<3>::find_crossings(const State<3>& state, int w, double from, double to);
template void Events<2>::join_with_these(State<2>& state, TimeStamp at, std::vector<Due>& actions);
template void Events<3>::join_with_these(State<3>& state, TimeStamp at, std::vector<Due>& actions);

}  // namespace obscura::sim
