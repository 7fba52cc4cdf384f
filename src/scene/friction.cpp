#include "scene/friction.h"

#include <fmt/format.h>

namespace obscura::scene {

std::optional<double> static_friction(const Fields& fields, std::optional<double> friction,
                                      Diagnostics& complaints, int i, int n) {
  const Node* given = fields.given("static_friction");
  if (!given) return {};
  const double mu = number(*given, i, n);
  if (!friction || mu < *friction)
    complaints.add(given->place,
                   friction ? fmt::format("'static_friction' is that of what does not slip: at least "
                                          "'friction', {:g} here",
                                          *friction)
                            : std::string("'static_friction' needs 'friction', of what slips, beside it"));
  return mu;
}

}  // namespace obscura::scene
