#include "scene/explosions.h"

#include <fmt/format.h>

#include "scene/fields.h"

namespace obscura::scene {

namespace {

constexpr double kMostIntervals = 100'000;

}  // namespace

template <int D>
void explosions(const Node& top, sim::Model<D>& model, Diagnostics& complaints) {
  const Node* all = top.find("explosion");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "explosion");
    if (!fields.given("strength")) continue;
    sim::Explosion<D> it;
    it.center = fields.vector<D>("center");
    it.strength = fields.number("strength");
    it.start = fields.rational("start");
    it.duration = fields.rational("duration");
    it.interval = fields.rational("interval");
    it.softening = fields.number("softening");
    it.scheme = fields.text("scheme") == "paper" ? sim::Explosion<D>::Scheme::paper
                                                 : sim::Explosion<D>::Scheme::smooth;
    const double intervals = sim::value(it.duration) / sim::value(it.interval);
    if (intervals > kMostIntervals)
      complaints.add(fields.place("interval"),
                     fmt::format("'interval' cuts {} s into {:.0f} parts: at most {:.0f}",
                                 sim::value(it.duration), intervals, kMostIntervals));
    model.explosions.push_back(it);
  }
}

template void explosions<2>(const Node&, sim::Model<2>&, Diagnostics&);
template void explosions<3>(const Node&, sim::Model<3>&, Diagnostics&);

}  // namespace obscura::scene
