// What may touch within a substep in space: pairs whose bounds meet, and of these the features that are
// nearest. A pair that was far apart, or that keeps its features, is not looked at anew.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

namespace {

constexpr double kSlow = 0.01;   // of the narrower body: so far a pair moves with the same features
constexpr double kWider = 0.05;  // bounding radii: how far a body may come before pairs are sought anew
constexpr double kSpare = 0.02;  // of their bounding radius: what two may come nearer by being struck
constexpr double kThrown = 0.1;  // bounding radii: how far at most a body comes in a substep by being struck
constexpr double kFasterThrown = 1.05;  // times as fast: less is not passed on again
constexpr double kFarther = 1.5;        // times its speed: how far a body may come in a step
constexpr double kRounding = 1e-12;     // rad

}  // namespace

// whether bodies come farther in a substep than pairs are to approach in one, however many the step has
bool SpaceIterative::too_fast() const { return closing_rates_.most > kCloser * kMostSubsteps; }

// how far a body may come in a step, m
double SpaceIterative::margin(int body, double h) const {
  if (drives_.number(body) >= 0) return h * swiftness(body) + farther_[body] + 1e-3 * bounding_radius_[body];
  if (inactive_[body]) return 0;
  const double struck = farther_.empty() ? 0 : farther_[body];
  return h * (kFarther * swiftness(body) + 2 * g_ * h) + struck + 1e-3 * bounding_radius_[body];
}

// how far a body may come by being thrown, m
double SpaceIterative::thrown_way(int body, double h) const {
  return std::min(h * kFarther * thrown_[body], kThrown * bounding_radius_[body]);
}

// How fast blows of the substep may throw bodies, one after another, into thrown_, and wider margins for
// that, with the pairs that are near by these: what strikes passes on
//   v' = (1 + e) v m / (m + m')
// and no more than twice what the fastest has. From round to round, so that it does not hang on the order of
// pairs.
void SpaceIterative::foresee_blows(double h) {
  const int n = int(model_.bodies.size());
  thrown_.resize(std::size_t(n));
  double fastest = 0;
  for (int i = 0; i < n; ++i) {
    thrown_[i] = inactive_[i] && drives_.number(i) < 0 ? 0 : swiftness(i);
    fastest = std::max(fastest, thrown_[i]);
  }
  const auto pass_on = [&](int from, int to) {
    if (!(thrown_[from] > thrown_[to]) || inactive_[to] || drives_.number(to) >= 0) return;
    const Body<D>&a = model_.bodies[from], &b = model_.bodies[to];
    const double share = drives_.number(from) >= 0 || joints_.has(from) ? 1 : a.mass / (a.mass + b.mass);
    const double speed = (1 + std::max(a.elasticity, b.elasticity)) * share * thrown_[from];
    next_thrown_[to] = std::max(next_thrown_[to], std::min(speed, 2 * fastest));
  };
  for (bool more = true; more;) {
    find_near();
    next_thrown_ = thrown_;
    for (const auto& [a, b] : near_pairs_) {
      if (thrown_[a] == thrown_[b] || !bounds_[a].meets(bounds_[b])) continue;
      pass_on(a, b), pass_on(b, a);
    }
    more = false;
    for (int i = 0; i < n; ++i) {
      // slow ones have room enough
      if (!(next_thrown_[i] > kFasterThrown * thrown_[i]) || !(h * kFarther * next_thrown_[i] > margin_[i]))
        continue;
      thrown_[i] = next_thrown_[i], more = true;
      const double margin = thrown_way(i, h);
      if (!(margin > margin_[i])) continue;
      const Vec<D> wider = Vec<D>::Constant(margin - margin_[i]);
      margin_[i] = margin, bounds_[i].lower -= wider, bounds_[i].upper += wider;
    }
  }
}

// how fast points of one body pass those of another, at most
double SpaceIterative::passing_speed(int a, int b) const {
  return std::sqrt((moving_[a].v - moving_[b].v).squaredNorm()) + swing_[a] + swing_[b];
}

// How near features of a pair may come to touch in the step, m. Of two that fly side by side none comes
// nearer, but for what strikes them meanwhile.
double SpaceIterative::pair_margin(int a, int b, double h) const {
  const double farther = carries_.empty() ? 0 : farther_[a] + farther_[b];
  const auto struck = [&](int body) { return thrown_[body] > swiftness(body) ? thrown_way(body, h) : 0; };
  return std::min(margin_[a] + margin_[b],
                  h * (passing_speed(a, b) + 2 * g_ * h) + farther +
                      std::max(kSpare * (bounding_radius_[a] + bounding_radius_[b]), struck(a) + struck(b)));
}

