#include "scene/links.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "scene/fields.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostSprings = 4'000'000;

// a side of a thing in its own frame
struct Way {
  std::string_view word;
  int axis, side;
};
constexpr Way kWays[] = {{"left", 0, -1}, {"right", 0, 1}, {"bottom", 1, -1},
                         {"top", 1, 1},   {"back", 2, -1}, {"front", 2, 1}};

// the corner or side that words such as "top left" mean, in halves of a thing's size: a word for each axis at
// most; nothing where they mean none
template <int D>
std::optional<sim::Vec<D>> way(std::string_view words) {
  sim::Vec<D> sum = sim::Vec<D>::Zero();
  if (words == "center") return sum;
  while (!words.empty()) {
    const std::string_view word = words.substr(0, words.find(' '));
    const auto found =
        std::find_if(std::begin(kWays), std::end(kWays), [&](const Way& w) { return w.word == word; });
    if (found == std::end(kWays) || found->axis >= D || sum[found->axis] != 0) return {};
    sum[found->axis] = found->side;
    words.remove_prefix(std::min(words.size(), word.size() + 1));
  }
  if (sum.isZero(0)) return {};
  return sum;
}

// the words there are, upper ones first
template <int D>
std::vector<std::string> all_words() {
  std::vector<std::string> all;
  for (const char* depth : {"", " front", " back"}) {
    if (D == 2 && *depth) continue;
    for (const char* up : {"top", "", "bottom"}) {
      for (const char* across : {" left", "", " right"}) {
        const std::string word = std::string(up) + across + depth;
        all.push_back(word.empty() ? "center" : word[0] == ' ' ? word.substr(1) : word);
      }
    }
  }
  return all;
}

// the position of that point on a shape, if the shape has it
template <int D>
std::optional<sim::Vec<D>> spot(const sim::Shape<D>& shape, std::string_view word) {
  const auto found = way<D>(word);
  if (!found) return {};
  return sim::of_form(shape, [&](const auto& form) { return form.side(*found); });
}

// a value that varies over the springs of one table needs one value for each spring
bool fits(const Fields& fields, const char* key, int n, Diagnostics& complaints) {
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

template <int D>
bool too_many(const sim::World<D>& world, std::size_t more, Place place, Diagnostics& complaints) {
  if (world.model.springs.size() + more <= kMostSprings) return false;
  complaints.add(place, fmt::format("{} springs in all are more than {}, the most a scene may have",
                                    world.model.springs.size() + more, kMostSprings));
  return true;
}

}  // namespace

template <int D>
sim::Vec<D> start(const sim::World<D>& world, const sim::End<D>& end) {
  return end.body < 0 ? end.local : place(world, end.body, end.local);
}

template <int D>
std::vector<sim::End<D>> ends(const Node& node, const Seating<D>& roster, const sim::World<D>& world,
                              Diagnostics& complaints) {
  using End = sim::End<D>;
  if (node.is_list()) return {End{-1, vector<D>(node)}};
  const Node& name = node.is_text() ? node : *node.find("body");
  std::vector<End> all;
  for (const int body : roster.bodies(name.text(), name.place, complaints))
    all.push_back({body, sim::Vec<D>::Zero()});
  if (node.is_text() || all.empty()) return all;

  // a point of a body that turns
  const Node* local = node.find("local");
  const Node* at = node.find("at");
  const sim::Body<D>& first = world.model.bodies[std::size_t(all.front().body)];
  if ((local || at) && sim::round_radius(first.shape) && (sim::is_point(first.shape) || !first.turns())) {
    complaints.add((local ? local : at)->place,
                   fmt::format("{} is a particle, which has no point but its centre", in_quotes(name.text())));
    return {};
  }
  for (End& end : all) {
    const sim::Shape<D>& its = world.model.bodies[std::size_t(end.body)].shape;
    if (local) {
      end.local = roster.seats[std::size_t(end.body)].seen(vector<D>(*local));
      continue;
    }
    if (!at) continue;
    const auto place = spot<D>(its, at->text());
    if (!place) {
      const std::vector<std::string> known = all_words<D>();
      std::vector<std::string_view> words;
      for (const std::string& word : known)
        if (spot<D>(its, word)) words.push_back(word);
      complaints.add(
          at->place,
          spot<D>(its, "top right")
              ? fmt::format("'at': expected a corner or side such as \"top right\" or \"left\", got {}{}",
                            in_quotes(at->text()), did_you_mean(at->text(), words))
              : fmt::format("'at': expected {}, got {}",
                            words.size() > 1 ? "a side such as \"top\" or \"left\""
                                             : "\"center\", or a point as 'local'",
                            in_quotes(at->text())));
      return {};
    }
    end.local = *place;
  }
  return all;
}

