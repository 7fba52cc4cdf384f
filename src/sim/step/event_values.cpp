// Values of quantities, along the course of a step:
//   g(t) = b(t) - a(t)             margins of the comparisons a < b, by samples; where samples turn back
//                                  before zero, the extremum between them
// The course has velocities to the third order alone: what it has found must be so on the motion itself.
// Under `event` the time is then sought on the motion itself: by steps of a part of the step, from its
// beginning, between one before and one after, until both are 1e-12 of a step apart.

#include <algorithm>
#include <cmath>

#include "sim/force/spring.h"
#include "sim/model/body_motion.h"
#include "sim/step/events.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

namespace {

constexpr double kFound = 1e-12;        // of a step
constexpr double kFirstBracket = 1e-8;  // of a step
constexpr double kLastBracket = 1e-2;
constexpr int kMostTries = 60;       // partial steps of a search
constexpr int kLooksAt = 4;          // of a span of the course, at the ends of which the motion is looked at
constexpr int kPeakTries = 30;       // where it is true for a moment alone
constexpr int kSamples = 16;         // of a smooth piece
constexpr double kBeside = 1e-3;     // of the way between two samples
constexpr double kJustAfter = 1e-8;  // of a smooth piece
constexpr double kGolden = 0.3819660112501051;

template <int D>
double read(const Instant<D>& at, Reading::Of of) {
  using enum Reading::Of;
  switch (of) {
    case x:
      return at.x[0];
    case y:
      return at.x[1];
    case z:
      return at.x[D - 1];
    case vx:
      return at.v[0];
    case vy:
      return at.v[1];
    case vz:
      return at.v[D - 1];
    case speed:
      return std::sqrt(at.v.squaredNorm());
    case angle:
      return at.turn[0];
    case spin:
      return D == 2 ? at.spin[0] : std::sqrt(at.spin.squaredNorm());
    default:
      return 0;
  }
}

}  // namespace

// a quantity in a state; of forces how long the sum of what it has from all that touches or holds it is
template <int D>
double Events<D>::read(const State<D>& state, const Reading& of) {
  using enum Reading::Of;
  const int body = of.body;
  if (!of.of_forces()) return sim::read(instant(state, body), of.of);
  const auto known = [&](int joint) { return std::size_t(joint) < state.joint_forces.size(); };
  if (of.of == torque)
    return known(body) ? std::sqrt(state.joint_torques[std::size_t(body)].squaredNorm()) : 0;
  if (of.of == force) return known(body) ? std::sqrt(state.joint_forces[std::size_t(body)].squaredNorm()) : 0;
  const Model<D>& model = stepper_->model(state);
  Vec<D> sum = Vec<D>::Zero();
  const auto touch = [&](const Vec<D>& push, const Vec<D>& normal) {
    const Vec<D> pressed = push.dot(normal) * normal;
    sum += of.of == contact ? push : of.of == normal_force ? pressed : Vec<D>(push - pressed);
  };
  if (of.of == spring_force) {
    for (const Spring<D>& spring : model.springs) {
      if (spring.a.body != body && spring.b.body != body) continue;
      const Vec<D> a = place(state, spring.a), va = velocity(state, spring.a);
      const Vec<D> b = place(state, spring.b), vb = velocity(state, spring.b);
      sum += (spring.a.body == body ? 1 : -1) * pull<D>(law(spring), a, va, b, vb);
    }
  } else if (of.of == joint_force) {
    for (int i = 0; i < int(model.joints.size()); ++i) {
      const Joint<D>& joint = model.joints[std::size_t(i)];
      if (known(i) && (joint.a.body == body || joint.b.body == body))
        sum += (joint.a.body == body ? 1 : -1) * state.joint_forces[std::size_t(i)];
    }
  } else {
    for (const Contact<D>& it : state.contacts)
      if (it.touching != ContactMode::open && (it.key.a == body || it.key.b == body))
        touch((it.key.a == body ? 1 : -1) * it.force, it.normal);
    for (const Touch<D>& it : state.touches)
      if (it.body == body) touch(it.impulse * value(model.rate), model.walls[std::size_t(it.wall)].normal);
  }
  return std::sqrt(sum.squaredNorm());
}

