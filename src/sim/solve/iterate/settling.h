#pragma once

#include <span>
#include <vector>

#include "sim/constraint/response.h"
#include "sim/math/islands.h"
#include "sim/solve/iterate/contact_constraint.h"

namespace obscura::sim {

/// Iterations that go on until contacts have settled, island by island, so that how far one gets does not
/// hang on the others. Contacts of bodies on joints are left out.
struct Settling {
  static constexpr unsigned char kNow = 1, kNext = 2, kNever = 4;

  /// Bodies that move and touch each other, directly or through others.
  struct Island {
    int contacts = 0, quiet = 0;  // of these, those of pairs that are (sim/solve/iterate/substeps.h)
    int budget = 0, spent = 0;    // contacts times iterations
    double rate = 0;         // the fastest that its bodies pass each other, in widths of the narrower, 1/s
    double mass = 0;         // kg, of its bodies
    double settled = 0;      // widths, 1/s: smaller corrections count as none
    double enough = 0;       // J: what an accelerated iteration may change, for its budget to be spent
    bool friction = false;   // whether those of friction count
    bool follows = false;    // whether it is accelerated by conjugate directions
    bool open = true;        // whether it has neither settled nor spent its budget
    bool exhausted = false;  // whether it has spent its budget and not settled
    bool changed = false;    // whether the last iteration made larger corrections
    double change = 0, before = 0;  // by the last iterations, and those before, squared; 0: begins
    double share = 0;               // of the directions along which it goes on
    int first = 0, last = 0;        // its bodies, in `bodies`
  };
  std::vector<Island> islands;
  std::vector<int> island_of;        // of each body, and of walls; -1: it does not move
  std::vector<int> bodies;           // island by island
  std::vector<unsigned char> flags;  // of each body: its contacts are iterated now, next, never

  /// The islands of the bodies that the contacts `which` join, of which those of a pair follow each other;
  /// all are open. `never`: bodies on joints.
  void begin(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
             std::span<const PointBody<3>> moving, std::span<const int> never);
  /// After an iteration there and back: islands whose bodies move as after the last one have not changed,
  /// whatever single contacts say. Among the corners of a face, for which no velocities may be right,
  /// impulses wander for thousands of iterations. `radii`: of the bodies, m.
  void compare_velocities(std::span<const PointBody<3>> moving, std::span<const double> radii);
  /// After an iteration: closes islands that have settled or spent their budget. Whether any is left.
  bool close_settled();
  /// The bodies that the last iteration named are iterated now; of islands that follow, all.
  void activate_next();

  bool narrowed = false;  // islands have closed since the last iteration

 private:
  struct Pair {
    int a, b, contacts = 0;
    double rate = 0;
  };

  Islands sets_;
  std::vector<Pair> pairs_;
  std::vector<PointBody<3>> before_;
};

}  // namespace obscura::sim
