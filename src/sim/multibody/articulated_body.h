#pragma once

#include "sim/multibody/forward_kinematics.h"

namespace obscura::sim {

/// Forces on a chain and the resulting accelerations, one a link, at the origins and axes of ChainKinematics.
/// Allocated once; nothing below allocates.
template <int D>
struct ChainDynamics {
  ChainDynamics() = default;
  explicit ChainDynamics(const Chain<D>& chain);

  // by the caller
  std::vector<Wrench<D>> applied;  // on each link besides gravity, at its origin: wrench_at()

  // by factor(), from q
  std::vector<ArticulatedInertia<D>> inertia;  // of a link and all beyond it, as its parent feels it
  std::vector<Wrench<D>> U;                    // one a velocity
  std::vector<double> over_D;                  // 1/D, one a velocity

  // by accelerate()
  std::vector<Wrench<D>> resistance;   // p: articulated bias force, the wrench at zero acceleration
  std::vector<Twist<D>> acceleration;  // of the link at its origin

  // by respond()
  std::vector<Twist<D>> jump;  // the change of the link's twist at its origin

  // scratch
  std::vector<double> push;         // one a velocity
  std::vector<Wrench<D>> impulses;  // one a link
};

/// Articulated inertias, which accelerate() and respond() share; they depend on q only. Call place() first.
/// Requires that no freedom is without inertia, as a ball joint about the line to a point mass would be.
template <int D>
void factor(const Chain<D>& chain, const ChainKinematics<D>& stance, ChainDynamics<D>& dynamics);

/// Forward dynamics by the articulated-body algorithm, O(n): v' of the velocity v under tau (along the
/// freedoms), damping, the applied wrenches and gravity (m/s^2). After place(), move() and factor(). tau, v,
/// rate: chain.velocities() numbers.
template <int D>
void accelerate(const Chain<D>& chain, const ChainKinematics<D>& stance, std::span<const double> v,
                std::span<const double> tau, const Vec<D>& gravity, ChainDynamics<D>& dynamics,
                std::span<double> rate);

/// M^-1 J' of one row: the change of v that an impulse `wrench` at the origin of `link` makes, O(n). After
/// factor().
template <int D>
void respond(const Chain<D>& chain, const ChainKinematics<D>& stance, int link, const Wrench<D>& wrench,
             ChainDynamics<D>& dynamics, std::span<double> change);

/// M^-1 x: the change of v that an impulse along the freedoms makes, as of a motor or a limit, O(n). After
/// factor(). `change` may be `along`.
template <int D>
void respond(const Chain<D>& chain, const ChainKinematics<D>& stance, std::span<const double> along,
             ChainDynamics<D>& dynamics, std::span<double> change);

/// The wrench at its origin that the joint of `link` puts on it, motor and freedoms included. After
/// accelerate().
template <int D>
Wrench<D> joint_wrench(const Chain<D>& chain, const ChainKinematics<D>& stance,
                       const ChainDynamics<D>& dynamics, int link);

/// Inverse dynamics (recursive Newton-Euler): the tau under which v has the given rate, O(n). With rate zero,
/// what the reference calls h. After place() and move(). Overwrites what accelerate() left.
template <int D>
void inverse(const Chain<D>& chain, const ChainKinematics<D>& stance, std::span<const double> v,
             std::span<const double> rate, const Vec<D>& gravity, ChainDynamics<D>& dynamics,
             std::span<double> tau);

/// The joint-space mass matrix (composite rigid bodies), symmetric, velocities() x velocities(). After
/// place(). Overwrites what factor() left.
template <int D>
void mass_matrix(const Chain<D>& chain, const ChainKinematics<D>& stance, ChainDynamics<D>& dynamics,
                 Eigen::Ref<Eigen::MatrixXd> m);

}  // namespace obscura::sim