// truth_ and margins_ of a value at fractions of the step
template <int D>
void Events<D>::evaluate(const State<D>& state, int w, double from, double to, std::span<const double> at,
                         double inside) {
  const When<D>& when = model_.whens[std::size_t(w)];
  const std::size_t reads = when.reads.size(), n = at.size();
  inputs_.resize(std::max(inputs_.size(), reads + 1));
  for (auto& all : inputs_) all.resize(Program::kLanes);
  for (std::size_t i = 0; i < n; ++i) {
    int last = -1;
    Instant<D> it;
    for (std::size_t k = 0; k < reads; ++k) {
      const Reading& read = when.reads[k];
      if (read.body != last) it = pose_at(state, read.body, from, to, at[i], inside), last = read.body;
      inputs_[k][i] = sim::read(it, read.of);
    }
    inputs_[reads][i] = time_at(begun_, at[i]);
  }
  std::vector<const double*> slots;
  for (std::size_t k = 0; k <= reads; ++k) slots.push_back(inputs_[k].data());
  Evaluation& evaluation = evaluations_[std::size_t(evaluation_of_[std::size_t(w)])];
  evaluation.run(int(n), slots);
  truth_.assign(evaluation.output(0), evaluation.output(0) + n);
  margins_.resize(std::size_t(when.value->outputs() - 1));
  for (std::size_t m = 0; m < margins_.size(); ++m)
    margins_[m].assign(evaluation.output(int(m) + 1), evaluation.output(int(m) + 1) + n);
}

