#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// A line of mathematics, set: letters are italic, what stands between asterisks is a vector in bold italic,
/// digits, operators and words of three letters or more are upright.
///   v_center'   a_{ij}   x^2   *J* = J*n*   \omega   \dot{q}   \bar{v}   \vec{r}   *r* \perp *n*   "wall"
///   \frac{1}{2}   \sqrt{2gh}   \sum_{i=1}^n   \int_a^b   \hat{n}   \text{at rest}   \sin
/// Between dollars it is as in LaTeX: spaces mean nothing, operators have theirs; what stands outside of them
/// is upright.
struct Formula {
  struct Over {
    enum Kind { bar, arrow, dot, dots, hat, tilde } kind = bar;
    double from = 0, to = 0;  // along the line
    double rise = 0;          // above the baseline
  };
  /// A fraction's bar, a root's sign.
  struct Line {
    std::vector<Point> points;  // from the line's start, y down
    double width = 0;
  };
  std::vector<Span> spans;
  std::vector<Over> overs;
  std::vector<Line> lines;
  std::vector<Formula> parts;  // numerators, radicands, limits,
  std::vector<Point> places;   // each with its baseline's left end there, y down
  std::string source;          // the text that it sets; of the whole alone
  double size = 0;
  double width = 0, ascent = 0, descent = 0;  // page units
  Color color{};

  bool empty() const { return spans.empty() && parts.empty(); }
};

/// What a formula says wrongly: the first of it.
struct FormulaMistake {
  std::size_t column = 1;  // from 1
  std::string what;        // "unknown command '\\omgea'; did you mean '\\omega'?"
};
std::optional<FormulaMistake> mistake(std::string_view text);

/// Sets `text` at an em of `size` page units. A name that is not known stays as it was written. What stands
/// between kNumber and kNumberEnd is a number in digits of equal width.
Formula formula(std::string_view text, double size, Color color);
inline constexpr char kNumber = '\x01', kNumberEnd = '\x02';

/// Which point of words stays where it is when another font sets them: that beside what they name.
struct Hold {
  Align align = Align::left;
  Level level = Level::baseline;
};

/// Puts it down with its baseline's left end at `at`; on a list whose words are apart, as LaTeX.
void add(const Formula& formula, const Point& at, List& list, const Hold& hold = {});

/// `text` with its first letter a vector, unless it says itself what is one, or begins with a word or with a
/// product: of "m g" neither letter is known to be one.
std::string as_vector(const std::string& text);

/// Mathematics whose first symbol, a letter or a command that stands for one, has a number, behind the
/// subscript that it has: "N = {}" is "N_{1} = {}". Other text, words too, stays as it is.
std::string with_number(const std::string& text, int number);

/// `text` as it is where it is mathematics; plain words, such as a body is called by, upright.
std::string as_words(const std::string& text);

/// Where a value goes in a label: "{}", of three digits and with its unit, or "{:.2}", of as many digits
/// after the point.
struct ValueSlot {
  std::size_t begin = 0, end = 0;  // of the text
  std::optional<int> decimals;
};
/// None: the label shows no value.
std::optional<ValueSlot> value_slot(std::string_view text);

/// A number as mathematics: up to six digits, from a million up and below 1e-4 with a power of ten:
/// "7.4 \times 10^{14}". `exponent`: that of the power.
std::string as_number(double value, std::optional<int> exponent = {});

/// The numbers of one axis: if one of them has a power of ten all have that of the largest.
std::vector<std::string> as_numbers(const std::vector<double>& values);

/// `text` with its slot replaced by a value. "{}" has three digits that count, those of a thousand up to a
/// million all before the point; beyond, and below 1e-4, it has a power of ten. What follows "{:.2}" and is
/// the unit is set upright.
std::string with_value(const std::string& text, double value, std::string_view unit);

/// The same for a value that goes from `low` to `high` while the label stays where it is: "{}" has as many
/// digits after the point as give the largest three digits, and its power of ten. Room is left for the
/// longest number: all labels are equally wide, and nothing in them moves but the number's first digits and
/// its sign.
Formula live(const std::string& text, double value, double low, double high, std::string_view unit,
             double size, Color color);

/// All of it as much lighter as `strength` (0 to 1) says.
void fade(Formula& formula, double strength);

}  // namespace obscura::draw
