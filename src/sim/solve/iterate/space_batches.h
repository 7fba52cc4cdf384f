#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sim/constraint/response.h"
#include "sim/solve/iterate/contact_constraint.h"

namespace obscura::sim {

/// Bodies whose contacts are still to be iterated: those of a contact that an iteration changed by more than
/// `settled`. Contacts of bodies on joints are never among them.
struct ActiveBodies {
  static constexpr unsigned char kNow = 1, kNext = 2, kNever = 4;
  double settled = 0;                 // widths of the narrower body, 1/s
  bool friction = false;              // whether changes of friction count
  std::vector<unsigned char> bodies;  // flags; one more for walls, which never are

  bool any() const {
    return std::any_of(bodies.begin(), bodies.end(), [](unsigned char flags) { return flags & kNow; });
  }
};

/// The contacts of space, four pairs side by side that share no body which moves. They come to what one pair
/// after another would, in the order of their keys: so a blow passes through a column in one iteration.
class SpaceBatches {
 public:
  static constexpr int kLanes = 4;

  /// Lays out the contacts `which`, ascending, of `contacts`, in which those of a pair follow each other.
  void build(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
             std::span<const PointBody<3>> bodies);

  /// Impulses and aims of the contacts anew, where they have changed since.
  void load(std::span<const ContactConstraint<3>> contacts);
  /// Their impulses into the contacts.
  void store(std::span<ContactConstraint<3>> contacts) const;

  /// One iteration over all of them, in order or back.
  void iterate(std::span<PointBody<3>> bodies, bool back);

  /// One iteration of those of `active` bodies alone; then says whose are next. Returns how many contacts
  /// that were.
  int iterate(std::span<PointBody<3>> bodies, bool back, ActiveBodies& active);

  /// Begins to accelerate iterations by conjugate directions: keeps the impulses.
  void begin_directions();
  /// After some iterations: goes on along the directions that they and those before took (Fletcher and
  /// Reeves), back into the friction cones; begins anew where they come to more than those before.
  void follow_directions(std::span<PointBody<3>> bodies);

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
    int first = 0, count = 0;        // rows
    unsigned char used = 0;          // a bit a lane
  };

 private:
  // the contacts of a pair, `which` from first on
  struct Pair {
    int a, b, first, count, level;
  };

  void find_pairs(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
                  std::span<const PointBody<3>> bodies);
  void add(const Pair& pair, int lane, std::span<const ContactConstraint<3>> contacts,
           std::span<const int> which);

  std::vector<Pair> pairs_, sorted_;
  std::vector<int> begin_;   // of each level and number of contacts, among the sorted
  std::vector<int> levels_;  // of each body: that of its next pair
  std::vector<Batch> batches_;
  std::vector<Row> rows_;
  std::vector<Belt> belts_;                   // of rows; empty where there are none
  std::vector<Impulses> before_, direction_;  // of rows
  double change_ = 0;                         // by the iterations before, squared; 0: begins
};

}  // namespace obscura::sim
