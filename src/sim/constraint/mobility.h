#pragma once

#include <array>
#include <vector>

#include "sim/constraint/response.h"

namespace obscura::sim {

// When bodies are set at rest: one rule for all solvers, in proportion to gravity g and to the room's height
// L, so that a room scaled in both rests alike. Without gravity nothing presses a contact, and only what does
// not move at all rests. An island is
//   asked     where no point has been faster than Slow::asked for kWait
//   balanced  where forces within the laws of contacts and joints leave no acceleration
//   held      where those contacts and joints leave its motion no freedom (Mobility)
// and then set at rest. Balance alone proves nothing of motion: a ball that rolls is balanced too.

inline constexpr double kWait = 0.25;  // s

/// Speeds that rest goes by, m/s.
struct Slow {
  double asked = 0;  // what gravity gives in a five-hundredth of a second
  double none = 0;   // 1e-8 sqrt(g L): slower than this is no motion
};

template <int D>
Slow slow(const Model<D>& model);

/// A contact of two bodies, for what asks whether it bears or holds them.
template <int D>
struct BearingContact {
  int a = -1, b = -1;                                     // bodies that would move; -1: none
  Vec<D> normal = Vec<D>::Zero();                         // unit, towards a
  Vec<D> arm_a = Vec<D>::Zero(), arm_b = Vec<D>::Zero();  // from their centres, m
  double friction = 0;
  Vec<D> force = Vec<D>::Zero();  // on a, N; a first guess, and what is found
};

/// Whether a point of a set of bodies moves freely, by more than Slow::none; unknown where some hundred
/// rounds do not tell.
enum class Mobile { no, yes, unknown };

/// The motion that contacts and joints leave free of the velocities v:
///   v_free = v - M^-1 J' l,   J v_free = 0
/// J has the rows of joints, of the normals of pressing contacts, and of their tangents if the remaining
/// friction (mu f_n less the present load) can stop the slip at once.
template <int D>
class Mobility {
 public:
  /// Kept by reference.
  explicit Mobility(const Model<D>& model);

  /// Forgets all bodies and rows.
  void clear();

  /// A body that moves, with its orientation. Bodies that were not added count as fixed.
  void add(int body, const Vec<D>& v, const AngularVec<D>& w, const Rotation<D>& room_from_body);

  /// After all bodies: a contact with its force. One that does not press holds nothing.
  void add_contact(const BearingContact<D>& touch);

  /// A row of a joint. `spare`: the acceleration (m/s^2 or rad/s^2) that the row can still give, its bound
  /// less its present load; infinite for an equality. A row with bounds counts as holding if `spare` can stop
  /// its motion at once.
  void add_row(const Row<D>& row, double spare);

  Mobile mobile();

 private:
  using Way = typename Side<D>::Way;

  struct Held {
    std::array<Side<D>, 2> sides;
    std::vector<Side<D>> more;        // of a mechanism
    double give = 0;                  // 1 / (J M^-1 J')
    double off = 0, way = 0, by = 0;  // of conjugate gradients: J v; direction; J M^-1 J' direction
  };
  struct Moving {
    int body;
    Rotation<D> room_from_body;
    Way v, change;
  };

  Side<D> side(int body, const Vec<D>& along, const AngularVec<D>& turn) const;
  double moves(const Held& row) const;
  void keep(Held row);
  template <class Act>
  static void each_side(Held& row, Act&& act) {
    for (Side<D>& side : row.sides) act(side);
    for (Side<D>& side : row.more) act(side);
  }
  template <class Act>
  static void each_side(const Held& row, Act&& act) {
    for (const Side<D>& side : row.sides) act(side);
    for (const Side<D>& side : row.more) act(side);
  }
  double fastest() const;

  const Model<D>& model_;
  Slow slow_;
  double g_ = 0;
  std::vector<double> bounding_radius_;
  std::vector<int> columns_;  // of a body in bodies_, or -1
  std::vector<Moving> bodies_;
  std::vector<Held> rows_;
};

}  // namespace obscura::sim
