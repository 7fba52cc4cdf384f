// A quiet island at rest needs forces with
//   g + sum f / m = 0,  sum r x f = 0        each f in its friction cone
// which iterations search for as in a step of bodies without speed: what speed they leave, over h, is the
// residual. Of small islands they are found exactly, at the beginning, and later where iterations do not come
// near.

#include "sim/solve/iterate/plane_sleep.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim::plane {

namespace {

constexpr double kHeld = 1e-6;      // of gravity
constexpr int kPairSweeps = 40000;  // pairs times iterations of an island at a time
constexpr int kMostSweeps = 400;
constexpr int kBetweenChecks = 10;
constexpr double kClosed = 1e-6;  // of its thickness: no wider a gap bears

}  // namespace

Rest::Rest(const Model<2>& model, const CoreShapes& cores)
    : model_(model),
      cores_(cores),
      statics_(model),
      mobility_(model),
      turns_(model.bodies.size(), Rotation<2>::Identity()) {
  const std::size_t n = model.bodies.size();
  restless_.resize(n), marked_.assign(n, 0), v_.resize(n + 1), zero_.resize(n + 1);
}

// whether a touch makes an island of two bodies
bool Rest::joins(const Contact<2>& touch, const Pair& pair) const {
  return touch.touching != ContactMode::open ||
         touch.gap < 1e-3 * std::min(cores_.half_thickness[pair.a], cores_.half_thickness[pair.b]);
}

// the two of a joint are of one island, if they are alike
template <class Alike>
void Rest::unite_joined(const State<2>& state, Alike&& alike) {
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const int a = model_.joints[i].a.body, b = model_.joints[i].b.body;
    if (a >= 0 && b >= 0 && !state.broken[i] && alike(a) && alike(b)) islands_.join(a, b);
  }
}

void Rest::freeze(State<2>& state, int body) const {
  state.frozen[body] = 1;
  state.v[body].setZero();
  if (const int k = turning(state, body); k >= 0) state.spin[k].setZero();
}

bool Rest::held(State<2>& state, const Pairs& pairs, std::span<const int> of,
                const std::vector<Pose>& poses) {
  touches_.clear(), bearing_.clear();
  const auto moving = [&](int body) { return body >= 0 && free_[body] ? body : -1; };
  for (const int i : of) {
    const Pair& pair = pairs.all()[i];
    double thin = cores_.half_thickness[pair.a];
    if (pair.b >= 0) thin = std::min(thin, cores_.half_thickness[pair.b]);
    for (int k = pair.first; k < pair.first + pair.touches; ++k) {
      Contact<2>& contact = state.contacts[k];
      const Feature feature = Feature::of(contact.key.feature);
      if (feature.kind == Feature::none) continue;
      const ContactPoint at = pairs.place(pair, poses, feature);
      contact.point = {at.x, at.y}, contact.normal = {at.nx, at.ny}, contact.gap = at.gap;
      if (at.gap > kClosed * thin) continue;
      BearingContact<2> touch{.a = moving(pair.a), .b = moving(pair.b), .normal = contact.normal};
      touch.arm_a = contact.point - state.x[pair.a], touch.friction = pair.material.friction;
      if (pair.b >= 0) touch.arm_b = contact.point - state.x[pair.b];
      touch.force = contact.force;
      touches_.push_back(touch), bearing_.push_back(k);
    }
    if (touches_.size() > Statics<2>::kMost) return false;
  }
  if (!statics_.in_equilibrium(touches_, turns_)) return false;
  std::size_t bears = 0;
  for (const int i : of) {
    const Pair& pair = pairs.all()[i];
    for (int k = pair.first; k < pair.first + pair.touches; ++k) {
      const bool does = bears < bearing_.size() && bearing_[bears] == k;
      Contact<2>& contact = state.contacts[k];
      contact.force = does ? touches_[bears].force : Vec<2>(Vec<2>::Zero()), contact.impulse.setZero();
      contact.touching = contact.force.dot(contact.normal) > 0 ? ContactMode::stick : ContactMode::open;
      bears += does;
    }
  }
  return true;
}

