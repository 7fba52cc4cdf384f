#include "scene/bodies.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

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
#include "sim/exponential.h"
#include "sim/shape.h"
#include "sim/turning.h"

namespace obscura::scene {

namespace {

constexpr std::int64_t kMostBodies = 1'000'000;
// the palette's order for what has no colour; vermilion is for forces
constexpr const char* kPalette[] = {"blue", "green", "orange", "purple", "sky", "yellow", "grey"};

// everything about the making of one scene's bodies
template <int D>
struct Making {
  const Node& top;
  const Room<D>& room;
  std::uint64_t seed;
  const Dimension& told;
  sim::World<D>& world;
  std::vector<draw::BodyLook>& looks;
  Seating<D>& roster;
  Complaints& complaints;
  bool rotation = true;                    // the scene's
  double ground_drag = 0;                  // the room's
  double drag = 0;                         // the room's
  double trail = 0;                        // the look's
  bool velocity = false, contact = false;  // arrows on every body
  int declared = 0;                        // groups so far: which colour is next
  bool knots = false;  // the group at hand is joined by a net: draw has a colour for those
};

// copies.offset: one step in each direction of the grid
template <int D>
std::vector<sim::Vec<D>> offsets(const Fields& copies, std::size_t directions, Complaints& complaints) {
  std::vector<sim::Vec<D>> steps(directions, sim::Vec<D>::Zero());
  const Node* offset = copies.given("offset");
  if (!offset) return steps;
  if (!offset->list().front().is_list()) {
    if (directions == 1) {
      steps[0] = vector<D>(*offset);
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
  for (std::size_t k = 0; k < directions; ++k) steps[k] = vector<D>(offset->list()[k]);
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
void refuse_odd_lists(const Fields& fields, const std::string& kind, bool copied, int n, int dimension,
                      Complaints& complaints) {
  for (const Key* key : keys_of(kind)) {
    const Node* node = fields.given(key->last());
    if (!key->varies || !node) continue;
    const bool number = key->form == Form::number || (key->form == Form::spin && dimension == 2);
    const bool list = node->is_list() && number;
    if (!copied && (list || node->is_table()))
      complaints.add(node->place, fmt::format("'{}' varies over copies, and there are none: expected {}",
                                              key->last(), expected(*key, dimension)));
    else if (list && int(node->list().size()) != n)
      complaints.add(node->place, fmt::format("'{}': expected one for each of the {} copies, got {}",
                                              key->last(), n, node->list().size()));
  }
}

// how the bodies of one copy begin: seen from the frame that was typed
template <int D>
struct Start {
  sim::Vec<D> position = sim::Vec<D>::Zero(), velocity = sim::Vec<D>::Zero();
  sim::Turn<D> turn = sim::upright<D>();
  sim::Spin<D> spin = sim::Spin<D>::Zero();
  bool fixed = false;
};

Node leaf(Place place, double x) { return {place, x}; }

// a vector as it would have been typed
template <class V>
Node typed(Place at, const V& v) {
  Node::List list;
  for (int k = 0; k < v.size(); ++k) list.push_back(leaf(at, v[k]));
  return {at, std::move(list)};
}

// a turn and a spin as they would have been typed
Node typed_turn(Place at, const sim::Turn<2>& turn) { return leaf(at, degrees(turn[0])); }
Node typed_turn(Place at, const sim::Turn<3>& turn) {
  const sim::Vec3 by = sim::logarithm(turn);
  const double angle = std::sqrt(by.squaredNorm());
  return {at, Node::Table{{"axis", at, typed(at, angle > 0 ? sim::Vec3(by / angle) : sim::Vec3(0, 1, 0))},
                          {"angle", at, leaf(at, degrees(angle))}}};
}

Node typed_spin(const Node& spin, const sim::Spin<2>&, int i, int n) {
  return leaf(spin.place, number(spin, i, n));
}
Node typed_spin(const Node& spin, const sim::Spin<3>& w, int, int) {
  return typed(spin.place, sim::Vec3(w * (180 / std::numbers::pi)));
}

// how it is turned, of the kinds that are
template <int D>
constexpr const char* kTurnKey = D == 2 ? "angle" : "orientation";

// the concrete table of one copy: its own place and values; its turn where that will be set from outside
template <int D>
Node single(const Fields& fields, const std::string& kind, int i, int n, const Start<D>& start, bool turn) {
  Node one = fields.table();
  std::erase_if(one.table(), [](const Entry& entry) {
    return entry.key == "copies" || entry.key == "name" || entry.key == "fixed";
  });
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
    if (key->form == Form::spin) put("spin", typed_spin(*node, start.spin, i, n));
    if (key->form == Form::color && node->is_list())
      put("color", node->list()[std::size_t(i) % node->list().size()]);
  }
  put("position", typed(fields.place("position"), start.position));
  put("velocity", typed(fields.place("velocity"), start.velocity));
  if (turn) put(kTurnKey<D>, typed_turn(fields.place(kTurnKey<D>), start.turn));
  return one;
}

bool has(const Node& words, std::string_view word) {
  return std::any_of(words.list().begin(), words.list().end(),
                     [&](const Node& each) { return each.text() == word; });
}

// whether a table of a body that can turn lets it
template <int D>
bool rotates(const Making<D>& making, const Fields& fields, const std::string& kind) {
  if (kind == "particle") return false;
  const Node* own = fields.given("rotation");
  return own ? std::get<bool>(own->value) : making.rotation;
}

// adds the i-th of n to the world
template <int D>
void add(Making<D>& making, const Fields& fields, const std::string& kind, const Solid<D>& solid,
         const std::string& name, int i, int n, const Start<D>& start) {
  sim::Body<D> body;
  body.name = name;
  body.elasticity = number(fields.node("elasticity"), i, n);
  body.friction = number(fields.node("friction"), i, n);
  const Node* drag = fields.given("drag");
  body.drag = drag ? number(*drag, i, n) : making.drag;
  const Node* ground_drag = fields.given("ground_drag");
  body.ground_drag = ground_drag ? number(*ground_drag, i, n) : making.ground_drag;
  body.fixed = start.fixed;
  body.handout = fields.given("collision") != nullptr;
  if (fields.given("group")) {
    auto& families = making.roster.families;
    body.group = families.emplace(fields.text("group"), int(families.size()) + 1).first->second;
  }
  sim::State<D>& state = making.world.state;
  Seat<D> seat;
  if (kind != "particle") {
    seat = {solid.bulk.center, solid.bulk.axes};
    body.shape = solid.shape;
    const Node* mass = fields.given("mass");
    body.mass = mass ? number(*mass, i, n) : number(fields.node("density"), i, n) * solid.bulk.content;
    body.inertia = body.mass * (solid.bulk.second / solid.bulk.content);
    if (!(body.inertia.allFinite() && body.inertia.minCoeff() > 0))
      making.complaints.add(fields.place(kind == "box"                         ? "size"
                                         : kind == "ball" || kind == "capsule" ? "radius"
                                         : kind == "body"                      ? "shapes"
                                                                               : "points"),
                            fmt::format("the {}'s moment of inertia, {} kg m^2, cannot be reckoned with",
                                        kind, fmt::join(body.inertia, ", ")));
    const sim::Turn<D> turn = sim::composed<D>(start.turn, seat.axes);
    if (rotates(making, fields, kind)) {
      state.turn.push_back(turn);
      state.spin.push_back(start.fixed ? sim::Spin<D>(sim::Spin<D>::Zero()) : start.spin);
    } else {
      body.inertia.setZero();
      body.shape = held<D>(body.shape, turn);
      seat.axes = sim::undone<D>(start.turn);
    }
  } else {
    body.mass = number(fields.node("mass"), i, n);
    if (const Node* radius = fields.given("radius")) {
      body.shape.kind = sim::ShapeKind::ball;
      body.shape.radius = number(*radius, i, n);
    }
  }
  state.x.push_back(seat.center.isZero(0) ? start.position
                                          : sim::Vec<D>(start.position + turned<D>(seat.center, start.turn)));
  state.v.push_back(start.fixed ? sim::Vec<D>(sim::Vec<D>::Zero()) : start.velocity);
  making.world.model.bodies.push_back(std::move(body));
  making.roster.seats.push_back(seat);

  draw::BodyLook look;
  if (const Node* color = fields.given("color")) {
    look.color = draw::color(color->is_list() ? color->list()[std::size_t(i) % color->list().size()].text()
                                              : color->text());
  } else if (!start.fixed && !making.knots) {
    look.color = draw::color(kPalette[std::size_t(making.declared) % std::size(kPalette)]);
  }
  const Node* trail = fields.given("trail");
  look.trail = trail ? trail->number() : start.fixed ? 0 : making.trail;
  const Node* arrows = fields.given("arrows");
  look.velocity = arrows ? has(*arrows, "velocity") : making.velocity && !start.fixed;
  look.contact = arrows ? has(*arrows, "contact") : making.contact && !start.fixed;
  if (fields.given("label")) look.label = fields.text("label");
  making.looks.push_back(look);
}

// how far the body reaches beyond a wall; one that is held counts by its centre
template <int D>
double reach(const sim::World<D>& world, int body, const std::vector<sim::Tip<D>>& tips,
             const sim::Wall<D>& wall) {
  if (world.model.bodies[std::size_t(body)].fixed) return beyond<D>(wall, world.state.x[std::size_t(body)]);
  double most = -std::numeric_limits<double>::infinity();
  for (const sim::Tip<D>& tip : tips)
    most = std::max(most, beyond<D>(wall, place(world, body, tip.at)) + tip.radius);
  return most;
}

// the first of a group that is outside the room, by which wall and how far
template <int D>
void refuse_outside(const Making<D>& making, const Group& group, Place place) {
  int outside = 0;
  std::string message;
  for (int body = group.first; body < group.first + group.count; ++body) {
    double most = 0;
    std::size_t worst = 0;
    const std::vector<sim::Tip<D>> tips = sim::tips(making.world.model.bodies[std::size_t(body)].shape);
    for (std::size_t w = 0; w < making.room.walls.size(); ++w) {
      const double far = reach(making.world, body, tips, making.room.walls[w]);
      if (far > most) most = far, worst = w;
    }
    const double rounding = 1e-9 * (1 + making.world.state.x[std::size_t(body)].cwiseAbs().maxCoeff());
    if (most <= rounding) continue;
    if (outside++ > 0) continue;
    const Place wall = making.room.places[worst];
    message = fmt::format("'{}' is outside the room: {:.3g} m beyond {} ({})",
                          making.world.model.bodies[std::size_t(body)].name, most, making.room.names[worst],
                          wall == Place{} ? fmt::format("{} m by 4.5 m{} where room.size is left out",
                                                        D == 2 ? 8 : 12, D == 2 ? "" : " by 8 m")
                                          : making.complaints.text(wall));
  }
  if (outside > 1) message += fmt::format(", and so are {} more of its copies", outside - 1);
  if (outside > 0) making.complaints.add(place, message);
}

// the stream of random numbers of a kind's n-th table
std::uint64_t stream(const std::string& kind, int ordinal) {
  const std::uint64_t of = kind == "ball"      ? 1
                           : kind == "polygon" ? 2
                           : kind == "body"    ? 3
                           : kind == "capsule" ? 4
                           : kind == "hull"    ? 5
                                               : 0;
  return std::uint64_t(ordinal) * 2 + (kind == "box" ? 1 : 0) + (of << 40);
}

// how a body is turned that was copied and turned by so many degrees about an axis
sim::Turn<2> turned_copy(const Fields& fields, int i, int n, double by, const sim::Vec<2>&) {
  const double angle = number(fields.node("angle"), i, n);
  return sim::Turn<2>(radians(by != 0 ? angle + by : angle));
}
sim::Turn<3> turned_copy(const Fields& fields, int, int, double by, const sim::Vec<3>& axis) {
  const sim::Turn<3> typed = turn<3>(fields);
  return by != 0 ? sim::composed<3>(sim::exponential(radians(by) * axis), typed) : typed;
}

// the turn from one copy to another
sim::Turn<2> between_copies(double by, const sim::Vec<2>&) { return sim::Turn<2>(radians(by)); }
sim::Turn<3> between_copies(double by, const sim::Vec<3>& axis) {
  return sim::exponential(radians(by) * axis);
}

// what copies turn about; of the plane there is but one way
sim::Vec<2> copies_axis(const Fields&, const sim::Vec<2>&) { return {0, 0}; }
sim::Vec<3> copies_axis(const Fields& copies, const sim::Vec<3>&) {
  return copies.vector<3>("axis").stableNormalized();
}

template <int D>
void declaration(Making<D>& making, const Node& table, const std::string& kind, int ordinal,
                 const std::vector<CopySet>& sets) {
  using Vec = sim::Vec<D>;
  Seating<D>& roster = making.roster;
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
  const std::vector<Vec> steps = offsets<D>(copies, sides->size(), complaints);
  if (copied) group.grid = *sides;
  for (const int side : *sides) group.count *= side;
  const std::size_t wrong = complaints.count();
  refuse_odd_lists(fields, kind, copied, group.count, D, complaints);
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
  if (const Node* spin = fields.given("spin"); spin && !rotates(making, fields, kind))
    complaints.add(spin->place, "'spin' of a body that does not turn: 'rotation' is false");
  const Solid<D> one_for_all = turns ? solid<D>(fields, kind, 0, group.count, complaints) : Solid<D>{};
  const bool varied = kind == "ball" || kind == "capsule";
  const Node* about = copies.given("around");
  const double by = copies.number("turn"), jitter = copies.number("jitter");
  const Vec axis = copies_axis(copies, Vec());
  for (int i = 0; i < group.count; ++i) {
    Start<D> start;
    start.position =
        at ? vector<D>(*at, i, group.count) : Vec((making.room.bounds->low + making.room.bounds->high) / 2);
    start.velocity = vector<D>(fields.node("velocity", D), i, group.count);
    if (turns) start.spin = spin<D>(fields.node("spin", D), i, group.count);
    if (turns) start.turn = turned_copy(fields, i, group.count, by * i, axis);
    start.fixed = held[std::size_t(i)];

    // along the grid, then about a place, then aside
    int along = i;
    for (std::size_t k = 0; k < sides->size(); ++k) {
      start.position += steps[k] * (along % (*sides)[k]);
      along /= (*sides)[k];
    }
    if (by != 0 && i > 0) {
      const sim::Turn<D> further = between_copies(by * i, axis);
      if (about) start.position = vector<D>(*about) + turned<D>(start.position - vector<D>(*about), further);
      start.velocity = turned<D>(start.velocity, further);
      start.spin = sim::to_room<D>(sim::rotation<D>(further), start.spin);
    }
    for (int k = 0; k < D && jitter > 0; ++k)
      start.position[k] +=
          jitter * even(making.seed, stream(kind, ordinal), std::uint64_t(i) * D + std::uint64_t(k));

    const std::string name = copied ? fmt::format("{}[{}]", group.name, i) : group.name;
    std::vector<const CopySet*> own;
    bool turn_set = false;
    for (const CopySet& set : sets)
      if (set.kind == kind && set.table == ordinal && set.copy == i) {
        own.push_back(&set);
        turn_set = turn_set || set.path.front().name == kTurnKey<D>;
      }
    if (own.empty() || !copied) {
      add(making, fields, kind, varied ? solid<D>(fields, kind, i, group.count, complaints) : one_for_all,
          name, i, group.count, start);
      continue;
    }
    Node one = single(fields, kind, i, group.count, start, turn_set);
    for (const CopySet* set : own) write(one, kind, set->path, set->value, set->place, D, complaints);
    check(one, kind, making.told, complaints);
    const Fields its(one, kind);
    for (const CopySet* set : own)
      if (const std::string& whole = set->path.front().name;
          whole == "copies" || whole == "name" || whole == "rotation")
        complaints.add(set->place,
                       fmt::format("'{0}' is one for all copies; set {1}.{0}", whole, group.name));
    if (const Node* own_fixed = its.given("fixed")) {
      if (own_fixed->is_text())
        complaints.add(own_fixed->place, "'fixed': expected true or false for one copy");
      else
        start.fixed = std::get<bool>(own_fixed->value);
    }
    if (its.given("position")) start.position = its.vector<D>("position");
    if (its.given("velocity")) start.velocity = its.vector<D>("velocity");
    if (its.given("spin")) start.spin = spin<D>(its.node("spin", D), 0, 1);
    if (turn_set) start.turn = turn<D>(its);
    add(making, its, kind, turns ? solid<D>(its, kind, 0, 1, complaints) : Solid<D>{}, name, 0, 1, start);
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

template <int D>
sim::Vec<D> turned(const sim::Vec<D>& v, const sim::Turn<D>& turn) {
  return sim::rotation<D>(turn) * v;
}

template <int D>
sim::Turn<D> turn_of(const sim::World<D>& world, int body) {
  const int k = body < 0 ? -1 : sim::turning(world.state, body);
  return k < 0 ? sim::upright<D>() : world.state.turn[std::size_t(k)];
}

template <int D>
sim::Vec<D> place(const sim::World<D>& world, int body, const sim::Vec<D>& local) {
  const sim::Vec<D>& x = world.state.x[std::size_t(body)];
  const int k = sim::turning(world.state, body);
  if (k < 0 || local.isZero(0)) return x + local;
  return x + turned<D>(local, world.state.turn[std::size_t(k)]);
}

template <int D>
sim::Vec<D> Seat<D>::seen(const sim::Vec<D>& typed) const {
  const sim::Vec<D> from = typed - center;
  return axes == sim::upright<D>() ? from : turned<D>(from, sim::undone<D>(axes));
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

template <int D>
Seating<D> bodies(const Node& top, const Room<D>& room, std::uint64_t seed, const std::vector<CopySet>& sets,
                  const Dimension& told, sim::World<D>& world, std::vector<draw::BodyLook>& looks,
                  Complaints& complaints) {
  Seating<D> roster;
  Making<D> making{top, room, seed, told, world, looks, roster, complaints};
  making.drag = Fields::of(top, "room").number("drag");
  making.ground_drag = Fields::of(top, "room").number("ground_drag");
  making.rotation = Fields::of(top, "physics").flag("rotation");
  const Fields look = Fields::of(top, "look");
  if (const Node& trails = look.node("trails"); trails.is_number()) making.trail = trails.number();
  making.velocity = has(look.node("arrows"), "velocity");
  making.contact = has(look.node("arrows"), "contact");
  // the model has those that do not turn first
  for (const bool turning : {false, true}) {
    for (const std::string_view kind : body_kinds()) {
      const Node* all = top.find(kind);
      for (std::size_t i = 0; all && i < all->list().size(); ++i) {
        const Node& table = all->list()[i];
        if (rotates(making, Fields(table, std::string(kind)), std::string(kind)) == turning)
          declaration(making, table, std::string(kind), int(i), sets);
      }
    }
  }
  return roster;
}

#define OBSCURA_INSTANTIATE(D)                                                                           \
  template struct Seat<D>;                                                                               \
  template sim::Vec<D> turned<D>(const sim::Vec<D>&, const sim::Turn<D>&);                               \
  template sim::Turn<D> turn_of<D>(const sim::World<D>&, int);                                           \
  template sim::Vec<D> place<D>(const sim::World<D>&, int, const sim::Vec<D>&);                          \
  template Seating<D> bodies<D>(const Node&, const Room<D>&, std::uint64_t, const std::vector<CopySet>&, \
                                const Dimension&, sim::World<D>&, std::vector<draw::BodyLook>&, Complaints&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
