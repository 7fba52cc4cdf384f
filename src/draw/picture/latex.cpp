// Formulas as LaTeX, symbol by symbol as formula.cpp sets them: LaTeX's own words where it has them. Two
// things differ: a space beside an operator is LaTeX's business, and two scripts of a kind after one another,
// which LaTeX refuses, get an empty base.

#include "draw/picture/latex.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "draw/picture/formula.h"
#include "draw/picture/formula_text.h"

namespace obscura::draw {
namespace {

/// A character that TeX does not know by itself, in mathematics.
constexpr std::array<std::pair<std::string_view, std::string_view>, 23> kSigns{
    {{"−", "-"},          {"–", "\\mbox{--}"},   {"°", "^{\\circ}"},
     {"′", "^{\\prime}"}, {"²", "^{2}"},         {"³", "^{3}"},
     {"¹", "^{1}"},       {"⁻", "^{-}"},         {"⁺", "^{+}"},
     {"∑", "\\sum "},     {"∏", "\\prod "},      {"∫", "\\int "},
     {"∮", "\\oint "},    {"√", "\\surd "},      {"ϵ", "\\epsilon "},
     {"ϕ", "\\phi "},     {"µ", "\\mu "},        {"Ω", "\\Omega "},
     {"∠", "\\angle "},   {"⟂", "\\perp "},      {"½", "\\frac{1}{2}"},
     {"φ", "\\varphi "},  {"ε", "\\varepsilon "}}};
/// TeX's own characters.
constexpr std::array<std::pair<char, std::string_view>, 10> kOwn{{{'\\', "\\textbackslash{}"},
                                                                  {'{', "\\{"},
                                                                  {'}', "\\}"},
                                                                  {'%', "\\%"},
                                                                  {'#', "\\#"},
                                                                  {'&', "\\&"},
                                                                  {'$', "\\$"},
                                                                  {'_', "\\_"},
                                                                  {'^', "\\^{}"},
                                                                  {'~', "\\~{}"}}};

std::string_view own(char c) {
  for (const auto& [sign, written] : kOwn)
    if (sign == c) return written;
  return {};
}

/// A character as mathematics; empty where it stands for itself.
std::string sign(std::string_view c) {
  for (const auto& [symbol, written] : kSigns)
    if (symbol == c) return std::string(written);
  if (c.size() > 1)
    for (const formulas::Name& each : formulas::kNames)
      if (each.symbol == c && each.word != "circ") return fmt::format("\\{} ", each.word);
  return {};
}

/// Writes mathematics between its dollars.
class LatexWriter {
 public:
  explicit LatexWriter(bool latex, bool bold = false) : latex_(latex), bold_(bold) {}

  std::string write(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) step(text, i);
    return std::move(out_);
  }

 private:
  std::string inner(std::string_view text, bool bold) const { return LatexWriter(latex_, bold).write(text); }

  void put(std::string_view written) { out_ += written, above_ = below_ = false; }

  void script(bool below, std::string_view written) {
    bool& had = below ? below_ : above_;
    if (had) out_ += "{}", above_ = below_ = false;
    out_ += fmt::format("{}{{{}}}", below ? '_' : '^', written);
    had = true;
  }

  // what begins with ^ is a script of its own
  void put_sign(const std::string& written) {
    if (written.starts_with("^{"))
      script(false, std::string_view(written).substr(2, written.size() - 3));
    else
      put(written);
  }

  void letter(std::string_view c) {
    const std::string written = sign(c);
    const bool plain = written.empty();
    if (plain && c.size() == 1 && formulas::latin(c[0])) {
      put(bold_ ? fmt::format("\\obscurabold{{{}}}", c) : std::string(c));
    } else if (!plain && bold_ && !written.starts_with('^')) {
      put(fmt::format("\\obscurabold{{{}}}", written));
    } else if (!plain) {
      put_sign(written);
    } else if (c.size() == 1) {
      const std::string_view escaped = own(c[0]);
      put(c[0] == '\\'      ? "\\backslash "
          : c[0] == '^'     ? "\\hat{}"
          : c[0] == '~'     ? "\\sim "
          : escaped.empty() ? c
                            : escaped);
    } else {
      put(fmt::format("\\obscuratext{{{}}}", c));
    }
  }