template <int D>
void Events<D>::find_values(const State<D>& state, int w, double from, double to) {
  bool was = state.events.on[std::size_t(slot(w, 0))] != 0;
  // forces are known at the ends of what has been stepped
  if (model_.whens[std::size_t(w)].of_forces()) {
    if (!was && true_now(state, w, to)) found_.push_back({to, w, 0, false, 0});
    return;
  }
  stretches(read_[std::size_t(w)], from, to);
  const std::vector<double> knots = knots_;
  const std::size_t begun = found_.size();
  double since = from;
  std::vector<double> at(kSamples + 1), more;
  for (std::size_t s = 0; s + 1 < knots.size(); ++s) {
    const double a = knots[s], b = knots[s + 1], inside = 0.5 * (a + b);
    at.resize(kSamples + 1);
    for (int i = 0; i <= kSamples; ++i) at[std::size_t(i)] = a + (b - a) * i / kSamples;
    at.back() = b;
    evaluate(state, w, from, to, at, inside);
    const std::vector<std::vector<double>> margins = margins_;
    std::vector<double> truth = truth_;
    const auto margin_at = [&](std::size_t m, double x) {
      evaluate(state, w, from, to, std::span(&x, 1), inside);
      return margins_[m][0];
    };
    more.clear();
    for (std::size_t m = 0; m < margins.size(); ++m) {
      const std::vector<double>& g = margins[m];
      const std::size_t last = g.size() - 1;
      for (std::size_t i = 0; i <= last; ++i) {
        // turns back before zero: how near it comes between
        if (!(g[i] != 0)) continue;
        const double sign = g[i] > 0 ? 1 : -1;
        const double before = sign * g[i > 0 ? i - 1 : i], here = sign * g[i],
                     after = sign * g[i < last ? i + 1 : i];
        if (!(here <= before && here <= after)) continue;
        double low = at[i > 0 ? i - 1 : i], high = at[i < last ? i + 1 : i];
        // at an end only what goes towards zero from there
        const double beside = i == 0 ? low + kBeside * (high - low) : high - kBeside * (high - low);
        if ((i == 0 || i == last) && !(sign * margin_at(m, beside) < here)) continue;
        double x = low + kGolden * (high - low), y = high - kGolden * (high - low);
        double gx = sign * margin_at(m, x), gy = sign * margin_at(m, y);
        for (int k = 0; k < kNarrowings && gx > 0 && gy > 0; ++k) {
          if (gx < gy)
            high = y, y = x, gy = gx, x = low + kGolden * (high - low), gx = sign * margin_at(m, x);
          else
            low = x, x = y, gx = gy, y = high - kGolden * (high - low), gy = sign * margin_at(m, y);
        }
        if (gx <= 0 || gy <= 0) more.push_back(gx <= 0 ? x : y);
      }
      // changes its sign between two samples, and with another margin may be true between
      for (std::size_t i = 0; i + 1 < g.size() && margins.size() > 1; ++i) {
        if (!(g[i] * g[i + 1] < 0)) continue;
        double low = at[i], high = at[i + 1];
        for (int k = 0; k < kNarrowings; ++k) {
          const double middle = 0.5 * (low + high);
          (margin_at(m, middle) * g[i] > 0 ? low : high) = middle;
        }
        more.push_back(low), more.push_back(high);
      }
    }
    if (!more.empty()) {
      at.insert(at.end(), more.begin(), more.end());
      std::sort(at.begin(), at.end());
      // and between them
      const std::size_t n = at.size();
      for (std::size_t i = 0; i + 1 < n; ++i) at.push_back(0.5 * (at[i] + at[i + 1]));
      std::sort(at.begin(), at.end());
      truth.clear();
      for (std::size_t i = 0; i < at.size(); i += Program::kLanes) {
        evaluate(state, w, from, to,
                 std::span(at).subspan(i, std::min(at.size() - i, std::size_t(Program::kLanes))), inside);
        truth.insert(truth.end(), truth_.begin(), truth_.end());
      }
    }
    // what has just fired, on the border itself, goes on from there
    if (s == 0 && was && truth[0] == 0) {
      const double after = a + kJustAfter * (b - a);
      evaluate(state, w, from, to, std::span(&after, 1), inside);
      truth[0] = truth_[0];
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
      const bool now = truth[i] != 0;
      if (now && !was) {
        double low = i == 0 ? at[0] : at[i - 1], high = at[i];
        for (int k = 0; k < kNarrowings && low < high; ++k) {
          const double middle = 0.5 * (low + high);
          evaluate(state, w, from, to, std::span(&middle, 1), inside);
          (truth_[0] != 0 ? high : low) = middle;
        }
        found_.push_back({exact_ ? high : to, w, 0, false, 0, since, high, to});
      }
      if (!now && was) {
        since = at[i];
        if (found_.size() > begun) found_.back().until = i == 0 ? at[0] : at[i - 1];
      }
      was = now;
    }
  }
  if (!was && true_now(state, w, to)) found_.push_back({to, w, 0, true, 0});
}

// whether a value is true in a state
template <int D>
bool Events<D>::true_now(const State<D>& as_it_is, int w, double fraction) {
  const When<D>& when = model_.whens[std::size_t(w)];
  const bool probed = probes_ && when.of_forces();
  if (probed) probe(as_it_is, fraction);
  const State<D>& state = probed ? probed_ : as_it_is;
  const std::size_t reads = when.reads.size();
  inputs_.resize(std::max(inputs_.size(), reads + 1));
  std::vector<const double*> slots;
  for (std::size_t k = 0; k <= reads; ++k) {
    inputs_[k].resize(Program::kLanes);
    inputs_[k][0] = k < reads ? read(state, when.reads[k]) : time_at(begun_, fraction);
    slots.push_back(inputs_[k].data());
  }
  Evaluation& evaluation = evaluations_[std::size_t(evaluation_of_[std::size_t(w)])];
  evaluation.run(1, slots);
  margins_.resize(std::size_t(when.value->outputs() - 1));
  for (std::size_t m = 0; m < margins_.size(); ++m) margins_[m].assign(1, evaluation.output(int(m) + 1)[0]);
  return evaluation.output(0)[0] != 0;
}

