#include "sim/model/incomplete.h"

#include <cmath>
#include <string>

namespace obscura::sim {

namespace {

// the first thing that is wrong with a world
template <int D>
class Inspection {
 public:
  explicit Inspection(const World<D>& world) : model_(world.model), state_(world.state) {}

  std::optional<Trouble> first() {
    rate(), bodies(), numbers(), ends();
    return found_;
  }

 private:
  void tell(int body, const char* quantity, const char* what, std::string likely) {
    if (found_) return;
    found_.emplace();
    found_->time = 0;
    found_->body = "the world";
    if (body >= 0) {
      const std::string& name = model_.bodies[std::size_t(body)].name;
      found_->body = name.empty() ? "body " + std::to_string(body) : name;
    }
    found_->quantity = quantity, found_->what = what, found_->likely = std::move(likely);
  }

  void rate() {
    if (model_.rate.num <= 0 || model_.rate.den <= 0)
      tell(-1, "rate", "is not positive", "steps a second are num / den, both above 0");
  }

  void bodies() {
    bool turning = false;
    for (int i = 0; i < int(model_.bodies.size()); ++i) {
      const Body<D>& body = model_.bodies[std::size_t(i)];
      if (!body.fixed && !(body.mass > 0 && std::isfinite(body.mass)))
        tell(i, "mass", "is not positive", "a body that moves has a mass in kilograms");
      if (!(body.inertia.array() >= 0).all() || !body.inertia.array().isFinite().all())
        tell(i, "inertia", "is not positive", "principal moments are zero for a body that does not turn");
      if (turning && !body.turns())
        tell(i, "place in the list", "is wrong", "bodies that do not turn come before those that do");
      turning = turning || body.turns();
      turns_ += body.turns();
    }
  }

  // one entry a body, all finite
  template <class Entries>
  void column(const Entries& all, std::size_t wanted, const char* quantity, const char* plural,
              const char* of) {
    if (all.size() != wanted) {
      tell(all.size() < wanted ? int(model_.bodies.size() - wanted + all.size()) : -1, quantity,
           all.size() < wanted ? "is missing" : "has too many entries",
           "the state has " + std::to_string(all.size()) + " " + plural + " for " + std::to_string(wanted) +
               " " + of);
      return;
    }
    for (std::size_t i = 0; i < all.size(); ++i)
      if (!all[i].array().isFinite().all())
        tell(int(model_.bodies.size() - wanted + i), quantity, "is not a number", "");
  }

  void numbers() {
    const std::size_t n = model_.bodies.size();
    column(state_.x, n, "position", "positions", "bodies");
    column(state_.v, n, "velocity", "velocities", "bodies");
    column(state_.turn, turns_, "orientation", "orientations", "bodies that turn");
    column(state_.spin, turns_, "spin", "spins", "bodies that turn");
    if (state_.chain_states.size() != model_.chains.size())
      tell(-1, "chain state", "is missing", "each chain has the positions and velocities of its joints");
  }

  void end(int body, const char* of, std::size_t number) {
    if (body < -1 || body >= int(model_.bodies.size()))
      tell(-1, of, "names a body that is not there",
           std::string(of) + " " + std::to_string(number) + " names body " + std::to_string(body) + " of " +
               std::to_string(model_.bodies.size()));
  }

  void ends() {
    for (std::size_t i = 0; i < model_.springs.size(); ++i)
      end(model_.springs[i].a.body, "spring", i), end(model_.springs[i].b.body, "spring", i);
    for (std::size_t i = 0; i < model_.joints.size(); ++i)
      model_.joints[i].each_body([&](int body) { end(body, "joint", i); });
    for (std::size_t i = 0; i < model_.bonds.size(); ++i)
      end(model_.bonds[i].a, "bond", i), end(model_.bonds[i].b, "bond", i);
    for (std::size_t i = 0; i < model_.drives.size(); ++i) end(model_.drives[i].body, "drive", i);
    for (std::size_t i = 0; i < model_.rails.size(); ++i) end(model_.rails[i].body, "rail", i);
    for (std::size_t i = 0; i < model_.forces.size(); ++i)
      for (const Subject<D>& subject : model_.forces[i].subjects) end(subject.body, "force", i);
    for (std::size_t i = 0; i < model_.chains.size(); ++i)
      for (const int body : model_.chains[i].bodies) end(body, "chain", i);
  }

  const Model<D>& model_;
  const State<D>& state_;
  std::size_t turns_ = 0;
  std::optional<Trouble> found_;
};

}  // namespace

template <int D>
std::optional<Trouble> incomplete(const World<D>& world) {
  return Inspection<D>(world).first();
}

template std::optional<Trouble> incomplete<2>(const World<2>&);
template std::optional<Trouble> incomplete<3>(const World<3>&);

}  // namespace obscura::sim
