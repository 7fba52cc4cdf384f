#include "scene/whens.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/conditions.h"

namespace obscura::scene {

namespace {

// joints and springs that are not there at the start, and which no event makes
template <int D>
void refuse_never_made(const WhenNames<D>& names) {
  const auto made = [&](typename sim::Change<D>::Of of, int index) {
    return std::any_of(names.model.changes.begin(), names.model.changes.end(), [&](const sim::Change<D>& it) {
      return it.of == of && it.index == index && it.value == 0;
    });
  };
  const Node* all = names.top.find("joint");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Node &its = all->list()[k], *name = its.find("name");
    const std::vector<int> those = names.joints(name ? name->text() : fmt::format("joint[{}]", k));
    const bool all_made = std::all_of(those.begin(), those.end(), [&](int joint) {
      return !names.model.joints[std::size_t(joint)].later || made(sim::Change<D>::Of::join, joint);
    });
    if (all_made) continue;
    names.complaints.add(its.find("joined")->place,
                         "no event makes this joint: [[when]] do = [{ join = \"...\" }]");
  }
  const Node* springs = names.top.find("spring");
  for (std::size_t k = 0; springs && k < springs->list().size(); ++k) {
    const Node &its = springs->list()[k], *name = its.find("name");
    for (const int spring : names.springs_called(name ? name->text() : fmt::format("spring[{}]", k))) {
      if (!names.model.springs[std::size_t(spring)].loose || made(sim::Change<D>::Of::loose, spring))
        continue;
      names.complaints.add(its.find("joined")->place,
                           "no event joins this spring: [[when]] do = [{ join = \"...\" }]");
      break;
    }
  }
}

}  // namespace

template <int D>
void whens(const Node& top, const NameTable& roster, const std::vector<NameRange>& springs,
           const std::vector<NameRange>& bonds, Constants& constants, const Rebuild<D>& rebuild,
           sim::World<D>& world, Diagnostics& complaints) {
  using Do = typename sim::When<D>::Action::Do;
  sim::Model<D>& model = world.model;
  const WhenNames<D> names{top, roster, springs, bonds, model, complaints};
  Glued glued;
  const Node* all = top.find("when");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "when");
    sim::When<D> when;
    when.name = fields.given("name") ? fields.text("name") : fmt::format("when[{}]", k);
    when.again = fields.flag("again");
    const std::size_t wrong = complaints.count();
    condition(fields, names, constants, when, complaints);
    actions(fields, names, rebuild, world, glued, when, complaints);
    if (complaints.count() == wrong) model.whens.push_back(std::move(when));
  }
  refuse_never_made(names);
  for (const sim::When<D>& when : model.whens)
    for (const auto& action : when.actions)
      model.changed = model.changed || !(action.what == Do::mark || action.what == Do::stop);
}

template void whens<2>(const Node&, const NameTable&, const std::vector<NameRange>&,
                       const std::vector<NameRange>&, Constants&, const Rebuild<2>&, sim::World<2>&,
                       Diagnostics&);
template void whens<3>(const Node&, const NameTable&, const std::vector<NameRange>&,
                       const std::vector<NameRange>&, Constants&, const Rebuild<3>&, sim::World<3>&,
                       Diagnostics&);

}  // namespace obscura::scene
