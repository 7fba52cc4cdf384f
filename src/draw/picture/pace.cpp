// The time w of the run that a film shows at its time f is the integral of the speed over the film:
//   w = w0 + v (f - f0)                                  where the speed is v
//   w = w0 + T (v0 u + (v1 - v0) E(u)),  u = (f - f0) / T    on the way from v0 to v1
// with E the integral of the ease e from 0 to u. A key stands at a time w1 of the run, so that the way to it
// takes T = (w1 - w0) / (v0 + (v1 - v0) E(1)) of the film. Everything is a polynomial: no rounding but the
// last.

#include "draw/picture/pace.h"

#include <cmath>
#include <numeric>

namespace obscura::draw {
namespace {

__extension__ typedef __int128 Wide;
using sim::Rational;

constexpr std::int64_t kFinest = 1'000'000;  // of a second

Rational rounded(double seconds) { return sim::rational(std::llround(seconds * double(kFinest)), kFinest); }

// num / den where that has a denominator fine enough, else the nearest microsecond
Rational rounded(Wide num, Wide den) {
  Wide a = num < 0 ? -num : num, b = den;
  while (b != 0) {
    const Wide r = a % b;
    a = b, b = r;
  }
  if (a > 1) num /= a, den /= a;
  if (den <= kFinest) return {std::int64_t(num), std::int64_t(den)};
  const Wide whole = num / den, rest = num % den;
  return sim::rational(std::int64_t(whole * kFinest + (2 * rest * kFinest + den) / (2 * den)), kFinest);
}

// start + speed (at - from). With all of them as fine as a scene may say, 128 bits hold it.
Rational along(Rational start, Rational speed, Rational at, Rational from) {
  if (at.den > kFinest) at = rounded(sim::value(at));
  const Wide num = (Wide(at.num) * from.den - Wide(from.num) * at.den) * speed.num;
  const Wide den = Wide(at.den) * from.den * speed.den;
  return rounded(num * start.den + start.num * den, den * start.den);
}

// the integral of an ease from 0 to u, u in [0, 1]
double area(CameraKey::Ease ease, double u) {
  switch (ease) {
    case CameraKey::Ease::linear:
      return u * u / 2;
    case CameraKey::Ease::in:
      return u * u * u * u / 4;
    case CameraKey::Ease::out:
      return u - (1 - (1 - u) * (1 - u) * (1 - u) * (1 - u)) / 4;
    case CameraKey::Ease::in_out:
      return u * u * u * u * (u * (u - 3) + 2.5);
    case CameraKey::Ease::hold:
      return 0;
  }
  return 0;
}

}  // namespace

// the part of the way that is done at the part u of its time; 1 at 1, exactly
double Pace::Stretch::gone(double u) const {
  const double v0 = sim::value(from), v1 = sim::value(to);
  return (v0 * u + (v1 - v0) * area(ease, u)) / (v0 + (v1 - v0) * area(ease, 1));
}

Pace::Pace(sim::Rational speed) {
  if (!(speed == Rational{1, 1})) stretches_.push_back({{}, {}, speed, speed, CameraKey::Ease::hold});
}

Pace::Pace(const std::vector<PaceKey>& keys) {
  if (keys.empty()) return;
  stretches_.push_back({{}, {}, keys[0].speed, keys[0].speed, CameraKey::Ease::hold});
  for (std::size_t i = 0; i < keys.size(); ++i) {
    // the key's time in the film: there the interval before it ends
    const Rational begins = moving_film(keys[i].time);
    const bool last = i + 1 == keys.size();
    Stretch next{begins, keys[i].time, keys[i].speed, keys[i].speed, CameraKey::Ease::hold};
    if (!last && keys[i + 1].ease != CameraKey::Ease::hold && !(keys[i + 1].speed == keys[i].speed)) {
      const double v0 = sim::value(keys[i].speed), v1 = sim::value(keys[i + 1].speed);
      next.to = keys[i + 1].speed, next.ease = keys[i + 1].ease;
      next.length = sim::value(keys[i + 1].time - keys[i].time);
      next.seconds = sim::value(rounded(next.length / (v0 + (v1 - v0) * area(next.ease, 1))));
    }
    stretches_.push_back(next);
  }
}

void Pace::freeze(const Freeze& freeze) {
  // after what stands still at this instant already
  frozen_.push_back({film(freeze.time) + frozen_at(freeze.time), freeze.time, freeze.seconds});
}

sim::Rational Pace::world(sim::Rational film) const {
  Rational stood{0, 1};
  for (const Frozen& each : frozen_) {
    if (film < each.film) break;
    if (film < each.film + each.seconds) return each.world;
    stood = stood + each.seconds;
  }
  return moving_world(film - stood);
}

sim::Rational Pace::film(sim::Rational world) const {
  Rational at = moving_film(world);
  for (const Frozen& each : frozen_)
    if (each.world < world) at = at + each.seconds;
  return at;
}

double Pace::speed(double film) const {
  constexpr double kClose = 1e-4;  // s: a hundred of the steps to which times are rounded
  for (const Frozen& each : frozen_)
    if (film >= sim::value(each.film) && film < sim::value(each.film + each.seconds)) return 0;
  if (stretches_.empty()) return 1;
  double stood = 0;
  for (const Frozen& each : frozen_)
    if (film >= sim::value(each.film)) stood += sim::value(each.seconds);
  const double at = std::fmax(film - stood, kClose);
  return (sim::value(moving_world(rounded(at + kClose))) - sim::value(moving_world(rounded(at - kClose)))) /
         (2 * kClose);
}

sim::Rational Pace::frozen_at(sim::Rational world) const {
  Rational seconds{0, 1};
  for (const Frozen& each : frozen_)
    if (each.world == world) seconds = seconds + each.seconds;
  return seconds;
}

// of what moves: without the times that the film stands still
sim::Rational Pace::moving_world(sim::Rational film) const {
  if (stretches_.empty()) return film;
  std::size_t i = stretches_.size() - 1;
  while (i > 0 && film < stretches_[i].film) --i;
  const Stretch& s = stretches_[i];
  if (s.even()) return along(s.world, s.from, film, s.film);
  const double u = (sim::value(film) - sim::value(s.film)) / s.seconds;
  return rounded(sim::value(s.world) + s.length * s.gone(std::fmin(u, 1)));
}

sim::Rational Pace::moving_film(sim::Rational world) const {
  if (stretches_.empty()) return world;
  std::size_t i = stretches_.size() - 1;
  while (i > 0 && world < stretches_[i].world) --i;
  const Stretch& s = stretches_[i];
  if (s.even()) return along(s.film, {s.from.den, s.from.num}, world, s.world);
  const double done = (sim::value(world) - sim::value(s.world)) / s.length;
  if (done >= 1) return rounded(sim::value(s.film) + s.seconds);
  // by halves: the way done grows with u
  double low = 0, high = 1;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (s.gone(middle) < done ? low : high) = middle;
  }
  return rounded(sim::value(s.film) + s.seconds * high);
}

}  // namespace obscura::draw
