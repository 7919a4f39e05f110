// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/ink.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hexaplast::output {
namespace {

std::string glsl(const Direction& direction) {
  const Eigen::Vector3f unit =
      direction.of(Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY(), Eigen::Vector3f::UnitZ());
  return fmt::format("vec3({:.6f}, {:.6f}, {:.6f})", unit.x(), unit.y(), unit.z());
}

}  // namespace

std::optional<EdgeInk> edge_ink(float length, bool is_cage) {
  if (length < EdgeInk::kShortest) return std::nullopt;
  if (is_cage) return EdgeInk{kCage, EdgeInk::kCageWidth, EdgeInk::kCageOpacity};
  const float fraction = std::min(1.0f, length / EdgeInk::kLongest);
  return EdgeInk{kEdge, EdgeInk::kWidest * std::sqrt(fraction), EdgeInk::kStrongest * fraction};
}

std::string light_shader() {
  return fmt::format(R"(
float sky(vec3 normal) {{ return {sky:.6f} * (0.5 + 0.5 * dot(normal, {zenith})); }}
vec3 moist(vec3 colour, vec3 normal, vec3 sight, float received) {{
  float mirrored = max(dot(normal, normalize({gleam_lamp} + sight)), 0.0);
  return mix(colour * min({darkest:.6f} + {lit:.6f} * received, 1.0), vec3(1.0),
             {gleam:.6f} * received * pow(mirrored, {exponent:.6f}));
}}
vec3 lit_tissue(vec3 colour, vec3 normal, vec3 sight, float arriving) {{
  return moist(colour, normal, sight,
               sky(normal) + (1.0 - {sky:.6f}) * arriving * max(dot(normal, {main}), 0.0));
}}
vec3 lit_thing(vec3 colour, vec3 normal) {{
  return colour * min({darkest:.6f} + {lit:.6f} * max(dot(normal, {thing}), 0.0), 1.0);
}}
)",
                     fmt::arg("zenith", glsl(kZenith)), fmt::arg("sky", kSkyFraction),
                     fmt::arg("main", glsl(kMainLamp)), fmt::arg("gleam_lamp", glsl(kGleamLamp)),
                     fmt::arg("darkest", kDarkest), fmt::arg("lit", kLit), fmt::arg("gleam", kGleam),
                     fmt::arg("exponent", kGleamExponent), fmt::arg("thing", glsl(kThingLamp)));
}

}  // namespace hexaplast::output
