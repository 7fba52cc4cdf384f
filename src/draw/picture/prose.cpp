#include "draw/picture/prose.h"

#include <algorithm>
#include <array>
#include <utility>

#include "draw/picture/formula_text.h"
#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

constexpr double kBeside = 1.1;  // size of mathematics beside words: its letters are lower

bool space(char c) { return c == ' ' || c == '\n' || c == '\t'; }
bool numeral(char c) { return c >= '0' && c <= '9'; }

/// Signs of scripts that have characters of their own.
constexpr std::array<std::pair<char, std::string_view>, 14> kRaised{{{'0', "⁰"},
                                                                     {'1', "¹"},
                                                                     {'2', "²"},
                                                                     {'3', "³"},
                                                                     {'4', "⁴"},
                                                                     {'5', "⁵"},
                                                                     {'6', "⁶"},
                                                                     {'7', "⁷"},
                                                                     {'8', "⁸"},
                                                                     {'9', "⁹"},
                                                                     {'+', "⁺"},
                                                                     {'-', "⁻"},
                                                                     {'n', "ⁿ"},
                                                                     {'i', "ⁱ"}}};
constexpr std::array<std::pair<char, std::string_view>, 12> kLowered{{{'0', "₀"},
                                                                      {'1', "₁"},
                                                                      {'2', "₂"},
                                                                      {'3', "₃"},
                                                                      {'4', "₄"},
                                                                      {'5', "₅"},
                                                                      {'6', "₆"},
                                                                      {'7', "₇"},
                                                                      {'8', "₈"},
                                                                      {'9', "₉"},
                                                                      {'+', "₊"},
                                                                      {'-', "₋"}}};
/// Accents as characters that combine, in the order of formulas::kAccents.
constexpr std::string_view kCombining[] = {"\u0304", "\u20D7", "\u0307", "\u0308", "\u0302", "\u0303"};

std::string script(const std::string& text, auto& signs, const char* otherwise) {
  std::string all;
  for (const char c : text) {
    const auto found =
        std::find_if(signs.begin(), signs.end(), [&](const auto& each) { return each.first == c; });
    if (found == signs.end())
      return otherwise + (text.size() > 1 && otherwise[0] == '^' ? "(" + text + ")" : text);
    all += found->second;
  }
  return all;
}

/// Reads a formula and writes letters.
class Speller {
 public:
  explicit Speller(bool latex) : latex_(latex) {}

  std::string spell(std::string_view text) const {
    std::string all;
    for (std::size_t i = 0; i < text.size();) {
      const char c = text[i];
      if (c == '_' || c == '^') {
        const std::string inner = spell(formulas::argument(text, ++i, latex_));
        all += c == '^' ? script(inner, kRaised, "^") : script(inner, kLowered, "_");
      } else if (c == '\\') {
        all += command(text, ++i, all);
      } else if (c == '\'') {
        all += "′", ++i;
      } else {
        if (c != '{' && c != '}' && c != '*' && c != '"' && c != '$' && c != '~') all += c;
        ++i;
      }
    }
    return all;
  }

 private:
  bool latex_;

  // in brackets, unless it is one number or one name
  std::string factor(std::string_view text) const {
    std::string inner = spell(text);
    return one(inner) ? inner : "(" + inner + ")";
  }

  // "12.5", "θ", "v₀", "E_kin"
  static bool one(std::string_view letters) {
    const std::size_t number = letters.find_first_not_of("0123456789.");
    if (number == letters.npos) return true;
    if (number > 0) return false;
    const auto character = [&](std::size_t at) {
      std::size_t end = at + 1;
      while (end < letters.size() && (static_cast<unsigned char>(letters[end]) & 0xC0) == 0x80) ++end;
      return letters.substr(at, end - at);
    };
    const auto beside = [](std::string_view one) {
      const auto is = [&](const auto& each) { return each.second == one; };
      return std::any_of(kRaised.begin(), kRaised.end(), is) ||
             std::any_of(kLowered.begin(), kLowered.end(), is) ||
             std::find(std::begin(kCombining), std::end(kCombining), one) != std::end(kCombining);
    };
    std::size_t at = character(0).size();
    while (at < letters.size() && beside(character(at))) at += character(at).size();
    return at == letters.size() ||
           (letters[at] == '_' && letters.find_first_of(" +-/=^", at) == letters.npos);
  }

