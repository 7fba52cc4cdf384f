#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "scene/complaints.h"

namespace obscura::app {

/// Words as they are printed; everything else as it is.
template <typename T>
using Said = std::conditional_t<std::is_convertible_v<const T&, std::string_view>, std::string, const T&>;

template <typename T>
Said<T> said(const T& value) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>)
    return scene::one_line(value);
  else
    return value;
}

/// Prints to `to`. The words among the arguments, such as names of files, titles, and what a PNG says of
/// itself, are put on one line, without what a terminal would act on; line breaks are the format's alone.
template <typename... Args>
void say(std::FILE* to, fmt::format_string<Said<Args>...> format, const Args&... args) {
  std::fputs(fmt::format(format, said(args)...).c_str(), to);
}

/// The lines of a text.
inline std::vector<std::string> lines(std::string_view text) {
  std::vector<std::string> all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    all.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return all;
}

/// "1 scene", "2 scenes".
inline std::string counted(std::size_t n, const char* thing) {
  return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s");
}

/// The first few of some names; of more, how many.
inline std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 6;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) text += (i ? ", " : "") + names[i];
  return names.size() > kMost ? text + fmt::format(" and {} more", names.size() - kMost) : text;
}

/// Prints a text of several lines, each as `say` would.
inline void say_lines(std::FILE* to, std::string_view text) {
  for (const std::string& line : lines(text)) say(to, "{}\n", line);
}

}  // namespace obscura::app
