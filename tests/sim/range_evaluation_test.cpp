#include "sim/math/range_evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <variant>
#include <vector>

namespace obscura::sim {
namespace {

// a formula of the time, as it is and by ranges
struct OfTime {
  explicit OfTime(const std::string& text) {
    const std::vector<Symbol> symbols{{"t", graph.variable(0, true)}};
    const auto node = parse_expression(text, symbols, graph);
    EXPECT_TRUE(std::holds_alternative<int>(node)) << text;
    if (std::holds_alternative<int>(node)) program = Program(graph, std::vector<int>{std::get<int>(node)});
  }
  double at(double t) const {
    Evaluation evaluation(program);
    evaluation.begin(std::vector<double>{t});
    return *evaluation.output(0);
  }
  Range over(double from, double to) const {
    RangeEvaluation evaluation(program);
    evaluation.begin(std::vector<Range>{{from, to}});
    return evaluation.output(0);
  }

  ExpressionGraph graph;
  Program program;
};

TEST(RangeEvaluation, HoldsAllThatAFormulaComesTo) {
  std::mt19937 bits(5);
  const auto any = [&] { return double(bits()) / 4294967296.0; };
  for (const char* text : {"t",
                           "3 - t",
                           "t*t - t",
                           "(t - 1)*(2 - t)",
                           "1/t",
                           "t/(t - 2)",
                           "-t^2",
                           "t^3 - 2*t",
                           "t^-2",
                           "t^0.5",
                           "t^t",
                           "2^t",
                           "(t - 1)^4",
                           "sqrt(t)",
                           "sqrt(abs(t))",
                           "exp(-t)",
                           "log(abs(t))",
                           "sin(3*t)",
                           "cos(20*t)",
                           "tan(t)",
                           "asin(t/9)",
                           "acos(t/9)",
                           "atan2(t, 1)",
                           "atan2(1 - t, t)",
                           "atan2(1, t)",
                           "sinh(t)",
                           "cosh(t - 1)",
                           "tanh(t)",
                           "abs(t - 1)",
                           "sign(t)",
                           "sign(sin(5*t))",
                           "floor(4*t)",
                           "min(t, 1 - t)",
                           "max(t, t^2)",
                           "t < 1",
                           "t <= sin(t)",
                           "t > 2*t",
                           "t >= 1",
                           "if(t < 1, t, -t)",
                           "if(abs(t) < 0.01, 100, 0)",
                           "sin(t)^2 + cos(t)^2",
                           "max(log(t), 1)",
                           "sign(sqrt(t))",
                           "sin(1/t)",
                           "max(log(t), 1) > 0",
                           "exp(1000*t) <= exp(2000*t)",
                           "if(log(t) < 0, 1, 2)",
                           "(t - 1)*exp(1000*t)"}) {
    const OfTime formula(text);
    for (int round = 0; round < 200; ++round) {
      const double from = 6 * any() - 3, to = from + std::pow(10, 2 - 6 * any());
      const Range all = formula.over(from, to);
      for (int k = 0; k <= 50; ++k) {
        const double t = std::min(to, from + (to - from) * k / 50), value = formula.at(t);
        if (std::isnan(value)) {
          EXPECT_TRUE(std::isinf(all.least) && std::isinf(all.most)) << text << " at " << t;
          continue;
        }
        EXPECT_LE(all.least, value) << text << " at " << t << " of " << from << " to " << to;
        EXPECT_GE(all.most, value) << text << " at " << t << " of " << from << " to " << to;
      }
    }
  }
}

// What is sure is said: no comparison that cannot change is in doubt.
TEST(RangeEvaluation, IsNotWiderThanNeedBe) {
  const auto is = [](const char* text, double from, double to, double least, double most) {
    const Range all = OfTime(text).over(from, to);
    EXPECT_NEAR(all.least, least, 1e-12) << text;
    EXPECT_NEAR(all.most, most, 1e-12) << text;
  };
  is("t < 1", 0, 0.9, 1, 1);
  is("t < 1", 1, 2, 0, 0);
  is("t < 1", 0.5, 2, 0, 1);
  is("abs(t - 1) < 0.1", 0, 0.8, 0, 0);
  is("abs(t - 1) < 0.1", 0.95, 1.05, 1, 1);
  is("(t - 1)^2 < 0.01", 2, 3, 0, 0);
  is("sin(t)", 0, 1, 0, std::sin(1));
  is("sin(t)", 1, 2, std::sin(1), 1);
  is("cos(t)", -1, 2, std::cos(2), 1);
  is("cos(t)", 1, 7, -1, 1);
  is("sign(sin(t))", 0.1, 3, 1, 1);
  is("floor(t)", 0.2, 0.9, 0, 0);
  is("if(t < 5, t, 100)", 0, 1, 0, 1);
  is("if(t < 5, t, 100)", 4, 6, 4, 100);
  is("t^2", -1, 2, 0, 4);
  is("t^3", 1, 2, 1, 8);
  is("3 + 4", 0, 1, 7, 7);
}

}  // namespace
}  // namespace obscura::sim
