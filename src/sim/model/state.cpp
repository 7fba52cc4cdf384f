#include "sim/model/state.h"

namespace obscura::sim {

template <int D>
State<D>::State() = default;
template <int D>
State<D>::State(const State&) = default;
template <int D>
State<D>::State(State&&) noexcept = default;
template <int D>
State<D>& State<D>::operator=(const State&) = default;
template <int D>
State<D>& State<D>::operator=(State&&) noexcept = default;
template <int D>
State<D>::~State() = default;
template <int D>
bool State<D>::operator==(const State&) const = default;

template struct State<2>;
template struct State<3>;

}  // namespace obscura::sim
