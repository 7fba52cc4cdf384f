// Bodies in space: triangles for what faces the eye, and outlines and creases as lines where they are seen.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/picture/joint_look.h"
#include "draw/picture/upright.h"
#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kEdgeLine = 2.3;                            // page units
constexpr double kSilhouetteLine = 1.3, kCreaseLine = 0.75;  // of that
constexpr double kOneWay = 1e-6;                             // of a cosine: normals that are one
constexpr double kTurnedAway = 0.1;                          // cosine from which on an edge is all crease
constexpr double kBracket = 20;                      // page units: half a plate from which something hangs
constexpr double kHung = 1.3, kLeastBracket = 0.45;  // of what hangs there: not wider; of its size: nor less
constexpr double kFromAbove = 0.85;      // sine of the camera's elevation, from which on there are none
constexpr int kBracketNumber = 1 << 29;  // theirs in sight, above those of all others
constexpr double kThinEdge = 0.11;       // of a body's thickness: an outline is not wider
constexpr double kAround = 60;           // page units outside the window where things are still drawn
constexpr double kOver = 0.06;           // page units: how far faces of one plane lie over each other
constexpr double kLeast = 1.6;           // radius of what is too small to see

Vec3 placed(const sim::Snapshot::Body& body, const Vec3& local) {
  return body.position + body.orientation * local;
}

/// Whether a ball around a place may be seen.
bool in_window(const CameraProjection& lens, const Vec3& center, double reach) {
  const double near = lens.depth(center) - lens.per_distance * reach;
  if (lens.perspective() && lens.depth(center) + lens.per_distance * reach <= 0) return false;
  if (near < 1e-3) return true;
  return !outside(lens.window, lens.page(center), reach * lens.scale / near + kAround);
}

void begin(SpaceFrame& s, const Vec3& center, double reach, int piece) {
  s.chunks.push_back({s.triangles.size(), 0, center, reach, piece});
}
void end(SpaceFrame& s) { s.chunks.back().end = s.triangles.size(); }

std::uint32_t corner(SpaceFrame& s, const Vec3& place, const Vec3& normal, Shaded color) {
  s.corners.push_back({place, normal, color, s.chunks.empty() ? -1 : s.chunks.back().piece});
  return std::uint32_t(s.corners.size() - 1);
}

/// The colours of a surface there, of the piece that is being added.
Shaded surface(const SpaceFrame& s, Color own, const Vec3& place, const Vec3& normal, bool round) {
  const int piece = s.chunks.back().piece;
  const bool metal = piece >= 0 && piece < int(s.stage.pieces.size()) &&
                     s.stage.looks(s.stage.pieces[std::size_t(piece)].body).material == Material::metal;
  const Theme theme = s.stage.look.theme;
  if (metal) return shine(own, theme, s.stage.light, normal, s.lens.sight(place));
  return round ? shade_round(own, theme, s.stage.light, normal, s.lens.sight(place))
               : shade(own, theme, s.stage.light, normal);
}

/// The corners of a face. Where another piece of the body continues it, it reaches a little over that, and
/// what it hides there ends a little before: the rasteriser brings corners to parts of a pixel, and a sample
/// between the edges of two pieces would show what is behind.
std::vector<Vec3> corners_of(const SpaceFrame& s, const Polyhedron& body, const Polyhedron::Face& face,
                             const std::vector<std::int8_t>* goes_on) {
  std::vector<Vec3> places;
  for (const int v : face.loop) places.push_back(body.vertices[std::size_t(v)]);
  if (!goes_on) return places;
  const std::size_t count = places.size();
  const std::vector<Vec3> own = places;
  for (std::size_t i = 0; i < count; ++i) {
    if ((*goes_on)[i] == 0) continue;
    const Vec3 out = (own[(i + 1) % count] - own[i]).normalized().cross(face.normal);
    for (const std::size_t k : {i, (i + 1) % count}) {
      if (s.lens.depth(own[k]) < 0.05) continue;
      const double facing = std::max(face.normal.dot(s.lens.sight(own[k])), 0.25);
      places[k] += (*goes_on)[i] * kOver / (facing * s.lens.scale_at(own[k])) * out;
    }
  }
  return places;
}

