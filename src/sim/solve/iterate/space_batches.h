#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/constraint/response.h"
#include "sim/math/workers.h"
#include "sim/solve/iterate/contact_constraint.h"
#include "sim/solve/iterate/pair_levels.h"
#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/settling.h"

namespace obscura::sim {

/// The contacts of space, four pairs side by side that share no body which moves. They come to what one pair
/// after another would, in the order of their keys: so a blow passes through a column in one iteration.
class SpaceBatches {
 public:
  static constexpr int kLanes = 4;

  /// The pairs of a level (sort()) are shared by the workers; null: there are none.
  explicit SpaceBatches(std::shared_ptr<Workers> workers) : workers_(std::move(workers)) {}

  /// Sorts the pairs of the contacts `which`, ascending, of `contacts`, in which those of a pair follow each
  /// other, by levels, before the following.
  void sort(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
            std::span<const PointBody<3>> bodies);
  /// act(first, end) for each pair, with the range of its contacts among `which`. Pairs of a level, which
  /// share no body that moves, may be at once; so each body that moves sees its pairs in the order of
  /// `which`. What does not move is not to be written.
  template <class Act>
  void each_pair(const Act& act) const {
    for (std::size_t level = 0; level + 1 < pair_begins_.size(); ++level) {
      const int first = pair_begins_[level];
      each(workers_.get(), pair_begins_[level + 1] - first, kBodyPiece, [&](int begin, int end) {
        for (auto i = std::size_t(first + begin); i < std::size_t(first + end); ++i)
          act(sorted_[i].first, sorted_[i].first + sorted_[i].count);
      });
    }
  }
  /// Lays them out; after sort() of the same.
  void build(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
             std::span<const PointBody<3>> bodies);
  /// Says which islands their bodies are of, before the following.
  void set_islands(const Settling& settling);

  /// Impulses and aims of the contacts anew, where they have changed since.
  void load(std::span<const ContactConstraint<3>> contacts);
  /// Their impulses into the contacts.
  void store(std::span<ContactConstraint<3>> contacts) const;

  /// One iteration over all of them, in order or back.
  void iterate(std::span<PointBody<3>> bodies, bool back);

  /// One iteration of those of active bodies alone; says which bodies and islands it changed.
  void iterate(std::span<PointBody<3>> bodies, bool back, Settling& settling);

  /// Begins to accelerate iterations by conjugate directions: keeps the impulses.
  void begin_directions();
  /// After some iterations: goes on along the directions that they and those before took (Fletcher and
  /// Reeves), back into the friction cones, island by island; begins anew where they come to more than those
  /// before.
  void follow_directions(std::span<PointBody<3>> bodies, Settling& settling);

  /// One contact point of four pairs.
  struct alignas(64) Row {
    double n[3][kLanes], arm_a[3][kLanes], arm_b[3][kLanes], askew[3][kLanes];
    double per_normal[kLanes], across[kLanes], per_across[kLanes];
    double least[kLanes], normal_impulse[kLanes], tangent_impulse[3][kLanes];
    int contact[kLanes];  // -1: none
  };
  struct alignas(32) Impulses {
    double normal[kLanes], tangent[3][kLanes];
  };
  struct alignas(32) Belt {
    double speed[3][kLanes];
  };
  struct alignas(32) Batch {
    double mu[kLanes], per_width[kLanes];
    int a[kLanes], b[kLanes];        // bodies; of unused lanes the one after the last
    int at_a[kLanes], at_b[kLanes];  // where they are, in fours of numbers
    int island[kLanes];
    int first = 0, count = 0;  // rows
    int level = 0, first_pair = 0, lanes = 0;
    unsigned char used = 0;             // a bit a lane
    unsigned char on = 0, changed = 0;  // likewise: what the last iteration of some did
  };

 private:
  // the contacts of a pair, `which` from first on
  struct Pair {
    int a, b, first, count, level;
  };

  void lay_out();
  void fill(Batch& batch, std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
            int none);
  void add(Batch& batch, int lane, std::span<const ContactConstraint<3>> contacts,
           std::span<const int> which);
  void load(Row& row, int lane, const ContactConstraint<3>& from);
  void find_open_levels();
  template <class Act>
  void by_level(std::span<const int> begins, bool back, const Act& act) const;

  std::shared_ptr<Workers> workers_;
  std::vector<Pair> pairs_, sorted_;
  std::vector<int> begin_;        // of each level and number of contacts, among the sorted
  std::vector<int> pair_begins_;  // of each level, and where they end
  PairLevels levels_;
  std::vector<Batch> batches_;
  std::vector<int> level_begins_, open_begins_;  // among batches_ and open_, and where they end
  std::vector<Row> rows_;
  std::vector<Belt> belts_;                   // of rows; empty where there are none
  std::vector<Impulses> before_, direction_;  // of rows
  std::vector<int> open_;                     // batches with islands that have not settled
};

}  // namespace obscura::sim
