#include "draw/picture/formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

constexpr double kScript = 0.7, kSub = -0.2, kSuper = 0.36;  // size and rise of scripts, em

constexpr std::array<std::pair<std::string_view, std::string_view>, 46> kNames{{
    {"alpha", "α"},  {"beta", "β"},     {"gamma", "γ"}, {"delta", "δ"},   {"epsilon", "ε"}, {"zeta", "ζ"},
    {"eta", "η"},    {"theta", "θ"},    {"kappa", "κ"}, {"lambda", "λ"},  {"mu", "μ"},      {"nu", "ν"},
    {"xi", "ξ"},     {"pi", "π"},       {"rho", "ρ"},   {"sigma", "σ"},   {"tau", "τ"},     {"phi", "φ"},
    {"chi", "χ"},    {"psi", "ψ"},      {"omega", "ω"}, {"Gamma", "Γ"},   {"Delta", "Δ"},   {"Theta", "Θ"},
    {"Lambda", "Λ"}, {"Pi", "Π"},       {"Sigma", "Σ"}, {"Phi", "Φ"},     {"Psi", "Ψ"},     {"Omega", "Ω"},
    {"perp", "⊥"},   {"times", "×"},    {"cdot", "·"},  {"pm", "±"},      {"le", "≤"},      {"ge", "≥"},
    {"approx", "≈"}, {"infty", "∞"},    {"to", "→"},    {"circ", "°"},    {"deg", "°"},     {"sqrt", "√"},
    {"prime", "′"},  {"parallel", "∥"}, {"int", "∫"},   {"partial", "∂"},
}};

