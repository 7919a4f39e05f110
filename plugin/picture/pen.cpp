// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/pen.hpp"

#include <algorithm>

namespace hexaplast::output {
namespace {

constexpr float kOutlineNearer = 1e-4f;  // depth by which the outline of what stands behind lies before its surface

}  // namespace

Corner operator*(float factor, const Corner& corner) { return {factor * corner.place, factor * corner.colour}; }
Corner operator+(const Corner& a, const Corner& b) {
  return {a.place + b.place,
          {a.colour.red + b.colour.red, a.colour.green + b.colour.green, a.colour.blue + b.colour.blue}};
}

Colour operator*(float factor, const Colour& colour) {
  return {factor * colour.red, factor * colour.green, factor * colour.blue};
}

void Pen::fill(const std::array<Corner, 3>& triangle) const {
  for_each_part(triangle, above_, [&](const std::array<Corner, 3>& part) {
    picture_.triangles.push_back({{vertex(part[0]), vertex(part[1]), vertex(part[2])}});
  });
}

void Pen::line(Corner from, Corner to, float width, float opacity) const {
  for (const Plane& plane : above_) {
    const double at_from = height(plane, from.place), at_to = height(plane, to.place);
    if (at_from < 0 && at_to < 0) return;
    if (at_from >= 0 && at_to >= 0) continue;
    const auto factor = static_cast<float>(at_from / (at_from - at_to));
    (at_from < 0 ? from : to) = (1 - factor) * from + factor * to;
  }
  picture_.lines.push_back({vertex(from), vertex(to), width, opacity});
  if (layer_ != Layer::kBehind) return;
  for (Drawing::Vertex* end : {&picture_.lines.back().from, &picture_.lines.back().to}) end->depth -= kOutlineNearer;
}

bool Pen::reaches(const Eigen::Vector3f& place) const {
  return std::ranges::all_of(above_, [&](const Plane& plane) { return height(plane, place) >= 0; });
}

// The camera's depths lie in [0.1, 0.9], which leaves room on both sides.
Drawing::Vertex Pen::vertex(const Corner& corner) const {
  Drawing::Vertex vertex = camera_.project(corner.place);
  if (layer_ == Layer::kBehind) vertex.depth = 0.93f + 0.06f * vertex.depth;
  if (layer_ == Layer::kInFront) vertex.depth = 0.01f + 0.06f * vertex.depth;
  vertex.colour = corner.colour;
  return vertex;
}

}  // namespace hexaplast::output
