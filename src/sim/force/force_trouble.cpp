#include "sim/force/force_trouble.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "sim/math/limits.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

namespace {

std::string six_digits(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

}  // namespace

template <int D>
void refuse_force(const Model<D>& model, const Force<D>& of, int body, double t, const Vec<D>& force,
                  const Vec<D>& place, const AngularVec<D>& torque) {
  const std::string& name = model.bodies[std::size_t(std::max(0, body))].name;
  Trouble trouble;
  trouble.time = t;
  trouble.body = name.empty() ? "body " + std::to_string(body) : name;
  const bool turns = within(force.data(), D, kLargestForce) >= 0;
  trouble.quantity = turns ? "torque" : "force";
  trouble.what = (turns ? torque.array().isNaN().any() : force.array().isNaN().any()) ? "is not a number"
                                                                                      : "is infinite";
  trouble.likely = of.name + " at ";
  for (int k = 0; k < D; ++k)
    trouble.likely += (k > 0 ? ", " : "") + std::string(1, "xyz"[k]) + " = " + six_digits(place[k]);
  throw NotFinite(std::move(trouble));
}

template void refuse_force<2>(const Model<2>&, const Force<2>&, int, double, const Vec<2>&, const Vec<2>&,
                              const AngularVec<2>&);
template void refuse_force<3>(const Model<3>&, const Force<3>&, int, double, const Vec<3>&, const Vec<3>&,
                              const AngularVec<3>&);

}  // namespace obscura::sim