// All features are looked for sixty times a second. In between, a pair keeps those of its contacts in the
// state for one, two, four, ... substeps, as long as it hardly moves in these.
void SpaceIterative::find(StepPart<D> step) {
  const double h = step.h;
  const double elapsed = double(step.state.step % every_) / value(model_.rate) + step.substep * h;
  const std::int64_t number = std::llround(elapsed / h);
  const int n = int(model_.bodies.size());
  bounds_.resize(n), margin_.resize(n), swing_.resize(n);
  known_.swap(features_);
  // the first substep begins where the step does: of what has been found for the step, what is near enough
  const bool same = number == 0 && step.h < found_for_ && inactive_ == inactive_then_ && !too_fast();
  found_for_ = step.h;
  each(workers(), n, kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      bounds_[i] = bounds(model_.bodies[i].shape, stances_[i]);
      margin_[i] = margin(i, h), swing_[i] = bounding_radius_[i] * std::sqrt(moving_[i].w.squaredNorm());
      const Vec<D> more = Vec<D>::Constant(margin_[i]);
      bounds_[i].lower -= more, bounds_[i].upper += more;
    }
  });
  foresee_blows(h);
  const Search search{h, number, same, step.state.contacts};
  found_.resize(std::size_t((n + kPairPiece - 1) / kPairPiece));
  for (Found& found : found_) found.all.clear();
  each(workers(), n, kPairPiece,
       [&](int begin, int end) { find_of(begin, end, search, found_[std::size_t(begin / kPairPiece)]); });
  begin_constraints();
}

// The features of bodies from `begin` on before `end` with walls and with bodies of higher numbers,
// ascending: of a body first its walls, from the last.
void SpaceIterative::find_of(int begin, int end, const Search& search, Found& found) {
  const double h = search.h;
  auto pair = std::lower_bound(near_pairs_.begin(), near_pairs_.end(), std::pair(begin, -1));
  std::span<const Contact<D>> old = search.contacts;
  old = old.subspan(std::size_t(std::lower_bound(old.begin(), old.end(), begin,
                                                 [](const auto& c, int body) { return c.key.a < body; }) -
                                old.begin()));
  auto memo = std::size_t(std::lower_bound(known_.begin(), known_.end(), begin,
                                           [](const auto& gap, int body) { return gap.key.a < body; }) -
                          known_.begin());
  std::vector<ContactCandidate<D>>& gaps = found.of_pair;
  const auto keep = [&] { found.all.insert(found.all.end(), gaps.begin(), gaps.end()); };
  for (int a = begin; a < end; ++a) {
    const Body<D>& p = model_.bodies[a];
    for (int wall = int(model_.walls.size()); !inactive_[a] && !p.handout && wall-- > 0;) {
      const Wall<D>& w = model_.walls[wall];
      if ((stances_[a].x - w.point).dot(w.normal) > bounding_radius_[a] + margin_[a]) continue;
      gaps.clear();
      sim::collide(a, p.shape, stances_[a], wall, w, margin_[a], gaps);
      keep();
    }
    for (; pair != near_pairs_.end() && pair->first == a; ++pair) {
      const int b = pair->second;
      if (!bounds_[a].meets(bounds_[b])) continue;
      Apart& apart = apart_[std::size_t(pair - near_pairs_.begin())];
      const double within = pair_margin(a, b, h);
      if (stays_apart(apart, a, b, within)) continue;
      apart.clearance.apart = -1e300;
      gaps.clear();
      if (search.same) {
        take_known(a, b, within, memo, gaps);
      } else if (search.number == 0 || !keep_features(a, b, search, old, memo, gaps)) {
        const Body<D>& q = model_.bodies[b];
        Clearance clearance;
        sim::collide(a, p.shape, stances_[a], b, q.shape, stances_[b], within, Gaps::touching, gaps,
                     clearance);
        if (gaps.empty())
          apart = {clearance, stances_[a].x - stances_[b].x,
                   turned_[std::size_t(a)] + turned_[std::size_t(b)]};
      }
      keep();
    }
  }
}

// what has been found, as the iterations see it
void SpaceIterative::begin_constraints() {
  int count = 0;
  for (Found& found : found_) found.first = count, count += int(found.all.size());
  touches_.resize(std::size_t(count)), features_.resize(std::size_t(count));
  each(workers(), int(found_.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      auto at = std::size_t(found_[std::size_t(i)].first);
      Material made;
      const ContactCandidate<D>* last = nullptr;
      for (const ContactCandidate<D>& gap : found_[std::size_t(i)].all) {
        if (!last || last->key.a != gap.key.a || last->key.b != gap.key.b)
          made = material(model_, gap.key.a, gap.key.b);
        features_[at] = gap, touches_[at] = constraint(gap, made);
        last = &gap, ++at;
      }
    }
  });
}

