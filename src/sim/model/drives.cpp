// Prescribed motion: the place c of a body and its angle are functions of time,
//   c = start + pivot + p(t),   x = c - R(angle) pivot
//   v = p' - w x r,   a = p'' - alpha x r - w x (w x r),   r = R pivot
//   w = angle' axis,  alpha = angle'' axis
// p', p'' and those of the angle by exact differentiation of what the scene gives.

#include "sim/model/drives.h"

#include <algorithm>
#include <cmath>

#include "sim/model/body_motion.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

namespace {

constexpr int kTravelSamples = 8;  // of a step

}  // namespace

template <int D>
Drives<D>::Drives(const Model<D>& model) : model_(model) {
  for (const Drive<D>& drive : model.drives) {
    if (!drive.moves() || !model.bodies[std::size_t(drive.body)].driven) continue;
    if (number_.empty()) number_.assign(model.bodies.size(), -1);
    number_[std::size_t(drive.body)] = int(active_.size());
    Active& it = active_.emplace_back();
    it.drive = &drive;
    if (drive.formula) it.evaluation.emplace_back(*drive.formula);
    if (!drive.path.empty()) it.path.emplace_back(drive.path, true);
  }
}

template <int D>
DrivenMotion<D> Drives<D>::at(int i, double t) {
  Active& it = active_[std::size_t(i)];
  const Drive<D>& drive = *it.drive;
  DrivenMotion<D> now;
  Vec<D> place = Vec<D>::Zero();
  double angle = 0, angle_rate = 0, angle_rate2 = 0;
  if (!it.evaluation.empty()) {
    Evaluation& evaluation = it.evaluation[0];
    const double time[] = {t};
    evaluation.begin(time);
    evaluation.run(1, {});
    const auto output = [&](int k) { return evaluation.output(k)[0]; };
    for (int axis = 0; axis < D; ++axis) {
      place[axis] = output(3 * axis), now.at.v[axis] = output(3 * axis + 1);
      now.a[axis] = output(3 * axis + 2);
    }
    angle = output(3 * D), angle_rate = output(3 * D + 1), angle_rate2 = output(3 * D + 2);
  }
  if (!it.path.empty()) {
    const auto on = it.path[0].at(t);
    place = on.place - drive.start - drive.pivot, now.at.v = on.velocity, now.a = on.acceleration;
  }
  now.turn = drive.turn;
  if (angle != 0) now.turn = turned<D>(drive.turn, AngularVec<D>(angle * drive.axis));
  now.at.w = angle_rate * drive.axis, now.alpha = angle_rate2 * drive.axis;
  now.at.x = drive.start + place;
  const bool turns = model_.bodies[std::size_t(drive.body)].turns();
  if (turns) {
    now.at.room_from_body = rotation<D>(now.turn);
    if (!drive.pivot.isZero(0)) {
      const Vec<D> r = now.at.room_from_body * (rotation<D>(drive.turn).transpose() * drive.pivot);
      const Vec<D> wr = cross_velocity<D>(now.at.w, r);
      now.at.x += drive.pivot - r;
      now.at.v -= wr;
      now.a -= cross_velocity<D>(now.alpha, r) + cross_velocity<D>(now.at.w, wr);
    }
  } else {
    now.at.w.setZero(), now.alpha.setZero();
  }
  const bool sound = now.at.x.allFinite() && now.at.v.allFinite() && now.a.allFinite() &&
                     std::isfinite(angle) && now.at.w.allFinite() && now.alpha.allFinite();
  if (!sound) {
    Trouble trouble;
    trouble.time = t;
    trouble.body = model_.bodies[std::size_t(drive.body)].name;
    trouble.quantity = "motion";
    trouble.what = "is no finite number";
    trouble.likely = "its place, velocity and acceleration must be finite at all times; see its 'motion'";
    throw NotFinite(std::move(trouble));
  }
  return now;
}

template <int D>
double Drives<D>::travel(int i, double t, double h) {
  const Vec<D> from = at(i, t).at.x;
  double most = 0;
  for (int k = 1; k <= kTravelSamples; ++k)
    most = std::max(most, (at(i, t + h * k / kTravelSamples).at.x - from).squaredNorm());
  return std::sqrt(most);
}

template <int D>
Drives<D>::Pace Drives<D>::fastest(int i, double t, double h) {
  Pace most;
  for (int k = 0; k <= kTravelSamples; ++k) {
    const BodyMotion<D> then = at(i, k < kTravelSamples ? t + h * k / kTravelSamples : t + h).at;
    most.speed = std::max(most.speed, std::sqrt(then.v.squaredNorm()));
    most.spin = std::max(most.spin, std::sqrt(then.w.squaredNorm()));
  }
  return most;
}

template <int D>
void Drives<D>::put(State<D>& state, double t) {
  for (int i = 0; i < size(); ++i) {
    const DrivenMotion<D> now = at(i, t);
    state.x[std::size_t(body(i))] = now.at.x, state.v[std::size_t(body(i))] = now.at.v;
    const int k = turning(state, body(i));
    if (k >= 0) state.turn[std::size_t(k)] = now.turn, state.spin[std::size_t(k)] = now.at.w;
  }
}

template <int D>
std::variant<Program, MotionFault> drive_formula(
    const MotionText& text, const std::vector<std::pair<std::string, double>>& constants) {
  ExpressionGraph graph;
  const int time = graph.variable(0, true);
  std::vector<Symbol> symbols{{"t", time}};
  for (const auto& [name, value] : constants) symbols.push_back({name, graph.number(value)});
  for (const char* name : {"x", "y", "z", "vx", "vy", "vz", "speed", "r", "dx", "dy", "dz", "angle", "spin"})
    symbols.push_back({name, -1, "changes with the run: a prescribed motion depends on t alone"});

  std::vector<int> outputs;
  const auto read = [&](const std::string& one, double unit) -> std::variant<int, ExpressionFault> {
    int node = graph.number(0);
    if (!one.empty()) {
      const auto found = parse_expression(one, symbols, graph);
      if (const auto* fault = std::get_if<ExpressionFault>(&found)) return *fault;
      node = std::get<int>(found);
      if (graph.is_number(node) && !std::isfinite(graph[node].value))
        return ExpressionFault{1, "is no finite number"};
      if (unit != 1) node = graph.make(Operation::multiply, node, graph.number(unit));
    }
    for (int k = 0; k < 3; ++k) {
      outputs.push_back(node);
      if (k < 2) node = graph.derivative(node, time);
    }
    return 0;
  };
  for (int axis = 0; axis < D; ++axis) {
    const auto done = read(text.ways.empty() ? "" : text.ways[std::size_t(axis)], 1);
    if (const auto* fault = std::get_if<ExpressionFault>(&done)) return MotionFault{axis, *fault};
  }
  const auto done = read(text.angle, text.angle_unit);
  if (const auto* fault = std::get_if<ExpressionFault>(&done)) return MotionFault{-1, *fault};
  return Program(graph, outputs);
}

template class Drives<2>;
template class Drives<3>;
template std::variant<Program, MotionFault> drive_formula<2>(
    const MotionText&, const std::vector<std::pair<std::string, double>>&);
template std::variant<Program, MotionFault> drive_formula<3>(
    const MotionText&, const std::vector<std::pair<std::string, double>>&);

}  // namespace obscura::sim
