#include "sim/math/rational.h"

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

// num/den in lowest terms; if that does not fit 64 bits, a near fraction that does
Rational nearest(Wide num, Wide den) {
  if (const auto exact = reduce(num, den)) return *exact;
  if (den < 0) num = -num, den = -den;
  while (num > kMost || num < -kMost || den > kMost) num /= 2, den = (den + 1) / 2;
  return *reduce(num, den);
}

// The simplest fraction of [a, b] = [a_num / a_den, b_num / b_den], 0 < a <= b: the first of the Stern-Brocot
// tree, found by the continued fractions of both ends as far as they agree.
std::optional<Rational> simplest(Wide a_num, Wide a_den, Wide b_num, Wide b_den) {
  const Wide whole = a_num / a_den, rest = a_num % a_den;
  if (rest == 0) return reduce(whole, 1);
  if ((whole + 1) * b_den <= b_num) return reduce(whole + 1, 1);
  const auto below = simplest(b_den, b_num - whole * b_den, a_den, rest);
  if (!below || whole > kMost) return {};
  return reduce(whole * below->num + below->den, below->num);
}

// the simplest fraction whose nearest double is x; none where its ends do not fit
std::optional<Rational> simplest(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(std::abs(x), &exponent);
  // |x| = m / 2^k, with ends half a unit of m away
  const Wide m = Wide(std::ldexp(mantissa, 53));
  const int k = 53 - exponent;
  if (x == 0 || k > 110 || k < 0) return {};
  const Wide den = Wide(1) << (k + 1);
  const auto found = simplest(2 * m - 1, den, 2 * m + 1, den);
  if (!found || value(*found) != std::abs(x)) return {};
  return x < 0 ? Rational{-found->num, found->den} : *found;
}

// whether a decimal has a fraction and so many digits that it is a double which was printed
bool printed(std::string_view s) {
  constexpr std::size_t kDigits = 15;
  std::size_t digits = 0, zeros = 0;
  bool fraction = false;
  for (const char c : s) {
    if (c == 'e' || c == 'E') {
      fraction = true;
      break;
    }
    if (c == '.') fraction = true;
    if (c < '0' || c > '9' || (c == '0' && digits == 0)) continue;
    ++digits;
    zeros = c == '0' ? zeros + 1 : 0;
  }
  return fraction && digits - zeros >= kDigits;
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
  if (slash == std::string_view::npos) {
    const auto exact = parse_decimal(text);
    if (!printed(text)) return exact;
    if (text.starts_with('+')) text.remove_prefix(1);
    double x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (error != std::errc() || end != text.data() + text.size()) return exact;
    const auto found = simplest(x);
    return found ? found : exact;
  }
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
  return parse_rational({digits, std::size_t(end - digits)});
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
