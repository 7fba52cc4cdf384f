#include "app/compare/runs.h"
#include "app/console/say.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <string_view>

#include <nlohmann/json.hpp>

#include "app/compare/format.h"
#include "app/console/exit.h"

namespace obscura::app {

namespace {

constexpr std::size_t kMostQuantities = 20;  // of the table of quantities

struct StateColumn {
  std::string body, quantity, component;  // "ball", "position", "x"
  std::size_t a = 0, b = 0;               // in the tables
  std::size_t group = 0;                  // in the quantities
};

bool is_component(const std::string& word) {
  return word == "x" || word == "y" || word == "z" || word == "w";
}

// sums over all bodies stand under "energy", or under no name
bool is_body(const std::string& name) { return !name.empty() && name != "energy"; }

StateColumn named(const std::string& name) {
  StateColumn column;
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) {
    column.quantity = name;
    return column;
  }
  column.body = name.substr(0, dot), column.quantity = name.substr(dot + 1);
  const std::size_t last = column.quantity.rfind('.');
  if (last != std::string::npos && is_component(column.quantity.substr(last + 1))) {
    column.component = column.quantity.substr(last + 1);
    column.quantity = column.quantity.substr(0, last);
  } else if (is_component(column.quantity)) {
    // "momentum.x"
    column.component = column.quantity, column.quantity = column.body, column.body.clear();
  }
  return column;
}

// equal; or both infinite of one sign, or both not a number
bool the_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

// JSON has no word for what is not finite
nlohmann::ordered_json json_of(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(fmt::format("{}", x));
}

// a row of b at time t; between two rows on the straight line, where that is asked for
std::optional<std::vector<double>> row_at(const Table& b, double t, bool interpolate, int& line) {
  const auto next = std::lower_bound(b.rows.begin(), b.rows.end(), t,
                                     [&](const auto& row, double time) { return row[b.time_column] < time; });
  const auto at = [&](auto row) {
    line = b.lines[std::size_t(row - b.rows.begin())];
    return *row;
  };
  if (next != b.rows.end() && same_time((*next)[b.time_column], t)) return at(next);
  if (next != b.rows.begin() && same_time((*(next - 1))[b.time_column], t)) return at(next - 1);
  if (!interpolate || next == b.rows.begin() || next == b.rows.end()) return {};
  const auto before = next - 1;
  const double s = (t - (*before)[b.time_column]) / ((*next)[b.time_column] - (*before)[b.time_column]);
  std::vector<double> row = at(before);
  for (std::size_t i = 0; i < row.size(); ++i)
    if (!the_same(row[i], (*next)[i])) row[i] += s * ((*next)[i] - row[i]);
  return row;
}

std::string joined(const std::string& body, const std::string& quantity) {
  return body.empty() ? quantity : body + "." + quantity;
}

// the columns in common, in a's order; "time" matches rows, and "step" is another clock's. `missing`: those
// of a alone
std::vector<StateColumn> common_columns(const Table& a, const Table& b, std::vector<std::string>& missing,
                                        RunComparison& found) {
  std::vector<StateColumn> columns;
  for (std::size_t i = 0; i < a.columns.size(); ++i) {
    if (a.columns[i] == "time" || a.columns[i] == "step") continue;
    const auto there = b.column(a.columns[i]);
    if (!there) {
      missing.push_back(a.columns[i]);
      continue;
    }
    StateColumn column = named(a.columns[i]);
    column.a = i, column.b = *there;
    auto& all = found.quantities;
    auto group = std::find_if(all.begin(), all.end(), [&](const auto& q) {
      return q.body == column.body && q.name == column.quantity;
    });
    if (group == all.end())
      group = all.insert(all.end(), RunComparison::Quantity{column.body, column.quantity});
    column.group = std::size_t(group - all.begin());
    columns.push_back(column);
  }
  // at one time, report bodies before sums over bodies
  std::stable_partition(columns.begin(), columns.end(),
                        [](const StateColumn& column) { return is_body(column.body); });
  return columns;
}

// What a table may leave out as a whole: all of a body but where it is, and what is of no one body. A column
// of another name, or a component of a quantity whose others are there, was asked for.
bool may_be_left_out(const StateColumn& column, const Table& b) {
  static constexpr std::string_view kOptional[] = {"angle", "orientation", "velocity", "spin", "force"};
  if (is_body(column.body) &&
      std::find(std::begin(kOptional), std::end(kOptional), column.quantity) == std::end(kOptional))
    return false;
  return std::none_of(b.columns.begin(), b.columns.end(), [&](const std::string& name) {
    const StateColumn there = named(name);
    return !there.component.empty() && there.body == column.body && there.quantity == column.quantity;
  });
}

// says which columns only one table has, and what of both is no column
void report_others(const Table& a, const Table& b, const std::vector<StateColumn>& columns,
                   std::vector<std::string> missing, RunComparison& found) {
  std::vector<std::string> extra;
  for (const std::string& name : b.columns)
    if (name != "time" && name != "step" && !a.column(name)) extra.push_back(name);
  if (columns.empty()) found.plain.push_back("they have no column in common but time");
  // a missing body, or what was asked for of it, makes it another run; what may be left out is not compared
  std::vector<std::string> absent, lacking;
  std::erase_if(missing, [&](const std::string& name) {
    const StateColumn column = named(name);
    const bool body =
        column.quantity == "position" &&
        std::none_of(columns.begin(), columns.end(), [&](const auto& c) { return c.body == column.body; });
    if (body && (absent.empty() || absent.back() != column.body)) absent.push_back(column.body);
    if (body || may_be_left_out(column, b)) return body;
    lacking.push_back(name);
    return true;
  });
  if (!absent.empty()) found.plain.push_back(fmt::format("{} has no {}", b.file, some_of(absent)));
  if (!lacking.empty()) found.plain.push_back(fmt::format("{} has no column {}", b.file, some_of(lacking)));
  if (!missing.empty())
    found.others.push_back(fmt::format("not compared, because only {} has it: {}", a.file, some_of(missing)));
  if (!extra.empty())
    found.others.push_back(fmt::format("not compared, because only {} has it: {}", b.file, some_of(extra)));
  std::vector<std::string> unread = a.unread;
  for (const std::string& name : b.unread)
    if (std::find(unread.begin(), unread.end(), name) == unread.end()) unread.push_back(name);
  if (a.column("step") || b.column("step")) unread.push_back("step");
  if (!unread.empty()) found.others.push_back("never compared: " + some_of(unread));
}

// b's value of a column in `row`, near a's: angles without whole turns, and of q and -q the nearer one.
// `turns` are those that an angle was more than a's.
double value_near(const std::vector<double>& of_a, const std::vector<double>& row, const StateColumn& column,
                  const std::vector<StateColumn>& columns, double& turns) {
  const double x = of_a[column.a];
  double y = row[column.b];
  if (column.quantity == "angle" && std::isfinite(x) && std::isfinite(y)) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const double rest = std::remainder(y - x, kTurn);
    turns = std::round((y - x - rest) / kTurn);
    y = x + rest;
  }
  if (column.quantity == "orientation") {
    double dot = 0;
    for (const StateColumn& other : columns)
      if (other.group == column.group) dot += of_a[other.a] * row[other.b];
    if (dot < 0) y = -y;
  }
  return y;
}

}  // namespace