// Into probed_: a state with the forces of its instant, which are those that the next moment of its motion
// begins with, and the velocities after its impacts. The exact solver keeps the forces of contacts as they
// were at the last event of a step. False: it cannot go on.
template <int D>
bool Events<D>::probe(const State<D>& state, double fraction) {
  probed_ = state;
  stepper_->watch(nullptr);
  const double from = state.step > begun_.step ? 0 : fraction;
  const bool troubled = stepper_->go(probed_, from, std::min(from + kMoment, 1.0)).has_value();
  stepper_->watch(&course_);
  return !troubled;
}

// what was found, on the motion itself: whether it is so at a fraction of the step, and by how much
template <int D>
typename Events<D>::Tried Events<D>::attempt(const Found& found, double from, double at) {
  const When<D>& when = model_.whens[std::size_t(found.when)];
  stepper_->watch(nullptr);
  tried_ = begun_;
  const bool troubled = at > from && stepper_->go(tried_, from, at).has_value();
  stepper_->watch(&course_);
  if (troubled) return {true, 0};
  if (when.on == On::crosses) {
    const double s = side_of(when, tried_.x[std::size_t(when.those[std::size_t(found.which)])]);
    const double over = found.side == 2 ? s : -s;
    return {over > 0, over};
  }
  const bool is = true_now(tried_, found.when, at);
  return {is, margins_.size() == 1 ? margins_[0][0] : 0};
}

// an instant at which a value is true, where the course has it, or near
template <int D>
std::optional<double> Events<D>::true_instant(const Found& found, double from, double to) {
  for (double d = kFirstBracket; d <= kLastBracket; d *= 100) {
    const double at = std::min(to, found.seen + d);
    if (attempt(found, from, at).is) return at;
  }
  for (int k = 1; k <= kLooksAt && found.until > found.seen; ++k) {
    const double at = found.seen + (found.until - found.seen) * k / kLooksAt;
    if (attempt(found, from, at).is) return at;
  }
  // for a moment alone, which the course has a little too early or late: up to where its margin is greatest
  if (found.until - found.seen > kLastBracket || margins_.size() != 1) return {};
  double low = std::max(from, found.seen - kLastBracket), high = std::min(to, found.until + kLastBracket);
  double x = low + kGolden * (high - low), y = high - kGolden * (high - low);
  Tried at_x = attempt(found, from, x), at_y = attempt(found, from, y);
  for (int k = 0; k < kPeakTries && !at_x.is && !at_y.is; ++k) {
    if (at_x.margin > at_y.margin)
      high = y, y = x, at_y = at_x, x = low + kGolden * (high - low), at_x = attempt(found, from, x);
    else
      low = x, x = y, at_x = at_y, y = high - kGolden * (high - low), at_y = attempt(found, from, y);
  }
  return at_x.is ? std::optional(x) : at_y.is ? std::optional(y) : std::nullopt;
}

// an instant before `at` at which it is false
template <int D>
std::optional<double> Events<D>::false_before(const Found& found, double from, double at) {
  if (found.since >= at) {
    const double before = std::max(from, at - kLastBracket);
    return attempt(found, from, before).is ? std::nullopt : std::optional(before);
  }
  for (double d = kFirstBracket; d <= kLastBracket && at - d > found.since; d *= 100)
    if (!attempt(found, from, at - d).is) return at - d;
  // it is false where its course begins, or was true there and has to have ceased
  for (int k = 1; k < kLooksAt; ++k) {
    const double before = at + (found.since - at) * k / kLooksAt;
    if (!attempt(found, from, before).is) return before;
  }
  if (found.since == from || !attempt(found, from, found.since).is) return found.since;
  return {};
}

