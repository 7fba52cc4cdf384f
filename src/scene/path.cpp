#include "scene/path.h"

#include <charconv>

namespace obscura::scene {

namespace {

std::string_view trimmed_path(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

std::optional<std::int64_t> whole(std::string_view s) {
  s = trimmed_path(s);
  std::int64_t n = 0;
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), n);
  if (s.empty() || error != std::errc() || end != s.data() + s.size() || n < 0) return {};
  return n;
}

}  // namespace

std::optional<std::vector<Step>> path(std::string_view text) {
  std::vector<Step> steps;
  text = trimmed_path(text);
  while (true) {
    const std::size_t dot = text.find('.');
    const std::string_view part = text.substr(0, dot);
    const std::size_t open = part.find('[');
    Step step{std::string(part.substr(0, open)), {}};
    if (step.name.empty() || step.name.find_first_of(" ]\"'") != std::string::npos) return {};
    for (std::string_view rest = open == std::string_view::npos ? "" : part.substr(open); !rest.empty();) {
      const std::size_t close = rest.find(']');
      const auto index =
          rest[0] == '[' && close != std::string_view::npos ? whole(rest.substr(1, close - 1)) : std::nullopt;
      if (!index) return {};
      step.indices.push_back(*index);
      rest.remove_prefix(close + 1);
    }
    steps.push_back(std::move(step));
    if (steps.size() > 16) return {};
    if (dot == std::string_view::npos) return steps;
    text.remove_prefix(dot + 1);
  }
}

std::optional<Reference> reference(std::string_view text) {
  text = trimmed_path(text);
  // an automatic name has an index of its own: "box[0]", "particle[1][3]"
  const std::size_t open = text.rfind('[');
  if (open == std::string_view::npos) {
    if (text.empty()) return {};
    return Reference{std::string(text), "", false};
  }
  if (open == 0 || text.back() != ']') return {};
  return Reference{std::string(text.substr(0, open)),
                   std::string(text.substr(open + 1, text.size() - open - 2)), true};
}

std::optional<std::vector<int>> range(std::string_view text, int n) {
  std::vector<int> all;
  if (trimmed_path(text) == "*") {
    for (int i = 0; i < n; ++i) all.push_back(i);
    return all;
  }
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view part = trimmed_path(text.substr(0, comma));
    const std::size_t dots = part.find("..");
    const auto first = whole(part.substr(0, dots));
    const auto last = dots == std::string_view::npos ? first : whole(part.substr(dots + 2));
    if (!first || !last || *last < *first || *last >= n || all.size() > std::size_t(n)) return {};
    for (std::int64_t i = *first; i <= *last; ++i) all.push_back(int(i));
    if (comma == std::string_view::npos) return all;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace obscura::scene