/// Whether a face is part of a round surface: one of the normals at its corners, turned by `turn`, is not its
/// own.
bool goes_round(const Vec3& own, const std::vector<Vec3>& normals, const Eigen::Matrix3d& turn) {
  return std::any_of(normals.begin(), normals.end(),
                     [&](const Vec3& n) { return own.dot(turn * n) < 1 - kOneWay; });
}

/// The faces of a polyhedron that look at the eye, see Piece; `turn` takes `normals` to the world.
void add_faces(SpaceFrame& s, const Polyhedron& body, Color own,
               const std::vector<std::vector<Vec3>>& normals = {},
               const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity(),
               const std::vector<std::vector<std::int8_t>>& goes_on = {}) {
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    const Polyhedron::Face& face = body.faces[f];
    const Vec3& place = body.vertices[face.loop[0]];
    if (face.normal.dot(s.lens.perspective() ? Vec3(s.lens.eye() - place) : s.lens.back) <= 0) continue;
    const auto first = std::uint32_t(s.corners.size());
    const std::vector<Vec3> places = corners_of(s, body, face, goes_on.empty() ? nullptr : &goes_on[f]);
    const bool round = !normals.empty() && goes_round(face.normal, normals[f], turn);
    for (std::size_t i = 0; i < places.size(); ++i)
      corner(s, places[i], face.normal,
             surface(s, own, places[i], round ? Vec3(turn * normals[f][i]) : face.normal, round));
    for (std::uint32_t i = 2; i < places.size(); ++i)
      for (std::uint32_t k : {first, first + i - 1, first + i}) s.triangles.push_back(k);
  }
}

/// The half of a ball that looks at the eye: rings around the sight line, down to the contour.
void add_cap(SpaceFrame& s, const Vec3& center, double radius, Color own) {
  const CameraProjection& lens = s.lens;
  const double page = radius * lens.scale_at(center);
  const int around = std::clamp(roundness(page), 8, 64), rings = std::max(2, around / 5);
  const Vec3 sight = lens.sight(center), side = lens.up.cross(sight).normalized(), up = sight.cross(side);
  const double last = lens.perspective() ? std::acos(std::min(radius / (lens.eye() - center).norm(), 1.0))
                                         : std::numbers::pi / 2;
  const auto at = [&](int ring, int k) {
    const double polar = last * ring / rings, turn = 2 * std::numbers::pi * k / around;
    const Vec3 n = std::cos(polar) * sight + std::sin(polar) * (std::cos(turn) * side + std::sin(turn) * up);
    return corner(s, center + radius * n, n, surface(s, own, center + radius * n, n, true));
  };
  const std::uint32_t pole = at(0, 0);
  std::uint32_t above = pole;
  for (int ring = 1; ring <= rings; ++ring) {
    const auto first = std::uint32_t(s.corners.size());
    for (int k = 0; k < around; ++k) at(ring, k);
    for (int k = 0; k < around; ++k) {
      const auto a = first + std::uint32_t(k), b = first + std::uint32_t((k + 1) % around);
      if (ring == 1) {
        for (std::uint32_t i : {pole, a, b}) s.triangles.push_back(i);
      } else {
        const auto c = above + std::uint32_t(k), d = above + std::uint32_t((k + 1) % around);
        for (std::uint32_t i : {c, a, b, c, b, d}) s.triangles.push_back(i);
      }
    }
    above = first;
  }
}

