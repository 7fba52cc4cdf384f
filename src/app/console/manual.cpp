#include "app/console/manual.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/console/exit.h"
#include "scene/complaints.h"

namespace obscura::app {

namespace {

// One character of UTF-8 from `at` on, which is moved behind it.
std::uint32_t code_point(std::string_view text, std::size_t& at) {
  const auto lead = static_cast<unsigned char>(text[at++]);
  int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc0 ? 1 : 0;
  std::uint32_t code = more ? lead & (0x3f >> more) : lead;
  for (; more > 0 && at < text.size(); --more)
    code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3f);
  return code;
}

// Text as roff shows it unchanged. `typed`: what one types, whose - is a minus, not a hyphen.
std::string roff(std::string_view text, bool typed) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (static_cast<unsigned char>(c) >= 0x80) {
      out += fmt::format("\\[u{:04X}]", code_point(text, at));
      continue;
    }
    ++at;
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += typed ? "\\-" : "-";
        break;
      case '\'':
        out += "\\(aq";
        break;
      case '`':
        out += "\\(ga";
        break;
      case '^':
        out += "\\(ha";
        break;
      case '~':
        out += "\\(ti";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string bold(std::string_view text) { return "\\fB" + roff(text, true) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + roff(text, true) + "\\fR"; }

// Prose: what lies between ` and ` is bold, and so are options.
std::string prose(const std::string& text) {
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    if (text[at] == '`') {
      const std::size_t end = text.find('`', at + 1);
      if (end != std::string::npos) {
        out += bold(text.substr(at + 1, end - at - 1));
        at = end + 1;
        continue;
      }
    }
    // up to the next blank or `
    std::size_t end = std::min(text.find_first_of(" `", at + 1), text.size());
    std::string word = text.substr(at, end - at);
    const std::size_t first = word.find_first_not_of(" ('");
    if (first != std::string::npos && word[first] == '-' && word.size() > first + 1) {
      const std::size_t last = std::min(word.find_first_of(";,:.')=", first), word.size());
      out += word.substr(0, first) + bold(word.substr(first, last - first)) + roff(word.substr(last), true);
    } else {
      out += roff(word, false);
    }
    at = end;
  }
  return out;
}

// Roff's lines end at blanks, before the 80th column; none begins with a request.
std::string wrapped(const std::string& text) {
  std::string out;
  std::istringstream words(text);
  std::size_t width = 0;
  for (std::string word; words >> word;) {
    if (word.front() == '.') word.insert(0, "\\&");
    const bool fits = width + 1 + word.size() < 80;
    if (width > 0) out += fits ? ' ' : '\n';
    width = width > 0 && fits ? width + 1 + word.size() : word.size();
    out += word;
  }
  return out + "\n";
}

// "Film a scene" as it stands behind a dash
std::string small(std::string text) {
  if (!text.empty()) text[0] = char(std::tolower(static_cast<unsigned char>(text[0])));
  while (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

// What stands at the end of --help, by its parts.
struct Footer {
  std::vector<std::string> notes;     // paragraphs
  std::vector<std::string> examples;  // lines
  std::string exits;                  // "0 done, 2 usage"
};

Footer parts(const std::string& footer) {
  constexpr std::string_view kExits = "Exit codes: ";
  Footer parts;
  std::istringstream lines(footer);
  bool examples = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Examples:") {
      examples = true;
    } else if (examples && line.starts_with("  ")) {
      parts.examples.push_back(line.substr(2));
    } else if (line.starts_with(kExits)) {
      parts.exits = line.substr(kExits.size());
    } else if (!line.empty()) {
      parts.notes.push_back(line);
    }
    if (!line.starts_with("  ") && line != "Examples:") examples = false;
  }
  while (!parts.exits.empty() && parts.exits.back() == '.') parts.exits.pop_back();
  return parts;
}

// "0 done, 4 files, codec or memory" as a list: each number begins an entry.
std::string exit_list(const std::string& exits) {
  std::string out;
  for (std::size_t at = 0; at < exits.size();) {
    std::size_t end = at;
    do {
      end = exits.find(", ", end + 1);
    } while (end != std::string::npos && !std::isdigit(static_cast<unsigned char>(exits[end + 2])));
    const std::string entry = exits.substr(at, end == std::string::npos ? end : end - at);
    const std::size_t blank = entry.find(' ');
    out += fmt::format(".TP\n{}\n{}", bold(entry.substr(0, blank)), wrapped(prose(entry.substr(blank + 1))));
    at = end == std::string::npos ? exits.size() : end + 2;
  }
  return out;
}

std::string placeholder(const OptionRow& row) {
  return row.value + (row.positional() && row.repeated ? "..." : "");
}

