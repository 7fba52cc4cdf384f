#include "scene/bodies.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "draw/picture/formula.h"
#include "scene/body_kinds.h"
#include "scene/check.h"
#include "scene/copies.h"
#include "scene/fields.h"
#include "scene/friction.h"
#include "scene/motions.h"
#include "scene/overlap.h"
#include "scene/path.h"
#include "scene/solid.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

// the palette's order for what has no colour; vermilion is for forces
constexpr const char* kPalette[] = {"blue", "green", "orange", "purple", "sky", "yellow", "grey"};

// everything about the making of one scene's bodies
template <int D>
struct BuilderContext {
  const Node& top;
  const Room<D>& room;
  std::uint64_t seed;
  const Dimension& told;
  sim::World<D>& world;
  std::vector<draw::BodyLook>& looks;
  Seating<D>& roster;
  Constants& constants;
  Diagnostics& complaints;
  bool rotation = true;                    // the scene's
  double ground_drag = 0;                  // the room's
  double drag = 0, quadratic_drag = 0;     // the room's
  double trail = 0;                        // the look's
  bool velocity = false, contact = false;  // arrows on every body
  int declared = 0;                        // groups so far: which colour is next
  bool knots = false;  // the group at hand is joined by a net: draw has a colour for those
};

bool has(const Node& words, std::string_view word) {
  return std::any_of(words.list().begin(), words.list().end(),
                     [&](const Node& each) { return each.text() == word; });
}

// whether a table of a body that can turn lets it
template <int D>
bool rotates(const BuilderContext<D>& making, const Fields& fields, const BodyKind& kind) {
  if (!kind.turns) return false;
  const Node* own = fields.given("rotation");
  return own ? std::get<bool>(own->value) : making.rotation;
}

// moments of inertia that a table gives the i-th of n: one number in the plane, three in space
sim::AngularVec<2> moments(const Node& node, int i, int n, sim::AngularVec<2>*) {
  return sim::AngularVec<2>(number(node, i, n));
}
sim::AngularVec<3> moments(const Node& node, int i, int n, sim::AngularVec<3>*) {
  return vector<3>(node, i, n);
}
template <int D>
sim::AngularVec<D> given_inertia(const Node& node, int i, int n, Diagnostics& complaints) {
  const sim::AngularVec<D> I = moments(node, i, n, static_cast<sim::AngularVec<D>*>(nullptr));
  if (!(I.minCoeff() > 0))
    complaints.add(node.place, "'inertia' must be positive");
  else if (D == 3 && 2 * I.maxCoeff() > I.sum() * (1 + 1e-9))
    complaints.add(node.place, "'inertia': no body has a moment that is more than the sum of the other two");
  return I;
}

