// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/arrow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "picture/ink.hpp"

namespace hexaplast::output {

using Eigen::Vector3f;

std::vector<Arrow::Face> Arrow::faces() const {
  std::vector<Face> faces;
  const float length = (to - from).norm();
  if (!(length > 0)) return faces;
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
    faces.push_back({foot[0], foot[1], top[1]});
    faces.push_back({foot[0], top[1], top[0]});
    faces.push_back({brim[0], brim[1], tip});
    faces.push_back({Vertex{brim[0].place, -along}, {brim[1].place, -along}, {neck, -along}});
    faces.push_back({Vertex{foot[0].place, -along}, {foot[1].place, -along}, {from, -along}});
  }
  return faces;
}

void Arrow::draw(const Camera& camera, const Pen& pen) const {
  const Vector3f lamp = kThingLamp.of(camera.right(), camera.up(), camera.towards());
  const auto lit = [&](const Vertex& vertex) {
    return Corner{vertex.place, brightness(std::max(0.0f, vertex.normal.dot(lamp))) * colour};
  };
  for (const auto& [a, b, c] : faces()) pen.fill({{lit(a), lit(b), lit(c)}});
}

Arrow ArrowScale::of_load(const Vector3f& place, const Vector3f& load, const Vector3f& outwards) const {
  const Vector3f along = longest / force * load;
  const bool presses = outwards.dot(load) < -kArrowPresses * outwards.norm() * load.norm();
  return {presses ? Vector3f(place - along) : place, presses ? place : Vector3f(place + along), girth, kLoad};
}

Arrow ArrowScale::of_tool(const Vector3f& place, const Vector3f& load) const {
  return {place, place + longest / force * load, girth, kSteel};
}

}  // namespace hexaplast::output
