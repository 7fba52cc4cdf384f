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

/// The same of a control character at i where plain words stand: what TOML makes of "\theta".
std::optional<FormulaMistake> escaped_in_words(std::string_view words, std::size_t i);

/// Sets `text` at an em of `size` page units. A name that is not known stays as it was written. What stands
/// between kNumber and kNumberEnd is a number in digits of equal width, with so many ems of `room` before it.
Formula formula(std::string_view text, double size, Color color, double room = 0);
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

/// All of it as much lighter as `strength` (0 to 1) says.
void fade(Formula& formula, double strength);

}  // namespace obscura::draw
