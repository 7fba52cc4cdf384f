// Rails and wires within the exact solver: which part of a curve a body is on, and where it comes to the
// next.
//
// A contact or bead keeps its run of the curve through an interval, however far the stages reach beyond it,
// so that all is smooth there. The interval is cut where the run ends; the next begins on the run that
// follows. Where a curve crosses itself, what is on one part of it does not feel the other: the contacts of
// the step before, and State::on_piece of beads, tell which part that is. What comes upon a rail from behind
// passes: only a gap that was open counts when it closes.

#include <algorithm>
#include <cmath>

#include "sim/constraint/joints/pulley.h"
#include "sim/constraint/joints/wire.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kNoEvent = 2;        // a part of the interval
constexpr double kAtTheStart = 1e-9;  // a part too short to go
constexpr double kSamePart = 1e-6;    // of the length of a curve: places so near are on one part of it
constexpr double kBehind = 1e-5;      // of its radius: what is deeper in a rail at first has come from behind
constexpr double kPointBehind = 2e-6;  // of the room: the same of a point
constexpr double kLeftBehind = 2e-3;   // of the room: how deep a rough step leaves what is not from behind
constexpr double kFinePart = 0.25;     // of the depth that is seen: how far to go between two looks
constexpr double kFastestPart = 2.5;   // of its way: how fast one goes in its interval, at most
constexpr int kMostRailLooks = 20000;  // of a couple in an interval
constexpr double kAtEnd = 1e-9;        // of its length: what is so near an end of a curve is at it
constexpr double kSteady = 1e-13;      // of the friction on a wire: it no longer changes

// how far along its curve the foot of a candidate is, m
template <int D>
double along_of(const ContactCandidate<D>& gap, const std::vector<BodyMotion<D>>& at) {
  return rail_place(gap, at[std::size_t(gap.key.a)], at[std::size_t(gap.key.b)]).foot.along;
}

template <int D>
double radius_of(const ContactCandidate<D>& gap) {
  return std::max(gap.radius_a, gap.radius_b);
}

// whether a bead has come to an open end that lets go, and goes on; `slack`: so near to it, m
template <int D>
bool leaves(const Joint<D>& wire, const WirePlace<D>& bead, double slack) {
  if (!wire.lets_go || bead.speed == 0) return false;
  const Curve<D>& curve = *wire.curve;
  const bool forward = bead.speed > 0;
  if (curve.next(bead.foot.piece, forward)) return false;
  const double past = curve.beyond(bead.foot);
  if (past != 0) return (past > 0) == forward;
  const auto& run = curve.piece(bead.foot.piece);
  return forward ? bead.foot.along > run.start + run.length - slack : bead.foot.along < run.start + slack;
}

}  // namespace

// gaps of rails below the margin, onto scratch_.on_rails
template <int D>
void ExactSolver<D>::near_rails(const std::vector<BodyMotion<D>>& at, Couple couple, double margin) {
  const auto add = [&](int a, int b) {
    if (!has_rails(b) || !touches_rails(model_.bodies[std::size_t(a)].shape)) return;
    const double far = limits_.bounding_radius[a] + limits_.bounding_radius[b] + margin;
    if ((at[a].x - at[b].x).squaredNorm() > far * far) return;
    for (const int number : limits_.rails[std::size_t(b)])
      collide_rail(a, model_.bodies[a].shape, at[a], b, number, model_.rails[std::size_t(number)], at[b],
                   margin, model_.scale, scratch_.on_rails);
  };
  if (couple.b < 0) return;
  add(couple.a, couple.b), add(couple.b, couple.a);
}

