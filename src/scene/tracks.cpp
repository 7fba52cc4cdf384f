#include "scene/tracks.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "scene/fields.h"
#include "scene/friction.h"
#include "scene/track_curve.h"
#include "sim/collide/may_touch.h"
#include "sim/collide/rails.h"
#include "sim/constraint/joints/wire.h"
#include "sim/constraint/material.h"
#include "sim/model/body_motion.h"
#include "sim/shape/curve.h"

namespace obscura::scene {

namespace {

// a curve turned and shifted into the frame of a body
template <int D>
void move(typename sim::Curve<D>::Piece& piece, const sim::Rotation<D>& turn, const sim::Vec<D>& shift) {
  for (int k = 0; k < 6; ++k) piece.c[k] = turn * piece.c[k];
  piece.c[0] += shift;
}

// the bodies that one reference, or a list of them, names
template <int D>
std::vector<int> references(const Node& node, const Seating<D>& roster, Diagnostics& complaints) {
  std::vector<int> all;
  const auto add = [&](const Node& one) {
    const std::vector<int> found = roster.bodies(one.text(), one.place, complaints);
    all.insert(all.end(), found.begin(), found.end());
  };
  if (node.is_text())
    add(node);
  else
    for (const Node& one : node.list()) add(one);
  return all;
}

// tracks of one scene on their way into its world
template <int D>
class TrackBuilder {
 public:
  TrackBuilder(const Node& top, Constants& constants, Seating<D>& roster, sim::World<D>& world,
               draw::Look& look, Diagnostics& complaints)
      : top_(top),
        constants_(constants),
        roster_(roster),
        world_(world),
        look_(look),
        complaints_(complaints) {}

  void build() {
    const Node* all = top_.find("track");
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Fields fields(all->list()[k], "track");
      track(fields, fields.given("name") ? fields.text("name") : fmt::format("track[{}]", k));
    }
  }

 private:
  using Vec = sim::Vec<D>;

  void track(const Fields& fields, const std::string& name) {
    std::optional<TypedCurve<D>> typed = track_curve<D>(fields, constants_, complaints_);
    if (!typed) return;
    auto& pieces = typed->pieces;
    if (pieces.size() > std::size_t(sim::RailFeature::kPieces)) {
      complaints_.add(fields.place(), "the track bends too often to follow; make it several tracks");
      return;
    }
    const Node *on = fields.given("on"), *thread = fields.given("thread"), *side = fields.given("side");
    if (D == 3 && side) {
      complaints_.add(side->place, "in space a track is touched from all sides; leave 'side' out");
      return;
    }
    int body = -1;
    if (on) {
      const std::vector<int> found = roster_.bodies(on->text(), on->place, complaints_);
      if (found.size() != 1) return;
      body = found[0];
      if (fields.given("group")) {
        complaints_.add(fields.place("group"),
                        fmt::format("a track on '{0}' is of the group of '{0}'", on->text()));
        return;
      }
      // from the frame that was typed to the body's
      const Seat<D>& seat = roster_.seats[std::size_t(body)];
      const sim::Rotation<D> turn = sim::rotation<D>(sim::inverse<D>(seat.axes));
      for (auto& piece : pieces) move<D>(piece, turn, Vec(-(turn * seat.center)));
    }
    const bool touched = side || !thread;
    if (!touched && fields.given("elasticity")) {
      complaints_.add(fields.place("elasticity"),
                      "what is threaded does not bounce; give the track a 'side' too");
      return;
    }
    if (!thread && fields.given("ends")) {
      complaints_.add(fields.place("ends"),
                      "'ends' is for beads, 'thread'; what rolls on a track leaves it there");
      return;
    }
    if (!touched) {
      const auto curve = std::make_shared<const sim::Curve<D>>(std::move(pieces), typed->closed);
      wires(fields, name, *thread, body, curve);
      return;
    }
    if (world_.model.rails.size() >= std::size_t(sim::RailFeature::kRails)) {
      complaints_.add(fields.place(), fmt::format("more than {} tracks that are touched are too many",
                                                  sim::RailFeature::kRails));
      return;
    }
    if (body < 0) body = own_body(fields, name, pieces);
    sim::Rail<D> rail;
    rail.name = name, rail.body = body;
    rail.curve = std::make_shared<const sim::Curve<D>>(std::move(pieces), typed->closed);
    const std::string word = side ? side->text() : "left";
    rail.left = word != "right", rail.right = word != "left";
    if (const Node* mu = fields.given("friction")) rail.friction = mu->number();
    rail.static_friction = static_friction(fields, rail.friction, complaints_);
    if (const Node* e = fields.given("elasticity")) rail.elasticity = e->number();
    world_.model.rails.push_back(rail);
    paint(fields, name);
    if (thread) wires(fields, name, *thread, body, rail.curve);
  }

