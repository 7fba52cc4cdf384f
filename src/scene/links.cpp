#include "scene/links.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "scene/check.h"
#include "scene/fields.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;
using End = sim::End<2>;

constexpr std::size_t kMostSprings = 4'000'000;

// corners and sides of a box in its own frame, in halves of its size
const std::map<std::string_view, Vec>& spots() {
  static const std::map<std::string_view, Vec> all = {
      {"top left", {-1, 1}},     {"top", {0, 1}},     {"top right", {1, 1}},
      {"left", {-1, 0}},         {"center", {0, 0}},  {"right", {1, 0}},
      {"bottom left", {-1, -1}}, {"bottom", {0, -1}}, {"bottom right", {1, -1}}};
  return all;
}

// which of the spots a shape has, and where
std::optional<Vec> spot(const sim::Shape<2>& shape, std::string_view word) {
  const auto found = spots().find(word);
  if (found == spots().end()) return {};
  const Vec& way = found->second;
  if (shape.kind == sim::ShapeKind::box) return way.cwiseProduct(shape.half);
  if (shape.kind == sim::ShapeKind::ball && way.cwiseAbs().sum() < 1.5) return way * shape.radius;
  if (way.isZero(0)) return way;
  return {};
}

// what varies over the springs of one table must have as many values as there are springs
bool fits(const Fields& fields, const char* key, int n, Complaints& complaints) {
  const Node* node = fields.given(key);
  if (!node || node->is_number()) return true;
  if (node->is_list() && int(node->list().size()) == n) return true;
  if (node->is_table() && n > 1) return true;
  complaints.add(node->place, node->is_list()
                                  ? fmt::format("'{}': expected one for each of the {} springs, got {}", key,
                                                n, node->list().size())
                                  : fmt::format("'{}' varies over many springs, and this is one", key));
  return false;
}

std::string automatic(const Fields& fields, const std::string& kind, std::size_t i) {
  return fields.given("name") ? fields.text("name") : fmt::format("{}[{}]", kind, i);
}

bool too_many(const sim::World<2>& world, std::size_t more, Place place, Complaints& complaints) {
  if (world.model.springs.size() + more <= kMostSprings) return false;
  complaints.add(place, fmt::format("{} springs in all are more than {}, the most a scene may have",
                                    world.model.springs.size() + more, kMostSprings));
  return true;
}

}  // namespace

Vec start(const sim::World<2>& world, const End& end) {
  return end.body < 0 ? end.local : place(world, end.body, end.local);
}

std::vector<End> ends(const Node& node, const Roster& roster, const sim::World<2>& world,
                      Complaints& complaints) {
  if (node.is_list()) return {End{-1, vector(node)}};
  const Node& name = node.is_text() ? node : *node.find("body");
  std::vector<End> all;
  for (const int body : roster.bodies(name.text(), name.place, complaints))
    all.push_back({body, Vec::Zero()});
  if (node.is_text() || all.empty()) return all;

  // a point of a body that turns
  const Node* local = node.find("local");
  const Node* at = node.find("at");
  if ((local || at) && !world.model.bodies[std::size_t(all.front().body)].turns()) {
    complaints.add((local ? local : at)->place,
                   fmt::format("{} is a particle, which has no point but its centre", quoted(name.text())));
    return {};
  }
  for (End& end : all) {
    const sim::Shape<2>& its = world.model.bodies[std::size_t(end.body)].shape;
    if (local) {
      end.local = vector(*local) - roster.centers[std::size_t(end.body)];
      continue;
    }
    if (!at) continue;
    const auto place = spot(its, at->text());
    if (!place) {
      std::vector<std::string_view> words;
      for (const auto& [word, way] : spots())
        if (spot(its, word)) words.push_back(word);
      complaints.add(
          at->place,
          its.kind == sim::ShapeKind::box
              ? fmt::format("'at': expected a corner or side such as \"top right\" or \"left\", got {}{}",
                            quoted(at->text()), did_you_mean(at->text(), words))
              : fmt::format("'at': expected {}, got {}",
                            words.size() > 1 ? "a side such as \"top\" or \"left\""
                                             : "\"center\", or a point as 'local'",
                            quoted(at->text())));
      return {};
    }
    end.local = *place;
  }
  return all;
}

