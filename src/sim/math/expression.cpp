// The graph of a formula, its derivatives, and its program.
//   (a b)' = a' b + a b'      (a/b)' = (a' - (a/b) b') / b      (a^n)' = n a^(n-1) a'
//   (a^b)' = a^b (b' log a + b a'/a)      f(a)' = f'(a) a'
// Forward mode: every node has its derivative made of nodes before it; those that are zero are dropped at
// once. Source: Griewank and Walther, Evaluating Derivatives (2008), §3.1.

#include "sim/math/expression.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "sim/math/elementary.h"
#include "sim/math/lanes.h"

namespace obscura::sim {

namespace {

double sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : x; }

double evaluated(Operation operation, double a, double b, double c) {
  using enum Operation;
  switch (operation) {
    case constant:
    case variable:
      break;
    case add:
      return a + b;
    case subtract:
      return a - b;
    case multiply:
      return a * b;
    case divide:
      return a / b;
    case negate:
      return -a;
    case power:
      return elementary::pow(a, b);
    case square_root:
      return std::sqrt(a);
    case exponential:
      return elementary::exp(a);
    case logarithm:
      return elementary::log(a);
    case sine:
      return sin_cos(a).sin;
    case cosine:
      return sin_cos(a).cos;
    case tangent:
      return elementary::tan(a);
    case arc_sine:
      return elementary::asin(a);
    case arc_cosine:
      return elementary::acos(a);
    case arc_tangent:
      return elementary::atan2(a, b);
    case hyperbolic_sine:
      return elementary::sinh(a);
    case hyperbolic_cosine:
      return elementary::cosh(a);
    case hyperbolic_tangent:
      return elementary::tanh(a);
    case absolute:
      return std::fabs(a);
    case sign:
      return sign_of(a);
    case floor:
      return std::floor(a);
    case minimum:
      return b < a ? b : a;
    case maximum:
      return b > a ? b : a;
    case less:
      return a < b;
    case less_equal:
      return a <= b;
    case equal:
      return a == b;
    case not_equal:
      return a != b;
    case choose:
      return a != 0 ? b : c;
  }
  return 0;
}

// how many operands it has
int operands(Operation operation) {
  using enum Operation;
  switch (operation) {
    case constant:
    case variable:
      return 0;
    case add:
    case subtract:
    case multiply:
    case divide:
    case power:
    case arc_tangent:
    case minimum:
    case maximum:
    case less:
    case less_equal:
    case equal:
    case not_equal:
      return 2;
    case choose:
      return 3;
    default:
      return 1;
  }
}

}  // namespace

// --- the graph

int ExpressionGraph::keep(const Node& node) {
  const auto [at, fresh] = known_.try_emplace(
      {node.operation, node.a, node.b, node.c, std::bit_cast<std::uint64_t>(node.value)}, size());
  if (fresh) nodes_.push_back(node);
  return at->second;
}

int ExpressionGraph::number(double value) { return keep({.value = value, .uniform = true}); }

int ExpressionGraph::variable(int slot, bool uniform) {
  return keep({.operation = Operation::variable, .a = slot, .uniform = uniform});
}

// whether it is a sum of squares and their like
bool ExpressionGraph::not_negative(int node) const {
  const Node& it = (*this)[node];
  switch (it.operation) {
    case Operation::constant:
      return it.value >= 0;
    case Operation::multiply:
      return it.a == it.b || (not_negative(it.a) && not_negative(it.b));
    case Operation::add:
      return not_negative(it.a) && not_negative(it.b);
    case Operation::absolute:
    case Operation::square_root:
      return true;
    default:
      return false;
  }
}

