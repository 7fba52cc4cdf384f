#pragma once

#include <filesystem>
#include <set>

#include "architecture/arrows.h"

namespace obscura::architecture {

/// Names in the unnamed namespace of a .cpp under `top` that another .cpp of its room (of draw and
/// sim/solve: of its folder) defines too, or that hide a name of a header: with OBSCURA_UNITY (src/CMakeLists.txt) these
/// are compiled as one, which then does not compile, or calls the other function. The files `apart` (relative
/// to `top`) are compiled alone; `roots` are the folders that #include "..." starts from. It reads
/// declarations, not C++: what it does not follow (friends, function pointers, names from macros) it leaves
/// out.
Complaints clashing_names(const std::filesystem::path& top, const std::set<std::filesystem::path>& apart,
                          const std::vector<std::filesystem::path>& roots);

/// Names that a file under `top` uses although no header that it includes, directly or not, has them, and one
/// of another file has: with OBSCURA_UNITY what is compiled before may have included that, alone the file
/// does not compile. Types, constants, and functions where they are called by their name alone; what a file
/// or its headers name in any other way, as members do, is left out.
Complaints names_without_headers(const std::filesystem::path& top,
                                 const std::vector<std::filesystem::path>& roots);

/// The files that a CMakeLists.txt has compiled alone (SKIP_UNITY_BUILD_INCLUSION), as it names them.
std::set<std::filesystem::path> compiled_apart(const std::filesystem::path& cmake_lists);

}  // namespace obscura::architecture