void springs(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints) {
  const Node* all = top.find("spring");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "spring");
    const Node* between = fields.given("between");
    if (!between) continue;
    const std::vector<End> a = ends(between->list()[0], roster, world, complaints);
    const std::vector<End> b = ends(between->list()[1], roster, world, complaints);
    if (a.empty() || b.empty()) continue;
    if (a.size() != b.size() && a.size() != 1 && b.size() != 1) {
      complaints.add(
          between->place,
          fmt::format("'between' has {} ends on one side and {} on the other: expected as many, or one",
                      a.size(), b.size()));
      continue;
    }
    if (a.front().body < 0 && b.front().body < 0) {
      complaints.add(between->place, fmt::format("'between' has two places: {} would move nothing",
                                                 automatic(fields, "spring", k)));
      continue;
    }
    const int n = int(std::max(a.size(), b.size()));
    if (!fits(fields, "stiffness", n, complaints) || !fits(fields, "damping", n, complaints) ||
        !fits(fields, "rest_length", n, complaints) ||
        too_many(world, std::size_t(n), between->place, complaints))
      continue;
    for (int i = 0; i < n; ++i) {
      sim::Spring<2> spring;
      spring.a = a[a.size() == 1 ? 0 : std::size_t(i)];
      spring.b = b[b.size() == 1 ? 0 : std::size_t(i)];
      if (spring.a.body == spring.b.body && spring.a.body >= 0 && spring.a.local == spring.b.local) {
        complaints.add(between->place,
                       fmt::format("both ends of {} are one point of '{}'", automatic(fields, "spring", k),
                                   world.model.bodies[std::size_t(spring.a.body)].name));
        break;
      }
      spring.stiffness = number(fields.node("stiffness"), i, n);
      spring.damping = number(fields.node("damping"), i, n);
      const Node* rest = fields.given("rest_length");
      spring.rest_length =
          rest ? number(*rest, i, n) : (start(world, spring.b) - start(world, spring.a)).norm();
      world.model.springs.push_back(spring);
    }
  }
}

void nets(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints) {
  const Node* all = top.find("net");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "net");
    const Node* of = fields.given("of");
    if (!of) continue;
    const Group* group = roster.group(of->text(), of->place, complaints);
    if (!group) continue;
    if (group->count < 2) {
      complaints.add(
          of->place,
          fmt::format("'{}' has no copies to join: give it copies = {{ count = [5, 4], ... }}", group->name));
      continue;
    }
    const int columns = group->grid[0], rows = group->grid.size() > 1 ? group->grid[1] : 1;
    if (too_many(world, std::size_t(group->count) * 4, of->place, complaints)) continue;
    const Node* rest = fields.given("rest_length");
    const auto join = [&](int i, int j, bool diagonal) {
      sim::Spring<2> spring;
      spring.a.body = group->first + i, spring.b.body = group->first + j;
      spring.stiffness = fields.number("stiffness");
      spring.damping = fields.number("damping");
      spring.rest_length = rest ? rest->number() * (diagonal ? std::sqrt(2.0) : 1.0)
                                : (start(world, spring.b) - start(world, spring.a)).norm();
      world.model.springs.push_back(spring);
    };
    const bool diagonals = fields.flag("diagonals");
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const int i = row * columns + column;
        if (column + 1 < columns) join(i, i + 1, false);
        if (row + 1 < rows) join(i, i + columns, false);
        if (diagonals && column + 1 < columns && row + 1 < rows) {
          join(i, i + columns + 1, true);
          join(i + 1, i + columns, true);
        }
      }
    }
  }
}

void mice(const Node& top, sim::World<2>& world, Complaints& complaints) {
  const Node* all = top.find("mouse");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "mouse");
    const Node* path = fields.given("path");
    if (!path) continue;
    if (std::all_of(world.model.bodies.begin(), world.model.bodies.end(),
                    [](const sim::Body<2>& body) { return body.fixed; })) {
      complaints.add(fields.place(), "the mouse has nothing to take: no body of the scene can move");
      continue;
    }
    sim::Mouse<2> mouse;
    for (const Node& knot : path->list())
      mouse.path.push_back({exact(knot.list()[0]), Vec(knot.list()[1].number(), knot.list()[2].number())});
    mouse.stiffness = fields.number("stiffness");
    mouse.damping = fields.number("damping");
    // twenty reference pixels: a length in the room, whatever the size of the picture
    const Node* rest = fields.given("rest_length");
    mouse.rest_length = rest ? rest->number() : 20.0 / 480 * world.model.scale;
    world.model.mice.push_back(std::move(mouse));
    world.state.grips.emplace_back();
  }
}

}  // namespace obscura::scene
