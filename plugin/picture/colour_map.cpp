// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/colour_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hexaplast::output {
namespace {

/// CIELAB, white point D65.
struct Lab {
  double L, a, b;
};

/// The way from pale sand to violet: lightness falls evenly, the hue turns from yellow over red, and the chroma swells
/// as far as sRGB allows everywhere.
Lab way(double s) {
  const double lightness = 93 - 56 * s;
  const double chroma = 14 + 48 * std::sin(0.64 * std::numbers::pi * s);
  const double hue = (90 - 140 * std::pow(s, 1.15)) * std::numbers::pi / 180;
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

double distance(const Lab& p, const Lab& q) { return std::hypot(p.L - q.L, p.a - q.a, p.b - q.b); }

/// Companded sRGB of a linear component.
float companded(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return static_cast<float>(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
}

Colour srgb(const Lab& lab) {
  const auto inverse = [](double f) { return f > 6.0 / 29 ? f * f * f : 3 * (6.0 / 29) * (6.0 / 29) * (f - 4.0 / 29); };
  const double fy = (lab.L + 16) / 116;
  const double x = 0.95047 * inverse(fy + lab.a / 500), y = inverse(fy), z = 1.08883 * inverse(fy - lab.b / 200);
  return {companded(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          companded(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          companded(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

/// Colours at equal distances along the way.
constexpr int kSamples = 257;

std::array<Colour, kSamples> sample_way() {
  constexpr int kFine = 4096;
  std::array<double, kFine + 1> length{};
  for (int i = 1; i <= kFine; ++i)
    length[i] = length[i - 1] + distance(way((i - 1.0) / kFine), way(static_cast<double>(i) / kFine));

  std::array<Colour, kSamples> colours;
  for (int k = 0; k < kSamples; ++k) {
    const double wanted = length[kFine] * k / (kSamples - 1);
    const auto after = std::lower_bound(length.begin(), length.end(), wanted);
    colours[k] = srgb(way(static_cast<double>(after - length.begin()) / kFine));
  }
  return colours;
}

}  // namespace

Colour colour_of(double t) {
  static const std::array<Colour, kSamples> colours = sample_way();
  const float at = static_cast<float>(std::clamp(t, 0.0, 1.0) * (kSamples - 1));
  const int below = std::min(static_cast<int>(at), kSamples - 2);
  const float part = at - static_cast<float>(below);
  const Colour &p = colours[below], &q = colours[below + 1];
  return {p.red + part * (q.red - p.red), p.green + part * (q.green - p.green), p.blue + part * (q.blue - p.blue)};
}

Colour colour_of_region(int number) {
  if (number == 0) return colour_of(0);
  constexpr double kGoldenAngle = 137.508, kFirst = 20, kChroma = 48;  // [deg]
  const double hue = (kFirst + (number - 1) * kGoldenAngle) * std::numbers::pi / 180;
  return srgb({number % 2 ? 52.0 : 66.0, kChroma * std::cos(hue), kChroma * std::sin(hue)});
}

}  // namespace hexaplast::output