  // a space counts between words, not beside what has room of its own
  void space(std::string_view text, std::size_t i) {
    static constexpr std::string_view kSpaced = "=<>+-";
    const auto spaced = [&](std::size_t k) {
      if (kSpaced.find(text[k]) != kSpaced.npos) return true;
      // operators by name, or typed
      for (const std::string_view word :
           {"\\approx", "\\times", "\\cdot",  "\\perp", "\\le", "\\ge", "\\ne",       "\\pm", "\\mp",
            "\\propto", "\\sim",   "\\equiv", "\\to",   "\\ll", "\\gg", "\\parallel", "\\in", "\\Rightarrow",
            "≈",        "×",       "·",       "⊥",      "≤",    "≥",    "≠",          "±",    "∓",
            "∝",        "∼",       "≡",       "→",      "−",    "≪",    "≫",          "∥",    "∈",
            "⇒"}) {
        if (text.substr(k).starts_with(word)) return true;
        // or the word ends here
        if (k + 1 >= word.size() && text.substr(k + 1 - word.size(), word.size()) == word) return true;
      }
      return false;
    };
    if ((i > 0 && spaced(i - 1)) || (i + 1 < text.size() && spaced(i + 1))) return;
    // the blank that ends a command's name is not seen: before a stroke there is one, as behind it
    const bool stroke = i + 1 < text.size() && text[i + 1] == '/' && !out_.ends_with("\\ ");
    if (out_.empty() || (out_.back() == ' ' && !stroke)) return;
    put("\\ ");
  }

  void step(std::string_view text, std::size_t& i) {
    const char c = text[i];
    if (c == kNumber || c == kNumberEnd) {
      ++i;
    } else if (c == '*') {
      bold_ = !bold_, ++i;
    } else if (c == '_' || c == '^') {
      ++i;
      const std::string_view argument = formulas::argument(text, i, latex_);
      if (argument == "*") return script(c == '_', "*");
      // "^\circ", "^{'}": it is up already
      std::string written = inner(argument, false);
      if (written.starts_with("^{") && written.find('}') == written.size() - 1)
        written = written.substr(2, written.size() - 3);
      script(c == '_', written);
    } else if (c == '\'') {
      script(false, "\\prime"), ++i;
    } else if (c == '"') {
      const std::size_t end = std::min(text.find('"', i + 1), text.size());
      words(text.substr(i + 1, end - i - 1));
      i = std::min(end + 1, text.size());
    } else if (c == '\\') {
      name(text, ++i);
    } else if (c == '{' && formulas::closing(text, i) != text.npos) {
      put(fmt::format("{{{}}}", inner(formulas::argument(text, i, latex_), bold_)));
    } else if (c == ' ') {
      if (!latex_) space(text, i);
      ++i;
    } else if (const auto [end, letters] = formulas::word(text, i); letters > 0 && !latex_) {
      units_ = std::max(units_, formulas::units_end(text, i));
      if (int(end - i) > letters)
        words(text.substr(i, end - i));
      else if (end < text.size() && text[end] == '\\' &&
               formulas::among(formulas::kFunctions, text.substr(i, end - i)) &&
               text.substr(i, end - i) != "sgn")
        put(fmt::format("\\{} ", text.substr(i, end - i)));
      else if (letters >= formulas::kWord || i < units_)
        put(fmt::format("\\mathrm{{{}}}", text.substr(i, end - i)));
      else
        for (std::size_t k = i; k < end; ++k) letter(text.substr(k, 1));
      i = end;
    } else {
      const std::size_t n = std::min(formulas::length_of(c), text.size() - i);
      letter(text.substr(i, n));
      i += n;
    }
  }

  void words(std::string_view text) {
    if (!text.empty()) put(fmt::format("\\obscuratext{{{}}}", latex_text(formulas::plain(text))));
  }

