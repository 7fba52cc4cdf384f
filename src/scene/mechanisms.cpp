#include "scene/mechanisms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/joint_words.h"
#include "scene/links.h"
#include "sim/constraint/joints/gear.h"
#include "sim/constraint/joints/pulley.h"
#include "sim/math/orientation.h"
#include "sim/model/body_motion.h"

namespace obscura::scene {

namespace {

using sim::JointKind;

constexpr int kMostRounds = 64;  // of the second wheel, after which whole rounds of both agree
constexpr double kWhole = 1e-9;
constexpr double kBelt = 1e-6;  // of a radius: how far a ratio may be from that of a belt

// keys that neither has
void refuse_other_keys(const Fields& fields, Diagnostics& complaints) {
  const bool gear = fields.text("type") == "gear";
  for (const char* key : {"at", "axis", "limits", "motor", "friction", "spring"})
    if (fields.given(key) && (gear || std::string_view(key) != "friction"))
      complaints.add(fields.place(key), fmt::format("a {} has no '{}'", fields.text("type"), key));
}

template <int D>
double given_breaks(const Fields& fields) {
  const Node* breaks = fields.given("breaks");
  return breaks ? breaks->number() : sim::Joint<D>{}.breaks;
}

// one place that a rope comes to, and whether it is a wheel there
template <int D>
struct Turn {
  sim::End<D> end;
  double radius = 0;  // of a wheel, m
};

// the one end that a node means; none, and a complaint, where it means several or none
template <int D>
std::optional<sim::End<D>> one_end(const Node& node, const Seating<D>& roster, const sim::World<D>& world,
                                   Diagnostics& complaints) {
  if (node.is_text() && node.text() == "room") {
    complaints.add(node.place, fmt::format("where in the room? A pulley needs a place {}",
                                           D == 2 ? "[x, y]" : "[x, y, z]"));
    return {};
  }
  const auto all = ends(node, roster, world, complaints);
  if (all.size() > 1)
    complaints.add(node.place, fmt::format("these are {} bodies, and a rope has one end", all.size()));
  if (all.size() != 1) return {};
  return all.front();
}

// Where the rope turns at b on its way from a to c: to the left positive. Straight on counts as to the right.
double side_of_turn(const sim::Vec<2>& a, const sim::Vec<2>& b, const sim::Vec<2>& c) {
  const sim::Vec<2> u = b - a, v = c - b;
  return u[0] * v[1] - u[1] * v[0] > 0 ? 1 : -1;
}

struct Side {
  std::string_view word;
  double x, y;
};
constexpr Side kSides[] = {{"left", -1, 0}, {"right", 1, 0}, {"above", 0, 1}, {"below", 0, -1}};

// On which side a rope from p leaves a wheel at c that it is wound on, as side_of_turn() has it of its way
// from p to c: on that of `given`, else on the side on which p lies, left or right of the middle where it is
// more above or below, else above or below it. Zero: p lies on neither, or straight on from the side.
double side_of_winding(const sim::Vec<2>& p, const sim::Vec<2>& c, const Side* given) {
  const sim::Vec<2> far = p - c;
  const bool upright = std::fabs(far[0]) <= std::fabs(far[1]);
  const sim::Vec<2> side = given     ? sim::Vec<2>(given->x, given->y)
                           : upright ? sim::Vec<2>(far[0], 0)
                                     : sim::Vec<2>(0, far[1]);
  const double turn = far[0] * side[1] - far[1] * side[0];  // from c to p
  const double whole = given ? std::sqrt(far.squaredNorm()) : far.squaredNorm();
  return std::fabs(turn) <= kWhole * whole ? 0 : turn > 0 ? 1 : -1;
}

// The sides that `wound` gives for the first and the last end, nullptr for "auto"; false, and a complaint,
// where it says what cannot be.
bool given_sides(const Fields& fields, const std::array<bool, 2>& wound, std::array<const Side*, 2>& sides,
                 Diagnostics& complaints) {
  sides = {};
  const Node* node = fields.given("wound");
  for (std::size_t k = 0; node && k < 2; ++k) {
    const Node& word = node->list()[k];
    if (word.text() == "auto") continue;
    const auto found = std::ranges::find(kSides, word.text(), &Side::word);
    if (found == std::end(kSides)) {
      complaints.add(word.place, "'wound': expected left, right, above, below or auto");
      return false;
    }
    if (!wound[k]) {
      complaints.add(word.place, fmt::format("the rope is not wound on a wheel at its {} end: write auto, or "
                                             "name the wheel in 'between' and in 'over'",
                                             k == 0 ? "first" : "second"));
      return false;
    }
    sides[k] = &*found;
  }
  return true;
}

// Whether a rope with friction is one that is known: it slides over things, and over several that stand
// still.
template <int D>
bool rope_may_rub(const Fields& fields, double friction, const std::vector<Turn<D>>& turns, int over,
                  const sim::World<D>& world, Diagnostics& complaints) {
  if (const Node* rounds = fields.given("turns"); rounds && friction == 0) {
    complaints.add(rounds->place, "'turns' is for a rope with 'friction'; without it they change nothing");
    return false;
  }
  if (friction == 0) return true;
  const Place place = fields.place("friction");
  if (int(turns.size()) != over + 2) {
    complaints.add(place, "a rope that is wound on a wheel does not slide there: leave 'friction' out");
    return false;
  }
  if (world.model.solver == sim::Solver::iterative) {
    complaints.add(place, "the friction of a rope is for the direct solver; write solver = \"direct\"");
    return false;
  }
  const bool stands = std::all_of(turns.begin() + 1, turns.end() - 1, [&](const Turn<D>& turn) {
    if (turn.end.body < 0) return true;
    return world.model.bodies[std::size_t(turn.end.body)].fixed &&
           std::none_of(world.model.drives.begin(), world.model.drives.end(),
                        [&](const sim::Drive<D>& drive) { return drive.body == turn.end.body; });
  });
  if (over > 1 && !stands) {
    complaints.add(place, "a rope with friction runs over one thing that moves, or several that stand still");
    return false;
  }
  return true;
}

// its friction, and how it is wrapped around what it runs over
template <int D>
void rub(const Fields& fields, double friction, const std::vector<sim::Vec<D>>& at, sim::Joint<D>& it) {
  it.friction = friction;
  it.whole_turns = fields.given("turns") ? int(fields.number("turns")) : 0;
  it.wrap = 2 * std::numbers::pi * it.whole_turns * double(it.around.size());
  if constexpr (D == 2) {
    const auto piece = [&](std::size_t i) {
      const double from = i == 0 ? 0 : it.around[i - 1], to = i < it.around.size() ? it.around[i] : 0;
      return sim::rope_piece<D>(at[i], at[i + 1], from - to).direction;
    };
    it.wraps.assign(it.around.size(), 0);
    for (std::size_t i = 0; i < it.around.size(); ++i) {
      if (it.around[i] == 0) continue;
      const double wrap = sim::wrap_between(piece(i), piece(i + 1), it.around[i]);
      it.wrap += wrap, it.wraps[i] = 2 * std::numbers::pi * it.whole_turns + wrap;
    }
  }
}

}  // namespace

template <int D>
void pulley(const Fields& fields, const std::string& name, const Seating<D>& roster, sim::World<D>& world,
            Diagnostics& complaints) {
  refuse_other_keys(fields, complaints);
  const Node *between = fields.given("between"), *over = fields.given("over");
  if (!between || !over) {
    complaints.add(fields.place(), fmt::format("a pulley needs '{}', {}", between ? "over" : "between",
                                               between ? "what its rope runs over" : "its two ends"));
    return;
  }
  std::vector<Turn<D>> turns;
  const auto add = [&](const Node& node, bool may_be_wheel) {
    const auto end = one_end(node, roster, world, complaints);
    if (!end) return false;
    Turn<D> turn{*end};
    if (may_be_wheel && node.is_text()) {
      const sim::Body<D>& body = world.model.bodies[std::size_t(end->body)];
      const auto radius = sim::round_radius(body.shape);
      if (radius && !sim::is_point(body.shape) && body.turns()) {
        if (D == 3) {
          complaints.add(node.place,
                         fmt::format("a rope turns wheels in the plane alone; to let it slide over "
                                     "'{}' in space write {{ body = \"{}\", at = \"center\" }}",
                                     body.name, body.name));
          return false;
        }
        turn.radius = *radius;
      }
    }
    turns.push_back(turn);
    return true;
  };
  bool good = add(between->list()[0], false);
  for (const Node& each : over->list()) good = good && add(each, true);
  good = good && add(between->list()[1], false);
  if (!good) return;
  // an end that is the wheel beside it: the rope is wound on that
  const auto wound = [&](const Node& end, const Node& wheel, const Turn<D>& turn) {
    return turn.radius > 0 && end.is_text() && wheel.is_text() && end.text() == wheel.text();
  };
  const std::size_t wheels = over->list().size();
  std::array<bool, 2> wound_on{};
  if (wheels > 0 && turns.size() > 2 && wound(between->list()[1], over->list()[wheels - 1], turns[wheels]))
    turns.pop_back(), wound_on[1] = true;
  if (wheels > 0 && turns.size() > 2 && wound(between->list()[0], over->list()[0], turns[1]))
    turns.erase(turns.begin()), wound_on[0] = true;
  std::array<const Side*, 2> sides;
  if (!given_sides(fields, wound_on, sides, complaints)) return;
  // the first end moves, if one does
  const bool turned_round = turns.front().end.body < 0 && turns.back().end.body >= 0;
  if (turned_round) std::reverse(turns.begin(), turns.end()), std::swap(sides[0], sides[1]);
  if (std::all_of(turns.begin(), turns.end(), [&](const Turn<D>& turn) {
        return turn.end.body < 0 || world.model.bodies[std::size_t(turn.end.body)].fixed;
      })) {
    complaints.add(between->place, "nothing that this rope holds could move");
    return;
  }

  const int n = int(turns.size());
  const double friction = fields.number("friction");
  if (!rope_may_rub(fields, friction, turns, int(over->list().size()), world, complaints)) return;
  std::vector<sim::Vec<D>> at;
  for (const Turn<D>& turn : turns) at.push_back(start(world, turn.end));
  std::vector<double> offsets(std::size_t(n), 0.0);
  if constexpr (D == 2) {
    // a rope that is wound on a side that is named comes from there
    std::vector<sim::Vec<D>> by = at;
    for (const auto& [wheel, side] : {std::pair(0, sides[0]), std::pair(n - 1, sides[1])})
      if (side) by[std::size_t(wheel)] += turns[std::size_t(wheel)].radius * sim::Vec<D>(side->x, side->y);
    for (int i = 1; i + 1 < n; ++i)
      if (turns[std::size_t(i)].radius > 0)
        offsets[std::size_t(i)] =
            turns[std::size_t(i)].radius *
            side_of_turn(by[std::size_t(i - 1)], by[std::size_t(i)], by[std::size_t(i + 1)]);
    for (const auto& [wheel, next, sign] : {std::tuple(0, 1, -1), std::tuple(n - 1, n - 2, 1)}) {
      const double radius = turns[std::size_t(wheel)].radius;
      if (!(radius > 0)) continue;
      const double side =
          sign * side_of_winding(at[std::size_t(next)], at[std::size_t(wheel)], sides[wheel == 0 ? 0 : 1]);
      if (side == 0) {
        complaints.add(over->place,
                       fmt::format("on which side does the rope leave '{}', on which it is wound? Say it "
                                   "with 'wound', as in wound = [\"left\", \"auto\"]",
                                   world.model.bodies[std::size_t(turns[std::size_t(wheel)].end.body)].name));
        return;
      }
      offsets[std::size_t(wheel)] = radius * side;
    }
  }
  // with friction it slides over wheels, too
  const auto is_wheel = [&](int i) { return friction == 0 && turns[std::size_t(i)].radius > 0; };
  const bool one_piece =
      std::none_of(turns.begin(), turns.end(), [](const Turn<D>& t) { return t.radius > 0; });
  int rope = 0;
  for (const sim::Joint<D>& joint : world.model.joints) rope = std::max(rope, joint.rope + 1);

  if (const Node* breaks = fields.given("breaks_torque"))
    complaints.add(breaks->place, "a pulley's rope bears no torque; 'breaks' is the force that breaks it");
  std::vector<sim::Joint<D>> pieces;
  for (int first = 0; first + 1 < n;) {
    int last = first + 1;
    while (last + 1 < n && !is_wheel(last)) ++last;
    sim::Joint<D> it;
    it.kind = JointKind::pulley, it.rope = rope;
    it.a = turns[std::size_t(first)].end, it.b = turns[std::size_t(last)].end;
    it.breaks = given_breaks<D>(fields);
    for (int i = first + 1; i < last; ++i) it.over.push_back(turns[std::size_t(i)].end);
    it.on_a.offset = is_wheel(first) ? offsets[std::size_t(first)] : 0;
    it.on_b.offset = is_wheel(last) ? offsets[std::size_t(last)] : 0;
    it.length = 0, it.later = !fields.flag("joined");
    if (friction > 0) it.around.assign(offsets.begin() + first + 1, offsets.begin() + last);
    const auto offset = [&](int i) {
      return i == first     ? it.on_a.offset
             : i == last    ? it.on_b.offset
             : friction > 0 ? offsets[std::size_t(i)]
                            : 0;
    };
    for (int i = first; i < last; ++i) {
      const double from = offset(i), to = offset(i + 1);
      const sim::RopePiece<D> piece =
          sim::rope_piece<D>(at[std::size_t(i)], at[std::size_t(i + 1)], from - to);
      if (!(piece.length > 0)) {
        const auto word = [&](int k) {
          const int body = turns[std::size_t(k)].end.body;
          return body < 0 ? std::string("a place of the room")
                          : "'" + world.model.bodies[std::size_t(body)].name + "'";
        };
        complaints.add(over->place, fmt::format("the rope cannot go straight from {} to {}: they are at one "
                                                "place, or one is inside the other's wheel",
                                                word(i), word(i + 1)));
        return;
      }
      it.length += piece.length;
      if (i == first) it.on_a.start = piece.direction;
      if (i + 1 == last) it.on_b.start = piece.direction;
    }
    if (friction > 0) rub(fields, friction, at, it);
    if constexpr (D == 2) {
      if (it.on_a.offset != 0) it.turns.emplace_back(it.a.body, it.on_a.offset);
      if (it.on_b.offset != 0) it.turns.emplace_back(it.b.body, -it.on_b.offset);
      for (const auto& [body, factor] : it.turns) it.turn += factor * turn_of(world, body);
    }
    pieces.push_back(std::move(it));
    first = last;
  }
  if (const Node* length = fields.given("length")) {
    if (!one_piece) {
      complaints.add(length->place, "a rope on wheels is as long as it is at the start; move an end");
      return;
    }
    if (!pieces[0].later && length->number() < pieces[0].length * (1 - kWhole)) {
      complaints.add(length->place,
                     fmt::format("'length' is {} m and the rope is {:.6g} m long at the start; move "
                                 "an end",
                                 length->number(), pieces[0].length));
      return;
    }
    pieces[0].length = length->number();
  } else if (one_piece && pieces[0].later) {
    pieces[0].length = 0;  // as long as it is then
  }
  // as they follow each other, from an end that moves; numbered from the first end as typed
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const std::size_t number = turned_round ? pieces.size() - 1 - k : k;
    pieces[k].name = pieces.size() == 1 ? name : fmt::format("{}[{}]", name, number);
    world.model.joints.push_back(std::move(pieces[k]));
    world.state.broken.push_back(world.model.joints.back().later);
  }
}

