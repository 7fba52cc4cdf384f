#include "architecture/names.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "architecture/declarations.h"

namespace obscura::architecture {
namespace {

using Paths = std::set<std::filesystem::path>;

// whether both cannot be in one file: functions of other parameters can, and one alias twice
bool clash(const Defined& a, const Defined& b) {
  if (a.name != b.name || a.scope != b.scope || !(a.unnamed || b.unnamed)) return false;
  if (a.kind != b.kind) return true;
  if (a.kind == Kind::other) return true;
  return a.kind == Kind::function ? a.type == b.type : a.type != b.type;
}

// Whether a header's name is no longer found in unnamed namespaces, where this one is, in a namespace within.
// What is in the same namespace is found by the types of its arguments, if one of them is of ours:
// PascalCase.
bool hides(const Defined& here, const Defined& header) {
  if (!here.unnamed || here.name != header.name || here.scope.rfind(header.scope, 0) != 0) return false;
  if (here.scope != header.scope || header.kind != Kind::function) return true;
  return std::none_of(header.type.begin(), header.type.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

// The words of a file; of these the ones that it declares in some way, and those that are meant as a name of
// a namespace: not of a member, not with another scope before them, and where they are first.
struct Words {
  std::set<std::string> all, declared, values;  // values: not only called
  std::set<std::string> usings;                 // of another scope: using sim::Vec3;
  std::map<std::string, int> used, calls;
};

Words words_of(const Tokens& tokens) {
  // a word before a name, but for these, is its type
  static const std::set<std::string> no_types{"return", "else",      "case",   "throw",  "co_return",
                                              "not",    "and",       "or",     "const",  "new",
                                              "static", "constexpr", "inline", "mutable"};
  // where a name's type ends in one of these, it is followed by one of those
  static const std::set<std::string> ends_type{">", "&", "*", ",", "[", "}", "]"},
      begins_value{"=", ";", "{", "[", ",", "]", "("};
  Words words;
  const auto text = [&](std::size_t i) { return i < tokens.size() ? tokens[i].text : ""; };
  int enumerates = 0;  // in the braces of an enum
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string word = text(i), before = i > 0 ? text(i - 1) : "", after = text(i + 1);
    if (word == "enum") enumerates = 1;
    if (enumerates == 1 && word == "{") enumerates = 2;
    if (word == "}" || (word == ";" && enumerates == 1)) enumerates = 0;
    if (!begins_word(word[0])) continue;
    words.all.insert(word);
    if (word == "using" && after == "namespace") words.usings.insert(after);
    if (word == "using" && text(i + 2) == "::") {
      while (text(i + 2) == "::") i += 2;
      words.usings.insert(text(i + 1));
      continue;
    }
    const bool typed = !before.empty() && begins_word(before[0]) && !no_types.contains(before),
               is_member = before == "." || (before == ">" && i > 1 && text(i - 2) == "-");
    const bool aligned = before == ")" && i > 3 && text(i - 4) == "alignas";
    const bool tests = before == "(" && i > 1 && text(i - 2).find("TEST") != std::string::npos;
    if (typed || tests || aligned || enumerates == 2 ||
        (!is_member && ends_type.contains(before) && begins_value.contains(after) &&
         (before != "," || after == "=" || after == "]")))
      words.declared.insert(word);
    if (is_member || typed || before == "::") continue;
    words.used.emplace(word, tokens[i].line);
    if (after == "(")
      words.calls.emplace(word, tokens[i].line);
    else
      words.values.insert(word);
  }
  return words;
}

}  // namespace

Complaints names_without_headers(const std::filesystem::path& top,
                                 const std::vector<std::filesystem::path>& roots) {
  std::map<std::filesystem::path, Words> words;
  std::map<std::string, Paths> types, functions;  // where each is declared
  std::map<std::filesystem::path, std::vector<Defined>> defined;
  std::map<std::string, std::set<std::string>> usings;  // of the files of a room
  Paths files;
  const auto room_of = [&](const std::filesystem::path& file) {
    for (const auto& root : roots) {
      const auto name = file.lexically_relative(root);
      if (*name.begin() != "..") return name.begin()->string();
    }
    return std::string();
  };
  const auto read = [&](const std::filesystem::path& file) {
    const auto [at, is_new] = words.try_emplace(file);
    if (is_new) at->second = words_of(tokens_of(contents(file)));
    return is_new;
  };
  for (const auto& entry : std::filesystem::recursive_directory_iterator(top))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h") files.insert(entry.path());
  std::map<std::filesystem::path, Paths> included;
  for (const auto& file : files) {
    Paths all = included[file] = headers_of(file, roots);
    all.insert(file);
    for (const auto& each : all) {
      if (!read(each)) continue;
      defined[each] = names_of(tokens_of(contents(each)));
      if (each.extension() != ".h") {
        usings[room_of(each)].insert(words.at(each).usings.begin(), words.at(each).usings.end());
        continue;
      }
      for (const Defined& name : defined.at(each)) {
        if (name.kind == Kind::function)
          functions[name.name].insert(each);
        else if (std::isupper(static_cast<unsigned char>(name.name[0])) || name.name[0] == 'k')
          types[name.name].insert(each);
      }
    }
  }

  Complaints missing;
  for (const auto& file : files) {
    const Words& own = words.at(file);
    const Paths& headers = included.at(file);
    std::set<std::string> rooms{room_of(file)};  // the others have no name of which this file knows
    for (const auto& header : headers) rooms.insert(room_of(header));
    const auto named = [&](const std::string& name) {
      return std::any_of(headers.begin(), headers.end(),
                         [&](const auto& header) { return words.at(header).all.contains(name); });
    };
    const auto look = [&](const std::map<std::string, int>& used, const std::map<std::string, Paths>& places,
                          const std::set<std::string>& skip) {
      for (const auto& [name, line] : used) {
        const auto place = places.find(name);
        if (place == places.end() || place->second.contains(file) || own.declared.contains(name) ||
            skip.contains(name) || named(name))
          continue;
        const auto header = std::find_if(place->second.begin(), place->second.end(),
                                         [&](const auto& each) { return rooms.contains(room_of(each)); });
        if (header == place->second.end()) continue;
        missing.push_back(file.lexically_relative(top).string() + ":" + std::to_string(line) + ": " + name +
                          " without " + header->filename().string());
      }
    };
    look(own.used, types, {});
    // what a file beside it takes from another namespace is there where both are compiled together
    const auto seen = [&](const std::string& name) {
      return std::any_of(headers.begin(), headers.end(), [&](const auto& header) {
        const auto& there = defined.at(header);
        const auto is_here = [&](const Defined& one) { return one.name == name; };
        // of a class
        if (words.at(header).declared.contains(name) && std::none_of(there.begin(), there.end(), is_here))
          return true;
        return words.at(header).usings.contains(name) ||
               std::any_of(there.begin(), there.end(), [&](const Defined& one) {
                 return is_here(one) &&
                        std::any_of(defined.at(file).begin(), defined.at(file).end(),
                                    [&](const Defined& here) { return here.scope.rfind(one.scope, 0) == 0; });
               });
      });
    };
    for (const auto& [name, line] : own.used)
      if (types.contains(name) && usings[room_of(file)].contains(name) && !own.usings.contains(name) &&
          !own.usings.contains("namespace") && !own.declared.contains(name) && !seen(name))
        missing.push_back(file.lexically_relative(top).string() + ":" + std::to_string(line) + ": " + name +
                          " without using");
    look(own.calls, functions, own.values);
  }
  return missing;
}

Complaints clashing_names(const std::filesystem::path& top, const Paths& apart,
                          const std::vector<std::filesystem::path>& roots) {
  // as src/CMakeLists.txt has them compiled: draw and the solvers by folder, else by room
  const auto compiled_with = [](const std::filesystem::path& name) {
    const bool own_names = *name.begin() == "draw" || name.string().starts_with("sim/solve");
    return own_names ? name.parent_path() : *name.begin();
  };
  std::map<std::filesystem::path, Paths> folders;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(top)) {
    const std::filesystem::path name = entry.path().lexically_relative(top);
    // a folder with a CMakeLists.txt of its own has other rules
    const bool own_rules = entry.path().parent_path() != top &&
                           std::filesystem::exists(entry.path().parent_path() / "CMakeLists.txt");
    if (name.extension() == ".cpp" && !own_rules && !apart.contains(name))
      folders[compiled_with(name)].insert(name);
  }

