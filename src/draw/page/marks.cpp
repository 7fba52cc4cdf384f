#include "draw/page/marks.h"

#include <algorithm>

namespace obscura::draw {

Marks::Marks() = default;
Marks::Marks(const Marks&) = default;
Marks::Marks(Marks&&) noexcept = default;
Marks& Marks::operator=(const Marks&) = default;
Marks& Marks::operator=(Marks&&) noexcept = default;
Marks::~Marks() = default;

bool Marks::empty() const {
  return !axes && points.empty() && vectors.empty() && angles.empty() && lengths.empty() && cones.empty() &&
         labels.empty() && names.empty() && paths.empty() && ghosts.empty();
}

bool Marks::fixed() const {
  Marks others = *this;
  others.labels.clear();
  return others.empty() && std::all_of(labels.begin(), labels.end(), [](const Label& label) {
           return label.at.body < 0 && label.quantity.empty();
         });
}

}  // namespace obscura::draw