// where the contacts that the last interval left are along the rail of a key
template <int D>
void ExactSolver<D>::known_places(const ContactKey& key, std::vector<double>& along) const {
  along.clear();
  const Rail<D>* rail = rail_of(model_, key);
  if (!rail || !progress_.known) return;
  const RailFeature own = RailFeature::of(key.feature);
  auto known = std::lower_bound(progress_.known->begin(), progress_.known->end(), ContactKey{key.a, key.b, 0},
                                [](const Contact<D>& c, const ContactKey& k) { return c.key < k; });
  for (; known != progress_.known->end() && known->key.a == key.a && known->key.b == key.b; ++known) {
    if (rail_of(model_, known->key) != rail) continue;
    const RailFeature its = RailFeature::of(known->key.feature);
    if (its.vertex != own.vertex || its.piece >= rail->curve->size()) continue;
    const BodyMotion<D>& at = poses_[std::size_t(rail->body)];
    const Vec<D> local = at.room_from_body.transpose() * (known->point - at.x);
    along.push_back(rail->curve->foot(its.piece, local).along);
  }
}

// leaves of the candidates of rails those that touch: see above
template <int D>
void ExactSolver<D>::choose_rail_contacts() {
  std::vector<double> known;
  const auto motion = [&](const ContactCandidate<D>& gap) {
    const RailPlace<D> its = rail_place(gap, poses_[gap.key.a], poses_[gap.key.b]);
    return std::abs(its.speed) > still_speed_ ? its.speed : its.tangent.dot(model_.gravity);
  };
  const auto same_vertex = [&](const ContactCandidate<D>& p, const ContactCandidate<D>& q) {
    const RailFeature f = RailFeature::of(p.key.feature), g = RailFeature::of(q.key.feature);
    return p.key.a == q.key.a && p.key.b == q.key.b && f.rail == g.rail && f.vertex == g.vertex;
  };
  const auto closing = [&](const ContactCandidate<D>& gap, const Rail<D>& rail) {
    const RailPlace<D> at = rail_place(gap, poses_[gap.key.a], poses_[gap.key.b]);
    const BodyMotion<D>&own = poses_[gap.key.a == rail.body ? gap.key.b : gap.key.a],
          &its = poses_[rail.body];
    return at.normal.dot(its.velocity(Vec<D>(at.point - its.x)) - own.velocity(Vec<D>(at.point - own.x)));
  };
  // whether the middle of the body is on the side that touches
  const auto in_front = [&](const ContactCandidate<D>& gap, const Rail<D>& rail) {
    if (D == 3) return true;
    const BodyMotion<D>&own = poses_[gap.key.a == rail.body ? gap.key.b : gap.key.a],
          &its = poses_[rail.body];
    const Vec<D> middle = its.room_from_body.transpose() * (own.x - its.x);
    const auto foot = rail.curve->nearest(middle);
    const Vec<D> e = middle - foot.at.x;
    return gap.side * (foot.at.tangent[0] * e[1] - foot.at.tangent[1] * e[0]) > 0;
  };
  // nothing that has come from behind; what a rough step has left in a rail comes on, that from behind goes
  std::erase_if(candidates_, [&](const ContactCandidate<D>& gap) {
    const Rail<D>* rail = rail_of(model_, gap.key);
    if (!rail) return false;
    const double r = radius_of(gap);
    if (gap.value > -(r > 0 ? kBehind * r : kPointBehind * model_.scale)) return false;
    known_places(gap.key, known);
    if (!known.empty()) return false;
    return !gap.curve || gap.value < -kLeftBehind * model_.scale || !in_front(gap, *rail) ||
           closing(gap, *rail) <= still_speed_;
  });
  std::vector<char> out(candidates_.size(), 0);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const ContactCandidate<D>& p = candidates_[i];
    const Rail<D>* rail = rail_of(model_, p.key);
    if (!rail || out[i]) continue;
    const Curve<D>& curve = *rail->curve;
    known_places(p.key, known);
    const RailFeature f = RailFeature::of(p.key.feature);
    const double along = p.curve ? along_of(p, poses_) : f.end == 1 ? 0 : curve.length();
    for (const double other : known)
      if (curve.conflict(along, other)) out[i] = 1;
    for (std::size_t j = i + 1; j < candidates_.size() && !out[i]; ++j) {
      const ContactCandidate<D>& q = candidates_[j];
      if (out[j] || !same_vertex(p, q)) continue;
      const RailFeature g = RailFeature::of(q.key.feature);
      const double its = q.curve ? along_of(q, poses_) : g.end == 1 ? 0 : curve.length();
      if (known.empty() && curve.conflict(along, its)) {
        out[along <= its ? j : i] = 1;
        continue;
      }
      if (curve.apart(along, its) > kSamePart * curve.length()) continue;
      if (f.left != g.left) {
        // a point on a rail of two sides: on that where it was, or where it comes from
        const auto was = [&](bool left) {
          return std::any_of(progress_.known->begin(), progress_.known->end(), [&](const Contact<D>& c) {
            return c.key.a == p.key.a && c.key.b == p.key.b && rail_of(model_, c.key) == rail &&
                   RailFeature::of(c.key.feature).left == left;
          });
        };
        const bool left = was(true), right = was(false);
        bool stays = f.left;
        if (left != right) {
          stays = left;
        } else {
          const double by = closing(p, *rail);
          const double down = rail_place(p, poses_[p.key.a], poses_[p.key.b]).normal.dot(model_.gravity);
          const bool away = std::abs(by) > still_speed_ ? by < 0 : down > 0;
          stays = away ? !f.left : f.left;
        }
        out[stays == f.left ? j : i] = 1;
      } else if (p.curve && q.curve) {
        // the joint of two runs: the one that it goes to
        const bool forward = motion(p) > 0;
        const bool q_later =
            curve.next(p.piece, true) == q.piece ||
            curve.piece(curve.next(p.piece, true).value_or(0)).run == curve.piece(q.piece).run;
        out[forward == q_later ? i : j] = 1;
      } else if (p.curve || q.curve) {
        // an open end: beyond it, if it goes there
        const ContactCandidate<D>& on = p.curve ? p : q;
        const int end = p.curve ? g.end : f.end;
        const double way = motion(on);
        const bool leaves = end == 2 ? way > 0 : way < 0;
        out[leaves == (p.curve != nullptr) ? i : j] = 1;
      }
    }
  }
  // what has come to an open end leaves it; a ball and a face have another gap for the end itself
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const ContactCandidate<D>& gap = candidates_[i];
    if (out[i] || !gap.curve || gap.curve->closed()) continue;
    const double along = along_of(gap, poses_), slack = kAtEnd * gap.curve->length();
    if (along > slack && along < gap.curve->length() - slack) continue;
    const double way = motion(gap);
    out[i] = along > slack ? way > 0 : way < 0;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    if (!out[i]) candidates_[kept++] = candidates_[i];
  candidates_.resize(kept);
}

