#include "scene/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "scene/check.h"
#include "scene/fields.h"
#include "scene/path.h"
#include "scene/random.h"
#include "scene/solid.h"
#include "sim/trig.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;

constexpr std::int64_t kMostBodies = 1'000'000;
// the palette's order for what has no colour; vermilion is for forces
constexpr const char* kPalette[] = {"blue", "green", "orange", "purple", "sky", "yellow", "grey"};

// everything about the making of one scene's bodies
struct Making {
  const Node& top;
  const Room& room;
  std::uint64_t seed;
  sim::World<2>& world;
  std::vector<draw::BodyLook>& looks;
  Roster& roster;
  Complaints& complaints;
  double drag = 0;                         // the room's
  double trail = 0;                        // the look's
  bool velocity = false, contact = false;  // arrows on every body
  int declared = 0;                        // groups so far: which colour is next
  bool knots = false;  // the group at hand is joined by a net: draw has a colour for those
};

// copies.offset: one step in each direction of the grid
std::vector<Vec> offsets(const Fields& copies, std::size_t directions, Complaints& complaints) {
  std::vector<Vec> steps(directions, Vec::Zero());
  const Node* offset = copies.given("offset");
  if (!offset) return steps;
  if (!offset->list().front().is_list()) {
    if (directions == 1) {
      steps[0] = vector(*offset);
    } else {
      complaints.add(offset->place,
                     "'offset': a grid needs one for each direction, such as [[0.3, 0], [0, 0.3]]");
    }
    return steps;
  }
  if (offset->list().size() != directions) {
    complaints.add(offset->place,
                   fmt::format("'offset': expected {} for a count in {} direction{}, got {}", directions,
                               directions, directions == 1 ? "" : "s", offset->list().size()));
    return steps;
  }
  for (std::size_t k = 0; k < directions; ++k) steps[k] = vector(offset->list()[k]);
  return steps;
}

// how many in each direction; nothing where there are too many
std::optional<std::vector<int>> grid(const Fields& copies, std::int64_t so_far, Complaints& complaints) {
  const Node* count = copies.given("count");
  if (!count) return std::vector<int>{1};
  std::vector<int> sides;
  std::int64_t all = 1;
  for (const Node& side : count->is_list() ? count->list() : Node::List{*count}) {
    sides.push_back(int(std::get<std::int64_t>(side.value)));
    all *= sides.back();
  }
  if (so_far + all > kMostBodies) {
    complaints.add(count->place,
                   fmt::format("'count': {} bodies in all are more than {}, the most a scene may have",
                               so_far + all, kMostBodies));
    return {};
  }
  return sides;
}

// what varies over copies must have copies to vary over, and as many values as there are
void refuse_odd_lists(const Fields& fields, const std::string& kind, bool copied, int n,
                      Complaints& complaints) {
  for (const Key* key : keys_of(kind)) {
    const Node* node = fields.given(key->last());
    if (!key->varies || !node) continue;
    const bool list = node->is_list() && key->form == Form::number;
    if (!copied && (list || node->is_table()))
      complaints.add(node->place, fmt::format("'{}' varies over copies, and there are none: expected {}",
                                              key->last(), expected(*key)));
    else if (list && int(node->list().size()) != n)
      complaints.add(node->place, fmt::format("'{}': expected one for each of the {} copies, got {}",
                                              key->last(), n, node->list().size()));
  }
}

// the concrete table of one copy: its own place and values, then what was set from outside
Node single(const Fields& fields, const std::string& kind, int i, int n, const Vec& position,
            const Vec& velocity, double angle) {
  Node one = fields.table();
  std::erase_if(one.table(), [](const Entry& entry) {
    return entry.key == "copies" || entry.key == "name" || entry.key == "fixed";
  });
  const auto leaf = [](Place place, double x) { return Node{place, x}; };
  const auto put = [&](const std::string& key, Node value) {
    if (Node* there = one.find(key)) {
      *there = std::move(value);
    } else {
      one.table().push_back({key, one.place, std::move(value)});
    }
  };
  for (const Key* key : keys_of(kind)) {
    const Node* node = fields.given(key->last());
    if (!node || !key->varies || node->is_number()) continue;
    if (key->form == Form::number) put(std::string(key->last()), leaf(node->place, number(*node, i, n)));
    if (key->form == Form::color && node->is_list())
      put("color", node->list()[std::size_t(i) % node->list().size()]);
  }
  const Place at = fields.place("position"), moving = fields.place("velocity");
  put("position", Node{at, Node::List{leaf(at, position.x()), leaf(at, position.y())}});
  put("velocity", Node{moving, Node::List{leaf(moving, velocity.x()), leaf(moving, velocity.y())}});
  if (kind != "particle") put("angle", leaf(fields.place("angle"), angle));
  return one;
}

