#include "scene/document.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "scene/complaints.h"
#include "scene/input.h"
#include "scene/utf8.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostBytes = std::size_t(16) << 20;
constexpr const char* kCalculated = "a value is a number, not a calculation: 0.5, not 1/2";
constexpr std::size_t kLongestEscape = 24;  // bytes of a word of mathematics, of a unit
constexpr int kDeepest =
    64;  // nested lists and tables, and parts of a dotted key: the parser recurses over both

[[noreturn]] void refuse(const std::string& file, int line, int column, std::string message) {
  throw Error({Complaint{file, line, column, std::move(message)}});
}

// the place of a byte, counted as the parser does: lines by \n, columns by code points
struct Cursor {
  int line = 1, column = 1;
  void pass(unsigned char c) {
    if (c == '\n') {
      ++line, column = 1;
    } else if ((c & 0xC0) != 0x80) {
      ++column;
    }
  }
};

void refuse_what_is_not_text(std::string_view text, const std::string& file) {
  Cursor here;
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if ((c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F)
      refuse(file, here.line, here.column,
             fmt::format("a control byte (0x{:02X}) has no place in a scene; is this a text file?", c));
    const std::size_t bytes = code_point(text.substr(i));
    if (bytes == 0)
      refuse(file, here.line, here.column,
             fmt::format("the byte 0x{:02X} is not UTF-8; save the file as UTF-8", c));
    here.pass(c);
    i += bytes;
  }
}

// counts what the parser would recurse over: brackets open at once, and dots in one key
void refuse_what_is_too_deep(std::string_view text, const std::string& file) {
  Cursor here;
  int depth = 0, dots = 0;
  char quote = 0;        // in a string: its quote
  bool tripled = false;  // ... one of three
  const auto starts = [&](std::size_t i, char c) { return text.substr(i, 3) == std::string(3, c); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto skip = [&](int n) {
      for (; n > 0 && i + 1 < text.size(); --n) here.pass(static_cast<unsigned char>(text[i])), ++i;
    };
    if (quote) {
      if (c == '\\' && quote == '"') {
        skip(1);
      } else if (tripled ? starts(i, quote) : c == quote || c == '\n') {
        if (tripled) skip(2);
        // up to two more quotes belong to the string
        for (int more = 0; tripled && more < 2 && i + 1 < text.size() && text[i + 1] == quote; ++more)
          skip(1);
        quote = 0;
      }
    } else if (c == '"' || c == '\'') {
      quote = c, tripled = starts(i, c);
      if (tripled) skip(2);
    } else if (c == '#') {
      while (i + 1 < text.size() && text[i + 1] != '\n') skip(1);
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest)
        refuse(file, here.line, here.column,
               fmt::format("lists and tables are nested more than {} deep here", kDeepest));
      dots = 0;
    } else if (c == ']' || c == '}') {
      depth = std::max(0, depth - 1), dots = 0;
    } else if (c == '\n' || c == '=' || c == ',') {
      dots = 0;
    } else if (c == '.') {
      if (++dots >= kDeepest)
        refuse(file, here.line, here.column, fmt::format("a dotted key of more than {} parts", kDeepest));
    }
    here.pass(static_cast<unsigned char>(text[i]));
  }
}

Place place_of(const toml::source_region& region) {
  return {0, int(region.begin.line), int(region.begin.column)};
}

