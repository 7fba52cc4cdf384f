#include "sim/model/condition.h"

namespace obscura::sim {

namespace {

std::vector<Symbol> symbols_of(std::span<const std::string> quantities, std::span<const Symbol> refused,
                               std::span<const std::pair<std::string, double>> constants,
                               ExpressionGraph& graph) {
  std::vector<Symbol> symbols;
  for (std::size_t i = 0; i < quantities.size(); ++i)
    symbols.push_back({quantities[i], graph.variable(int(i))});
  symbols.push_back({"t", graph.variable(int(quantities.size()))});
  for (const auto& [name, value] : constants) symbols.push_back({name, graph.number(value)});
  symbols.insert(symbols.end(), refused.begin(), refused.end());
  return symbols;
}

}  // namespace

std::variant<Program, ExpressionFault> condition_formula(
    std::string_view text, std::span<const std::string> quantities, std::span<const Symbol> refused,
    std::span<const std::pair<std::string, double>> constants) {
  ExpressionGraph graph;
  const std::vector<Symbol> symbols = symbols_of(quantities, refused, constants, graph);
  const auto parsed = parse_expression(text, symbols, graph);
  if (const auto* fault = std::get_if<ExpressionFault>(&parsed)) return *fault;

  // all that it reads; each node follows those that it reads
  const int root = std::get<int>(parsed), count = graph.size();
  std::vector<char> needed(std::size_t(count), 0);
  needed[std::size_t(root)] = 1;
  std::vector<int> outputs{root};
  for (int node = root; node >= 0; --node) {
    if (!needed[std::size_t(node)]) continue;
    const ExpressionGraph::Node it = graph[node];
    if (it.operation == Operation::constant || it.operation == Operation::variable) continue;
    for (const int operand : {it.a, it.b, it.c})
      if (operand >= 0) needed[std::size_t(operand)] = 1;
    if (it.operation == Operation::equal || it.operation == Operation::not_equal)
      return ExpressionFault{1, "== and != hold for an instant at most; compare with < or >"};
    if (it.operation == Operation::less || it.operation == Operation::less_equal)
      outputs.push_back(graph.make(Operation::subtract, it.b, it.a));
  }
  if (outputs.size() == 1)
    return ExpressionFault{1, graph.is_number(root)
                                  ? "is always the same"
                                  : "compares nothing; expected a condition such as ball.y < 1"};
  return Program(graph, outputs);
}

std::variant<Program, std::pair<int, ExpressionFault>> value_formulas(
    std::span<const std::string> texts, double unit, std::span<const std::string> quantities,
    std::span<const Symbol> refused, std::span<const std::pair<std::string, double>> constants) {
  ExpressionGraph graph;
  const std::vector<Symbol> symbols = symbols_of(quantities, refused, constants, graph);
  std::vector<int> outputs;
  for (const std::string& text : texts) {
    const auto parsed = parse_expression(text, symbols, graph);
    if (const auto* fault = std::get_if<ExpressionFault>(&parsed))
      return std::pair(int(&text - texts.data()), *fault);
    outputs.push_back(graph.make(Operation::multiply, std::get<int>(parsed), graph.number(unit)));
  }
  return Program(graph, outputs);
}

}  // namespace obscura::sim
