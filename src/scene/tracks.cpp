#include "scene/tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "scene/fields.h"
#include "scene/friction.h"
#include "sim/collide/may_touch.h"
#include "sim/collide/rails.h"
#include "sim/constraint/joints/wire.h"
#include "sim/constraint/material.h"
#include "sim/model/body_motion.h"
#include "sim/shape/curve.h"

namespace obscura::scene {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
// At a joint of the track no more than a millionth of the velocity may go: 1 - cos(0.001) is half of that.
constexpr double kStraightOn = 1e-3;  // rad
constexpr std::size_t kMostPlaces = 2000;

// one item of `points`: a place, an arc, or a spline
template <int D>
struct Stop {
  enum class Kind { place, arc, onward, spline } kind = Kind::place;
  std::vector<sim::Vec<D>> places;  // where it ends last; of an arc `through` before it
  Place at;
};

template <int D>
Stop<D> stop(const Node& node) {
  Stop<D> it;
  it.at = node.place;
  if (node.is_list()) {
    it.places = {vector<D>(node)};
    return it;
  }
  if (const Node* spline = node.find("spline")) {
    it.kind = Stop<D>::Kind::spline;
    for (const Node& each : spline->list()) it.places.push_back(vector<D>(each));
    return it;
  }
  it.kind = Stop<D>::Kind::onward;
  if (const Node* through = node.find("through"))
    it.kind = Stop<D>::Kind::arc, it.places.push_back(vector<D>(*through));
  it.places.push_back(vector<D>(*node.find("to")));
  return it;
}

// the curve of a track in the frame that was typed
template <int D>
class TrackCurve {
 public:
  using Pieces = std::vector<typename sim::Curve<D>::Piece>;
  using Vec = sim::Vec<D>;

  TrackCurve(const Fields& fields, Constants& constants, Diagnostics& complaints)
      : fields_(fields), constants_(constants), complaints_(complaints) {}

  /// None, and a complaint, where it makes no curve.
  std::optional<Pieces> make() {
    const Node* points = fields_.given("points");
    bool formula = false;
    for (int axis = 0; axis < D; ++axis) formula = formula || fields_.given(kAxes[axis]);
    if (points && formula) {
      refuse(points->place, "'points' and formulas both say where the track is; leave one out");
      return {};
    }
    if (!points && !formula) {
      if (!complaints_.none()) return {};  // what was wrong is gone
      refuse(fields_.place(), D == 2 ? "a track needs 'points', or 'x' and 'y' as expressions of s"
                                     : "a track needs 'points', or 'x', 'y' and 'z' as expressions of s");
      return {};
    }
    if (formula) return of_formulas();
    for (const char* key : {"from", "to"})
      if (fields_.given(key)) refuse(fields_.place(key), fmt::format("'{}' is for a track of formulas", key));
    return of_points(*points);
  }

  bool closed() const { return closed_; }

 private:
  void refuse(Place place, std::string message) { complaints_.add(place, std::move(message)); }

  // --- formulas

  std::optional<double> bound(const char* key) {
    const Node* node = fields_.given(key);
    if (!node) {
      refuse(fields_.place(),
             fmt::format("a track of formulas needs '{}', {} of s", key,
                         std::string_view(key) == "from" ? "the first value" : "the last value"));
      return {};
    }
    const std::string text = typed(*node);
    constants_.read_by(text);
    sim::ExpressionGraph graph;
    std::vector<sim::Symbol> symbols{{"s", -1, "runs from 'from' to 'to'"}};
    std::vector<std::string> names;
    for (const auto& [name, value] : constants_.numbers())
      symbols.push_back({name, graph.number(value)}), names.push_back(name);
    const auto found = sim::parse_expression(text, symbols, graph);
    if (const auto* fault = std::get_if<sim::ExpressionFault>(&found)) {
      for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
      for (const std::string_view name : sim::expression_numbers()) names.emplace_back(name);
      complain(*node, key, *fault, names, complaints_);
      return {};
    }
    const double value = graph[std::get<int>(found)].value;
    if (std::isfinite(value)) return value;
    refuse(node->place, fmt::format("'{}' is no finite number", key));
    return {};
  }

