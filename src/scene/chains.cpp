#include "scene/chains.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene/fields.h"
#include "sim/multibody/chains.h"

namespace obscura::scene {

namespace {

// why a body cannot be a link; empty where it can
template <int D>
std::string unfit(const sim::Body<D>& body) {
  if (body.linked) return "is a link of another chain";
  if (body.fixed) return "is fixed; join a link to the room by a [[joint]], and leave this one out";
  if (body.handout) return "meets walls by the handout's law, which knows no links";
  if (body.turns()) return "";
  return body.shape.kind == sim::ShapeKind::point || body.shape.kind == sim::ShapeKind::ball
             ? "is a particle, which does not turn: a link needs a [[ball]]"
             : "does not turn, as a link must";
}

}  // namespace

template <int D>
void chains(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints) {
  const Node* all = top.find("chain");
  if (!all || all->list().empty()) return;
  if (world.model.solver == sim::Solver::iterative)
    complaints.add(Fields::of(top, "physics").place("solver"),
                   "chains are the direct solver's: leave 'solver' out, or the [[chain]]");
  if (const Node* bonds = top.find("bond"); bonds && !bonds->list().empty())
    complaints.add(bonds->list().front().place, "a scene has [[bond]]s or [[chain]]s, not both yet");

  for (const Node& table : all->list()) {
    const Fields fields(table, "chain");
    const Node* of = fields.given("of");
    if (!of) continue;
    const std::size_t wrong = complaints.count();
    std::vector<int> links;
    for (const Node& each : of->list()) {
      for (const int body : roster.bodies(each.text(), each.place, complaints)) {
        const sim::Body<D>& it = world.model.bodies[std::size_t(body)];
        if (const std::string why = unfit(it); !why.empty()) {
          complaints.add(each.place, fmt::format("'{}' {}", it.name, why));
          break;
        }
        if (std::find(links.begin(), links.end(), body) == links.end()) links.push_back(body);
      }
    }
    if (complaints.count() != wrong) continue;

    const std::size_t chains = world.model.chains.size();
    sim::articulate(world, links);
    bool joined = false;
    for (std::size_t i = chains; i < world.model.chains.size(); ++i) {
      for (const int joint : world.model.chains[i].joints) {
        if (joint < 0) continue;
        joined = true;
        if (const sim::Joint<D>& it = world.model.joints[std::size_t(joint)]; it.breaks < 1e299)
          complaints.add(
              of->place,
              fmt::format("'{}' breaks, and what holds a chain cannot; leave out its 'breaks'", it.name));
      }
    }
    if (!joined)
      complaints.add(of->place,
                     "no pin, hinge, ball, weld or slider joins any of these, to one another or to the room");
  }
}

template void chains<2>(const Node&, const NameTable&, sim::World<2>&, Diagnostics&);
template void chains<3>(const Node&, const NameTable&, sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
