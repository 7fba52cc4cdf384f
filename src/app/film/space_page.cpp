#include "app/film/space_page.h"

#include <algorithm>
#include <map>

namespace obscura::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kTurnBound = 1e-4;    // of a quaternion's numbers
constexpr double kLengthBound = 5e-5;  // of the room's scale: places
constexpr double kUnitBound = 2e-5;    // of directions; and of a camera's scale, of itself

Json array_of(const sim::Vec3& v) { return {v.x(), v.y(), v.z()}; }
Json array_of(draw::Color c) { return {c.r, c.g, c.b, c.a}; }

Json flat(const std::vector<sim::Vec3>& points) {
  Json all = Json::array();
  for (const sim::Vec3& p : points)
    for (int k = 0; k < 3; ++k) all.push_back(double(float(p[k])));
  return all;
}

// `round`: see draw::Piece
Json shape(const draw::Polyhedron& body, const std::vector<std::vector<sim::Vec3>>& round) {
  Json faces = Json::array(), normals = Json::array(), edges = Json::array();
  for (const draw::Polyhedron::Face& face : body.faces) {
    faces.push_back(face.loop);
    for (int k = 0; k < 3; ++k) normals.push_back(double(float(face.normal[k])));
  }
  for (const draw::Polyhedron::Edge& e : body.edges)
    for (const int i : {e.a, e.b, e.left, e.right}) edges.push_back(i);
  Json all{{"vertices", flat(body.vertices)}, {"faces", faces}, {"normals", normals}, {"edges", edges}};
  if (!round.empty()) {
    Json corners = Json::array();
    for (const std::vector<sim::Vec3>& face : round)
      for (const sim::Vec3& n : face)
        for (int k = 0; k < 3; ++k) corners.push_back(double(float(n[k])));
    all["round"] = std::move(corners);
  }
  return all;
}

}  // namespace

