// Median cut: the box with the most pixels along its longest side is halved at the median of its pixels,
// until there are enough boxes; each stands for its mean (Heckbert 1982).

#include "media/palette.h"

#include <algorithm>
#include <limits>

namespace obscura::media {

namespace {

using Counted = std::pair<std::uint32_t, std::uint32_t>;  // 0xRRGGBB, pixels

int channel(std::uint32_t colour, int k) { return int(colour >> (16 - 8 * k) & 255); }

struct ColourBox {
  std::size_t begin, end;
  int axis = 0;
  std::uint64_t weight = 0;  // pixels times the longest side: what cutting it would gain
};

ColourBox box(const std::vector<Counted>& colours, std::size_t begin, std::size_t end) {
  ColourBox result{begin, end};
  std::uint64_t pixels = 0;
  int low[3] = {255, 255, 255}, high[3] = {0, 0, 0};
  for (std::size_t i = begin; i < end; ++i) {
    pixels += colours[i].second;
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], channel(colours[i].first, k));
      high[k] = std::max(high[k], channel(colours[i].first, k));
    }
  }
  for (int k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[result.axis] - low[result.axis]) result.axis = k;
  }
  result.weight = pixels * std::uint64_t(high[result.axis] - low[result.axis]);
  return result;
}

std::uint32_t mean(const std::vector<Counted>& colours, const ColourBox& of) {
  std::uint64_t pixels = 0, sum[3] = {};
  for (std::size_t i = of.begin; i < of.end; ++i) {
    pixels += colours[i].second;
    for (int k = 0; k < 3; ++k) sum[k] += std::uint64_t(channel(colours[i].first, k)) * colours[i].second;
  }
  std::uint32_t colour = 0;
  for (const std::uint64_t s : sum) colour = colour << 8 | std::uint32_t((s + pixels / 2) / pixels);
  return colour;
}

}  // namespace

std::vector<std::uint32_t> palette(std::vector<Counted> colours, std::size_t most) {
  // the most frequent first; ties by colour, so that the order of `counted` does not matter
  std::sort(colours.begin(), colours.end(), [](const Counted& a, const Counted& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  const std::size_t exact = colours.size() <= most ? colours.size() : most / 2;
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < exact; ++i) result.push_back(colours[i].first);

  std::vector<ColourBox> boxes;
  if (exact < colours.size()) boxes.push_back(box(colours, exact, colours.size()));
  while (!boxes.empty() && boxes.size() < most - exact) {
    const auto widest =
        std::max_element(boxes.begin(), boxes.end(),
                         [](const ColourBox& a, const ColourBox& b) { return a.weight < b.weight; });
    if (widest->weight == 0) break;
    const ColourBox whole = *widest;
    const auto first = colours.begin() + std::ptrdiff_t(whole.begin);
    const auto last = colours.begin() + std::ptrdiff_t(whole.end);
    std::sort(first, last, [&](const Counted& a, const Counted& b) {
      const int x = channel(a.first, whole.axis), y = channel(b.first, whole.axis);
      return x != y ? x < y : a.first < b.first;
    });
    // the median pixel, with a colour at least on either side
    std::uint64_t pixels = 0, half = 0;
    for (auto i = first; i != last; ++i) pixels += i->second;
    std::size_t cut = whole.begin;
    while (cut + 1 < whole.end && (cut == whole.begin || half + colours[cut].second <= pixels / 2)) {
      half += colours[cut++].second;
    }
    *widest = box(colours, whole.begin, cut);
    boxes.push_back(box(colours, cut, whole.end));
  }
  for (const ColourBox& one : boxes) result.push_back(mean(colours, one));
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::size_t nearest(const std::vector<std::uint32_t>& palette, std::uint32_t colour) {
  std::size_t best = 0;
  int least = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < palette.size(); ++i) {
    int distance = 0;
    for (int k = 0; k < 3; ++k) {
      const int d = channel(palette[i], k) - channel(colour, k);
      distance += d * d;
    }
    if (distance < least) least = distance, best = i;
  }
  return best;
}

}  // namespace obscura::media
