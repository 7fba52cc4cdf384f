// The curve of a track: through places, with arcs, splines and rounded corners, or by formulas of s.

#include "scene/track_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

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

}  // namespace

template <int D>
std::optional<TypedCurve<D>> track_curve(const Fields& fields, Constants& constants,
                                         Diagnostics& complaints) {
  TrackCurve<D> curve(fields, constants, complaints);
  auto pieces = curve.make();
  if (!pieces) return {};
  return TypedCurve<D>{std::move(*pieces), curve.closed()};
}

template std::optional<TypedCurve<2>> track_curve<2>(const Fields&, Constants&, Diagnostics&);
template std::optional<TypedCurve<3>> track_curve<3>(const Fields&, Constants&, Diagnostics&);

}  // namespace obscura::scene
