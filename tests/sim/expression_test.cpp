#include "sim/math/expression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "sim/allocations.h"

namespace obscura::sim {
namespace {

enum Slot { kX, kY, kV, kTime };

// x and y of each body, a constant k, and the time, which is the same for all
struct Variables {
  ExpressionGraph graph;
  int x = graph.variable(kX), y = graph.variable(kY), t = graph.variable(kTime, true);
  int r = graph.length(std::vector<int>{x, y});
  std::vector<Symbol> symbols{
      {"x", x}, {"y", y}, {"t", t}, {"r", r}, {"k", graph.number(3)}, {"v", -1, "is not known here"}};

  std::variant<int, ExpressionFault> parse(const std::string& text) {
    return parse_expression(text, symbols, graph);
  }
  double value(int node, double px, double py, double time) const {
    const Program program(graph, std::vector<int>{node});
    Evaluation evaluation(program);
    const std::vector<double> uniform{0, 0, 0, time};
    evaluation.begin(uniform);
    const double* const inputs[] = {&px, &py, nullptr};
    evaluation.run(1, inputs);
    return evaluation.output(0)[0];
  }
  double value(const std::string& text, double px = 0.7, double py = -1.3, double time = 0.4) {
    const auto node = parse(text);
    EXPECT_TRUE(std::holds_alternative<int>(node)) << text;
    return std::holds_alternative<int>(node) ? value(std::get<int>(node), px, py, time) : NAN;
  }
  ExpressionFault fault(const std::string& text) {
    const auto node = parse(text);
    EXPECT_TRUE(std::holds_alternative<ExpressionFault>(node)) << text;
    return std::holds_alternative<ExpressionFault>(node) ? std::get<ExpressionFault>(node)
                                                         : ExpressionFault{};
  }
};

TEST(Expression, ReadsAsMathematicsIsRead) {
  Variables at;
  EXPECT_EQ(at.value("1 + 2*3"), 7);
  EXPECT_EQ(at.value("(1 + 2)*3"), 9);
  EXPECT_EQ(at.value("8 - 4 - 2"), 2);
  EXPECT_EQ(at.value("8/4/2"), 1);
  EXPECT_EQ(at.value("2^3^2"), 512);
  EXPECT_EQ(at.value("-2^2"), -4);
  EXPECT_EQ(at.value("2^-2"), 0.25);
  EXPECT_EQ(at.value("2*-3"), -6);
  EXPECT_EQ(at.value(".5 + 5. + 1e-1 + 2E+1"), 25.6);
  EXPECT_EQ(at.value("x"), 0.7);
  EXPECT_EQ(at.value("k*x - y"), 3 * 0.7 + 1.3);
  EXPECT_EQ(at.value("if(x > 0.5, 1, 2) + if(x > 1, 10, 20)"), 21);
  EXPECT_EQ(at.value("(x <= 0.7) + (x >= 0.7) + (x == y) + (x != y)"), 3);
  EXPECT_EQ(at.value("min(x, y) + max(x, y)"), 0.7 - 1.3);
  EXPECT_EQ(at.value("floor(-1.5) + sign(y) + abs(y)"), -2 - 1 + 1.3);
  EXPECT_EQ(at.value("t"), 0.4);
  EXPECT_DOUBLE_EQ(at.value("sin(30*deg)"), 0.5);
  EXPECT_DOUBLE_EQ(at.value("exp(log(x)) + sinh(t) + cosh(t) + tanh(t) + tan(t)"),
                   0.7 + std::exp(0.4) + std::tanh(0.4) + std::tan(0.4));
  EXPECT_DOUBLE_EQ(at.value("asin(x) + acos(x) + atan(y) + atan2(y, x)"),
                   std::acos(0.0) + std::atan(-1.3) + std::atan2(-1.3, 0.7));
  EXPECT_DOUBLE_EQ(at.value("r^2"), 0.49 + 1.69);
  EXPECT_DOUBLE_EQ(
      at.value("x^2.5 + x^-3 + x^1.5 + 2^x + x^pi"),
      std::pow(0.7, 2.5) + std::pow(0.7, -3) + std::pow(0.7, 1.5) + std::pow(2, 0.7) + std::pow(0.7, M_PI));
}

TEST(Expression, NamesTheColumnOfAMistake) {
  Variables at;
  const struct {
    const char* text;
    int column;
    const char* says;
  } cases[] = {
      {"", 1, "empty"},
      {"  ", 3, "empty"},
      {"2x", 2, "expected an operator"},
      {"2 x", 3, "expected an operator"},
      {"x y", 3, "expected an operator"},
      {"3(x + 1)", 2, "expected an operator"},
      {"x + speedd", 5, "nothing is called 'speedd'"},
      {"v*2", 1, "is not known here"},
      {"1 + ", 5, "ends where"},
      {"1 + * 2", 5, "expected a number"},
      {"(1 + 2", 1, "not closed"},
      {"1 + 2)", 6, "closes none"},
      {"sinn(x)", 1, "no function is called 'sinn'"},
      {"sin x", 1, "is a function"},
      {"sin(x, y)", 1, "takes one argument, got 2"},
      {"if(x, y)", 1, "takes three arguments"},
      {"max()", 1, "takes two arguments, got 0"},
      {"min(x, y", 1, "is not closed"},
      {"x(2)", 1, "is no function"},
      {"x ** 2", 3, "written with ^"},
      {"x = 2", 3, "== compares"},
      {"x > 1 && y > 1", 7, "there is no &&"},
      {"1 < x < 2", 7, "do not chain"},
      {"x, y", 2, "comma"},
      {"1.2.3", 4, "expected an operator"},
      {".", 1, "digits"},
      {"1e999", 1, "too large"},
      {"2 + \xC3\xA9", 5, "no part of an expression"},
      {"\xC3\xA9 + 2", 1, "no part of an expression"},
      {"x + 2 # y", 7, "no part of an expression"},
  };
  for (const auto& it : cases) {
    const ExpressionFault fault = at.fault(it.text);
    EXPECT_EQ(fault.column, it.column) << it.text << ": " << fault.message;
    EXPECT_NE(fault.message.find(it.says), std::string::npos) << it.text << ": " << fault.message;
  }
  EXPECT_EQ(at.fault("x + speedd").word, "speedd");
  EXPECT_TRUE(at.fault("sinn(x)").function);
}

TEST(Expression, RefusesWhatIsNestedTooDeepOrTooLong) {
  Variables at;
  EXPECT_NE(at.fault(std::string(5000, '(')).message.find("too deep"), std::string::npos);
  EXPECT_NE(at.fault(std::string(5000, '-') + "1").message.find("too deep"), std::string::npos);
  EXPECT_NE(at.fault("2" + std::string(20000, ' ')).message.find("longer"), std::string::npos);
  std::string powers = "2", sines;
  for (int i = 0; i < 3000; ++i) powers += "^2";
  for (int i = 0; i < 1000; ++i) sines += "sin(";
  EXPECT_NE(at.fault(powers).message.find("too deep"), std::string::npos);
  EXPECT_NE(at.fault(sines).message.find("too deep"), std::string::npos);
}

// against differences of the formula itself, fourth order: h^4 and rounding over h
TEST(Expression, HasExactDerivatives) {
  Variables at;
  for (const char* text :
       {"x*y + x/y - y/x", "x^2 + x^3*y^4 + x^-2 + x^0.5", "x^2.7 + 2^x + x^x + x^y", "sqrt(1 + x^2)",
        "1/r + r^2 + r^3", "sin(x*y) + cos(2*x) + tan(x)", "asin(x/2) + acos(x/3) + atan(x*y) + atan2(y, x)",
        "exp(-x^2) + log(x) + sinh(x) + cosh(x) + tanh(x)", "abs(y)*x + sign(y)*x^2 + floor(x)",
        "min(x, y^2) + max(x*x, y) + if(x > 0, x^3, y)", "-3*5/r", "k*x*sin(t)", "x - -y - (2 - x)"}) {
    const int node = std::get<int>(at.parse(text));
    for (const bool by_x : {true, false}) {
      const int slope = at.graph.derivative(node, by_x ? at.x : at.y);
      const double px = 0.73, py = -1.31, h = 1e-3;
      const auto moved = [&](double by) {
        return at.value(node, px + (by_x ? by : 0), py + (by_x ? 0 : by), 0.4);
      };
      const double rough = (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h);
      if (std::isnan(rough)) continue;  // x^y by y
      EXPECT_NEAR(at.value(slope, px, py, 0.4), rough, 1e-9 * (1 + std::fabs(rough)))
          << text << (by_x ? " by x" : " by y");
    }
  }
}

TEST(Expression, DerivativesOfASoftenedLengthAreFiniteAtTheCentre) {
  Variables at;
  const int node = std::get<int>(at.parse("-1/sqrt(r^2 + 0.01)"));
  EXPECT_EQ(at.value(at.graph.derivative(node, at.x), 0, 0, 0), 0);
}

TEST(Expression, FoldsWhatIsConstantAndComputesWhatIsEqualOnce) {
  Variables at;
  EXPECT_TRUE(at.graph.is_number(std::get<int>(at.parse("2*3 + sin(0) + if(1 < 2, 4, x)"))));
  EXPECT_EQ(std::get<int>(at.parse("x*y + y*x")), std::get<int>(at.parse("2*(y*x)")));
  EXPECT_TRUE(at.graph.is_number(at.graph.derivative(std::get<int>(at.parse("y^2 + t")), at.x)));
  EXPECT_TRUE(at.graph.depends(std::get<int>(at.parse("x*sin(t)")), kTime));
  EXPECT_FALSE(at.graph.depends(std::get<int>(at.parse("x + 0*t")), kTime));
}

// every body's numbers are those that it has alone, whatever the size of the block, and nothing is allocated
TEST(Expression, ABlockIsEachOfItsBodiesAlone) {
  Variables at;
  const std::vector<int> outputs{std::get<int>(at.parse("sin(t)*x/r^3 + exp(-y^2)*(x > y) + k")),
                                 std::get<int>(at.parse("x")), std::get<int>(at.parse("cos(2*t)")),
                                 std::get<int>(at.parse("2"))};
  const Program program(at.graph, outputs);
  EXPECT_TRUE(program.reads(kX) && program.reads(kY) && !program.reads(kV));
  Evaluation evaluation(program);
  std::vector<double> x, y;
  for (int i = 0; i < Program::kLanes; ++i) x.push_back(std::sin(i)), y.push_back(std::cos(3 * i));
  const std::vector<double> uniform{0, 0, 0, 0.4};
  const double* const inputs[] = {x.data(), y.data(), nullptr};
  const std::size_t before = allocations();
  evaluation.begin(uniform);
  evaluation.run(Program::kLanes, inputs);
  EXPECT_EQ(allocations(), before);
  for (int i = 0; i < Program::kLanes; ++i) {
    for (std::size_t k = 0; k < outputs.size(); ++k)
      ASSERT_EQ(evaluation.output(int(k))[i],
                at.value(outputs[k], x[std::size_t(i)], y[std::size_t(i)], 0.4));
  }
}

}  // namespace
}  // namespace obscura::sim
