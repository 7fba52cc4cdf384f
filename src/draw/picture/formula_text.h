#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace obscura::draw::formulas {

// The language of formulas (formula.h): its names, and how its text is taken apart.

struct Name {
  std::string_view word, symbol;
};

inline constexpr Name kNames[] = {
    {"alpha", "α"},      {"beta", "β"},       {"gamma", "γ"},     {"delta", "δ"},      {"epsilon", "ε"},
    {"varepsilon", "ε"}, {"zeta", "ζ"},       {"eta", "η"},       {"theta", "θ"},      {"vartheta", "ϑ"},
    {"iota", "ι"},       {"kappa", "κ"},      {"lambda", "λ"},    {"mu", "μ"},         {"nu", "ν"},
    {"xi", "ξ"},         {"pi", "π"},         {"rho", "ρ"},       {"sigma", "σ"},      {"tau", "τ"},
    {"upsilon", "υ"},    {"phi", "φ"},        {"varphi", "φ"},    {"chi", "χ"},        {"psi", "ψ"},
    {"omega", "ω"},      {"Gamma", "Γ"},      {"Delta", "Δ"},     {"Theta", "Θ"},      {"Lambda", "Λ"},
    {"Xi", "Ξ"},         {"Pi", "Π"},         {"Sigma", "Σ"},     {"Phi", "Φ"},        {"Psi", "Ψ"},
    {"Omega", "Ω"},      {"perp", "⊥"},       {"times", "×"},     {"cdot", "·"},       {"pm", "±"},
    {"mp", "∓"},         {"div", "÷"},        {"le", "≤"},        {"leq", "≤"},        {"ge", "≥"},
    {"geq", "≥"},        {"ne", "≠"},         {"neq", "≠"},       {"ll", "≪"},         {"gg", "≫"},
    {"approx", "≈"},     {"sim", "∼"},        {"propto", "∝"},    {"equiv", "≡"},      {"infty", "∞"},
    {"to", "→"},         {"rightarrow", "→"}, {"leftarrow", "←"}, {"Rightarrow", "⇒"}, {"circ", "°"},
    {"deg", "°"},        {"degree", "°"},     {"prime", "′"},     {"parallel", "∥"},   {"partial", "∂"},
    {"nabla", "∇"},      {"hbar", "ħ"},       {"ell", "ℓ"},       {"dots", "…"},       {"ldots", "…"},
    {"cdots", "⋯"},      {"in", "∈"},         {"langle", "⟨"},    {"rangle", "⟩"},     {"quad", "  "},
};
/// Signs that are larger than letters; a sum's limits stand below and above it, an integral's beside it.
inline constexpr Name kLarge[] = {{"sum", "∑"}, {"prod", "∏"}, {"int", "∫"}, {"oint", "∮"}};
inline constexpr std::string_view kFunctions[] = {"sin",    "cos",  "tan",  "cot",  "arcsin", "arccos",
                                                  "arctan", "sinh", "cosh", "tanh", "log",    "ln",
                                                  "exp",    "min",  "max",  "lim",  "det",    "sgn"};
inline constexpr std::string_view kAccents[] = {"bar", "vec", "dot", "ddot", "hat", "tilde"};
inline constexpr std::string_view kForms[] = {"frac",   "dfrac",  "tfrac",      "sqrt",        "text",
                                              "mathrm", "mathbf", "boldsymbol", "bm",          "mathit",
                                              "left",   "right",  "overline",   "operatorname"};

/// The three that are a fraction.
inline bool fraction(std::string_view word) { return word == "frac" || word == "dfrac" || word == "tfrac"; }

inline const Name* entry(std::span<const Name> names, std::string_view word) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const Name& each) { return each.word == word; });
  return found == names.end() ? nullptr : &*found;
}

