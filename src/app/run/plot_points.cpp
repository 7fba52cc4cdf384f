#include "app/run/plot_points.h"

#include <algorithm>
#include <cmath>

namespace obscura::app {

namespace {

// what a line would leave out is shown where it is so far from what the line spans between two points (of its
// range), in so many of its parts; points nearer to each other are one
constexpr double kUnseen = 0.03, kOften = 0.1, kOnePoint = 0.01;

double range_of(const std::vector<double>& a, const std::vector<double>& b) {
  double low = 1e300, high = -1e300;
  for (const std::vector<double>* all : {&a, &b})
    for (const double x : *all) low = std::min(low, x), high = std::max(high, x);
  return high - low;
}

}  // namespace

bool is_quiet(const draw::Look& look, int body) {
  return std::size_t(body) < look.bodies.size() && look.bodies[std::size_t(body)].quiet;
}

void add_values(const sim::SceneInfo& cast, const sim::Snapshot& now, const draw::Measured& measured,
                const std::vector<draw::Measured::Line>& lines, draw::Plot& plot) {
  plot.times.push_back(now.time);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    plot.lines[k].values.push_back(lines[k].at(cast, now));
    if (const auto along = measured.along(lines[k])) plot.lines[k].along.push_back(along->at(cast, now));
  }
}

void refine(const draw::Plot& looks, draw::Plot& plot) {
  struct Course {
    const std::vector<double>*points, *looks;
    double range;
  };
  std::vector<Course> courses;
  bool against = false;
  for (std::size_t k = 0; k < plot.lines.size(); ++k) {
    const draw::Series &line = plot.lines[k], &look = looks.lines[k];
    courses.push_back({&line.values, &look.values, range_of(line.values, look.values)});
    if (line.along.empty()) continue;
    against = true;
    courses.push_back({&line.along, &look.along, range_of(line.along, look.along)});
  }

  // the looks of a part, after point i and before the next
  const std::size_t parts = std::max<std::size_t>(plot.times.size(), 1) - 1;
  std::vector<std::size_t> first;
  for (const double t : plot.times)
    first.push_back(
        std::size_t(std::upper_bound(looks.times.begin(), looks.times.end(), t) - looks.times.begin()));
  const auto unseen = [&](const Course& of, std::size_t i) {
    const auto [low, high] = std::minmax((*of.points)[i], (*of.points)[i + 1]);
    for (std::size_t j = first[i]; j < first[i + 1]; ++j)
      if (std::max((*of.looks)[j] - high, low - (*of.looks)[j]) > kUnseen * of.range) return true;
    return false;
  };
  std::size_t coarse = 0;
  for (std::size_t i = 0; i < parts; ++i)
    coarse += std::any_of(courses.begin(), courses.end(), [&](const Course& of) { return unseen(of, i); });
  if (!(double(coarse) > kOften * double(parts))) return;

  draw::Plot all = plot;
  const auto take = [&](const draw::Plot& from, std::size_t at) {
    all.times.push_back(from.times[at]);
    for (std::size_t k = 0; k < all.lines.size(); ++k) {
      all.lines[k].values.push_back(from.lines[k].values[at]);
      if (against) all.lines[k].along.push_back(from.lines[k].along[at]);
    }
  };
  all.times.clear();
  for (draw::Series& line : all.lines) line.values.clear(), line.along.clear();
  for (std::size_t i = 0; i <= parts; ++i) {
    take(plot, i);
    if (i == parts) break;
    std::vector<std::size_t> chosen;
    for (std::size_t j = first[i]; j < first[i + 1]; ++j) {
      const bool far = std::any_of(courses.begin(), courses.end(), [&](const Course& of) {
        const double last = chosen.empty() ? (*of.points)[i] : (*of.looks)[chosen.back()];
        return std::abs((*of.looks)[j] - last) > kOnePoint * of.range;
      });
      if (against && far) chosen.push_back(j);
    }
    for (const Course& of : courses) {
      if (against || first[i] == first[i + 1]) continue;
      const auto least = std::minmax_element(of.looks->begin() + std::ptrdiff_t(first[i]),
                                             of.looks->begin() + std::ptrdiff_t(first[i + 1]));
      for (const auto& end : {least.first, least.second})
        chosen.push_back(std::size_t(end - of.looks->begin()));
    }
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (const std::size_t j : chosen)
      if (looks.times[j] < plot.times[i + 1]) take(looks, j);
  }
  plot = std::move(all);
}

}  // namespace obscura::app
