#include "draw/picture/rope_way.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/constraint/joints/pulley.h"

namespace obscura::draw {

using sim::Vec3;

namespace {

constexpr double kArc = 0.05;       // rad: of a rope on a wheel that is drawn as straight
constexpr double kStraight = 1e-6;  // rad: of one that is
constexpr double kLoose = 1e-5;     // of a piece's length: more than this hangs loose
constexpr int kSag = 20;            // pieces of what hangs

}  // namespace

Vec3 place_of(const sim::Snapshot& now, const sim::SceneInfo::Joint::Place& at) {
  if (at.body < 0) return at.local;
  const sim::Snapshot::Body& body = now.bodies[std::size_t(at.body)];
  return body.position + body.orientation * at.local;
}

namespace {

/// A place that a rope is at, and its wheel there, as sim::Winding::offset has it.
struct RopePlace {
  const sim::SceneInfo::Joint::Place* place = nullptr;
  double offset = 0;
};
std::vector<RopePlace> rope_places(const sim::SceneInfo& cast, std::size_t i, const sim::Snapshot& now) {
  std::vector<RopePlace> all;
  const sim::Snapshot::Joint& its = now.joints[i];
  if (its.with < 0) return all;
  const std::size_t last = i + std::size_t(its.with);
  for (std::size_t joint = i; joint <= last; ++joint) {
    const sim::SceneInfo::Joint& piece = cast.joints[joint];
    const std::size_t n = piece.places.size();
    for (std::size_t k = 0; k < n; ++k) {
      const bool begins = k == 0, ends = k + 1 == n;
      if ((begins && joint > i) || (ends && joint < last)) continue;
      const bool inner = !begins && !ends;
      if (inner && (k <= std::size_t(its.off_a) || k + 1 + std::size_t(its.off_b) >= n)) continue;
      const double around = inner && !piece.around.empty() ? piece.around[k - 1] : 0;
      all.push_back({&piece.places[k], begins ? piece.offset_a : ends ? piece.offset_b : around});
    }
  }
  return all;
}

}  // namespace

std::vector<RopeLine> rope_lines(const sim::SceneInfo& cast, std::size_t number, const sim::Snapshot& now) {
  std::vector<RopeLine> all;
  const std::vector<RopePlace> places = rope_places(cast, number, now);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Vec3 p = place_of(now, *places[i].place), q = place_of(now, *places[i + 1].place);
    const double a = places[i].offset, b = places[i + 1].offset;
    if (a == 0 && b == 0) {
      const double far = (q - p).norm();
      all.push_back({p, q, far > 0 ? Vec3((q - p) / far) : Vec3(Vec3::UnitX())});
      continue;
    }
    const auto piece = sim::rope_piece<2>(sim::Vec<2>(p.head<2>()), sim::Vec<2>(q.head<2>()), a - b);
    const Vec3 d(piece.direction[0], piece.direction[1], 0), out(d.y(), -d.x(), 0);
    all.push_back({p + a * out, q + b * out, d});
  }
  return all;
}

