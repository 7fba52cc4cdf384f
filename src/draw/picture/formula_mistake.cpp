// What is wrong with a formula: names that are not known, and what is not whole. It is read as formula.cpp
// sets it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "draw/picture/formula.h"
#include "draw/picture/formula_text.h"
#include "draw/picture/formula_values.h"

namespace obscura::draw {
namespace {

// how many letters two words differ by, swaps counted once
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t k = 0; k <= b.size(); ++k) {
      if (i == 0 || k == 0) {
        d[i][k] = i + k;
        continue;
      }
      d[i][k] = std::min({d[i - 1][k] + 1, d[i][k - 1] + 1, d[i - 1][k - 1] + (a[i - 1] != b[k - 1])});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
        d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
    }
  return d[a.size()][b.size()];
}

// the known command that is most like a word
std::string nearest(std::string_view word) {
  std::string best;
  std::size_t least = 3;
  const auto offer = [&](std::string_view name) {
    if (const std::size_t d = distance(word, name); d < least && d < name.size()) least = d, best = name;
  };
  for (const formulas::Name& each : formulas::kNames) offer(each.word);
  for (const formulas::Name& each : formulas::kLarge) offer(each.word);
  for (const auto each : formulas::kFunctions) offer(each);
  for (const auto each : formulas::kAccents) offer(each);
  for (const auto each : formulas::kForms) offer(each);
  return best;
}

/// What a command needs, and how it is written.
struct Need {
  std::string_view words, example;
};
Need need_of(std::string_view word) {
  if (formulas::fraction(word)) return {"what stands above and below", "{1}{2}"};
  if (word == "sqrt") return {"what stands under it", "{2gh}"};
  if (word == "overline") return {"what stands under it", "{AB}"};
  if (word == "operatorname") return {"its name", "{div}"};
  if (word == "text" || word == "mathrm") return {"its words", "{at rest}"};
  return {"its letter", "{v}"};
}

// what TOML made of a command in double quotes whose backslash is written once: "\theta" is a tab and "heta"
std::optional<FormulaMistake> escaped_command(std::string_view text, std::size_t i) {
  static constexpr std::string_view kCharacters = "\b\t\n\f\r", kLetters = "btnfr";
  static constexpr std::array kNames = {"backspace", "tab", "line break", "form feed", "carriage return"};
  const std::size_t which = kCharacters.find(text[i]);
  if (which == kCharacters.npos) return {};
  std::size_t to = i + 1;
  while (to < text.size() && formulas::latin(text[to])) ++to;
  const std::string word = kLetters[which] + std::string(text.substr(i + 1, to - i - 1));
  if (word.size() < 2 || !formulas::known(word)) return {};
  return FormulaMistake{i + 1,
                        fmt::format("in double quotes '\\{}' begins with a {}: write '\\\\{}', or put the "
                                    "text in single quotes",
                                    word, kNames[which], word)};
}

/// Reads mathematics, all of it or a part that has to be whole.
class FormulaReader {
 public:
  FormulaReader(std::string_view text, bool latex) : text_(text), latex_(latex) {}

  std::optional<FormulaMistake> read(std::size_t begin, std::size_t end) {
    std::vector<std::size_t> lefts;  // brackets that are open
    std::size_t star = text_.npos;   // where a vector begins
    for (std::size_t i = begin; i < end && !wrong_;) {
      const char c = text_[i];
      const std::size_t from = i++;
      if (c == '"') {
        i = text_.find('"', i);
        if (i >= end) return at(from, "'\"' without another that ends the words");
        ++i;
      } else if (c == '*') {
        star = star == text_.npos ? from : text_.npos;
      } else if (c == '^' || c == '_') {
        script(from, i, end);
      } else if (c == '{') {
        i = formulas::closing(text_.substr(0, end), from);
        if (i == text_.npos) return at(from, "'{' without a '}' that closes it");
        within(from + 1, i++);
      } else if (c == '}') {
        return at(from, "'}' without a '{' that it closes");
      } else if (c == '\\') {
        command(from, i, end, lefts);
      } else if (const auto escaped = escaped_command(text_, from)) {
        return escaped;
      }
    }
    if (wrong_) return wrong_;
    if (!lefts.empty()) return at(lefts.back(), "'\\left' without its '\\right'");
    if (star != text_.npos)
      return at(star, "'*' without another: a vector stands between two, and a product is '\\cdot'");
    return {};
  }

 private:
  std::optional<FormulaMistake> at(std::size_t i, std::string what) {
    if (!wrong_) wrong_ = FormulaMistake{i + 1, std::move(what)};
    return wrong_;
  }
  void within(std::size_t begin, std::size_t end) {
    if (auto wrong = FormulaReader(text_, latex_).read(begin, end); wrong && !wrong_) wrong_ = wrong;
  }
  void skip(std::size_t& i, std::size_t end) const {
    while (i < end && text_[i] == ' ') ++i;
  }