/// A tube along `way` without ends, its rings carried along so that it does not twist.
void add_rings(SpaceFrame& s, const std::vector<Vec3>& way, double radius, Color own) {
  const double page = radius * s.lens.scale_at(way[way.size() / 2]);
  const int around = std::clamp(roundness(page) / 2 * 2, 6, 48);
  Vec3 side = Vec3::Zero();
  std::uint32_t above = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Vec3 before = i > 0 ? Vec3((way[i] - way[i - 1]).normalized()) : Vec3::Zero();
    const Vec3 after = i + 1 < way.size() ? Vec3((way[i + 1] - way[i]).normalized()) : Vec3::Zero();
    const Vec3 tangent = (before + after).normalized();
    if (i == 0) side = tangent.unitOrthogonal();
    side = (side - tangent * tangent.dot(side)).normalized();
    const Vec3 up = tangent.cross(side);
    const auto first = std::uint32_t(s.corners.size());
    for (int k = 0; k < around; ++k) {
      const double a = 2 * std::numbers::pi * k / around;
      const Vec3 n = std::cos(a) * side + std::sin(a) * up;
      corner(s, way[i] + radius * n, n, surface(s, own, way[i] + radius * n, n, true));
    }
    for (int k = 0; k < around && i > 0; ++k) {
      const auto a = first + std::uint32_t(k), b = first + std::uint32_t((k + 1) % around),
                 c = above + std::uint32_t(k), d = above + std::uint32_t((k + 1) % around);
      for (std::uint32_t v : {c, a, b, c, b, d}) s.triangles.push_back(v);
    }
    above = first;
  }
}

double line_width(const SpaceFrame& s, const Vec3& center, double least) {
  const double weight = s.stage.layout.weight;
  return std::clamp(2 * kThinEdge * least * s.lens.scale_at(center), 0.5 * weight, kEdgeLine * weight);
}

