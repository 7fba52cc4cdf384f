#include "scene/whens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "scene/conditions.h"

namespace obscura::scene {

namespace {

// the names of bodies, joints and springs that are not in the model, as something is wrong with them
template <int D>
std::vector<std::string> missing(const WhenNames<D>& names) {
  std::vector<std::string> found(names.roster.wrong.begin(), names.roster.wrong.end());
  for (const char* kind : {"joint", "spring"}) {
    const Node* all = names.top.find(kind);
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Node* its = all->list()[k].find("name");
      const std::string name = its && its->is_text() ? its->text() : fmt::format("{}[{}]", kind, k);
      if (names.joints(name).empty() && names.joints(name + "[*]").empty() &&
          names.springs_called(name).empty())
        found.push_back(name);
    }
  }
  return found;
}

// whether any text in it has one of these names
bool mentions(const Node& node, const std::vector<std::string>& names) {
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  const auto has = [&](const std::string& text, const std::string& name) {
    for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
      const std::size_t end = at + name.size();
      if ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end]))) return true;
    }
    return false;
  };
  if (node.is_text())
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& it) { return has(node.text(), it); });
  if (node.is_list())
    return std::any_of(node.list().begin(), node.list().end(),
                       [&](const Node& it) { return mentions(it, names); });
  return node.is_table() && std::any_of(node.table().begin(), node.table().end(),
                                        [&](const Entry& it) { return mentions(it.node, names); });
}

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

// a condition of two that touch, of which a joint that stays keeps all from it
template <int D>
void refuse_kept_apart(const WhenNames<D>& names, const sim::When<D>& when, const Node& node) {
  using When = sim::When<D>;
  const sim::Model<D>& model = names.model;
  const auto parted = [&](int joint) {
    return std::any_of(model.whens.begin(), model.whens.end(), [&](const When& it) {
      return std::any_of(it.actions.begin(), it.actions.end(), [&](const auto& action) {
        return action.what == When::Action::Do::part &&
               std::find(action.of.begin(), action.of.end(), joint) != action.of.end();
      });
    });
  };
  std::string by;
  const auto kept = [&](const std::pair<int, int>& pair) {
    for (int k = 0; pair.second >= 0 && k < int(model.joints.size()); ++k) {
      const sim::Joint<D>& joint = model.joints[std::size_t(k)];
      // wheels that mesh overlap by their teeth
      const auto are = [&](int a, int b) { return std::pair<int, int>(std::minmax(a, b)) == pair; };
      const bool held = are(joint.a.body, joint.b.body) ||
                        (joint.kind == sim::JointKind::gear && are(joint.a.body, joint.over[0].body));
      if (!held) continue;
      if (joint.touching || joint.later || joint.kind == sim::JointKind::pulley) continue;
      if (joint.breaks < 1e299 || joint.breaks_torque < 1e299 || parted(k)) continue;
      by = joint.name;
      return true;
    }
    return false;
  };
  if (when.pairs.empty() || !std::all_of(when.pairs.begin(), when.pairs.end(), kept)) return;
  const char* const key = when.on == When::On::touches ? "touches" : "leaves";
  const Node& two = *node.find(key);
  names.complaints.add(
      two.place, fmt::format("'{}': {} and {} are joined by {}, which lets them through each other; "
                             "give it touching = true",
                             key, scene::in_quotes(two.list()[0].text()), scene::in_quotes(two.list()[1].text()),
                             scene::in_quotes(by)));
}

}  // namespace

template <int D>
bool whens(const Node& top, const NameTable& roster, const std::vector<NameRange>& springs,
           const std::vector<NameRange>& bonds, Constants& constants, const Rebuild<D>& rebuild,
           sim::World<D>& world, Diagnostics& complaints) {
  using Do = typename sim::When<D>::Action::Do;
  sim::Model<D>& model = world.model;
  const WhenNames<D> names{top, roster, springs, bonds, model, constants, complaints};
  Glued glued;
  const std::vector<std::string> wanting = missing(names);
  bool whole = true;
  std::vector<const Node*> read;  // of each of the model's
  const Node* all = top.find("when");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "when");
    if (mentions(all->list()[k], wanting)) {
      whole = false;  // what is wrong there is told
      continue;
    }
    sim::When<D> when;
    when.name = fields.given("name") ? fields.text("name") : fmt::format("when[{}]", k);
    when.again = fields.flag("again");
    const std::size_t wrong = complaints.count();
    condition(fields, names, when, complaints);
    actions(fields, names, rebuild, world, glued, when, complaints);
    if (complaints.count() == wrong) model.whens.push_back(std::move(when)), read.push_back(&all->list()[k]);
  }
  if (whole) refuse_never_made(names);
  for (std::size_t k = 0; whole && k < read.size(); ++k) refuse_kept_apart(names, model.whens[k], *read[k]);
  for (const sim::When<D>& when : model.whens)
    for (const auto& action : when.actions)
      model.changed = model.changed || !(action.what == Do::mark || action.what == Do::stop);
  return whole;
}

template bool whens<2>(const Node&, const NameTable&, const std::vector<NameRange>&,
                       const std::vector<NameRange>&, Constants&, const Rebuild<2>&, sim::World<2>&,
                       Diagnostics&);
template bool whens<3>(const Node&, const NameTable&, const std::vector<NameRange>&,
                       const std::vector<NameRange>&, Constants&, const Rebuild<3>&, sim::World<3>&,
                       Diagnostics&);

}  // namespace obscura::scene