bool Tolerance::holds(double a, double b) const {
  if (!std::isfinite(a) || !std::isfinite(b)) return the_same(a, b);
  return a == b || std::abs(b - a) <= absolute + relative * std::abs(a);
}

RunComparison compare(const Table& a, const Table& b, const Tolerance& tolerance, bool interpolate) {
  RunComparison found;
  found.a = a.file, found.b = b.file;
  std::vector<std::string> missing;
  const std::vector<StateColumn> columns = common_columns(a, b, missing, found);
  report_others(a, b, columns, std::move(missing), found);

  std::size_t without = 0;
  double first_without = 0;
  std::vector<std::string> turned;  // angles that are the same but for whole turns
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    const double t = a.time(i);
    int line = 0;
    const auto row = row_at(b, t, interpolate, line);
    if (!row) {
      if (without++ == 0) first_without = t;
      continue;
    }
    ++found.times;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const StateColumn& column = columns[k];
      double turns = 0;
      const double x = a.rows[i][column.a], y = value_near(a.rows[i], *row, column, columns, turns);
      auto& quantity = found.quantities[column.group];
      if (const std::string name = joined(column.body, column.quantity);
          turns != 0 && (turned.empty() || turned.back() != name))
        turned.push_back(name);
      const double off = the_same(x, y)                         ? 0
                         : std::isfinite(x) && std::isfinite(y) ? std::abs(y - x)
                                                                : std::numeric_limits<double>::infinity();
      if (off > quantity.largest) quantity.largest = off, quantity.at = t;
      if (tolerance.holds(x, y)) continue;
      if (!quantity.parts) quantity.parts = true, quantity.first = t;
      if (!found.place) {
        const std::string what =
            column.component.empty() ? column.quantity : column.quantity + "." + column.component;
        found.place = {t, a.lines[i], line, column.body, what, x, y};
      }
    }
  }
  if (without > 0)
    found.plain.push_back(
        fmt::format("{} has no row at {} of {} times, the first t = {:g} s{}", b.file, without, a.rows.size(),
                    first_without, interpolate ? "" : "; --interpolate takes straight lines between rows"));
  if (found.turned = !turned.empty(); found.turned) {
    std::sort(turned.begin(), turned.end());
    turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
    found.others.push_back("compared without whole turns, by which they differ: " + some_of(turned));
  }
  if (found.times == 0 && !columns.empty()) found.plain.push_back("nothing was compared");
  if (b.rows.size() > found.times && !interpolate)
    found.others.push_back(fmt::format("{} has {} more rows", b.file, b.rows.size() - found.times));
  return found;
}

