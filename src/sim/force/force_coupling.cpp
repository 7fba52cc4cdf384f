#include "sim/force/force_coupling.h"

#include <algorithm>

namespace obscura::sim {

template <int D>
std::vector<char> pushed_by_forces(const Model<D>& model) {
  std::vector<char> pushed(model.bodies.size(), 0);
  const auto mark = [&](const Subject<D>& subject) {
    if (subject.body >= 0 && !model.bodies[std::size_t(subject.body)].fixed)
      pushed[std::size_t(subject.body)] = 1;
  };
  for (const Force<D>& force : model.forces) {
    for (const Subject<D>& subject : force.subjects) mark(subject);
    if (force.center) mark(*force.center);
  }
  return pushed;
}

template <int D>
std::vector<std::vector<int>> tied_by_forces(const Model<D>& model) {
  std::vector<std::vector<int>> all;
  for (const Force<D>& force : model.forces) {
    const bool centered = force.center && force.center->body >= 0;
    if (force.on == Force<D>::On::each && !centered) continue;
    if (force.on == Force<D>::On::between) {
      for (std::size_t k = 0; k + 1 < force.subjects.size(); k += 2)
        all.push_back({force.subjects[k].body, force.subjects[k + 1].body});
      continue;
    }
    std::vector<int>& together = all.emplace_back();
    if (centered) together.push_back(force.center->body);
    for (const Subject<D>& subject : force.subjects) {
      // a program's force lists what is fixed, too
      if (force.law == Force<D>::Law::function && model.bodies[std::size_t(subject.body)].fixed) continue;
      together.push_back(subject.body);
    }
    if (together.empty()) all.pop_back();
  }
  return all;
}

template <int D>
std::vector<int> restless_by_forces(const Model<D>& model, bool known) {
  std::vector<int> all;
  for (const Force<D>& force : model.forces) {
    const bool alone = force.on == Force<D>::On::each && !(force.center && force.center->body >= 0);
    const bool timed = force.formula && force.formula->timed,
               resting = !force.formula || force.formula->resting;
    if (alone && !timed && (known || !resting)) continue;
    for (const Subject<D>& subject : force.subjects) all.push_back(subject.body);
    if (force.center && force.center->body >= 0) all.push_back(force.center->body);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::erase_if(all, [&](int body) { return model.bodies[std::size_t(body)].fixed; });
  return all;
}

template std::vector<char> pushed_by_forces<2>(const Model<2>&);
template std::vector<char> pushed_by_forces<3>(const Model<3>&);
template std::vector<std::vector<int>> tied_by_forces<2>(const Model<2>&);
template std::vector<std::vector<int>> tied_by_forces<3>(const Model<3>&);
template std::vector<int> restless_by_forces<2>(const Model<2>&, bool);
template std::vector<int> restless_by_forces<3>(const Model<3>&, bool);

}  // namespace obscura::sim
