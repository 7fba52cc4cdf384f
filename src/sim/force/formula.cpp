// The variables of a force, and its formulas.
//   f = -grad V                 by x, y, z of each body
//   tau = -dV/d(angle)          in the plane
//   f2 = -f1 = -dV/d(dx, ...)   by the way from the first of two to the second

#include "sim/force/formula.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

// the graph of one force, with its variables
template <int D>
struct Vocabulary {
  ExpressionGraph graph;
  std::vector<Symbol> symbols;
  int by[3] = {-1, -1, -1};  // what a potential is differentiated by
  int by_angle = -1;
  std::vector<int> velocities;

  void add(const std::string& name, int node) { symbols.push_back({name, node}); }
  void refuse(const std::string& name, const std::string& why) { symbols.push_back({name, -1, why}); }

  Vocabulary(bool pair, bool centered, bool potential) {
    const std::string of_space = "is of space, and this scene is in the plane";
    const std::string no_velocity =
        "is no part of a potential, which depends on places alone; write 'components'";
    if (pair) {
      using namespace pair_slot;
      std::vector<int> ways;
      for (int k = 0; k < 3; ++k) {
        const std::string axis = kAxes[k];
        if (k >= D) {
          refuse("d" + axis, of_space), refuse("dv" + axis, of_space);
          continue;
        }
        ways.push_back(by[k] = graph.variable(dx + k));
        add("d" + axis, by[k]);
        velocities.push_back(graph.variable(dvx + k));
        if (potential)
          refuse("dv" + axis, no_velocity);
        else
          add("dv" + axis, velocities.back());
      }
      add("r", graph.length(ways));
      add("m1", graph.variable(mass1)), add("m2", graph.variable(mass2));
      add("charge1", graph.variable(charge1)), add("charge2", graph.variable(charge2));
      add("t", graph.variable(time, true));
      for (const char* one : {"x", "y", "z", "vx", "vy", "vz", "speed", "m", "charge", "angle", "spin",
                              "spinx", "spiny", "spinz", "i"})
        refuse(one,
               "is of one body, and this force is between two, which have dx, dy, r, m1, m2, charge1 and "
               "charge2");
      return;
    }
    using namespace each_slot;
    const std::string no_center = "is measured from 'center', which this force does not have";
    std::vector<int> ways;
    for (int k = 0; k < 3; ++k) {
      const std::string axis = kAxes[k];
      if (k >= D) {
        for (const char* before : {"", "v", "d", "dv"}) refuse(before + axis, of_space);
        continue;
      }
      by[k] = graph.variable(x + k);
      add(axis, by[k]);
      velocities.push_back(graph.variable(vx + k));
      ways.push_back(graph.make(Operation::subtract, by[k], graph.variable(center + k, true)));
      const int passing =
          graph.make(Operation::subtract, velocities.back(), graph.variable(center_velocity + k, true));
      if (potential) {
        refuse("v" + axis, no_velocity), refuse("dv" + axis, no_velocity);
      } else {
        add("v" + axis, velocities.back());
        if (centered)
          add("dv" + axis, passing);
        else
          refuse("dv" + axis, no_center);
      }
      if (centered)
        add("d" + axis, ways.back());
      else
        refuse("d" + axis, no_center);
    }
    if (centered)
      add("r", graph.length(ways));
    else
      refuse("r", no_center);
    if (potential)
      refuse("speed", no_velocity);
    else
      add("speed", graph.length(velocities));
    add("m", graph.variable(mass)), add("charge", graph.variable(charge)), add("i", graph.variable(copy));
    add("t", graph.variable(time, true));
    const std::string of_plane = "is of the plane, and this scene is in space";
    if (D == 3)
      refuse("angle", of_plane), refuse("spin", of_plane + "; it has spinx, spiny and spinz");
    else
      add("angle", by_angle = graph.variable(angle));
    const auto add_spin = [&](const char* name, int slot) {
      if (potential)
        refuse(name, no_velocity);
      else
        add(name, graph.variable(slot));
    };
    if (D == 2) {
      add_spin("spin", spin);
      for (const char* name : {"spinx", "spiny", "spinz"}) refuse(name, of_space + "; it has 'spin'");
    } else {
      add_spin("spinx", spin), add_spin("spiny", spin_y), add_spin("spinz", spin_z);
    }
    for (const char* one : {"m1", "m2", "charge1", "charge2"})
      refuse(one, "is of a force between two bodies ('among' or 'between')");
    // of the presets
    symbols.push_back({"_drag", graph.variable(drag)});
    symbols.push_back({"_quadratic_drag", graph.variable(quadratic_drag)});
  }
};

}  // namespace