bool has(const Node& words, std::string_view word) {
  return std::any_of(words.list().begin(), words.list().end(),
                     [&](const Node& each) { return each.text() == word; });
}

// adds the i-th of n to the world, its own origin at `position`; angle in degrees
void add(Making& making, const Fields& fields, const std::string& kind, const Solid& solid,
         const std::string& name, int i, int n, const Vec& position, const Vec& velocity, double angle,
         bool fixed) {
  sim::Body<2> body;
  body.name = name;
  body.elasticity = number(fields.node("elasticity"), i, n);
  body.friction = number(fields.node("friction"), i, n);
  const Node* drag = fields.given("drag");
  body.drag = drag ? number(*drag, i, n) : making.drag;
  body.fixed = fixed;
  body.handout = fields.given("collision") != nullptr;
  if (fields.given("group")) {
    auto& families = making.roster.families;
    body.group = families.emplace(fields.text("group"), int(families.size()) + 1).first->second;
  }
  sim::State<2>& state = making.world.state;
  const Vec center = kind == "particle" ? Vec(Vec::Zero()) : solid.bulk.center;
  if (kind != "particle") {
    body.shape = solid.shape;
    const Node* mass = fields.given("mass");
    body.mass = mass ? number(*mass, i, n) : number(fields.node("density"), i, n) * solid.bulk.content;
    body.inertia << body.mass * (solid.bulk.second[0] / solid.bulk.content);
    if (!(std::isfinite(body.inertia[0]) && body.inertia[0] > 0))
      making.complaints.add(fields.place(kind == "box"       ? "size"
                                         : kind == "ball"    ? "radius"
                                         : kind == "polygon" ? "points"
                                                             : "shapes"),
                            fmt::format("the {}'s moment of inertia, {} kg m^2, cannot be reckoned with",
                                        kind, body.inertia[0]));
    state.turn.emplace_back(sim::Turn<2>(radians(angle)));
    state.spin.emplace_back(sim::Spin<2>(fixed ? 0.0 : radians(number(fields.node("spin"), i, n))));
  } else {
    body.mass = number(fields.node("mass"), i, n);
    if (const Node* radius = fields.given("radius")) {
      body.shape.kind = sim::ShapeKind::ball;
      body.shape.radius = number(*radius, i, n);
    }
  }
  state.x.push_back(center.isZero(0) ? position : Vec(position + turned(center, radians(angle))));
  state.v.push_back(fixed ? Vec::Zero() : velocity);
  making.world.model.bodies.push_back(std::move(body));
  making.roster.centers.push_back(center);

  draw::BodyLook look;
  if (const Node* color = fields.given("color")) {
    look.color = draw::color(color->is_list() ? color->list()[std::size_t(i) % color->list().size()].text()
                                              : color->text());
  } else if (!fixed && !making.knots) {
    look.color = draw::color(kPalette[std::size_t(making.declared) % std::size(kPalette)]);
  }
  const Node* trail = fields.given("trail");
  look.trail = trail ? trail->number() : fixed ? 0 : making.trail;
  const Node* arrows = fields.given("arrows");
  look.velocity = arrows ? has(*arrows, "velocity") : making.velocity && !fixed;
  look.contact = arrows ? has(*arrows, "contact") : making.contact && !fixed;
  making.looks.push_back(look);
}