/// The outline of a capsule on the page: the hull of its two ends' contours.
std::vector<Vec3> outline(const CameraProjection& lens, const Vec3& a, const Vec3& b, double radius) {
  struct Place {
    Point page;
    Vec3 world;
  };
  std::vector<Place> places;
  for (const Vec3& end : {a, b}) {
    const int count = std::max(roundness(radius * lens.scale_at(end)), 24);
    for (const Vec3& p : contour(lens, end, radius, count)) {
      if (lens.depth(p) < 1e-3) return {};
      places.push_back({lens.page(p), p});
    }
  }
  std::sort(places.begin(), places.end(), [](const Place& p, const Place& q) {
    return p.page.x() != q.page.x() ? p.page.x() < q.page.x() : p.page.y() < q.page.y();
  });
  std::vector<Place> hull;
  const auto chain = [&](auto from, auto to) {
    const std::size_t first = hull.size();
    for (auto p = from; p != to; ++p) {
      while (hull.size() >= first + 2) {
        const Point u = hull.back().page - hull[hull.size() - 2].page,
                    v = p->page - hull[hull.size() - 2].page;
        if (u.x() * v.y() - u.y() * v.x() > 1e-12) break;
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  chain(places.begin(), places.end());
  chain(places.rbegin(), places.rend());
  std::vector<Vec3> line;
  for (const Place& p : hull) line.push_back(p.world);
  return line;
}

}  // namespace

void add_ball(SpaceFrame& s, const Vec3& center, double radius, Color color, int number) {
  if (number >= int(s.stage.pieces.size())) s.solids.balls.push_back({center, radius, color});
  if (!in_window(s.lens, center, radius) || s.lens.depth(center) < 1e-3) return;
  begin(s, center, radius, number);
  add_cap(s, center, radius, color);
  end(s);
  s.sight.add_disc(contour(s.lens, center, radius, std::min(roundness(radius * s.lens.scale_at(center)), 32)),
                   center, radius, number);
}

void add_tube(SpaceFrame& s, const std::vector<Vec3>& way, double radius, Color color, int number, int rings,
              const Solids::Tube* coil) {
  if (way.size() < 2) return;
  if (number >= int(s.stage.pieces.size()))
    s.solids.tubes.push_back(coil ? *coil : Solids::Tube{way, radius, color});
  Vec3 low = way[0], high = way[0];
  for (const Vec3& p : way) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vec3 center = (low + high) / 2;
  const double reach = (high - low).norm() / 2 + radius;
  if (!in_window(s.lens, center, reach)) return;
  for (const Vec3& p : way) {
    if (s.lens.depth(p) < 1e-3) return;
  }
  begin(s, center, reach, number);
  std::vector<Vec3> fine{way[0]};
  for (std::size_t i = 1; i < way.size(); ++i)
    for (int k = 1; k <= rings; ++k) fine.push_back(way[i - 1] + (way[i] - way[i - 1]) * (double(k) / rings));
  add_rings(s, fine, radius, color);
  add_cap(s, way.front(), radius, color);
  add_cap(s, way.back(), radius, color);
  end(s);
  for (std::size_t i = 1; i < way.size(); ++i) s.sight.add_rod(way[i - 1], way[i], radius, radius, number);
}

void add_bodies(SpaceFrame& s) {
  const auto& pieces = s.stage.pieces;
  s.placed.resize(pieces.size());
  for (int i = 0; i < int(pieces.size()); ++i) {
    const Piece& piece = pieces[i];
    const sim::Snapshot::Body& body = s.now.bodies[piece.body];
    const Color own = s.stage.own[piece.body];
    switch (piece.form) {
      case Piece::Form::polyhedron: {
        const Eigen::Matrix3d turn = body.orientation.toRotationMatrix();
        s.placed[i] = piece.flat.placed(turn, body.position);
        Vec3 middle = Vec3::Zero();
        for (const Vec3& v : s.placed[i].vertices) middle += v / double(s.placed[i].vertices.size());
        begin(s, middle, piece.reach, i);
        if (in_window(s.lens, middle, piece.reach)) {
          add_faces(s, s.placed[i], own, piece.normals, turn, piece.goes_on);
          s.sight.add(s.placed[i], i, piece.body);
        }
        end(s);
        break;
      }
      case Piece::Form::ball: {
        const Vec3 center = placed(body, piece.a);
        if (s.lens.depth(center) < 1e-3) break;
        const double page = s.lens.scale_at(center);
        const double own_radius =
            s.stage.dots[piece.body] > 0 ? s.stage.dots[piece.body] / s.lens.scale : piece.radius;
        add_ball(s, center, std::max(own_radius, kLeast * s.stage.layout.weight / page), own, i);
        break;
      }
      case Piece::Form::capsule: {
        const Vec3 a = placed(body, piece.a), b = placed(body, piece.b);
        if (s.lens.depth(a) < 1e-3 || s.lens.depth(b) < 1e-3) break;
        // rings along it, for it is darker where others are near
        const int rings = std::clamp(int((b - a).norm() / (0.7 * piece.radius)), 1, 16);
        add_tube(s, {a, b}, piece.radius, own, i, rings);
        for (const Vec3& end : {a, b})
          s.sight.add_disc(contour(s.lens, end, piece.radius, 24), end, piece.radius, i);
        break;
      }
    }
  }
}

void trace(SpaceFrame& s, const std::vector<Vec3>& way, bool closed, int own, int too, double width,
           Color color, std::span<const Vec3> faces) {
  if (way.size() < 2) return;
  if (own < 0) {
    s.solids.lines.push_back({way, width / 2, color});
    if (closed) s.solids.lines.back().way.push_back(way.front());
  }
  HiddenLines::Parts parts;
  std::vector<Trace> found;
  Trace line;
  bool whole = closed;
  const auto flush = [&] {
    if (line.nodes.size() > 1) found.push_back(line);
    line = {};
  };
  const std::size_t count = closed ? way.size() : way.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 &a = way[i], &b = way[(i + 1) % way.size()];
    s.sight.seen(a, b, own, too, parts, faces, width / 2);
    if (parts.size() != 1 || parts[0].first > 0 || parts[0].second < 1) whole = false;
    if (parts.empty()) {
      flush();
      continue;
    }
    const Point p = s.lens.page(a), q = s.lens.page(b);
    for (const auto& [from, to] : parts) {
      if (from > 0) flush();
      if (line.nodes.empty()) line.nodes.push_back({p + from * (q - p), width, color});
      line.nodes.push_back({p + to * (q - p), width, color});
      if (to < 1) flush();
    }
  }
  if (whole) {
    line.nodes.pop_back();
    line.closed = true;
  }
  flush();
  double near = 0;
  for (const Vec3& p : way) near += s.lens.seen(p).z() / double(way.size());
  for (Trace& l : found) {
    l.near = near;
    s.lines.push_back(std::move(l));
  }
}

namespace {

struct EdgeColors {
  Color outline, crease;
};

EdgeColors edges(Color own, Theme theme) { return {edge(own, theme), crease(own, theme)}; }

// the outline and the creases of one piece of a body, `number` among those that hide; -1: it hides nothing. A
// crease becomes part of the outline little by little as one of its faces turns away, so that none jumps.
void trace_flat(SpaceFrame& s, const Polyhedron& flat, int number, double width, const EdgeColors& colors) {
  std::vector<double> facing;  // cosines
  for (const Polyhedron::Face& face : flat.faces)
    facing.push_back(face.normal.dot(s.lens.sight(flat.vertices[face.loop[0]])));
  for (const Polyhedron::Edge& e : flat.edges) {
    const bool left = facing[e.left] > 0, right = e.right >= 0 && facing[e.right] > 0;
    if (!left && !right) continue;
    const Vec3 &a = flat.faces[e.left].normal, &b = flat.faces[right ? e.right : e.left].normal;
    if (left && right && a.dot(b) > kCrease) continue;
    const std::array<Vec3, 2> faces{left ? a : flat.faces[e.right].normal, right ? b : a};
    const double part =
        left && right ? std::min(1.0, std::min(facing[e.left], facing[e.right]) / kTurnedAway) : 0;
    trace(s, {flat.vertices[e.a], flat.vertices[e.b]}, false, number, -1,
          width * std::lerp(kSilhouetteLine, kCreaseLine, part), mix(colors.outline, colors.crease, part),
          faces);
  }
}

void trace_piece(SpaceFrame& s, const Piece& piece, const sim::Snapshot::Body& body, const Polyhedron& flat,
                 int number, const EdgeColors& colors) {
  const Color color = colors.outline;
  if (piece.form == Piece::Form::polyhedron) {
    if (!in_window(s.lens, body.position, piece.reach)) return;
    trace_flat(s, flat, number, line_width(s, body.position, piece.least), colors);
    return;
  }
  const Vec3 a = placed(body, piece.a), b = placed(body, piece.b);
  const double radius = s.stage.dots[piece.body] > 0 ? s.stage.dots[piece.body] / s.lens.scale : piece.radius;
  if (!in_window(s.lens, a, radius) && !in_window(s.lens, b, radius)) return;
  if (s.lens.depth(a) < 1e-3 || s.lens.depth(b) < 1e-3) return;
  const double page = radius * s.lens.scale_at(a);
  if (page < 2.2) return;
  const double width = kSilhouetteLine * line_width(s, a, radius);
  // the line lies inside the rim
  if (piece.form == Piece::Form::ball)
    trace(s, contour(s.lens, a, radius * (1 - 0.25 * width / page), roundness(page)), true, number, -1, width,
          color);
  else
    trace(s, outline(s.lens, a, b, radius), true, number, -1, width, color);
}

}  // namespace

// a plate over each place of the room that holds what may hang, but for those near the ground, a wall or a
// body that is held: there one sees what holds it
void add_brackets(SpaceFrame& s) {
  const sim::SceneInfo& cast = s.stage.cast;
  if (!(cast.gravity.norm() > 0)) return;
  const Vec3 up = -cast.gravity.normalized();
  // from above a plate would hide what hangs from it
  if (s.lens.back.dot(up) > kFromAbove) return;
  const double whole = kBracket * s.stage.layout.weight * s.zoom / s.lens.scale;
  const Eigen::Matrix3d turn = turn_from_y(up).toRotationMatrix();
  const auto held = [&](const Vec3& at, double half) {
    for (const sim::SceneInfo::Wall& wall : cast.walls)
      if ((at - wall.point).dot(wall.normal.normalized()) < 2 * half) return true;
    for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
      const sim::SceneInfo::Body& body = cast.bodies[i];
      const double reach = std::max(body.radius, body.half.norm()) + half;
      if (body.fixed && (s.now.bodies[i].position - at).norm() < reach) return true;
    }
    return false;
  };
  // modest against what is made fast there
  std::vector<double> far(cast.bodies.size(), 0);
  for (const Piece& piece : s.stage.pieces) {
    const double dot = s.stage.dots[std::size_t(piece.body)];
    far[std::size_t(piece.body)] =
        std::max(far[std::size_t(piece.body)],
                 dot > 0 ? dot * whole / (kBracket * s.stage.layout.weight) : piece.reach);
  }
  const auto add = [&](const Vec3& at, int hung) {
    const double half = std::clamp(kHung * far[std::size_t(hung)], kLeastBracket * whole, whole),
                 thick = 0.3 * half;
    const Vec3 center = at + thick * up;
    const double reach = 2 * half;
    if (!held(at, half)) s.solids.plates.push_back({center, half, thick});
    if (held(at, half) || !in_window(s.lens, center, reach) || s.lens.depth(center) < 1e-2) return;
    const Polyhedron plate = box({half, thick, half}).placed(turn, center);
    begin(s, center, reach, -1);
    add_faces(s, plate, neutral(s.stage.look.theme));
    end(s);
    s.sight.add(plate, kBracketNumber + int(s.brackets.size()));
    s.brackets.push_back(plate);
  };
  for (std::size_t i = 0; i < cast.springs.size() && i < s.now.springs.size(); ++i) {
    const sim::SceneInfo::Spring& spring = cast.springs[i];
    if (!s.now.springs[i].loose && (spring.a < 0) != (spring.b < 0))
      add(spring.a < 0 ? s.now.springs[i].a : s.now.springs[i].b, spring.a < 0 ? spring.b : spring.a);
  }
  for (std::size_t i = 0; i < cast.joints.size() && i < s.now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = cast.joints[i];
    const JointMark mark = joint_look(joint.kind).space;
    if (s.now.joints[i].broken || (joint.a < 0) == (joint.b < 0)) continue;
    if (mark != JointMark::line && mark != JointMark::rope && mark != JointMark::dot) continue;
    add(joint.a < 0 ? s.now.joints[i].a : s.now.joints[i].b, joint.a < 0 ? joint.b : joint.a);
  }
}

