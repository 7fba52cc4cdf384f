#include "sim/model/model.h"

namespace obscura::sim {

template <int D>
Model<D>::Model() = default;
template <int D>
Model<D>::Model(const Model&) = default;
template <int D>
Model<D>::Model(Model&&) noexcept = default;
template <int D>
Model<D>& Model<D>::operator=(const Model&) = default;
template <int D>
Model<D>& Model<D>::operator=(Model&&) noexcept = default;
template <int D>
Model<D>::~Model() = default;

template struct Model<2>;
template struct Model<3>;

}  // namespace obscura::sim
