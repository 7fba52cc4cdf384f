#include "draw/space/space.h"
#include "draw/picture/type.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kStripGap = 8;                      // page units
constexpr double kPanelName = 24, kPanelStrip = 44;  // em of a panel's name, and the height that it takes
constexpr double kFar = 200;                         // of the scale: how far an open room is cut off
constexpr double kRises = 0.2;         // least share of up in the normal of a wall that takes shadows
constexpr double kRoundMargin = 1.12;  // bodies without walls around them get this much room
constexpr double kRunMargin = 1.06;    // and where it is known how far they go, this much

Piece ball(int body, const Vec3& at, double radius) {
  Piece piece;
  piece.form = Piece::Form::ball, piece.body = body, piece.a = piece.b = at;
  piece.radius = radius, piece.reach = at.norm() + radius, piece.least = radius;
  return piece;
}

Piece capsule(int body, const Vec3& a, const Vec3& b, double radius) {
  Piece piece;
  piece.form = Piece::Form::capsule, piece.body = body, piece.a = a, piece.b = b;
  piece.radius = radius, piece.reach = std::max(a.norm(), b.norm()) + radius, piece.least = radius;
  return piece;
}

Piece flat(int body, Polyhedron form) {
  Piece piece;
  piece.form = Piece::Form::polyhedron, piece.body = body;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : form.vertices) middle += v / double(form.vertices.size());
  for (const Vec3& v : form.vertices) piece.reach = std::max({piece.reach, v.norm(), (v - middle).norm()});
  // the least distance from its middle to a face
  piece.least = piece.reach;
  for (const Polyhedron::Face& face : form.faces)
    piece.least = std::min(piece.least, face.normal.dot(form.vertices[face.loop[0]] - middle));
  piece.flat = blunted(form);
  piece.normals = round_normals(piece.flat);
  return piece;
}

/// The parts of a shape, placed in its body by `turn` and `center`.
template <class Form>
void add_pieces(int body, const Form& form, const Eigen::Matrix3d& turn, const Vec3& center,
                std::vector<Piece>& pieces) {
  switch (form.kind) {
    case sim::ShapeKind::point:
    case sim::ShapeKind::ball:
      pieces.push_back(ball(body, center, form.radius));
      break;
    case sim::ShapeKind::box:
      pieces.push_back(flat(body, box(form.half).placed(turn, center)));
      break;
    case sim::ShapeKind::capsule: {
      const Vec3 axis = turn * Vec3(0, form.half.y(), 0);
      pieces.push_back(capsule(body, center - axis, center + axis, form.radius));
      break;
    }
    case sim::ShapeKind::hull:
      pieces.push_back(flat(body, polyhedron(form.vertices, form.faces)));
      break;
    case sim::ShapeKind::polygon:
    case sim::ShapeKind::compound:
      break;
  }
}

/// Piece::goes_on of the pieces of one body.
void find_continued(std::span<Piece> pieces) {
  for (Piece& piece : pieces)
    for (const Piece& other : pieces) {
      if (&other == &piece || piece.flat.empty() || other.flat.empty()) continue;
      const auto found = continued(piece.flat, other.flat);
      if (piece.goes_on.empty())
        for (const Polyhedron::Face& face : piece.flat.faces) piece.goes_on.emplace_back(face.loop.size(), 0);
      for (std::size_t f = 0; f < found.size(); ++f)
        for (std::size_t i = 0; i < found[f].size(); ++i)
          if (found[f][i]) piece.goes_on[f][i] = 1;
    }
  for (Piece& piece : pieces) {
    if (piece.goes_on.empty()) continue;
    for (const Polyhedron::Edge& e : piece.flat.edges) {
      if (e.right < 0) continue;
      const auto side = [&](int face, int from) -> std::int8_t& {
        const std::vector<int>& loop = piece.flat.faces[std::size_t(face)].loop;
        return piece.goes_on[std::size_t(face)][std::size_t(std::ranges::find(loop, from) - loop.begin())];
      };
      // the right one's loop runs from b to a
      std::int8_t &left = side(e.left, e.a), &right = side(e.right, e.b);
      if (left == 1 && right == 0) right = -1;
      if (right == 1 && left == 0) left = -1;
    }
  }
}

