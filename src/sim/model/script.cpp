#include "sim/model/script.h"

#include <algorithm>

namespace obscura::sim {

namespace {

__extension__ typedef __int128 Int128;

constexpr double kSame = 1e-9;  // of a step

TimeStamp snapped(TimeStamp at) {
  if (at.fraction < kSame) return {at.step, 0};
  if (at.fraction > 1 - kSame) return {at.step + 1, 0};
  return at;
}

}  // namespace

TimeStamp time_stamp(Rational t, Rational rate) {
  const Int128 num = Int128(t.num) * rate.num, den = Int128(t.den) * rate.den;
  Int128 whole = num / den, rest = num % den;
  if (rest < 0) rest += den, --whole;
  const double fraction = double(rest) / double(den);
  // a rest short of a step by less than rounding
  if (fraction >= 1) return {std::int64_t(whole) + 1, 0};
  return {std::int64_t(whole), fraction};
}

TimeStamp snapped_stamp(Rational t, Rational rate) { return snapped(time_stamp(t, rate)); }

double time(TimeStamp at, Rational rate) {
  return double(at.step) * double(rate.den) / double(rate.num) + at.fraction * step_length(rate);
}

template <int D>
std::vector<ScriptEvent> edges(const Model<D>& model) {
  std::vector<ScriptEvent> all;
  for (int mouse = 0; mouse < int(model.mice.size()); ++mouse) {
    const auto& path = model.mice[mouse].path;
    for (const Knot<D>& knot : path) {
      const auto kind = &knot == &path.front()  ? ScriptEvent::Kind::press
                        : &knot == &path.back() ? ScriptEvent::Kind::release
                                                : ScriptEvent::Kind::knot;
      all.push_back({snapped(time_stamp(knot.time, model.rate)), mouse, kind});
    }
  }
  for (int i = 0; i < int(model.explosions.size()); ++i) {
    const Explosion<D>& it = model.explosions[i];
    const Rational end = it.start + it.duration;
    const bool held = it.scheme == Explosion<D>::Scheme::paper;
    Rational at = it.start;
    do {
      all.push_back({snapped(time_stamp(at, model.rate)), i, ScriptEvent::Kind::blast});
      at = at + it.interval;
    } while (held && at < end);
    all.push_back({snapped(time_stamp(end, model.rate)), i, ScriptEvent::Kind::calm});
  }
  for (int i = 0; i < int(model.drives.size()); ++i) {
    const Drive<D>& it = model.drives[std::size_t(i)];
    for (const Knot<D>& knot : it.path)
      all.push_back({snapped(time_stamp(knot.time, model.rate)), i, ScriptEvent::Kind::bend});
    if (it.release)
      all.push_back({snapped(time_stamp(*it.release, model.rate)), i, ScriptEvent::Kind::let_go});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const ScriptEvent& a, const ScriptEvent& b) { return a.at < b.at; });
  for (std::size_t i = 1; i < all.size(); ++i) {
    const TimeStamp before = all[i - 1].at;
    if (all[i].at.step == before.step && all[i].at.fraction - before.fraction < kSame) all[i].at = before;
  }
  return all;
}

template std::vector<ScriptEvent> edges<2>(const Model<2>&);
template std::vector<ScriptEvent> edges<3>(const Model<3>&);

}  // namespace obscura::sim
