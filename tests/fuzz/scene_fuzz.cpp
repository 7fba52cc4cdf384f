// Any bytes as a scene: they end in complaints of one line each, or in a scene whose first ten steps end,
// are of finite numbers, and make no energy from nothing.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "scene/error.h"
#include "scene/scene.h"
#include "sim/energy/energy.h"
#include "sim/step/run.h"

#include "../fuzz/rooms.h"

namespace obscura {
namespace {

using fuzz::fail;

constexpr int kSteps = 10;
constexpr std::size_t kMostBodies = 60;  // more of them take longer and find nothing else

// bodies by the hundred thousand are read, slowly: another test's
bool has_many_copies(const std::string& text) {
  for (std::size_t at = 0; (at = text.find("count", at)) != std::string::npos; at += 5) {
    const std::string line = text.substr(at, text.find('\n', at) - at);
    int digits = 0;
    for (const char c : line) digits += c >= '0' && c <= '9';
    if (digits > 3) return true;
  }
  return false;
}

bool finite(const sim::Vec3& v) { return v.array().isFinite().all(); }

// what drives a room from outside, or does so by the law of its scheme
template <int D>
bool is_driven(const sim::Model<D>& model) {
  bool driven = !model.mice.empty() || !model.explosions.empty() || !model.bonds.empty() ||
                model.integrator != sim::Integrator::rk4 || model.overlap == sim::Overlap::separate ||
                model.collision == sim::Collision::handout;
  for (const sim::Joint<D>& joint : model.joints) driven = driven || joint.motor.has_value();
  for (const sim::Body<D>& body : model.bodies) driven = driven || body.handout;
  return driven;
}

// whether the ends of a spring may pass each other within a step: its force turns round there, and no scheme
// has an order
bool passes(const sim::Snapshot& now, double h) {
  const auto speed = [&](int body) { return body < 0 ? 0 : now.bodies[std::size_t(body)].velocity.norm(); };
  return std::any_of(now.springs.begin(), now.springs.end(), [&](const sim::Snapshot::Spring& spring) {
    return (spring.a - spring.b).norm() < h * (speed(spring.holds_a) + speed(spring.holds_b));
  });
}

template <int D>
void watch(const scene::Scene& scene, const sim::World<D>& world) {
  const sim::Model<D>& model = world.model;
  if (model.bodies.size() > kMostBodies) return;
  const auto run = scene.run();
  const auto start = run->at({0, 1});
  if (!std::holds_alternative<sim::Snapshot>(start)) return;
  const auto& before = std::get<sim::Snapshot>(start);
  const bool closed = !is_driven(model) && scene.stability_warnings().empty();

  for (int k = 1; k <= kSteps; ++k) {
    const auto moment = run->at(sim::rational(k) / run->rate());
    const auto* now = std::get_if<sim::Snapshot>(&moment);
    if (!now) return;  // it says what went wrong
    if (passes(*now, 1 / sim::value(run->rate()))) return;
    // what energy is measured by: all there was, and what gravity gave or took
    double most = before.energies.kinetic + std::abs(before.energies.springs);
    for (std::size_t i = 0; i < now->bodies.size(); ++i) {
      const auto &body = now->bodies[i], &then = before.bodies[i];
      if (!finite(body.position) || !finite(body.velocity) || !finite(body.spin))
        fail("body " + std::to_string(i) + " is at no place in step " + std::to_string(k));
      if (!model.bodies[i].fixed)
        most += model.bodies[i].mass * model.gravity.norm() * (body.position - then.position).norm();
    }
    const double gained = now->energies.total() - before.energies.total();
    // a step's error is far less; what comes of nothing is more with every step
    if (closed && gained > 0.02 * most + 1e-9 * std::abs(before.energies.total()) + 1e-9)
      fail("gained " + std::to_string(gained) + " J of " + std::to_string(most) + " J by step " +
           std::to_string(k));
  }
}

}  // namespace
}  // namespace obscura

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace obscura;
  using fuzz::fail;
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  if (has_many_copies(text)) return -1;
  try {
    const scene::Scene scene = scene::parse(text, "a.toml");
    std::visit([&](const auto& world) { watch(scene, world); }, scene.world);
  } catch (const scene::Error& error) {
    if (error.complaints.empty()) fail("complains of nothing");
    for (const scene::Complaint& each : error.complaints)
      if (each.text().find('\n') != std::string::npos) fail("a complaint of two lines: " + each.text());
  }
  return 0;
}
