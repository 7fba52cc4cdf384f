// The i-th copy, i = i_0 + n_0 i_1 + n_0 n_1 i_2 of a grid of n_0 x n_1 x n_2 with steps s_k, turned by i a
// about c:
//   x = c + R(i a) (x_0 + sum i_k s_k - c) + jitter,  v = R v_0,  w = R w_0

#include "scene/copies.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "draw/picture/color.h"
#include "scene/random.h"
#include "scene/roster.h"
#include "sim/math/exponential.h"

namespace obscura::scene {

namespace {

constexpr std::int64_t kMostBodies = 1'000'000;

// copies.offset: one step in each direction of the grid
template <int D>
std::vector<sim::Vec<D>> offsets(const Fields& copies, std::size_t directions, Diagnostics& complaints) {
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
std::optional<std::vector<int>> grid(const Fields& copies, std::int64_t so_far, Diagnostics& complaints) {
  const Node* count = copies.given("count");
  if (!count) return std::vector<int>{1};
  std::vector<int> sides;
  std::int64_t all = 1;
  for (const Node& side : count->is_list() ? count->list() : Node::List{*count}) {
    sides.push_back(int(std::get<std::int64_t>(side.value)));
    all *= sides.back();
    if (all > kMostBodies) break;  // before it is more than a number holds
  }
  if (so_far + all > kMostBodies) {
    complaints.add(count->place,
                   fmt::format("'count': {} bodies in all are more than {}, the most a scene may have",
                               so_far + all, kMostBodies));
    return {};
  }
  return sides;
}

// a value that varies over copies needs copies, and one value for each
void refuse_odd_lists(const Fields& fields, const std::string& kind, bool copied, int n, int dimension,
                      Diagnostics& complaints) {
  for (const Key* key : keys_of(kind)) {
    const Node* node = fields.given(key->last());
    if (!key->varies || !node) continue;
    const bool number = key->form == Form::number || (key->form == Form::spin && dimension == 2);
    const bool list = node->is_list() && (number || (!node->list().empty() && node->list()[0].is_list()));
    if (!copied && (list || node->is_table()))
      complaints.add(node->place, fmt::format("'{}' varies over copies, and there are none: expected {}",
                                              key->last(), expected(*key, dimension)));
    else if (list && int(node->list().size()) != n)
      complaints.add(node->place, fmt::format("'{}': expected one for each of the {} copies, got {}",
                                              key->last(), n, node->list().size()));
  }
}

std::string hex(draw::Color c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }

Node leaf(Place place, double x) { return {place, x}; }

// a vector as it would have been typed
template <class V>
Node typed(Place at, const V& v) {
  Node::List list;
  for (int k = 0; k < v.size(); ++k) list.push_back(leaf(at, v[k]));
  return {at, std::move(list)};
}

// a turn and a spin as they would have been typed
Node typed_turn(Place at, const sim::Orientation<2>& turn) { return leaf(at, degrees(turn[0])); }
Node typed_turn(Place at, const sim::Orientation<3>& turn) {
  const sim::Vec3 by = sim::logarithm(turn);
  const double angle = std::sqrt(by.squaredNorm());
  return {at, Node::Table{{"axis", at, typed(at, angle > 0 ? sim::Vec3(by / angle) : sim::Vec3(0, 1, 0))},
                          {"angle", at, leaf(at, degrees(angle))}}};
}

Node typed_spin(const Node& spin, const sim::AngularVec<2>&, int i, int n) {
  return leaf(spin.place, number(spin, i, n));
}
Node typed_spin(const Node& spin, const sim::AngularVec<3>& w, int, int) {
  return typed(spin.place, sim::Vec3(w * (180 / std::numbers::pi)));
}

// how a body is turned that was copied and turned by so many degrees about an axis
sim::Orientation<2> turned_copy(const Fields& fields, int i, int n, double by, const sim::Vec<2>&) {
  const double angle = number(fields.node("angle"), i, n);
  return sim::Orientation<2>(radians(by != 0 ? angle + by : angle));
}
sim::Orientation<3> turned_copy(const Fields& fields, int, int, double by, const sim::Vec<3>& axis) {
  const sim::Orientation<3> typed = turn<3>(fields);
  return by != 0 ? sim::composed<3>(sim::exponential(radians(by) * axis), typed) : typed;
}

// the turn from one copy to another
sim::Orientation<2> between_copies(double by, const sim::Vec<2>&) { return sim::Orientation<2>(radians(by)); }
sim::Orientation<3> between_copies(double by, const sim::Vec<3>& axis) {
  return sim::exponential(radians(by) * axis);
}

// the axis that copies turn about; the plane has only one
sim::Vec<2> copies_axis(const Fields&, const sim::Vec<2>&) { return {0, 0}; }
sim::Vec<3> copies_axis(const Fields& copies, const sim::Vec<3>&) {
  return copies.vector<3>("axis").stableNormalized();
}

}  // namespace

template <int D>
int Copies<D>::count() const {
  int n = 1;
  for (const int side : sides) n *= side;
  return n;
}

template <int D>
sim::Orientation<D> Copies<D>::orientation(const Fields& fields, int i) const {
  return turned_copy(fields, i, count(), turn * i, axis);
}

template <int D>
void Copies<D>::move(Start<D>& start, int i, std::uint64_t seed, std::uint64_t stream) const {
  if (!places.empty()) start.position = places[std::size_t(i)];
  int along = i;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    start.position += steps[k] * (along % sides[k]);
    along /= sides[k];
  }
  if (turn != 0 && i > 0) {
    const sim::Orientation<D> further = between_copies(turn * i, axis);
    if (around) start.position = *around + turned<D>(start.position - *around, further);
    start.velocity = turned<D>(start.velocity, further);
    start.spin = sim::to_room<D>(sim::rotation<D>(further), start.spin);
  }
  for (int k = 0; k < D && jitter > 0; ++k)
    start.position[k] += jitter * even(seed, stream, std::uint64_t(i) * D + std::uint64_t(k));
}

template <int D>
std::optional<Copies<D>> copies(const Fields& fields, const std::string& kind, int so_far,
                                Diagnostics& complaints) {
  const Node* given = fields.given("copies");
  const Node none{{}, Node::Table{}};
  const Fields table(given ? *given : none, kind + ".copies");
  auto sides = grid(table, so_far, complaints);
  if (!sides) return {};
  Copies<D> all;
  if (const Node* at = table.given("at")) {
    for (const Node& place : at->list()) {
      if (place.is_list()) all.places.push_back(vector<D>(place));
    }
    const int n = int(all.places.size());
    std::string wrong;
    if (n == 0)
      wrong = "'at': expected a list of places, such as [[1, 2], [3, 2]]";
    else if (table.given("count") && (sides->size() != 1 || sides->front() != n))
      wrong = fmt::format("'at' has {} place{}; leave 'count' out", n, n == 1 ? "" : "s");
    else if (table.given("offset") || fields.given("position"))
      wrong = fmt::format("'at' says where each copy is; leave '{}' out",
                          table.given("offset") ? "offset" : "position");
    if (!wrong.empty()) {
      complaints.add(at->place, wrong);
      return {};
    }
    sides = std::vector<int>{n};
  } else if (given && !table.given("count") && complaints.none()) {
    complaints.add(given->place, "'copies' needs 'count' or 'at': how many, or where");
    return {};
  }
  all.asked = given != nullptr;
  all.sides = *sides;
  all.steps = offsets<D>(table, sides->size(), complaints);
  all.turn = table.number("turn"), all.jitter = table.number("jitter");
  all.axis = copies_axis(table, sim::Vec<D>());
  if (const Node* around = table.given("around")) all.around = vector<D>(*around);
  const std::size_t wrong = complaints.count();
  refuse_odd_lists(fields, kind, all.asked, all.count(), D, complaints);
  if (complaints.count() != wrong) return {};
  return all;
}

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
    if (key->last() == "spin") put("spin", typed_spin(*node, start.spin, i, n));
    if (key->last() == "inertia")
      put("inertia",
          D == 2 ? leaf(node->place, number(*node, i, n)) : typed(node->place, vector<3>(*node, i, n)));
    if (key->form == Form::color && node->is_table())
      put("color", {node->place,
                    hex(draw::mix(*draw::color(node->find("from")->text()),
                                  *draw::color(node->find("to")->text()), n > 1 ? double(i) / (n - 1) : 0))});
    if (key->form == Form::color && node->is_list())
      put("color", node->list()[std::size_t(i) % node->list().size()]);
  }
  put("position", typed(fields.place("position"), start.position));
  put("velocity", typed(fields.place("velocity"), start.velocity));
  if (turn) put(kTurnKey<D>, typed_turn(fields.place(kTurnKey<D>), start.turn));
  return one;
}

#define OBSCURA_INSTANTIATE(D)                                                                       \
  template struct Copies<D>;                                                                         \
  template std::optional<Copies<D>> copies<D>(const Fields&, const std::string&, int, Diagnostics&); \
  template Node single<D>(const Fields&, const std::string&, int, int, const Start<D>&, bool)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