// the part of the interval at which a couple closes on a rail, beyond what is held. Moves their stances.
template <int D>
double ExactSolver<D>::rail_closing_time(const State<D>& state, double h, Couple couple) {
  const int a = couple.a, b = couple.b;  // no binding: lambdas of clang 14 cannot hold one
  const double ways = travel(state, a, h) + travel(state, b, h), touch = limits_.touching_gap;
  std::vector<double> known;
  double depth = model_.scale;
  // the side of each rail that each vertex or face is on: 1 and -1; 0 where it is behind it, or far
  struct Front {
    int rail, vertex, side;
    bool near;
  };
  std::vector<Front> fronts;
  const auto front_of = [&](const RailFeature& its) -> Front& {
    for (Front& front : fronts)
      if (front.rail == its.rail && front.vertex == its.vertex) return front;
    return fronts.emplace_back(Front{its.rail, its.vertex, 0, false});
  };
  for (const ContactCandidate<D>& gap : candidates_) {
    if (gap.key.a != a || gap.key.b != b || !rail_of(model_, gap.key)) continue;
    const RailFeature its = RailFeature::of(gap.key.feature);
    front_of(its).side = its.left ? 1 : -1;
  }
  // whether one of the places that are held
  const auto is_held = [&](const ContactCandidate<D>& gap, const Rail<D>& rail, const RailFeature& its,
                           double along) {
    for (const Constraint& one : constraints_) {
      if (one.kind != Constraint::Kind::contact || !active(one)) continue;
      const ContactCandidate<D>& held = candidates_[one.of];
      if (held.key.a != gap.key.a || held.key.b != gap.key.b || rail_of(model_, held.key) != &rail) continue;
      const RailFeature other = RailFeature::of(held.key.feature);
      if (other.vertex != its.vertex) continue;
      double there = other.end == 1 ? 0 : rail.curve->length(), past = 0;
      if (held.curve) {
        const auto foot = rail_place(held, poses_[held.key.a], poses_[held.key.b]).foot;
        there = foot.along, past = std::abs(rail.curve->beyond(foot));
      }
      // the held place itself, beyond the end of its run the one beside it; a point on both sides
      if (rail.curve->apart(along, there) < 2 * past + kSamePart * rail.curve->length() ||
          rail.curve->conflict(along, there))
        return true;
    }
    return false;
  };
  // the least gap of what is in front; `look`: of the next instant, which may bring more to the front
  const auto least = [&](double part, bool look) {
    if (shifts(a)) poses_[a] = pose_at(state, a, h, part);
    if (shifts(b)) poses_[b] = pose_at(state, b, h, part);
    scratch_.on_rails.clear();
    near_rails(poses_, couple, ways + touch);
    double value = 1e300;
    for (Front& front : fronts) front.near = false;
    for (const ContactCandidate<D>& gap : scratch_.on_rails) {
      const Rail<D>& rail = *rail_of(model_, gap.key);
      const RailFeature its = RailFeature::of(gap.key.feature);
      Front& front = front_of(its);
      const int side = its.left ? 1 : -1;
      front.near = true;
      if (look && front.side == 0 && gap.value >= -touch) front.side = side;
      if (front.side != side) continue;
      const double along = gap.curve ? along_of(gap, poses_) : its.end == 1 ? 0 : rail.curve->length();
      if (is_held(gap, rail, its, along)) continue;
      known_places(gap.key, known);
      if (std::any_of(known.begin(), known.end(),
                      [&](double other) { return rail.curve->conflict(along, other); }))
        continue;
      value = std::min(value, gap.value);
      depth = std::min(depth, deepest_in_rail(radius_of(gap), model_.scale));
    }
    for (Front& front : fronts)
      if (look && !front.near) front.side = 0;
    return value;
  };
  double part = 0, value = least(0, true);
  bool open = value >= -touch;
  const bool touching = std::abs(value) <= touch;
  for (int looks = 0; part < 1 && looks < kMostRailLooks; ++looks) {
    const double spare = value < 1e299 ? std::max(0.0, value) : ways;
    const double step = std::max(spare / (kFastestPart * ways), kFinePart * depth / ways);
    const double next = std::min(1.0, part + step);
    const double at_next = least(next, true);
    progress_.searches += looks > 0;
    if (open && at_next < -touch) {
      double low = part, high = next, below = at_next;
      for (int i = 0; i < 60 && high - low > 1e-15 && below < -0.1 * touch; ++i) {
        const double middle = 0.5 * (low + high), there = least(middle, false);
        if (there >= 0) {
          low = middle;
        } else {
          high = middle, below = there;
        }
      }
      // one that has come from behind shows itself at a depth
      if (below > -10 * touch) return touching && high < kAtTheStart ? force_couple(couple) : high;
    }
    open = at_next >= -touch;
    part = next, value = at_next;
  }
  return kNoEvent;
}