  std::optional<Pieces> of_formulas() {
    if (const Node* round = fields_.given("round")) {
      refuse(round->place, "'round' is for corners of 'points'");
      return {};
    }
    std::vector<std::string> texts;
    for (int axis = 0; axis < D; ++axis) {
      const Node* way = fields_.given(kAxes[axis]);
      if (!way) {
        refuse(fields_.place(),
               fmt::format("a track of formulas needs '{}' too, an expression of s", kAxes[axis]));
        return {};
      }
      texts.push_back(typed(*way));
      constants_.read_by(texts.back());
    }
    const auto from = bound("from"), to = bound("to");
    if (!from || !to) return {};
    if (!(*from < *to)) {
      refuse(fields_.place("to"), fmt::format("'to' must be more than 'from', got {} and {}", *to, *from));
      return {};
    }
    const auto made = sim::curve_formula<D>(texts, constants_.numbers());
    if (const auto* fault = std::get_if<std::pair<int, sim::ExpressionFault>>(&made)) {
      std::vector<std::string> names{"s"};
      for (const auto& [name, value] : constants_.numbers()) names.push_back(name);
      for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
      for (const std::string_view name : sim::expression_numbers()) names.emplace_back(name);
      complain(*fields_.given(kAxes[fault->first]), kAxes[fault->first], fault->second, names, complaints_);
      return {};
    }
    auto pieces = sim::curve_pieces<D>(std::get<sim::Program>(made), *from, *to);
    if (const auto* wrong = std::get_if<std::string>(&pieces)) {
      refuse(fields_.place(kAxes[0]), *wrong);
      return {};
    }
    Pieces all = std::move(std::get<Pieces>(pieces));
    // closed where both ends are at one place, and go on in each other
    const sim::Curve<D> curve(all, false);
    const auto first = curve.at(0, 0), last = curve.at(curve.size() - 1, 1);
    closed_ = (first.x - last.x).norm() <= 1e-9 * curve.length() &&
              (first.tangent - last.tangent).norm() <= 1e-6 &&
              (first.curvature - last.curvature).norm() * curve.length() <= 1e-3;
    return all;
  }

  // --- points

  std::optional<Pieces> of_points(const Node& points) {
    std::vector<Stop<D>> stops;
    std::size_t places = 0;
    for (const Node& each : points.list())
      stops.push_back(stop<D>(each)), places += stops.back().places.size();
    if (places > kMostPlaces) {
      refuse(points.place,
             fmt::format("{} places are more than {}, the most a track may have", places, kMostPlaces));
      return {};
    }
    if (stops[0].kind != Stop<D>::Kind::place) {
      refuse(stops[0].at, "the first of 'points' is where the track begins, a place");
      return {};
    }
    const Vec start = stops[0].places[0];
    Vec before = start;
    for (std::size_t i = 1; i < stops.size(); ++i) {
      for (const Vec& next : stops[i].places) {
        if (next == before) {
          refuse(stops[i].at, "a place of the track is there twice, one after the other");
          return {};
        }
        before = next;
      }
    }
    if (const Node* round = fields_.given("round"); round && !rounded(stops, round->number())) return {};

    // a spline alone that comes back to its beginning has no ends
    if (stops.size() == 2 && stops[1].kind == Stop<D>::Kind::spline && stops[1].places.back() == start &&
        stops[1].places.size() > 2) {
      sim::CurvePath<D> path(start);
      path.loop({stops[1].places.begin(), stops[1].places.end() - 1});
      closed_ = true;
      return path.pieces();
    }
    sim::CurvePath<D> path(start);
    for (std::size_t i = 1; i < stops.size(); ++i)
      if (!add(path, stops, i)) return {};
    if (const auto kink = path.closing_kink()) {
      if (*kink > kStraightOn) {
        refuse(stops.back().at,
               fmt::format("the track comes back to its beginning with a turn of {:.3g} degrees; "
                           "let it go on as it began, or end it elsewhere",
                           degrees(*kink)));
        return {};
      }
      closed_ = true;
    }
    return path.pieces();
  }

  // the direction in which a stop leaves the place before it, where that tells it
  std::optional<Vec> leaves(const std::vector<Stop<D>>& stops, std::size_t i) const {
    if (i >= stops.size()) return {};
    const Vec from = stops[i - 1].places.back();
    if (stops[i].kind == Stop<D>::Kind::place) return Vec((stops[i].places[0] - from).normalized());
    if (stops[i].kind == Stop<D>::Kind::arc) {
      const auto bent = sim::arc_direction<D>(from, stops[i].places[0], stops[i].places[1]);
      return bent ? bent : Vec((stops[i].places[1] - from).normalized());
    }
    return {};
  }

