#pragma once

#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/expressions.h"
#include "scene/fields.h"
#include "scene/name_range.h"
#include "scene/roster.h"
#include "sim/model/model.h"

namespace obscura::scene {

/// What names of bodies, walls, springs and joints mean, in [[when]] and in marks.
template <int D>
struct WhenNames {
  const Node& top;
  const NameTable& roster;
  const std::vector<NameRange>&springs, &bonds;
  const sim::Model<D>& model;
  Constants& constants;
  Diagnostics& complaints;

  /// Whether a name means a body, without a complaint.
  bool is_body(const std::string& text) const;
  /// The bodies, or walls as -1 - wall, of one side of a pair. Complains and gives none where there are none.
  std::vector<int> side(const Node& node) const;
  /// Joints of a name: one, those of a list of copies, or all pieces of a rope over wheels.
  std::vector<int> joints(const std::string& text) const;
  /// Springs of a name: all of a table's, or one, `band[2]`. None, and no complaint, where there are none.
  std::vector<int> springs_called(const std::string& text) const;
  /// What is said where there are no such joints.
  std::string unknown_joint(const std::string& text) const;
};

/// act(action) for each action of each condition.
template <class Act>
void each_action(const Node& top, Act&& act) {
  const Node* all = top.find("when");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Node* actions = all->list()[k].find("do");
    for (std::size_t i = 0; actions && actions->is_list() && i < actions->list().size(); ++i)
      act(actions->list()[i]);
  }
}

}  // namespace obscura::scene