std::string text(const RunComparison& c, const Tolerance& tolerance) {
  std::string all;
  if (c.place) {
    const auto& p = *c.place;
    const std::string what =
        is_body(p.body) ? fmt::format("body {}, {}", p.body, p.quantity) : joined(p.body, p.quantity);
    all = fmt::format("{} and {} part first at t = {:g} s (lines {} and {}): {}: {} and {}", c.a, c.b, p.time,
                      p.line_a, p.line_b, what, p.a, p.b);
    const double allowed = tolerance.absolute + tolerance.relative * std::abs(p.a);
    if (!std::isfinite(p.a) || !std::isfinite(p.b))
      all += "; values that are not finite equal only themselves\n";
    else
      all += fmt::format(", off by {:.3g}{}\n", std::abs(p.b - p.a),
                         allowed > 0 ? fmt::format(", allowed {:.3g}", allowed) : "");
  } else if (c.same()) {
    double most = 0;
    for (const auto& q : c.quantities) most = std::max(most, q.largest);
    all = fmt::format("{} and {} agree at {} in {} quantities, {}\n", c.a, c.b, counted(c.times, "time"),
                      c.quantities.size(),
                      most > 0   ? fmt::format("to {:.3g} at most", most)
                      : c.turned ? "exactly but for whole turns"
                                 : "exactly");
  } else {
    all = fmt::format("{} and {} differ\n", c.a, c.b);
  }
  for (const std::string& line : c.plain) all += "  " + line + "\n";
  for (const std::string& line : c.others) all += "  " + line + "\n";
  if (c.place) {
    all += fmt::format("  {:<28} {:>10} {:>12} {:>10}\n", "quantity", "parts at", "largest", "at");
    std::size_t shown = 0;
    for (const auto& q : c.quantities) {
      if (!q.parts || ++shown > kMostQuantities) continue;
      all += fmt::format("  {:<28} {:>8g} s {:>12.3g} {:>8g} s\n", joined(q.body, q.name), q.first, q.largest,
                         q.at);
    }
    if (shown > kMostQuantities) all += fmt::format("  and {} more\n", shown - kMostQuantities);
  }
  return all;
}

std::string json(const RunComparison& c) {
  nlohmann::ordered_json top = json_head("compare", c.same() ? kDone : kDiffers);
  top["a"] = c.a, top["b"] = c.b, top["same"] = c.same(), top["times"] = c.times;
  if (const auto& p = c.place)
    top["part"] = {{"time", p->time},         {"line_a", p->line_a}, {"line_b", p->line_b}, {"body", p->body},
                   {"quantity", p->quantity}, {"a", json_of(p->a)},  {"b", json_of(p->b)}};
  top["quantities"] = nlohmann::ordered_json::array();
  for (const auto& q : c.quantities) {
    nlohmann::ordered_json it = {{"name", joined(q.body, q.name)}, {"parts", q.parts}};
    if (q.parts) it["first"] = q.first;
    it["largest"] = json_of(q.largest), it["at"] = q.at;
    top["quantities"].push_back(std::move(it));
  }
  top["plain"] = c.plain, top["others"] = c.others;
  return text_of(top);
}

}  // namespace obscura::app
