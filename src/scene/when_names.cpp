#include "scene/when_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/path.h"

namespace obscura::scene {

namespace {

constexpr const char* kWalls[] = {"floor", "left", "right", "ceiling", "back", "front"};

}  // namespace

template <int D>
bool WhenNames<D>::is_body(const std::string& text) const {
  const auto its = reference(text);
  return roster.index.count(text) > 0 || (its && its->bracketed && roster.index.count(its->name) > 0);
}

template <int D>
std::vector<int> WhenNames<D>::side(const Node& node) const {
  const std::string& text = node.text();
  const int walls = int(model.walls.size());
  const Node* own = Fields::of(top, "room").given("walls");
  const int listed = own && own->is_list() ? int(own->list().size()) : 0;
  for (int k = 0; k < std::min(6, walls - listed); ++k) {
    if (text != kWalls[k]) continue;
    if (!is_body(text)) return {-1 - k};
    complaints.add(node.place,
                   fmt::format("{} is a body, and a wall of the room, which is wall[{}] too: give "
                               "the body another name",
                               scene::in_quotes(text), k));
    return {};
  }
  if (!is_body(text)) {
    if (const auto its = reference(text); its && its->bracketed && its->name == "wall") {
      const auto which = range(its->which, walls);
      if (!which) {
        complaints.add(node.place, walls == 0 ? "the room has no walls"
                                              : fmt::format("{}: the room has {} walls, wall[0] .. wall[{}]",
                                                            scene::in_quotes(text), walls, walls - 1));
        return {};
      }
      std::vector<int> all;
      for (const int wall : *which) all.push_back(-1 - wall);
      return all;
    }
    if (text == "ground" && walls > listed) {
      complaints.add(node.place, "the ground is the wall \"floor\"");
      return {};
    }
    for (int k = walls - listed; k < 6; ++k) {
      if (text != kWalls[k]) continue;
      complaints.add(node.place,
                     fmt::format("the room has no {}; its walls are wall[*]", scene::in_quotes(text)));
      return {};
    }
  }
  return roster.bodies(text, node.place, complaints);
}

template <int D>
std::vector<int> WhenNames<D>::joints(const std::string& text) const {
  const auto its = reference(text);
  const bool all = its && its->bracketed && its->which == "*";
  const std::string base = (all ? its->name : text) + "[";
  std::vector<int> found;
  for (int k = 0; k < int(model.joints.size()); ++k) {
    const sim::Joint<D>& joint = model.joints[std::size_t(k)];
    const bool piece = joint.name.starts_with(base) && joint.name.back() == ']' &&
                       joint.name.find('[', base.size()) == std::string::npos;
    if ((!all && joint.name == text) || (piece && (all || joint.rope >= 0))) found.push_back(k);
  }
  return found;
}

template <int D>
std::vector<int> WhenNames<D>::springs_called(const std::string& text) const {
  std::vector<int> found;
  const auto its = reference(text);
  for (const NameRange& range : springs) {
    const int count = range.end - range.first;
    if (text == range.name) {
      for (int i = range.first; i < range.end; ++i) found.push_back(i);
    } else if (its && its->bracketed && its->name == range.name) {
      if (const auto which = scene::range(its->which, count))
        for (const int i : *which) found.push_back(range.first + i);
    }
  }
  return found;
}

template <int D>
std::string WhenNames<D>::unknown_joint(const std::string& text) const {
  std::vector<std::string_view> names;
  for (const sim::Joint<D>& joint : model.joints) names.push_back(joint.name);
  for (const NameRange& bond : bonds) names.push_back(bond.name);
  return fmt::format("no joint or bond is called {}{}", scene::in_quotes(text), did_you_mean(text, names));
}

template struct WhenNames<2>;
template struct WhenNames<3>;

}  // namespace obscura::scene