template <int D>
void gear(const Node& top, const Fields& fields, const std::string& name, sim::World<D>& world,
          Diagnostics& complaints) {
  refuse_other_keys(fields, complaints);
  const Node *joints = fields.given("joints"), *ratio = fields.given("ratio");
  if (const Node* between = fields.given("between")) {
    complaints.add(between->place,
                   "a gear holds two joints: give their names as 'joints', and leave out 'between'");
    return;
  }
  if (!joints || !ratio) {
    complaints.add(fields.place(), fmt::format("a gear needs '{}', {}", joints ? "ratio" : "joints",
                                               joints ? "such as -3" : "the names of two joints"));
    return;
  }
  std::array<sim::Joint<D>, 2> both;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string& wanted = joints->list()[k].text();
    const auto found = std::ranges::find(world.model.joints, wanted, &sim::Joint<D>::name);
    const auto cannot_take = [&] {
      complaints.add(
          joints->list()[k].place,
          fmt::format("'{}' has no angle and no way that a gear could take: expected a {} or a slider",
                      wanted, D == 2 ? "pin" : "hinge"));
    };
    if (found == world.model.joints.end()) {
      const Node* tables = top.find("joint");
      const auto is = [](const Node& it, std::string_view key, std::string_view text) {
        const Node* its = it.find(key);
        return its && its->is_text() && its->text() == text;
      };
      const auto called = [&](const Node& it) { return is(it, "name", wanted); };
      const auto gear = [&](const Node& it) { return called(it) && is(it, "type", "gear"); };
      if (tables && std::ranges::any_of(tables->list(), gear)) return cannot_take();
      // what is wrong there is told
      if (tables && std::ranges::any_of(tables->list(), called)) return;
      std::vector<std::string_view> known;
      for (const sim::Joint<D>& joint : world.model.joints) known.push_back(joint.name);
      complaints.add(joints->list()[k].place,
                     fmt::format("no joint is called '{}'{}", wanted, did_you_mean(wanted, known)));
      return;
    }
    if (!sim::has_free_row(*found)) return cannot_take();
    if (found->later) {
      complaints.add(joints->list()[k].place,
                     fmt::format("'{}' is not joined at the start, and a gear needs its joints", wanted));
      return;
    }
    both[k] = *found;
  }
  if (joints->list()[0].text() == joints->list()[1].text()) {
    complaints.add(joints->place, "a gear needs two joints, and these are one");
    return;
  }
  if (ratio->number() == 0) {
    complaints.add(ratio->place, "'ratio' is zero: the first joint could not move");
    return;
  }

  sim::Joint<D> it;
  it.name = name, it.kind = JointKind::gear, it.ratio = ratio->number();
  it.breaks = given_breaks<D>(fields), it.touching = fields.flag("touching");
  it.later = !fields.flag("joined");
  if (const Node* breaks = fields.given("breaks_torque")) it.breaks_torque = breaks->number();
  it.a = both[0].a, it.b = both[0].b, it.over = {both[1].a, both[1].b};
  it.geared = std::make_shared<const std::array<sim::Joint<D>, 2>>(both);
  const double n = it.ratio;
  const bool slides[] = {both[0].kind == JointKind::slider, both[1].kind == JointKind::slider};
  if constexpr (D == 2) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double factor = k == 0 ? 1 : -n;
      if (slides[k]) continue;
      if (both[k].a.body >= 0) it.turns.emplace_back(both[k].a.body, factor);
      if (both[k].b.body >= 0) it.turns.emplace_back(both[k].b.body, -factor);
      it.turn += factor * both[k].turn;
    }
    if (it.turns.empty()) it.turn = both[0].turn;
  } else {
    it.lower = 0;
    const double round = 2 * std::numbers::pi;
    if (slides[0] && slides[1]) it.length = -1;
    if (slides[0] && !slides[1]) it.length = std::fabs(n) * round;
    if (!slides[0] && slides[1]) it.length = round;
    for (int q = 1; !slides[0] && !slides[1] && q <= kMostRounds && it.length == 0; ++q)
      if (std::fabs(n * q - std::round(n * q)) < kWhole * q) it.length = round / q;
  }

  // pitch circles, and where their teeth meet at the start
  const sim::Vec<D> p = start(world, both[0].a), q = start(world, both[1].a);
  const double far = (q - p).norm();
  const bool pins = !slides[0] && !slides[1];
  const auto seen = [&](int body, const sim::Vec<D>& direction) -> sim::Vec<D> {
    if (body < 0) return direction;
    return sim::rotation<D>(turn_of(world, body)).transpose() * direction;
  };
  // two wheels apart whose radii have the ratio: no teeth, but a belt around both
  const auto wheel = [&](int body) {
    return D == 2 && body >= 0 ? sim::round_radius(world.model.bodies[std::size_t(body)].shape).value_or(0)
                               : 0;
  };
  const double r1 = wheel(both[0].a.body), r2 = wheel(both[1].a.body);
  it.belt = pins && n > 0 && r1 > 0 && std::fabs(n * r1 - r2) <= kBelt * r2 && far > r1 + r2;
  if (it.belt) {
    it.on_a.offset = r1, it.on_b.offset = r2;
    if (const Node* breaks = fields.given("breaks"))
      complaints.add(breaks->place, "this gear is a belt, which turns wheels; 'breaks_torque' breaks it");
  } else if (pins && far > 0 && n != 1) {
    it.on_a.offset = n < 0 ? far / (1 - n) : far / std::fabs(n - 1);
    it.on_b.offset = std::fabs(n) * it.on_a.offset;
    const sim::Vec<D> e = (n > 1 ? p - q : q - p) / far;
    it.on_a.start = seen(both[0].a.body, e);
    it.on_b.start = seen(both[1].a.body, n < 0 ? sim::Vec<D>(-e) : e);
  } else if (pins) {
    if (const Node* breaks = fields.given("breaks"))
      complaints.add(
          breaks->place,
          fmt::format("both joints turn about one place{}, so it has no teeth whose force could break "
                      "it; 'breaks_torque' is the torque that does",
                      n == 1 && far > 0 ? ", as one wheel does" : ""));
  } else if (!(slides[0] && slides[1])) {
    // of a rack the way from its teeth to itself: a pinion that turns to the left moves it to the left of
    // that
    (slides[0] ? it.on_b : it.on_a).offset = slides[0] ? std::fabs(n) : 1 / std::fabs(n);
    if constexpr (D == 2) {
      const sim::Joint<D>& slider = both[slides[0] ? 0 : 1];
      const sim::Vec<D> along =
          (n < 0 ? -1 : 1) * (slider.b.body < 0
                                  ? slider.axis
                                  : sim::Vec<D>(turned<D>(slider.axis, turn_of(world, slider.b.body))));
      (slides[0] ? it.on_a : it.on_b).start = seen(slider.a.body, sim::Vec<D>(along[1], -along[0]));
    }
  }
  world.model.joints.push_back(std::move(it));
  world.state.broken.push_back(world.model.joints.back().later);
}

template void pulley<2>(const Fields&, const std::string&, const Seating<2>&, sim::World<2>&, Diagnostics&);
template void pulley<3>(const Fields&, const std::string&, const Seating<3>&, sim::World<3>&, Diagnostics&);
template void gear<2>(const Node&, const Fields&, const std::string&, sim::World<2>&, Diagnostics&);
template void gear<3>(const Node&, const Fields&, const std::string&, sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