  using Places = std::map<std::string, std::vector<std::pair<std::string, Defined>>>;
  Complaints clashes;
  for (const auto& [folder, files] : folders) {
    Paths headers;
    for (const auto& file : files) headers.merge(headers_of(top / file, roots));
    Places declared, earlier;
    for (const auto& header : headers)
      for (const Defined& each : names_of(tokens_of(contents(header))))
        declared[each.name].emplace_back(header.filename().string(), each);

    for (const auto& file : files) {
      const std::vector<Defined> defined = names_of(tokens_of(contents(top / file)));
      for (const Defined& here : defined) {
        // the first of these that it meets
        const auto look = [&](const Places& places, auto meet) {
          const auto named = places.find(here.name);
          if (named == places.end()) return false;
          for (const auto& [other, there] : named->second)
            if (meet(here, there)) {
              clashes.push_back(file.string() + ":" + std::to_string(here.line) + ": " + here.name +
                                " is in " + other + ":" + std::to_string(there.line) + " too");
              return true;
            }
          return false;
        };
        look(earlier, clash) ||
            look(declared, [](const Defined& a, const Defined& b) { return clash(a, b) || hides(a, b); });
      }
      for (const Defined& here : defined) earlier[here.name].emplace_back(file.filename().string(), here);
    }
  }
  return clashes;
}

std::set<std::filesystem::path> compiled_apart(const std::filesystem::path& cmake_lists) {
  std::ifstream in(cmake_lists);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  static const std::regex call(R"(set_source_files_properties\(([^)]*?)PROPERTIES([^)]*)\))");
  std::set<std::filesystem::path> apart;
  for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
    if ((*it)[2].str().find("SKIP_UNITY_BUILD_INCLUSION ON") == std::string::npos) continue;
    std::istringstream files((*it)[1]);
    const std::string here = "${CMAKE_CURRENT_SOURCE_DIR}/";
    for (std::string file; files >> file;)
      apart.insert(file.rfind(here, 0) == 0 ? file.substr(here.size()) : file);
  }
  return apart;
}

}  // namespace obscura::architecture