std::string synopsis(const CommandTable& command) {
  std::string out = " [" + italic("OPTIONS") + "]";
  for (const OptionRow& row : command.options) {
    if (!row.positional()) continue;
    const std::string name = italic(placeholder(row));
    out += row.required ? " " + name : " [" + name + "]";
  }
  return out;
}

std::string entry(const OptionRow& row) {
  std::string head;
  for (const std::string& name : row.names) head += (head.empty() ? "" : ", ") + bold(name);
  if (!row.value.empty()) head += (head.empty() ? "" : " ") + italic(placeholder(row));
  std::string about = prose(row.about);
  if (!row.range.empty()) about += fmt::format(" ({})", row.range);
  return fmt::format(".TP\n{}\n{}", head, wrapped(about));
}

std::string options(const CommandTable& command) {
  std::string out;
  for (const bool places : {true, false}) {
    for (const OptionRow& row : command.options) {
      if (row.positional() == places) out += entry(row);
    }
  }
  return out;
}

std::string page_name(const std::string& command) {
  return command == "obscura" ? command : "obscura-" + command;
}

std::string reference(const std::string& command) { return ".BR " + roff(page_name(command), true) + " (1)"; }

std::string manual_date() {
  const char* fixed = std::getenv("SOURCE_DATE_EPOCH");
  return fixed ? fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time_t(std::atoll(fixed)))) : "";
}

std::string section(const char* title, const std::string& body) {
  return body.empty() ? "" : fmt::format(".SH {}\n{}", title, body);
}

std::string description(const CommandTable& command, const Footer& footer) {
  std::string out = wrapped(prose(command.about) + (command.about.ends_with(".") ? "" : "."));
  for (const std::string& note : footer.notes) out += ".PP\n" + wrapped(prose(note));
  return out;
}

std::string examples(const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string out = ".EX\n";
  for (const std::string& line : lines) out += roff(line, true) + "\n";
  return out + ".EE\n";
}

std::string all_commands(const CommandTables& tables) {
  std::string out;
  for (const CommandTable& command : tables) {
    if (command.name != "obscura")
      out += fmt::format(".TP\n{}\n{}", reference(command.name), wrapped(prose(command.about)));
  }
  return out;
}

constexpr const char* kEnvironment =
    ".TP\n\\fBOBSCURA_FONTS\\fR\n"
    "Folders, separated by :, whose fonts are used before those of the system\n"
    ".TP\n\\fBOBSCURA_FONT\\fR\n"
    "The family of fonts that words are set in, instead of Inter\n"
    ".TP\n\\fBSOURCE_DATE_EPOCH\\fR\n"
    "The time, in seconds since 1970, that pages and reports are dated by\n";

std::string see_also(const CommandTables& tables, const std::string& self) {
  std::string out;
  for (const CommandTable& other : tables) {
    if (other.name == self || (self != "obscura" && other.name != "obscura")) continue;
    out += (out.empty() ? "" : " ,\n") + reference(other.name);
  }
  return out + "\n";
}

}  // namespace

std::string manual(const CommandTables& tables, const std::string& name) {
  const auto found = std::find(tables.begin(), tables.end(), name.empty() ? "obscura" : name);
  if (found == tables.end()) {
    std::vector<std::string_view> names;
    for (const CommandTable& each : tables) names.push_back(each.name);
    throw UsageError(
        fmt::format("docs man {}: there is no such command{}", name, scene::did_you_mean(name, names)));
  }
  const CommandTable& command = *found;
  const bool program = found == tables.begin();
  const Footer footer = parts(command.footer);
  const std::string page = page_name(command.name);

  std::string upper = page;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  std::string out = fmt::format(".TH {} 1 \"{}\" \"obscura {}\" \"User Commands\"\n", roff(upper, true),
                                manual_date(), OBSCURA_VERSION);
  out += section("NAME", wrapped(roff(page, true) + " \\- " + prose(small(command.about))));
  out += section("SYNOPSIS",
                 program ? bold("obscura") + " " + italic("COMMAND") + " [" + italic("ARGUMENTS") + "]\n"
                         : bold("obscura " + command.name) + synopsis(command) + "\n");
  out += section("DESCRIPTION", description(command, footer));
  if (program) out += section("COMMANDS", all_commands(tables));
  out += section("OPTIONS", options(command));
  out += section("EXIT STATUS",
                 exit_list(footer.exits.empty() ? parts(tables.front().footer).exits : footer.exits));
  if (program) out += section("ENVIRONMENT", kEnvironment);
  out += section("EXAMPLES", examples(footer.examples));
  out += section("SEE ALSO", see_also(tables, command.name));
  return out;
}

}  // namespace obscura::app