bool latin(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

std::size_t length_of(char first) {
  const auto c = static_cast<unsigned char>(first);
  return c < 0x80 ? 1 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : 4;
}

// Greek small letters are italic, as Latin ones are
bool italic(std::string_view c) {
  if (c.size() == 1) return latin(c[0]);
  const std::string_view small[] = {"α", "β", "γ", "δ", "ε", "ζ", "η", "θ", "κ", "λ", "μ", "ν",
                                    "ξ", "π", "ρ", "σ", "τ", "φ", "χ", "ψ", "ω", "ϵ", "ϕ"};
  return std::find(std::begin(small), std::end(small), c) != std::end(small);
}

bool low(std::string_view c) {
  static constexpr std::string_view flat = "acemnorsuvwxz.,";
  return c.size() == 1 && flat.find(c[0]) != flat.npos;
}

bool deep(std::string_view c) {
  static constexpr std::string_view hung = "gjpqy()Q,/";
  const std::string_view greek[] = {"β", "γ", "ζ", "η", "μ", "ξ", "ρ", "φ", "χ", "ψ"};
  return (c.size() == 1 && hung.find(c[0]) != hung.npos) ||
         std::find(std::begin(greek), std::end(greek), c) != std::end(greek);
}

class Setter {
 public:
  Setter(std::string_view text, double size, Color color, double pad) : text_(text), pad_(pad) {
    out_.size = size;
    out_.color = color;
  }

  Formula set() {
    run(text_, 1, 0);
    if (!out_.spans.empty()) out_.width = width();
    return std::move(out_);
  }

 private:
  double width() const { return shape({{0, 0}, Align::left, out_.spans}).width; }

  void put(std::string_view c, Face face, double scale, double rise) {
    const double em = scale * out_.size;
    const double up = rise * out_.size;
    const bool joins = !out_.spans.empty() && out_.spans.back().face == face &&
                       out_.spans.back().size == em && out_.spans.back().rise == up &&
                       out_.spans.back().tabular == number_;
    if (joins) {
      out_.spans.back().text += c;
    } else {
      // an italic letter leans into what stands above it
      const bool leans =
          !out_.spans.empty() && rise > 0 &&
          (out_.spans.back().face == Face::math_italic || out_.spans.back().face == Face::math_bold_italic);
      out_.spans.push_back({.text = std::string(c),
                            .face = face,
                            .size = em,
                            .color = out_.color,
                            .rise = up,
                            .lead = (leans ? 0.07 * out_.size : 0) + (number_ ? pad_ : 0),
                            .tabular = number_});
    }
    if (c == " ") return;
    out_.ascent = std::max(out_.ascent, up + em * (low(c) ? 0.47 : 0.7));
    out_.descent = std::max(out_.descent, em * (deep(c) ? 0.22 : 0.015) - up);
  }

  void letter(std::string_view c, double scale, double rise) {
    const Face face = !italic(c) ? Face::math : bold_ ? Face::math_bold_italic : Face::math_italic;
    put(c == "-" ? std::string_view("−") : c, face, scale, rise);
  }

  // the argument of a script or an accent: {...}, or one symbol
  std::string_view argument(std::string_view text, std::size_t& i) {
    if (i < text.size() && text[i] == '{') {
      std::size_t depth = 0, from = i + 1;
      for (; i < text.size(); ++i) {
        if (text[i] == '{') ++depth;
        if (text[i] == '}' && --depth == 0) break;
      }
      const std::string_view inner = text.substr(from, i - from);
      i = std::min(i + 1, text.size());
      return inner;
    }
    const std::size_t from = i;
    if (i < text.size() && text[i] == '\\') {
      ++i;
      while (i < text.size() && latin(text[i])) ++i;
    } else if (i < text.size() && latin(text[i])) {
      // "v_center": a word is one
      while (i < text.size() && latin(text[i])) ++i;
    } else if (i < text.size()) {
      i += length_of(text[i]);
    }
    return text.substr(from, i - from);
  }

  void run(std::string_view text, double scale, double rise) {
    for (std::size_t i = 0; i < text.size();) {
      const char c = text[i];
      if (c == kNumber || c == kNumberEnd) {
        number_ = c == kNumber, ++i;
      } else if (c == '*') {
        bold_ = !bold_, ++i;
      } else if (c == '_' || c == '^') {
        ++i;
        const bool bold = std::exchange(bold_, false);
        run(argument(text, i), kScript * scale, rise + scale * (c == '_' ? kSub : kSuper));
        bold_ = bold;
      } else if (c == '\'') {
        put("′", Face::math, scale, rise), ++i;
      } else if (c == '"') {
        const std::size_t end = std::min(text.find('"', i + 1), text.size());
        put(text.substr(i + 1, end - i - 1), Face::math, scale, rise);
        i = std::min(end + 1, text.size());
      } else if (c == '\\') {
        name(text, ++i, scale, rise);
      } else if (latin(c)) {
        std::size_t end = i;
        while (end < text.size() && latin(text[end])) ++end;
        if (end - i >= 3) {
          put(text.substr(i, end - i), Face::math, scale, rise);
        } else {
          for (std::size_t k = i; k < end; ++k) letter(text.substr(k, 1), scale, rise);
        }
        i = end;
      } else {
        const std::size_t n = std::min(length_of(c), text.size() - i);
        letter(text.substr(i, n), scale, rise);
        i += n;
      }
    }
  }

  void name(std::string_view text, std::size_t& i, double scale, double rise) {
    const std::size_t from = i;
    while (i < text.size() && latin(text[i])) ++i;
    const std::string_view word = text.substr(from, i - from);
    const bool accent = word == "bar" || word == "vec" || word == "dot" || word == "ddot";
    if (accent) {
      const double before = width();
      const std::string_view inner = argument(text, i);
      run(inner, scale, rise);
      const double em = scale * out_.size;
      const double top = rise * out_.size + em * (inner.size() == 1 && low(inner) ? 0.56 : 0.78);
      // over the middle of a letter that leans
      out_.overs.push_back({word == "bar"   ? Formula::Over::bar
                            : word == "vec" ? Formula::Over::arrow
                            : word == "dot" ? Formula::Over::dot
                                            : Formula::Over::dots,
                            before + 0.06 * em, width() + 0.03 * em, top});
      out_.ascent = std::max(out_.ascent, top + 0.08 * em);
      return;
    }
    for (const auto& [known, symbol] : kNames) {
      if (known == word) return letter(symbol, scale, rise);
    }
    put("\\", Face::math, scale, rise);
    put(word, Face::math, scale, rise);
  }

  std::string_view text_;
  Formula out_;
  double pad_ = 0;
  bool bold_ = false, number_ = false;
};

}  // namespace

Formula formula(std::string_view text, double size, Color color, double pad) {
  return Setter(text, size, color, pad).set();
}

