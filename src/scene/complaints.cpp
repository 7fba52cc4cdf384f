#include "scene/complaints.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "scene/utf8.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostComplaints = 100;
constexpr std::size_t kLongestWord = 64;  // longer ones are cut when quoted, and near nothing

// fewest insertions, deletions, exchanges of a letter and swaps of two neighbours, case aside
std::size_t distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string line;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t bytes = code_point(text.substr(i));
    const std::string_view point = text.substr(i, std::max<std::size_t>(1, bytes));
    line += bytes == 0 ? "?" : is_control(point) ? " " : point;
    i += point.size();
  }
  return line;
}

std::string in_quotes(std::string_view word) {
  // cut where a code point ends
  std::size_t most = std::min(word.size(), kLongestWord);
  while (most > 0 && most < word.size() && (static_cast<unsigned char>(word[most]) & 0xC0) == 0x80) --most;
  return "'" + one_line(word.substr(0, most)) + (word.size() > most ? "...'" : "'");
}

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& words) {
  if (word.size() > kLongestWord) return {};
  std::string_view best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view each : words) {
    const std::size_t apart = std::max(each.size(), word.size()) - std::min(each.size(), word.size());
    if (each.size() > kLongestWord || (apart >= least && !each.starts_with(word) && !each.ends_with(word)))
      continue;
    std::size_t d = distance(word, each);
    // the front or the back of a longer word: "elastic", "length"
    if (word.size() >= 3 && (each.starts_with(word) || each.ends_with(word))) d = std::min<std::size_t>(d, 1);
    if (d < least) least = d, best = each;
  }
  return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& words) {
  const std::string_view near = nearest(word, words);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near);
}

Complaint Diagnostics::complaint(Place place, std::string message) const {
  if (place.set == 0) return {file_, place.line, place.column, std::move(message)};
  std::string set = sets_[std::size_t(place.set - 1)];
  if (set.size() > kLongestWord) set = set.substr(0, kLongestWord) + "...";
  return {"--set " + set, 0, 0, std::move(message)};
}

std::string Diagnostics::text(Place place) const {
  const Complaint it = complaint(place, "");
  return it.line > 0 ? fmt::format("{}:{}:{}", it.file, it.line, it.column) : it.file;
}

void Diagnostics::raise() const {
  auto found = found_;
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.set, a.first.line, a.first.column) <
           std::tie(b.first.set, b.first.line, b.first.column);
  });
  std::vector<Complaint> all;
  for (const auto& [place, message] : found) {
    if (all.size() == kMostComplaints) {
      all.push_back({file_, 0, 0, fmt::format("and {} more", found.size() - kMostComplaints)});
      break;
    }
    all.push_back(complaint(place, message));
  }
  throw Error(std::move(all));
}

}  // namespace obscura::scene