  bool add(sim::CurvePath<D>& path, const std::vector<Stop<D>>& stops, std::size_t i) {
    const Stop<D>& it = stops[i];
    switch (it.kind) {
      case Stop<D>::Kind::place:
        path.line(it.places[0]);
        break;
      case Stop<D>::Kind::arc:
        // three places in a line are a straight piece
        if (!path.arc(it.places[0], it.places[1])) {
          if (!((it.places[0] - path.place()).dot(it.places[1] - it.places[0]) > 0)) {
            refuse(it.at, "these places of an arc lie in a line, and the second not between the others");
            return false;
          }
          path.line(it.places[1]);
        }
        break;
      case Stop<D>::Kind::onward:
        if (!path.direction()) {
          refuse(it.at, "an arc that begins the track needs 'through', a place on it");
          return false;
        }
        if (!path.arc(it.places[0])) {
          refuse(it.at, "this place lies straight ahead, where no arc leads; write it without 'to'");
          return false;
        }
        break;
      case Stop<D>::Kind::spline:
        path.spline(it.places, leaves(stops, i + 1));
        break;
    }
    if (path.kink() <= kStraightOn) return true;
    refuse(it.at,
           fmt::format("the track turns by {:.3g} degrees at {}: it must be smooth. Write round = 0.2 "
                       "to round corners of straight pieces, or {{ to = {} }}, an arc that goes on as "
                       "the piece before",
                       degrees(path.kink()), shown(stops[i - 1].places.back()), shown(it.places.back())));
    return false;
  }

  static std::string shown(const Vec& x) {
    std::string text = "[";
    for (int axis = 0; axis < D; ++axis) text += fmt::format("{}{:.6g}", axis > 0 ? ", " : "", x[axis] + 0.0);
    return text + "]";
  }

  // replaces corners of straight pieces by arcs of a radius
  bool rounded(std::vector<Stop<D>>& stops, double radius) {
    std::vector<Stop<D>> all;
    const bool ring = stops.back().kind == Stop<D>::Kind::place &&
                      stops.back().places[0] == stops[0].places[0] &&
                      std::all_of(stops.begin(), stops.end(),
                                  [](const Stop<D>& it) { return it.kind == Stop<D>::Kind::place; });
    const std::size_t n = stops.size();
    std::vector<double> cut(n, 0.0);
    const auto corner = [&](std::size_t i, const Vec& before, const Vec& at, const Vec& after) {
      const Vec u = (at - before).normalized(), v = (after - at).normalized();
      // the tangent of half the turn
      const double off = (v - u).norm(), on = (v + u).norm();
      cut[i] = off > 1e-9 ? radius * off / on : 0;
    };
    const auto straight = [&](std::size_t i) {
      return i > 0 && i < n && stops[i].kind == Stop<D>::Kind::place;
    };
    for (std::size_t i = 1; i + 1 < n; ++i)
      if (straight(i) && straight(i + 1))
        corner(i, stops[i - 1].places.back(), stops[i].places[0], stops[i + 1].places[0]);
    if (ring && n > 3) {
      corner(0, stops[n - 2].places[0], stops[0].places[0], stops[1].places[0]);
      cut[n - 1] = cut[0];
    }
    for (std::size_t i = 1; i < n; ++i) {
      if (!straight(i)) continue;
      const double length = (stops[i].places[0] - stops[i - 1].places.back()).norm();
      if (cut[i - 1] + cut[i] <= length * (1 + 1e-12)) continue;
      refuse(fields_.place("round"),
             fmt::format("arcs of {} m are too wide for the piece from {} to {}", radius,
                         shown(stops[i - 1].places.back()), shown(stops[i].places[0])));
      return false;
    }
    const auto place = [](const Vec& x, Place at) {
      Stop<D> it;
      it.places = {x}, it.at = at;
      return it;
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (cut[i] == 0) {
        all.push_back(stops[i]);
        continue;
      }
      const Vec before = i == 0 ? stops[n - 2].places[0] : stops[i - 1].places.back(),
                at = stops[i].places[0], after = i + 1 == n ? stops[1].places[0] : stops[i + 1].places[0];
      const Vec u = (at - before).normalized(), v = (after - at).normalized();
      const Vec in = at - cut[i] * u, out = at + cut[i] * v;
      if (ring && i == 0) {
        all.push_back(place(out, stops[i].at));
        continue;
      }
      // nothing is left of a piece that both of its corners take
      if (all.empty() || (all.back().places.back() - in).norm() > 1e-9 * cut[i])
        all.push_back(place(in, stops[i].at));
      Stop<D> arc;
      arc.kind = Stop<D>::Kind::arc, arc.at = stops[i].at;
      const Vec inwards = (v - u).normalized();
      const double far = std::sqrt(cut[i] * cut[i] + radius * radius) - radius;
      arc.places = {Vec(at + far * inwards), out};
      all.push_back(arc);
    }
    stops = std::move(all);
    if (ring) stops.back().places.back() = stops[0].places[0];
    return true;
  }