void add(const Formula& f, const Point& at, List& list) {
  if (f.empty()) return;
  list.add(Text{at, Align::left, f.spans});
  const double line = 0.055 * f.size;
  for (const Formula::Over& over : f.overs) {
    const Point a = at + Point(over.from, -over.rise), b = at + Point(over.to, -over.rise), m = (a + b) / 2;
    const double r = 0.055 * f.size;
    switch (over.kind) {
      case Formula::Over::bar:
        list.add({{a, line, f.color}, {b, line, f.color}}, Cap::butt);
        break;
      case Formula::Over::arrow: {
        const double h = 0.09 * f.size;
        list.add({{a, line, f.color}, {b - Point(h / 2, 0), line, f.color}}, Cap::butt);
        list.add({b, b + Point(-1.5 * h, -h), b + Point(-h, 0), b + Point(-1.5 * h, h)}, f.color);
        break;
      }
      case Formula::Over::dot:
        list.add(Disc{m, r, 0, f.color, f.color});
        break;
      case Formula::Over::dots:
        list.add(Disc{m - Point(2 * r, 0), r, 0, f.color, f.color});
        list.add(Disc{m + Point(2 * r, 0), r, 0, f.color, f.color});
        break;
    }
  }
}

std::string as_vector(const std::string& text) {
  if (text.empty() || text.find('*') != text.npos || !latin(text[0])) return text;
  std::string vector = "*";
  vector.append(text, 0, 1).append("*").append(text, 1);
  return vector;
}

std::optional<ValueSlot> value_slot(std::string_view text) {
  for (std::size_t at = text.find('{'); at != text.npos; at = text.find('{', at + 1)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("{}")) return ValueSlot{at, at + 2, {}};
    if (rest.size() >= 5 && rest.starts_with("{:.") && rest[3] >= '0' && rest[3] <= '9' && rest[4] == '}')
      return ValueSlot{at, at + 5, rest[3] - '0'};
  }
  return {};
}

namespace {

// what stands after a value of a given form, its unit upright
std::string after(std::string rest, std::string_view unit) {
  if (unit.empty()) return rest;
  std::string typed(unit);
  if (const auto square = typed.find("²"); square != typed.npos) typed.replace(square, 2, "^2");
  const std::size_t gap = rest.find_first_not_of(' ');
  if (gap == rest.npos) return rest;
  for (const std::string& word : {std::string(unit), typed}) {
    if (rest.compare(gap, word.size(), word) != 0) continue;
    const std::size_t end = gap + word.size();
    if (end < rest.size() && latin(rest[end])) continue;
    return fmt::format("\"{}{}\"{}", rest.substr(0, gap), unit, rest.substr(end));
  }
  return rest;
}

// no minus before a zero
std::string number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_not_of("-0.") == text.npos && text[0] == '-') text.erase(0, 1);
  return text;
}

}  // namespace

std::string with_value(const std::string& text, double value, std::string_view unit) {
  const auto slot = value_slot(text);
  if (!slot) return text;
  const std::string before = text.substr(0, slot->begin), rest = text.substr(slot->end);
  if (slot->decimals) return before + number(value, *slot->decimals) + after(rest, unit);
  const double shown = std::abs(value) < 1e-9 ? 0 : value;
  return before + fmt::format("{:.3g}", shown) + (unit.empty() ? "" : fmt::format("\" {}\"", unit)) + rest;
}

Formula live(const std::string& text, double value, double low, double high, std::string_view unit,
             double size, Color color) {
  const auto slot = value_slot(text);
  if (!slot) return formula(text, size, color);
  const double most = std::max(std::abs(low), std::abs(high));
  const int digits =
      slot->decimals.value_or(most > 1e-9 ? std::clamp(2 - int(std::floor(std::log10(most))), 0, 6) : 2);
  const auto width = [&](double x) {
    return formula(kNumber + number(x, digits) + kNumberEnd, size, color).width;
  };
  const std::string shown = number(value, digits);
  const double own = width(value), widest = std::max({own, width(low), width(high)});
  std::string rest = text.substr(slot->end);
  rest = slot->decimals ? after(rest, unit) : (unit.empty() ? "" : fmt::format("\" {}\"", unit)) + rest;
  return formula(text.substr(0, slot->begin) + kNumber + shown + kNumberEnd + rest, size, color,
                 widest - own);
}

void fade(Formula& formula, double strength) {
  const double s = std::clamp(strength, 0.0, 1.0);
  formula.color.a = std::uint8_t(std::lround(formula.color.a * s));
  for (Span& span : formula.spans) span.color.a = formula.color.a;
}

}  // namespace obscura::draw
