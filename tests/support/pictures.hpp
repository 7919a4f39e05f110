// SPDX-License-Identifier: LGPL-2.1-or-later
// What tests of pictures begin with.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "picture/gallery.hpp"
#include "picture/ink.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
using namespace output;

namespace support {

using Rgb = std::array<int, 3>;

inline Rgb pixel(const Image& image, int x, int y) {
  const std::uint8_t* at = &image.pixels[(static_cast<std::size_t>(y) * image.width + x) * 3];
  return {at[0], at[1], at[2]};
}

inline Rgb bytes(const Colour& colour) {
  return {static_cast<int>(std::lround(255 * colour.red)), static_cast<int>(std::lround(255 * colour.green)),
          static_cast<int>(std::lround(255 * colour.blue))};
}

inline int difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

inline std::vector<Drawing> drawings_of(const Gallery& gallery) {
  std::vector<Drawing> drawings;
  gallery.for_each_drawing([&](int, const Drawing& drawing) { drawings.push_back(drawing); });
  return drawings;
}

inline Image rendered(const Drawing& drawing) { return load_renderer()->render(drawing); }

/// Of a mesh at rest, each hexahedron with its value.
inline Drawing drawing_of(const HexMesh& mesh, const std::vector<double>& values, const Staging& staging = {},
                          const BoundaryConditions& conditions = {}) {
  Gallery gallery(mesh, "test", 2, staging);
  gallery.add(0, 0, mesh.positions(), values, {}, conditions);
  return drawings_of(gallery)[0];
}

inline std::set<std::string> words_of(const Drawing& drawing) {
  std::set<std::string> words;
  for (const Drawing::Text& text : drawing.texts) words.insert(text.words);
  return words;
}

/// A staging without the edges of hexahedra, and without what shows the body as it was.
inline Staging plain_staging() {
  Staging staging;
  staging.shows_edges = false;
  staging.ghost.clear();
  return staging;
}

}  // namespace support
using namespace support;
}  // namespace hexaplast