// whether a value that the course has is so on the motion itself
template <int D>
bool Events<D>::confirm(const State<D>& state, Found& found, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(found.when)];
  if (found.exact || when.on != On::value || when.of_forces() || !model_.bonds.empty()) return true;
  if (!exact_) {
    const bool ends_true = found.until == to && true_now(state, found.when, to);
    const bool began_false = found.since == from;
    const bool is = ends_true || true_instant(found, from, to).has_value();
    return is && (began_false || false_before(found, from, found.seen).has_value());
  }
  const std::optional<double> at = true_instant(found, from, to);
  const std::optional<double> before = at ? false_before(found, from, *at) : std::nullopt;
  if (!before) return false;
  found.at = *at, found.since = *before;
  return true;
}

// the time of what was found, on the motion itself
template <int D>
void Events<D>::search(Found& found, double from, double to) {
  if (found.exact) return;
  const When<D>& when = model_.whens[std::size_t(found.when)];
  const bool forces = when.of_forces();
  double low = 0, high = 0;
  Tried at_low, at_high;
  bool before = false, after = false;
  int tries = 0;
  if (when.on == On::value && !forces) {
    low = found.since, high = found.at, before = after = true;
    at_low = attempt(found, from, low), at_high = attempt(found, from, high);
  }
  for (double d = kFirstBracket; d <= kLastBracket && !after; d *= 100, ++tries)
    high = std::min(to, found.at + d), at_high = attempt(found, from, high), after = at_high.is;
  for (double d = kFirstBracket; d <= kLastBracket && after && !before; d *= 100, ++tries) {
    low = found.at - d;
    if (low <= from)
      low = from, before = true, at_low = attempt(found, from, from);
    else
      at_low = attempt(found, from, low), before = !at_low.is;
  }
  // forces may have changed anywhere in the step
  if (forces && after && !before) low = from, before = true, at_low = attempt(found, from, from);
  // its margin is a straight line there, nearly: then a little before and a little after it
  for (; before && after && high - low > kFound && tries < kMostTries; ++tries) {
    double middle = 0.5 * (low + high);
    const double part = at_low.margin / (at_low.margin - at_high.margin);
    const bool line = at_low.margin < 0 && at_high.margin > 0 && tries % 4 != 3;
    if (line) middle = low + part * (high - low) + 0.25 * kFound;
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    const Tried now = attempt(found, from, middle);
    (now.is ? high : low) = middle;
    (now.is ? at_high : at_low) = now;
    if (!line || !now.is || middle - 0.5 * kFound <= low) continue;
    const Tried just = attempt(found, from, middle - 0.5 * kFound);
    (just.is ? high : low) = middle - 0.5 * kFound;
    (just.is ? at_high : at_low) = just;
  }
  if (before && after) found.at = high;
}

template double Events<2>::read(const State<2>& state, const Reading& of);
template double Events<3>::read(const State<3>& state, const Reading& of);
template void Events<2>::evaluate(const State<2>& state, int w, double from, double to,
                                  std::span<const double> at, double inside);
template void Events<3>::evaluate(const State<3>& state, int w, double from, double to,
                                  std::span<const double> at, double inside);
template void Events<2>::find_values(const State<2>& state, int w, double from, double to);
template void Events<3>::find_values(const State<3>& state, int w, double from, double to);
template bool Events<2>::true_now(const State<2>& as_it_is, int w, double fraction);
template bool Events<3>::true_now(const State<3>& as_it_is, int w, double fraction);
template bool Events<2>::probe(const State<2>& state, double fraction);
template bool Events<3>::probe(const State<3>& state, double fraction);
template bool Events<2>::confirm(const State<2>& state, typename Events<2>::Found& found, double from,
                                 double to);
template bool Events<3>::confirm(const State<3>& state, typename Events<3>::Found& found, double from,
                                 double to);
template void Events<2>::search(typename Events<2>::Found& found, double from, double to);
template void Events<3>::search(typename Events<3>::Found& found, double from, double to);

}  // namespace obscura::sim
