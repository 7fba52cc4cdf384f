#include "scene/bonds.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "scene/fields.h"
#include "sim/collide/narrow_phase.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostBonds = 1'000'000;

// the bodies that a list of references means, each once, in the order of the model
std::vector<int> meant(const Node& list, const NameTable& roster, Diagnostics& complaints) {
  std::vector<int> all;
  for (const Node& each : list.list()) {
    const std::vector<int> some = roster.bodies(each.text(), each.place, complaints);
    all.insert(all.end(), some.begin(), some.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// how far apart two bodies are at the start, m; no less than `far` where they are farther than that
template <int D>
double apart(const sim::World<D>& world, int a, int b, double far) {
  const auto& one = world.model.bodies[std::size_t(a)].shape;
  const auto& other = world.model.bodies[std::size_t(b)].shape;
  const double centres = (world.state.x[std::size_t(a)] - world.state.x[std::size_t(b)]).norm();
  const double least = centres - sim::bounding_radius(one) - sim::bounding_radius(other);
  if (least > far) return least;
  return sim::separation(one, sim::body_motion(world.state, a), other, sim::body_motion(world.state, b));
}

}  // namespace

template <int D>
std::vector<NameRange> bonds(const Node& top, const NameTable& roster, sim::World<D>& world,
                             Diagnostics& complaints) {
  std::vector<NameRange> ranges;
  const Node* all = top.find("bond");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "bond");
    const Node* of = fields.given("of");
    if (!of) continue;
    const double within = fields.number("within");
    sim::Bond<D> bond;
    if (const Node* breaks = fields.given("breaks")) bond.strength = breaks->number();
    bond.impact_duration = fields.number("impact_duration");
    const std::size_t wrong = complaints.count();
    const std::vector<int> bodies = meant(*of, roster, complaints);
    if (complaints.count() != wrong) continue;
    std::size_t made = 0;
    for (std::size_t i = 0; i < bodies.size() && world.model.bonds.size() < kMostBonds; ++i) {
      for (std::size_t j = i + 1; j < bodies.size(); ++j) {
        if (apart(world, bodies[i], bodies[j], within) > within) continue;
        bond.a = bodies[i], bond.b = bodies[j];
        world.model.bonds.push_back(bond);
        ++made;
      }
    }
    const int end = int(world.model.bonds.size());
    ranges.push_back(
        {fields.given("name") ? fields.text("name") : fmt::format("bond[{}]", k), end - int(made), end});
    if (made == 0)
      complaints.add(of->place, fmt::format("no two of these {} bodies lie within {} m of each other",
                                            bodies.size(), within));
  }
  return ranges;
}

template std::vector<NameRange> bonds<2>(const Node&, const NameTable&, sim::World<2>&, Diagnostics&);
template std::vector<NameRange> bonds<3>(const Node&, const NameTable&, sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
