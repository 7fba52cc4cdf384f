#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// A line of mathematics, set: letters are italic, what stands between asterisks is a vector in bold italic,
/// digits, operators and words of three letters or more are upright.
///   v_center'   a_{ij}   x^2   *J* = J*n*   \omega   \dot{q}   \bar{v}   \vec{r}   *r* \perp *n*   "wall"
struct Formula {
  struct Over {
    enum Kind { bar, arrow, dot, dots } kind = bar;
    double from = 0, to = 0;  // along the line
    double rise = 0;          // above the baseline
  };
  std::vector<Span> spans;
  std::vector<Over> overs;
  double size = 0;
  double width = 0, ascent = 0, descent = 0;  // page units
  Color color{};

  bool empty() const { return spans.empty(); }
};

/// Sets `text` at an em of `size` page units. A name that is not known stays as it was written.
Formula formula(std::string_view text, double size, Color color);

/// Puts it down with its baseline's left end at `at`.
void add(const Formula& formula, const Point& at, List& list);

/// `text` with its first letter a vector, unless it says itself what is one.
std::string as_vector(const std::string& text);

/// "{}" in `text` replaced by a number of three digits with its unit.
std::string with_value(const std::string& text, double value, std::string_view unit);

}  // namespace obscura::draw
