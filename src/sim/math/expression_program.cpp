// The program of a formula: a list of instructions, each of which does one operation for many bodies.

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/math/expression.h"
#include "sim/math/lanes.h"

namespace obscura::sim {

Program::Program(const ExpressionGraph& graph, std::span<const int> outputs) {
  const int n = outputs.empty() ? 0 : *std::max_element(outputs.begin(), outputs.end()) + 1;
  // when each node is read last; outputs are read after the end
  std::vector<int> last(std::size_t(n), -1);
  for (const int node : outputs) last[std::size_t(node)] = n;
  for (int i = n - 1; i >= 0; --i) {
    if (last[std::size_t(i)] < 0) continue;
    const ExpressionGraph::Node& it = graph[i];
    const int all[3] = {it.a, it.b, it.c};
    for (int k = 0; k < operands(it.operation); ++k)
      last[std::size_t(all[k])] = std::max(last[std::size_t(all[k])], i);
    if (it.operation == Operation::variable && !it.uniform) slots_ = std::max(slots_, it.a + 1);
  }

  // registers that keep what they have; then those that are free again after their last reading
  std::vector<int> place(std::size_t(n), -1), free;
  for (int i = 0; i < n; ++i) {
    const ExpressionGraph::Node& it = graph[i];
    if (last[std::size_t(i)] < 0 || !it.uniform) continue;
    const int to = place[std::size_t(i)] = slots_ + registers_++;
    const auto at = [&](int node) { return node < 0 ? -1 : place[std::size_t(node)]; };
    if (it.operation == Operation::constant)
      numbers_.push_back({to, it.value});
    else if (it.operation == Operation::variable)
      uniforms_.push_back({to, it.a});
    else
      prelude_.push_back({it.operation, to, at(it.a), at(it.b), at(it.c)});
  }
  for (int i = 0; i < n; ++i) {
    const ExpressionGraph::Node& it = graph[i];
    if (last[std::size_t(i)] < 0 || it.uniform) continue;
    if (it.operation == Operation::variable) {
      place[std::size_t(i)] = it.a;
      continue;
    }
    int to;
    if (free.empty()) {
      to = slots_ + registers_++;
    } else {
      to = free.back(), free.pop_back();
    }
    place[std::size_t(i)] = to;
    const auto at = [&](int node) { return node < 0 ? -1 : place[std::size_t(node)]; };
    code_.push_back({it.operation, to, at(it.a), at(it.b), at(it.c)});
    const std::array<int, 3> all = {it.a, it.b, it.c};
    const int count = operands(it.operation);
    for (int k = 0; k < count; ++k) {
      if (std::find(all.begin(), all.begin() + k, all[std::size_t(k)]) != all.begin() + k) continue;
      const ExpressionGraph::Node& read = graph[all[std::size_t(k)]];
      if (last[std::size_t(all[std::size_t(k)])] == i && !read.uniform && read.operation != Operation::variable)
        free.push_back(place[std::size_t(all[k])]);
    }
  }
  for (const int node : outputs) outputs_.push_back(place[std::size_t(node)]);
}

bool Program::reads(int slot) const {
  const auto any = [&](const std::vector<Instruction>& all) {
    return std::any_of(all.begin(), all.end(), [&](const Instruction& it) {
      return (it.a >= 0 && it.a == slot) || (it.b >= 0 && it.b == slot) || (it.c >= 0 && it.c == slot);
    });
  };
  return slot < slots_ && (any(code_) || std::find(outputs_.begin(), outputs_.end(), slot) != outputs_.end());
}

Program Program::jumps(int slot) const {
  using enum Operation;
  Program made = *this;
  made.code_.clear(), made.outputs_.clear();
  const auto registers = std::size_t(registers_);
  std::vector<char> known(registers), moves(registers);
  for (const Number& it : numbers_) known[std::size_t(it.to - slots_)] = 1;
  for (const Uniform& it : uniforms_)
    if (it.slot == slot) known[std::size_t(it.to - slots_)] = moves[std::size_t(it.to - slots_)] = 1;
  for (const Instruction& it : prelude_) {
    bool all = true, any = false;
    for (const int operand : {it.a, it.b, it.c}) {
      if (operand < 0) continue;
      all = all && known[std::size_t(operand - slots_)];
      any = any || moves[std::size_t(operand - slots_)];
    }
    if (!all) continue;
    known[std::size_t(it.to - slots_)] = 1, moves[std::size_t(it.to - slots_)] = any;
    const bool steps = it.operation == less || it.operation == less_equal || it.operation == equal ||
                       it.operation == not_equal || it.operation == sign || it.operation == Operation::floor;
    if (any && steps) made.outputs_.push_back(it.to);
  }
  return made;
}

Evaluation::Evaluation(const Program& program)
    : program_(&program), registers_(std::size_t(program.registers_) * Program::kLanes) {
  for (const Program::Number& it : program.numbers_)
    std::fill_n(registers_.begin() + std::ptrdiff_t(it.to - program.slots_) * Program::kLanes,
                Program::kLanes, it.value);
}

const double* Evaluation::at(int operand) const {
  const int slots = program_->slots_;
  return operand < slots ? inputs_[std::size_t(operand)]
                         : registers_.data() + std::size_t(operand - slots) * Program::kLanes;
}

const double* Evaluation::output(int i) const { return at(program_->outputs_[std::size_t(i)]); }

void Evaluation::begin(std::span<const double> uniform) {
  const auto fill = [&](int to, double value) {
    std::fill_n(registers_.data() + std::size_t(to - program_->slots_) * Program::kLanes, Program::kLanes,
                value);
  };
  for (const Program::Uniform& it : program_->uniforms_) fill(it.to, uniform[std::size_t(it.slot)]);
  for (const Program::Instruction& it : program_->prelude_) {
    const auto first = [&](int operand) { return operand < 0 ? 0 : *at(operand); };
    fill(it.to, evaluated(it.operation, first(it.a), first(it.b), first(it.c)));
  }
}

namespace {

// one operation for n bodies: `to` is none of the others
template <class F>
OBSCURA_INLINE void each(int n, double* __restrict to, const double* a, F&& f) {
  for (int i = 0; i < n; ++i) to[i] = f(a[i]);
}
template <class F>
OBSCURA_INLINE void each(int n, double* __restrict to, const double* a, const double* b, F&& f) {
  for (int i = 0; i < n; ++i) to[i] = f(a[i], b[i]);
}

// std::sqrt may set errno, so compilers make no vectors of it
#if defined(__SSE2__) && __has_builtin(__builtin_ia32_sqrtpd)
typedef double Two __attribute__((vector_size(16), aligned(8), may_alias));
OBSCURA_INLINE int pairs_of_roots(int n, double* __restrict to, const double* a) {
  int i = 0;
  for (; i + 2 <= n; i += 2)
    *reinterpret_cast<Two*>(to + i) = __builtin_ia32_sqrtpd(*reinterpret_cast<const Two*>(a + i));
  return i;
}
#else
OBSCURA_INLINE int pairs_of_roots(int, double*, const double*) { return 0; }
#endif
OBSCURA_INLINE void roots(int n, double* __restrict to, const double* a) {
  for (int i = pairs_of_roots(n, to, a); i < n; ++i) to[i] = std::sqrt(a[i]);
}

// those that the compiler makes vectors of; false: another
OBSCURA_INLINE bool operate(Operation operation, int n, double* __restrict to, const double* a,
                            const double* b, const double* c) {
  using enum Operation;
  switch (operation) {
    case add:
      each(n, to, a, b, [](double x, double y) { return x + y; });
      return true;
    case subtract:
      each(n, to, a, b, [](double x, double y) { return x - y; });
      return true;
    case multiply:
      each(n, to, a, b, [](double x, double y) { return x * y; });
      return true;
    case divide:
      each(n, to, a, b, [](double x, double y) { return x / y; });
      return true;
    case negate:
      each(n, to, a, [](double x) { return -x; });
      return true;
    case square_root:
      roots(n, to, a);
      return true;
    case absolute:
      each(n, to, a, [](double x) { return std::fabs(x); });
      return true;
    case minimum:
      each(n, to, a, b, [](double x, double y) { return y < x ? y : x; });
      return true;
    case maximum:
      each(n, to, a, b, [](double x, double y) { return y > x ? y : x; });
      return true;
    case less:
      each(n, to, a, b, [](double x, double y) { return x < y ? 1.0 : 0.0; });
      return true;
    case less_equal:
      each(n, to, a, b, [](double x, double y) { return x <= y ? 1.0 : 0.0; });
      return true;
    case choose:
      for (int i = 0; i < n; ++i) to[i] = a[i] != 0 ? b[i] : c[i];
      return true;
    default:
      return false;
  }
}

// the same bits by two lanes and by four
bool operate_by_two(Operation operation, int n, double* to, const double* a, const double* b,
                    const double* c) {
  return operate(operation, n, to, a, b, c);
}
OBSCURA_WIDE bool operate_by_four(Operation operation, int n, double* to, const double* a, const double* b,
                                  const double* c) {
  return operate(operation, n, to, a, b, c);
}

}  // namespace

void Evaluation::run(int n, std::span<const double* const> inputs) {
  inputs_ = inputs;
  for (const Program::Instruction& it : program_->code_) {
    double* const to = registers_.data() + std::size_t(it.to - program_->slots_) * Program::kLanes;
    const double* a = at(it.a);
    const double* b = it.b < 0 ? nullptr : at(it.b);
    const double* c = it.c < 0 ? nullptr : at(it.c);
    if (lanes::four_lanes ? operate_by_four(it.operation, n, to, a, b, c)
                          : operate_by_two(it.operation, n, to, a, b, c))
      continue;
    for (int i = 0; i < n; ++i) to[i] = evaluated(it.operation, a[i], b ? b[i] : 0, 0);
  }
}

}  // namespace obscura::sim
