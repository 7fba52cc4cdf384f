// Numbers in mathematics: live values of labels, and those of axes.

#include "draw/picture/formula_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "draw/picture/formula_text.h"

namespace obscura::draw {

std::optional<ValueSlot> value_slot(std::string_view text) {
  for (std::size_t at = text.find('{'); at != text.npos; at = text.find('{', at + 1)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("{}")) return ValueSlot{at, at + 2, {}};
    if (rest.size() >= 5 && rest.starts_with("{:.") && rest[3] >= '0' && rest[3] <= '9' && rest[4] == '}')
      return ValueSlot{at, at + 5, rest[3] - '0'};
  }
  return {};
}

namespace {

// what stands after a value of a given form, its unit upright
std::string after(std::string rest, std::string_view unit) {
  if (unit.empty()) return rest;
  std::string typed(unit);
  if (const auto square = typed.find("²"); square != typed.npos) typed.replace(square, 2, "^2");
  const std::size_t gap = rest.find_first_not_of(' ');
  if (gap == rest.npos) return rest;
  for (const std::string& word : {std::string(unit), typed}) {
    if (rest.compare(gap, word.size(), word) != 0) continue;
    const std::size_t end = gap + word.size();
    if (end < rest.size() && formulas::latin(rest[end])) continue;
    return fmt::format("\"{}{}\"{}", rest.substr(0, gap), unit, rest.substr(end));
  }
  return rest;
}

// a unit after its value: a space before it, but for degrees
std::string spaced(std::string_view unit) {
  return unit.empty() ? "" : fmt::format("\"{}{}\"", unit == "°" ? "" : " ", unit);
}

// a number with three digits that count has a power of ten from here up, and below that
constexpr double kLarge = 999'999.5, kSmall = 1e-4;
constexpr double kZero = 1e-9;                     // of the largest number of an axis
constexpr int kUsualDigits = 6, kMostDigits = 15;  // of the numbers of an axis
constexpr double kOfStep = 1e-3;                   // between two of them: how far off one is at most
constexpr double kBetweenSamples = 0.005;          // of the range of a live value

// the exponent of a number that has a power of ten
std::optional<int> power_of_ten(double size) {
  if (!std::isfinite(size) || size == 0 || (size >= kSmall && size < kLarge)) return {};
  return int(std::floor(std::log10(size) + 1e-9));
}

// how many digits after the point give three that count
int three_digits(double value) {
  if (!(value > 0)) return 2;
  int power = int(std::floor(std::log10(value)));
  // 0.9999 is shown as 1.00
  if (value + 0.5 * std::pow(10, power - 2) >= std::pow(10, power + 1)) ++power;
  return std::clamp(2 - power, 0, 6);
}

// no minus before a zero
std::string number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_not_of("-0.") == text.npos && text[0] == '-') text.erase(0, 1);
  return text;
}

std::string times_power(int exponent) { return fmt::format(" \\times 10^{{{}}}", exponent); }

// of how many digits the numbers of an axis are
int digits_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] > values[i - 1]) step = std::min(step, values[i] - values[i - 1]);
  const auto told = [&](int digits) {
    return std::all_of(values.begin(), values.end(), [&](double value) {
      return std::abs(std::stod(fmt::format("{:.{}g}", value, digits)) - value) <= kOfStep * step;
    });
  };
  int digits = kUsualDigits;
  while (digits < kMostDigits && !told(digits)) ++digits;
  return digits;
}

// a text with its value and unit in the place of its slot
std::string filled(const std::string& text, const ValueSlot& slot, const std::string& value,
                   std::string_view unit) {
  const std::string before = text.substr(0, slot.begin), rest = text.substr(slot.end);
  // between words of a text with dollars it is mathematics of its own
  bool inside = false, outside = false;
  for (std::size_t at = formulas::dollar(text, 0); at != text.npos; at = formulas::dollar(text, at + 1)) {
    outside = true;
    if (at < slot.begin) inside = !inside;
  }
  outside = outside && !inside;
  const std::string with_unit = slot.decimals ? value : value + spaced(unit);
  if (outside) return before + "$" + with_unit + "$" + rest;
  return before + with_unit + (slot.decimals ? after(rest, unit) : rest);
}

}  // namespace

std::string as_number(double value, std::optional<int> exponent, int digits) {
  if (!exponent) exponent = power_of_ten(std::abs(value));
  if (value == 0 || !exponent) return fmt::format("{:.{}g}", value == 0 ? 0.0 : value, digits);
  return fmt::format("{:.{}g}", value / std::pow(10, *exponent), digits) + times_power(*exponent);
}

std::vector<std::string> as_numbers(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  const auto shown = [&](double value) { return std::abs(value) < kZero * most ? 0 : value; };
  const bool powers = std::any_of(values.begin(), values.end(), [&](double value) {
    return power_of_ten(std::abs(shown(value))).has_value();
  });
  const auto exponent = powers ? std::optional(int(std::floor(std::log10(most) + 1e-9))) : std::nullopt;
  const int digits = digits_of(values);
  std::vector<std::string> all;
  for (const double value : values) all.push_back(as_number(shown(value), exponent, digits));
  return all;
}

std::string with_value(const std::string& text, double value, std::string_view unit) {
  const auto slot = value_slot(text);
  if (!slot) return text;
  if (slot->decimals) return filled(text, *slot, number(value, *slot->decimals), unit);
  const double size = std::abs(value);
  auto exponent = power_of_ten(size);
  if (exponent && size / std::pow(10, *exponent) >= 9.995) ++*exponent;  // 9.999 is shown as 10.0
  return filled(text, *slot,
                exponent        ? number(value / std::pow(10, *exponent), 2) + times_power(*exponent)
                : size >= 999.5 ? number(value, 0)
                                : fmt::format("{:.3g}", value),
                unit);
}

Formula live(const std::string& text, double value, double low, double high, std::string_view unit,
             double size, Color color) {
  const auto slot = value_slot(text);
  if (!slot) return formula(text, size, color);
  const double most = std::max(std::abs(low), std::abs(high));
  // one power of ten for the whole run
  const auto exponent = slot->decimals ? std::optional<int>() : power_of_ten(most);
  const double part = exponent ? std::pow(10, *exponent) : 1;
  const int digits = slot->decimals ? *slot->decimals : exponent ? 2 : three_digits(most);
  const auto width = [&](double x) {
    return formula(kNumber + number(x / part, digits) + kNumberEnd, size, color).width;
  };
  // the range was found at samples: between them the value goes a little farther, but to no other sign
  const double beyond = kBetweenSamples * (high - low);
  const double own = width(value), widest = std::max({own, width(low < 0 ? low - beyond : low),
                                                      width(high > 0 ? high + beyond : high)});
  const std::string shown =
      kNumber + number(value / part, digits) + kNumberEnd + (exponent ? times_power(*exponent) : "");
  const std::string whole = filled(text, *slot, shown, unit);
  return formula(whole, size, color, (widest - own) / size);
}

}  // namespace obscura::draw
