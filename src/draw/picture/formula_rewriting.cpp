// Formulas made of others, as text: with a vector, with a number, as plain words.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "draw/picture/formula.h"
#include "draw/picture/formula_text.h"

namespace obscura::draw {
namespace {

// whether a letter follows, or a command that stands for one
bool begins_factor(std::string_view text) {
  if (text.empty() || text[0] != '\\') return !text.empty() && formulas::latin(text[0]);
  const auto end = std::find_if_not(text.begin() + 1, text.end(), formulas::latin);
  const std::string_view word(text.begin() + 1, end);
  const formulas::Name* name = formulas::entry(formulas::kNames, word);
  return (name && formulas::italic(name->symbol)) || formulas::among(formulas::kAccents, word) ||
         formulas::among(formulas::kFunctions, word) || formulas::among(formulas::kForms, word);
}

}  // namespace

std::string as_vector(const std::string& text) {
  const auto letters = std::find_if_not(text.begin(), text.end(), formulas::latin) - text.begin();
  if (letters != 1 || text.find('*') != text.npos || text.find('$') != text.npos) return text;
  // behind its scripts: what it is multiplied by
  std::size_t next = 1;
  while (next < text.size() && std::string_view("_^'").find(text[next]) != std::string_view::npos)
    if (text[next++] != '\'') formulas::argument(text, next, false);
  next = std::min(text.find_first_not_of(' ', next), text.size());
  const std::string_view rest = std::string_view(text).substr(next);
  if (begins_factor(rest)) return text;
  std::string vector = "*";
  vector.append(text, 0, 1).append("*").append(text, 1);
  return vector;
}

std::string with_number(const std::string& text, int number) {
  const auto begin = text.begin();
  std::size_t end = 0;
  if (!text.empty() && text[0] == '\\') {
    end = std::size_t(std::find_if_not(begin + 1, text.end(), formulas::latin) - begin);
    const formulas::Name* name = formulas::entry(formulas::kNames, std::string_view(text).substr(1, end - 1));
    if (!name || !formulas::italic(name->symbol)) return text;
  } else {
    end = std::size_t(std::find_if_not(begin, text.end(), formulas::latin) - begin);
    if (end != 1) return text;
  }
  // its scripts, the subscript with the number
  std::string scripts;
  bool put = false;
  std::size_t next = end;
  while (next < text.size() && std::string_view("_^'").find(text[next]) != std::string_view::npos) {
    const std::size_t from = next++;
    if (text[from] != '\'') formulas::argument(text, next, false);
    std::string script = text.substr(from, next - from);
    if (text[from] == '_' && !put) {
      const std::string_view its = std::string_view(script).substr(1);
      const bool braced = its.starts_with('{') && its.ends_with('}');
      script = fmt::format("_{{{}{}}}", braced ? its.substr(1, its.size() - 2) : its, number), put = true;
    }
    scripts += script;
  }
  if (!put) scripts = fmt::format("_{{{}}}", number) + scripts;
  return text.substr(0, end) + scripts + text.substr(next);
}

std::string as_words(const std::string& text) {
  if (text.find_first_of("=_^\\$*{}<>+'\"") != text.npos) return text;
  // words of three letters or more, or one alone
  std::size_t longest = 0, letters = 0, words = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = std::min(formulas::length_of(text[i]), text.size() - i);
    if (formulas::letter(std::string_view(text).substr(i, n)))
      words += letters++ == 0, longest = std::max(longest, letters);
    else
      letters = 0;
    i += n;
  }
  const bool plain = longest >= formulas::kWord || (words == 1 && longest > 1);
  return plain ? '"' + text + '"' : text;
}

}  // namespace obscura::draw
