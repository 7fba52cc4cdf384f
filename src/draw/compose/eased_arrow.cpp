// An arrow for its words. At the samples t_k of a film its tail, and its length, are a_k. A step a_k -
// a_{k-1} that is much larger than those around it is a jump d at the middle t of its interval, and is spread
// over a time T, by
//   c(s) = d (S((s - t) / T + 1/2) - H(s - t))      S(u) = u² (3 - 2 u) from 0 to 1, H a step
// so that the eased ones are A_k = a_k + sum c(t_k). Between samples they are on the line from A_{k-1} to
// A_k, and as far from it as the arrow itself is from the line from a_{k-1} to a_k, where that is no more
// than its bend: a blow between two samples is not followed. Its direction is the arrow's at any time, for
// words stand beside it. Where it turns around they stand still at other places (Placing::beside_swing).

#include "draw/compose/eased_arrow.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace obscura::draw {
namespace {

constexpr double kSteadySteps = 1.5;  // times as far as in the intervals around it: still steady
constexpr double kUnbent = 0.25;      // of a jump: the least bend
constexpr double kLeastTime = 0.3, kMostTime = 2.5;  // s: of going over

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// the same way, and no farther than that
Point within(const Point& a, double most) {
  const double length = a.norm();
  return length > most ? Point(most / length * a) : a;
}

}  // namespace

void EasedArrow::add(double film, double before, const Ends& ends) {
  const bool anew = tails_.empty() || tails_.back().film != before;
  const Point length((ends.second - ends.first).norm(), 0);
  tails_.push_back({film, ends.first, ends.first, anew});
  lengths_.push_back({film, length, length, anew});
}

void EasedArrow::ease(double speed, double least) {
  ease(tails_, speed, least), ease(lengths_, speed, least);
}

void EasedArrow::ease(Knots& knots, double speed, double least) {
  const std::size_t n = knots.size();
  const auto goes = [&](std::size_t k) { return k > 0 && k < n && !knots[k].anew; };
  const auto step = [&](std::size_t k) { return Point(knots[k].real - knots[k - 1].real); };
  for (std::size_t k = 1; k < n; ++k) {
    if (!goes(k)) continue;
    std::vector<double> around;
    for (std::size_t j = k + 1; j <= k + 2 && goes(j); ++j) around.push_back(step(j).norm());
    for (std::size_t j = k - 1; j + 2 >= k && goes(j); --j) around.push_back(step(j).norm());
    std::sort(around.begin(), around.end(), std::greater());
    knots[k].jumps = step(k).norm() > kSteadySteps * (around.size() > 1 ? around[1] : 0) + least;
  }
  for (std::size_t k = 0; k < n; ++k) {
    double bend = 0;
    for (const std::size_t j : {k, k + 1})
      if (goes(j) && goes(j + 1) && !knots[j].jumps && !knots[j + 1].jumps)
        bend = std::max(bend, (step(j + 1) - step(j)).norm());
    knots[k].slack = bend + kUnbent * least;
  }
  for (std::size_t k = 1; k < n; ++k) {
    if (!knots[k].jumps) continue;
    const double lasting = std::clamp(1.5 * step(k).norm() / speed, kLeastTime, kMostTime),
                 middle = (knots[k - 1].film + knots[k].film) / 2;
    const auto shift = [&](std::size_t j) {
      const double off = knots[j].film - middle, gone = smooth(off / lasting + 0.5);
      knots[j].eased += (off > 0 ? gone - 1 : gone) * step(k);
    };
    shift(k);
    for (std::size_t j = k + 1; goes(j); ++j) shift(j);
    shift(k - 1);
    for (std::size_t j = k - 1; goes(j); --j) shift(j - 1);
  }
}

Point EasedArrow::at(const Knots& knots, double film, const Point& now) {
  const auto next = std::upper_bound(knots.begin(), knots.end(), film,
                                     [](double t, const Knot& knot) { return t < knot.film; });
  const Knot* after = next == knots.end() ? nullptr : &*next;
  const Knot* before = next == knots.begin() ? nullptr : &*(next - 1);
  if (before && after && !after->anew) {
    const double part = (film - before->film) / (after->film - before->film);
    const Point eased = before->eased + part * (after->eased - before->eased);
    if (after->jumps) return eased;
    return eased + within(now - before->real - part * (after->real - before->real), before->slack);
  }
  // where no way leads on it goes on as at the nearer knot
  const Knot* own = nullptr;
  for (const Knot* each : {before, after})
    if (each && (!own || (each->real - now).norm() < (own->real - now).norm())) own = each;
  if (!own) return now;
  const std::size_t k = std::size_t(own - knots.data()), end = own == after ? k + 1 : k;
  const bool goes = end > 0 && end < knots.size() && !knots[end].anew && !knots[end].jumps;
  const double step = goes ? (knots[end].real - knots[end - 1].real).norm() : 0;
  return own->eased + within(now - own->real, own->slack + kSteadySteps * step);
}

EasedArrow::Ends EasedArrow::at(double film, const Ends& now) const {
  const Point way = now.second - now.first, tail = at(tails_, film, now.first);
  const double length = way.norm(), eased = at(lengths_, film, {length, 0}).x();
  return {tail, length > 0 ? Point(tail + std::max(eased, 0.0) / length * way) : tail};
}

}  // namespace obscura::draw
