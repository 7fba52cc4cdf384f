#include "scene/roster.h"

#include <fmt/format.h>

#include "scene/path.h"
#include "sim/model/body_motion.h"

namespace obscura::scene {

template <int D>
sim::Vec<D> turned(const sim::Vec<D>& v, const sim::Orientation<D>& turn) {
  return sim::rotation<D>(turn) * v;
}

template <int D>
sim::Orientation<D> turn_of(const sim::World<D>& world, int body) {
  const int k = body < 0 ? -1 : sim::turning(world.state, body);
  return k < 0 ? sim::no_rotation<D>() : world.state.turn[std::size_t(k)];
}

template <int D>
sim::Vec<D> place(const sim::World<D>& world, int body, const sim::Vec<D>& local) {
  const sim::Vec<D>& x = world.state.x[std::size_t(body)];
  const int k = sim::turning(world.state, body);
  if (k < 0 || local.isZero(0)) return x + local;
  return x + turned<D>(local, world.state.turn[std::size_t(k)]);
}

template <int D>
sim::Vec<D> Seat<D>::seen(const sim::Vec<D>& typed) const {
  const sim::Vec<D> from = typed - center;
  return axes == sim::no_rotation<D>() ? from : turned<D>(from, sim::inverse<D>(axes));
}

const Group* NameTable::group(const std::string& name, Place place, Diagnostics& complaints) const {
  if (const auto found = index.find(name); found != index.end()) return &groups[std::size_t(found->second)];
  if (wrong.count(name) > 0) return nullptr;
  std::vector<std::string_view> names;
  if (!complaints.enough())
    for (const Group& each : groups) names.push_back(each.name);
  complaints.add(place, fmt::format("no body is called {}{}", in_quotes(name), did_you_mean(name, names)));
  return nullptr;
}

std::vector<int> NameTable::bodies(const std::string& text, Place place, Diagnostics& complaints) const {
  if (const auto whole = index.find(text); whole != index.end()) {
    const Group& it = groups[std::size_t(whole->second)];
    if (it.count == 1) return {it.first};
    complaints.add(place, fmt::format("'{}' is {} copies; say which: {}[0] .. {}[{}], or all, {}[*]", it.name,
                                      it.count, it.name, it.name, it.count - 1, it.name));
    return {};
  }
  const auto its = reference(text);
  if (!its) {
    complaints.add(place, fmt::format("{} is not the name of a body; expected one such as ball or ball[3]",
                                      in_quotes(text)));
    return {};
  }
  const Group* it = group(its->bracketed ? its->name : text, place, complaints);
  if (!it) return {};
  if (it->grid.empty()) {
    complaints.add(place, fmt::format("'{}' has no copies; write it without brackets", it->name));
    return {};
  }
  auto which = range(its->which, it->count);
  if (!which) {
    complaints.add(place, fmt::format("{}: '{}' has {} copies, {}[0] .. {}[{}]", in_quotes(text), it->name,
                                      it->count, it->name, it->name, it->count - 1));
    return {};
  }
  for (int& body : *which) body += it->first;
  return *which;
}

#define OBSCURA_INSTANTIATE(D)                                                    \
  template struct Seat<D>;                                                        \
  template sim::Vec<D> turned<D>(const sim::Vec<D>&, const sim::Orientation<D>&); \
  template sim::Orientation<D> turn_of<D>(const sim::World<D>&, int);             \
  template sim::Vec<D> place<D>(const sim::World<D>&, int, const sim::Vec<D>&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
