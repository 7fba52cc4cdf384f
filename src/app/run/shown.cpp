// What marks and plots show, in sentences, for those who do not see them.

#include "app/run/shown.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "app/run/telling.h"
#include "draw/picture/prose.h"

namespace obscura::app {

using namespace telling;

namespace {

constexpr std::size_t kNamed = 6;  // bodies: told one by one

// "crate[0]" and "crate[1]" are copies of one crate
std::string without_number(const std::string& name) {
  const std::size_t bracket = name.find('[');
  return bracket == name.npos ? name : name.substr(0, bracket);
}

// of bodies: one by one, or so many copies
std::string of_bodies(const std::vector<int>& bodies, const sim::SceneInfo& cast) {
  std::vector<std::pair<std::string, std::vector<int>>> groups;
  for (const int body : bodies) {
    const std::string name = without_number(cast.bodies[std::size_t(body)].name);
    auto of = std::find_if(groups.begin(), groups.end(), [&](const auto& it) { return it.first == name; });
    if (of == groups.end()) of = groups.insert(of, {name, {}});
    of->second.push_back(body);
  }
  std::vector<std::string> all;
  for (const auto& [name, its] : groups) {
    if (its.size() == 1)
      all.push_back(called(cast, its[0]));
    else
      all.push_back(fmt::format("the {} bodies \"{}\"", its.size(), draw::in_words(name)));
  }
  if (all.size() > kNamed) return fmt::format("{} bodies", bodies.size());
  return together(all);
}

void add_once(std::vector<std::string>& all, std::string one) {
  if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(std::move(one));
}

}  // namespace

std::vector<std::string> shown_marks(const draw::Marks& marks, const draw::Look& look,
                                     const sim::SceneInfo& cast) {
  std::vector<std::pair<int, std::vector<std::string>>> bodies;
  const auto add = [&](int body, const std::string& what) {
    if (body < 0) return;
    auto of = std::find_if(bodies.begin(), bodies.end(), [&](const auto& it) { return it.first == body; });
    if (of == bodies.end()) of = bodies.insert(of, {body, {}});
    add_once(of->second, what);
  };
  for (const draw::Marks::Vector& each : marks.vectors) {
    std::string what = "position";
    for (const std::string& name : draw::arrows())
      if (draw::measure(name)->arrow == each.quantity) what = draw::in_words(name);
    add(each.body, what);
  }
  for (std::size_t i = 0; i < look.bodies.size() && i < cast.bodies.size(); ++i) {
    if (look.bodies[i].velocity) add(int(i), "velocity");
    if (look.bodies[i].contact) add(int(i), "contact forces");
  }
  // those of which the same is shown are told together
  std::vector<std::pair<std::vector<std::string>, std::vector<int>>> alike;
  for (const auto& [body, quantities] : bodies) {
    const auto& its = quantities;
    auto of = std::find_if(alike.begin(), alike.end(), [&](const auto& it) { return it.first == its; });
    if (of == alike.end()) of = alike.insert(of, {its, {}});
    of->second.push_back(body);
  }
  std::vector<std::string> all;
  for (const auto& [quantities, of] : alike)
    if (all.size() < kNamed)
      all.push_back(fmt::format("Arrows show {} of {}.", together(quantities), of_bodies(of, cast)));
  std::vector<int> cones;
  for (const draw::Marks::Cone& each : marks.cones)
    if (each.body >= 0 && std::find(cones.begin(), cones.end(), each.body) == cones.end())
      cones.push_back(each.body);
  if (!cones.empty())
    all.push_back(fmt::format("Friction cones stand where {} {}.", of_bodies(cones, cast),
                              cones.size() == 1 ? "touches" : "touch"));
  return all;
}

std::string shown_plot(const draw::Measured& plot, const sim::SceneInfo& cast, const std::string& over,
                       bool errors) {
  std::vector<std::string> quantities;
  for (const std::string& each : plot.quantities) quantities.push_back(draw::in_words(each));
  return fmt::format("A plot shows {}{}{} over {}.", errors ? "the error of " : "", together(quantities),
                     plot.bodies.empty() ? "" : " of " + of_bodies(plot.bodies, cast),
                     !over.empty()          ? over
                     : plot.against.empty() ? "time"
                                            : draw::in_words(plot.against));
}

}  // namespace obscura::app