// how far a shape reaches beyond a wall
double reach(const sim::World<2>& world, int body, const sim::Shape<2>& shape, const sim::Wall<2>& wall) {
  const auto at = [&](const Vec& local) { return beyond(wall, place(world, body, local)); };
  double most = at(shape.center) + shape.radius;
  if (shape.kind == sim::ShapeKind::box)
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0})
        most = std::max(most, at(shape.center + shape.half.cwiseProduct(Vec(sx, sy))));
  if (!shape.vertices.empty() || !shape.parts.empty()) most = -std::numeric_limits<double>::infinity();
  for (const Vec& vertex : shape.vertices) most = std::max(most, at(vertex));
  for (const sim::Shape<2>& part : shape.parts) most = std::max(most, reach(world, body, part, wall));
  return most;
}

// how far the body reaches beyond a wall; one that is held counts by its centre
double reach(const sim::World<2>& world, int body, const sim::Wall<2>& wall) {
  const sim::Body<2>& it = world.model.bodies[std::size_t(body)];
  return it.fixed ? beyond(wall, world.state.x[std::size_t(body)]) : reach(world, body, it.shape, wall);
}

// the first of a group that is outside the room, by which wall and how far
void refuse_outside(const Making& making, const Group& group, Place place) {
  int outside = 0;
  std::string message;
  for (int body = group.first; body < group.first + group.count; ++body) {
    double most = 0;
    std::size_t worst = 0;
    for (std::size_t w = 0; w < making.room.walls.size(); ++w) {
      const double far = reach(making.world, body, making.room.walls[w]);
      if (far > most) most = far, worst = w;
    }
    const double rounding = 1e-9 * (1 + making.world.state.x[std::size_t(body)].cwiseAbs().maxCoeff());
    if (most <= rounding) continue;
    if (outside++ > 0) continue;
    const Place wall = making.room.places[worst];
    message = fmt::format(
        "'{}' is outside the room: {:.3g} m beyond {} ({})",
        making.world.model.bodies[std::size_t(body)].name, most, making.room.names[worst],
        wall == Place{} ? "8 m by 4.5 m where room.size is left out" : making.complaints.text(wall));
  }
  if (outside > 1) message += fmt::format(", and so are {} more of its copies", outside - 1);
  if (outside > 0) making.complaints.add(place, message);
}