Node copied(const toml::node& from) {
  Node node;
  node.place = place_of(from.source());
  if (const auto* table = from.as_table()) {
    Node::Table entries;
    for (auto&& [key, value] : *table)
      entries.push_back({std::string(key.str()), place_of(key.source()), copied(value)});
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
    });
    node.header = !table->is_inline();
    node.value = std::move(entries);
  } else if (const auto* array = from.as_array()) {
    Node::List list;
    for (auto&& value : *array) list.push_back(copied(value));
    node.header = !list.empty() && list.front().is_table() && list.front().header;
    node.value = std::move(list);
  } else if (const auto* integer = from.as_integer()) {
    node.value = integer->get();
  } else if (const auto* real = from.as_floating_point()) {
    node.value = real->get();
  } else if (const auto* flag = from.as_boolean()) {
    node.value = flag->get();
  } else if (const auto* text = from.as_string()) {
    node.value = text->get();
    const auto& region = from.source();
    const auto points = std::count_if(text->get().begin(), text->get().end(),
                                      [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    if (region.begin.line == region.end.line &&
        std::ptrdiff_t(region.end.column) - std::ptrdiff_t(region.begin.column) == points + 2)
      node.inside = 1;
  } else {
    node.value = Node::Date{};
  }
  return node;
}

// the parser's first sentence says where it was, its second what it met
std::string lowered(std::string_view description) {
  std::string text(description);
  if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') text[0] = char(text[0] - 'A' + 'a');
  return text;
}

// a line from a column on
std::string_view from_column(std::string_view line, int column) {
  std::size_t i = 0;
  for (int at = 1; at < column && i < line.size(); ++at)
    i += std::max<std::size_t>(1, code_point(line.substr(i)));
  return line.substr(std::min(i, line.size()));
}

// signs of slides and word processors that look like those of a scene
std::string look_alike(std::string_view at) {
  for (const std::string_view sign : {"\u2212", "\u2013", "\u2014"})
    if (at.starts_with(sign)) return fmt::format("a minus is the - of the keyboard, not {}", sign);
  for (const std::string_view sign : {"\u201C", "\u201D", "\u201E", "\u00AB", "\u00BB", "\u2018", "\u2019"})
    if (at.starts_with(sign)) return fmt::format("quotes are straight: \"a\", not {}", sign);
  if (at.starts_with("(")) return "a list is in square brackets: [1, 2]";
  return {};
}

// what is wrong with a number, or between two, where the parser stopped behind `before`: at a sign, or where
// what it cannot read begins
std::string mistyped_number(std::string_view before, std::string_view at) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const std::size_t last = before.find_last_not_of(" \t");
  if (last == before.npos) return {};
  if (last > 0 && before[last] == '.' && digit(before[last - 1]))
    return "a number has a digit after its point: 3.0";
  const std::size_t end = std::min(at.find_first_not_of("0123456789._"), at.size());
  const bool begins =
      last + 1 < before.size() || before[last] == '=' || before[last] == '[' || before[last] == ',';
  if (begins && end > 0 && end < at.size() &&
      std::string_view("+*/^").find(at[end]) != std::string_view::npos)
    return kCalculated;
  if (at.empty() || !(digit(before[last]) || before[last] == ']')) return {};
  if (std::string_view("+-*/^").find(at[0]) != std::string_view::npos && last + 1 == before.size())
    return kCalculated;
  const auto opened = std::count(before.begin(), before.end(), '['),
             closed = std::count(before.begin(), before.end(), ']');
  if (opened > closed && last + 1 < before.size() && (digit(at[0]) || at[0] == '-' || at[0] == '['))
    return "the values of a list have commas between them: [1, 2]";
  return {};
}

// an escape of mathematics in double quotes, where the parser stopped in it: "\\alpha"
std::string escape(std::string_view line, int column, std::string_view description) {
  if (description.find("escape") == description.npos && description.find("unicode") == description.npos)
    return {};
  const std::string_view at = from_column(line, column);
  const std::size_t from = line.substr(0, std::min(line.size() - at.size() + 1, line.size())).rfind('\\');
  if (from == line.npos) return {};
  // two of them are one that is meant
  std::size_t run = 0;
  while (run <= from && line[from - run] == '\\') ++run;
  if (run % 2 == 0) return {};
  std::size_t end = from + 1;
  while (end < line.size() && std::isalpha(static_cast<unsigned char>(line[end])) != 0) ++end;
  const std::string_view word = line.substr(from + 1, end - from - 1);
  if (word.empty() || word.size() > kLongestEscape || word == "u" || word == "U") return {};
  return fmt::format(
      "in double quotes a \\ is written twice: write '\\\\{0}' for '\\{0}', or put the text in single quotes",
      word);
}

// a unit behind the number that a value begins with, blanks between them or not, where the parser stopped at
// it
std::string unit_behind(std::string_view before, std::string_view at) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  if (at.empty() || at[0] == '/' || before.find('=') == before.npos) return {};
  std::size_t end = 0;
  while (end < at.size() &&
         (letter(at[end]) || at[end] == '/' || static_cast<unsigned char>(at[end]) >= 0x80))
    ++end;
  std::string_view number = before.substr(0, before.find_last_not_of(" \t") + 1);
  if (end == 0 || number.empty() || !digit(number.back())) return {};
  number.remove_prefix(number.find_last_not_of("0123456789._+-eE") + 1);
  const std::string_view ahead = before.substr(0, std::size_t(number.data() - before.data()));
  if (number.empty() || end > kLongestEscape ||
      std::string_view(" \t=[,").find(ahead.back()) == std::string_view::npos)
    return {};
  const std::string_view word = at.substr(0, end),
                         rest = at.substr(std::min(at.find_first_not_of(" \t", end), at.size()));
  if (word == "true" || word == "false" || rest.starts_with('=')) return {};
  return fmt::format("a number has no unit, all are in m, kg, s and degrees; got {}{}",
                     before.substr(std::size_t(number.data() - before.data())), word);
}

