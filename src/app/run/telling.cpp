#include "app/run/telling.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "draw/page/measure.h"
#include "draw/picture/prose.h"
#include "scene/complaints.h"
#include "sim/model/wall_name.h"

namespace obscura::app::telling {

namespace {

constexpr double kNoMotion = 1e-9;   // of the room's height a second: slower does not move
constexpr double kNoTurning = 1e-9;  // rad/s
constexpr double kRight = 1e-9;      // of its size: so much may a box's diagonals differ
constexpr double kNothing = 1e-30, kSmall = 1e-4, kLarge = 1e6;  // numbers that are told as 0, with a power

// to a thousandth of what all lasts, or is long, but that where it is longer than 1
double rounded(double x, double all) {
  const double unit = 1e-3 * std::min(1.0, std::pow(10.0, std::floor(std::log10(std::max(all, kNothing)))));
  const double parts = std::round(1 / unit);
  return std::round(x * parts) / parts;
}

// Whether its corners are a box's: all as far from the centre, each with one opposite. A box that cannot turn
// keeps the pose that the scene gives it as a polygon or hull.
bool has_corners_of_box(const sim::SceneInfo& cast, const sim::SceneInfo::Body& body) {
  const std::size_t corners = cast.dimension == 2 ? 4 : 8;
  if (body.radius > 0 || body.vertices.size() != corners) return false;
  const double far = body.vertices[0].norm();
  return std::all_of(body.vertices.begin(), body.vertices.end(), [&](const sim::Vec3& v) {
    return std::abs(v.norm() - far) <= kRight * far &&
           std::any_of(body.vertices.begin(), body.vertices.end(),
                       [&](const sim::Vec3& other) { return (v + other).norm() <= kRight * far; });
  });
}

struct Noun {
  const char *one, *many;
};

Noun noun(const sim::SceneInfo& cast, const sim::SceneInfo::Body& body) {
  switch (body.kind) {
    case sim::ShapeKind::point:
      return {"particle", "particles"};
    case sim::ShapeKind::ball:
      return cast.dimension == 2 ? Noun{"disc", "discs"} : Noun{"ball", "balls"};
    case sim::ShapeKind::box:
      return {"box", "boxes"};
    case sim::ShapeKind::capsule:
      return {"capsule", "capsules"};
    case sim::ShapeKind::polygon:
    case sim::ShapeKind::hull:
      if (has_corners_of_box(cast, body)) return {"box", "boxes"};
      return cast.dimension == 2 ? Noun{"polygon", "polygons"} : Noun{"polyhedron", "polyhedra"};
    case sim::ShapeKind::compound:
      if (body.parts.size() == 1 && body.parts[0].kind == sim::ShapeKind::box) return {"box", "boxes"};
      return {"body", "bodies"};
  }
  return {"body", "bodies"};
}

}  // namespace

std::string numeral(double x) {
  if (!(std::abs(x) > kNothing)) return "0";
  if (!(std::abs(x) >= kSmall && std::abs(x) < kLarge)) {
    const std::string text = fmt::format("{:.2e}", x);
    const std::size_t e = text.find('e');
    std::string digits = text.substr(0, e);
    while (digits.back() == '0') digits.pop_back();
    if (digits.back() == '.') digits.pop_back();
    return fmt::format("{}e{}", digits, std::stoi(text.substr(e + 1)));
  }
  const int decimals = std::clamp(2 - int(std::floor(std::log10(std::abs(x)))), 0, 9);
  std::string text = fmt::format("{:.{}f}", x, decimals);
  if (decimals == 0) return text;
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string time(double t, double duration) { return numeral(rounded(t, duration)) + " s"; }

std::string whereabouts(const sim::Vec3& p, const sim::SceneInfo& cast) {
  const int dimension = cast.dimension;
  const auto at = [&](double x) { return numeral(rounded(x, cast.scale)); };
  return dimension == 2 ? fmt::format("({}, {}) m", at(p.x()), at(p.y()))
                        : fmt::format("({}, {}, {}) m", at(p.x()), at(p.y()), at(p.z()));
}

std::string called(const sim::SceneInfo& cast, int body) {
  const std::string name = scene::one_line(cast.bodies[std::size_t(body)].name);
  return name.find('[') != name.npos ? name : "the " + draw::in_words(name);
}

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = char(text[0] - 'a' + 'A');
  return text;
}

std::string wall(const sim::SceneInfo& cast, int index) {
  const sim::Vec3 n = cast.walls[std::size_t(index)].normal.normalized();
  if (const auto name = sim::wall_name<3>(n)) return std::string(*name);
  return n.y() > 0.05 ? "the slope" : "a wall";
}

std::string motion(const sim::Vec3& v, const sim::SceneInfo& cast) {
  const int dimension = cast.dimension;
  const double speed = v.norm();
  std::vector<std::string> way;
  // what is to the right in space is the camera's business
  const auto along = [&](double component, const char* there, const char* back) {
    if (std::abs(component) > 0.3 * speed) way.emplace_back(component > 0 ? there : back);
  };
  dimension == 2 ? along(v.x(), "to the right", "to the left") : along(v.x(), "along x", "along −x");
  along(v.y(), "up", "down");
  if (dimension == 3) along(v.z(), "along z", "along −z");
  return fmt::format("at {} m/s{}{}", numeral(speed), way.empty() ? "" : " ", together(way));
}

bool stands(const sim::Vec3& v, const sim::SceneInfo& cast) { return !(v.norm() > kNoMotion * cast.scale); }

bool turns(const sim::Vec3& spin) { return spin.norm() > kNoTurning; }

std::string moves(const sim::Vec3& v, const sim::Vec3& spin, const sim::SceneInfo& cast) {
  if (!stands(v, cast)) return "moves " + motion(v, cast);
  return turns(spin) ? fmt::format("turns at {} rad/s", numeral(spin.norm())) : "does not move";
}

std::string together(std::vector<std::string> all) {
  if (all.empty()) return "";
  const std::string last = all.back();
  all.pop_back();
  return all.empty() ? last : fmt::format("{} and {}", fmt::join(all, ", "), last);
}

std::string headline(const draw::Look& look) {
  return draw::in_letters(look.title) +
         (look.subtitle.empty() ? "." : ": " + draw::in_letters(look.subtitle) + ".");
}

std::string count(std::size_t n, const char* one, const char* many) {
  return n == 1 ? fmt::format("one {}", one) : fmt::format("{} {}", n, many);
}

std::vector<int> moving(const sim::SceneInfo& cast) {
  std::vector<int> all;
  for (std::size_t i = 0; i < cast.bodies.size(); ++i)
    if (!cast.bodies[i].fixed) all.push_back(int(i));
  return all;
}

std::string listed(const sim::SceneInfo& cast) {
  std::vector<std::string> all;
  std::vector<std::pair<Noun, std::size_t>> kinds;  // in the order of the scene
  std::size_t fixed = 0;
  for (const sim::SceneInfo::Body& body : cast.bodies) {
    if (body.bare || (body.fixed && ++fixed)) continue;
    const Noun its = noun(cast, body);
    const auto of = std::find_if(kinds.begin(), kinds.end(),
                                 [&](const auto& it) { return std::string_view(it.first.one) == its.one; });
    if (of != kinds.end())
      ++of->second;
    else
      kinds.emplace_back(its, 1);
  }
  for (const auto& [its, n] : kinds) all.push_back(count(n, its.one, its.many));
  if (fixed > 0) all.push_back(count(fixed, "fixed body", "fixed bodies"));
  if (!cast.springs.empty()) all.push_back(count(cast.springs.size(), "spring", "springs"));
  const auto joints =
      std::size_t(std::count_if(cast.joints.begin(), cast.joints.end(), [](const auto& joint) {
        return joint.kind != sim::JointKind::wire && !joint.later;
      }));
  if (joints > 0) all.push_back(count(joints, "joint", "joints"));
  if (!cast.bonds.empty()) all.push_back(count(cast.bonds.size(), "bond", "bonds"));
  if (!cast.rails.empty()) all.push_back(count(cast.rails.size(), "track", "tracks"));
  return all.empty() ? "nothing" : together(all);
}

}  // namespace obscura::app::telling