void trace_edges(SpaceFrame& s) {
  const auto& pieces = s.stage.pieces;
  const Color dark = edge(neutral(s.stage.look.theme), s.stage.look.theme);
  for (std::size_t i = 0; i < s.brackets.size(); ++i)
    trace_flat(s, s.brackets[i], kBracketNumber + int(i), kEdgeLine * s.stage.layout.weight, {dark, dark});
  for (int i = 0; i < int(pieces.size()); ++i)
    trace_piece(s, pieces[i], s.now.bodies[pieces[i].body], s.placed[i], i,
                edges(s.stage.own[pieces[i].body], s.stage.look.theme));
}

void trace_ghost(SpaceFrame& s, const SpaceGhost& ghost) {
  const std::vector<int>& only = *ghost.bodies;
  for (const Piece& piece : s.stage.pieces) {
    if (s.stage.cast.bodies[std::size_t(piece.body)].fixed) continue;
    if (!only.empty() && std::find(only.begin(), only.end(), piece.body) == only.end()) continue;
    const sim::Snapshot::Body& body = ghost.then->bodies[std::size_t(piece.body)];
    Polyhedron flat;
    if (piece.form == Piece::Form::polyhedron)
      flat = piece.flat.placed(body.orientation.toRotationMatrix(), body.position);
    const Color own = paint(s.stage.own[piece.body], s.stage.look.theme).outline;
    const Color pale = mix(s.stage.colours.room, own, ghost.strength);
    trace_piece(s, piece, body, flat, -1, {pale, pale});
  }
}

}  // namespace obscura::draw
