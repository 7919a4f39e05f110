// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/arrow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "picture/ink.hpp"

namespace hexaplast::output {

using Eigen::Vector3f;

void Arrow::draw(Geometry::Vertices& triangles) const {
  using Vertex = Geometry::Vertex;
  const float length = (to - from).norm();
  if (!(length > 0)) return;
  const Vector3f along = (to - from) / length;
  const Vector3f first = along.unitOrthogonal(), second = along.cross(first);
  // a short arrow is thinner, so that it still has a shaft
  const float thick = std::min(girth, kArrowMaxHead * length / kArrowHeadLength);
  const float head = kArrowHeadLength * thick;
  const Vector3f neck = to - head * along;
  const auto outwards = [&](int side) -> Vector3f {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(side) / kArrowSides;
    return std::cos(angle) * first + std::sin(angle) * second;
  };
  const float slope = kArrowHeadWidth * thick / head;
  for (int side = 0; side < kArrowSides; ++side) {
    const std::array<Vector3f, 2> out{outwards(side), outwards(side + 1)};
    std::array<Vertex, 2> foot, top, brim;
    for (int k = 0; k < 2; ++k) {
      foot[k] = {from + 0.5f * thick * out[k], out[k]};
      top[k] = {neck + 0.5f * thick * out[k], out[k]};
      brim[k] = {neck + kArrowHeadWidth * thick * out[k], (out[k] + slope * along).normalized()};
    }
    const Vertex tip{to, ((out[0] + out[1]).normalized() + slope * along).normalized()};
    triangles.add({foot[0], foot[1], top[1], foot[0], top[1], top[0], brim[0], brim[1], tip});
    for (const auto& [end, middle] : {std::pair(brim, neck), std::pair(foot, from)})
      triangles.add({{end[0].place, -along}, {end[1].place, -along}, {middle, -along}});
  }
}

}  // namespace hexaplast::output
