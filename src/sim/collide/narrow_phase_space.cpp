// Narrow phase in space: which features touch. The face of greatest separation is the touching face; among
// the faces around the other's deepest vertex, the one most against it is its partner. Seen along the
// touching face's normal n, their overlap is a convex region, and each of its vertices is one of three:
//
//        ________________
//       |     1----------|---2
//       |     | shared   |   |
//       |_____3__________4   |
//
//   a corner of the other over the touching face      n . (p - p_face)
//   a corner of the touching face over its partner    n' . (p - p_partner)
//   an edge of each, crossing                         e x e' . (p - p') / |e x e'|
//
// Heights are measured along n: none is lower than the deepest vertex, so no gap is deeper than the greatest
// separation. If the least of these gaps is the greatest separation, they are the contact; for shapes apart
// only gaps count whose own nearest places lie on the features. Otherwise the touching features are two edges
// alone, or the shapes are apart and their nearest features are vertices and edges. Parallel faces that share
// only a line do not touch, as in the plane.

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/collide/narrow_phase.h"
#include "sim/shape/polyhedron.h"

namespace obscura::sim {

namespace {

constexpr double kOblique = 1e-10;   // of a core: kAligned on faces that are not parallel
constexpr double kAlongside = 1e-4;  // rad: edges that lie beside each other
constexpr double kSteep = 0.1;       // cosine: a partner that leans more is not under a corner
constexpr double kSharp = 0.05;      // sine between edges that cross
constexpr double kRounding = 1e-12;

using CandidateKind = ContactCandidate<3>::Kind;
using Flat = Vec<2>;

// a list that allocates only when it is long
template <class T, int N>
class Few {
 public:
  void push_back(const T& item) {
    if (size_ < N) {
      near_[size_] = item;
    } else {
      far_.push_back(item);
    }
    ++size_;
  }
  const T& operator[](int i) const { return i < N ? near_[i] : far_[i - N]; }
  int size() const { return size_; }

 private:
  std::array<T, N> near_;
  std::vector<T> far_;
  int size_ = 0;
};

// What a key counts: the kinds, and two more.
constexpr unsigned kPlaceOnEdge = 6, kTurnedEdges = 7, kKeyKinds = 8;

// two cores, part by part of two bodies
struct Couple {
  int a, b;
  const Polyhedron &of_a, &of_b;
  int part_a, part_b, parts_b;
  int digits_a, digits_b;  // more than any corner's, edge's or face's number

  double radii() const { return of_a.radius() + of_b.radius(); }

