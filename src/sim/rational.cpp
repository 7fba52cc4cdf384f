#include "sim/rational.h"

#include <charconv>
#include <cmath>
#include <numeric>

namespace obscura::sim {

namespace {

__extension__ typedef __int128 Wide;

constexpr Wide kMost = INT64_MAX;

// in lowest terms, or nothing where it does not fit 64 bits
std::optional<Rational> reduce(Wide num, Wide den) {
  if (den == 0) return {};
  if (den < 0) num = -num, den = -den;
  Wide a = num < 0 ? -num : num, b = den;
  while (b != 0) {
    const Wide r = a % b;
    a = b, b = r;
  }
  if (a > 1) num /= a, den /= a;
  if (num > kMost || num < -kMost || den > kMost) return {};
  return Rational{std::int64_t(num), std::int64_t(den)};
}

// in lowest terms; what does not fit 64 bits, by what does and is near it
Rational nearest(Wide num, Wide den) {
  if (const auto exact = reduce(num, den)) return *exact;
  if (den < 0) num = -num, den = -den;
  while (num > kMost || num < -kMost || den > kMost) num /= 2, den = (den + 1) / 2;
  return *reduce(num, den);
}

// an unsigned or signed decimal with an optional exponent, exactly
std::optional<Rational> parse_decimal(std::string_view s) {
  bool negative = false;
  if (!s.empty() && (s[0] == '-' || s[0] == '+')) negative = s[0] == '-', s.remove_prefix(1);
  Wide num = 0, den = 1;
  bool digits = false, point = false;
  std::size_t i = 0;
  for (; i < s.size(); ++i) {
    if (s[i] == '.' && !point) {
      point = true;
    } else if (s[i] >= '0' && s[i] <= '9') {
      digits = true;
      num = num * 10 + (s[i] - '0');
      if (point) den *= 10;
      if (num > kMost || den > kMost) return {};
    } else {
      break;
    }
  }
  if (!digits) return {};
  if (i < s.size() && (s[i] == 'e' || s[i] == 'E')) {
    ++i;
    if (i < s.size() && s[i] == '+') ++i;
    int exponent = 0;
    const auto [end, error] = std::from_chars(s.data() + i, s.data() + s.size(), exponent);
    if (error != std::errc() || end != s.data() + s.size() || exponent > 18 || exponent < -36) return {};
    for (; exponent > 0; --exponent) num *= 10;
    for (; exponent < 0; ++exponent) {
      if (num % 10 == 0)
        num /= 10;
      else
        den *= 10;
      if (den > kMost) return {};
    }
    i = s.size();
  }
  if (i != s.size()) return {};
  return reduce(negative ? -num : num, den);
}

}  // namespace

Rational rational(std::int64_t num, std::int64_t den) { return nearest(num, den); }

std::optional<Rational> parse_rational(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_decimal(text);
  const auto num = parse_decimal(text.substr(0, slash));
  const auto den = parse_decimal(text.substr(slash + 1));
  if (!num || !den || den->num == 0) return {};
  return reduce(Wide(num->num) * den->den, Wide(num->den) * den->num);
}

std::optional<Rational> from_double(double x) {
  if (!std::isfinite(x)) return {};
  char digits[64];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, x);
  if (error != std::errc()) return {};
  return parse_decimal({digits, std::size_t(end - digits)});
}

double value(Rational r) { return double(r.num) / double(r.den); }

std::string text(Rational r) {
  return r.den == 1 ? std::to_string(r.num) : std::to_string(r.num) + '/' + std::to_string(r.den);
}

Rational operator+(Rational a, Rational b) {
  return nearest(Wide(a.num) * b.den + Wide(b.num) * a.den, Wide(a.den) * b.den);
}
Rational operator-(Rational a, Rational b) { return a + Rational{-b.num, b.den}; }
Rational operator*(Rational a, Rational b) { return nearest(Wide(a.num) * b.num, Wide(a.den) * b.den); }
Rational operator/(Rational a, Rational b) { return nearest(Wide(a.num) * b.den, Wide(a.den) * b.num); }
bool operator<(Rational a, Rational b) { return Wide(a.num) * b.den < Wide(b.num) * a.den; }

std::int64_t floor(Rational r) {
  const std::int64_t q = r.num / r.den;
  return r.num % r.den < 0 ? q - 1 : q;
}
std::int64_t ceil(Rational r) { return -floor(Rational{-r.num, r.den}); }

}  // namespace obscura::sim
