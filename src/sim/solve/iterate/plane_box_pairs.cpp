// find_features() (sim/collide/core_shapes.h) of two boxes, four pairs at once. Seen from the reference box,
// turned so that its face looks along +n and its edge runs along +t,
//
//      b1 \      / b0        m, tau   normal of the incident face and the direction of its edge
//          \____/            b0, b1 = c + g_m m +- g_tau tau
//      a0 --------- a1       h_n, h_t: half the sides of the reference box along n and t
//
// the touches are b0, or a0 where b0 lies beyond it, and b1, or a1.

#include "sim/solve/iterate/plane_box_pairs.h"

#include <cmath>

#include "sim/collide/narrow_phase.h"
#include "sim/math/lanes.h"

namespace obscura::sim::plane {

using namespace lanes;

namespace {

constexpr double kAlike = 1e-6;  // of the thinner: so little deeper is not another face

template <class V>
struct Sides {
  V wide, high;
};

template <class V>
OBSCURA_INLINE Sides<V> sides(const HalfSides* halves, const int* i) {
  Sides<V> out;
  for (int k = 0; k < Of<V>::lanes; ++k) out.wide[k] = halves[i[k]].wide, out.high[k] = halves[i[k]].high;
  return out;
}

template <class V>
OBSCURA_INLINE Mask<V> choose(const Mask<V>& which, const Mask<V>& yes, const Mask<V>& no) {
  return (which & yes) | (~which & no);
}

// the face of a from which b is farthest: b's centre in a's frame, cosine and sine of its turn there
template <class V>
OBSCURA_INLINE void reference(const V& x, const V& y, const V& c, const V& s, const Sides<V>& a,
                              const Sides<V>& b, Mask<V>& along_x, V& gap) {
  const V ac = magnitude<V>(c), as = magnitude<V>(s);
  const V gap_x = magnitude<V>(x) - a.wide - (ac * b.wide + as * b.high);
  const V gap_y = magnitude<V>(y) - a.high - (as * b.wide + ac * b.high);
  along_x = gap_x > gap_y, gap = pick<V>(along_x, gap_x, gap_y);
}

template <class V>
OBSCURA_INLINE void meet_four(BoxManifold& m, int lane, const Pose* poses, const HalfSides* halves,
                              double passing) {
  using M = Mask<V>;
  Quad<V> a, b;
  gather(&poses->x, m.a + lane, a), gather(&poses->x, m.b + lane, b);
  const Sides<V> half_a = sides<V>(halves, m.a + lane), half_b = sides<V>(halves, m.b + lane);
  const V none{};

  // each seen from the other
  const V c = a.z * b.z + a.w * b.w, s = a.z * b.w - a.w * b.z;
  const V wx = b.x - a.x, wy = b.y - a.y;
  const V ax = a.z * wx + a.w * wy, ay = a.z * wy - a.w * wx;
  const V bx = -(b.z * wx + b.w * wy), by = -(b.z * wy - b.w * wx);
  M x_of_a, x_of_b;
  V gap_a, gap_b;
  reference<V>(ax, ay, c, s, half_a, half_b, x_of_a, gap_a);
  reference<V>(bx, by, c, -s, half_b, half_a, x_of_b, gap_b);

  // of nearly equals a's face, so that rounding does not choose
  const V thin = smaller<V>(smaller<V>(half_a.wide, half_a.high), smaller<V>(half_b.wide, half_b.high));
  const M swapped = gap_b > gap_a + kAlike * thin;
  const M along_x = choose<V>(swapped, x_of_b, x_of_a);
  const V x = pick<V>(swapped, bx, ax), y = pick<V>(swapped, by, ay);
  const V turn = pick<V>(swapped, -s, s);
  const V r_wide = pick<V>(swapped, half_b.wide, half_a.wide),
          r_high = pick<V>(swapped, half_b.high, half_a.high);
  const V i_wide = pick<V>(swapped, half_a.wide, half_b.wide),
          i_high = pick<V>(swapped, half_a.high, half_b.high);

  // n = +-x or +-y of the reference box, and its face: 0 to 3 look along -y, x, y, -x
  const M back = pick<V>(along_x, x, y) <= none;
  const V sign = pick<V>(back, V{} - 1.0, V{} + 1.0);
  const M face = choose<V>(along_x, choose<V>(back, M{} + 3, M{} + 1), choose<V>(back, M{}, M{} + 2));
  const V cn = sign * pick<V>(along_x, x, y), ct = sign * pick<V>(along_x, y, -x);
  const V hn = pick<V>(along_x, r_wide, r_high), ht = pick<V>(along_x, r_high, r_wide);
  // the incident box's x axis
  const V un = sign * pick<V>(along_x, c, turn), ut = sign * pick<V>(along_x, turn, -c);

  // its face that looks most against n: of -y, x, y, -x the n parts are ut, un, -ut, -un
  M incident{};
  V least = ut, mn = ut, mt = -un;
  const auto lower = [&](const V& along, const V& beside, long long which) __attribute__((always_inline)) {
    const M better = along < least;
    least = pick<V>(better, along, least);
    mn = pick<V>(better, along, mn), mt = pick<V>(better, beside, mt);
    incident = choose<V>(better, M{} + which, incident);
  };
  lower(un, ut, 1), lower(-ut, un, 2), lower(-un, -ut, 3);
  const M side_x = (incident & 1) != 0;
  const V gm = pick<V>(side_x, i_wide, i_high), gt = pick<V>(side_x, i_high, i_wide);

  const V mid_n = cn + mn * gm - hn, mid_t = ct + mt * gm;
  const V gap0 = mid_n - mt * gt, gap1 = mid_n + mt * gt;
  const V s0 = mid_t + mn * gt, s1 = mid_t - mn * gt;
  const V low = smaller<V>(gap0, gap1);

  // words: kind, corner, face; a corner of the reference box is a's unless swapped
  const M a0 = face, a1 = (face + 1) & 3, b0 = (incident + 1) & 3, b1 = incident;
  const auto of_reference = [&](const M& corner) __attribute__((always_inline)) {
    return (swapped & (long long)(Feature::corner_of_b << 14)) | corner << 7 | incident;
  };
  const auto of_incident = [&](const M& corner) __attribute__((always_inline)) {
    return (~swapped & (long long)(Feature::corner_of_b << 14)) | corner << 7 | face;
  };
  const M over0 = s0 >= -ht, over1 = s1 <= ht, nothing = M{} + (long long)(Feature::none << 14);
  M word0 = choose<V>(over0, of_incident(b0), of_reference(a0));
  M word1 = choose<V>(over1, of_incident(b1), of_reference(a1));
  // a corner touches alone where the faces are askew
  const M alone = (over0 ^ over1) & (magnitude<V>(mt) > V{} + kAskew);
  word1 = choose<V>(alone & over0 & (gap0 <= gap1), nothing, word1);
  word0 = choose<V>(alone & over1 & (gap1 <= gap0), nothing, word0);

  // in line with each other's ends: they pass by
  const V shared = smaller<V>(ht, s1) - larger<V>(-ht, s0);
  const M passes =
      (magnitude<V>(mt) < V{} + kParallel) & (magnitude<V>(shared) <= (2 * passing) * smaller<V>(ht, gt));
  // beside each other: corner to corner, if they are apart at all
  const M beyond = s0 > ht, before = s1 < -ht;
  const M apart = (low > none) & (beyond | before);
  const M corner_r = choose<V>(beyond, a1, a0), corner_i = choose<V>(beyond, b0, b1);
  const M corners = (M{} + (long long)(Feature::corners << 14)) |
                    choose<V>(swapped, corner_i, corner_r) << 7 | choose<V>(swapped, corner_r, corner_i);
  const M first =
      choose<V>(passes, nothing, choose<V>(apart, corners, choose<V>(word0 < word1, word0, word1)));
  const M second = choose<V>(passes | apart, nothing, choose<V>(word0 < word1, word1, word0));
  for (int k = 0; k < Of<V>::lanes; ++k) {
    m.words[0][lane + k] = int(first[k]), m.words[1][lane + k] = int(second[k]);
  }
  store<V>(m.gap + lane, low);
}

template <class V>
OBSCURA_INLINE void outdated_all(const ContactBatch* batches, int count, const Motion* v, const Pose* poses,
                                 const HalfSides* halves, double passing, double share,
                                 std::vector<ChangedPair>& boxes, LaneList& others) {
  const V part = V{} + share;
  BoxManifold m;
  for (int i = 0; i < count; ++i) {
    const ContactBatch& g = batches[i];
    if (!g.used) continue;
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Quad<V> a, b;
      gather(&v->x, g.a + lane, a), gather(&v->x, g.b + lane, b);
      const V speed = magnitude<V>(a.x - b.x) + magnitude<V>(a.y - b.y) +
                      (magnitude<V>(a.z) + magnitude<V>(b.z)) * load<V>(g.far + lane);
      const Mask<V> moves = part * speed > load<V>(g.calm + lane);
      if (!any(moves)) continue;
      for (int k = lane; k < lane + Of<V>::lanes; ++k) m.a[k] = g.a[k], m.b[k] = g.b[k];
      meet_four<V>(m, lane, poses, halves, passing);
      for (int k = lane; k < lane + Of<V>::lanes; ++k) {
        if (!moves[k - lane]) continue;
        if (!(g.boxes >> k & 1)) {
          others.push_back(kLanes * i + k);
        } else if (m.words[0][k] != g.words[0][k] || m.words[1][k] != g.words[1][k]) {
          boxes.push_back({g.pair[k], {m.words[0][k], m.words[1][k]}});
        }
      }
    }
  }
}
OBSCURA_WIDE void outdated_wide(const ContactBatch* batches, int count, const Motion* v, const Pose* poses,
                                const HalfSides* halves, double passing, double share,
                                std::vector<ChangedPair>& boxes, LaneList& others) {
  outdated_all<V4>(batches, count, v, poses, halves, passing, share, boxes, others);
}

template <class V>
OBSCURA_INLINE void meet_all(BoxManifold* manifolds, int count, const Pose* poses, const HalfSides* halves,
                             double passing) {
  for (BoxManifold* m = manifolds; m < manifolds + count; ++m) {
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) meet_four<V>(*m, lane, poses, halves, passing);
  }
}
OBSCURA_WIDE void meet_wide(BoxManifold* manifolds, int count, const Pose* poses, const HalfSides* halves,
                            double passing) {
  meet_all<V4>(manifolds, count, poses, halves, passing);
}

}  // namespace

std::vector<HalfSides> halves(const CoreShapes& cores) {
  std::vector<HalfSides> all;
  for (std::size_t body = 0; body + 1 < cores.begin.size(); ++body) {
    const CoreShape& core = cores.all[cores.begin[body]];
    const bool box = cores.begin[body + 1] == cores.begin[body] + 1 && core.wide > 0;
    all.push_back(box ? HalfSides{core.wide, core.high} : HalfSides{});
  }
  all.emplace_back();
  return all;
}

void find_outdated(const ContactBatch* batches, int count, const Motion* v, const Pose* poses,
                   const HalfSides* halves, double passing, double share, std::vector<ChangedPair>& boxes,
                   LaneList& others) {
  boxes.clear(), others.clear();
  four_lanes ? outdated_wide(batches, count, v, poses, halves, passing, share, boxes, others)
             : outdated_all<V2>(batches, count, v, poses, halves, passing, share, boxes, others);
}

void collide_boxes(BoxManifold* manifolds, int count, const Pose* poses, const HalfSides* halves,
                   double passing) {
  four_lanes ? meet_wide(manifolds, count, poses, halves, passing)
             : meet_all<V2>(manifolds, count, poses, halves, passing);
}

}  // namespace obscura::sim::plane