template <int D>
std::variant<ForceFormula, ForceFault> force_formula(const ForceText& text, const NamedNumbers& constants) {
  const bool potential = text.components.empty() && text.torque.empty();
  Vocabulary<D> words(text.pair, text.centered, potential);
  ExpressionGraph& graph = words.graph;
  for (const auto& [name, value] : constants) words.add(name, graph.number(value));
  const int time = text.pair ? int(pair_slot::time) : int(each_slot::time);

  ForceFormula made;
  std::vector<int> components;
  const auto read = [&](const std::string& one, int component, bool torque) -> std::variant<int, ForceFault> {
    const auto node = parse_expression(one, words.symbols, graph);
    if (const auto* fault = std::get_if<ExpressionFault>(&node)) return ForceFault{component, torque, *fault};
    const int found = std::get<int>(node);
    if (graph.is_number(found) && !std::isfinite(graph[found].value))
      return ForceFault{component, torque, {1, "is no finite number"}};
    return found;
  };
  if (potential) {
    const auto node = read(text.potential, -1, false);
    if (const auto* fault = std::get_if<ForceFault>(&node)) return *fault;
    const int energy = std::get<int>(node);
    for (int k = 0; k < D; ++k)
      components.push_back(graph.make(Operation::negate, graph.derivative(energy, words.by[k])));
    made.torque = words.by_angle >= 0 && graph.depends(energy, each_slot::angle) && !text.pair;
    if (made.torque)
      components.push_back(graph.make(Operation::negate, graph.derivative(energy, words.by_angle)));
    made.energy = Program(graph, std::vector<int>{energy});
    made.potential = true;
  } else {
    for (int k = 0; k < D; ++k) {
      if (text.components.empty()) {
        components.push_back(graph.number(0));
        continue;
      }
      const auto node = read(text.components[std::size_t(k)], k, false);
      if (const auto* fault = std::get_if<ForceFault>(&node)) return *fault;
      components.push_back(std::get<int>(node));
    }
    made.torque = !text.torque.empty();
    for (int k = 0; k < int(text.torque.size()); ++k) {
      const auto node = read(text.torque[std::size_t(k)], k, true);
      if (const auto* fault = std::get_if<ForceFault>(&node)) return *fault;
      components.push_back(std::get<int>(node));
    }
  }
  made.force = Program(graph, components);
  for (const int node : components) made.timed = made.timed || graph.depends(node, time);
  return made;
}

template <int D>
std::vector<std::string> force_names(bool pair) {
  const Vocabulary<D> words(pair, true, false);
  std::vector<std::string> all;
  for (const Symbol& it : words.symbols)
    if (it.node >= 0 && it.name[0] != '_') all.push_back(it.name);
  for (const std::string_view name : expression_functions()) all.emplace_back(name);
  for (const std::string_view name : expression_numbers()) all.emplace_back(name);
  return all;
}

std::vector<std::string> expression_names() {
  std::vector<std::string> all = force_names<3>(false);
  for (const std::vector<std::string>& more : {force_names<2>(false), force_names<3>(true)})
    all.insert(all.end(), more.begin(), more.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

template std::variant<ForceFormula, ForceFault> force_formula<2>(const ForceText&, const NamedNumbers&);
template std::variant<ForceFormula, ForceFault> force_formula<3>(const ForceText&, const NamedNumbers&);
template std::vector<std::string> force_names<2>(bool);
template std::vector<std::string> force_names<3>(bool);

}  // namespace obscura::sim