  // which: numbers of the corner, edge or face of a, and of b
  ContactKey key(unsigned kind, int which_a, int which_b) const {
    unsigned feature = (kind + kKeyKinds * unsigned(part_a)) * unsigned(parts_b) + unsigned(part_b);
    feature = (feature * unsigned(digits_a) + unsigned(which_a)) * unsigned(digits_b) + unsigned(which_b);
    return {a, b, int(feature & 0x7fffffffu)};
  }
  ContactCandidate<3> named(CandidateKind kind, int which_a, int which_b) const {
    ContactCandidate<3> made;
    made.key = key(unsigned(kind), which_a, which_b);
    made.kind = kind;
    made.radius_a = of_a.radius();
    made.radius_b = of_b.radius();
    return made;
  }
  ContactCandidate<3> corner_of_a(int corner, int face, double core) const {
    ContactCandidate<3> made = named(CandidateKind::corner_of_a, corner, face);
    made.on_a = of_a.own_corner(corner), made.on_b = of_b.own_corner(of_b.loop(face)[0]);
    made.normal = of_b.own_normal(face);
    made.value = core - radii();
    return made;
  }
  ContactCandidate<3> corner_of_b(int face, int corner, double core) const {
    ContactCandidate<3> made = named(CandidateKind::corner_of_b, face, corner);
    made.on_a = of_a.own_corner(of_a.loop(face)[0]), made.on_b = of_b.own_corner(corner);
    made.normal = of_a.own_normal(face);
    made.value = core - radii();
    return made;
  }
  ContactCandidate<3> corners(int of_one, int of_other, double core) const {
    ContactCandidate<3> made = named(CandidateKind::corners, of_one, of_other);
    made.on_a = of_a.own_corner(of_one), made.on_b = of_b.own_corner(of_other);
    made.value = core - radii();
    return made;
  }
  ContactCandidate<3> corner_at_edge_b(int corner, int edge, double core) const {
    ContactCandidate<3> made = named(CandidateKind::corner_at_edge_b, corner, edge);
    made.on_a = of_a.own_corner(corner), made.on_b = of_b.own_corner(of_b.edge(edge).from);
    made.edge_b = of_b.own_along(edge);
    made.value = core - radii();
    return made;
  }
  ContactCandidate<3> corner_at_edge_a(int edge, int corner, double core) const {
    ContactCandidate<3> made = named(CandidateKind::corner_at_edge_a, edge, corner);
    made.on_a = of_a.own_corner(of_a.edge(edge).from), made.on_b = of_b.own_corner(corner);
    made.edge_a = of_a.own_along(edge);
    made.value = core - radii();
    return made;
  }
  // turned: against how they run, so that their cross product leads from b to a
  ContactCandidate<3> edges(int edge_a, int edge_b, bool turned, double core) const {
    ContactCandidate<3> made = named(CandidateKind::edges, edge_a, edge_b);
    if (turned) made.key = key(kTurnedEdges, edge_a, edge_b);
    made.on_a = of_a.own_corner(of_a.edge(edge_a).from), made.on_b = of_b.own_corner(of_b.edge(edge_b).from);
    made.edge_a = of_a.own_along(edge_a), made.edge_b = of_b.own_along(edge_b);
    if (turned) made.edge_b = -made.edge_b;
    made.value = core - radii();
    return made;
  }
  // normal: about from b to a
  ContactCandidate<3> edges(int edge_a, int edge_b, const Vec<3>& normal, double core) const {
    return edges(edge_a, edge_b, of_a.along(edge_a).cross(of_b.along(edge_b)).dot(normal) < 0, core);
  }
};

// Two cores of which the first owns the touching face.
struct ReferenceFace {
  const Polyhedron &base, &other;
  bool base_is_b;  // else a
  FaceAxis by;     // of the base
  double best;     // greatest separation, by faces or edges

  ContactCandidate<3> other_at_base(const Couple& couple, int corner, double core) const {
    return base_is_b ? couple.corner_of_a(corner, by.face, core) : couple.corner_of_b(by.face, corner, core);
  }
  ContactCandidate<3> base_at_other(const Couple& couple, int corner, int partner, double core) const {
    return base_is_b ? couple.corner_of_b(partner, corner, core) : couple.corner_of_a(corner, partner, core);
  }
};

void keep(const ContactCandidate<3>& gap, double margin, std::vector<ContactCandidate<3>>& out) {
  if (gap.value < margin) out.push_back(gap);
}

// a face seen along a normal: its corners, where they are seen, and how high they lie
struct Seen {
  int corner;
  Flat at;
  double height;
};
struct Loop : Few<Seen, 16> {
  struct Side {
    Flat way;
    double length;
  };
  Few<Side, 16> sides;  // from each corner to the next, the last to the first