SpacePage::SpacePage(const draw::SpaceStage& stage, int part, const draw::Rect& panel, page::Reel& reel)
    : reel_(reel), part_(part) {
  const double k = panel.height / 1080;  // page units a unit of the run's own page
  Json shapes = Json::array(), pieces = Json::array(), colors = Json::array(), edges = Json::array(),
       creases = Json::array();
  std::map<std::string, int> known;
  for (const draw::Piece& piece : stage.pieces) {
    Json each{{"body", piece.body}, {"least", piece.least}};
    if (piece.form == draw::Piece::Form::polyhedron) {
      Json its = shape(piece.flat, piece.normals);
      const auto [at, fresh] = known.emplace(its.dump(), int(shapes.size()));
      if (fresh) shapes.push_back(std::move(its));
      each["shape"] = at->second;
    } else {
      each["a"] = array_of(piece.a), each["b"] = array_of(piece.b), each["radius"] = piece.radius;
      if (const double dot = stage.dots[std::size_t(piece.body)]; dot > 0) each["dot"] = k * dot;
    }
    const draw::Material material = stage.looks(piece.body).material;
    if (material == draw::Material::wood || material == draw::Material::checks) {
      each["grain"] = Json::array();
      for (int i = 0; i < 9; ++i) each["grain"].push_back(piece.grain(i / 3, i % 3));
    }
    pieces.push_back(std::move(each));
  }
  for (const draw::Color own : stage.own) {
    colors.push_back(array_of(own));
    edges.push_back(array_of(draw::edge(own, stage.look.theme)));
    creases.push_back(array_of(draw::crease(own, stage.look.theme)));
  }
  json_["shapes"] = shapes, json_["pieces"] = pieces, json_["colors"] = colors, json_["edges"] = edges;
  json_["creases"] = creases;
  const draw::Color plate = draw::neutral(stage.look.theme);
  json_["plate"] = {array_of(plate), array_of(draw::edge(plate, stage.look.theme))};
  Json materials = Json::array();
  bool plain = true;
  for (std::size_t i = 0; i < stage.own.size(); ++i) {
    const draw::Material material = stage.looks(int(i)).material;
    plain = plain && material == draw::Material::matte;
    materials.push_back(int(material));
  }
  if (!plain) json_["materials"] = materials;
  if (stage.look.drop_lines) {
    json_["drops"] = Json::array();
    for (std::size_t i = 0; i < stage.own.size(); ++i)
      json_["drops"].push_back(stage.cast.bodies[i].fixed
                                   ? Json()
                                   : array_of(draw::paint(stage.own[i], stage.look.theme).outline));
  }
  json_["toward"] = array_of(stage.light.toward), json_["across"] = array_of(stage.light.across);
  json_["weight"] = k * stage.layout.weight;
  json_["hatch"] = array_of(stage.colours.hatch);
  if (stage.ground) {
    json_["ground"] = {{"point", array_of(stage.ground->point)},
                       {"normal", array_of(stage.ground->normal)},
                       {"grid", stage.look.ground},
                       {"tile", stage.look.tile}};
    if (stage.closed && stage.ground_face >= 0) {
      std::vector<sim::Vec3> loop;
      for (const int v : stage.room.faces[std::size_t(stage.ground_face)].loop)
        loop.push_back(stage.room.vertices[std::size_t(v)]);
      json_["ground"]["loop"] = flat(loop);
    }
  }
  if (stage.closed) json_["room"] = shape(stage.room, {});
  const auto several = [&](int count, double bound) {
    int first = -1;
    for (int i = 0; i < count; ++i) {
      const int number = reel.number(bound);
      if (i == 0) first = number;
    }
    return first;
  };
  poses_ = several(4 * int(stage.cast.bodies.size()), kTurnBound);
  turns_.assign(stage.cast.bodies.size(), {1, 0, 0, 0});
  json_["turns"] = poses_;
  const double length = kLengthBound * std::max(stage.cast.scale, 1e-6);
  Json panels = Json::array();
  for (const draw::Panel& each : stage.panels) {
    const draw::Rect& w = each.window;
    const int first = several(3, length);
    several(9, kUnitBound);
    several(1, kUnitBound / std::max(stage.cast.scale, 1e-6));
    several(1, kUnitBound * k * stage.layout.scale);
    several(2, 0.02);
    if (lenses_ < 0) lenses_ = first;
    panels.push_back({{"window", {panel.x + k * w.x, panel.y + k * w.y, k * w.width, k * w.height}},
                      {"lens", first},
                      {"fitted", k * w.width / each.shown}});
  }
  json_["panels"] = panels;
  int places = -1;
  for (std::size_t i = 0; i < 3 * stage.cast.bodies.size(); ++i) {
    const int number = reel.number(length);
    if (i == 0) places = number;
  }
  json_["places"] = places;
}

void SpacePage::add(const sim::Snapshot& now, const draw::Picture& picture) {
  int number = poses_;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const Eigen::Quaterniond& q = now.bodies[i].orientation;
    Eigen::Vector4d turn(q.w(), q.x(), q.y(), q.z());
    // of the two that turn alike, the one that follows
    if (turn.dot(turns_[i]) < 0) turn = -turn;
    turns_[i] = turn;
    for (int k = 0; k < 4; ++k) reel_.put(number++, turn[k]);
  }
  number = lenses_;
  for (const auto& solids : picture.solids) {
    if (solids->part != part_) continue;
    const draw::CameraProjection& lens = solids->lens;
    for (const sim::Vec3* v : {&lens.target, &lens.right, &lens.up, &lens.back})
      for (int k = 0; k < 3; ++k) reel_.put(number++, (*v)[k]);
    reel_.put(number++, lens.per_distance);
    reel_.put(number++, lens.scale);
    for (int k = 0; k < 2; ++k) reel_.put(number++, lens.middle[k]);
  }
  number = json_["places"];
  for (const sim::Snapshot::Body& body : now.bodies)
    for (int k = 0; k < 3; ++k) reel_.put(number++, body.position[k]);
}

}  // namespace obscura::app