// Pairs whose bounds may overlap: those of wider bounds, as long as no body leaves its own.
void SpaceIterative::find_near() {
  const auto holds = [&](const Bounds<D>& wide, const Bounds<D>& bounds) {
    return (wide.lower.array() <= bounds.lower.array()).all() &&
           (wide.upper.array() >= bounds.upper.array()).all();
  };
  const std::size_t n = bounds_.size();
  bool known = wide_.size() == n && inactive_ == inactive_then_;
  for (std::size_t i = 0; known && i < n; ++i) known = holds(wide_[i], bounds_[i]);
  if (known) return;
  wide_ = bounds_, inactive_then_ = inactive_;
  for (std::size_t i = 0; i < n; ++i) {
    if (inactive_[i] && drives_.number(int(i)) < 0) continue;
    const Vec<D> more = Vec<D>::Constant(kWider * bounding_radius_[i] + margin_[i]);
    wide_[i].lower -= more, wide_[i].upper += more;
  }
  near_pairs_ = broad_.find(
      wide_, inactive_, [&](int a, int b) { return may_touch_(a, b); }, points_);
  apart_.assign(near_pairs_.size(), {});
}

// Whether a pair that was apart is still without a look. It only saves looks: what collide() would find is
// the same.
bool SpaceIterative::stays_apart(const Apart& apart, int a, int b, double margin) const {
  if (!(apart.clearance.apart > margin)) return false;
  const Vec<D> between = stances_[a].x - stances_[b].x;
  const double moved = std::sqrt((between - apart.between).squaredNorm());
  const double reach =
      std::sqrt(apart.between.squaredNorm()) + moved + bounding_radius_[a] + bounding_radius_[b];
  const double turned = turned_[a] + turned_[b] - apart.turned + kRounding;
  // edges that turn so far may be parallel then
  if (!(turned * apart.clearance.per_turn < 1)) return false;
  return apart.clearance.apart - moved - turned * apart.clearance.per_turn * reach >= margin;
}

// Those features of a pair that are known and less than `margin` apart, into `gaps`. `memo`: as below.
void SpaceIterative::take_known(int a, int b, double margin, std::size_t& memo,
                                std::vector<ContactCandidate<D>>& gaps) const {
  const auto before = [&](const ContactKey& key) { return key.a != a ? key.a < a : key.b < b; };
  while (memo < known_.size() && before(known_[memo].key)) ++memo;
  for (; memo < known_.size() && known_[memo].key.a == a && known_[memo].key.b == b; ++memo) {
    if (known_[memo].value < margin) gaps.push_back(known_[memo]);
  }
}

// The features of a pair's contacts in the state, into `gaps`; false where it has none, where they are to be
// looked for in the substep of this number, or a key does not say all. `old`: contacts from this pair on;
// `memo`: where its keys would be among those known.
bool SpaceIterative::keep_features(int a, int b, const Search& search, std::span<const Contact<D>>& old,
                                   std::size_t& memo, std::vector<ContactCandidate<D>>& gaps) const {
  const auto before = [&](const Contact<D>& c) { return c.key.a != a ? c.key.a < a : c.key.b < b; };
  std::size_t begin = 0, end = 0;
  while (begin < old.size() && before(old[begin])) ++begin;
  for (end = begin; end < old.size() && old[end].key.a == a && old[end].key.b == b;) ++end;
  const std::span<const Contact<D>> its = old.subspan(begin, end - begin);
  old = old.subspan(begin);
  if (its.empty()) return false;
  const double way = search.h * passing_speed(a, b), most = kSlow * std::min(width_[a], width_[b]);
  std::int64_t keeps = 1;  // substeps
  while (keeps <= search.number && double(2 * keeps) * way <= most) keeps *= 2;
  if (search.number % keeps == 0) return false;
  for (const Contact<D>& contact : its) {
    while (memo < known_.size() && known_[memo].key < contact.key) ++memo;
    if (memo < known_.size() && known_[memo].key == contact.key && !known_[memo].of_poses) {
      gaps.push_back(known_[memo]);
      continue;
    }
    const auto named = named_candidate(contact.key, model_.bodies[a].shape, model_.bodies[b].shape);
    if (!named) {
      gaps.clear();
      return false;
    }
    gaps.push_back(*named);
  }
  return true;
}

SpaceIterative::ContactConstraint SpaceIterative::constraint(const ContactCandidate<D>& gap,
                                                             const Material& pair) const {
  static const BodyMotion<D> room;
  const int none = int(model_.bodies.size());
  const int a = gap.key.a, b = gap.key.b < 0 ? none : gap.key.b;
  const BodyMotion<D>& at_b = b == none ? room : stances_[b];
  const EvaluatedContact<D> now = evaluate(gap, stances_[a], at_b);
  ContactConstraint touch;
  touch.key = gap.key, touch.a = a, touch.b = b;
  touch.n = now.normal, touch.point = now.point, touch.gap = now.value;
  // each is pushed on its own skin: by the time they touch those have come together
  const Vec<D> apart = 0.5 * std::max(0.0, now.value) * now.normal;
  touch.arm_a = now.point + apart - stances_[a].x, touch.arm_b = now.point - apart - at_b.x;
  touch.mu = pair.friction, touch.bounce = pair.elasticity;
  touch.per_width = 1 / (b == none ? width_[a] : std::min(width_[a], width_[b]));
  touch.least_strike = least_strike(touch.bounce, 1 / touch.per_width);
  if (carries(a) || carries(b)) touch.belt = belt(touch);
  return touch;
}

}  // namespace obscura::sim