// a number as exponent: products and roots where they are as exact
int ExpressionGraph::power_of(int base, double exponent) {
  using enum Operation;
  if (exponent < 0 && exponent >= -4) {
    const int below = power_of(base, -exponent);
    if ((*this)[below].operation != power) return make(divide, number(1), below);
  }
  const double whole = std::floor(exponent);
  if (exponent >= 0 && exponent <= 4 && (exponent == whole || exponent == whole + 0.5)) {
    int product = exponent == whole ? -1 : make(square_root, base);
    const int square = whole >= 2 ? make(multiply, base, base) : -1;
    const auto times = [&](int factor) { product = product < 0 ? factor : make(multiply, factor, product); };
    if (whole == 1 || whole == 3) times(base);
    if (whole >= 2) times(square);
    if (whole == 4) times(square);
    return product < 0 ? number(1) : product;
  }
  return keep({.operation = power, .a = base, .b = number(exponent), .uniform = (*this)[base].uniform});
}

int ExpressionGraph::make(Operation operation, int a, int b, int c) {
  using enum Operation;
  const int count = operands(operation);
  const int all[3] = {a, b, c};
  bool numbers = true, uniform = true;
  for (int i = 0; i < count; ++i) {
    numbers = numbers && is_number(all[i]);
    uniform = uniform && (*this)[all[i]].uniform;
  }
  const auto value = [&](int node) { return node < 0 ? 0 : (*this)[node].value; };
  if (numbers) return number(evaluated(operation, value(a), value(b), value(c)));
  // numbers first, so that equal sums and products are one node
  if ((operation == add || operation == multiply) && (is_number(b) || (!is_number(a) && b < a)))
    std::swap(a, b);

  switch (operation) {
    case add:
      if (number_is(a, 0)) return b;
      if (a == b) return make(multiply, number(2), a);
      if ((*this)[b].operation == negate) return make(subtract, a, (*this)[b].a);
      break;
    case subtract:
      if (number_is(b, 0)) return a;
      if (number_is(a, 0)) return make(negate, b);
      if ((*this)[b].operation == negate) return make(add, a, (*this)[b].a);
      break;
    case multiply:
      if (number_is(a, 0)) return a;
      if (number_is(a, 1)) return b;
      if (number_is(a, -1)) return make(negate, b);
      // (2 (3 x)), and |r|^2 where r is a length: its derivative has no 0/0 at r = 0
      if (is_number(a) && (*this)[b].operation == multiply && is_number((*this)[b].a))
        return make(multiply, number(value(a) * value((*this)[b].a)), (*this)[b].b);
      if (is_number(a) && (*this)[b].operation == negate)
        return make(multiply, number(-value(a)), (*this)[b].a);
      if (a == b && (*this)[a].operation == square_root && not_negative((*this)[a].a)) return (*this)[a].a;
      break;
    case divide:
      if (number_is(a, 0)) return a;
      if (number_is(b, 1)) return a;
      break;
    case negate:
      if ((*this)[a].operation == negate) return (*this)[a].a;
      break;
    case power:
      if (is_number(b)) return power_of(a, value(b));
      break;
    case choose:
      if (is_number(a)) return value(a) != 0 ? b : c;
      if (b == c) return b;
      break;
    default:
      break;
  }
  return keep({operation, a, count > 1 ? b : -1, count > 2 ? c : -1, 0, uniform});
}

int ExpressionGraph::length(std::span<const int> components) {
  int sum = number(0);
  for (const int each : components) sum = make(Operation::add, sum, make(Operation::multiply, each, each));
  return make(Operation::square_root, sum);
}

bool ExpressionGraph::depends(int node, int slot) const {
  std::vector<char> wanted(std::size_t(node) + 1, 0);
  wanted[std::size_t(node)] = 1;
  for (int i = node; i >= 0; --i) {
    if (!wanted[std::size_t(i)]) continue;
    const Node& it = (*this)[i];
    if (it.operation == Operation::variable && it.a == slot) return true;
    const int all[3] = {it.a, it.b, it.c};
    for (int k = 0; k < operands(it.operation); ++k) wanted[std::size_t(all[k])] = 1;
  }
  return false;
}

