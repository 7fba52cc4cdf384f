#include "architecture/arrows.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace obscura::architecture {
namespace {

using Names = std::set<std::string>;

// the picture (docs/design.md): a room includes itself and what its arrows point at
const std::map<std::string, Names> kArrows = {
    {"python", {"obscura"}},
    {"obscura", {"app", "scene", "draw", "gl", "media", "sim", "page"}},
    {"app", {"scene", "draw", "gl", "media", "sim", "page"}},
    {"scene", {"draw", "sim"}},
    {"gl", {"draw", "media"}},
    {"page", {"draw"}},
    {"draw", {"sim"}},
    {"media", {}},
    {"sim", {}},
};

// the second level of the picture: the folders of a room, each of which includes itself and those before it
const std::map<std::string, std::vector<std::string>> kSubRooms = {
    {"sim",
     {"math", "shape", "model", "collide", "force", "multibody", "constraint", "constraint/joints", "motion",
      "energy", "solve/cone", "solve", "solve/exact", "solve/iterate", "handout", "fracture", "step"}},
    {"draw", {"picture", "page", "plane", "space", "compose"}},
    {"app", {"console", "run", "film", "watch", "study", "compare", "figure", "cluster", "commands"}},
};

// the folder of a file within its room: of "sim/solve/exact/cone.h" "solve/exact"
std::string sub_room(const std::filesystem::path& name) {
  return name.parent_path().lexically_relative(*name.begin()).string();
}

// whose headers are whose: the beginning of a name in angle brackets, and the rooms that may say it
const std::map<std::string, Names> kLibraries = {
    {"GL/", {"gl"}},
    {"EGL/", {"gl"}},
    {"KHR/", {"gl"}},
    {"glad/", {"gl"}},
    {"epoxy/", {"gl"}},
    {"png.h", {"media"}},
    {"zlib.h", {"media"}},
    {"libdeflate", {"media", "page"}},
    {"libav", {"media"}},
    {"libsw", {"media"}},
    {"pybind11/", {"python"}},
    {"toml++/", {"scene"}},
    {"toml.hpp", {"scene"}},
    {"CLI/", {"app"}},
    {"cairo", {"page"}},
    {"ft2build.h", {"draw", "gl", "page"}},
    {"freetype", {"draw", "gl", "page"}},
    {"hb", {"draw", "gl", "page"}},
};

// names, and the header that has them in every version of their library
const std::map<std::string, std::string> kHeaders = {
    {"fmt::join(", "fmt/ranges.h"},  {"std::this_thread::", "thread"}, {"std::thread ", "thread"},
    {"std::jthread ", "thread"},     {"std::all_of(", "algorithm"},    {"std::any_of(", "algorithm"},
    {"std::none_of(", "algorithm"},  {"std::clamp(", "algorithm"},     {"std::count(", "algorithm"},
    {"std::count_if(", "algorithm"}, {"std::find(", "algorithm"},      {"std::find_if(", "algorithm"},
    {"std::sort(", "algorithm"},
};

// the physics knows Eigen's vectors, the standard library, and the processor
bool known_to_sim(const std::string& header) {
  return header.rfind("Eigen/", 0) == 0 || header == "immintrin.h" ||
         header.find_first_of("/.") == std::string::npos;
}

// Another version of Eigen may factor in another order, and states would no longer be the same bits: the
// physics has factors of its own, but for these, whose bits tests/sim/sums_test.cpp compares, and for what a
// state never sees: warnings.
const std::map<std::string, std::string> kFactors = {
    {"sim/fracture/bond_load.cpp", "Eigen/SparseCholesky"},
    {"sim/math/lcp.cpp", "Eigen/QR"},
    {"sim/motion/infinitesimal_motion.cpp", "Eigen/Eigenvalues"},
};
bool factors(const std::string& header) {
  return header.rfind("Eigen/", 0) == 0 && header != "Eigen/Core" && header != "Eigen/Geometry";
}

// the place of a folder in its room's list, which ends where it is not in it
std::ptrdiff_t place(const std::string& room, const std::string& folder) {
  const auto& list = kSubRooms.at(room);
  return std::find(list.begin(), list.end(), folder) - list.begin();
}

bool may(const std::string& from, const std::string& to) {
  const auto room = kArrows.find(from);
  return from == to || (room != kArrows.end() && room->second.contains(to));
}

// the sources under a folder, in the order of their names
std::vector<std::filesystem::path> sources(const std::filesystem::path& src) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(src))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Complaints wrong_includes(const std::filesystem::path& src) {
  static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  Complaints wrong;
  for (const auto& file : sources(src)) {
    const auto name = file.lexically_relative(src);
    const std::string room = name.begin()->string();
    if (!kArrows.contains(room)) wrong.push_back(name.string() + ": " + room + " is no room of the picture");

    const bool has_sub_rooms = kSubRooms.contains(room);
    const std::string own = sub_room(name);
    if (has_sub_rooms && place(room, own) == std::ssize(kSubRooms.at(room)) && name != "app/main.cpp")
      wrong.push_back(name.string() + ": " + (own == "." ? room : room + "/" + own) +
                      " is no sub-room of the picture");

    std::ifstream in(file);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string header = match[2];
      const auto complain = [&](const std::string& why) {
        wrong.push_back(name.string() + ":" + std::to_string(number) + ": " + why);
      };
      if (name == "obscura/obscura.h" && (match[1] == "\"" || header.find_first_of("/.") != header.npos))
        complain("the interface of programs knows only std, not " + header);
      if (match[1] == "\"") {
        const std::string to = header.substr(0, header.find('/'));
        if (!kArrows.contains(to))
          complain("\"" + header + "\" does not say its room");
        else if (!may(room, to))
          complain(room + " may not include " + header);
        else if (to == room && has_sub_rooms && place(room, sub_room(header)) > place(room, own))
          complain(room + "/" + own + " may not include " + header);
        continue;
      }
      for (const auto& [prefix, rooms] : kLibraries)
        if (header.rfind(prefix, 0) == 0 && !rooms.contains(room))
          complain(room + " may not include <" + header + ">");
      if (room == "sim" && factors(header) &&
          !(kFactors.contains(name.string()) && kFactors.at(name.string()) == header))
        complain("sim factors by itself, not by <" + header + ">");
      if (room == "sim" && !known_to_sim(header))
        complain("sim knows only Eigen and std, not <" + header + ">");
    }
  }
  return wrong;
}