// adds the i-th of n to the world
template <int D>
void add(BuilderContext<D>& making, const Fields& fields, const BodyKind& kind, const Solid<D>& formed,
         const std::string& name, int i, int n, const Start<D>& start, int copy, bool copied) {
  const Node* center = kind.turns ? fields.given("center_of_mass") : nullptr;
  const Solid<D> solid = center ? with_center<D>(formed, vector<D>(*center)) : formed;
  sim::Body<D> body;
  body.name = name;
  body.elasticity = number(fields.node("elasticity"), i, n);
  body.friction = number(fields.node("friction"), i, n);
  body.static_friction = static_friction(fields, body.friction, making.complaints, i, n);
  const Node* drag = fields.given("drag");
  body.drag = drag ? number(*drag, i, n) : making.drag;
  const Node* ground_drag = fields.given("ground_drag");
  body.ground_drag = ground_drag ? number(*ground_drag, i, n) : making.ground_drag;
  const Node* quadratic_drag = fields.given("quadratic_drag");
  body.quadratic_drag = quadratic_drag ? number(*quadratic_drag, i, n) : making.quadratic_drag;
  body.charge = number(fields.node("charge"), i, n);
  body.fixed = start.fixed;
  body.handout = fields.given("collision") != nullptr;
  if (fields.given("group")) {
    auto& families = making.roster.families;
    body.group = families.emplace(fields.text("group"), int(families.size()) + 1).first->second;
  }
  sim::State<D>& state = making.world.state;
  Seat<D> seat;
  body.shape = solid.shape;
  if (kind.turns) {
    seat = {solid.bulk.center, solid.bulk.axes};
    const Node* mass = fields.given("mass");
    body.mass = mass ? number(*mass, i, n) : number(fields.node("density"), i, n) * solid.bulk.content;
    body.inertia = body.mass * (solid.bulk.second / solid.bulk.content);
    if (const Node* given = fields.given("inertia"))
      body.inertia = given_inertia<D>(*given, i, n, making.complaints);
    if (!(body.inertia.allFinite() && body.inertia.minCoeff() > 0))
      making.complaints.add(fields.place(kind.measure),
                            fmt::format("the {}'s moment of inertia is too {} to compute with", kind.name,
                                        body.inertia.array().isInf().any() ? "large" : "small"));
    const sim::Orientation<D> turn = sim::composed<D>(start.turn, seat.axes);
    if (rotates(making, fields, kind)) {
      state.turn.push_back(turn);
      state.spin.push_back(start.fixed ? sim::AngularVec<D>(sim::AngularVec<D>::Zero()) : start.spin);
    } else {
      body.inertia.setZero();
      body.shape = held<D>(body.shape, turn);
      seat.axes = sim::inverse<D>(start.turn);
    }
  } else {
    body.mass = number(fields.node("mass"), i, n);
  }
  state.x.push_back(seat.center.isZero(0) ? start.position
                                          : sim::Vec<D>(start.position + turned<D>(seat.center, start.turn)));
  state.v.push_back(start.fixed ? sim::Vec<D>(sim::Vec<D>::Zero()) : start.velocity);
  body.copy = copy;
  making.world.model.bodies.push_back(std::move(body));
  making.roster.seats.push_back(seat);
  motion<D>(fields, std::string(kind.name), copy, copied, seat, making.constants, making.world,
            making.complaints);

  const bool still = start.fixed && !fields.given("release");
  draw::BodyLook look;
  if (const Node* color = fields.given("color")) {
    if (color->is_table()) {
      look.color = draw::mix(*draw::color(color->find("from")->text()),
                             *draw::color(color->find("to")->text()), n > 1 ? double(i) / (n - 1) : 0);
    } else {
      look.color = draw::color(color->is_list() ? color->list()[std::size_t(i) % color->list().size()].text()
                                                : color->text());
    }
  } else if (!still && !making.knots) {
    look.color = draw::color(kPalette[std::size_t(making.declared) % std::size(kPalette)]);
  }
  const Node* trail = fields.given("trail");
  look.trail = trail ? trail->number() : still ? 0 : making.trail;
  const Node* arrows = fields.given("arrows");
  look.velocity = arrows ? has(*arrows, "velocity") : making.velocity && !still;
  look.contact = arrows ? has(*arrows, "contact") : making.contact && !still;
  if (const Node* label = fields.given("label")) {
    const std::size_t texts = label->is_list() ? label->list().size() : 1;
    look.label = label->is_list() ? label->list()[std::size_t(i) % texts].text() : label->text();
    const auto wrong = std::size_t(i) < texts ? draw::mistake(look.label) : std::nullopt;
    if (wrong)
      making.complaints.add(fields.place("label"),
                            fmt::format("'label', column {}: {}", wrong->column, wrong->what));
  }
  if (const Node* material = fields.given("material")) {
    const std::string& word = material->text();
    look.material = word == "metal"    ? draw::Material::metal
                    : word == "wood"   ? draw::Material::wood
                    : word == "checks" ? draw::Material::checks
                                       : draw::Material::matte;
  }
  making.looks.push_back(look);
}