// whether what bears an island leaves its motion `v` any freedom
Mobile Rest::mobile(const State<2>& state, const Pairs& pairs, const JointSolver<2>& joints,
                    std::span<const int> of, std::span<const std::pair<int, int>> members,
                    const std::vector<Motion>& v, double h) {
  mobility_.clear();
  for (const auto& member : members) {
    const int i = member.second;
    mobility_.add(i, {v[i].x, v[i].y}, AngularVec<2>(v[i].w), Rotation<2>::Identity());
  }
  for (const int i : of) {
    const Pair& pair = pairs.all()[i];
    for (int k = pair.first; k < pair.first + pair.touches; ++k) {
      const Contact<2>& contact = state.contacts[k];
      BearingContact<2> touch{.a = pair.a, .b = pair.b, .normal = contact.normal};
      touch.arm_a = contact.point - state.x[pair.a], touch.friction = pair.material.friction;
      if (pair.b >= 0) touch.arm_b = contact.point - state.x[pair.b];
      touch.force = contact.force;
      mobility_.add_contact(touch);
    }
  }
  for (const int part : parts_)
    joints.each_bearing(part, [&](const Row<2>& row, double gain) { mobility_.add_row(row, gain / h); });
  return mobility_.mobile();
}

bool Rest::begin(State<2>& state, const Pairs& pairs, const std::vector<Pose>& poses,
                 const std::vector<Motion>& v, const std::vector<char>& movers) {
  const int n = int(model_.bodies.size());
  islands_.reset(n);
  std::fill(restless_.begin(), restless_.end(), 0);
  free_.assign(n, 0);
  for (int i = 0; i < n; ++i) free_[i] = v[i].im > 0;
  order_.clear();
  for (int i = 0; i < int(pairs.all().size()); ++i) {
    const Pair& pair = pairs.all()[i];
    if (pair.slot < 0) continue;
    double gap = 1e300, thin = cores_.half_thickness[pair.a];
    if (pair.b >= 0) thin = std::min(thin, cores_.half_thickness[pair.b]);
    for (int k = 0; k < pair.touches; ++k) {
      const Feature feature = Feature::of(state.contacts[pair.first + k].key.feature);
      if (feature.kind != Feature::none) gap = std::min(gap, pairs.place(pair, poses, feature).gap);
    }
    if (gap > 1e-3 * thin) continue;
    if (pair.b >= 0 && free_[pair.a] && free_[pair.b]) islands_.join(pair.a, pair.b);
    order_.push_back(i);
  }
  const auto restless = [&](int body) {
    if (body >= 0 && free_[body]) restless_[islands_.root(body)] = 1;
  };
  for (int i = 0; i < n; ++i) {
    if (movers[i] || v[i].x != 0 || v[i].y != 0 || v[i].w != 0) restless(i);
  }
  for (const Joint<2>& joint : model_.joints) restless(joint.a.body), restless(joint.b.body);
  const auto island = [&](int i) {
    const Pair& pair = pairs.all()[i];
    return islands_.root(free_[pair.a] ? pair.a : pair.b);
  };
  std::erase_if(order_, [&](int i) { return restless_[island(i)] != 0; });
  std::stable_sort(order_.begin(), order_.end(), [&](int i, int j) { return island(i) < island(j); });

  bool froze = false;
  for (std::size_t first = 0, last = 0; first < order_.size(); first = last) {
    const int which = island(order_[first]);
    while (last < order_.size() && island(order_[last]) == which) ++last;
    if (!held(state, pairs, {order_.data() + first, last - first}, poses)) continue;
    for (int i = 0; i < n; ++i) {
      if (free_[i] && islands_.root(i) == which) freeze(state, i), froze = true;
    }
  }
  return froze;
}