// of one node, where those of all before it are known
int ExpressionGraph::derivative_of(int node, const std::vector<int>& of) {
  using enum Operation;
  const Node it = (*this)[node];  // a copy: nodes are added below
  const auto d = [&](int operand) { return of[std::size_t(operand)]; };
  const auto chain = [&](int factor) { return make(multiply, factor, d(it.a)); };
  const auto square = [&](int x) { return make(multiply, x, x); };
  const int one = number(1), zero = number(0);
  switch (it.operation) {
    case add:
    case subtract:
      return make(it.operation, d(it.a), d(it.b));
    case multiply:
      return make(add, make(multiply, d(it.a), it.b), make(multiply, it.a, d(it.b)));
    case divide:
      return make(divide, make(subtract, d(it.a), make(multiply, node, d(it.b))), it.b);
    case negate:
      return make(negate, d(it.a));
    case power: {
      const int by_base = chain(make(multiply, it.b, make(power, it.a, make(subtract, it.b, one))));
      if (number_is(d(it.b), 0)) return by_base;
      const int by_exponent = make(multiply, d(it.b), make(multiply, node, make(logarithm, it.a)));
      return make(add, by_base, by_exponent);
    }
    case square_root:
      return make(divide, make(multiply, number(0.5), d(it.a)), node);
    case exponential:
      return chain(node);
    case logarithm:
      return make(divide, d(it.a), it.a);
    case sine:
      return chain(make(cosine, it.a));
    case cosine:
      return chain(make(negate, make(sine, it.a)));
    case tangent:
      return chain(make(add, one, square(node)));
    case arc_sine:
      return make(divide, d(it.a), make(square_root, make(subtract, one, square(it.a))));
    case arc_cosine:
      return make(negate, make(divide, d(it.a), make(square_root, make(subtract, one, square(it.a)))));
    case arc_tangent:  // of the direction (b, a)
      return make(divide, make(subtract, make(multiply, it.b, d(it.a)), make(multiply, it.a, d(it.b))),
                  make(add, square(it.a), square(it.b)));
    case hyperbolic_sine:
      return chain(make(hyperbolic_cosine, it.a));
    case hyperbolic_cosine:
      return chain(make(hyperbolic_sine, it.a));
    case hyperbolic_tangent:
      return chain(make(subtract, one, square(node)));
    case absolute:
      return chain(make(sign, it.a));
    case minimum:
      return make(choose, make(less, it.b, it.a), d(it.b), d(it.a));
    case maximum:
      return make(choose, make(less, it.a, it.b), d(it.b), d(it.a));
    case choose:
      return make(choose, it.a, d(it.b), d(it.c));
    case constant:
    case variable:
    case sign:
    case floor:
    case less:
    case less_equal:
    case equal:
    case not_equal:
      break;
  }
  return zero;
}

int ExpressionGraph::derivative(int of, int by) {
  std::vector<char> wanted(std::size_t(of) + 1, 0);
  wanted[std::size_t(of)] = 1;
  for (int i = of; i >= 0; --i) {
    if (!wanted[std::size_t(i)]) continue;
    const int all[3] = {nodes_[std::size_t(i)].a, nodes_[std::size_t(i)].b, nodes_[std::size_t(i)].c};
    for (int k = 0; k < operands(nodes_[std::size_t(i)].operation); ++k) wanted[std::size_t(all[k])] = 1;
  }
  std::vector<int> all(std::size_t(of) + 1, number(0));
  for (int i = 0; i <= of; ++i) {
    if (wanted[std::size_t(i)]) all[std::size_t(i)] = i == by ? number(1) : derivative_of(i, all);
  }
  return all.back();
}