/// The frame of a material's pattern, in units of half the thickness of a piece, of wood the geometric mean
/// of its two lesser ones: a board's rings are no finer than a beam's; its first axis is the piece's longest.
/// Of a box checks are as many along each side as fit.
Eigen::Matrix3d grain_of(const Piece& piece, Material material) {
  Vec3 half = Vec3::Constant(piece.radius);
  if (piece.form == Piece::Form::capsule) half += (piece.b - piece.a).cwiseAbs() / 2;
  if (piece.form == Piece::Form::polyhedron) {
    Vec3 low = piece.flat.vertices[0], high = low;
    for (const Vec3& v : piece.flat.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    half = (high - low) / 2;
  }
  const double least = std::max(half.minCoeff(), 1e-12);
  int longest = 0;
  half.maxCoeff(&longest);
  const double second = std::max(half.sum() - half.maxCoeff() - half.minCoeff(), least);
  const double ring = std::sqrt(least * second);
  Eigen::Matrix3d grain = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const int axis = (longest + i) % 3;
    const double cell = material == Material::checks ? half[axis] / std::round(half[axis] / least) : ring;
    grain(i, axis) = 1 / cell;
  }
  return grain;
}

/// The region that cameras fit: the bodies and the ground under them.
std::vector<Vec3> corners_around(const SpaceStage& stage, const Extent& extent) {
  Vec3 low = extent.low.cwiseMin(extent.high), high = extent.low.cwiseMax(extent.high);
  const double least = 0.25 * stage.cast.scale;
  for (int i = 0; i < 3; ++i) {
    const double missing = least - (high[i] - low[i]);
    if (missing > 0) low[i] -= missing / 2, high[i] += missing / 2;
  }
  const Vec3 middle = (low + high) / 2, half = kRoundMargin * (high - low) / 2;
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(middle + half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  return corners;
}

/// Places that bodies reach, with room around them.
std::vector<Vec3> widened(std::vector<Vec3> places, double scale) {
  Vec3 low = places[0], high = places[0];
  for (const Vec3& at : places) low = low.cwiseMin(at), high = high.cwiseMax(at);
  const Vec3 middle = (low + high) / 2;
  for (Vec3& at : places) at = middle + kRunMargin * (at - middle);
  // what hardly moves is not looked at through a microscope
  const double least = 0.25 * scale / 2;
  for (int i = 0; i < 3; ++i)
    if (kRunMargin * (high - low)[i] < 2 * least)
      for (const double side : {-least, least}) places.push_back(middle + side * Vec3::Unit(i));
  return places;
}

/// Windows for so many panels under a strip: rows and columns that leave them about half again as wide as
/// high.
std::vector<Rect> windows(int count, double width, double top, double bottom, bool named, double weight) {
  if (count == 1) return {{0, top, width, bottom - top}};
  int best = 1;
  double least = 1e300;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double off = std::abs(std::log(width / columns / ((bottom - top) / rows) / 1.5));
    if (off < least) least = off, best = columns;
  }
  const int rows = (count + best - 1) / best;
  const double gap = kCameraGap * weight, name = named ? kPanelStrip * weight : 0;
  const double w = (width - gap * (best - 1)) / best, h = (bottom - top - gap * (rows - 1)) / rows;
  std::vector<Rect> found;
  for (int i = 0; i < count; ++i) {
    const int column = i % best, row = i / best;
    found.push_back({column * (w + gap), top + row * (h + gap) + name, w, h - name});
  }
  return found;
}

bool same(const CameraProjection& a, const CameraProjection& b) {
  return a.target == b.target && a.back == b.back && a.right == b.right && a.up == b.up &&
         a.scale == b.scale && a.per_distance == b.per_distance && a.middle == b.middle;
}

}  // namespace