bool Rest::freeze(State<2>& state, const Pairs& found, std::vector<ContactBatch>& seats,
                  JointSolver<2>& joints, const std::vector<Pose>& poses, const std::vector<Motion>& v,
                  const std::vector<char>& movers, double h, double span) {
  const std::vector<Pair>& pairs = found.all();
  const int n = int(model_.bodies.size());
  bool candidates = false;
  for (int i = 0; i < n; ++i) candidates = candidates || (v[i].im > 0 && state.quiet[i] >= kWait);
  if (!candidates) return false;

  free_.assign(n, 0);
  for (int i = 0; i < n; ++i) free_[i] = v[i].im > 0;

  // islands, and which of them will not rest
  islands_.reset(n);
  std::fill(restless_.begin(), restless_.end(), 0);
  for (const Pair& pair : pairs) {
    if (pair.slot < 0 || pair.b < 0 || v[pair.a].im == 0 || v[pair.b].im == 0) continue;
    for (int k = 0; k < pair.touches; ++k) {
      if (joins(state.contacts[pair.first + k], pair)) islands_.join(pair.a, pair.b);
    }
  }
  unite_joined(state, [&](int body) { return v[body].im > 0; });
  for (int i = 0; i < n; ++i) {
    if (v[i].im > 0 && (state.quiet[i] < kWait || movers[i])) restless_[islands_.root(i)] = 1;
  }
  order_.clear();
  for (int i = 0; i < int(pairs.size()); ++i) {
    const Pair& pair = pairs[i];
    if (pair.slot < 0) continue;
    const int body = v[pair.a].im > 0 ? pair.a : pair.b;
    bool deep = false;
    for (int k = 0; k < pair.touches; ++k)
      deep =
          deep || state.contacts[pair.first + k].gap < -2 * cores_.linear_slop * cores_.bounding_radius[body];
    if (deep) restless_[islands_.root(body)] = 1;
    order_.push_back(i);
  }
  const auto island = [&](int i) { return islands_.root(v[pairs[i].a].im > 0 ? pairs[i].a : pairs[i].b); };
  std::erase_if(order_, [&](int i) { return restless_[island(i)] != 0; });
  std::sort(order_.begin(), order_.end(), [&](int i, int j) {
    const int p = island(i), q = island(j);
    return p != q ? p < q : pairs[i].slot < pairs[j].slot;
  });

  // bodies without speed for a step
  const double g = std::sqrt(model_.gravity.squaredNorm());
  const StepConstants pace{h, 1e300, 0};
  members_.clear();
  for (int i = 0; i < n; ++i) {
    v_[i] = {0, 0, 0, v[i].im};
    if (v[i].im == 0 || restless_[islands_.root(i)]) continue;
    v_[i].x = h * model_.gravity[0], v_[i].y = h * model_.gravity[1];
    members_.emplace_back(islands_.root(i), i);
  }
  std::sort(members_.begin(), members_.end());
  const auto copy_to_joints = [&](int body) {
    joints.body_motion(body).v = {v_[body].x, v_[body].y}, joints.body_motion(body).w[0] = v_[body].w;
  };
  const auto copy_from_joints = [&](int body) {
    const BodyMotion<2>& at = joints.body_motion(body);
    v_[body].x = at.v[0], v_[body].y = at.v[1], v_[body].w = at.w[0];
  };
  if (!joints.empty()) {
    for (const auto& member : members_) {
      if (joints.has(member.second)) copy_to_joints(member.second);
    }
    joints.begin(h);
    for (const auto& member : members_) {
      if (joints.has(member.second)) copy_from_joints(member.second);
    }
  }

  bool froze = false;
  std::size_t begin = 0, end = 0;
  for (std::size_t first = 0, last = 0; first < members_.size(); first = last, begin = end) {
    const int which = members_[first].first;
    parts_.clear();
    for (; last < members_.size() && members_[last].first == which; ++last) {
      const int body = members_[last].second;
      if (joints.has(body)) parts_.push_back(joints.part(body));
    }
    while (end < order_.size() && island(order_[end]) == which) ++end;
    if (begin == end && parts_.empty()) continue;
    double quiet = 1e300;
    for (std::size_t k = first; k < last; ++k) quiet = std::min(quiet, state.quiet[members_[k].second]);
    // a trial leaves other forces behind, to which joints have to settle again
    if (!parts_.empty() && std::floor(quiet / kWait) == std::floor((quiet - span) / kWait)) continue;
    std::sort(parts_.begin(), parts_.end());
    parts_.erase(std::unique(parts_.begin(), parts_.end()), parts_.end());

    // lanes of its own: those of one colour stay together
    some_.clear();
    int lane = kLanes, colour = -1;
    ContactBatch empty{};
    for (int k = 0; k < kLanes; ++k) {
      empty.a[k] = empty.b[k] = n, empty.pair[k] = empty.first[k] = -1, empty.d[0][k] = empty.d[1][k] = -1e9;
    }
    for (std::size_t at = begin; at < end; ++at) {
      const Pair& pair = pairs[order_[at]];
      if (lane == kLanes || pair.colour != colour || pair.alone)
        some_.push_back(empty), lane = 0, colour = pair.colour;
      copy_lane(seats[pair.slot / kLanes], pair.slot % kLanes, some_.back(), lane++);
    }
    const int count = int(some_.size());
    const auto solve_joint_velocities = [&] {
      if (parts_.empty()) return;
      const auto each = [&](const auto& act) {
        for (std::size_t k = first; k < last; ++k) {
          if (joints.has(members_[k].second)) act(members_[k].second);
        }
      };
      each(copy_to_joints);
      for (const int part : parts_) joints.iterate(part);
      each(copy_from_joints);
    };
    start(some_.data(), count, poses.data(), zero_.data(), v_.data(), pace, slow_, fast_);
    const int most = std::clamp(kPairSweeps / std::max(1, int(end - begin)), kBetweenChecks, kMostSweeps);
    double worst = 1e300;
    for (int i = 1; worst > kHeld * g * h && i < most; ++i) {
      solve_joint_velocities();
      iterate(some_.data(), count, poses.data(), v_.data(), pace);
      if (i % kBetweenChecks != 0 && i + 1 < most) continue;
      worst = 0;
      for (std::size_t k = first; k < last; ++k) {
        const Motion& m = v_[members_[k].second];
        worst = std::max(worst, std::sqrt(m.x * m.x + m.y * m.y) +
                                    std::fabs(m.w) * cores_.bounding_radius[members_[k].second]);
      }
    }
    bool held = worst <= kHeld * g * h;
    solve_joint_velocities();
    finish(some_.data(), count, poses.data(), v_.data(), pace, state.contacts.data());
    for (ContactBatch& g4 : some_) {
      for (int k = 0; k < kLanes; ++k) {
        if (g4.pair[k] >= 0)
          copy_lane_forces(g4, k, seats[pairs[g4.pair[k]].slot / kLanes], pairs[g4.pair[k]].slot % kLanes);
      }
    }
    if (!parts_.empty()) {
      for (std::size_t k = first; k < last; ++k) marked_[members_[k].second] = 1;
      joints.keep(state, h, &marked_);
      for (std::size_t k = first; k < last; ++k) marked_[members_[k].second] = 0;
    }
    if (!held && parts_.empty()) {
      // after one wait, two, four, ...
      double due = kWait;
      while (2 * due <= quiet) due *= 2;
      if (quiet - span < due) held = this->held(state, found, {order_.data() + begin, end - begin}, poses);
    }
    if (!held) continue;
    const Mobile moves = mobile(state, found, joints, {order_.data() + begin, end - begin},
                                {members_.data() + first, last - first}, v, h);
    for (std::size_t k = first; k < last; ++k) {
      const int body = members_[k].second;
      if (moves != Mobile::no) continue;
      if (!state.frozen[body]) freeze(state, body), froze = true;
    }
  }
  return froze;
}

