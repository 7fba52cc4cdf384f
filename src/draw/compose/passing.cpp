// Words that come over others in passing are not seen there. At the instants t_k at which the run is known
// they are as strong as s_k, less where they lie deeper in others that are seen, and in between
//   s(t) = min over k of  s_k + (1 - s_k) S(|t - t_k| / T)      S(u) = u² (3 - 2 u), T the time of fading
// So they come and go in a while, however briefly something passes, and a frame does not depend on others.

#include "draw/compose/passing.h"

#include <algorithm>
#include <cmath>

namespace obscura::draw {
namespace {

constexpr double kFading = 0.3;  // s of the film

// how deep words lie in others, 0 to 1
double depth(const Standing& own, const Standing& other) {
  const Point both = own.size + other.size;
  const Point deep = kNearWords * both - (own.center - other.center).cwiseAbs();
  if (!(deep.x() > 0 && deep.y() > 0)) return 0;
  return std::min(1.0, deep.cwiseQuotient((kNearWords - 0.5) * both).minCoeff());
}

}  // namespace

void plan_passing(const std::vector<std::vector<Standing>>& instants, const std::vector<double>& films,
                  LabelPlan& plan) {
  for (std::size_t k = 0; k < instants.size(); ++k) {
    // those that do not move go before all others
    std::vector<Standing> words = instants[k];
    std::stable_partition(words.begin(), words.end(), [](const Standing& each) { return each.stays; });
    std::vector<double> seen(words.size(), 1);
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto course = plan.courses.find(words[i].key);
      if (course == plan.courses.end() || !course->second.yields) continue;
      for (std::size_t n = 0; n < i; ++n) {
        const double other = std::min(1.0, 2 * seen[n] * words[n].strength);
        seen[i] = std::min(seen[i], 1 - depth(words[i], words[n]) * other);
      }
      if (seen[i] < 1) course->second.dims.push_back({films[k], seen[i]});
    }
  }
}

double strength(const LabelPlan::Course& course, double film) {
  const auto from = std::lower_bound(course.dims.begin(), course.dims.end(), film - kFading,
                                     [](const LabelPlan::Dim& dim, double t) { return dim.film < t; });
  double least = 1;
  for (auto dim = from; dim != course.dims.end() && dim->film < film + kFading; ++dim) {
    const double u = std::abs(film - dim->film) / kFading;
    least = std::min(least, dim->strength + (1 - dim->strength) * u * u * (3 - 2 * u));
  }
  return least;
}

}  // namespace obscura::draw
