#include "app/console/completion.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace obscura::app {

namespace {

// What a shell offers where a value is to be typed: words, or files by a pattern; neither where only a person
// knows.
struct Offer {
  std::vector<std::string> words;
  std::string files;  // "*.toml", "*" for all, "/" for folders
};

Offer offer(const OptionRow& row, const CommandTables& tables) {
  if (!row.words.empty()) return {row.words, ""};
  if (row.value == "COMMAND") {
    Offer commands;
    for (std::size_t i = 1; i < tables.size(); ++i) commands.words.push_back(tables[i].name);
    return commands;
  }
  if (row.value == "SCENE") return {{}, "*.toml"};
  if (row.value == "DIR") return {{}, "/"};
  for (const char* any : {"OUT", "FILE", "A", "B"}) {
    if (row.value == any) return {{}, "*"};
  }
  // RUN.csv, OUT.html
  const std::size_t dot = row.value.find('.');
  return {{}, dot == std::string::npos ? "" : "*" + row.value.substr(dot)};
}

// The first clause, which fits beside a word.
std::string brief(const std::string& about) {
  std::size_t end = about.size();
  for (const char* mark : {"; ", ": ", " [", ", as in "}) end = std::min(end, about.find(mark));
  return about.substr(0, end);
}

// 'text' for a shell, in which nothing is special; `quote`: a ' within it.
std::string quoted(const std::string& text, std::string_view quote) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += quote;
    else
      out += c;
  }
  return out + "'";
}

// "words='paper screen'" or "files='*.toml'"
std::string assigned(const Offer& offer) {
  if (!offer.words.empty()) return fmt::format("words='{}'", fmt::join(offer.words, " "));
  return fmt::format("files='{}'", offer.files);
}

std::string bash_values(const CommandTables& tables) {
  std::string out;
  for (const CommandTable& command : tables) {
    int place = 0;
    for (const OptionRow& row : command.options) {
      if (row.value.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : row.names)
        patterns.push_back(fmt::format("'{} {}'", command.name, name));
      if (row.positional())
        patterns.push_back(row.repeated ? fmt::format("'{} '[0-9]*", command.name)
                                        : fmt::format("'{} {}'", command.name, ++place));
      out += fmt::format("    {}) {} ;;\n", fmt::join(patterns, " | "), assigned(offer(row, tables)));
    }
  }
  return out;
}

std::string bash_options(const CommandTables& tables) {
  std::string out;
  for (const CommandTable& command : tables) {
    std::vector<std::string> names;
    for (const OptionRow& row : command.options)
      names.insert(names.end(), row.names.begin(), row.names.end());
    if (command.name == "obscura") {
      for (std::size_t i = 1; i < tables.size(); ++i) names.push_back(tables[i].name);
    }
    out += fmt::format("    {}) words='{}' ;;\n", command.name, fmt::join(names, " "));
  }
  return out;
}

std::string zsh_text(const std::string& text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != special.npos) out += '\\';
    out += c;
  }
  return out;
}

// the end of one spec of _arguments: ":OUT:_files"
std::string zsh_value(const OptionRow& row, const CommandTables& tables) {
  const Offer it = offer(row, tables);
  std::string action = " ";
  if (!it.words.empty())
    action = fmt::format("({})", fmt::join(it.words, " "));
  else if (it.files == "/")
    action = "_files -/";
  else if (it.files == "*")
    action = "_files";
  else if (!it.files.empty())
    action = fmt::format("_files -g \"{}\"", it.files);
  return fmt::format(":{}:{}", zsh_text(row.value, ":\\"), action);
}

std::string zsh_arguments(const CommandTable& command, const CommandTables& tables,
                          const std::string& indent) {
  constexpr std::string_view kQuote = "'\\''";
  std::string out;
  for (const OptionRow& row : command.options) {
    const std::string value = row.value.empty() ? "" : zsh_value(row, tables);
    if (row.positional()) {
      out += fmt::format(" \\\n{}{}", indent,
                         quoted((row.repeated   ? "*"
                                 : row.required ? ""
                                                : ":") +
                                    value,
                                kQuote));
      continue;
    }
    const std::string about = fmt::format("[{}]", zsh_text(brief(row.about), "[]\\"));
    for (const std::string& name : row.names) {
      // -o and --output exclude each other, and themselves, unless they may be given again
      const std::string others = row.repeated ? "*" : fmt::format("({})", fmt::join(row.names, " "));
      const char* equals = !value.empty() && name.starts_with("--") ? "=" : "";
      out += fmt::format(" \\\n{}{}", indent, quoted(others + name + equals + about + value, kQuote));
    }
  }
  return out;
}

std::string fish_value(const OptionRow& row, const CommandTables& tables) {
  const Offer it = offer(row, tables);
  if (!it.words.empty()) return fmt::format(" -x -a '{}'", fmt::join(it.words, " "));
  if (it.files == "/") return " -x -a '(__fish_complete_directories)'";
  if (it.files == "*") return " -r -F";
  if (!it.files.empty()) return fmt::format(" -x -k -a '(__obscura_files {})'", it.files.substr(1));
  return " -x";
}

}  // namespace

