#include "scene/chains.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "scene/fields.h"
#include "sim/multibody/chains.h"
#include "sim/shape/shape.h"
#include "sim/solve/contact_solver.h"

namespace obscura::scene {

namespace {

// why a body cannot be a link; empty where it can
template <int D>
std::string unfit(const sim::Body<D>& body) {
  if (body.linked) return "is a link of another chain";
  if (body.driven) return "is moved by its 'motion'; join a link to it by a [[joint]], and leave it out";
  if (body.fixed) return "is fixed; join a link to the room by a [[joint]], and leave this one out";
  if (body.handout) return "collides by the handout's law, which has no links";
  if (body.turns()) return "";
  return sim::round_radius(body.shape) ? "is a particle, which does not turn: a link needs a [[ball]]"
                                       : "does not turn, as a link must";
}

// Whether the links stay bodies on joints: beside many others, or by the solver that the scene names. Chains
// in reduced coordinates are the direct solver's.
template <int D>
bool stay_jointed(const sim::Model<D>& reduced) {
  if (reduced.collision != sim::Collision::contact || reduced.solver == sim::Solver::direct) return false;
  return reduced.solver == sim::Solver::iterative || !sim::body_counts(reduced).template few<D>();
}

}  // namespace

template <int D>
void chains(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints) {
  const Node* all = top.find("chain");
  if (!all || all->list().empty()) return;
  if (const Node* bonds = top.find("bond"); bonds && !bonds->list().empty())
    complaints.add(bonds->list().front().place, "a scene has [[bond]]s or [[chain]]s, not both yet");

  sim::World<D> reduced = world;
  for (const Node& table : all->list()) {
    const Fields fields(table, "chain");
    const Node* of = fields.given("of");
    if (!of) continue;
    const std::size_t wrong = complaints.count();
    std::vector<int> links;
    for (const Node& each : of->list()) {
      for (const int body : roster.bodies(each.text(), each.place, complaints)) {
        const sim::Body<D>& it = reduced.model.bodies[std::size_t(body)];
        if (const std::string why = unfit(it); !why.empty()) {
          complaints.add(each.place, fmt::format("'{}' {}", it.name, why));
          break;
        }
        if (std::find(links.begin(), links.end(), body) == links.end()) links.push_back(body);
      }
    }
    if (complaints.count() != wrong) continue;

    const std::size_t chains = reduced.model.chains.size();
    sim::articulate(reduced, links);
    bool joined = false;
    for (std::size_t i = chains; i < reduced.model.chains.size(); ++i) {
      for (const int joint : reduced.model.chains[i].joints) {
        if (joint < 0) continue;
        joined = true;
        if (const sim::Joint<D>& it = reduced.model.joints[std::size_t(joint)]; it.breaks < 1e299)
          complaints.add(
              of->place,
              fmt::format("'{}' breaks, and what holds a chain cannot; leave out its 'breaks'", it.name));
      }
    }
    if (!joined)
      complaints.add(of->place,
                     "no pin, hinge, ball, weld or slider joins any of these, to one another or to the room");
  }
  if (!stay_jointed(reduced.model)) world = std::move(reduced);
}

template void chains<2>(const Node&, const NameTable&, sim::World<2>&, Diagnostics&);
template void chains<3>(const Node&, const NameTable&, sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
