#pragma once

#include <cstddef>
#include <string_view>

namespace obscura::scene {

/// How many bytes the code point at the front of `text` takes; 0 where it is not UTF-8, or `text` is empty.
std::size_t code_point(std::string_view text);

/// Whether a code point is one that a terminal acts on instead of showing it: control characters, and those
/// that break lines or turn the direction of writing. Requires one code point.
bool is_control(std::string_view point);

/// Whether a name may be part of a path. One rule for every name that becomes one: kPathName says it in
/// words.
bool is_path_name(std::string_view name);
inline constexpr const char* kPathName =
    "a string that may be part of a file's name: no control characters, none of / \\ : * ? \" < > | % { }, "
    "no dot, "
    "dash or space first, no dot or space last, at most 100 bytes";

}  // namespace obscura::scene