  int next(int i) const { return i + 1 < size() ? i + 1 : 0; }
  void close() {
    for (int i = 0; i < size(); ++i) {
      const Flat way = (*this)[next(i)].at - (*this)[i].at;
      sides.push_back({way, std::sqrt(way.squaredNorm())});
    }
  }
};

double cross(const Flat& p, const Flat& q) { return p[0] * q[1] - p[1] * q[0]; }

// whether a point lies within a loop, up to `slack` beyond it. A loop of two holds none.
bool within(const Loop& loop, const Flat& p, double slack) {
  if (loop.size() < 3) return false;
  for (int i = 0; i < loop.size(); ++i) {
    if (cross(loop.sides[i].way, p - loop[i].at) < -slack * loop.sides[i].length) return false;
  }
  return true;
}

// how wide what lies about the points is, across the way between the farthest two
double width(const Few<Flat, 16>& points) {
  double most = 0;
  Flat from = Flat::Zero(), way = Flat::Zero();
  for (int i = 0; i < points.size(); ++i) {
    for (int k = i + 1; k < points.size(); ++k) {
      const double d = (points[k] - points[i]).squaredNorm();
      if (d > most) most = d, from = points[i], way = points[k] - points[i];
    }
  }
  if (most == 0) return 0;
  double low = 0, high = 0;
  for (int i = 0; i < points.size(); ++i) {
    const double off = cross(way, points[i] - from) / std::sqrt(most);
    low = std::min(low, off), high = std::max(high, off);
  }
  return high - low;
}

// whether two edges cross within both their lengths
bool cross_within(const Polyhedron& a, const Polyhedron& b, int of_a, int of_b) {
  const Polyhedron::Edge p = a.edge(of_a), q = b.edge(of_b);
  const Vec<3> p0 = a.corner(p.from), q0 = b.corner(q.from), along_a = a.along(of_a), along_b = b.along(of_b);
  const Crossing at = crossing(p0 - q0, along_a, along_b);
  const double length_a = along_a.dot(a.corner(p.to) - p0), length_b = along_b.dot(b.corner(q.to) - q0);
  return at.s >= -kRounding * length_a && at.s <= length_a * (1 + kRounding) &&
         at.t >= -kRounding * length_b && at.t <= length_b * (1 + kRounding);
}

// The region that a touching face shares with its partner.
class Shared {
 public:
  // Appends its gaps to `out`.
  Shared(const Couple& couple, const ReferenceFace& touching, std::vector<ContactCandidate<3>>& out)
      : couple_(couple), touching_(touching), gaps_(out), begin_(out.size()) {
    const Polyhedron &base = touching.base, &other = touching.other;
    n_ = base.normal(touching.by.face);
    t_ = perpendicular<3>(n_), u_ = n_.cross(t_);
    origin_ = base.corner(base.loop(touching.by.face)[0]);
    for (const int corner : base.loop(touching.by.face)) own_.push_back(seen(base, corner));
    if (other.faces() > 0) {
      partner_ = other.facing(touching.by.corner, -n_);
      const std::span<const int> around = other.loop(partner_);
      for (auto corner = around.rbegin(); corner != around.rend(); ++corner)
        its_.push_back(seen(other, *corner));
      partner_n_ = other.normal(partner_);
      partner_origin_ = other.corner(around[0]);
      parallel_ = n_.cross(partner_n_).squaredNorm() < kParallel * kParallel && n_.dot(partner_n_) < 0;
    } else {
      its_.push_back(seen(other, 0)), its_.push_back(seen(other, 1));
    }
    own_.close(), its_.close();
    const double size =
        std::min(base.bounding_radius(),
                 other.bounding_radius() > 0 ? other.bounding_radius() : base.bounding_radius());
    aligned_ = (parallel_ ? kAligned : kOblique) * size;

    const bool other_first = touching.base_is_b || !parallel_;
    if (other_first) {
      corners_of_other(), corners_of_base();
    } else {
      corners_of_base(), corners_of_other();
    }
    crossings();
  }

  // whether parallel faces are in line with each other's ends: they pass by
  bool passes() const { return parallel_ && places_.size() > 0 && width(places_) <= aligned_; }

  // whether its gaps are what touches: the least of them is the greatest separation
  bool found() const { return least_ <= touching_.best + aligned_ && least_ >= touching_.best - aligned_; }

  // Drops the gaps that are askew, but for the least.
  void drop_askew() {
    std::size_t kept = begin_;
    for (std::size_t i = begin_; i < gaps_.size(); ++i) {
      const bool least = gaps_[i].value + couple_.radii() <= least_;
      if (least || !askew_[int(i - begin_)]) gaps_[kept++] = gaps_[i];
    }
    gaps_.resize(kept);
  }