  const Fields& fields_;
  Constants& constants_;
  Diagnostics& complaints_;
  bool closed_ = false;
};

// a curve turned and shifted into the frame of a body
template <int D>
void move(typename sim::Curve<D>::Piece& piece, const sim::Rotation<D>& turn, const sim::Vec<D>& shift) {
  for (int k = 0; k < 6; ++k) piece.c[k] = turn * piece.c[k];
  piece.c[0] += shift;
}

// the bodies that one reference, or a list of them, names
template <int D>
std::vector<int> references(const Node& node, const Seating<D>& roster, Diagnostics& complaints) {
  std::vector<int> all;
  const auto add = [&](const Node& one) {
    const std::vector<int> found = roster.bodies(one.text(), one.place, complaints);
    all.insert(all.end(), found.begin(), found.end());
  };
  if (node.is_text())
    add(node);
  else
    for (const Node& one : node.list()) add(one);
  return all;
}

// tracks of one scene on their way into its world
template <int D>
class TrackBuilder {
 public:
  TrackBuilder(const Node& top, Constants& constants, Seating<D>& roster, sim::World<D>& world,
               draw::Look& look, Diagnostics& complaints)
      : top_(top),
        constants_(constants),
        roster_(roster),
        world_(world),
        look_(look),
        complaints_(complaints) {}

  void build() {
    const Node* all = top_.find("track");
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Fields fields(all->list()[k], "track");
      track(fields, fields.given("name") ? fields.text("name") : fmt::format("track[{}]", k));
    }
  }

 private:
  using Vec = sim::Vec<D>;

  void track(const Fields& fields, const std::string& name) {
    TrackCurve<D> typed(fields, constants_, complaints_);
    auto pieces = typed.make();
    if (!pieces) return;
    if (pieces->size() > std::size_t(sim::RailFeature::kPieces)) {
      complaints_.add(fields.place(), "the track bends too often to follow; make it several tracks");
      return;
    }
    const Node *on = fields.given("on"), *thread = fields.given("thread"), *side = fields.given("side");
    if (D == 3 && side) {
      complaints_.add(side->place, "in space a track is touched from all sides; leave 'side' out");
      return;
    }
    int body = -1;
    if (on) {
      const std::vector<int> found = roster_.bodies(on->text(), on->place, complaints_);
      if (found.size() != 1) return;
      body = found[0];
      if (fields.given("group")) {
        complaints_.add(fields.place("group"),
                        fmt::format("a track on '{0}' is of the group of '{0}'", on->text()));
        return;
      }
      // from the frame that was typed to the body's
      const Seat<D>& seat = roster_.seats[std::size_t(body)];
      const sim::Rotation<D> turn = sim::rotation<D>(sim::inverse<D>(seat.axes));
      for (auto& piece : *pieces) move<D>(piece, turn, Vec(-(turn * seat.center)));
    }
    const bool touched = side || !thread;
    if (!touched && fields.given("elasticity")) {
      complaints_.add(fields.place("elasticity"),
                      "what is threaded does not bounce; give the track a 'side' too");
      return;
    }
    if (!thread && fields.given("ends")) {
      complaints_.add(fields.place("ends"),
                      "'ends' is for beads, 'thread'; what rolls on a track leaves it there");
      return;
    }
    if (!touched) {
      const auto curve = std::make_shared<const sim::Curve<D>>(std::move(*pieces), typed.closed());
      wires(fields, name, *thread, body, curve);
      return;
    }
    if (world_.model.rails.size() >= std::size_t(sim::RailFeature::kRails)) {
      complaints_.add(fields.place(), fmt::format("more than {} tracks that are touched are too many",
                                                  sim::RailFeature::kRails));
      return;
    }
    if (body < 0) body = own_body(fields, name, *pieces);
    sim::Rail<D> rail;
    rail.name = name, rail.body = body;
    rail.curve = std::make_shared<const sim::Curve<D>>(std::move(*pieces), typed.closed());
    const std::string word = side ? side->text() : "left";
    rail.left = word != "right", rail.right = word != "left";
    if (const Node* mu = fields.given("friction")) rail.friction = mu->number();
    rail.static_friction = static_friction(fields, rail.friction, complaints_);
    if (const Node* e = fields.given("elasticity")) rail.elasticity = e->number();
    world_.model.rails.push_back(rail);
    paint(fields, name);
    if (thread) wires(fields, name, *thread, body, rail.curve);
  }

