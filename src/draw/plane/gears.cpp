// Teeth of wheels and racks: trapezia, as high above the pitch line as they are deep. Where they are the edge
// of a body, its form is drawn as far as their feet, and they are filled as it is.

#include "draw/plane/gears.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "draw/picture/joint_look.h"
#include "draw/picture/rope_way.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kFewestTeeth = 12;      // of the smaller wheel of a gear
constexpr double kToothHeight = 0.2;  // of the distance of two teeth: half of a tooth
constexpr double kToothFoot = 0.32,
                 kToothCrest = 0.15;  // of that distance: half a tooth's width below and above
constexpr double kLeastTooth = 1.5;   // page units: half the height of one that is filled
constexpr double kNear = 0.5;         // of half a tooth's height: so near an edge is the pitch line

/// A tooth, or many in a row, on their way along the page: filled, and their outline.
class Row {
 public:
  Row(Color fill, Color line, double width) : fill_(fill), line_(line), width_(width) {}

  /// A tooth's two feet and the crest between them; `deeper`: places in the body that the filling overlaps.
  void add(const Point& foot, const Point& crest, const Point& crest_end, const Point& foot_end,
           const Point& deeper, const Point& deeper_end) {
    for (const Point& p : {foot, crest, crest_end, foot_end}) nodes_.push_back({p, width_, line_});
    teeth_.push_back({deeper, foot, crest, crest_end, foot_end, deeper_end});
  }
  void draw(bool filled, bool around, List& list) {
    if (nodes_.empty()) return;
    for (std::size_t i = 0; filled && i < teeth_.size(); ++i) list.add(teeth_[i], fill_);
    if (around) nodes_.push_back(nodes_.front());
    list.add(nodes_, Cap::round);
  }

 private:
  Color fill_, line_;
  double width_;
  std::vector<Node> nodes_;
  std::vector<std::vector<Point>> teeth_;
};

/// How far a box reaches from its centre along a unit vector of its frame that is an axis of it; else less
/// than 0.
double half_along_axis(const sim::SceneInfo::Body& body, const Vec3& way) {
  if (body.kind != sim::ShapeKind::box || way.cwiseAbs().maxCoeff() < 1 - 1e-9) return -1;
  return way.cwiseAbs().dot(body.half);
}

Row row(const Stage& stage, const View& view, int index, bool edge) {
  const double weight = stage.layout.weight;
  const sim::SceneInfo::Body& body = stage.cast.bodies[std::size_t(index)];
  const double half = view.scale * std::max(body.radius, body.half.head<2>().minCoeff());
  const Paint& paint = stage.paints[std::size_t(index)];
  return {fill_of(paint, half, weight), paint.outline, (edge ? kOutline : kSpringLine) * weight};
}

}  // namespace

double Toothed::pitch() const { return kTurn / count; }
double Toothed::high() const { return kToothHeight * pitch() * radius; }

Gears gears_of(const sim::SceneInfo& cast, const sim::Snapshot& now) {
  const auto is_gear = [&](std::size_t i) {
    const sim::SceneInfo::Joint& joint = cast.joints[i];
    return joint_look(joint.kind).plane == JointMark::teeth && !now.joints[i].broken &&
           joint.places.size() == 4 && !joint.belt;
  };
  double least = 1e300;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    if (!is_gear(i)) continue;
    for (const double radius : {cast.joints[i].offset_a, cast.joints[i].offset_b})
      if (radius > 0) least = std::min(least, radius);
  }
  Gears all;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    if (!is_gear(i)) continue;
    const sim::SceneInfo::Joint& joint = cast.joints[i];
    double between = 0;  // where the second wheel has a tooth against the first's, in teeth
    const auto add = [&](const sim::SceneInfo::Joint::Place& at, double radius, const Vec3& meets,
                         bool second) {
      if (!(radius > 0) || at.body < 0) return;
      const int count = std::max(kFewestTeeth, int(std::lround(kFewestTeeth * radius / least)));
      const double angle = std::atan2(meets.y(), meets.x());
      const double first = angle + (second ? between + 0.5 : 0) * kTurn / count;
      const Toothed& wheel = all.wheels.try_emplace(at.body, Toothed{at, radius, first, count}).first->second;
      if (!second) between = (angle - wheel.first) * wheel.count / kTurn;
    };
    add(joint.places[0], joint.offset_a, joint.tooth_a, false);
    add(joint.places[2], joint.offset_b, joint.tooth_b, true);
    const bool first = !(joint.offset_a > 0);
    if (first == !(joint.offset_b > 0)) continue;
    const int rack = joint.places[first ? 0 : 2].body, pinion = joint.places[first ? 2 : 0].body;
    if (const auto found = all.wheels.find(pinion); rack >= 0 && found != all.wheels.end())
      all.racks.try_emplace(rack, Rack{first ? joint.tooth_a : joint.tooth_b, found->second});
  }
  return all;
}

