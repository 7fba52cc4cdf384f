#include "sim/cone.h"

namespace obscura::sim {

template <int D>
ConeReport Cone<D>::solve(const Eigen::Ref<const Eigen::MatrixXd>&, const Eigen::Ref<const Eigen::VectorXd>&,
                          std::span<const ConeBlock<D>>, std::span<ConeMode<D>>,
                          Eigen::Ref<Eigen::VectorXd> f) {
  f.setZero();
  return {};
}

template <int D>
ConeReport Cone<D>::hold(const Eigen::Ref<const Eigen::MatrixXd>&, const Eigen::Ref<const Eigen::VectorXd>&,
                         std::span<const ConeBlock<D>>, std::span<const ConeMode<D>>,
                         Eigen::Ref<Eigen::VectorXd> f) {
  f.setZero();
  return {};
}

template <int D>
ConeReport Cone<D>::least(const Eigen::Ref<const Eigen::MatrixXd>&, const Eigen::Ref<const Eigen::VectorXd>&,
                          std::span<const int>, Eigen::Ref<Eigen::VectorXd> x) {
  x.setZero();
  return {};
}

template class Cone<2>;
template class Cone<3>;

}  // namespace obscura::sim
