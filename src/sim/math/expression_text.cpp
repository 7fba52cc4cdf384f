// Formulas from text, by recursive descent.
//   comparison = sum [(< <= > >= == !=) sum]      sum = product {(+ -) product}
//   product = sign {(* /) sign}      sign = {+ -} power      power = primary [^ sign]

#include <algorithm>
#include <charconv>

#include "sim/math/expression.h"

namespace obscura::sim {

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