double cut_of_teeth(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                    int index) {
  const sim::SceneInfo::Body& body = stage.cast.bodies[std::size_t(index)];
  const auto seen = [&](double high) {
    return view.scale * high > kLeastTooth * stage.layout.weight ? high : 0.0;
  };
  if (const auto found = gears.wheels.find(index); found != gears.wheels.end()) {
    const Toothed& wheel = found->second;
    const double off = std::max(wheel.center.local.norm(), std::abs(body.radius - wheel.radius));
    return body.kind == sim::ShapeKind::ball && off < kNear * wheel.high() ? seen(wheel.high()) : 0;
  }
  if (const auto found = gears.racks.find(index); found != gears.racks.end()) {
    const Toothed& pinion = found->second.pinion;
    const double half = half_along_axis(body, found->second.out);
    const Vec3 out = now.bodies[std::size_t(index)].orientation * found->second.out;
    const double pitch_line =
        (place_of(now, pinion.center) - now.bodies[std::size_t(index)].position).dot(out) + pinion.radius;
    return half > 2 * pinion.high() && std::abs(pitch_line + half) < kNear * pinion.high()
               ? seen(pinion.high())
               : 0;
  }
  return 0;
}

void draw_gears(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                List& list) {
  for (const auto& [body, wheel] : gears.wheels) {
    const Vec3 center = place_of(now, wheel.center);
    const double pitch = wheel.pitch(), high = wheel.high();
    const double first = wheel.first + now.bodies[std::size_t(body)].angle;
    const auto at = [&](double teeth, double r) {
      const double angle = first + teeth * pitch;
      return view.page(center + r * Vec3(std::cos(angle), std::sin(angle), 0));
    };
    const bool edge = cut_of_teeth(stage, view, now, gears, body) > 0;
    Row teeth = row(stage, view, body, edge);
    const double foot = wheel.radius - high, crest = wheel.radius + high, deep = foot - high;
    for (int k = 0; k < wheel.count; ++k)
      teeth.add(at(k - kToothFoot, foot), at(k - kToothCrest, crest), at(k + kToothCrest, crest),
                at(k + kToothFoot, foot), at(k - kToothFoot, deep), at(k + kToothFoot, deep));
    list.of({Subject::What::body, body});
    teeth.draw(edge, true, list);
  }
}

// Where the pinion has a tooth, the rack has a gap: the place that meets it is at
// r (angle of the tooth - angle of the way there) along the rack.
void draw_racks(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                List& list) {
  for (const auto& [index, rack] : gears.racks) {
    const Toothed& pinion = rack.pinion;
    const sim::Snapshot::Body& body = now.bodies[std::size_t(index)];
    const Vec3 out = body.orientation * rack.out, along(-out.y(), out.x(), 0);
    const Vec3 foot = place_of(now, pinion.center) + pinion.radius * out;
    // how far the body reaches along it
    const sim::SceneInfo::Body& its = stage.cast.bodies[std::size_t(index)];
    const Vec3 own_along(-rack.out.y(), rack.out.x(), 0);
    double reach = its.radius;
    if (its.kind == sim::ShapeKind::box)
      reach = std::abs(own_along.x()) * its.half.x() + std::abs(own_along.y()) * its.half.y();
    for (const Vec3& vertex : its.vertices) reach = std::max(reach, std::abs(vertex.dot(own_along)));
    const double middle = (body.position - foot).dot(along);
    const double pitch = pinion.pitch() * pinion.radius, high = pinion.high();
    const double tooth = pinion.radius * (pinion.first + now.bodies[std::size_t(pinion.center.body)].angle -
                                          std::atan2(out.y(), out.x()));
    const auto at = [&](double x, double h) { return view.page(foot + x * along - h * out); };
    const bool edge = cut_of_teeth(stage, view, now, gears, index) > 0;
    Row teeth = row(stage, view, index, edge);
    const double from = std::ceil((middle - reach - tooth) / pitch) - 0.5;
    for (double x = tooth + from * pitch; x <= middle + reach; x += pitch) {
      const double low = x - kToothFoot * pitch, top = x + kToothFoot * pitch;
      if (low < middle - reach || top > middle + reach) continue;
      teeth.add(at(low, -high), at(x - kToothCrest * pitch, high), at(x + kToothCrest * pitch, high),
                at(top, -high), at(low, -2 * high), at(top, -2 * high));
    }
    list.of({Subject::What::body, index});
    teeth.draw(edge, false, list);
  }
}

}  // namespace obscura::draw