namespace {

/// The last of the joints of a rope that are one with joint `i`.
const sim::SceneInfo::Joint& last_piece(const sim::SceneInfo& cast, std::size_t i, const sim::Snapshot& now) {
  return cast.joints[i + std::size_t(std::max(0, now.joints[i].with))];
}

/// A piece of a rope where it lies on the wheel at its a or at its b, as it goes on from there.
struct OnWheel {
  Vec3 along = Vec3::UnitX();
  double offset = 0;
};
OnWheel leaving(const sim::SceneInfo& cast, std::size_t i, bool at_a, const sim::Snapshot& now) {
  const std::vector<RopeLine> lines = rope_lines(cast, i, now);
  return at_a ? OnWheel{lines.front().along, cast.joints[i].offset_a}
              : OnWheel{-lines.back().along, -last_piece(cast, i, now).offset_b};
}

/// The arc of a rope around a wheel, from where it comes along `before` to just before it goes along `after`.
std::vector<Vec3> arc_between(const Vec3& before, const Vec3& after, double offset, int rounds,
                              const Vec3& center) {
  constexpr double kRound = 2 * std::numbers::pi;
  double turn = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
  if (std::fabs(turn) > kStraight && (turn > 0) != (offset > 0)) turn += offset > 0 ? kRound : -kRound;
  turn += (offset > 0 ? kRound : -kRound) * rounds;
  const int steps = std::max(1, int(std::ceil(std::fabs(turn) / kArc)));
  std::vector<Vec3> arc;
  for (int n = 0; n < steps; ++n) {
    const double s = std::sin(turn * n / steps), c = std::cos(turn * n / steps);
    const Vec3 d(c * before.x() - s * before.y(), s * before.x() + c * before.y(), 0);
    arc.push_back(center + offset * Vec3(d.y(), -d.x(), 0));
  }
  return arc;
}

/// The arc of a rope's piece on the wheel at its a or its b, from where the piece before it in the list comes
/// to that wheel to where this one leaves it; nothing where there is no such piece, or it has broken.
std::vector<Vec3> arc_on_wheel(const sim::SceneInfo& cast, std::size_t i, bool at_a,
                               const sim::Snapshot& now) {
  const sim::SceneInfo::Joint& joint = at_a ? cast.joints[i] : last_piece(cast, i, now);
  if ((at_a ? joint.offset_a : joint.offset_b) == 0) return {};
  const int wheel = (at_a ? joint.places.front() : joint.places.back()).body;
  const OnWheel after = leaving(cast, i, at_a, now);
  for (std::size_t k = i; k-- > 0;) {
    const sim::SceneInfo::Joint& first = cast.joints[k];
    if (first.kind != joint.kind || first.rope != joint.rope || first.places.empty() ||
        now.joints[k].broken || now.joints[k].with < 0)
      continue;
    for (const bool its_a : {true, false}) {
      const sim::SceneInfo::Joint& other = its_a ? first : last_piece(cast, k, now);
      if ((its_a ? other.offset_a : other.offset_b) == 0 ||
          (its_a ? other.places.front() : other.places.back()).body != wheel)
        continue;
      const Vec3 before = -leaving(cast, k, its_a, now).along, along = after.along;
      return arc_between(before, along, after.offset, 0,
                         place_of(now, at_a ? joint.places.front() : joint.places.back()));
    }
  }
  return {};
}

}  // namespace

std::vector<Vec3> hanging_rope(const Vec3& a, const Vec3& b, const Vec3& down, double length) {
  const auto way = [&](double sag) {
    std::vector<Vec3> points;
    for (int i = 0; i <= kSag; ++i) {
      const double u = double(i) / kSag;
      points.push_back(a + u * (b - a) + 4 * sag * u * (1 - u) * down);
    }
    return points;
  };
  double low = 0, high = length;
  for (int i = 0; i < 40; ++i) {
    const double half = (low + high) / 2;
    const std::vector<Vec3> points = way(half);
    double its = 0;
    for (int k = 0; k < kSag; ++k) its += (points[k + 1] - points[k]).norm();
    (its < length ? low : high) = half;
  }
  return way(low);
}

std::vector<Vec3> rope_way(const sim::SceneInfo& cast, std::size_t i, const sim::Snapshot& now) {
  const sim::SceneInfo::Joint& joint = cast.joints[i];
  if (now.joints[i].with < 0) return {};
  const std::vector<RopePlace> places = rope_places(cast, i, now);
  const std::vector<RopeLine> lines = rope_lines(cast, i, now);
  const Vec3 down = cast.gravity.norm() > 0 ? Vec3(cast.gravity.normalized()) : Vec3(-Vec3::UnitY());
  // the piece that what is loose hangs from
  std::size_t loose = 0;
  const auto across = [&](const RopeLine& line) {
    const Vec3 far = line.to - line.from;
    return (far - far.dot(down) * down).norm();
  };
  for (std::size_t k = 1; k < lines.size(); ++k)
    if (across(lines[k]) > across(lines[loose]) * (1 + 1e-9)) loose = k;
  std::vector<Vec3> way;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const RopeLine& line = lines[k];
    if (k > 0 && places[k].offset != 0)
      for (const Vec3& point : arc_between(lines[k - 1].along, line.along, places[k].offset, joint.rounds,
                                           place_of(now, *places[k].place)))
        way.push_back(point);
    const double length = (line.to - line.from).norm(), slack = now.joints[i].slack;
    if (k == loose && slack > kLoose * length) {
      for (const Vec3& point : hanging_rope(line.from, line.to, down, length + slack)) way.push_back(point);
      continue;
    }
    way.push_back(line.from), way.push_back(line.to);
  }
  for (const bool at_a : {true, false}) {
    const std::vector<Vec3> arc = arc_on_wheel(cast, i, at_a, now);
    if (at_a)
      way.insert(way.begin(), arc.begin(), arc.end());
    else
      way.insert(way.end(), arc.rbegin(), arc.rend());
  }
  return way;
}

}  // namespace obscura::draw
