// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/lamps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "picture/ink.hpp"

namespace hexaplast::output {

using Eigen::Matrix3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;

namespace {

// of the many lamps
constexpr float kEvenStrength = 0.45f;  // of those far from the main lamp; the rest gathers around it
constexpr float kMainWidth = 0.45f;     // [rad] of what gathers there
constexpr float kMainStrength = 6;      // in its middle
constexpr float kRim = 3;               // [texels] free around the bodies

}  // namespace

std::pair<std::vector<Matrix3f>, std::vector<float>> lamps_and_strengths(int count) {
  const auto from_viewer = [](const Direction& direction) {
    return direction.of(Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ());
  };
  const Vector3f zenith = from_viewer(kZenith), main = from_viewer(kMainLamp);
  const Vector3f first = zenith.unitOrthogonal(), second = zenith.cross(first);
  std::vector<Vector3f> towards;
  std::vector<float> strengths;
  if (count == 1) {
    towards = {main};
    strengths = {1 - kSkyFraction};
  } else {
    // equal fractions of the hemisphere: equal steps of height, the golden angle from one to the next
    const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
    for (int k = 0; k < count; ++k) {
      const float height = (static_cast<float>(k) + 0.5f) / static_cast<float>(count);
      const float radius = std::sqrt(1 - height * height), angle = golden * static_cast<float>(k);
      towards.push_back(height * zenith + radius * (std::cos(angle) * first + std::sin(angle) * second));
      const float from_main = std::acos(std::clamp(towards.back().dot(main), -1.0f, 1.0f)) / kMainWidth;
      strengths.push_back(kEvenStrength + kMainStrength * (1 - kEvenStrength) * std::exp(-from_main * from_main));
    }
    float brightest = 0;
    for (const Vector3f& normal : towards) {
      float sum = 0;
      for (int k = 0; k < count; ++k) sum += strengths[k] * std::max(0.0f, towards[k].dot(normal));
      brightest = std::max(brightest, sum);
    }
    for (float& strength : strengths) strength /= brightest;
  }

  std::vector<Matrix3f> lamps;
  for (const Vector3f& direction : towards) {
    const Vector3f right = direction.unitOrthogonal();
    lamps.emplace_back();
    lamps.back() << right.transpose(), direction.cross(right).transpose(), direction.transpose();
  }
  return {lamps, strengths};
}

Matrix4f seen_by(const Camera& camera, const Geometry& geometry, int map_size) {
  Eigen::AlignedBox3f box;
  for (const Geometry::Vertices* vertices : {&geometry.surface, &geometry.cut_faces})
    for (const Geometry::Vertex& vertex : *vertices) box.extend(vertex.place);
  const Vector3f centre = box.isEmpty() ? Vector3f(0, 0, 0) : Vector3f(box.center());
  float radius = std::numeric_limits<float>::min();
  for (const Geometry::Vertices* vertices : {&geometry.surface, &geometry.cut_faces})
    for (const Geometry::Vertex& vertex : *vertices) radius = std::max(radius, (vertex.place - centre).norm());
  const float reach = radius / (1 - 2 * kRim / static_cast<float>(map_size));
  Matrix4f matrix = Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() << camera.right().transpose(), camera.up().transpose(), camera.towards().transpose();
  matrix.topLeftCorner<3, 3>() /= reach;
  matrix.topRightCorner<3, 1>() = -matrix.topLeftCorner<3, 3>() * centre;
  return matrix;
}

}  // namespace hexaplast::output