SpaceStage::SpaceStage(const sim::SceneInfo& info, const Look& looks_, const std::vector<Camera>& cameras,
                       const Extent& extent, double aspect, const Charts& beside)
    : cast(info),
      look(looks_),
      colours(palette(looks_.theme)),
      charts(beside),
      light(draw::light(looks_.light)) {
  layout.width = 1080 * aspect;
  layout.aspect = layout.width / 1080;
  layout.weight = page_weight(aspect) * look.weight;
  layout.width -= charts.right(), layout.height -= charts.below();
  const double w = layout.weight;
  // the ground has no edge: one colour for the page and the room; light enough to carry shadows
  if (look.theme == Theme::screen) colours.room = {0x24, 0x2C, 0x35};
  colours.ground = colours.room;

  // the room, cut from a large block
  const Vec3 about = (extent.low + extent.high) / 2;
  const double far = kFar * std::max({cast.scale, (extent.high - extent.low).norm(), 1e-9});
  room = box(Vec3::Constant(far)).placed(Eigen::Matrix3d::Identity(), about);
  for (std::size_t i = 0; i < cast.walls.size() && !room.empty(); ++i)
    room = cut(room, cast.walls[i].point, cast.walls[i].normal.normalized(), int(i));
  closed = !room.empty();
  double level = 0.5;
  for (std::size_t f = 0; f < room.faces.size(); ++f) {
    closed = closed && room.faces[f].side >= 0;
    const Vec3 normal = -room.faces[f].normal;
    if (room.faces[f].side < 0 || normal.y() <= level) continue;
    level = normal.y();
    ground = Ground{cast.walls[room.faces[f].side].point, normal};
    ground_face = int(f);
  }
  // walls that rise from it take shadows, too, each those that fall on its own part
  const auto on = [&](std::size_t f) {
    Ground it{cast.walls[std::size_t(room.faces[f].side)].point, -room.faces[f].normal};
    for (const int v : room.faces[f].loop) it.loop.push_back(room.vertices[std::size_t(v)]);
    return it;
  };
  for (std::size_t f = 0; ground && f < room.faces.size(); ++f)
    if (int(f) != ground_face && room.faces[f].side >= 0 && -room.faces[f].normal.y() > kRises)
      slopes.push_back(on(f));
  if (!slopes.empty()) ground = on(std::size_t(ground_face));

  // bodies, piece by piece
  const std::vector<char> net = knots(cast);
  const auto knot = [&](int body) { return body >= 0 && net[body]; };
  const auto points =
      std::count_if(cast.bodies.begin(), cast.bodies.end(),
                    [](const sim::SceneInfo::Body& b) { return b.kind == sim::ShapeKind::point && !b.bare; });
  const double dot = kDot * w * std::min(1.0, std::cbrt(60.0 / double(std::max<std::ptrdiff_t>(points, 1))));
  int taken = 0;
  for (int i = 0; i < int(cast.bodies.size()); ++i) {
    const sim::SceneInfo::Body& body = cast.bodies[i];
    const bool quiet = body.fixed || knot(i);
    const Color color = looks(i).color ? *looks(i).color : quiet ? neutral(look.theme) : turn(taken++);
    own.push_back(looks(i).quiet ? mix(neutral(look.theme), colours.room, kHushed) : color);
    dots.push_back(body.kind == sim::ShapeKind::point && !body.bare ? dot : 0);
    if (body.bare) continue;
    add_pieces(i, body, Eigen::Matrix3d::Identity(), Vec3::Zero(), pieces);
    for (const sim::SceneInfo::Part& part : body.parts)
      add_pieces(i, part, part.turn.toRotationMatrix(), part.center, pieces);
  }

  for (Piece& piece : pieces) {
    const Material material = looks(piece.body).material;
    piece.grain = grain_of(piece, material);
    grained = grained || material == Material::wood || material == Material::checks;
    const sim::SceneInfo::Body& body = cast.bodies[std::size_t(piece.body)];
    piece.marked = look.axes && material == Material::matte && body.turns && !body.fixed &&
                   (body.kind == sim::ShapeKind::ball || body.kind == sim::ShapeKind::capsule);
    marked = marked || piece.marked;
  }

  // where pieces of a body lie in one plane side by side
  for (std::size_t begin = 0, end = 0; begin < pieces.size(); begin = end) {
    while (end < pieces.size() && pieces[end].body == pieces[begin].body) ++end;
    find_continued(std::span(pieces).subspan(begin, end - begin));
  }

  // the page: caption, then a window for each camera
  const double strip = lay_caption(layout, look);
  const bool several = cameras.size() > 1;
  const double top = strip > 0 ? strip + (several ? kStripGap * w : -0.12 * strip) : 0;
  const bool named =
      several && std::any_of(cameras.begin(), cameras.end(), [](const Camera& c) { return !c.name.empty(); });
  const std::vector<Rect> rects = windows(int(cameras.size()), layout.width, top, layout.height, named, w);
  const std::vector<Vec3> corners = closed ? room.vertices : corners_around(*this, extent);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::vector<Vec3>& reached = cameras[i].reached;
    Panel panel{cameras[i],
                rects[i],
                aim(cameras[i], reached.empty() ? corners : widened(reached, cast.scale), rects[i]),
                1,
                {}};
    panel.shown = rects[i].width / lens_at(panel.camera, panel.aim, panel.window, 0).scale;
    if (several && !cameras[i].name.empty()) {
      const double size = kPanelName * w, inset = std::max(w * 36, 0.045 * layout.width);
      const double left = rects[i].x + (rects[i].x == 0 ? inset : 0);
      panel.words.push_back(
          {{left, rects[i].y - 14 * w},
           Align::left,
           {{.text = cameras[i].name, .face = Face::medium, .size = size, .color = colours.quiet}}});
    }
    panels.push_back(panel);
  }
  layout.window = rects[0];
  layout.scale = rects[0].width / panels[0].shown;

  // springs: coils, or lines where they make a net or are many
  const auto in_net = [&](const sim::SceneInfo::Spring& spring) { return knot(spring.a) || knot(spring.b); };
  const auto loose =
      std::count_if(cast.springs.begin(), cast.springs.end(), [&](const auto& s) { return !in_net(s); });
  for (const sim::SceneInfo::Spring& spring : cast.springs) {
    const bool line = look.springs == Look::Springs::lines ||
                      (look.springs == Look::Springs::automatic && (loose > kMany || in_net(spring)));
    Coil form = coil(std::max(spring.rest_length, 0.12 * cast.scale) * layout.scale, w);
    if (line) form.turns = 0;
    coils.push_back(form);
  }
  for (const sim::SceneInfo::Mouse& mouse : cast.mice) {
    hands.push_back(coil(std::max(mouse.rest_length, 0.2 * cast.scale) * layout.scale, 0.82 * w));
    if (look.springs == Look::Springs::lines) hands.back().turns = 0;
  }
  force_scale = look.force_scale > 0 ? look.force_scale : newton(cast);
}

