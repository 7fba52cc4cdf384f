#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace obscura::architecture {

/// One line of a source file that goes against the picture: "sim/step.cpp:3: sim may not include
/// draw/picture/list.h".
using Complaints = std::vector<std::string>;

/// Reads every #include of every .h and .cpp under `src`, whose folders are the rooms.
Complaints wrong_includes(const std::filesystem::path& src);

/// Names used without their header, where some versions of a library include it by another header and some
/// do not.
Complaints missing_includes(const std::filesystem::path& src);

/// Reads what each obscura_room(...) of src/CMakeLists.txt links.
Complaints wrong_links(const std::filesystem::path& cmake_lists);

}  // namespace obscura::architecture