void declaration(Making& making, Roster& roster, const Node& table, const std::string& kind, int ordinal,
                 const std::vector<CopySet>& sets) {
  const Fields fields(table, kind);
  Complaints& complaints = making.complaints;
  Group group;
  group.name = fields.given("name") ? fields.text("name") : fmt::format("{}[{}]", kind, ordinal);
  group.place = fields.place("name");
  group.at = fields.place("position");
  group.first = int(making.world.model.bodies.size());
  // nameless ones have the names ball[0], ball[1], ...: another name would mean two things
  if (const Node* same = fields.given("name") ? making.top.find(group.name) : nullptr;
      same && same->is_list())
    for (const Node& each : same->list())
      if (!each.find("name")) {
        complaints.add(group.place,
                       fmt::format("the name '{0}' is what [[{0}]]s without one are called, as at {1}",
                                   group.name, complaints.text(each.place)));
        return;
      }
  if (const auto before = roster.index.find(group.name); before != roster.index.end()) {
    // said at the second in the file
    Place first = roster.groups[std::size_t(before->second)].place, second = group.place;
    if (std::tie(second.line, second.column) < std::tie(first.line, first.column)) std::swap(first, second);
    complaints.add(second, fmt::format("the name '{}' is taken by another body at {}", group.name,
                                       complaints.text(first)));
    return;
  }
  if (kind != "particle" && fields.given("mass") && fields.given("density"))
    complaints.add(std::max(fields.place("mass"), fields.place("density"),
                            [](Place a, Place b) { return a.line < b.line; }),
                   "'mass' and 'density' both say how heavy it is; leave one out");

  // how many, and how each lies from the one before
  const bool copied = fields.given("copies") != nullptr;
  const Node none{{}, Node::Table{}};
  const Fields copies(copied ? *fields.given("copies") : none, kind + ".copies");
  const auto sides = grid(copies, group.first, complaints);
  if (!sides) return;
  const std::vector<Vec> steps = offsets(copies, sides->size(), complaints);
  if (copied) group.grid = *sides;
  for (const int side : *sides) group.count *= side;
  const std::size_t wrong = complaints.count();
  refuse_odd_lists(fields, kind, copied, group.count, complaints);
  if (complaints.count() != wrong) return;

  // which are held
  std::vector<bool> held(std::size_t(group.count), false);
  if (const Node& fixed = fields.node("fixed"); fixed.is_text()) {
    const auto which = range(fixed.text(), group.count);
    if (!which || !copied) {
      complaints.add(
          fixed.place,
          copied
              ? fmt::format("'fixed': expected which of the {} copies, such as \"0..{}\" or \"0,{}\", got {}",
                            group.count, group.count - 1, group.count - 1, quoted(fixed.text()))
              : "'fixed': expected true or false; a list of copies needs copies");
    } else {
      for (const int i : *which) held[std::size_t(i)] = true;
    }
  } else {
    held.assign(std::size_t(group.count), std::get<bool>(fixed.value));
  }

  const Node* at = fields.given("position");
  if (!at && !making.room.bounds) {
    complaints.add(fields.place(), fmt::format("[[{}]] needs 'position': an open room has no middle", kind));
    return;
  }
  const Node* nets = making.top.find("net");
  making.knots = nets && std::any_of(nets->list().begin(), nets->list().end(), [&](const Node& net) {
                   const Node* of = net.find("of");
                   return of && of->text() == group.name;
                 });
  const bool turns = kind != "particle";
  const Solid one_for_all = turns ? solid(fields, kind, 0, group.count, complaints) : Solid{};
  const Node* about = copies.given("around");
  const double turn = copies.number("turn"), jitter = copies.number("jitter");
  for (int i = 0; i < group.count; ++i) {
    Vec position =
        at ? vector(*at, i, group.count) : Vec((making.room.bounds->low + making.room.bounds->high) / 2);
    Vec velocity = vector(fields.node("velocity"), i, group.count);
    double angle = turns ? number(fields.node("angle"), i, group.count) : 0;

    // along the grid, then about a place, then aside
    position += steps[0] * (i % sides->front());
    if (sides->size() > 1) position += steps[1] * (i / sides->front());
    if (turn != 0 && i > 0) {
      if (about) position = vector(*about) + turned(position - vector(*about), radians(turn * i));
      velocity = turned(velocity, radians(turn * i));
      angle += turn * i;
    }
    if (jitter > 0) {
      const auto stream = std::uint64_t(ordinal) * 2 + (kind == "box" ? 1 : 0) +
                          (kind == "ball"      ? std::uint64_t(1) << 40
                           : kind == "polygon" ? std::uint64_t(2) << 40
                           : kind == "body"    ? std::uint64_t(3) << 40
                                               : 0);
      position += jitter * Vec(even(making.seed, stream, std::uint64_t(i) * 2),
                               even(making.seed, stream, std::uint64_t(i) * 2 + 1));
    }

    const std::string name = copied ? fmt::format("{}[{}]", group.name, i) : group.name;
    std::vector<const CopySet*> own;
    for (const CopySet& set : sets)
      if (set.kind == kind && set.table == ordinal && set.copy == i) own.push_back(&set);
    if (own.empty() || !copied) {
      add(making, fields, kind,
          kind == "ball" ? solid(fields, kind, i, group.count, complaints) : one_for_all, name, i,
          group.count, position, velocity, angle, held[std::size_t(i)]);
      continue;
    }
    Node one = single(fields, kind, i, group.count, position, velocity, angle);
    for (const CopySet* set : own) write(one, kind, set->path, set->value, set->place, complaints);
    check(one, kind, complaints);
    const Fields its(one, kind);
    for (const char* whole : {"copies", "name"})
      if (its.given(whole))
        complaints.add(its.place(whole),
                       fmt::format("'{}' is one for all copies; set {}.{}", whole, group.name, whole));
    bool fixed = held[std::size_t(i)];
    if (const Node* own_fixed = its.given("fixed")) {
      if (own_fixed->is_text())
        complaints.add(own_fixed->place, "'fixed': expected true or false for one copy");
      else
        fixed = std::get<bool>(own_fixed->value);
    }
    const Solid its_own = turns ? solid(its, kind, 0, 1, complaints) : Solid{};
    add(making, its, kind, its_own, name, 0, 1, its.given("position") ? its.vector("position") : position,
        its.given("velocity") ? its.vector("velocity") : velocity, turns ? its.number("angle") : 0, fixed);
  }
  for (const CopySet& set : sets)
    if (set.kind == kind && set.table == ordinal && (set.copy >= group.count || !copied))
      complaints.add(set.place, copied ? fmt::format("'{}' has {} copies: {}[0] .. {}[{}]", group.name,
                                                     group.count, group.name, group.name, group.count - 1)
                                       : fmt::format("'{}' has no copies", group.name));
  refuse_outside(making, group, fields.place("position"));
  if (!making.knots && !fields.given("color")) ++making.declared;
  roster.index.emplace(group.name, int(roster.groups.size()));
  roster.groups.push_back(std::move(group));
}

}  // namespace