  // drops the gaps beyond `margin`
  void keep_near(double margin) {
    // If the shapes are apart and the faces oblique, a corner beside the partner may seem to lie over it. Its
    // gap is then less than the separation of the shapes: drop it.
    const double nearest = touching_.best > 0 ? touching_.best * (1 - kAligned) - aligned_ : -1e300;
    gaps_.erase(std::remove_if(gaps_.begin() + std::ptrdiff_t(begin_), gaps_.end(),
                               [&](const ContactCandidate<3>& gap) {
                                 return !(gap.value < margin && gap.value + couple_.radii() >= nearest);
                               }),
                gaps_.end());
  }

  // drops them all
  void drop() { gaps_.resize(begin_); }

 private:
  Seen seen(const Polyhedron& of, int corner) const {
    const Vec<3> place = of.corner(corner) - origin_;
    return {corner, {t_.dot(place), u_.dot(place)}, n_.dot(place)};
  }

  bool taken(const Flat& at) const {
    for (int i = 0; i < places_.size(); ++i) {
      if ((places_[i] - at).squaredNorm() <= 4 * aligned_ * aligned_) return true;
    }
    return false;
  }

  // `normal`: of the gap; real: its nearest places lie on the features
  void add(const Flat& at, const ContactCandidate<3>& gap, const Vec<3>& normal, bool real) {
    places_.push_back(at), gaps_.push_back(gap);
    askew_.push_back(n_.cross(normal).squaredNorm() > kAskew * kAskew);
    if (real || touching_.best <= 0) least_ = std::min(least_, gap.value + couple_.radii());
  }

  void corners_of_other() {
    for (int i = 0; i < its_.size(); ++i) {
      if (!within(own_, its_[i].at, aligned_) || taken(its_[i].at)) continue;
      add(its_[i].at, touching_.other_at_base(couple_, its_[i].corner, its_[i].height), n_, true);
    }
  }

  void corners_of_base() {
    if (its_.size() < 3 || partner_n_.dot(n_) > -kSteep) return;
    for (int i = 0; i < own_.size(); ++i) {
      if (!within(its_, own_[i].at, aligned_) || taken(own_[i].at)) continue;
      const Vec<3> place = touching_.base.corner(own_[i].corner);
      add(own_[i].at,
          touching_.base_at_other(couple_, own_[i].corner, partner_, partner_n_.dot(place - partner_origin_)),
          partner_n_, touching_.best <= 0 || over(touching_.other, partner_, place, aligned_));
    }
  }

  void crossings() {
    const int sides = its_.size() > 2 ? its_.size() : 1;
    const auto across = [&](double from, double to) {
      return std::min(from, to) < -aligned_ && std::max(from, to) > aligned_;
    };
    for (int i = 0; i < own_.size(); ++i) {
      const Seen &p0 = own_[i], &p1 = own_[own_.next(i)];
      const auto& [p, p_length] = own_.sides[i];
      for (int k = 0; k < sides; ++k) {
        const Seen &q0 = its_[k], &q1 = its_[its_.next(k)];
        const auto& [q, q_length] = its_.sides[k];
        if (q_length <= aligned_) continue;
        // most lie on one side
        double d0 = cross(p, q0.at - p0.at), d1 = cross(p, q1.at - p0.at);
        if ((d0 < 0) == (d1 < 0)) continue;
        double e0 = cross(q, p0.at - q0.at), e1 = cross(q, p1.at - q0.at);
        if ((e0 < 0) == (e1 < 0)) continue;
        d0 /= p_length, d1 /= p_length, e0 /= q_length, e1 /= q_length;
        if (!across(d0, d1) || !across(e0, e1)) continue;
        const double on_q = d0 / (d0 - d1);
        const Flat at = q0.at + on_q * q;
        if (!taken(at)) cross_at(at, p0.corner, p1.corner, q0, q1, on_q);
      }
    }
  }