// the part of the interval at which the first contact or bead comes to the end of its run
template <int D>
double ExactSolver<D>::passing_time(const State<D>& state, double h) {
  double first = kNoEvent;
  // beyond(part): metres past the end of the run, of either sign; 0 within it
  const auto find = [&](const auto& beyond) {
    const double at_end = beyond(1);
    if (std::abs(at_end) <= limits_.touching_gap) return;
    double low = 0, high = 1;
    for (int i = 0; i < 60 && high - low > 1e-16; ++i) {
      const double middle = 0.5 * (low + high), there = beyond(middle);
      (there * at_end > 0 ? high : low) = middle;
    }
    // one that begins beyond goes on as it is
    if (high > kAtTheStart) first = std::min(first, high);
  };
  const auto pose = [&](int body, double part) {
    if (body >= 0 && shifts(body)) poses_[std::size_t(body)] = pose_at(state, body, h, part);
  };
  const auto restore_pose = [&](int body) {
    if (body >= 0 && shifts(body)) poses_[std::size_t(body)] = end_pose(state, body);
  };
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact) {
      const ContactCandidate<D>& gap = candidates_[constraint.of];
      if (!gap.curve || !active(constraint)) continue;
      find([&](double part) {
        pose(gap.key.a, part), pose(gap.key.b, part);
        return gap.curve->beyond(rail_place(gap, poses_[gap.key.a], poses_[gap.key.b]).foot);
      });
      restore_pose(gap.key.a), restore_pose(gap.key.b);
    } else if (constraint.kind == Constraint::Kind::joint) {
      const Joint<D>& joint = model_.joints[constraint.of];
      if (joint.kind != JointKind::wire) continue;
      static const BodyMotion<D> room;
      const AngularVec<D> turn = wire_pose(constraint.of);
      find([&](double part) {
        pose(joint.a.body, part), pose(joint.b.body, part);
        const BodyMotion<D>& b = joint.b.body < 0 ? room : poses_[joint.b.body];
        const auto foot = wire_place<D>({joint, poses_[joint.a.body], b, turn}).foot;
        const double past = joint.curve->beyond(foot);
        // open ends are limits, or let go
        return past != 0 && !joint.lets_go && !joint.curve->next(foot.piece, past > 0) ? 0 : past;
      });
      restore_pose(joint.a.body), restore_pose(joint.b.body);
    }
  }
  return first;
}