  void paint(const Fields& fields, const std::string& name) {
    if (const Node* color = fields.given("color"))
      if (const auto known = draw::color(color->text())) look_.tracks.emplace_back(name, *known);
  }

  // a body for a track that is part of none, in the middle of it
  int own_body(const Fields& fields, const std::string& name,
               std::vector<typename sim::Curve<D>::Piece>& pieces) {
    const sim::Curve<D> curve(pieces, false);
    Vec low = curve.at(0, 0).x, high = low;
    for (const Vec& x : curve.places(0.01 * curve.length())) low = low.cwiseMin(x), high = high.cwiseMax(x);
    const Vec middle = (low + high) / 2;
    for (auto& piece : pieces) move<D>(piece, sim::Rotation<D>::Identity(), Vec(-middle));
    sim::Body<D> body;
    body.name = name;
    body.shape = sim::Point<D>{};
    // it counts among those that turn, which come last
    body.mass = 0, body.inertia.setOnes();
    body.fixed = body.bare = true;
    if (fields.given("group")) {
      auto& families = roster_.families;
      body.group = families.emplace(fields.text("group"), int(families.size()) + 1).first->second;
    }
    if (const Node* mu = fields.given("friction")) body.friction = mu->number();
    if (const Node* e = fields.given("elasticity")) body.elasticity = e->number();
    sim::State<D>& state = world_.state;
    state.x.push_back(middle), state.v.push_back(Vec::Zero());
    state.turn.push_back(sim::no_rotation<D>()), state.spin.push_back(sim::AngularVec<D>::Zero());
    world_.model.bodies.push_back(std::move(body));
    roster_.seats.emplace_back();
    Group group;
    group.name = name, group.place = fields.place("name"), group.at = fields.place("points");
    group.first = int(world_.model.bodies.size()) - 1;
    if (const auto before = roster_.index.find(name); before != roster_.index.end())
      complaints_.add(group.place,
                      fmt::format("the name '{}' is taken by another body at {}", name,
                                  complaints_.text(roster_.groups[std::size_t(before->second)].place)));
    roster_.index.emplace(name, int(roster_.groups.size()));
    roster_.groups.push_back(std::move(group));
    look_.bodies.emplace_back();
    return int(world_.model.bodies.size()) - 1;
  }

  // the beads, each at the place of the wire that is nearest to it
  void wires(const Fields& fields, const std::string& name, const Node& thread, int on,
             const std::shared_ptr<const sim::Curve<D>>& curve) {
    const std::vector<int> beads = references<D>(thread, roster_, complaints_);
    sim::State<D>& state = world_.state;
    for (std::size_t i = 0; i < beads.size(); ++i) {
      const int bead = beads[i];
      const sim::Body<D>& body = world_.model.bodies[std::size_t(bead)];
      const auto refuse = [&](const std::string& why) {
        complaints_.add(thread.place, fmt::format("'{}' {}", body.name, why));
      };
      if (bead == on) return refuse("cannot run on a track that is part of it");
      if (body.fixed) return refuse("is fixed or moved, and does not run on a track");
      if (body.handout) return refuse("keeps the handout's law, which has no tracks");
      for (const sim::Joint<D>& other : world_.model.joints)
        if (other.kind == sim::JointKind::wire && other.a.body == bead)
          return refuse(fmt::format("runs on '{}' already", other.name));
      sim::Joint<D> joint;
      joint.name = beads.size() == 1 ? name : fmt::format("{}[{}]", name, i);
      if (i == 0) paint(fields, joint.name);
      joint.kind = sim::JointKind::wire;
      joint.a.body = bead, joint.b.body = on;
      joint.curve = curve;
      joint.friction =
          fields.given("friction") ? sim::mixed(body.friction, fields.number("friction")) : body.friction;
      joint.lets_go = fields.text("ends") == "free";
      if (!curve->closed() && !joint.lets_go) joint.lower = 0, joint.upper = curve->length();
      const sim::BodyMotion<D> carrier = on < 0 ? sim::BodyMotion<D>{} : sim::body_motion(state, on);
      Vec& x = state.x[std::size_t(bead)];
      const auto foot = curve->nearest(carrier.room_from_body.transpose() * (x - carrier.x));
      x = carrier.x + carrier.arm(foot.at.x);
      Vec& v = state.v[std::size_t(bead)];
      const Vec along = carrier.arm(foot.at.tangent), matter = carrier.velocity(carrier.arm(foot.at.x));
      v = matter + along * along.dot(v - matter);
      world_.model.joints.push_back(std::move(joint));
      state.broken.push_back(0);
      state.on_piece.resize(world_.model.joints.size());
      state.on_piece.back() = foot.piece + 1;
    }
  }