// --- the program

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
    int all[3] = {it.a, it.b, it.c};
    const int count = operands(it.operation);
    std::sort(all, all + count);
    for (int k = 0; k < count; ++k) {
      if (k > 0 && all[k] == all[k - 1]) continue;
      const ExpressionGraph::Node& read = graph[all[k]];
      if (last[std::size_t(all[k])] == i && !read.uniform && read.operation != Operation::variable)
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

// --- the text

namespace {

struct Function {
  std::string_view name;
  int arguments;
  Operation operation;
};
constexpr Function kFunctions[] = {
    {"sin", 1, Operation::sine},
    {"cos", 1, Operation::cosine},
    {"tan", 1, Operation::tangent},
    {"asin", 1, Operation::arc_sine},
    {"acos", 1, Operation::arc_cosine},
    {"atan", 1, Operation::arc_tangent},
    {"atan2", 2, Operation::arc_tangent},
    {"sinh", 1, Operation::hyperbolic_sine},
    {"cosh", 1, Operation::hyperbolic_cosine},
    {"tanh", 1, Operation::hyperbolic_tangent},
    {"exp", 1, Operation::exponential},
    {"log", 1, Operation::logarithm},
    {"sqrt", 1, Operation::square_root},
    {"abs", 1, Operation::absolute},
    {"sign", 1, Operation::sign},
    {"floor", 1, Operation::floor},
    {"min", 2, Operation::minimum},
    {"max", 2, Operation::maximum},
    {"if", 3, Operation::choose},
};
constexpr double kPiOfText = 3.141592653589793;
constexpr int kDeepestExpression = 100;  // brackets, signs and powers one within another
constexpr std::size_t kLongestExpression = 10'000;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// recursive descent; the first fault ends it
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, std::span<const Symbol> symbols, ExpressionGraph& graph)
      : text_(text), symbols_(symbols), graph_(graph) {}

  std::variant<int, ExpressionFault> parse() {
    if (text_.size() > kLongestExpression) {
      fail(kLongestExpression, "is longer than 10000 characters");
      return fault_;
    }
    const int all = comparison();
    skip();
    if (!failed_ && at_ < text_.size()) unexpected();
    if (failed_) return fault_;
    return all;
  }

 private:
  // the first fault is kept; what is answered afterwards means nothing
  int fail(std::size_t at, std::string message, std::string word = {}, bool function = false) {
    if (!failed_) {
      failed_ = true;
      int column = 1;
      for (std::size_t i = 0; i < at && i < text_.size(); ++i) column += (text_[i] & 0xC0) != 0x80;
      fault_ = {column, std::move(message), std::move(word), function};
    }
    at_ = text_.size();
    return graph_.number(0);
  }

  void skip() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
  }
  bool take(std::string_view word) {
    skip();
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  bool next_is(char c) {
    skip();
    return at_ < text_.size() && text_[at_] == c;
  }

  // something where an operator, a bracket or the end belongs
  int unexpected() {
    const char c = text_[at_];
    const std::string_view rest = text_.substr(at_);
    if (is_letter(c) || is_digit(c) || c == '(' || c == '.')
      return fail(at_, "expected an operator before this; a product is written with *, as 2*x");
    if (c == ')') return fail(at_, "this bracket closes none");
    if (c == ',') return fail(at_, "a comma belongs between the arguments of a function");
    if (rest.starts_with("&&") || rest.starts_with("||"))
      return fail(at_, "there is no && and ||; a product of comparisons is true where both are");
    if (c == '=') return fail(at_, "= is no operator; == compares");
    if (c == '!') return fail(at_, "! is no operator; != compares");
    std::size_t bytes = 1;
    while (at_ + bytes < text_.size() && (text_[at_ + bytes] & 0xC0) == 0x80) ++bytes;
    return fail(at_, "'" + std::string(text_.substr(at_, bytes)) + "' is no part of an expression");
  }

  int comparison() {
    const int a = sum();
    const auto operation = compared();
    if (operation < 0) return a;
    const int b = sum();
    skip();
    const std::size_t again = at_;
    if (compared() >= 0) return fail(again, "comparisons do not chain; write (a < b)*(b < c)");
    using enum Operation;
    switch (operation) {
      case 0:
        return graph_.make(less_equal, a, b);
      case 1:
        return graph_.make(less_equal, b, a);
      case 2:
        return graph_.make(equal, a, b);
      case 3:
        return graph_.make(not_equal, a, b);
      case 4:
        return graph_.make(less, a, b);
      default:
        return graph_.make(less, b, a);
    }
  }

  int compared() {
    constexpr std::string_view kAll[] = {"<=", ">=", "==", "!=", "<", ">"};
    for (int i = 0; i < 6; ++i)
      if (take(kAll[i])) return i;
    return -1;
  }

  int sum() {
    int all = product();
    while (true) {
      if (take("+"))
        all = graph_.make(Operation::add, all, product());
      else if (take("-"))
        all = graph_.make(Operation::subtract, all, product());
      else
        return all;
    }
  }

  int product() {
    int all = with_sign();
    while (true) {
      skip();
      if (text_.substr(at_).starts_with("**")) return fail(at_, "a power is written with ^, as x^2");
      if (take("*"))
        all = graph_.make(Operation::multiply, all, with_sign());
      else if (take("/"))
        all = graph_.make(Operation::divide, all, with_sign());
      else
        return all;
    }
  }

  int with_sign() {
    if (++depth_ > kDeepestExpression) return fail(at_, "is nested too deep here");
    int all;
    if (take("-"))
      all = graph_.make(Operation::negate, with_sign());
    else if (take("+"))
      all = with_sign();
    else
      all = power();
    --depth_;
    return all;
  }

  int power() {
    const int base = primary();
    return take("^") ? graph_.make(Operation::power, base, with_sign()) : base;
  }

  int primary() {
    skip();
    const std::size_t begun = at_;
    if (at_ == text_.size())
      return fail(at_, text_.find_first_not_of(" \t\r\n") == std::string_view::npos
                           ? "is empty; expected an expression such as -2*x"
                           : "ends where a number, a name or a bracket is expected");
    const char c = text_[at_];
    if (is_digit(c) || c == '.') return literal();
    if (is_letter(c)) return named();
    if (take("(")) {
      if (++depth_ > kDeepestExpression) return fail(begun, "is nested too deep here");
      const int all = comparison();
      --depth_;
      skip();
      if (!take(")")) return at_ < text_.size() ? unexpected() : fail(begun, "this bracket is not closed");
      return all;
    }
    if (c == ')' || c == ',' || c == '*' || c == '/' || c == '^' || c == '<' || c == '>' || c == '=')
      return fail(at_, "expected a number, a name or a bracket before this");
    return unexpected();
  }

  // 2, 0.5, .5, 1e-3
  int literal() {
    const std::size_t begun = at_;
    const auto digits = [&] {
      const std::size_t from = at_;
      while (at_ < text_.size() && is_digit(text_[at_])) ++at_;
      return at_ - from;
    };
    std::size_t count = digits();
    if (at_ < text_.size() && text_[at_] == '.') ++at_, count += digits();
    if (count == 0) return fail(begun, "expected digits beside the point");
    if (at_ < text_.size() && (text_[at_] == 'e' || text_[at_] == 'E')) {
      const std::size_t sign = at_ + 1 < text_.size() && (text_[at_ + 1] == '+' || text_[at_ + 1] == '-');
      if (at_ + 1 + sign < text_.size() && is_digit(text_[at_ + 1 + sign])) at_ += 1 + sign, digits();
    }
    double value = 0;
    const auto end = std::from_chars(text_.data() + begun, text_.data() + at_, value);
    if (end.ec != std::errc{} || end.ptr != text_.data() + at_)
      return fail(begun, "is too large or too small for a number");
    if (at_ < text_.size() && (is_letter(text_[at_]) || text_[at_] == '.')) return unexpected();
    return graph_.number(value);
  }

  int named() {
    const std::size_t begun = at_;
    if (const Symbol* quantity = dotted()) {
      at_ += quantity->name.size();
      if (quantity->node < 0) return fail(begun, "'" + quantity->name + "' " + quantity->refused);
      return quantity->node;
    }
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view name = text_.substr(begun, at_ - begun);
    const bool called = next_is('(');
    const auto function = std::find_if(std::begin(kFunctions), std::end(kFunctions),
                                       [&](const Function& it) { return it.name == name; });
    if (function != std::end(kFunctions)) {
      if (!called)
        return fail(begun, "'" + std::string(name) + "' is a function; write " + std::string(name) + "(...)");
      return call(*function, begun);
    }
    const auto symbol =
        std::find_if(symbols_.begin(), symbols_.end(), [&](const Symbol& it) { return it.name == name; });
    const bool number = name == "pi" || name == "deg";
    if (called) {
      if (symbol == symbols_.end() && !number)
        return fail(begun, "no function is called '" + std::string(name) + "'", std::string(name), true);
      return fail(begun, "'" + std::string(name) + "' is no function; a product is written with *");
    }
    if (name == "pi") return graph_.number(kPiOfText);
    if (name == "deg") return graph_.number(kPiOfText / 180);
    if (symbol == symbols_.end() && at_ + 1 < text_.size() && (text_[at_] == '.' || text_[at_] == '[')) {
      // as a quantity of a body is written
      while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]) || text_[at_] == '.' ||
                                    text_[at_] == '[' || text_[at_] == ']'))
        ++at_;
      const std::string whole(text_.substr(begun, at_ - begun));
      return fail(begun, "nothing is called '" + whole + "' here", whole);
    }
    if (symbol == symbols_.end())
      return fail(begun, "nothing is called '" + std::string(name) + "' here", std::string(name));
    if (symbol->node < 0) return fail(begun, "'" + std::string(name) + "' " + symbol->refused);
    return symbol->node;
  }

  // the longest symbol with a dot that stands here: "ball[2].vx"
  const Symbol* dotted() const {
    const Symbol* found = nullptr;
    const std::string_view rest = text_.substr(at_);
    for (const Symbol& it : symbols_) {
      const std::size_t n = it.name.size();
      if (it.name.find('.') == std::string::npos || !rest.starts_with(it.name)) continue;
      if (n < rest.size() && (is_letter(rest[n]) || is_digit(rest[n]))) continue;
      if (!found || n > found->name.size()) found = &it;
    }
    return found;
  }

  int call(const Function& function, std::size_t begun) {
    take("(");
    if (++depth_ > kDeepestExpression) return fail(begun, "is nested too deep here");
    int all[3] = {-1, -1, -1}, count = 0;
    if (!next_is(')')) {
      do {
        const int one = comparison();
        if (count < 3) all[count] = one;
        ++count;
      } while (!failed_ && take(","));
    }
    --depth_;
    if (failed_) return graph_.number(0);
    skip();
    if (at_ == text_.size())
      return fail(begun, "the bracket of '" + std::string(function.name) + "' is not closed");
    if (!take(")")) return unexpected();
    if (count != function.arguments)
      return fail(begun, "'" + std::string(function.name) + "' takes " +
                             (function.arguments == 1   ? "one argument"
                              : function.arguments == 2 ? "two arguments"
                                                        : "three arguments: if(condition, then, else)") +
                             ", got " + std::to_string(count));
    if (function.name == "atan") all[1] = graph_.number(1);
    return graph_.make(function.operation, all[0], all[1], all[2]);
  }

  std::string_view text_;
  std::span<const Symbol> symbols_;
  ExpressionGraph& graph_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool failed_ = false;
  ExpressionFault fault_;
};

}  // namespace

std::variant<int, ExpressionFault> parse_expression(std::string_view text, std::span<const Symbol> symbols,
                                                    ExpressionGraph& graph) {
  return ExpressionParser(text, symbols, graph).parse();
}

std::span<const std::string_view> expression_functions() {
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> names;
    for (const Function& it : kFunctions) names.push_back(it.name);
    return names;
  }();
  return all;
}

std::span<const std::string_view> expression_numbers() {
  static constexpr std::string_view kAll[] = {"pi", "deg"};
  return kAll;
}

}  // namespace obscura::sim
