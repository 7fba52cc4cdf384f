// Several forms as one. Where they overlap, the overlap counts once for each.
//   content = sum A_i     c = sum A_i c_i / A
//   plane   K = sum K_i + A_i |c_i - c|^2
//   space   C = sum C_i + V_i (c_i - c)(c_i - c)'

#include <algorithm>

#include "sim/shape/form.h"

namespace obscura::sim {

template <int D>
Spread<D> Compound<D>::spread() const {
  std::vector<Spread<D>> all;
  Spread<D> whole;
  for (const Shape<D>& part : parts) {
    all.push_back(of_form(part, [](const auto& form) { return form.spread(); }));
    whole.content += all.back().content;
    whole.center += all.back().content * all.back().center;
  }
  if (whole.content == 0) return D == 2 ? whole : Spread<D>{};
  whole.center /= whole.content;
  for (const Spread<D>& part : all) {
    const Vec<D> off = part.center - whole.center;
    if constexpr (D == 2) {
      whole.second(0) += part.second(0) + part.content * off.squaredNorm();
    } else {
      whole.second += part.second + part.content * off * off.transpose();
    }
  }
  return whole;
}

template <int D>
void Compound<D>::add_support_vertices(std::vector<SupportVertex<D>>& all) const {
  for (const Shape<D>& part : parts) of_form(part, [&](const auto& form) { form.add_support_vertices(all); });
}

template <int D>
double Compound<D>::half_thickness() const {
  double least = 1e300;
  for (const Shape<D>& part : parts)
    least = std::min(least, of_form(part, [](const auto& form) { return form.half_thickness(); }));
  return least;
}

template <int D>
double Compound<D>::bounding_radius() const {
  double most = 0;
  for (const Shape<D>& part : parts)
    most = std::max(most, of_form(part, [](const auto& form) { return form.bounding_radius(); }));
  return most;
}

template <int D>
Bounds<D> Compound<D>::bounds(const Vec<D>& x, const Rotation<D>& room_from_body) const {
  const auto of = [&](const Shape<D>& part) {
    return of_form(part, [&](const auto& form) { return form.bounds(x, room_from_body); });
  };
  Bounds<D> all = of(parts[0]);
  for (const Shape<D>& part : parts) {
    const Bounds<D> own = of(part);
    all.lower = all.lower.cwiseMin(own.lower);
    all.upper = all.upper.cwiseMax(own.upper);
  }
  return all;
}

template <int D>
double Compound<D>::outside(const Vec<D>& point) const {
  double least = 1e300;
  for (const Shape<D>& part : parts)
    least = std::min(least, of_form(part, [&](const auto& form) { return form.outside(point); }));
  return least;
}

template <int D>
Shape<D> Compound<D>::moved(const Placing<D>& placing, const Orientation<D>& turn) const {
  Compound it;
  for (const Shape<D>& part : parts)
    it.parts.push_back(of_form(part, [&](const auto& form) { return form.moved(placing, turn); }));
  return it;
}

template <int D>
std::optional<Vec<D>> Compound<D>::side(const Vec<D>& way) const {
  if (way.isZero(0)) return way;
  if (parts.size() != 1) return {};
  // one form that is not about its centre of mass
  return of_form(parts[0], [&](const auto& form) -> std::optional<Vec<D>> {
    const std::optional<Vec<D>> its = form.side(way);
    if constexpr (requires { form.center, form.turn; }) {
      if (its) return Vec<D>(form.center + rotation<D>(form.turn) * *its);
    } else if constexpr (requires { form.center; }) {
      if (its) return Vec<D>(form.center + *its);
    }
    return its;
  });
}

template <int D>
Vec<D> Compound<D>::hold() const {
  return Vec<D>::Zero();
}

template <int D>
std::vector<DrawnForm> Compound<D>::drawn() const {
  std::vector<DrawnForm> all;
  for (const Shape<D>& part : parts) {
    for (DrawnForm& one : of_form(part, [](const auto& form) { return form.drawn(); }))
      all.push_back(std::move(one));
  }
  return all;
}

template struct Compound<2>;
template struct Compound<3>;

}  // namespace obscura::sim
