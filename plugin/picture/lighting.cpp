// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/lighting.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "picture/ink.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int kNumLamps = 72;
constexpr int kMapSize = 256;   // depths per direction
constexpr float kRim = 3;       // [texels] free around the bodies
constexpr float kLift = 1.5f;   // [texels] that a place is looked at above its surface, so that it shades not itself
constexpr float kSlack = 1.0f;  // [texels] by which something must be nearer to the lamp to cast a shadow
constexpr float kSky = 0.45f;   // strength of the even sky; the rest gathers around the main lamp
constexpr float kLampWidth = 0.45f;  // [rad] of the main lamp

}  // namespace

Lighting::Lighting(const Vector3f& up, const Vector3f& towards) {
  const Vector3f right = up.cross(towards);
  const Vector3f zenith = kZenith.of(right, up, towards), main = kMainLamp.of(right, up, towards);
  const Vector3f first = zenith.unitOrthogonal(), second = zenith.cross(first);

  // equal fractions of the hemisphere: equal steps of height, the golden angle from one to the next
  const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
  for (int k = 0; k < kNumLamps; ++k) {
    const float height = (static_cast<float>(k) + 0.5f) / kNumLamps, radius = std::sqrt(1 - height * height);
    const float angle = golden * static_cast<float>(k);
    Lamp lamp;
    lamp.towards = height * zenith + radius * (std::cos(angle) * first + std::sin(angle) * second);
    lamp.right = lamp.towards.unitOrthogonal();
    lamp.up = lamp.towards.cross(lamp.right);
    const float from_main = std::acos(std::clamp(lamp.towards.dot(main), -1.0f, 1.0f)) / kLampWidth;
    lamp.strength = kSky + 6 * (1 - kSky) * std::exp(-from_main * from_main);
    lamps_.push_back(std::move(lamp));
  }

  float brightest = 0;
  for (const Lamp& normal : lamps_) {
    float sum = 0;
    for (const Lamp& lamp : lamps_) sum += lamp.strength * std::max(0.0f, lamp.towards.dot(normal.towards));
    brightest = std::max(brightest, sum);
  }
  for (Lamp& lamp : lamps_) lamp.strength /= brightest;
}

void Lighting::place(std::span<const Vector3f> points, std::span<const Triangle> triangles) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& point : points) box.extend(point);
  const Vector3f centre = points.empty() ? Vector3f(0, 0, 0) : Vector3f(box.center());
  float radius = 0;
  for (const Vector3f& point : points) radius = std::max(radius, (point - centre).norm());
  texel_ = std::max(2 * radius / (kMapSize - 2 * kRim), std::numeric_limits<float>::min());
  for (Lamp& lamp : lamps_) {
    lamp.corner = Vector2f(lamp.right.dot(centre), lamp.up.dot(centre)).array() - texel_ * kMapSize / 2;
    draw(lamp, points, triangles);
  }
}

void Lighting::draw(Lamp& lamp, std::span<const Vector3f> points, std::span<const Triangle> triangles) const {
  lamp.depth.assign(kMapSize * kMapSize, -std::numeric_limits<float>::infinity());
  std::vector<Vector3f> seen;  // x and y in texels, depth
  seen.reserve(points.size());
  for (const Vector3f& point : points)
    seen.emplace_back((lamp.right.dot(point) - lamp.corner.x()) / texel_,
                      (lamp.up.dot(point) - lamp.corner.y()) / texel_, lamp.towards.dot(point));

  for (const auto& [i, j, k] : triangles) {
    const Vector3f &a = seen[i], u = seen[j] - a, v = seen[k] - a;
    const float area = u.x() * v.y() - u.y() * v.x();
    if (area == 0) continue;
    // texels whose centre lies within the triangle
    const auto [left, right] = std::minmax({a.x(), seen[j].x(), seen[k].x()});
    const auto [low, high] = std::minmax({a.y(), seen[j].y(), seen[k].y()});
    const int x1 = std::min(kMapSize - 1, static_cast<int>(right)), y1 = std::min(kMapSize - 1, static_cast<int>(high));
    for (int y = std::max(0, static_cast<int>(low)); y <= y1; ++y)
      for (int x = std::max(0, static_cast<int>(left)); x <= x1; ++x) {
        const float dx = static_cast<float>(x) + 0.5f - a.x(), dy = static_cast<float>(y) + 0.5f - a.y();
        const float s = (dx * v.y() - dy * v.x()) / area, t = (u.x() * dy - u.y() * dx) / area;
        if (s < 0 || t < 0 || s + t > 1) continue;
        float& depth = lamp.depth[y * kMapSize + x];
        depth = std::max(depth, a.z() + s * u.z() + t * v.z());
      }
  }
}

float Lighting::reach(const Lamp& lamp, const Vector3f& place) const {
  const float x = (lamp.right.dot(place) - lamp.corner.x()) / texel_ - 0.5f;
  const float y = (lamp.up.dot(place) - lamp.corner.y()) / texel_ - 0.5f;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const float depth = lamp.towards.dot(place) + kSlack * texel_;
  const auto arrives = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= kMapSize || row >= kMapSize) return 1.0f;
    return lamp.depth[row * kMapSize + column] <= depth ? 1.0f : 0.0f;
  };
  return (1 - t) * ((1 - s) * arrives(i, j) + s * arrives(i + 1, j)) +
         t * ((1 - s) * arrives(i, j + 1) + s * arrives(i + 1, j + 1));
}

float Lighting::received(const Vector3f& place, const Vector3f& normal) const {
  const Vector3f above = place + kLift * texel_ * normal;
  float sum = 0;
  for (const Lamp& lamp : lamps_) {
    const float slant = lamp.towards.dot(normal);
    if (slant > 0) sum += lamp.strength * slant * reach(lamp, above);
  }
  return sum;
}

}  // namespace hexaplast::output
