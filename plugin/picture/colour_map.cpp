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

/// 0xRRGGBB at equal distances in CIELAB along L = 93 - 56 s, chroma 14 + 48 sin(0.64 pi s), as much as sRGB allows
/// everywhere, and hue 90 - 140 s^1.15 [deg], s from 0 to 1.
constexpr std::array<unsigned, 33> kScale{
    0xf6ead0, 0xf4e2c2, 0xf4dab5, 0xf3d2a8, 0xf4ca9d, 0xf5c293, 0xf6b98b, 0xf7b183, 0xf8a87e, 0xf8a079, 0xf99776,
    0xf98f74, 0xf98673, 0xf87e74, 0xf67674, 0xf46f76, 0xf26778, 0xee607b, 0xea5a7e, 0xe65481, 0xe04f85, 0xda4a88,
    0xd3468c, 0xcc438f, 0xc44193, 0xbb4096, 0xb13f99, 0xa73f9b, 0x9c409d, 0x91409e, 0x85419f, 0x78429f, 0x6a429f};

}  // namespace

Colour colour_of(double t) {
  const double at = std::clamp(t, 0.0, 1.0) * (kScale.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), kScale.size() - 2);
  const auto component = [&](int shift) {
    const double p = kScale[below] >> shift & 0xff, q = kScale[below + 1] >> shift & 0xff;
    return static_cast<float>((p + (at - static_cast<double>(below)) * (q - p)) / 255);
  };
  return {component(16), component(8), component(0)};
}

Colour colour_of_region(int number) {
  if (number == 0) return colour_of(0);
  constexpr double kGoldenAngle = 137.508, kFirst = 20, kChroma = 48;  // [deg]
  const double hue = (kFirst + (number - 1) * kGoldenAngle) * std::numbers::pi / 180;
  return srgb({number % 2 ? 52.0 : 66.0, kChroma * std::cos(hue), kChroma * std::sin(hue)});
}

}  // namespace hexaplast::output