CameraProjection lens_of(const SpaceStage& stage, const Panel& panel, const sim::Snapshot& now) {
  return lens_at(panel.camera, panel.aim, panel.window, now.time, followed(panel.camera, stage.cast, now));
}

Picture depict_space(const SpaceStage& stage, const sim::Snapshot& now, Ways ways, const sim::Snapshot& frame,
                     std::span<const WorldLine> paths, std::span<const SpaceGhost> ghosts) {
  Picture picture;
  picture.aspect = stage.layout.aspect;
  picture.ground = stage.colours.ground;
  std::vector<CameraProjection> lenses;
  for (const Panel& panel : stage.panels) lenses.push_back(lens_of(stage, panel, now));
  {
    const std::lock_guard lock(stage.mutex);
    if (!stage.still ||
        !std::equal(lenses.begin(), lenses.end(), stage.seen.begin(), stage.seen.end(), same)) {
      auto list = std::make_shared<List>();
      draw_space_still(stage, lenses, *list);
      set_decimal_mark(*list, stage.look.decimal);
      stage.still = std::move(list);
      stage.seen = lenses;
    }
    picture.still = stage.still;
  }

  for (std::size_t i = 0; i < stage.panels.size(); ++i) {
    const Panel& panel = stage.panels[i];
    const CameraProjection& lens = lenses[i];
    SpaceFrame scenery{stage,
                       panel,
                       lens,
                       now,
                       picture.moving,
                       lens.scale * panel.shown / panel.window.width,
                       HiddenLines(lens),
                       {},
                       {},
                       {},
                       {},
                       {},
                       {},
                       {},
                       {}};
    scenery.solids.window = panel.window;
    scenery.solids.lens = lens;
    picture.moving.part = int(i);
    picture.moving.clip(panel.window);
    // first the hiding bodies, then the lines
    add_bodies(scenery);
    add_links(scenery);
    add_brackets(scenery);
    add_water(scenery);
    scenery.sight.finish();
    add_shadows(scenery);
    trace_trails(scenery, ways);
    trace_drops(scenery);
    trace_paths(scenery, paths, false);
    for (const SpaceGhost& ghost : ghosts) trace_ghost(scenery, ghost);
    trace_water(scenery);
    trace_edges(scenery);
    draw_room_front(stage, lens, picture.moving);
    draw_space_arrows(scenery);
    draw_space_gone(scenery);
    trace_paths(scenery, paths, true);
    draw_space_hands(scenery);
    picture.moving.of({});
    picture.moving.unclip();
    picture.solids.push_back(std::make_shared<const Solids>(std::move(scenery.solids)));
  }
  picture.moving.part = 0;
  if (stage.layout.caption && stage.look.clock) {
    Text clock = stage.layout.clock;
    clock.spans[0].text = clock_text(frame.time, stage.look.duration);
    picture.moving.of({Subject::What::page, 1});
    picture.moving.add(clock);
    picture.moving.of({});
  }
  return picture;
}

}  // namespace obscura::draw