// how far the body reaches beyond a wall; one that is held counts by its centre
template <int D>
double reach(const sim::World<D>& world, int body, const std::vector<sim::SupportVertex<D>>& tips,
             const sim::Wall<D>& wall) {
  if (world.model.bodies[std::size_t(body)].fixed) return beyond<D>(wall, world.state.x[std::size_t(body)]);
  double most = -std::numeric_limits<double>::infinity();
  for (const sim::SupportVertex<D>& tip : tips)
    most = std::max(most, beyond<D>(wall, place(world, body, tip.at)) + tip.radius);
  return most;
}

// the first of a group that is outside the room, by which wall and how far
template <int D>
void refuse_outside(const BuilderContext<D>& making, const Group& group, Place place) {
  int outside = 0;
  std::string message;
  for (int body = group.first; body < group.first + group.count; ++body) {
    double most = 0;
    std::size_t worst = 0;
    const std::vector<sim::SupportVertex<D>> tips =
        sim::support_vertices(making.world.model.bodies[std::size_t(body)].shape);
    for (std::size_t w = 0; w < making.room.walls.size(); ++w) {
      const double far = reach(making.world, body, tips, making.room.walls[w]);
      if (far > most) most = far, worst = w;
    }
    const double rounding = 1e-9 * (1 + making.world.state.x[std::size_t(body)].cwiseAbs().maxCoeff());
    const double allowed =
        kAllowedOverlap * 2 * sim::bounding_radius(making.world.model.bodies[std::size_t(body)].shape);
    if (most <= std::max(rounding, allowed)) continue;
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

// the form of the i-th of n
template <int D>
Solid<D> solid_of(const BodyKind& kind, const Fields& fields, int i, int n, Diagnostics& complaints) {
  const Maker<D>& maker = kind.maker<D>();
  // a kind of the other dimension has been complained of
  const sim::Shape<D> typed = maker.make ? maker.make(fields, i, n, complaints) : sim::Ball<D>{1};
  return kind.turns ? solid<D>(typed) : Solid<D>{typed, {}};
}

// the name of a table of bodies, which must be free; false: it is not
template <int D>
bool take_name(BuilderContext<D>& making, const Fields& fields, const Group& group) {
  Diagnostics& complaints = making.complaints;
  // nameless ones have the names ball[0], ball[1], ...: another name would mean two things
  if (const Node* same = fields.given("name") ? making.top.find(group.name) : nullptr;
      same && same->is_list())
    for (const Node& each : same->list())
      if (!each.find("name")) {
        complaints.add(group.place,
                       fmt::format("the name '{0}' is what [[{0}]]s without one are called, as at {1}",
                                   group.name, complaints.text(each.place)));
        return false;
      }
  const auto before = making.roster.index.find(group.name);
  if (before == making.roster.index.end()) return true;
  // said at the second in the file
  Place first = making.roster.groups[std::size_t(before->second)].place, second = group.place;
  if (std::tie(second.line, second.column) < std::tie(first.line, first.column)) std::swap(first, second);
  complaints.add(second, fmt::format("the name '{}' is taken by another body at {}", group.name,
                                     complaints.text(first)));
  return false;
}

// which of the copies are fixed
std::vector<bool> fixed_copies(const Fields& fields, int count, bool copied, Diagnostics& complaints) {
  std::vector<bool> held(std::size_t(count), false);
  const Node& fixed = fields.node("fixed");
  if (!fixed.is_text()) {
    held.assign(std::size_t(count), std::get<bool>(fixed.value));
    return held;
  }
  const auto which = range(fixed.text(), count);
  if (!which || !copied) {
    complaints.add(
        fixed.place,
        copied
            ? fmt::format("'fixed': expected which of the {} copies, such as \"0..{}\" or \"0,{}\", got {}",
                          count, count - 1, count - 1, in_quotes(fixed.text()))
            : "'fixed': expected true or false, without quotes; a list of copies needs copies");
  } else {
    for (const int i : *which) held[std::size_t(i)] = true;
  }
  return held;
}

// whether a net joins the bodies of this group
bool knots_a_net(const Node& top, const std::string& group) {
  const Node* nets = top.find("net");
  return nets && std::any_of(nets->list().begin(), nets->list().end(), [&](const Node& net) {
           const Node* of = net.find("of");
           return of && of->text() == group;
         });
}

// adds one copy of which --set has changed keys, as `own` says
template <int D>
void add_changed(BuilderContext<D>& making, const Fields& fields, const BodyKind& its, const Group& group,
                 int i, Start<D> start, const std::vector<const CopySet*>& own) {
  Diagnostics& complaints = making.complaints;
  const std::string kind(its.name);
  const bool turn_set =
      std::ranges::any_of(own, [](const CopySet* set) { return set->path.front().name == kTurnKey<D>; });
  Node one = single(fields, kind, i, group.count, start, turn_set);
  for (const CopySet* set : own) write(one, kind, set->path, set->value, set->place, D, complaints);
  check(one, kind, making.told, complaints);
  const Fields own_fields(one, kind);
  for (const CopySet* set : own)
    if (const std::string& whole = set->path.front().name;
        whole == "copies" || whole == "name" || whole == "rotation")
      complaints.add(set->place, fmt::format("'{0}' is one for all copies; set {1}.{0}", whole, group.name));
  if (const Node* own_fixed = own_fields.given("fixed")) {
    if (own_fixed->is_text())
      complaints.add(own_fixed->place, "'fixed': expected true or false for one copy, without quotes");
    else
      start.fixed = std::get<bool>(own_fixed->value);
  }
  if (own_fields.given("position")) start.position = own_fields.vector<D>("position");
  if (own_fields.given("velocity")) start.velocity = own_fields.vector<D>("velocity");
  if (own_fields.given("spin")) start.spin = spin<D>(own_fields.node("spin", D), 0, 1);
  if (turn_set) start.turn = turn<D>(own_fields);
  add(making, own_fields, its, solid_of<D>(its, own_fields, 0, 1, complaints),
      fmt::format("{}[{}]", group.name, i), 0, 1, start, i, true);
}

// adds all copies of a table; `sets`: those of --set for one copy of it
template <int D>
void add_copies(BuilderContext<D>& making, const Fields& fields, const BodyKind& its, int ordinal,
                const Group& group, const Copies<D>& copies, const std::vector<bool>& held,
                const std::vector<const CopySet*>& sets) {
  using Vec = sim::Vec<D>;
  const Node* at = fields.given("position");
  const Solid<D> one_for_all = solid_of<D>(its, fields, 0, group.count, making.complaints);
  for (int i = 0; i < group.count; ++i) {
    Start<D> start;
    const std::optional<Vec> begins = path_start<D>(fields);
    start.position = at                       ? vector<D>(*at, i, group.count)
                     : begins                 ? *begins
                     : !copies.places.empty() ? copies.places[std::size_t(i)]
                                              : Vec((making.room.bounds->low + making.room.bounds->high) / 2);
    start.velocity = vector<D>(fields.node("velocity", D), i, group.count);
    if (its.turns) start.spin = spin<D>(fields.node("spin", D), i, group.count);
    if (its.turns) start.turn = copies.orientation(fields, i);
    start.fixed = held[std::size_t(i)];
    copies.move(start, i, making.seed, its.stream + std::uint64_t(ordinal) * 2);

    std::vector<const CopySet*> own;
    for (const CopySet* set : sets)
      if (set->copy == i) own.push_back(set);
    if (!own.empty() && copies.asked) {
      add_changed(making, fields, its, group, i, start, own);
      continue;
    }
    const std::string name = copies.asked ? fmt::format("{}[{}]", group.name, i) : group.name;
    add(making, fields, its,
        its.varies ? solid_of<D>(its, fields, i, group.count, making.complaints) : one_for_all, name, i,
        group.count, start, i, copies.asked);
  }
}

// the bodies of one table
template <int D>
void declaration(BuilderContext<D>& making, const Node& table, const BodyKind& its, int ordinal,
                 const std::vector<CopySet>& all_sets) {
  const std::string kind(its.name);
  const Fields fields(table, kind);
  Diagnostics& complaints = making.complaints;
  Group group;
  group.name = fields.given("name") ? fields.text("name") : fmt::format("{}[{}]", kind, ordinal);
  group.place = fields.place("name");
  group.at = fields.place("position");
  group.first = int(making.world.model.bodies.size());
  if (!take_name(making, fields, group)) return;
  if (its.turns && fields.given("mass") && fields.given("density"))
    complaints.add(std::max(fields.place("mass"), fields.place("density"),
                            [](Place a, Place b) { return a.line < b.line; }),
                   "'mass' and 'density' both say how heavy it is; leave one out");

  // how many, and how each lies from the one before
  const auto copies = scene::copies<D>(fields, kind, group.first, complaints);
  if (!copies) {
    making.roster.wrong.insert(group.name);
    return;
  }
  const bool copied = copies->asked;
  if (copied) group.grid = copies->sides;
  group.count = copies->count();
  const std::vector<bool> held = fixed_copies(fields, group.count, copied, complaints);

  if (!fields.given("position") && !making.room.bounds && copies->places.empty() && !path_start<D>(fields)) {
    complaints.add(fields.place(), fmt::format("[[{}]] needs 'position': an open room has no middle", kind));
    making.roster.wrong.insert(group.name);
    return;
  }
  making.knots = knots_a_net(making.top, group.name);
  if (const Node* spin = fields.given("spin"); spin && !rotates(making, fields, its))
    complaints.add(spin->place, "'spin' of a body that does not turn: 'rotation' is false");
  std::vector<const CopySet*> sets;
  for (const CopySet& set : all_sets)
    if (set.kind == kind && set.table == ordinal) sets.push_back(&set);
  add_copies(making, fields, its, ordinal, group, *copies, held, sets);
  for (const CopySet* set : sets)
    if (set->copy >= group.count || !copied)
      complaints.add(set->place, copied ? fmt::format("'{}' has {} copies: {}[0] .. {}[{}]", group.name,
                                                      group.count, group.name, group.name, group.count - 1)
                                        : fmt::format("'{}' has no copies", group.name));
  refuse_outside(making, group, fields.place("position"));
  if (!making.knots && !fields.given("color")) ++making.declared;
  making.roster.index.emplace(group.name, int(making.roster.groups.size()));
  making.roster.groups.push_back(std::move(group));
}

}  // namespace

template <int D>
Seating<D> bodies(const Node& top, const Room<D>& room, std::uint64_t seed, const std::vector<CopySet>& sets,
                  const Dimension& told, Constants& constants, sim::World<D>& world,
                  std::vector<draw::BodyLook>& looks, Diagnostics& complaints) {
  Seating<D> roster;
  BuilderContext<D> making{top, room, seed, told, world, looks, roster, constants, complaints};
  making.drag = Fields::of(top, "room").number("drag");
  making.quadratic_drag = Fields::of(top, "room").number("quadratic_drag");
  making.ground_drag = Fields::of(top, "room").number("ground_drag");
  making.rotation = Fields::of(top, "physics").flag("rotation");
  const Fields look = Fields::of(top, "look");
  if (const Node& trails = look.node("trails"); trails.is_number()) making.trail = trails.number();
  making.velocity = has(look.node("arrows"), "velocity");
  making.contact = has(look.node("arrows"), "contact");
  // the model has those that do not turn first
  for (const bool turning : {false, true}) {
    for (const BodyKind& kind : body_kinds()) {
      const Node* all = top.find(kind.name);
      for (std::size_t i = 0; all && i < all->list().size(); ++i) {
        const Node& table = all->list()[i];
        if (rotates(making, Fields(table, std::string(kind.name)), kind) == turning)
          declaration(making, table, kind, int(i), sets);
      }
    }
  }
  return roster;
}

#define OBSCURA_INSTANTIATE(D)                                                                              \
  template Seating<D> bodies<D>(const Node&, const Room<D>&, std::uint64_t, const std::vector<CopySet>&,    \
                                const Dimension&, Constants&, sim::World<D>&, std::vector<draw::BodyLook>&, \
                                Diagnostics&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
