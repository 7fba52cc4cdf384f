#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "draw/picture/color.h"
#include "draw/picture/formula.h"

namespace obscura::draw {

/// Where a value goes in a label: "{}", of three digits and with its unit, or "{:.2}", of as many digits
/// after the point.
struct ValueSlot {
  std::size_t begin = 0, end = 0;  // of the text
  std::optional<int> decimals;
};
/// None: the label shows no value.
std::optional<ValueSlot> value_slot(std::string_view text);

/// A number as mathematics: up to so many digits, from a million up and below 1e-4 with a power of ten:
/// "7.4 \times 10^{14}". `exponent`: that of the power.
std::string as_number(double value, std::optional<int> exponent = {}, int digits = 6);

/// The numbers of one axis: if one of them has a power of ten all have that of the largest. They have as many
/// digits as tell them apart, each to a thousandth of the least step between them.
std::vector<std::string> as_numbers(const std::vector<double>& values);

/// `text` with its slot replaced by a value. "{}" has three digits that count, those of a thousand up to a
/// million all before the point; beyond, and below 1e-4, it has a power of ten. What follows "{:.2}" and is
/// the unit is set upright.
std::string with_value(const std::string& text, double value, std::string_view unit);

/// The same for a value that goes from `low` to `high` while the label stays where it is: "{}" has as many
/// digits after the point as give the largest three digits, and its power of ten. Room is left for the
/// longest number: all labels are equally wide, and nothing in them moves but the number's first digits and
/// its sign.
Formula live(const std::string& text, double value, double low, double high, std::string_view unit,
             double size, Color color);

}  // namespace obscura::draw
