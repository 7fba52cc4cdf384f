#include "sim/iterative_pairs.h"

#include <algorithm>
#include <cmath>

#include "sim/turning.h"

namespace obscura::sim::sweep {

namespace {

constexpr double kCalm = 0.02;  // of the least thickness: how far a calm body may come

int part_of(const Cores& cores, int core) { return core < 0 ? 0 : cores.all[core].part; }

}  // namespace

Pairs::Pairs(const Model<2>& model, const Cores& cores) : model_(model), cores_(cores) {
  for (const Joint<2>& joint : model.joints) {
    if (joint.touching || joint.a.body < 0 || joint.b.body < 0) continue;
    joined_.emplace_back(std::min(joint.a.body, joint.b.body), std::max(joint.a.body, joint.b.body));
  }
  std::sort(joined_.begin(), joined_.end());
  compounds_ = cores.all.size() > model.bodies.size();
  double thin = 1e300;
  for (const double inside : cores.inside) thin = std::min(thin, std::max(inside, 1e-3 * model.scale));
  calm_ = kCalm * thin / kCalmLooks;
}

bool Pairs::may_touch(int a, int b) const {
  const Body<2>&p = model_.bodies[a], &q = model_.bodies[b];
  if ((p.fixed && q.fixed) || p.handout || q.handout) return false;
  for (const auto& [g, h] : model_.ignore) {
    if ((p.group == g && q.group == h) || (p.group == h && q.group == g)) return false;
  }
  return joined_.empty() || !std::binary_search(joined_.begin(), joined_.end(), std::pair(a, b));
}

Pair Pairs::pair(int a, int b, int core_a, int core_b) const {
  Pair made;
  made.a = a, made.b = b, made.core_a = core_a, made.core_b = core_b;
  const Body<2>& p = model_.bodies[a];
  if (b < 0) {
    const Wall<2>& wall = model_.walls[-1 - b];
    made.friction = wall.friction ? std::sqrt(p.friction * *wall.friction) : p.friction;
    made.elasticity = wall.elasticity ? std::sqrt(p.elasticity * *wall.elasticity) : p.elasticity;
    made.touches = cores_.all[core_a].count > 1 ? 2 : 1;
  } else {
    const Body<2>& q = model_.bodies[b];
    made.friction = std::sqrt(p.friction * q.friction);
    made.elasticity = std::sqrt(p.elasticity * q.elasticity);
    made.touches = cores_.all[core_a].count > 1 && cores_.all[core_b].count > 1 ? 2 : 1;
  }
  return made;
}

// of the fastest point, at most
double Pairs::speed(const State<2>& state, int body) const {
  const int k = turning(state, body);
  return std::sqrt(state.v[body].squaredNorm()) +
         (k >= 0 ? std::fabs(state.spin[k][0]) * cores_.reach[body] : 0);
}

double Pairs::room_to_move(const State<2>& state, int body, double span) const {
  if (model_.bodies[body].fixed || state.frozen[body]) return 0;
  const double fast = speed(state, body);
  return span * (fast + std::sqrt(model_.gravity.squaredNorm()) * span) + spare(body, fast, span);
}

double Pairs::spare(int body, double speed, double span) const {
  const double inside = std::max(cores_.inside[body], 1e-3 * model_.scale);
  return 0.05 * inside + std::min(0.2 * inside, speed * span);
}

// Who may be struck within the span: who may reach another as both fly now, or a wall; and, since they may be
// thrown about, their neighbours. Of two that fly side by side and cannot be struck, none will touch.
void Pairs::expose(const State<2>& state, const std::vector<Pose>& poses, double span) {
  const int n = int(model_.bodies.size());
  exposed_.assign(n, 0);
  for (int a = 0; a < n; ++a) {
    if (still_[a]) continue;
    for (const Wall<2>& w : model_.walls) {
      const double high = w.normal[0] * (poses[a].x - w.point[0]) + w.normal[1] * (poses[a].y - w.point[1]);
      if (high <= cores_.reach[a] + margin_[a]) exposed_[a] = 1;
    }
  }
  const double falls = 2 * span * span * std::sqrt(model_.gravity.squaredNorm());
  const auto swings = [&](int body) {
    const int k = turning(state, body);
    return k >= 0 ? std::fabs(state.spin[k][0]) * cores_.reach[body] : 0;
  };
  for (Candidate& c : candidates_) {
    const int a = cores_.all[c.a].body, b = cores_.all[c.b].body;
    const double passes = std::sqrt((state.v[a] - state.v[b]).squaredNorm()) + swings(a) + swings(b);
    const double margin = std::min(margin_[a] + margin_[b],
                                   span * passes + falls + 0.1 * (cores_.inside[a] + cores_.inside[b]));
    const double far = cores_.reach[a] + cores_.reach[b] + margin;
    const double dx = poses[a].x - poses[b].x, dy = poses[a].y - poses[b].y;
    c.close = dx * dx + dy * dy <= far * far;
    if (c.close) exposed_[a] = exposed_[b] = 1;
  }
  for (Candidate& c : candidates_) {
    const int a = cores_.all[c.a].body, b = cores_.all[c.b].body;
    if (exposed_[a] == 1 || exposed_[b] == 1) {
      c.close = true;
      if (!exposed_[a]) exposed_[a] = 2;
      if (!exposed_[b]) exposed_[b] = 2;
    }
  }
}

bool Pairs::find(State<2>& state, const std::vector<Pose>& poses, double span, bool all) {
  const int n = int(model_.bodies.size());
  margin_.resize(n), bounds_.resize(cores_.all.size()), still_.resize(n);
  bool everyone = true;
  for (int body = 0; body < n; ++body) {
    still_[body] =
        model_.bodies[body].fixed || state.frozen[body] || (!all && span * speed(state, body) < calm_);
    everyone = everyone && still_[body];
    margin_[body] = room_to_move(state, body, span);
  }
  if (everyone && !all) return false;
  for (int i = 0; i < int(bounds_.size()); ++i) {
    const Core& core = cores_.all[i];
    const Pose& at = poses[core.body];
    Bounds b{1e300, 1e300, -1e300, -1e300};
    for (int k = core.first; k < core.first + core.count; ++k) {
      const double x = at.x + (at.c * cores_.x[k] - at.s * cores_.y[k]);
      const double y = at.y + (at.s * cores_.x[k] + at.c * cores_.y[k]);
      b.left = std::min(b.left, x), b.right = std::max(b.right, x);
      b.bottom = std::min(b.bottom, y), b.top = std::max(b.top, y);
    }
    const double out = core.radius + margin_[core.body];
    bounds_[i] = {b.left - out, b.bottom - out, b.right + out, b.top + out};
  }
  grid_.fill(bounds_);
  candidates_.clear();
  for (int i = 0; i < int(cores_.all.size()); ++i) {
    const Core& p = cores_.all[i];
    if (model_.bodies[p.body].handout) continue;
    grid_.after(i, near_);
    for (const int j : near_) {
      const Core& q = cores_.all[j];
      if (q.body == p.body || (still_[p.body] && still_[q.body])) continue;
      if (p.count == 1 && q.count == 1 && p.radius + q.radius <= 0) continue;
      if (may_touch(p.body, q.body)) candidates_.push_back({i, j, false});
    }
  }
  expose(state, poses, span);

  // in the order of keys: walls from the last, then bodies
  found_.clear(), contacts_.clear();
  Feature features[2];
  const auto add = [&](Pair pair, double gap) {
    pair.first = int(contacts_.size());
    Contact<2> contact;
    contact.key.a = pair.a, contact.key.b = pair.b, contact.gap = gap;
    const int part_a = part_of(cores_, pair.core_a), part_b = part_of(cores_, pair.core_b);
    int words[2] = {features[0].word(), features[1].word()};
    if (pair.touches == 2 && words[1] < words[0]) std::swap(words[0], words[1]);
    for (int k = 0; k < pair.touches; ++k) {
      contact.key.feature = (part_a << 7 | part_b) << 16 | words[k];
      contacts_.push_back(contact);
    }
    found_.push_back(pair);
  };
  std::size_t resting = 0, next = 0;
  for (int a = 0; a < n; ++a) {
    const std::size_t begun = found_.size();
    bool kept = false;
    for (; resting < pairs_.size() && pairs_[resting].a <= a; ++resting) {
      const Pair& pair = pairs_[resting];
      if (pair.a < a || !still_[a] || !still(pair.b)) continue;
      found_.push_back(pair);
      found_.back().first = int(contacts_.size());
      for (int k = 0; k < pair.touches; ++k) contacts_.push_back(state.contacts[pair.first + k]);
      kept = true;
    }
    if (!still_[a] && !model_.bodies[a].handout) {
      for (int wall = int(model_.walls.size()); wall-- > 0;) {
        const Wall<2>& w = model_.walls[wall];
        const double high = w.normal[0] * (poses[a].x - w.point[0]) + w.normal[1] * (poses[a].y - w.point[1]);
        if (high > cores_.reach[a] + margin_[a]) continue;
        for (int i = cores_.begin[a]; i < cores_.begin[a + 1]; ++i) {
          const double gap = nearest(cores_, cores_.all[i], poses[a], w, features);
          if (gap < margin_[a]) add(pair(a, -1 - wall, i, -1), gap);
        }
      }
    }
    for (; next < candidates_.size() && candidates_[next].a < cores_.begin[a + 1]; ++next) {
      const Candidate& c = candidates_[next];
      if (!c.close) continue;
      const Core &p = cores_.all[c.a], &q = cores_.all[c.b];
      const double margin = margin_[a] + margin_[q.body];
      const double gap = nearest(cores_, p, poses[a], q, poses[q.body], features, margin);
      if (gap < margin) add(pair(a, q.body, c.a, c.b), gap);
    }
    if (compounds_ || kept) {
      std::sort(found_.begin() + long(begun), found_.end(), [&](const Pair& p, const Pair& q) {
        return contacts_[p.first].key < contacts_[q.first].key;
      });
    }
  }
  if (!std::is_sorted(contacts_.begin(), contacts_.end(),
                      [](const auto& p, const auto& q) { return p.key < q.key; })) {
    // the touches follow their pairs
    std::sort(contacts_.begin(), contacts_.end(), [](const auto& p, const auto& q) { return p.key < q.key; });
    int first = 0;
    for (Pair& pair : found_) pair.first = first, first += pair.touches;
  }

  // both lists ascend: forces go over to the same pair
  const std::vector<Contact<2>>& old = state.contacts;
  std::size_t o = 0;
  const auto before = [](const ContactKey& p, const ContactKey& q) {
    return std::tuple(p.a, p.b, p.feature >> 16) < std::tuple(q.a, q.b, q.feature >> 16);
  };
  for (const Pair& pair : found_) {
    const ContactKey& key = contacts_[pair.first].key;
    while (o < old.size() && before(old[o].key, key)) ++o;
    int count = 0;
    while (o + count < old.size() && count < 2 && !before(key, old[o + count].key)) ++count;
    if (count > 0) inherit(pair, poses, &old[o], count, &contacts_[pair.first]);
  }
  bool same = pairs_.size() == found_.size();
  for (std::size_t i = 0; same && i < pairs_.size(); ++i) {
    same = pairs_[i].a == found_[i].a && pairs_[i].b == found_[i].b && pairs_[i].core_a == found_[i].core_a &&
           pairs_[i].core_b == found_[i].core_b;
  }
  state.contacts.assign(contacts_.begin(), contacts_.end());
  if (same) return true;
  pairs_.swap(found_);
  ++version_;
  return true;
}

void Pairs::inherit(const Pair& pair, const std::vector<Pose>& poses, const Contact<2>* old, int count,
                    Contact<2>* now) const {
  // the same features
  bool taken[2] = {false, false}, filled[2] = {false, false};
  for (int k = 0; k < pair.touches; ++k) {
    for (int o = 0; o < count; ++o) {
      if (taken[o] || old[o].key.feature != now[k].key.feature) continue;
      now[k] = old[o], taken[o] = filled[k] = true;
    }
  }
  // else the nearest place: where corners of both lie over each other rounding chooses between them
  for (int k = 0; k < pair.touches; ++k) {
    const Feature feature = Feature::of(now[k].key.feature);
    if (filled[k] || feature.kind == Feature::none) continue;
    const Place at = place(pair, poses, feature);
    const double near = 0.2 * cores_.inside[pair.a];
    double least = near * near;
    int best = -1;
    for (int o = 0; o < count; ++o) {
      if (taken[o]) continue;
      const double dx = old[o].point[0] - at.x, dy = old[o].point[1] - at.y;
      if (dx * dx + dy * dy < least) least = dx * dx + dy * dy, best = o;
    }
    if (best < 0) continue;
    const ContactKey key = now[k].key;
    now[k] = old[best], now[k].key = key, taken[best] = true;
  }
}

Place Pairs::place(const Pair& pair, const std::vector<Pose>& poses, Feature feature) const {
  if (pair.b < 0)
    return touch(cores_, cores_.all[pair.core_a], poses[pair.a], model_.walls[-1 - pair.b], feature);
  return touch(cores_, cores_.all[pair.core_a], poses[pair.a], cores_.all[pair.core_b], poses[pair.b],
               feature);
}

bool Pairs::same_features(const Pair& pair, const State<2>& state, const std::vector<Pose>& poses,
                          int words[2]) const {
  Feature features[2];
  if (pair.b < 0) {
    nearest(cores_, cores_.all[pair.core_a], poses[pair.a], model_.walls[-1 - pair.b], features);
  } else {
    nearest(cores_, cores_.all[pair.core_a], poses[pair.a], cores_.all[pair.core_b], poses[pair.b], features);
  }
  words[0] = features[0].word(), words[1] = features[1].word();
  if (pair.touches == 2 && words[1] < words[0]) std::swap(words[0], words[1]);
  const Contact<2>* now = &state.contacts[pair.first];
  const int parts = now->key.feature >> 16 << 16;
  bool same = true;
  for (int k = 0; k < pair.touches; ++k) same = same && now[k].key.feature == (parts | words[k]);
  return same;
}

void Pairs::replace(const Pair& pair, State<2>& state, const std::vector<Pose>& poses, const int words[2]) {
  Contact<2>* now = &state.contacts[pair.first];
  const int parts = now->key.feature >> 16 << 16;
  const Contact<2> old[2] = {now[0], now[pair.touches - 1]};
  for (int k = 0; k < pair.touches; ++k) {
    now[k] = {};
    now[k].key = {pair.a, pair.b, parts | words[k]};
  }
  inherit(pair, poses, old, pair.touches, now);
}

void Pairs::adopt(const State<2>& state) {
  const auto parts = [](const ContactKey& key) { return key.feature >> 16; };
  bool same = true;
  std::size_t at = 0;
  for (const Pair& pair : pairs_) {
    same =
        at < state.contacts.size() && state.contacts[at].key.a == pair.a &&
        state.contacts[at].key.b == pair.b &&
        parts(state.contacts[at].key) == (part_of(cores_, pair.core_a) << 7 | part_of(cores_, pair.core_b));
    if (!same) break;
    at += pair.touches;
  }
  if (same && at == state.contacts.size()) return;
  pairs_.clear();
  for (at = 0; at < state.contacts.size();) {
    const ContactKey& key = state.contacts[at].key;
    const int core_a = cores_.begin[key.a] + (parts(key) >> 7);
    const int core_b = key.b < 0 ? -1 : cores_.begin[key.b] + (parts(key) & 127);
    Pair made = pair(key.a, key.b, core_a, core_b);
    made.first = int(at), at += made.touches;
    pairs_.push_back(made);
  }
  ++version_;
}

}  // namespace obscura::sim::sweep