inline bool among(std::span<const std::string_view> words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

inline bool known(std::string_view word) {
  return entry(kNames, word) || entry(kLarge, word) || among(kFunctions, word) || among(kAccents, word) ||
         among(kForms, word);
}

/// So many letters together are a word, and upright.
inline constexpr int kWord = 3;

inline bool latin(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// Greek small letters are italic, as Latin ones are.
inline bool italic(std::string_view c) {
  if (c.size() == 1) return latin(c[0]);
  constexpr std::string_view small[] = {"α", "β", "γ", "δ", "ε", "ζ", "η", "θ", "κ", "λ", "μ", "ν",
                                        "ξ", "π", "ρ", "σ", "τ", "φ", "χ", "ψ", "ω", "ϵ", "ϕ"};
  return among(small, c);
}

/// Bytes of the UTF-8 character that begins with `first`.
inline std::size_t length_of(char first) {
  const auto c = static_cast<unsigned char>(first);
  return c < 0x80 ? 1 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : 4;
}

/// A letter of Latin: also one with an accent, but neither a sign nor a Greek letter.
inline bool letter(std::string_view c) {
  if (c.size() == 1) return latin(c[0]);
  const auto first = static_cast<unsigned char>(c[0]);
  return c.size() == 2 && first >= 0xC3 && first <= 0xC9 && c != "×" && c != "÷";
}

/// Where a word that begins at text[i] ends, and how many letters it has.
inline std::pair<std::size_t, int> word(std::string_view text, std::size_t i) {
  int letters = 0;
  while (i < text.size()) {
    const std::size_t n = std::min(length_of(text[i]), text.size() - i);
    if (!letter(text.substr(i, n))) break;
    i += n, ++letters;
  }
  return {i, letters};
}

inline constexpr std::string_view kUnits[] = {"m",  "mm", "cm", "km", "s",  "ms", "g",  "kg",  "N",
                                              "kN", "J",  "kJ", "W",  "kW", "Hz", "Pa", "rad", "Nm"};

/// Where the units end that stand at text[i], a space after a number: "9.81 m/s^2". Where a letter follows
/// them it is a product ("2 m v"), as is "2 g": i.
inline std::size_t units_end(std::string_view text, std::size_t i) {
  const auto digit = [&](std::size_t k) { return text[k] >= '0' && text[k] <= '9'; };
  if (i < 2 || text[i - 1] != ' ' || !(digit(i - 2) || text[i - 2] == '\x02')) return i;
  if (text.substr(i, 1) == "g" && word(text, i).second == 1) return i;
  for (std::size_t k = i;;) {
    const std::size_t end = word(text, k).first;
    if (end == k || !among(kUnits, text.substr(k, end - k))) return i;
    k = end;
    if (k + 1 < text.size() && text[k] == '^' && digit(k + 1)) k += 2;
    if (text.substr(k).starts_with("²")) k += 2;
    const std::size_t next = std::min(text.find_first_not_of(' ', k), text.size());
    if (next < text.size() && text[next] == '/') {
      k = next + 1;
    } else if (next > k && word(text, next).second > 0) {
      k = next;
    } else {
      return next < text.size() && (text[next] == '\\' || text[next] == '{' || text[next] == '_') ? i : k;
    }
  }
}

/// Where the brace at i is closed; "\{" and "\}" are signs.
inline std::size_t closing(std::string_view text, std::size_t i) {
  std::size_t depth = 0;
  for (; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
      continue;
    }
    if (text[i] == '{') ++depth;
    if (text[i] == '}' && --depth == 0) return i;
  }
  return text.npos;
}

/// The argument of a script or an accent at text[i], which goes on behind it: {...}, or one symbol. Where
/// spaces count (not `latex`), a word is one.
inline std::string_view argument(std::string_view text, std::size_t& i, bool latex) {
  while (latex && i < text.size() && text[i] == ' ') ++i;
  if (i < text.size() && text[i] == '{') {
    const std::size_t from = i + 1, end = std::min(closing(text, i), text.size());
    i = std::min(end + 1, text.size());
    return text.substr(from, end - from);
  }
  const std::size_t from = i;
  if (i < text.size() && text[i] == '\\') {
    ++i;
    while (i < text.size() && latin(text[i])) ++i;
    if (i == from + 1 && i < text.size()) ++i;  // "\{"
  } else if (i < text.size() && text[i] == '"') {
    i = std::min(text.find('"', i + 1), text.size() - 1) + 1;  // v_"max"
  } else if (i < text.size() && latin(text[i]) && latex) {
    ++i;
  } else if (const std::size_t end = word(text, i).first; end > i) {
    i = end;  // "v_center"
  } else if (i < text.size()) {
    i = std::min(i + length_of(text[i]), text.size());
  }
  return text.substr(from, i - from);
}

/// Where the next dollar is that begins or ends mathematics: "\$" is a sign. None: npos.
inline std::size_t dollar(std::string_view text, std::size_t i) {
  for (; i < text.size(); ++i) {
    if (text[i] == '$') return i;
    if (text[i] == '\\') ++i;
  }
  return text.npos;
}

/// Plain words as they are shown: "\$" is a dollar.
inline std::string plain(std::string_view words) {
  std::string shown(words);
  for (std::size_t at = shown.find("\\$"); at != shown.npos; at = shown.find("\\$", at)) shown.erase(at++, 1);
  return shown;
}

/// The bracket at text[i], behind \left or \right: "(", "\{", "\langle", "." for none. Empty: there is none.
inline std::string_view bracket(std::string_view text, std::size_t i) {
  static constexpr std::string_view kBrackets[] = {"(", ")",   "[",   "]",   "|",        "/",
                                                   ".", "\\|", "\\{", "\\}", "\\langle", "\\rangle",
                                                   "⟨", "⟩",   "<",   ">",   "‖"};
  for (const std::string_view each : kBrackets)
    if (text.substr(std::min(i, text.size())).starts_with(each)) return each;
  return {};
}

/// Where the \right is that belongs to a \left before text[i]. None: npos.
inline std::size_t right_of(std::string_view text, std::size_t i) {
  std::size_t depth = 0;
  while (i < text.size()) {
    if (text[i] != '\\') {
      ++i;
      continue;
    }
    const std::size_t from = i++;
    while (i < text.size() && latin(text[i])) ++i;
    const std::string_view command = text.substr(from + 1, i - from - 1);
    if (command.empty()) ++i;
    if (command == "left") ++depth;
    if (command == "right" && depth-- == 0) return from;
  }
  return text.npos;
}

}  // namespace obscura::draw::formulas