  std::string command(std::string_view text, std::size_t& i, const std::string& before) const {
    const std::size_t from = i;
    while (i < text.size() && formulas::latin(text[i])) ++i;
    const std::string_view word = text.substr(from, i - from);
    if (word.empty()) {
      if (i >= text.size()) return "";
      const char c = text[i++];
      return c == ',' || c == ':' || c == ';' || c == ' ' ? " " : c == '!' ? "" : std::string(1, c);
    }
    const auto skip = [&] {
      while (i < text.size() && text[i] == ' ') ++i;
    };
    const auto next = [&] {
      skip();
      return formulas::argument(text, i, latex_);
    };
    if (formulas::among(formulas::kAccents, word)) {
      const auto which = std::find(std::begin(formulas::kAccents), std::end(formulas::kAccents), word) -
                         std::begin(formulas::kAccents);
      return spell(next()) + std::string(kCombining[which]);
    }
    if (word == "overline") {
      const std::string under = spell(next());
      return under.size() == 1 ? under + std::string(kCombining[0]) : under;
    }
    if (formulas::fraction(word)) {
      const std::string above = factor(next()), below = factor(next());
      return above == "1" && below == "2" ? "½" : above + "/" + below;
    }
    if (word == "sqrt") {
      skip();
      std::string index;
      if (i < text.size() && text[i] == '[')
        if (const std::size_t end = text.find(']', i); end != text.npos)
          index = spell(text.substr(i + 1, end - i - 1)), i = end + 1;
      return script(index, kRaised, "") + "√" + factor(next());
    }
    if (word == "left" || word == "right") {
      if (i < text.size() && text[i] == '.') ++i;  // no bracket
      return "";
    }
    if (formulas::among(formulas::kForms, word)) return spell(next());
    if (const formulas::Name* sign = formulas::entry(formulas::kLarge, word))
      return std::string(sign->symbol);
    if (const formulas::Name* name = formulas::entry(formulas::kNames, word))
      return std::string(name->symbol);
    return (before.empty() || space(before.back()) ? "" : " ") + std::string(word);
  }
};

}  // namespace

std::vector<Phrase> phrases(std::string_view words) {
  std::vector<Phrase> all;
  std::size_t plain = 0;
  const auto dollar = [&](std::size_t from) { return formulas::dollar(words, from); };
  for (std::size_t open = dollar(0); open != words.npos; open = dollar(open)) {
    std::size_t close = words.npos;
    if (open + 1 < words.size() && !space(words[open + 1]))
      for (close = dollar(open + 1); close != words.npos; close = dollar(close + 1))
        if (close > open + 1 && !space(words[close - 1]) &&
            (close + 1 == words.size() || !numeral(words[close + 1])))
          break;
    if (close == words.npos) {
      ++open;
      continue;
    }
    if (open > plain) all.push_back({words.substr(plain, open - plain), false, plain});
    all.push_back({words.substr(open + 1, close - open - 1), true, open + 1});
    open = plain = close + 1;
  }
  if (plain < words.size()) all.push_back({words.substr(plain), false, plain});
  return all;
}

bool contains_mathematics(std::string_view words) {
  if (formulas::dollar(words, 0) == words.npos) return false;
  const std::vector<Phrase> all = phrases(words);
  return std::any_of(all.begin(), all.end(), [](const Phrase& phrase) { return phrase.mathematics; });
}

std::optional<FormulaMistake> prose_mistake(std::string_view words) {
  const auto characters = [&](std::size_t bytes) {
    return std::size_t(std::count_if(words.begin(), words.begin() + std::ptrdiff_t(bytes),
                                     [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  };
  for (const Phrase& phrase : phrases(words)) {
    if (phrase.mathematics) {
      if (auto wrong = mistake("$" + std::string(phrase.text) + "$")) {
        wrong->column += characters(phrase.begin) - 1;
        return wrong;
      }
      continue;
    }
    for (std::size_t i = 0; i < phrase.text.size(); ++i)
      if (auto wrong = escaped_in_words(phrase.text, i)) {
        wrong->column = characters(phrase.begin + i) + 1;
        return wrong;
      }
    if (const std::size_t open = formulas::dollar(phrase.text, 0); open != words.npos) {
      // no money: a command follows
      for (std::size_t i = open; i + 1 < phrase.text.size(); ++i)
        if (phrase.text[i] == '\\' && formulas::latin(phrase.text[i + 1]))
          return FormulaMistake{characters(phrase.begin + open) + 1,
                                "'$' without another that ends the mathematics; '\\$' is a dollar"};
    }
  }
  return {};
}

Formula prose(std::string_view words, Face face, double size, Color color) {
  Formula all;
  all.size = size, all.color = color, all.source = words;
  for (const Phrase& phrase : phrases(words)) {
    Formula part;
    if (phrase.mathematics) {
      part = formula("$" + std::string(phrase.text) + "$", kBeside * size, color);
    } else {
      part.size = size, part.color = color, part.source = phrase.text;
      part.spans.push_back(
          {.text = formulas::plain(phrase.text), .face = face, .size = size, .color = color});
      part.width = shape({{0, 0}, Align::left, part.spans}).width;
      part.ascent = 0.74 * size, part.descent = 0.22 * size;
    }
    all.ascent = std::max(all.ascent, part.ascent), all.descent = std::max(all.descent, part.descent);
    all.places.emplace_back(all.width, 0);
    all.width += part.width;
    all.parts.push_back(std::move(part));
  }
  return all;
}

void add_prose(const std::string& words, Face face, double size, Color color, const Point& at, Align align,
               List& list) {
  if (!contains_mathematics(words)) {
    list.add(Text{at, align, {{.text = formulas::plain(words), .face = face, .size = size, .color = color}}});
    return;
  }
  const Formula set = prose(words, face, size, color);
  add(set, align == Align::center ? Point(at.x() - set.width / 2, at.y()) : at, list);
}

std::string in_letters(std::string_view words) {
  std::string all;
  for (const Phrase& phrase : phrases(words))
    all += phrase.mathematics ? Speller(true).spell(phrase.text) : formulas::plain(phrase.text);
  return all;
}

std::string formula_in_letters(std::string_view text) { return Speller(false).spell(text); }

}  // namespace obscura::draw
