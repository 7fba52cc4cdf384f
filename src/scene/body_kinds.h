#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "scene/complaints.h"
#include "scene/fields.h"
#include "scene/table.h"
#include "sim/model/model.h"

namespace obscura::scene {

/// How a kind of body gets its form in D dimensions: which of sim::Forms<D> it is counted as, and what makes
/// it from the i-th of n copies of a checked table. Complains, and makes some form, where that table says
/// none.
template <int D>
struct Maker {
  int form;  // -1: there is no such kind in D dimensions
  sim::Shape<D> (*make)(const Fields& fields, int i, int n, Diagnostics& complaints);
};

/// A kind of body. No member has a default, so that a row that leaves one out does not compile.
struct BodyKind {
  std::string_view name;            // of its table: "ball" for [[ball]]
  std::string_view called, plural;  // where bodies are counted by what they are made of
  std::string_view doc;             // one line
  int dimension;                    // 2, 3: of the plane, of space only; 0: of both
  std::string_view instead;         // what there is in the other
  bool turns;                       // whether it can
  bool handout;                     // whether the handout's collisions know it
  bool own_origin;                  // its frame is that of the points or parts that are typed
  bool varies;                      // its form may vary over its copies
  std::string_view measure;         // the key that says how large it is
  std::uint64_t stream;             // of random numbers: of its first table
  std::vector<Key> (*keys)();       // those of its form
  Maker<2> plane;
  Maker<3> space;

  template <int D>
  constexpr const Maker<D>& maker() const {
    if constexpr (D == 2) {
      return plane;
    } else {
      return space;
    }
  }
};

/// All kinds of body: those that do not turn first, as the model has them.
std::span<const BodyKind> body_kinds();

/// The kind that a body is counted as: a round body that does not turn is a particle; one that is tilted and
/// does not turn is a compound of one part, and counts as that part.
template <int D>
const BodyKind& kind_of(const sim::Body<D>& body);

}  // namespace obscura::scene
