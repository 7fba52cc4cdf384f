#include "sim/solve/iterate/plane_pair_cache.h"

#include <algorithm>

namespace obscura::sim::plane {

namespace {

// the order of pairs: that of the keys of their contacts, walls from the last
bool before(const Pair& p, const Pair& q) {
  if (p.a != q.a) return p.a < q.a;
  if (p.b != q.b) return p.b < q.b;
  return p.core_a != q.core_a ? p.core_a < q.core_a : p.core_b < q.core_b;
}
bool alike(const Pair& p, const Pair& q) {
  return p.a == q.a && p.b == q.b && p.core_a == q.core_a && p.core_b == q.core_b;
}

}  // namespace

Pairs::Pairs(const Model<2>& model, const CoreShapes& cores)
    : model_(model), cores_(cores), near_(model, cores), compounds_(cores.all.size() > model.bodies.size()) {
  for (const Body<2>& body : model.bodies) materials_.emplace_back(body);
}

Pair Pairs::pair(int a, int b, int core_a, int core_b) const {
  Pair made;
  made.a = a, made.b = b, made.core_a = core_a, made.core_b = core_b;
  if (b < 0) {
    made.material = mixed(materials_[a], model_.walls[-1 - b]);
    made.touches = cores_.all[core_a].count > 1 ? 2 : 1;
  } else {
    made.material = mixed(materials_[a], materials_[b]);
    made.touches = cores_.all[core_a].count > 1 && cores_.all[core_b].count > 1 ? 2 : 1;
  }
  return made;
}

// ContactKey::feature: which parts, and which features of them
int Pairs::feature(const Pair& pair, int word) const {
  const int part_b = pair.core_b < 0 ? 0 : cores_.all[pair.core_b].part;
  return (cores_.all[pair.core_a].part << 7 | part_b) << 16 | word;
}

// into found_, in order
void Pairs::gather_found(const std::vector<Pose>& poses) {
  found_.clear();
  Feature features[2];
  const auto add = [&](const Pair& pair) {
    found_.push_back(pair);
    Pair& made = found_.back();
    made.words[0] = features[0].word(), made.words[1] = features[1].word();
    if (made.touches == 2 && made.words[1] < made.words[0]) std::swap(made.words[0], made.words[1]);
  };
  const int n = int(model_.bodies.size());
  std::size_t resting = 0, next = 0;
  const std::vector<NearPairs::Candidate>& candidates = near_.candidates();
  for (int a = 0; a < n; ++a) {
    const std::size_t begun = found_.size();
    bool kept = false;
    for (; resting < pairs_.size() && pairs_[resting].a <= a; ++resting) {
      const Pair& pair = pairs_[resting];
      if (pair.a < a || !near_.still(a) || !near_.still(pair.b)) continue;
      found_.push_back(pair);
      kept = true;
    }
    if (!near_.still(a) && !near_.apart(a)) {
      for (int wall = int(model_.walls.size()); wall-- > 0;) {
        const Wall<2>& w = model_.walls[wall];
        const double high = w.normal[0] * (poses[a].x - w.point[0]) + w.normal[1] * (poses[a].y - w.point[1]);
        if (high > cores_.bounding_radius[a] + near_.margin(a)) continue;
        for (int i = cores_.begin[a]; i < cores_.begin[a + 1]; ++i) {
          if (find_features(cores_, cores_.all[i], poses[a], w, features) < near_.margin(a))
            add(pair(a, -1 - wall, i, -1));
        }
      }
    }
    for (; next < candidates.size() && candidates[next].a < cores_.begin[a + 1]; ++next) {
      const NearPairs::Candidate& c = candidates[next];
      const CoreShape &p = cores_.all[c.a], &q = cores_.all[c.b];
      if (c.meeting >= 0) {
        const BoxManifold& m = near_.manifold(c);
        const int lane = c.meeting % kLanes;
        if (!(m.gap[lane] < c.margin)) continue;
        found_.push_back(pair(a, q.body, c.a, c.b));
        found_.back().words[0] = m.words[0][lane], found_.back().words[1] = m.words[1][lane];
      } else if (find_features(cores_, p, poses[a], q, poses[q.body], features, c.margin) < c.margin) {
        add(pair(a, q.body, c.a, c.b));
      }
    }
    if (compounds_ || kept) std::sort(found_.begin() + long(begun), found_.end(), before);
  }
}

bool Pairs::find(State<2>& state, const std::vector<Pose>& poses, double span, int patience) {
  if (!near_.find(state, poses, span, patience)) return false;
  gather_found(poses);

  // the same pairs: only what is new of their features
  if (std::equal(pairs_.begin(), pairs_.end(), found_.begin(), found_.end(), alike)) {
    for (int i = 0; i < int(pairs_.size()); ++i) {
      const int *words = found_[i].words, *known = pairs_[i].words;
      if (known[0] == words[0] && (known[1] == words[1] || pairs_[i].touches < 2)) continue;
      renew({i, {words[0], words[1]}}, state, poses);
      pairs_[i].fresh = true;
    }
    return true;
  }

  // both lists ascend: forces go over to the same pair
  contacts_.clear();
  std::size_t old = 0;
  const Contact<2>*begin = nullptr, *end = nullptr;  // what goes over as it is
  const auto copy = [&] {
    contacts_.insert(contacts_.end(), begin, end);
    begin = end = nullptr;
  };
  for (Pair& pair : found_) {
    while (old < pairs_.size() && before(pairs_[old], pair)) ++old;
    const Pair* known = old < pairs_.size() && alike(pairs_[old], pair) ? &pairs_[old] : nullptr;
    const Contact<2>* from = known ? &state.contacts[known->first] : nullptr;
    if (from != end) copy();
    pair.first = int(contacts_.size()) + int(end - begin);
    if (known)
      pair.slot = known->slot, pair.colour = known->colour, pair.alone = known->alone,
      pair.impact_speed = known->impact_speed;
    pair.fresh =
        !known || known->words[0] != pair.words[0] || (known->words[1] != pair.words[1] && pair.touches > 1);
    if (!pair.fresh) {
      if (begin == end) begin = from;
      end = from + pair.touches;
      continue;
    }
    copy();
    contacts_.resize(pair.first + pair.touches);
    for (int k = 0; k < pair.touches; ++k)
      contacts_[pair.first + k].key = {pair.a, pair.b, feature(pair, pair.words[k])};
    if (known) inherit(pair, poses, from, known->touches, &contacts_[pair.first]);
  }
  copy();
  state.contacts.swap(contacts_);
  pairs_.swap(found_);
  ++version_;
  return true;
}

void Pairs::inherit(const Pair& pair, const std::vector<Pose>& poses, const Contact<2>* old, int count,
                    Contact<2>* now) const {
  // the same features
  bool used[2] = {false, false}, filled[2] = {false, false};
  for (int k = 0; k < pair.touches; ++k) {
    for (int o = 0; o < count; ++o) {
      if (used[o] || old[o].key.feature != now[k].key.feature) continue;
      now[k] = old[o], used[o] = filled[k] = true;
    }
  }
  // else the nearest place: where corners of both lie over each other rounding chooses between them
  for (int k = 0; k < pair.touches; ++k) {
    const Feature feature = Feature::of(now[k].key.feature);
    if (filled[k] || feature.kind == Feature::none) continue;
    const ContactPoint at = place(pair, poses, feature);
    const double near = 0.2 * cores_.half_thickness[pair.a];
    double least = near * near;
    int best = -1;
    for (int o = 0; o < count; ++o) {
      if (used[o]) continue;
      const double dx = old[o].point[0] - at.x, dy = old[o].point[1] - at.y;
      if (dx * dx + dy * dy < least) least = dx * dx + dy * dy, best = o;
    }
    if (best < 0) continue;
    const ContactKey key = now[k].key;
    now[k] = old[best], now[k].key = key, used[best] = true;
  }
}

ContactPoint Pairs::place(const Pair& pair, const std::vector<Pose>& poses, Feature feature) const {
  if (pair.b < 0)
    return evaluate_feature(cores_, cores_.all[pair.core_a], poses[pair.a], model_.walls[-1 - pair.b],
                            feature);
  return evaluate_feature(cores_, cores_.all[pair.core_a], poses[pair.a], cores_.all[pair.core_b],
                          poses[pair.b], feature);
}

void Pairs::features(const Pair& pair, const Pose& a, const Pose& b, int words[2]) const {
  Feature found[2];
  if (pair.b < 0) {
    find_features(cores_, cores_.all[pair.core_a], a, model_.walls[-1 - pair.b], found);
  } else {
    find_features(cores_, cores_.all[pair.core_a], a, cores_.all[pair.core_b], b, found);
  }
  words[0] = found[0].word(), words[1] = found[1].word();
  if (pair.touches == 2 && words[1] < words[0]) std::swap(words[0], words[1]);
}

void Pairs::put(const Pair& pair, const int words[2], ContactBatch& g) const {
  const int lane = pair.slot % kLanes, bit = 1 << lane;
  for (int k = 0; k < 2; ++k) {
    g.of_b[k] = static_cast<unsigned char>(g.of_b[k] & ~bit);
    g.corners[k] = static_cast<unsigned char>(g.corners[k] & ~bit);
    g.cx[k][lane] = g.cy[k][lane] = g.fx[k][lane] = g.fy[k][lane] = 0;
    g.d[k][lane] = -kNowhere;
    if (k >= pair.touches) continue;
    const Feature f = Feature::of(words[k]);
    g.words[k][lane] = static_cast<unsigned short>(words[k]);
    if (f.kind == Feature::none) continue;
    const CoreShape& a = cores_.all[pair.core_a];
    if (pair.b < 0) {
      const Wall<2>& wall = model_.walls[-1 - pair.b];
      g.cx[k][lane] = cores_.x[a.first + f.corner], g.cy[k][lane] = cores_.y[a.first + f.corner];
      g.fx[k][lane] = wall.normal[0], g.fy[k][lane] = wall.normal[1];
      g.d[k][lane] = wall.normal.dot(wall.point);
      continue;
    }
    const CoreShape& b = cores_.all[pair.core_b];
    if (f.kind == Feature::corners) {
      g.corners[k] = static_cast<unsigned char>(g.corners[k] | bit);
      g.cx[k][lane] = cores_.x[a.first + f.corner], g.cy[k][lane] = cores_.y[a.first + f.corner];
      g.fx[k][lane] = cores_.x[b.first + f.face], g.fy[k][lane] = cores_.y[b.first + f.face];
      g.d[k][lane] = b.radius;
      continue;
    }
    const bool of_a = f.kind == Feature::corner_of_a;
    const int corner = (of_a ? a : b).first + f.corner, face = (of_a ? b : a).first + f.face;
    if (!of_a) g.of_b[k] = static_cast<unsigned char>(g.of_b[k] | bit);
    g.cx[k][lane] = cores_.x[corner], g.cy[k][lane] = cores_.y[corner];
    g.fx[k][lane] = cores_.nx[face], g.fy[k][lane] = cores_.ny[face], g.d[k][lane] = cores_.d[face];
  }
}

const std::vector<ChangedPair>& Pairs::outdated(const std::vector<ContactBatch>& batches,
                                                const std::vector<Motion>& v, const std::vector<Pose>& poses,
                                                double share) {
  near_.find_outdated(batches, v, poses, share, outdated_, others_);
  for (const int seat : others_) {
    const int i = batches[seat / kLanes].pair[seat % kLanes];
    const Pair& pair = pairs_[i];
    ChangedPair now{i, {0, 0}};
    features(pair, poses[pair.a], poses[pair.b < 0 ? pair.a : pair.b], now.words);
    if (now.words[0] != pair.words[0] || (pair.touches == 2 && now.words[1] != pair.words[1]))
      outdated_.push_back(now);
  }
  return outdated_;
}

void Pairs::renew(const ChangedPair& found, State<2>& state, const std::vector<Pose>& poses) {
  Pair& pair = pairs_[found.pair];
  Contact<2>* now = &state.contacts[pair.first];
  const Contact<2> old[2] = {now[0], now[pair.touches - 1]};
  for (int k = 0; k < pair.touches; ++k) {
    pair.words[k] = found.words[k];
    now[k] = {};
    now[k].key = {pair.a, pair.b, feature(pair, pair.words[k])};
  }
  inherit(pair, poses, old, pair.touches, now);
}

void Pairs::adopt(const State<2>& state) {
  const auto parts = [](const ContactKey& key) { return key.feature >> 16; };
  bool same = true;
  std::size_t at = 0;
  for (Pair& pair : pairs_) {
    same = at < state.contacts.size() && state.contacts[at].key.a == pair.a &&
           state.contacts[at].key.b == pair.b &&
           parts(state.contacts[at].key) == parts({0, 0, feature(pair, 0)});
    if (!same) break;
    for (int k = 0; k < pair.touches && at + k < state.contacts.size(); ++k)
      pair.words[k] = state.contacts[at + k].key.feature & 0xffff;
    at += pair.touches;
  }
  if (same && at == state.contacts.size()) return;
  pairs_.clear();
  for (at = 0; at < state.contacts.size();) {
    const ContactKey& key = state.contacts[at].key;
    const int core_a = cores_.begin[key.a] + (parts(key) >> 7);
    const int core_b = key.b < 0 ? -1 : cores_.begin[key.b] + (parts(key) & 127);
    Pair made = pair(key.a, key.b, core_a, core_b);
    made.first = int(at);
    for (int k = 0; k < made.touches && at + k < state.contacts.size(); ++k)
      made.words[k] = state.contacts[at + k].key.feature & 0xffff;
    at += made.touches;
    pairs_.push_back(made);
  }
  ++version_;
}

}  // namespace obscura::sim::plane
