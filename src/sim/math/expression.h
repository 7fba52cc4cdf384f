#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "sim/math/operation.h"

namespace obscura::sim {

// Formulas from text: read into a graph, differentiated there, and made a flat program that is evaluated for
// many bodies at a time. All functions are our own (sim/math/elementary.h): the same bits on every machine.

/// A formula, or several: nodes in an order in which each follows those that it reads. Equal nodes are one,
/// and operations on numbers are done at once.
class ExpressionGraph {
 public:
  struct Node {
    Operation operation = Operation::constant;
    int a = -1, b = -1, c = -1;  // nodes; of a variable a is its slot
    double value = 0;            // of a number
    bool uniform = false;        // the same for all bodies of an evaluation
  };

  int number(double value);
  /// The value that an evaluation gives in `slot`; with `uniform` one for all bodies.
  int variable(int slot, bool uniform = false);
  int make(Operation operation, int a, int b = -1, int c = -1);
  /// Square root of the sum of squares.
  int length(std::span<const int> components);

  /// The exact derivative of a node by a variable, by the chain rule from node to node.
  int derivative(int of, int by);

  const Node& operator[](int node) const { return nodes_[std::size_t(node)]; }
  bool is_number(int node) const { return (*this)[node].operation == Operation::constant; }
  /// Whether a node's value depends on the variable in `slot`.
  bool depends(int node, int slot) const;
  int size() const { return int(nodes_.size()); }

 private:
  int keep(const Node& node);
  bool number_is(int node, double value) const { return is_number(node) && (*this)[node].value == value; }
  bool not_negative(int node) const;
  int power_of(int base, double exponent);
  int derivative_of(int node, const std::vector<int>& of);

  std::vector<Node> nodes_;
  std::map<std::tuple<Operation, int, int, int, std::uint64_t>, int> known_;
};

/// A name that an expression may use, and its node.
struct Symbol {
  std::string name;
  int node = -1;             // -1: it may not be used here,
  std::string refused = {};  // because
};

/// What is wrong with an expression.
struct ExpressionFault {
  int column = 0;  // in the text, in code points from 1
  std::string message;
  std::string word = {};  // an unknown name: `message` wants a hint
  bool function = false;  // it was called
};

/// Reads an expression into a graph: + - * / ^ and comparisons, functions, numbers, `symbols`, pi and deg. ^
/// binds to the right and before a sign: -2^2 is -4. Answers its node.
std::variant<int, ExpressionFault> parse_expression(std::string_view text, std::span<const Symbol> symbols,
                                                    ExpressionGraph& graph);

/// The functions that expressions have, and the names of numbers, pi and deg.
std::span<const std::string_view> expression_functions();
std::span<const std::string_view> expression_numbers();

/// Nodes of a graph as a list of instructions, without what they do not need.
class Program {
 public:
  /// So many bodies at a time.
  static constexpr int kLanes = 128;

  Program() = default;
  Program(const ExpressionGraph& graph, std::span<const int> outputs);

  int outputs() const { return int(outputs_.size()); }
  /// How many slots its evaluation is given: one more than the highest variable.
  int slots() const { return slots_; }
  bool reads(int slot) const;
  /// A program of all that in this one changes by jumps with the variable in `slot`, the same for all bodies,
  /// and hangs on no other: an output for each comparison, sign and floor. Evaluation::begin() suffices.
  Program jumps(int slot) const;

 private:
  friend class Evaluation;
  friend class RangeEvaluation;

  // operands: below slots_ a variable of each body, from there on a register
  struct Instruction {
    Operation operation;
    int to, a, b, c;
  };
  struct Number {
    int to;
    double value;
  };
  struct Uniform {
    int to, slot;
  };

  int slots_ = 0, registers_ = 0;
  std::vector<Number> numbers_;       // set once
  std::vector<Uniform> uniforms_;     // set before
  std::vector<Instruction> prelude_;  // what is the same for all bodies
  std::vector<Instruction> code_;
  std::vector<int> outputs_;  // operands
};

/// Room for the evaluation of a program, which must live longer. Allocates once.
class Evaluation {
 public:
  explicit Evaluation(const Program& program);

  /// What is the same for all bodies: the value of each uniform slot.
  void begin(std::span<const double> uniform);
  /// Evaluates for n bodies, at most Program::kLanes: `inputs` has, for each slot that is read, the values of
  /// the bodies.
  void run(int n, std::span<const double* const> inputs);
  /// What an output came to, one number a body, until the next run.
  const double* output(int i) const;

 private:
  const double* at(int operand) const;

  const Program* program_;
  std::vector<double> registers_;
  std::span<const double* const> inputs_;
};

}  // namespace obscura::sim
