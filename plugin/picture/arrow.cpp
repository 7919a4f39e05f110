// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/arrow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

constexpr int kSides = 16;           // of the shaft
constexpr float kHeadLength = 4.2f;  // in parts of the girth
constexpr float kHeadWidth = 1.5f;   // radius of its foot
constexpr float kMostHead = 0.6f;    // in parts of the arrow's length

/// Light as it falls on the body, from above and from the left, and never none.
float brightness(const Vector3f& normal, const Camera& camera) {
  const Vector3f light = (0.6f * camera.up() + 0.7f * camera.towards() - 0.4f * camera.right()).normalized();
  return 0.6f + 0.4f * std::max(0.0f, normal.dot(light));
}

}  // namespace

void Arrow::draw(const Camera& camera, const Pen& pen) const {
  const float length = (to - from).norm();
  if (!(length > 0)) return;
  const Vector3f along = (to - from) / length;
  const Vector3f first = along.unitOrthogonal(), second = along.cross(first);
  // a short arrow is thinner, so that it still has a shaft
  const float thick = std::min(girth, kMostHead * length / kHeadLength);
  const float head = kHeadLength * thick;
  const Vector3f neck = to - head * along;
  const auto outwards = [&](int side) -> Vector3f {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(side) / kSides;
    return std::cos(angle) * first + std::sin(angle) * second;
  };
  const auto lit = [&](const Vector3f& place, const Vector3f& normal) {
    return Corner{place, brightness(normal, camera) * colour};
  };
  const float slope = kHeadWidth * thick / head;
  for (int side = 0; side < kSides; ++side) {
    const std::array<Vector3f, 2> out{outwards(side), outwards(side + 1)};
    std::array<Corner, 2> foot, top, brim;
    for (int k = 0; k < 2; ++k) {
      foot[k] = lit(from + 0.5f * thick * out[k], out[k]);
      top[k] = lit(neck + 0.5f * thick * out[k], out[k]);
      brim[k] = lit(neck + kHeadWidth * thick * out[k], (out[k] + slope * along).normalized());
    }
    const Corner tip = lit(to, ((out[0] + out[1]).normalized() + slope * along).normalized());
    pen.fill({{foot[0], foot[1], top[1]}});
    pen.fill({{foot[0], top[1], top[0]}});
    pen.fill({{brim[0], brim[1], tip}});
    pen.fill({{lit(brim[0].place, -along), lit(brim[1].place, -along), lit(neck, -along)}});
    pen.fill({{lit(foot[0].place, -along), lit(foot[1].place, -along), lit(from, -along)}});
  }
}

}  // namespace hexaplast::output