  const Node& top_;
  Constants& constants_;
  Seating<D>& roster_;
  sim::World<D>& world_;
  draw::Look& look_;
  Diagnostics& complaints_;
};

}  // namespace

template <int D>
void tracks(const Node& top, Constants& constants, Seating<D>& roster, sim::World<D>& world, draw::Look& look,
            Diagnostics& complaints) {
  TrackBuilder<D>(top, constants, roster, world, look, complaints).build();
}

template <int D>
void refuse_off_tracks(const Node& top, const sim::Model<D>& model, Diagnostics& complaints) {
  const Node* all = top.find("track");
  if (!all || all->list().empty()) return;
  const Place where = all->list().front().place;
  if (model.collision == sim::Collision::handout) return;  // refused as a kind
  if (!model.bonds.empty())
    complaints.add(where,
                   "a scene has [[bond]]s or tracks, not both yet; a [[joint]] of type \"weld\" with "
                   "'breaks' holds two bodies together");
  if (model.solver == sim::Solver::iterative)
    complaints.add(Fields::of(top, "physics").place("solver"),
                   "tracks are for the direct solver; leave 'solver' out, or write \"direct\"");
  const sim::MayTouch<D> may_touch(model);
  // a bead stays on its wire
  std::vector<char> threaded(model.bodies.size(), 0);
  for (const sim::Joint<D>& joint : model.joints)
    if (joint.curve && joint.a.body >= 0) threaded[std::size_t(joint.a.body)] = 1;
  for (const sim::Rail<D>& rail : model.rails) {
    for (int i = 0; i < int(model.bodies.size()); ++i) {
      const sim::Body<D>& body = model.bodies[std::size_t(i)];
      if (i == rail.body || body.fixed || body.bare || sim::touches_rails<D>(body.shape) ||
          !may_touch(i, rail.body) || (sim::is_point(body.shape) && threaded[std::size_t(i)]))
        continue;
      complaints.add(
          where,
          D == 2 ? fmt::format(
                       "'{}' has more corners than the {} with which bodies lie on tracks; let its group "
                       "ignore that of the track '{}': [contact] ignore",
                       body.name, sim::RailFeature::kVertices, rail.name)
          : sim::is_point(body.shape)
              ? fmt::format(
                    "'{}' is a point, which passes by the track '{}' in space; give it a 'radius', or "
                    "thread = [\"{}\"]",
                    body.name, rail.name, body.name)
              : fmt::format(
                    "'{}' might come upon the track '{}', and in space only balls and bodies made of balls "
                    "roll and slide on tracks; let its group ignore that of the track: [contact] ignore",
                    body.name, rail.name));
      return;
    }
  }
}

template void tracks<2>(const Node&, Constants&, Seating<2>&, sim::World<2>&, draw::Look&, Diagnostics&);
template void tracks<3>(const Node&, Constants&, Seating<3>&, sim::World<3>&, draw::Look&, Diagnostics&);
template void refuse_off_tracks<2>(const Node&, const sim::Model<2>&, Diagnostics&);
template void refuse_off_tracks<3>(const Node&, const sim::Model<3>&, Diagnostics&);

}  // namespace obscura::scene