// --- wires

template <int D>
AngularVec<D> ExactSolver<D>::wire_pose(int joint) const {
  AngularVec<D> turn = AngularVec<D>::Zero();
  turn[0] = on_piece_[std::size_t(joint)];
  return turn;
}

// the pieces that beads are on, from where they were: at a joint of two runs the one that they go to
template <int D>
void ExactSolver<D>::follow_wires(const State<D>& state) {
  static const BodyMotion<D> room;
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[std::size_t(i)];
    if (joint.kind != JointKind::wire || state.broken[std::size_t(i)]) continue;
    const BodyMotion<D>&a = poses_[joint.a.body], &b = joint.b.body < 0 ? room : poses_[joint.b.body];
    const AngularVec<D> turn = wire_pose(i);
    const WirePlace<D> its = wire_place<D>({joint, a, b, turn});
    const Curve<D>& curve = *joint.curve;
    int piece = its.foot.piece;
    const auto& run = curve.piece(piece);
    const bool forward =
        (std::abs(its.speed) > still_speed_ ? its.speed : its.tangent.dot(model_.gravity)) > 0;
    const double slack = 4 * limits_.touching_gap;
    // at the end of the run in the way that it goes, or beyond it
    if (const auto next = curve.next(piece, forward)) {
      const bool last =
          curve.piece(*next).run != run.run &&
          (forward ? its.foot.along > run.start + run.length - slack : its.foot.along < run.start + slack);
      const int beside = forward ? piece + 1 : piece - 1;
      const bool at_end = beside < 0 || beside >= curve.size() || curve.piece(beside).run != run.run;
      if (last && at_end) piece = *next;
    }
    on_piece_[std::size_t(i)] = piece + 1;
  }
}

