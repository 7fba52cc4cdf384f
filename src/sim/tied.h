#pragma once

#include <vector>

#include "sim/integrator.h"
#include "sim/path.h"
#include "sim/spring.h"
#include "sim/turning.h"

namespace obscura::sim {

/// The bodies that springs and hands hold, gathered into one system: first the centres, then the turns of
/// those that turn.
template <int D>
class Tied final : public System {
 public:
  /// `paths`: the way of each mouse. Both are kept by reference.
  Tied(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Who is tied under the grips of `state`. To be called whenever a grip changes.
  void gather(const State<D>& state);

  bool has(int body) const { return member_[body] >= 0; }
  const std::vector<int>& bodies() const { return bodies_; }

  /// Moves the tied bodies of `state` from t to t + h.
  void step(Integrate* integrate, State<D>& state, double t, double h, Stages& stages);

  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;

 private:
  // one end of a tie: a point of a tied body, a place that stays, or a hand
  struct Hold {
    int member = -1;             // place in bodies_; -1: not a tied body
    int mouse = -1;              // whose hand; -1: none
    Vec<D> at = Vec<D>::Zero();  // in the body's frame; else a place in the room
  };
  struct Tie {
    Hold a, b;
    SpringLaw law;
  };
  struct Moving {
    Vec<D> arm, place, velocity;
  };

  Hold hold(const State<D>& state, const End<D>& end) const;
  Moving moving(const Hold& hold, double t) const;
  void push(const Hold& hold, const Vec<D>& arm, const Vec<D>& force, std::span<double> v_rate) const;

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  std::vector<int> bodies_;             // ascending: those that turn come last
  std::vector<int> member_;             // a body's place in bodies_, or -1
  std::vector<Tie> ties_;               // springs in order, then mice in order
  std::vector<double> gravity_, drag_;  // a component each; drag_ empty where there is none
  int turning_ = 0;                     // how many turn

  std::vector<Vec<D>> x_;  // where the step began
  std::vector<Turn<D>> turn_;
  std::vector<Stance<D>> stances_;  // at the stage at hand
  std::vector<double> d_, v_;
};

}  // namespace obscura::sim
