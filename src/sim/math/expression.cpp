// The graph of a formula, and its derivatives.
//   (a b)' = a' b + a b'      (a/b)' = (a' - (a/b) b') / b      (a^n)' = n a^(n-1) a'
//   (a^b)' = a^b (b' log a + b a'/a)      f(a)' = f'(a) a'
// Forward mode: every node has its derivative made of nodes before it; those that are zero are dropped at
// once. Source: Griewank and Walther, Evaluating Derivatives (2008), §3.1.

#include "sim/math/expression.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace obscura::sim {

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

}  // namespace obscura::sim