bool Rest::wake(State<2>& state, const std::vector<Pair>& pairs, const std::vector<Motion>& v,
                const std::vector<char>& movers, double span) {
  const int n = int(model_.bodies.size());
  const double falls = 0.5 * span * span * std::sqrt(model_.gravity.squaredNorm());
  bool any = false;
  std::fill(restless_.begin(), restless_.end(), 0);
  for (int i = 0; i < n; ++i) {
    if (state.frozen[i] && movers[i]) restless_[i] = 1, any = true;
  }
  for (const Pair& pair : pairs) {
    if (pair.b < 0 || state.frozen[pair.a] == state.frozen[pair.b]) continue;
    if (model_.bodies[pair.a].fixed || model_.bodies[pair.b].fixed) continue;
    const int sleeper = state.frozen[pair.a] ? pair.a : pair.b, other = pair.a + pair.b - sleeper;
    const Motion& m = v[other];
    const double fast = std::sqrt(m.x * m.x + m.y * m.y) + std::fabs(m.w) * cores_.bounding_radius[other];
    double gap = 1e300, nears = 0;
    bool bears = false;
    for (int k = 0; k < pair.touches; ++k) {
      const Contact<2>& contact = state.contacts[pair.first + k];
      gap = std::min(gap, contact.gap), bears = bears || joins(contact, pair);
      const Vec<2> arm = contact.point - state.x[other];
      const double along = contact.normal.dot(Vec<2>(m.x - m.w * arm[1], m.y + m.w * arm[0]));
      nears = std::max(nears, other == pair.a ? -along : along);
    }
    // a body that was slow between two searches does not fall; two beside each other would wake each
    // other in turns. It may come nearer all the same
    const bool slow = !bears && state.quiet[other] > span;
    if (gap < (slow ? span * nears : span * fast + falls)) restless_[sleeper] = 1, any = true;
  }
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const int a = model_.joints[i].a.body, b = model_.joints[i].b.body;
    if (a < 0 || b < 0 || state.broken[i] || model_.bodies[a].fixed || model_.bodies[b].fixed) continue;
    if (state.frozen[a] != state.frozen[b]) restless_[state.frozen[a] ? a : b] = 1, any = true;
  }
  if (!any) return false;

  // all of an island
  islands_.reset(n);
  for (const Pair& pair : pairs) {
    if (pair.b < 0 || !state.frozen[pair.a] || !state.frozen[pair.b]) continue;
    bool together = false;
    for (int k = 0; k < pair.touches; ++k) together = together || joins(state.contacts[pair.first + k], pair);
    if (together) islands_.join(pair.a, pair.b);
  }
  unite_joined(state, [&](int body) { return state.frozen[body] != 0; });
  for (int i = 0; i < n; ++i) {
    if (restless_[i]) restless_[islands_.root(i)] = 1;
  }
  for (int i = 0; i < n; ++i) {
    if (state.frozen[i] && restless_[islands_.root(i)]) state.frozen[i] = 0, state.quiet[i] = 0;
  }
  return true;
}

}  // namespace obscura::sim::plane