std::string bash_completion(const CommandTables& tables) {
  return "# Completes lines of obscura in bash. Made by `obscura docs bash`.\n\n"
         "# What may stand behind option $2 of command $1, or at its place $2: words, or files by a "
         "pattern.\n"
         "_obscura_value() {\n  words= files=\n  case \"$1 $2\" in\n" +
         bash_values(tables) +
         "    *) return 1 ;;\n  esac\n}\n\n"
         "_obscura_options() {\n  case $1 in\n" +
         bash_options(tables) + R"(    *) words= ;;
  esac
}

_obscura() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} command=obscura place=1 words files i
  # --theme=paper is three words to bash
  if [[ $cur == = ]]; then cur=; elif [[ $prev == = ]]; then prev=${COMP_WORDS[COMP_CWORD - 2]}; fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
      -*) if _obscura_value "$command" "${COMP_WORDS[i]}"; then
            [[ ${COMP_WORDS[i + 1]} != = ]] || ((i++))
            ((i++))
          fi ;;
      *) if [[ $command == obscura ]]; then command=${COMP_WORDS[i]}; else ((place++)); fi ;;
    esac
  done
  if ! { [[ $prev == -* ]] && _obscura_value "$command" "$prev"; }; then
    if [[ $cur == -* || $command == obscura ]] || ! _obscura_value "$command" "$place"; then
      _obscura_options "$command"
      files=
    fi
  fi
  local IFS=$'\n'
  COMPREPLY=()
  case $files in
    '') IFS=$' \n'; COMPREPLY=($(compgen -W "$words" -- "$cur")) ;;
    /) COMPREPLY=($(compgen -d -- "$cur")) ;;
    *) COMPREPLY=($(compgen -f -X "!$files" -- "$cur") $([[ $files == '*' ]] || compgen -d -- "$cur")) ;;
  esac
  if [[ -n $files ]]; then compopt -o filenames 2>/dev/null || true; fi
}
complete -F _obscura obscura
)";
}

std::string zsh_completion(const CommandTables& tables) {
  std::string commands, lines;
  for (std::size_t i = 1; i < tables.size(); ++i) {
    const CommandTable& command = tables[i];
    commands += fmt::format("        {}\n",
                            quoted(command.name + ":" + zsh_text(brief(command.about), ":\\"), "'\\''"));
    lines += fmt::format("        {})\n          _arguments -S{} && ret=0 ;;\n", command.name,
                         zsh_arguments(command, tables, "            "));
  }
  return "#compdef obscura\n# Completes lines of obscura in zsh. Made by `obscura docs zsh`.\n\n"
         "_obscura() {\n"
         "  local curcontext=$curcontext state line ret=1\n"
         "  typeset -A opt_args\n"
         "  _arguments -C -S" +
         zsh_arguments(tables.front(), tables, "    ") +
         " \\\n    '1: :->command' \\\n    '*:: :->rest' && ret=0\n"
         "  case $state in\n"
         "    command)\n"
         "      local -a commands=(\n" +
         commands +
         "      )\n"
         "      _describe -t commands command commands && ret=0 ;;\n"
         "    rest)\n"
         "      case $words[1] in\n" +
         lines +
         "      esac ;;\n"
         "  esac\n"
         "  return ret\n"
         "}\n\n"
         "if [ \"$funcstack[1]\" = _obscura ]; then _obscura \"$@\"; else compdef _obscura obscura; fi\n";
}

std::string fish_completion(const CommandTables& tables) {
  constexpr std::string_view kQuote = "\\'";
  std::string out =
      "# Completes lines of obscura in fish. Made by `obscura docs fish`.\n\n"
      "# whether the line has this command, and, where a number is named, so many words behind it\n"
      "function __obscura_has\n"
      "  set -l words (commandline -opc)\n"
      "  test (count $words) -gt 1; and test \"$words[2]\" = $argv[1]\n"
      "  and begin; not set -q argv[2]; or test (count $words) -eq (math $argv[2] + 2); end\n"
      "end\n\n"
      "# files that end so, and folders\n"
      "function __obscura_files\n"
      "  __fish_complete_suffix $argv | string match -er '(?:/|'(string escape --style=regex "
      "$argv)')(?:\\t|$)'\n"
      "end\n\n"
      "complete -c obscura -f\n";
  for (const CommandTable& command : tables) {
    const bool program = command.name == "obscura";
    const std::string first = "complete -c obscura -n 'test (count (commandline -opc)) -eq 1'";
    if (!program)
      out += fmt::format("\n{} -a {} -d {}\n", first, command.name, quoted(brief(command.about), kQuote));
    int place = 0;
    for (const OptionRow& row : command.options) {
      const std::string value = row.value.empty() ? "" : fish_value(row, tables);
      // words belong to their place; a file may stand behind any option
      const std::string at =
          row.positional() && !offer(row, tables).words.empty() ? fmt::format(" {}", place) : "";
      if (row.positional()) ++place;
      if (row.positional() && value == " -x") continue;
      out += program ? first : fmt::format("complete -c obscura -n '__obscura_has {}{}'", command.name, at);
      for (const std::string& name : row.names) {
        const bool is_long = name.starts_with("--");
        out += (is_long ? " -l " : " -s ") + name.substr(is_long ? 2 : 1);
      }
      // fish knows at which place a file of any name stands
      out += row.positional() && value == " -r -F" ? " -F" : value;
      if (!row.positional()) out += " -d " + quoted(brief(row.about), kQuote);
      out += "\n";
    }
  }
  return out;
}

}  // namespace obscura::app