template <int D>
std::vector<NameRange> springs(const Node& top, const Seating<D>& roster, sim::World<D>& world,
                               Diagnostics& complaints) {
  using End = sim::End<D>;
  std::vector<NameRange> ranges;
  const Node* all = top.find("spring");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "spring");
    const Node* between = fields.given("between");
    if (!between) continue;
    const std::vector<End> a = ends<D>(between->list()[0], roster, world, complaints);
    const std::vector<End> b = ends<D>(between->list()[1], roster, world, complaints);
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
    const Node* rest = fields.given("rest_length");
    if (!fields.flag("joined") && !rest) {
      complaints.add(fields.place("joined"),
                     "a spring that an event joins needs 'rest_length': it may be of any length then");
      continue;
    }
    const int first = int(world.model.springs.size());
    for (int i = 0; i < n; ++i) {
      sim::Spring<D> spring;
      spring.loose = !fields.flag("joined");
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
      spring.rest_length =
          rest ? number(*rest, i, n) : (start(world, spring.b) - start(world, spring.a)).norm();
      if (!spring.loose && spring.rest_length > 0 && start(world, spring.a) == start(world, spring.b)) {
        complaints.add(between->place,
                       fmt::format("both ends of {} are at one place, and it is {} m long at rest: it has no "
                                   "direction to push; move one end a little",
                                   automatic(fields, "spring", k), spring.rest_length));
        break;
      }
      world.model.springs.push_back(spring);
    }
    ranges.push_back({automatic(fields, "spring", k), first, int(world.model.springs.size())});
  }
  return ranges;
}

template <int D>
void nets(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints) {
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
    if (group->grid.size() > 2) {
      complaints.add(
          of->place,
          fmt::format("'{}' is a grid in three directions: a net joins a row or a grid of two", group->name));
      continue;
    }
    const int columns = group->grid[0], rows = group->grid.size() > 1 ? group->grid[1] : 1;
    if (too_many(world, std::size_t(group->count) * 4, of->place, complaints)) continue;
    const Node* rest = fields.given("rest_length");
    const auto join = [&](int i, int j, bool diagonal) {
      sim::Spring<D> spring;
      spring.a.body = group->first + i, spring.b.body = group->first + j;
      spring.stiffness = fields.number("stiffness");
      spring.damping = fields.number("damping");
      spring.rest_length = rest ? rest->number() * (diagonal ? std::sqrt(2.0) : 1.0)
                                : (start(world, spring.b) - start(world, spring.a)).norm();
      world.model.springs.push_back(spring);
    };
    const bool diagonals = fields.flag("diagonals");
    if (diagonals && (columns < 2 || rows < 2))
      complaints.add(
          fields.place("diagonals"),
          fmt::format("'diagonals' does nothing: '{}' is one row, and a grid has them", group->name));
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

template <int D>
void mice(const Node& top, sim::World<D>& world, Diagnostics& complaints) {
  const Node* all = top.find("mouse");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "mouse");
    const Node* path = fields.given("path");
    if (!path) continue;
    if (std::all_of(world.model.bodies.begin(), world.model.bodies.end(),
                    [](const sim::Body<D>& body) { return body.fixed; })) {
      complaints.add(fields.place(), "the mouse has nothing to take: no body of the scene can move");
      continue;
    }
    sim::Mouse<D> mouse;
    for (const Node& knot : path->list()) {
      sim::Vec<D> at;
      for (int axis = 0; axis < D; ++axis) at[axis] = knot.list()[std::size_t(axis) + 1].number();
      mouse.path.push_back({exact(knot.list()[0]), at});
    }
    mouse.stiffness = fields.number("stiffness");
    mouse.damping = fields.number("damping");
    // twenty reference pixels: a length in the room, whatever the size of the picture
    const Node* rest = fields.given("rest_length");
    mouse.rest_length = rest ? rest->number() : 20.0 / 480 * world.model.scale;
    world.model.mice.push_back(std::move(mouse));
    world.state.grips.emplace_back();
  }
}

#define OBSCURA_INSTANTIATE(D)                                                                              \
  template sim::Vec<D> start<D>(const sim::World<D>&, const sim::End<D>&);                                  \
  template std::vector<sim::End<D>> ends<D>(const Node&, const Seating<D>&, const sim::World<D>&,           \
                                            Diagnostics&);                                                  \
  template std::vector<NameRange> springs<D>(const Node&, const Seating<D>&, sim::World<D>&, Diagnostics&); \
  template void nets<D>(const Node&, const NameTable&, sim::World<D>&, Diagnostics&);                       \
  template void mice<D>(const Node&, sim::World<D>&, Diagnostics&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