double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

Vec turned(const Vec& v, double angle) {
  const auto [s, c] = sim::sin_cos(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

Vec place(const sim::World<2>& world, int body, const Vec& local) {
  const Vec& x = world.state.x[std::size_t(body)];
  const int particles = int(world.state.x.size() - world.state.turn.size());
  if (body < particles || local.isZero(0)) return x + local;
  return x + turned(local, world.state.turn[std::size_t(body - particles)][0]);
}

const Group* Roster::group(const std::string& name, Place place, Complaints& complaints) const {
  if (const auto found = index.find(name); found != index.end()) return &groups[std::size_t(found->second)];
  std::vector<std::string_view> names;
  if (!complaints.enough())
    for (const Group& each : groups) names.push_back(each.name);
  complaints.add(place, fmt::format("no body is called {}{}", quoted(name), did_you_mean(name, names)));
  return nullptr;
}

std::vector<int> Roster::bodies(const std::string& text, Place place, Complaints& complaints) const {
  if (const auto whole = index.find(text); whole != index.end()) {
    const Group& it = groups[std::size_t(whole->second)];
    if (it.count == 1) return {it.first};
    complaints.add(place, fmt::format("'{}' is {} copies; say which: {}[0] .. {}[{}], or all, {}[*]", it.name,
                                      it.count, it.name, it.name, it.count - 1, it.name));
    return {};
  }
  const auto its = reference(text);
  if (!its) {
    complaints.add(
        place, fmt::format("{} is no name of a body; expected one such as ball or ball[3]", quoted(text)));
    return {};
  }
  const Group* it = group(its->bracketed ? its->name : text, place, complaints);
  if (!it) return {};
  if (it->grid.empty()) {
    complaints.add(place, fmt::format("'{}' has no copies; write it without brackets", it->name));
    return {};
  }
  auto which = range(its->which, it->count);
  if (!which) {
    complaints.add(place, fmt::format("{}: '{}' has {} copies, {}[0] .. {}[{}]", quoted(text), it->name,
                                      it->count, it->name, it->name, it->count - 1));
    return {};
  }
  for (int& body : *which) body += it->first;
  return *which;
}

Roster bodies(const Node& top, const Room& room, std::uint64_t seed, const std::vector<CopySet>& sets,
              sim::World<2>& world, std::vector<draw::BodyLook>& looks, Complaints& complaints) {
  Roster roster;
  Making making{top, room, seed, world, looks, roster, complaints};
  making.drag = Fields::of(top, "room").number("drag");
  const Fields look = Fields::of(top, "look");
  if (const Node& trails = look.node("trails"); trails.is_number()) making.trail = trails.number();
  making.velocity = has(look.node("arrows"), "velocity");
  making.contact = has(look.node("arrows"), "contact");
  for (const std::string_view kind : body_kinds()) {
    const Node* all = top.find(kind);
    for (std::size_t i = 0; all && i < all->list().size(); ++i)
      declaration(making, roster, all->list()[i], std::string(kind), int(i), sets);
  }
  return roster;
}

}  // namespace obscura::scene
