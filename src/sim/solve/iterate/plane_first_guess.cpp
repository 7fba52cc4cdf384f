// Forces that a pile may begin with, from the top down: each body stands on what lies below it,
//   sum f_i u_i = W + loads,  sum f_i m_i = -moment of the loads,  f_i >= 0 of least sum of squares
// u_i how much of normal i points up, m_i its moment about the centre. It hands f_i on. Where normals are
// upright this is an equilibrium, and a pile of boxes of any height begins at rest.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/plane.h"

namespace obscura::sim {

using plane::Feature;
using plane::Pair;

namespace {

struct Support {
  int contact = 0;
  double up = 0, moment = 0, force = 0;
  bool bears = true;
};

// false where no forces do it
bool balance(std::vector<Support>& supports, double weight, double moment) {
  for (;;) {
    int left = 0;
    double a = 0, b = 0, c = 0;
    for (const Support& s : supports) {
      if (!s.bears) continue;
      ++left, a += s.up * s.up, b += s.up * s.moment, c += s.moment * s.moment;
    }
    if (left == 0) return false;
    // f_i = p u_i + q m_i
    const double det = a * c - b * b;
    double p = weight / a, q = 0;
    if (det > 1e-9 * a * c) p = (c * weight + b * moment) / det, q = -(a * moment + b * weight) / det;
    Support* worst = nullptr;
    double whole = 0, turn = moment;
    for (Support& s : supports) {
      if (!s.bears) continue;
      s.force = p * s.up + q * s.moment;
      whole += std::fabs(s.force * s.moment), turn += s.force * s.moment;
      if (s.force < 0 && (!worst || s.force < worst->force)) worst = &s;
    }
    if (!worst) return std::fabs(turn) <= 1e-6 * (whole + std::fabs(moment));
    worst->bears = false, worst->force = 0;
  }
}

}  // namespace

void PlaneIterative::first_guess(State<D>& state) {
  const double g = std::sqrt(model_.gravity.squaredNorm());
  if (g == 0) return;
  const int n = int(turns_.size());
  const Vec<D> up = -model_.gravity / g;
  std::vector<std::pair<double, int>> order;
  std::vector<std::vector<int>> around(n);  // pairs of each body
  for (int i = 0; i < n; ++i) order.emplace_back(-up.dot(state.x[i]), i);
  std::sort(order.begin(), order.end());
  for (int i = 0; i < int(pairs_.all().size()); ++i) {
    const Pair& pair = pairs_.all()[i];
    if (pair.slot < 0) continue;
    around[pair.a].push_back(i);
    if (pair.b >= 0) around[pair.b].push_back(i);
  }
  std::vector<double> load(n, 0), turn(n, 0);  // N upwards, N m
  std::vector<Support> supports;
  for (const auto& [height, body] : order) {
    if (moving_[body].im == 0) continue;
    supports.clear();
    for (const int i : around[body]) {
      const Pair& pair = pairs_.all()[i];
      for (int k = 0; k < pair.touches; ++k) {
        Contact<D>& contact = state.contacts[pair.first + k];
        const Feature f = Feature::of(contact.key.feature);
        if (f.kind == Feature::none) continue;
        const plane::ContactPoint at = pairs_.place(pair, poses_, f);
        contact.normal = {at.nx, at.ny}, contact.point = {at.x, at.y};
        const Vec<D> normal = pair.a == body ? contact.normal : Vec<D>(-contact.normal);
        if (at.gap > 1e-3 * cores_.half_thickness[body] || up.dot(normal) <= 0.5) continue;
        Support support;
        support.contact = pair.first + k, support.up = up.dot(normal);
        support.moment = moment<D>(contact.point - state.x[body], normal)[0];
        supports.push_back(support);
      }
    }
    const double weight = g / moving_[body].im - load[body];
    if (!balance(supports, weight, turn[body])) {
      for (Support& s : supports) s.force = weight / double(supports.size()) / s.up;
    }
    for (const Support& s : supports) {
      Contact<D>& contact = state.contacts[s.contact];
      contact.force = s.force * contact.normal;
      const int other = contact.key.a == body ? contact.key.b : contact.key.a;
      if (other < 0) continue;
      const Vec<D> on = contact.key.a == body ? Vec<D>(-contact.force) : contact.force;
      load[other] += up.dot(on);
      turn[other] += moment<D>(contact.point - state.x[other], on)[0];
    }
  }
}

}  // namespace obscura::sim
