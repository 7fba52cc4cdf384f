#include "app/variation.h"

#include <fmt/format.h>

#include "app/exit.h"
#include "sim/rational.h"

namespace obscura::app {

Variation::Variation(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == text.npos || equals + 1 == text.size())
    throw UsageError(fmt::format("--vary {}: expected PATH=VALUES, as in crate.elasticity=0,0.5,1", text));
  path = text.substr(0, equals);
  const std::string_view list = text.substr(equals + 1);
  // commas within brackets are a value's own
  std::size_t depth = 0, from = 0;
  for (std::size_t i = 0; i <= list.size(); ++i) {
    if (i < list.size() && list[i] == '[') ++depth;
    if (i < list.size() && list[i] == ']' && depth > 0) --depth;
    if (i < list.size() && (list[i] != ',' || depth > 0)) continue;
    values.emplace_back(list.substr(from, i - from));
    from = i + 1;
  }
}

std::string Variation::name() const {
  const auto dot = path.rfind('.');
  return dot == path.npos ? path : path.substr(dot + 1);
}

double Variation::number(const std::string& value) const {
  const auto found = sim::parse_rational(value);
  if (!found) throw UsageError(fmt::format("a plot over {}: {} is no number", path, value));
  return sim::value(*found);
}

}  // namespace obscura::app