// guesses what was forgotten at the place where the parser stopped: a quote, a bracket, or the quotes around
// a word; empty if none of these
std::string forgotten(std::string_view text, int line, int column, std::string_view description) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  if (line < 1 || line > int(lines.size())) return {};

  // quotes and brackets outside of strings and comments
  struct Count {
    bool quoted = false;
    int open = 0;
  };
  const auto count = [](std::string_view one) {
    Count sum;
    char quote = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      const char c = one[i];
      if (quote != 0) {
        if (c == '\\' && quote == '"')
          ++i;
        else if (c == quote)
          quote = 0;
        continue;
      }
      if (c == '#') break;
      if (c == '"' || c == '\'') quote = c;
      if (c == '[' || c == '{') ++sum.open;
      if (c == ']' || c == '}') --sum.open;
    }
    sum.quoted = quote != 0;
    return sum;
  };
  const std::string_view here = lines[line - 1];
  const std::size_t first = here.find_first_not_of(" \t"), equals = here.find('=');
  if (first == std::string_view::npos) return {};
  const std::string_view at = from_column(here, column);
  if (const std::string sign = escape(here, column, description); !sign.empty()) return sign;
  if (const std::string sign = look_alike(at); !sign.empty()) return sign;
  const std::string_view before = here.substr(0, here.size() - at.size());
  if (const std::string number = mistyped_number(before, at); !number.empty()) return number;
  if (const std::string unit = unit_behind(before, at); !unit.empty()) return unit;
  if (column >= 1 && column <= int(here.size()) && here[column - 1] == '.')
    return "a number has a digit before its point: 0.1";
  const auto digit_at = [&](int i) {
    return i >= 1 && i <= int(here.size()) && std::isdigit(static_cast<unsigned char>(here[i - 1])) != 0;
  };
  if (digit_at(column - 1) && digit_at(column + 1) && here[column - 1] == ',')
    return "a number has a point, not a comma: 0.1";
  if (count(here).quoted) return "a quote is opened here and not closed";
  if (here[first] == '[' && count(here).open != 0)
    return "a table's name closes as it opens: [room], [[box]]";

  // a bracket left open above
  int open = 0;
  for (int i = line - 1; i >= 1; --i) {
    open += count(lines[i - 1]).open;
    if (open > 0) return fmt::format("a bracket opened in line {} is not closed", i);
    if (lines[i - 1].find('=') != std::string_view::npos) break;
  }
  if (count(here).open > 0) return "a bracket is opened here and not closed";
  if (equals == std::string_view::npos) return "a key is given as key = value";
  const std::size_t value = here.find_first_not_of(" \t", equals + 1);
  if (value == std::string_view::npos || here[value] == '#') return "a value is missing after the =";
  if (std::isalpha(static_cast<unsigned char>(here[value]))) {
    std::string_view word = here.substr(value, here.find_first_of(" \t#", value) - value);
    std::string small(word);
    for (char& c : small) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (word != small && (small == "true" || small == "false"))
      return fmt::format("it is written {}, not {}", small, word);
    if (word != "true" && word != "false") return fmt::format("words go in quotes: \"{}\"", word);
  }
  return {};
}

std::string slurp(const std::string& file) {
  std::string text;
  try {
    Input in(file);
    // piece by piece: room for the longest would be cleared for each
    for (std::size_t piece = 1 << 14; text.size() <= kMostBytes; piece = text.size()) {
      const std::size_t there = text.size();
      text.resize(std::min(there + piece, kMostBytes + 1));
      in.read(text.data() + there, std::streamsize(text.size() - there));
      text.resize(there + std::size_t(in.gcount()));
      if (text.size() < there + piece) break;
    }
  } catch (const std::system_error& error) {
    refuse(file, 0, 0, "cannot be read: " + error.code().message());
  }
  if (text.size() > kMostBytes)
    refuse(file, 0, 0,
           fmt::format("is longer than {} MiB; copies say many bodies in one line", kMostBytes >> 20));
  return text;
}

std::string_view trimmed(std::string_view s) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!s.empty() && blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && blank(s.back())) s.remove_suffix(1);
  return s;
}

