#include "scene/when_changes.h"

namespace obscura::scene {

std::optional<std::string> owner(const std::string& path, std::string_view key) {
  const std::string end = "." + std::string(key);
  if (path.size() <= end.size() || !path.ends_with(end)) return {};
  return path.substr(0, path.size() - end.size());
}

template <int D>
bool Changes<D>::bonded(Place place) {
  if (model.bonds.empty()) return false;
  complaints.add(place,
                 "events of a scene with [[bond]]s mark and stop; they do not release or set yet; a "
                 "[[joint]] of type \"weld\" with 'breaks' holds two bodies together");
  return true;
}

template <int D>
bool Changes<D>::moves(int body) const {
  return body >= 0 && (!model.bodies[std::size_t(body)].fixed || drive_of(model, body) >= 0);
}

template <int D>
void Changes<D>::let_go(Place place, const std::string& text, When& when) {
  typename When::Action action{When::Action::Do::let_go, "", {}};
  for (const int body : names.roster.bodies(text, place, complaints)) {
    const int drive = drive_of(model, body);
    if (drive >= 0) action.of.push_back(drive);
  }
  if (!action.of.empty()) when.actions.push_back(std::move(action));
}

template <int D>
sim::Change<D> Changes<D>::of(typename Change::Of of, int index, double value) {
  Change change;
  change.of = of, change.index = index, change.value = value;
  return change;
}

template <int D>
int Changes<D>::number(Change change) {
  model.changes.push_back(std::move(change));
  return int(model.changes.size()) - 1;
}

template <int D>
bool Changes<D>::give(const std::vector<Change>& changes, When& when) {
  if (changes.empty()) return false;
  typename When::Action action{When::Action::Do::change, "", {}};
  for (const Change& change : changes) action.of.push_back(number(change));
  when.actions.push_back(std::move(action));
  return true;
}

template class Changes<2>;
template class Changes<3>;

}  // namespace obscura::scene