  // an argument at i, which goes on behind it: whether there is one
  bool argument(std::size_t& i, std::size_t end, bool words = false) {
    if (latex_) skip(i, end);
    static constexpr std::string_view kNone = " }^_$";
    if (i >= end || kNone.find(text_[i]) != kNone.npos) return false;
    const std::size_t from = i;
    if (text_[i] == '{' && formulas::closing(text_.substr(0, end), i) == text_.npos) {
      at(i, "'{' without a '}' that closes it");
      return true;
    }
    const std::string_view got = formulas::argument(text_.substr(0, end), i, latex_);
    const bool braces = text_[from] == '{';
    // the place of a value needs braces of its own
    const auto slot = value_slot(text_.substr(from, i - from));
    if (got.empty() || (braces && slot && slot->begin == 0)) return false;
    if (words || got == "*") return true;
    if (!braces && got[0] == '\\' && takes_argument(got.substr(1)))
      at(from, fmt::format("'{}' needs braces here: '{{{}{}}}'", got, got, need_of(got.substr(1)).example));
    else
      within(from + (braces ? 1 : 0), i - (braces ? 1 : 0));
    return true;
  }
  static bool takes_argument(std::string_view word) {
    return formulas::among(formulas::kAccents, word) ||
           (formulas::among(formulas::kForms, word) && word != "left" && word != "right");
  }

  void script(std::size_t from, std::size_t& i, std::size_t end) {
    if (argument(i, end)) return;
    if (text_[from] == '^')
      at(from, "'^' without what it raises, as in 'x^2' or 'x^{ab}'");
    else
      at(from, "'_' without what it lowers, as in 'x_1' or 'x_{ab}'");
  }

  void command(std::size_t from, std::size_t& i, std::size_t end, std::vector<std::size_t>& lefts) {
    while (i < end && formulas::latin(text_[i])) ++i;
    const std::string_view word = text_.substr(from + 1, i - from - 1);
    if (word.empty()) {
      if (i >= end) at(from, "'\\' without a command behind it");
      i += i < end;
    } else if (!formulas::known(word)) {
      std::string what = fmt::format("unknown command '\\{}'", word);
      if (const std::string near = nearest(word); !near.empty())
        what += fmt::format("; did you mean '\\{}'?", near);
      at(from, std::move(what));
    } else if (word == "left" || word == "right") {
      skip(i, end);
      const std::string_view sign = formulas::bracket(text_.substr(0, end), i);
      if (sign.empty())
        at(from, fmt::format("'\\{}' without a bracket behind it, as in '\\left( x \\right)'", word));
      i += sign.size();
      if (word == "left")
        lefts.push_back(from);
      else if (lefts.empty())
        at(from, "'\\right' without its '\\left'");
      else
        lefts.pop_back();
    } else if (takes_argument(word)) {
      skip(i, end);
      if (word == "sqrt" && i < end && text_[i] == '[') {
        const std::size_t close = text_.find(']', i);
        if (close >= end) {
          at(i, "'[' without a ']' that closes it");
          return;
        }
        within(i + 1, close), i = close + 1;
      }
      const bool words = word == "text" || word == "mathrm" || word == "mathit" || word == "operatorname";
      bool whole = argument(i, end, words);
      if (whole && formulas::fraction(word)) skip(i, end), whole = argument(i, end);
      if (!whole) {
        const Need need = need_of(word);
        at(from, fmt::format("'\\{}' needs {}: '\\{}{}'", word, need.words, word, need.example));
      }
    }
  }

  std::string_view text_;
  bool latex_;
  std::optional<FormulaMistake> wrong_;
};

// a command where words stand, which would be shown as it is written
std::optional<FormulaMistake> command_in_words(std::string_view text, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i + 1 < end; ++i) {
    if (const auto escaped = escaped_in_words(text, i)) return escaped;
    if (text[i] != '\\' || !formulas::latin(text[i + 1])) continue;
    std::size_t to = i + 1;
    while (to < end && formulas::latin(text[to])) ++to;
    return FormulaMistake{i + 1, fmt::format("'{}' stands outside of the dollars: mathematics is between two",
                                             text.substr(i, to - i))};
  }
  return {};
}

// counted in characters, not in bytes
std::optional<FormulaMistake> in_characters(std::optional<FormulaMistake> found, std::string_view text) {
  if (found)
    found->column =
        1 + std::size_t(std::count_if(text.begin(), text.begin() + std::ptrdiff_t(found->column - 1),
                                      [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  return found;
}

}  // namespace

std::optional<FormulaMistake> escaped_in_words(std::string_view words, std::size_t i) {
  return words[i] == '\n' ? std::nullopt : escaped_command(words, i);
}

std::optional<FormulaMistake> mistake(std::string_view text) {
  if (formulas::dollar(text, 0) == text.npos)
    return in_characters(FormulaReader(text, false).read(0, text.size()), text);
  bool inside = false;
  for (std::size_t i = 0; i <= text.size(); inside = !inside) {
    const std::size_t end = std::min(formulas::dollar(text, i), text.size());
    if (inside && end == text.size())
      return in_characters(
          FormulaMistake{i, "'$' without another that ends the mathematics; '\\$' is a dollar"}, text);
    const auto wrong = inside ? FormulaReader(text, true).read(i, end) : command_in_words(text, i, end);
    if (wrong) return in_characters(wrong, text);
    i = end + 1;
  }
  return {};
}

}  // namespace obscura::draw
