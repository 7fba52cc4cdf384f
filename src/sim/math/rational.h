#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace obscura::sim {

/// A time, a rate or a frame rate, exact: num / den, in lowest terms, den > 0.
struct Rational {
  std::int64_t num = 0;
  std::int64_t den = 1;

  bool operator==(const Rational&) const = default;
};

/// num / den in lowest terms. Requires den != 0.
Rational rational(std::int64_t num, std::int64_t den = 1);

/// Reads "30", "29.97", "30000/1001", "-1.25e-3" exactly. Nothing where it is not a number, or does not fit.
std::optional<Rational> parse_rational(std::string_view text);

/// The decimal a person typed: the shortest decimal that reads back as `x`, as an exact rational, so that
/// 0.1 is 1/10. Nothing where x is not finite or does not fit.
std::optional<Rational> from_double(double x);

/// The nearest double.
double value(Rational r);

/// "30", "30000/1001".
std::string text(Rational r);

Rational operator+(Rational a, Rational b);  // these: exact where that fits 64 bits, else near it
Rational operator-(Rational a, Rational b);
Rational operator*(Rational a, Rational b);
Rational operator/(Rational a, Rational b);
bool operator<(Rational a, Rational b);
inline bool operator<=(Rational a, Rational b) { return !(b < a); }

/// The largest integer not above r, the smallest not below it.
std::int64_t floor(Rational r);
std::int64_t ceil(Rational r);

}  // namespace obscura::sim