// Friction that is a part of a load, a wire's force or a rope's tension: the bounds from the forces found
// last. True: they have changed. While what slips goes on, the load of a rope changes in proportion to its
// bound, so a secant finds it.
template <int D>
bool ExactSolver<D>::rub(int round) {
  if (!limits_.rubs) return false;
  bool changed = false;
  for (Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::friction) continue;
    const Joint<D>& joint = model_.joints[constraint.of];
    if (joint.kind != JointKind::wire && !rubs(joint)) continue;
    double load2 = 0;
    for (const Constraint& other : constraints_) {
      const bool bears = other.kind == Constraint::Kind::joint || other.kind == Constraint::Kind::rope;
      if (!bears || other.of != constraint.of) continue;
      for (int k = 0; k < other.rows; ++k) load2 += f_[other.first + k] * f_[other.first + k];
    }
    const double needed = constraint.grip * std::sqrt(load2);
    ConeBlock<D>& block = blocks_[constraint.block];
    const double before = std::max(std::abs(block.lower), std::abs(block.upper));
    changed = changed || std::abs(needed - before) > kSteady * needed;
    double most = needed;
    if (round > 0 && before != constraint.tried && rubs(joint)) {
      const double slope = (needed - constraint.needed) / (before - constraint.tried);
      const double next = before + (needed - before) / (1 - slope);
      if (slope < 1 && std::isfinite(next) && next >= 0) most = next;
    }
    constraint.tried = before, constraint.needed = needed;
    block.lower = constraint.rubs < 0 ? most : -most;
    block.upper = constraint.rubs > 0 ? -most : most;
  }
  return changed;
}

// those beads that leave at this instant, of the bodies at hand
template <int D>
void ExactSolver<D>::leave_wires(State<D>& state) {
  static const BodyMotion<D> room;
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[std::size_t(i)];
    if (joint.kind != JointKind::wire || !joint.lets_go || state.broken[std::size_t(i)]) continue;
    const BodyMotion<D>&a = poses_[joint.a.body], &b = joint.b.body < 0 ? room : poses_[joint.b.body];
    if (!leaves(joint, wire_place<D>({joint, a, b, wire_pose(i)}), limits_.touching_gap)) continue;
    state.broken[std::size_t(i)] = 1;
    joint.each_body([&](int body) {
      if (body >= 0) scratch_.unheld.push_back(body);
    });
  }
}

// beads that have come to an open end that lets go are free from the next step on
template <int D>
void ExactSolver<D>::let_go_of_wires(State<D>& state) {
  if (!limits_.wires) return;
  static const BodyMotion<D> room;
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (joint.kind != JointKind::wire || !joint.lets_go || state.broken[i]) continue;
    AngularVec<D> turn = AngularVec<D>::Zero();
    turn[0] = state.on_piece[i];
    const BodyMotion<D> a = body_motion(state, joint.a.body),
                        b = joint.b.body < 0 ? room : body_motion(state, joint.b.body);
    if (joint.curve->beyond(wire_place<D>({joint, a, b, turn}).foot) == 0) continue;
    state.broken[i] = 1;
    scratch_.unheld.push_back(joint.a.body);
    if (joint.b.body >= 0) scratch_.unheld.push_back(joint.b.body);
  }
}

#define OBSCURA_INSTANTIATE(D)                                                                 \
  template void ExactSolver<D>::near_rails(const std::vector<BodyMotion<D>>&, Couple, double); \
  template void ExactSolver<D>::choose_rail_contacts();                                        \
  template double ExactSolver<D>::rail_closing_time(const State<D>&, double, Couple);          \
  template double ExactSolver<D>::passing_time(const State<D>&, double);                       \
  template AngularVec<D> ExactSolver<D>::wire_pose(int) const;                                 \
  template void ExactSolver<D>::follow_wires(const State<D>&);                                 \
  template void ExactSolver<D>::leave_wires(State<D>&);                                        \
  template bool ExactSolver<D>::rub(int);                                                      \
  template void ExactSolver<D>::let_go_of_wires(State<D>&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