Complaints missing_includes(const std::filesystem::path& src) {
  Complaints missing;
  for (const auto& file : sources(src)) {
    std::ifstream in(file);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    for (const auto& [name, header] : kHeaders) {
      std::size_t at = text.find(name);
      while (at != text.npos && at > 0 && text[at - 1] == '"')
        at = text.find(name, at + 1);  // as a word only
      if (at == text.npos || text.find("#include <" + header + ">") != text.npos) continue;
      missing.push_back(
          file.lexically_relative(src).string() + ":" +
          std::to_string(1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n')) + ": " +
          name + " without <" + header + ">");
    }
  }
  return missing;
}

Complaints wrong_links(const std::filesystem::path& cmake_lists) {
  std::ifstream in(cmake_lists);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  static const std::regex call(R"(obscura_room\((\w+)([^)]*)\))");

  Complaints wrong;
  for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
    const std::string room = (*it)[1];
    if (room == "name") continue;  // the function's own definition
    std::istringstream words((*it)[2]);
    bool rooms = false;
    for (std::string word; words >> word;) {
      if (word == "ROOMS" || word == "LIBRARIES")
        rooms = word == "ROOMS";
      else if (rooms && !may(room, word))
        wrong.push_back(room + " may not link " + word);
    }
  }
  return wrong;
}

}  // namespace obscura::architecture
