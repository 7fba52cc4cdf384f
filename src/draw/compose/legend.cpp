// The lines under a picture that say how long a metre and how strong an arrow is; and how long arrows are.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "draw/compose/annotate.h"
#include "draw/page/readings.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"
#include "draw/picture/formula_values.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kSmall = 8.5;                                      // points, em
constexpr double kLongest = 0.34;                                   // of the picture's shorter side
constexpr double kLegendLine = 10, kKindsApart = 10, kToWords = 3;  // points
constexpr double kLegendArrow = 1.1 * kPoint / kArrowLine;          // weight at which a shaft is 1.1 pt

}  // namespace

double round_below(double x) {
  if (!(x > 0)) return 0;
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= x * (1 + 1e-12)) return digit * power;
  return power;
}

Scales scales(const Marks& marks, const sim::SceneInfo& cast, std::span<const sim::Snapshot> moments,
              const Rect& window, double scale) {
  Scales longest;
  for (const sim::Snapshot& now : moments) {
    for (const Marks::Vector& vector : marks.vectors) {
      double* most = scale_of(vector.quantity, longest);
      if (!most || !vector.shown.may_have(now.time)) continue;
      for (const Reading& each : readings(vector, cast, now))
        if (const double size = each.value.norm();
            size > negligible(unit(vector.quantity), cast, vector.body))
          *most = std::max(*most, size);
    }
  }
  const double room = kLongest * std::min(window.width, window.height) / scale;
  const auto of = [&](double most) { return most > 0 ? room / most : 0; };
  return {of(longest.velocity), of(longest.force), of(longest.impulse), of(longest.momentum),
          of(longest.acceleration)};
}

bool has_legend(const Figure& figure) {
  Scales any;
  return figure.scale_bar || std::any_of(figure.vectors.begin(), figure.vectors.end(),
                                         [&](const auto& v) { return scale_of(v.quantity, any) != nullptr; });
}

double draw_legend(const Figure& figure, const Scales& scales, const Palette& colours, double scale,
                   double left, double right, double baseline, double type_scale, List& list) {
  const double point = type_scale * kPoint, small = kSmall * point;
  double middle = baseline - 0.24 * small;
  double taken = left;  // of the line, from the left
  // the room's scale at the left
  if (figure.scale_bar) {
    const double metres = round_below(0.25 * (right - left) / scale), length = metres * scale;
    const double tick = 2 * kPoint;
    const auto line = [&](const Point& a, const Point& b) {
      list.add({{a, 0.7 * kPoint, colours.ink}, {b, 0.7 * kPoint, colours.ink}}, Cap::butt);
    };
    line({left, middle}, {left + length, middle});
    for (const double x : {left, left + length}) line({x, middle - tick}, {x, middle + tick});
    const Formula f = formula(as_number(metres) + " \"m\"", small, colours.ink);
    add(f, {left + length + kToWords * point, baseline}, list);
    taken = left + length + kToWords * point + f.width + kKindsApart * point;
  }
  // from the right: an arrow of each kind; what finds no room goes on in a line of its own
  double x = right;
  struct Each {
    double scale;
    const char* unit;
    Quantity quantity;
  };
  for (const Each& kind :
       {Each{scales.acceleration, "m/s²", Quantity::acceleration},
        Each{scales.momentum, "kg m/s", Quantity::momentum}, Each{scales.impulse, "N s", Quantity::impulse},
        Each{scales.force, "N", Quantity::contact}, Each{scales.velocity, "m/s", Quantity::velocity}}) {
    if (!(kind.scale > 0)) continue;
    const double value = round_below(32 * kPoint / (kind.scale * scale));
    const double length = value * kind.scale * scale;
    const Formula f = formula(fmt::format("{} \"{}\"", as_number(value), kind.unit), small, colours.ink);
    if (x - f.width - kToWords * point - length < taken && (taken > left || x < right)) {
      baseline += kLegendLine * point, middle += kLegendLine * point;
      x = right, taken = left;
    }
    x -= f.width;
    add(f, {x, baseline}, list);
    x -= kToWords * point;
    std::vector<Arrow> arrows;
    offer({x - length, middle}, {x, middle}, {left, middle - length, right - left, 2 * length}, kLegendArrow,
          arrows);
    Marks::Vector of;
    of.quantity = kind.quantity;
    draw_arrows(arrows, kLegendArrow, colours.ground, color_of(of, colours), list);
    x -= length + kKindsApart * point;
  }
  return baseline;
}

}  // namespace obscura::draw