// a key as it means the same however it is typed: without blanks and quotes
std::string bare(std::string_view key) {
  std::string name;
  for (const char c : key)
    if (c != ' ' && c != '\t' && c != '"' && c != '\'') name += c;
  return name;
}

// the name in a table's header: "[look]", "[[ room.walls ]]"
std::string header_name(std::string_view line) {
  const std::size_t from = line.find_first_not_of("[ \t"), to = line.find(']');
  return from < to && to != line.npos ? bare(line.substr(from, to - from)) : std::string();
}

// a table or a key that is there already, and where; empty where the parser met something else
std::string repeated(std::string_view text, int line, std::string_view description) {
  const std::size_t at = description.find("cannot redefine existing "), open = description.find('\'', at),
                    close = description.rfind('\'');
  if (at == description.npos || open == description.npos || close == open) return {};
  std::vector<std::string_view> lines;
  for (std::size_t i = 0; i < text.size() && int(lines.size()) < line;) {
    const std::size_t end = std::min(text.find('\n', i), text.size());
    lines.push_back(trimmed(text.substr(i, end - i)));
    i = end + 1;
  }
  if (line < 1 || int(lines.size()) < line) return {};
  const std::string_view here = lines.back();
  const bool header = here.starts_with('[');
  const std::string name = header ? header_name(here) : bare(description.substr(open + 1, close - open - 1));
  const bool other_kind = description.substr(close).find(" as ") != description.npos;

  // the one before: the last key in the same table
  int first = 0;
  for (int i = line - 1; i >= 1 && first == 0; --i) {
    const std::string_view one = lines[std::size_t(i - 1)];
    if (one.starts_with('[')) {
      if (!header) break;
      if (header_name(one) == name) first = i;
    } else if (const std::size_t equals = one.find('='); equals != one.npos) {
      const std::string key = bare(one.substr(0, equals));
      if (key == name || key.starts_with(name + ".")) first = i;
    }
  }
  const std::string where = first > 0 ? fmt::format("; the first is in line {}", first) : "";
  if (!header) return fmt::format("{} is given a second time{}", scene::in_quotes(name), where);
  return fmt::format("{} is given a second time{}{}", one_line(here.substr(0, here.rfind(']') + 1)), where,
                     other_kind ? "" : ": put its keys together");
}

}  // namespace

double Node::number() const {
  return is_integer() ? double(std::get<std::int64_t>(value)) : std::get<double>(value);
}

const Node* Node::find(std::string_view key) const {
  if (!is_table()) return nullptr;
  for (const Entry& entry : table())
    if (entry.key == key) return &entry.node;
  return nullptr;
}

Node* Node::find(std::string_view key) { return const_cast<Node*>(std::as_const(*this).find(key)); }

std::string described(const Node& node) {
  if (node.is_integer()) return fmt::format("{}", std::get<std::int64_t>(node.value));
  if (node.is_number())
    return std::isfinite(node.number()) && node.number() == std::floor(node.number()) &&
                   std::abs(node.number()) < 1e15
               ? fmt::format("{:.1f}", node.number())
               : fmt::format("{}", node.number());
  if (const bool* flag = std::get_if<bool>(&node.value)) return *flag ? "true" : "false";
  if (node.is_text())
    return node.text().size() <= 40 ? fmt::format("the string \"{}\"", one_line(node.text())) : "a string";
  if (node.is_list()) return "a list";
  if (node.is_table()) return "a table";
  return "a date or time";
}

Node document(std::string_view text, const std::string& file) {
  if (text.size() > kMostBytes)
    refuse(file, 0, 0,
           fmt::format("is longer than {} MiB; copies say many bodies in one line", kMostBytes >> 20));
  refuse_what_is_not_text(text, file);
  refuse_what_is_too_deep(text, file);
  try {
    Node top = copied(toml::parse(text));
    top.place = {};
    return top;
  } catch (const toml::parse_error& error) {
    const Place place = place_of(error.source());
    if (const std::string twice = repeated(text, place.line, error.description()); !twice.empty())
      refuse(file, place.line, place.column, twice);
    const std::string likely = forgotten(text, place.line, place.column, error.description());
    refuse(file, place.line, place.column,
           "not TOML: " + one_line(likely.empty() ? lowered(error.description()) : likely));
  }
}

std::string contents(const std::string& file) {
  if (file == "-") return slurp(file);
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) refuse(file, 0, 0, "no such file");
  if (std::filesystem::is_directory(status)) refuse(file, 0, 0, "is a folder, not a scene");
  return slurp(file);
}

}  // namespace obscura::scene