  void name(std::string_view text, std::size_t& i) {
    const std::size_t from = i;
    while (i < text.size() && formulas::latin(text[i])) ++i;
    const std::string_view word = text.substr(from, i - from);
    if (word.empty()) {
      // "\,": a space; "\{": the sign itself
      if (i >= text.size()) return;
      const char c = text[i++];
      static constexpr std::string_view kSpaces = ",:; !";
      if (kSpaces.find(c) != kSpaces.npos || c == '|')
        put(fmt::format("\\{}", c));
      else
        letter(text.substr(i - 1, 1));
      return;
    }
    const auto skip = [&] {
      while (i < text.size() && text[i] == ' ') ++i;
    };
    const auto argument = [&] {
      skip();
      return formulas::argument(text, i, latex_);
    };
    if (formulas::among(formulas::kAccents, word)) {
      put(fmt::format("\\{}{{{}}}", word, inner(argument(), bold_)));
    } else if (word == "overline") {
      put(fmt::format("\\overline{{{}}}", inner(argument(), bold_)));
    } else if (word == "operatorname") {
      put(fmt::format("\\mathop{{\\mathrm{{{}}}}}\\nolimits ", latex_text(argument())));
    } else if (formulas::fraction(word)) {
      const std::string above = inner(argument(), bold_), below = inner(argument(), bold_);
      put(fmt::format("\\frac{{{}}}{{{}}}", above, below));
    } else if (word == "sqrt") {
      skip();
      std::string index;
      if (i < text.size() && text[i] == '[')
        if (const std::size_t end = text.find(']', i); end != text.npos)
          index = fmt::format("[{}]", inner(text.substr(i + 1, end - i - 1), bold_)), i = end + 1;
      put(fmt::format("\\sqrt{}{{{}}}", index, inner(formulas::argument(text, i, latex_), bold_)));
    } else if (word == "text" || word == "mathrm") {
      words(argument());
    } else if (word == "mathbf" || word == "boldsymbol" || word == "bm") {
      put(inner(argument(), true));
    } else if (word == "mathit") {
      put(fmt::format("\\mathit{{{}}}", latex_text(argument())));
    } else if (word == "left" || word == "right") {
      skip();
      const std::string_view sign = formulas::bracket(text, i);
      i += sign.size();
      // spaces at the brackets are not seen
      if (word == "left") skip();
      if (word == "right" && out_.ends_with("\\ ")) out_.resize(out_.size() - 2);
      // LaTeX refuses one without the other
      const bool whole = word == "left" ? formulas::right_of(text, i) != text.npos : lefts_ > 0;
      if (whole) lefts_ += word == "left" ? 1 : -1;
      const std::string written = sign == "⟨"   ? "\\langle "
                                  : sign == "⟩" ? "\\rangle "
                                  : sign == "‖" ? "\\|"
                                                : std::string(sign) + (sign.size() > 2 ? " " : "");
      if (whole)
        put(fmt::format("\\{}{}", word, sign.empty() ? "." : written));
      else if (sign != ".")
        put(written);
    } else if (formulas::entry(formulas::kLarge, word)) {
      put(fmt::format("\\{}{} ", word, word.ends_with("int") ? "" : "\\limits"));
    } else if (word == "sgn") {
      put("\\mathop{\\mathrm{sgn}}\\nolimits ");
    } else if (word == "circ" || word == "deg" || word == "degree") {
      script(false, "\\circ");
    } else if (word == "prime") {
      script(false, "\\prime");
    } else if (formulas::among(formulas::kFunctions, word)) {
      put(fmt::format("\\{} ", word));
    } else if (formulas::entry(formulas::kNames, word)) {
      put(bold_ ? fmt::format("\\obscurabold{{\\{} }}", word) : fmt::format("\\{} ", word));
    } else {
      put(fmt::format("\\backslash\\mathrm{{{}}}", word));
    }
  }

  std::string out_;
  bool latex_, bold_;
  int lefts_ = 0;                       // brackets that are open
  std::size_t units_ = 0;               // where those end that are written now
  bool above_ = false, below_ = false;  // scripts of what came last
};

std::string mathematics(std::string_view text, bool latex) {
  std::string written = LatexWriter(latex).write(text);
  while (written.ends_with(' ') && !written.ends_with("\\ ")) written.pop_back();
  return written.empty() ? "" : "$" + written + "$";
}

}  // namespace

std::string latex_text(std::string_view words) {
  std::string out;
  for (std::size_t i = 0; i < words.size();) {
    const std::size_t n = std::min(formulas::length_of(words[i]), words.size() - i);
    const std::string_view c = words.substr(i, n);
    i += n;
    if (n == 1 && static_cast<unsigned char>(c[0]) < 0x20) continue;
    if (n == 1) {
      if (c == "<" || c == ">" || c == "|") {
        out += fmt::format("${}$", c);
        continue;
      }
      const std::string_view escaped = own(c[0]);
      out += escaped.empty() ? c : escaped;
      continue;
    }
    if (c == "–") {
      out += "--";
    } else if (c == "…") {
      out += "\\ldots{}";
    } else if (const std::string written = sign(c); !written.empty()) {
      out += fmt::format("${}{}$", written.starts_with('^') ? "{}" : "", written);
    } else {
      out += c;
    }
  }
  return out;
}

std::string latex(std::string_view text) {
  if (formulas::dollar(text, 0) == text.npos) return mathematics(text, false);
  std::string out;
  bool inside = false;
  for (std::size_t i = 0; i <= text.size(); inside = !inside) {
    const std::size_t end = std::min(formulas::dollar(text, i), text.size());
    const std::string_view part = text.substr(i, end - i);
    out += inside ? mathematics(part, true) : latex_text(formulas::plain(part));
    i = end + 1;
  }
  return out;
}

Words latex_words(const Text& text) {
  Words words{.at = text.at, .align = text.align};
  for (const Span& span : text.spans) {
    if (words.latex.empty()) words.size = span.size, words.color = span.color;
    const std::string written = latex_text(span.text);
    words.latex += span.face == Face::bold          ? fmt::format("\\textbf{{{}}}", written)
                   : span.face >= Face::math_italic ? fmt::format("\\textit{{{}}}", written)
                                                    : written;
  }
  return words;
}

std::string latex_with_mark(std::string_view latex, std::string_view mark) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::string out;
  for (std::size_t i = 0; i < latex.size(); ++i) {
    const bool point =
        latex[i] == '.' && i > 0 && i + 1 < latex.size() && digit(latex[i - 1]) && digit(latex[i + 1]);
    if (point)
      out += mark == "," ? "{,}" : mark;  // no list
    else
      out += latex[i];
  }
  return out;
}

}  // namespace obscura::draw
