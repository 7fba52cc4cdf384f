#include "app/run/first_difference.h"

#include <fmt/format.h>

#include <vector>

#include "app/console/interrupt.h"
#include "app/run/trouble.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

using sim::Snapshot;

std::string text(const sim::Vec3& v, int dimension) {
  std::string all = fmt::format("[{}, {}", v.x(), v.y());
  if (dimension == 3) all += fmt::format(", {}", v.z());
  return all + "]";
}

// all quantities of one body that differ; the values of the first
std::optional<Parting> of_body(const Snapshot::Body& a, const Snapshot::Body& b, int dimension) {
  Parting found;
  const auto differ = [&](const char* quantity, const std::string& left, const std::string& right) {
    if (found.quantity.empty()) found.a = left, found.b = right;
    found.quantity += (found.quantity.empty() ? "" : " and ") + std::string(quantity);
  };
  if (a.position != b.position) differ("position", text(a.position, dimension), text(b.position, dimension));
  if (dimension == 2 ? a.angle != b.angle : a.orientation.coeffs() != b.orientation.coeffs())
    dimension == 2 ? differ("angle", fmt::format("{}", a.angle), fmt::format("{}", b.angle))
                   : differ("orientation", "", "");
  if (a.velocity != b.velocity) differ("velocity", text(a.velocity, dimension), text(b.velocity, dimension));
  if (a.spin != b.spin)
    dimension == 2 ? differ("spin", fmt::format("{}", a.spin.z()), fmt::format("{}", b.spin.z()))
                   : differ("spin", text(a.spin, 3), text(b.spin, 3));
  if (a.at_rest != b.at_rest)
    differ("rest", a.at_rest ? "at rest" : "awake", b.at_rest ? "at rest" : "awake");
  if (found.quantity.empty()) return {};
  return found;
}

Parting first_difference(const Snapshot& a, const Snapshot& b, const sim::SceneInfo& cast) {
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    if (auto found = of_body(a.bodies[i], b.bodies[i], cast.dimension)) {
      found->body = cast.bodies[i].name;
      return *found;
    }
  }
  Parting found;
  for (std::size_t i = 0; i < a.mice.size() && i < b.mice.size(); ++i)
    if (a.mice[i].body != b.mice[i].body) found.quantity = fmt::format("what mouse {} holds", i);
  for (std::size_t i = 0; i < a.joints.size() && i < b.joints.size(); ++i)
    if (a.joints[i].force != b.joints[i].force || a.joints[i].broken != b.joints[i].broken)
      found.quantity = "force on joint " + cast.joints[i].name;
  if (found.quantity.empty()) found.quantity = "contact forces, or other kept values";
  return found;
}

// a difference that is there before anything moves
std::optional<Parting> of_casts(const sim::Run& a, const sim::Run& b) {
  const sim::SceneInfo &left = a.scene_info(), &right = b.scene_info();
  Parting found;
  if (left.dimension != right.dimension) {
    found.quantity = "one is in the plane and one in space";
  } else if (a.rate() != b.rate()) {
    found.quantity = "steps a second";
    found.a = sim::text(a.rate()), found.b = sim::text(b.rate());
  } else if (left.bodies.size() != right.bodies.size()) {
    found.quantity = "number of bodies";
    found.a = fmt::format("{}", left.bodies.size()), found.b = fmt::format("{}", right.bodies.size());
  } else {
    for (std::size_t i = 0; i < left.bodies.size(); ++i) {
      if (left.bodies[i].name == right.bodies[i].name) continue;
      found.quantity = "names of bodies", found.a = left.bodies[i].name, found.b = right.bodies[i].name;
      break;
    }
  }
  if (found.quantity.empty()) return {};
  return found;
}

}  // namespace

std::string Parting::text() const {
  return fmt::format("states part at step {} (t = {:g} s): {}{}{}", step, time,
                     body.empty() ? "" : "body " + body + ", ", quantity,
                     a.empty() ? "" : fmt::format(": {} and {}", a, b));
}

std::optional<Parting> parting(const scene::Scene& a, const scene::Scene& b, sim::Rational until) {
  const auto left = a.run(), right = b.run();
  left->heed(interrupted), right->heed(interrupted);
  if (const auto at_once = of_casts(*left, *right)) return at_once;
  const sim::Rational rate = left->rate();
  const std::int64_t whole = sim::floor(until * rate);
  for (std::int64_t step = 0; step <= whole + 1 && !interrupted(); ++step) {
    // the last one is the instant itself, where it lies between two steps
    sim::Rational t = sim::rational(step) / rate;
    if (until < t) t = until;
    const auto one = left->at(t), two = right->at(t);
    const auto *bad_a = std::get_if<sim::Trouble>(&one), *bad_b = std::get_if<sim::Trouble>(&two);
    Parting found;
    if (bad_a && bad_b) return {};
    if (bad_a || bad_b) {
      found.quantity = fmt::format("only one of them can go on: {}", text(bad_a ? *bad_a : *bad_b));
    } else if (left->words() != right->words()) {
      if (!std::holds_alternative<Snapshot>(one) || !std::holds_alternative<Snapshot>(two)) return {};
      found = first_difference(std::get<Snapshot>(one), std::get<Snapshot>(two), left->scene_info());
    } else {
      if (t == until) return {};
      continue;
    }
    found.step = step, found.time = sim::value(t);
    return found;
  }
  return {};
}

}  // namespace obscura::app