  void cross_at(const Flat& at, int p0, int p1, const Seen& q0, const Seen& q1, double on_q) {
    const Polyhedron &base = touching_.base, &other = touching_.other;
    const int of_base = base.edge_between(p0, p1), of_other = other.edge_between(q0.corner, q1.corner);
    const Vec<3> from = base.corner(p0), to = other.corner(q0.corner);
    Vec<3> n = (base.corner(p1) - from).normalized().cross((other.corner(q1.corner) - to).normalized());
    const double sine = std::sqrt(n.squaredNorm());
    if (sine >= kSharp) {
      n /= n.dot(n_) < 0 ? -sine : sine;
      if (n.dot(n_) < kSteep) return;
      const double core = n.dot(to - from);
      const bool real = touching_.best <= 0 || cross_within(base, other, of_base, of_other);
      // nearest beyond their ends: what lies there is neither's, but the place is taken
      if (!real) return places_.push_back(at);
      add(at,
          touching_.base_is_b ? couple_.edges(of_other, of_base, n, core)
                              : couple_.edges(of_base, of_other, -n, core),
          n, true);
      return;
    }
    // too nearly parallel to tell a normal: the place on the other's edge against the touching face
    const double height = q0.height + on_q * (q1.height - q0.height);
    const Vec<3> place = other.own_place(to + on_q * (other.corner(q1.corner) - to));
    ContactCandidate<3> gap = touching_.other_at_base(couple_, q0.corner, height);
    gap.key = couple_.key(kPlaceOnEdge, touching_.base_is_b ? of_other : of_base,
                          touching_.base_is_b ? of_base : of_other);
    (touching_.base_is_b ? gap.on_a : gap.on_b) = place, gap.of_poses = true;
    add(at, gap, n_, false);
  }

