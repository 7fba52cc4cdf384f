#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

// How colours look to eyes of several kinds, and how far apart they look.

namespace obscura {

using Rgb = std::array<double, 3>;  // linear sRGB, 0 to 1
using Eye = std::array<Rgb, 3>;     // linear: rows by columns

inline Rgb linear_rgb(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  const auto decode = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  return {decode(r / 255.0), decode(g / 255.0), decode(b / 255.0)};
}

/// What an eye makes of a colour.
inline Rgb seen(const Eye& eye, const Rgb& c) {
  Rgb out{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out[i] += eye[i][j] * c[j];
    out[i] = std::min(1.0, std::max(0.0, out[i]));
  }
  return out;
}

/// CIE L*a*b*, white D65.
inline Rgb lab(const Rgb& c) {
  const double x = (0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2]) / 0.95047;
  const double y = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  const double z = (0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2]) / 1.08883;
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  return {116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))};
}

/// CIE 1976: 2.3 is a just noticeable difference; 10 is plain side by side, 20 across a picture.
inline double color_difference(const Rgb& a, const Rgb& b) {
  return std::sqrt(std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2));
}

// Machado, Oliveira and Fernandes, IEEE TVCG 2009, severity 1, on linear sRGB.
inline constexpr Eye kProtanEye{
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
inline constexpr Eye kDeutanEye{
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
inline constexpr Eye kTritanEye{
    {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};
inline constexpr Eye kNormalEye{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
/// A print in grey.
inline constexpr Eye kGreyEye{{{0.2126, 0.7152, 0.0722}, {0.2126, 0.7152, 0.0722}, {0.2126, 0.7152, 0.0722}}};

}  // namespace obscura