  void paint(const Fields& fields, const std::string& name) {
    if (const Node* color = fields.given("color"))
      if (const auto known = draw::color(color->text())) look_.tracks.emplace_back(name, *known);
  }

  // a body for a track that is part of none, in the middle of it
  int own_body(const Fields& fields, const std::string& name,
               std::vector<typename sim::Curve<D>::Piece>& pieces) {
    const sim::Curve<D> curve(pieces, false);
    Vec low = curve.at(0, 0).x, high = low;
    for (const Vec& x : curve.places(0.01 * curve.length())) low = low.cwiseMin(x), high = high.cwiseMax(x);
    const Vec middle = (low + high) / 2;
    for (auto& piece : pieces) move<D>(piece, sim::Rotation<D>::Identity(), Vec(-middle));
    sim::Body<D> body;
    body.name = name;
    body.shape = sim::Point<D>{};
    // it counts among those that turn, which come last
    body.mass = 0, body.inertia.setOnes();
    body.fixed = body.bare = true;
    if (fields.given("group")) {
      auto& families = roster_.families;
      body.group = families.emplace(fields.text("group"), int(families.size()) + 1).first->second;
    }
    if (const Node* mu = fields.given("friction")) body.friction = mu->number();
    if (const Node* e = fields.given("elasticity")) body.elasticity = e->number();
    sim::State<D>& state = world_.state;
    state.x.push_back(middle), state.v.push_back(Vec::Zero());
    state.turn.push_back(sim::no_rotation<D>()), state.spin.push_back(sim::AngularVec<D>::Zero());
    world_.model.bodies.push_back(std::move(body));
    roster_.seats.emplace_back();
    Group group;
    group.name = name, group.place = fields.place("name"), group.at = fields.place("points");
    group.first = int(world_.model.bodies.size()) - 1;
    if (const auto before = roster_.index.find(name); before != roster_.index.end())
      complaints_.add(group.place,
                      fmt::format("the name '{}' is taken by another body at {}", name,
                                  complaints_.text(roster_.groups[std::size_t(before->second)].place)));
    roster_.index.emplace(name, int(roster_.groups.size()));
    roster_.groups.push_back(std::move(group));
    look_.bodies.emplace_back();
    return int(world_.model.bodies.size()) - 1;
  }

  // the beads, each at the place of the wire that is nearest to it
  void wires(const Fields& fields, const std::string& name, const Node& thread, int on,
             const std::shared_ptr<const sim::Curve<D>>& curve) {
    const std::vector<int> beads = references<D>(thread, roster_, complaints_);
    sim::State<D>& state = world_.state;
    for (std::size_t i = 0; i < beads.size(); ++i) {
      const int bead = beads[i];
      const sim::Body<D>& body = world_.model.bodies[std::size_t(bead)];
      const auto refuse = [&](const std::string& why) {
        complaints_.add(thread.place, fmt::format("'{}' {}", body.name, why));
      };
      if (bead == on) return refuse("cannot run on a track that is part of it");
      if (body.fixed) return refuse("is fixed or moved, and does not run on a track");
      if (body.handout) return refuse("keeps the handout's law, which has no tracks");
      for (const sim::Joint<D>& other : world_.model.joints)
        if (other.kind == sim::JointKind::wire && other.a.body == bead)
          return refuse(fmt::format("runs on '{}' already", other.name));
      sim::Joint<D> joint;
      joint.name = beads.size() == 1 ? name : fmt::format("{}[{}]", name, i);
      if (i == 0) paint(fields, joint.name);
      joint.kind = sim::JointKind::wire;
      joint.a.body = bead, joint.b.body = on;
      joint.curve = curve;
      joint.friction =
          fields.given("friction") ? sim::mixed(body.friction, fields.number("friction")) : body.friction;
      joint.lets_go = fields.text("ends") == "free";
      if (!curve->closed() && !joint.lets_go) joint.lower = 0, joint.upper = curve->length();
      const sim::BodyMotion<D> carrier = on < 0 ? sim::BodyMotion<D>{} : sim::body_motion(state, on);
      Vec& x = state.x[std::size_t(bead)];
      const auto foot = curve->nearest(carrier.room_from_body.transpose() * (x - carrier.x));
      x = carrier.x + carrier.arm(foot.at.x);
      Vec& v = state.v[std::size_t(bead)];
      const Vec along = carrier.arm(foot.at.tangent), matter = carrier.velocity(carrier.arm(foot.at.x));
      v = matter + along * along.dot(v - matter);
      world_.model.joints.push_back(std::move(joint));
      state.broken.push_back(0);
      state.on_piece.resize(world_.model.joints.size());
      state.on_piece.back() = foot.piece + 1;
    }
  }