  const Couple& couple_;
  const ReferenceFace& touching_;
  Vec<3> n_, t_, u_, origin_, partner_n_ = Vec<3>::Zero(), partner_origin_ = Vec<3>::Zero();
  int partner_ = -1;
  bool parallel_ = false;
  double aligned_ = 0, least_ = 1e300;
  Loop own_, its_;
  Few<Flat, 16> places_;
  Few<char, 16> askew_;  // of its gaps
  std::vector<ContactCandidate<3>>& gaps_;
  std::size_t begin_;
};

// No face is nearest and no crossing edges: vertices and edges; for parallel edges both ends of the part that
// they share.
void nearest_features(const Couple& couple, const ReferenceFace* touching, double margin,
                      std::vector<ContactCandidate<3>>& out) {
  const Polyhedron &a = couple.of_a, &b = couple.of_b;
  const int edges_a = std::max(1, a.edges()), edges_b = std::max(1, b.edges());
  const auto edge = [](const Polyhedron& of, int i) { return of.edges() ? of.edge(i) : Polyhedron::Edge{}; };
  Nearest best{0, 0, 1e300};
  int of_a = 0, of_b = 0;
  for (int i = 0; i < edges_a; ++i) {
    const Polyhedron::Edge p = edge(a, i);
    const Vec<3> p0 = a.corner(p.from), p1 = a.corner(p.to);
    for (int k = 0; k < edges_b; ++k) {
      const Polyhedron::Edge q = edge(b, k);
      const Nearest here = nearest(p0, p1, b.corner(q.from), b.corner(q.to));
      if (here.apart < best.apart) best = here, of_a = i, of_b = k;
    }
  }
  const double size = std::min(a.bounding_radius() > 0 ? a.bounding_radius() : b.bounding_radius(),
                               b.bounding_radius() > 0 ? b.bounding_radius() : a.bounding_radius());
  const double aligned = kAligned * size;
  if (best.apart <= kOblique * size && touching) {
    // at one place and sharp: the deepest corner at the touching face
    return keep(touching->other_at_base(couple, touching->by.corner, touching->by.value), margin, out);
  }

  // edges beside each other
  for (int i = 0; i < a.edges(); ++i) {
    const Polyhedron::Edge p = a.edge(i);
    const Vec<3> p0 = a.corner(p.from), along = a.along(i);
    const double length = along.dot(a.corner(p.to) - p0);
    for (int k = 0; k < b.edges(); ++k) {
      if (along.cross(b.along(k)).squaredNorm() > kAlongside * kAlongside) continue;
      const Polyhedron::Edge q = b.edge(k);
      const Vec<3> q0 = b.corner(q.from), q1 = b.corner(q.to);
      if (nearest(p0, a.corner(p.to), q0, q1).apart > best.apart + aligned) continue;
      double ends[2] = {along.dot(q0 - p0), along.dot(q1 - p0)};
      int corners[2] = {q.from, q.to};
      if (ends[0] > ends[1]) std::swap(ends[0], ends[1]), std::swap(corners[0], corners[1]);
      if (std::min(length, ends[1]) - std::max(0.0, ends[0]) <= aligned) continue;
      for (int end = 0; end < 2; ++end) {
        // the inner of both corners
        const double inner = end ? length - ends[1] : ends[0];
        if (inner <= aligned) {
          const int corner = end ? p.to : p.from;
          const Vec<3> d = a.corner(corner) - q0, way = b.along(k);
          keep(couple.corner_at_edge_b(corner, k, std::sqrt((d - way * way.dot(d)).squaredNorm())), margin,
               out);
        } else {
          const Vec<3> d = b.corner(corners[end]) - p0;
          keep(couple.corner_at_edge_a(i, corners[end], std::sqrt((d - along * along.dot(d)).squaredNorm())),
               margin, out);
        }
      }
      return;
    }
  }

  const auto end = [](const Polyhedron::Edge& of, double on) { return on <= kRounding ? of.from : of.to; };
  const auto inner = [](double on) { return on > kRounding && on < 1 - kRounding; };
  const Polyhedron::Edge p = edge(a, of_a), q = edge(b, of_b);
  const bool in_a = a.edges() > 0 && inner(best.on_p), in_b = b.edges() > 0 && inner(best.on_q);
  if (in_a && in_b) {
    const Vec<3> apart = (a.corner(p.from) + best.on_p * (a.corner(p.to) - a.corner(p.from))) -
                         (b.corner(q.from) + best.on_q * (b.corner(q.to) - b.corner(q.from)));
    keep(couple.edges(of_a, of_b, apart, best.apart), margin, out);
  } else if (in_a) {
    keep(couple.corner_at_edge_a(of_a, end(q, best.on_q), best.apart), margin, out);
  } else if (in_b) {
    keep(couple.corner_at_edge_b(end(p, best.on_p), of_b, best.apart), margin, out);
  } else {
    keep(couple.corners(end(p, best.on_p), end(q, best.on_q), best.apart), margin, out);
  }
}

void solid_gaps(const Couple& couple, double margin, Gaps sought, std::vector<ContactCandidate<3>>& out,
                Clearance& clearance) {
  const Polyhedron &a = couple.of_a, &b = couple.of_b;
  const double far = margin + couple.radii();
  const double both = a.bounding_radius() + b.bounding_radius(), radii = std::max(far, 0.0) + both;
  const double between = (a.middle() - b.middle()).squaredNorm();
  if (between > radii * radii) return clearance.add(std::sqrt(between) - both - couple.radii(), 1);

  if (a.faces() + b.faces() == 0) {
    clearance.add(-1e300, 1);
    if (couple.radii() > 0) nearest_features(couple, nullptr, margin, out);
    return;
  }
  FaceAxis by_a, by_b;
  EdgeAxis by_edges;
  if (b.faces()) by_b = greatest_separation(b, a, far);
  if (by_b.value >= far) return clearance.add(by_b.value - couple.radii(), 1);
  if (a.faces()) by_a = greatest_separation(a, b, far);
  if (by_a.value >= far) return clearance.add(by_a.value - couple.radii(), 1);
  if (a.edges() && b.edges()) by_edges = greatest_edge_separation(a, b, far);
  if (by_edges.value >= far) {
    // of boxes any two edges along these axes; of others they may be farthest no more
    if (!a.is_box() || !b.is_box()) return clearance.add(-1e300, 1);
    const double sine = std::sqrt(a.along(by_edges.of_a).cross(b.along(by_edges.of_b)).squaredNorm());
    return clearance.add(by_edges.value - couple.radii(), 1 + 2 / sine);
  }
  clearance.add(-1e300, 1);

  const bool base_is_b = b.faces() && by_b.value >= by_a.value;
  const ReferenceFace touching{base_is_b ? b : a, base_is_b ? a : b, base_is_b, base_is_b ? by_b : by_a,
                               std::max({by_a.value, by_b.value, by_edges.value})};
  if (touching.by.face < 0) return;  // what stands nowhere, of a state that is no more
  if (touching.other.edges() == 0) {
    const double slack = kOblique * touching.base.bounding_radius();
    if (touching.best <= 0 ||
        over(touching.base, touching.by.face, touching.other.corner(touching.by.corner), slack)) {
      return keep(touching.other_at_base(couple, touching.by.corner, touching.by.value), margin, out);
    }
    return nearest_features(couple, &touching, margin, out);
  }

  Shared shared(couple, touching, out);
  if (shared.passes()) return shared.drop();
  if (shared.found()) {
    if (sought == Gaps::touching) shared.drop_askew();
    return shared.keep_near(margin);
  }
  shared.drop();
  const bool edges = by_edges.value > touching.by.value;
  if (edges && (touching.best <= 0 || cross_within(a, b, by_edges.of_a, by_edges.of_b))) {
    return keep(couple.edges(by_edges.of_a, by_edges.of_b, by_edges.normal, by_edges.value), margin, out);
  }
  if (touching.best <= 0) {
    return keep(touching.other_at_base(couple, touching.by.corner, touching.by.value), margin, out);
  }
  nearest_features(couple, &touching, margin, out);
}

// more than the number of any corner, edge or face of any part
int digits(const Shape<3>& shape) {
  int most = 2;
  for (int i = 0; i < parts(shape); ++i) {
    const Core<3> one = core(part(shape, i));
    most = std::max(most, one.box ? 12 : int(one.corners.size() + one.faces.size()));
  }
  return most;
}

// whether keys of two shapes have room for all of their features
bool keys_suffice(const Shape<3>& a, const Shape<3>& b) {
  return double(kKeyKinds) * parts(a) * parts(b) * digits(a) * digits(b) <= double(0x7fffffff);
}

}  // namespace

template <>
void collide(int a, const Shape<3>& shape_a, const BodyMotion<3>& at_a, int b, const Shape<3>& shape_b,
             const BodyMotion<3>& at_b, double margin, std::vector<ContactCandidate<3>>& out) {
  Clearance clearance;
  collide(a, shape_a, at_a, b, shape_b, at_b, margin, Gaps::all, out, clearance);
}

void collide(int a, const Shape<3>& shape_a, const BodyMotion<3>& at_a, int b, const Shape<3>& shape_b,
             const BodyMotion<3>& at_b, double margin, Gaps sought, std::vector<ContactCandidate<3>>& out,
             Clearance& clearance) {
  const int digits_a = digits(shape_a), digits_b = digits(shape_b);
  const std::size_t before = out.size();
  for (int i = 0; i < parts(shape_a); ++i) {
    const Polyhedron of_a(part(shape_a, i), at_a, at_b.x);
    for (int k = 0; k < parts(shape_b); ++k) {
      const Polyhedron of_b(part(shape_b, k), at_b, at_b.x);
      solid_gaps({a, b, of_a, of_b, i, k, parts(shape_b), digits_a, digits_b}, margin, sought, out,
                 clearance);
    }
  }
  if (out.size() > before && !keys_suffice(shape_a, shape_b)) {
    for (std::size_t i = before; i < out.size(); ++i) out[i].of_poses = true;
  }
  std::sort(out.begin() + std::ptrdiff_t(before), out.end(),
            [](const ContactCandidate<3>& p, const ContactCandidate<3>& q) { return p.key < q.key; });
}

std::optional<ContactCandidate<3>> named_candidate(const ContactKey& key, const Shape<3>& shape_a,
                                                   const Shape<3>& shape_b) {
  const int digits_a = digits(shape_a), digits_b = digits(shape_b), parts_b = parts(shape_b);
  if (key.b < 0 || !keys_suffice(shape_a, shape_b)) return {};
  int left = key.feature;
  const auto digit = [&](int radix) {
    const int value = left % radix;
    left /= radix;
    return value;
  };
  const int which_b = digit(digits_b), which_a = digit(digits_a), part_b = digit(parts_b);
  const unsigned kind = unsigned(digit(int(kKeyKinds)));
  if (kind == kPlaceOnEdge) return {};
  const BodyMotion<3> own;
  const Polyhedron of_a(part(shape_a, left), own, own.x), of_b(part(shape_b, part_b), own, own.x);
  const Couple couple{key.a, key.b, of_a, of_b, left, part_b, parts_b, digits_a, digits_b};
  if (kind == kTurnedEdges) return couple.edges(which_a, which_b, true, 0);
  switch (CandidateKind(kind)) {
    case CandidateKind::corner_of_a:
      return couple.corner_of_a(which_a, which_b, 0);
    case CandidateKind::corner_of_b:
      return couple.corner_of_b(which_a, which_b, 0);
    case CandidateKind::corners:
      return couple.corners(which_a, which_b, 0);
    case CandidateKind::edges:
      return couple.edges(which_a, which_b, false, 0);
    case CandidateKind::corner_at_edge_b:
      return couple.corner_at_edge_b(which_a, which_b, 0);
    case CandidateKind::corner_at_edge_a:
      return couple.corner_at_edge_a(which_a, which_b, 0);
    case CandidateKind::corner_at_rail_b:  // these have keys of their own
    case CandidateKind::corner_at_rail_a:
    case CandidateKind::face_at_rail_b:
    case CandidateKind::face_at_rail_a:
      break;
  }
  return {};
}

template <>
void collide(int a, const Shape<3>& shape, const BodyMotion<3>& at, int wall, const Wall<3>& half_space,
             double margin, std::vector<ContactCandidate<3>>& out) {
  const int digits_a = digits(shape);
  for (int i = 0; i < parts(shape); ++i) {
    const Polyhedron solid(part(shape, i), at, half_space.point);
    for (int k = 0; k < solid.corners(); ++k) {
      const double value = half_space.normal.dot(solid.corner(k)) - solid.radius();
      if (!(value < margin)) continue;
      ContactCandidate<3> made;
      made.key = {a, -1 - wall, i * digits_a + k};
      made.kind = CandidateKind::corner_of_a;
      made.on_a = solid.own_corner(k);
      made.on_b = half_space.point;
      made.normal = half_space.normal;
      made.radius_a = solid.radius();
      made.value = value;
      out.push_back(made);
    }
  }
}

template <>
double separation(const Shape<3>& a, const BodyMotion<3>& at_a, const Shape<3>& b,
                  const BodyMotion<3>& at_b) {
  double least = 1e300;
  for (int i = 0; i < parts(a); ++i) {
    const Polyhedron of_a(part(a, i), at_a, at_b.x);
    for (int k = 0; k < parts(b); ++k) {
      const Polyhedron of_b(part(b, k), at_b, at_b.x);
      least = std::min(least, core_separation(of_a, of_b) - of_a.radius() - of_b.radius());
    }
  }
  return least;
}

double separation_along(const Vec<3>& n, const Shape<3>& a, const BodyMotion<3>& at_a, const Shape<3>& b,
                        const BodyMotion<3>& at_b) {
  const auto reach = [](const Shape<3>& shape, const BodyMotion<3>& at, const Vec<3>& d) {
    double most = -1e300;
    for (int i = 0; i < parts(shape); ++i) {
      const Core<3> one = core(part(shape, i));
      most = std::max(most, reach_along(one, at.room_from_body, d) + one.radius);
    }
    return most;
  };
  return n.dot(at_a.x - at_b.x) - reach(a, at_a, -n) - reach(b, at_b, n);
}

}  // namespace obscura::sim