  const Node& top_;
  Constants& constants_;
  Seating<D>& roster_;
  sim::World<D>& world_;
  draw::Look& look_;
  Diagnostics& complaints_;
};

}  // namespace

template <int D>
void tracks(const Node& top, Constants& constants, Seating<D>& roster, sim::World<D>& world, draw::Look& look,
            Diagnostics& complaints) {
  TrackBuilder<D>(top, constants, roster, world, look, complaints).build();
}

template <int D>
void refuse_off_tracks(const Node& top, const sim::Model<D>& model, Diagnostics& complaints) {
  const Node* all = top.find("track");
  if (!all || all->list().empty()) return;
  const Place where = all->list().front().place;
  if (model.collision == sim::Collision::handout) return;  // refused as a kind
  if (!model.bonds.empty())
    complaints.add(where,
                   "a scene has [[bond]]s or tracks, not both yet; a [[joint]] of type \"weld\" with "
                   "'breaks' holds two bodies together");
  if (model.solver == sim::Solver::iterative)
    complaints.add(Fields::of(top, "physics").place("solver"),
                   "tracks are for the direct solver; leave 'solver' out, or write \"direct\"");
  const sim::MayTouch<D> may_touch(model);
  // a bead stays on its wire
  std::vector<char> threaded(model.bodies.size(), 0);
  for (const sim::Joint<D>& joint : model.joints)
    if (joint.curve && joint.a.body >= 0) threaded[std::size_t(joint.a.body)] = 1;
  for (const sim::Rail<D>& rail : model.rails) {
    for (int i = 0; i < int(model.bodies.size()); ++i) {
      const sim::Body<D>& body = model.bodies[std::size_t(i)];
      if (i == rail.body || body.fixed || body.bare || sim::touches_rails<D>(body.shape) ||
          !may_touch(i, rail.body) || (sim::is_point(body.shape) && threaded[std::size_t(i)]))
        continue;
      complaints.add(
          where,
          D == 2 ? fmt::format(
                       "'{}' has more corners than the {} with which bodies lie on tracks; let its group "
                       "ignore that of the track '{}': [contact] ignore",
                       body.name, sim::RailFeature::kVertices, rail.name)
          : sim::is_point(body.shape)
              ? fmt::format(
                    "'{}' is a point, which passes by the track '{}' in space; give it a 'radius', or "
                    "thread = [\"{}\"]",
                    body.name, rail.name, body.name)
              : fmt::format(
                    "'{}' might come upon the track '{}', and in space only balls and bodies made of balls "
                    "roll and slide on tracks; let its group ignore that of the track: [contact] ignore",
                    body.name, rail.name));
      return;
    }
  }
}

template void tracks<2>(const Node&, Constants&, Seating<2>&, sim::World<2>&, draw::Look&, Diagnostics&);
template void tracks<3>(const Node&, Constants&, Seating<3>&, sim::World<3>&, draw::Look&, Diagnostics&);
template void refuse_off_tracks<2>(const Node&, const sim::Model<2>&, Diagnostics&);
template void refuse_off_tracks<3>(const Node&, const sim::Model<3>&, Diagnostics&);

}  // namespace obscura::scene
