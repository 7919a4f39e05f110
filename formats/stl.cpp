// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "mesh_source.hpp"

namespace hexaplast {
namespace {

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

/// Triangles whose corners are given by their places: corners in one place are one node.
class JoinedTriangles {
 public:
  void add(const std::array<std::array<double, 3>, 3>& corners) {
    Triangle triangle;
    for (int a = 0; a < 3; ++a) {
      const auto [known, is_new] = nodes_.try_emplace(corners[a], static_cast<int>(nodes_.size()));
      if (is_new) points_.insert(points_.end(), corners[a].begin(), corners[a].end());
      triangle[a] = known->second;
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
      ++mesh_.num_degenerate;
    else
      mesh_.triangles.push_back(triangle);
  }

  ImportedMesh take() {
    mesh_.positions = points_of(points_);
    merge_copies(mesh_);
    return std::move(mesh_);
  }

 private:
  ImportedMesh mesh_;
  std::vector<double> points_;
  std::map<std::array<double, 3>, int> nodes_;
};

bool is_word(std::string_view word, std::string_view wanted) { return in_small_letters(word) == wanted; }

void expect_word(MeshSource& source, std::string_view wanted) {
  const std::string_view word = source.word();
  if (!is_word(word, wanted))
    source.refuse(word.empty() ? fmt::format("the file ends where '{}' must stand", wanted)
                               : fmt::format("'{}', must be '{}'", excerpt(word), wanted));
}

/// Where the size is that of as many triangles as the file says.
bool is_binary_stl(std::string_view content, const std::string& name) {
  if (content.size() < kHeaderBytes + sizeof(std::uint32_t)) return false;
  MeshSource source(content.substr(kHeaderBytes), name);
  source.swaps_bytes = std::endian::native == std::endian::big;
  const std::uint64_t count = source.binary<std::uint32_t>();
  return source.remaining() == count * kTriangleBytes;
}

ImportedMesh parse_binary_stl(std::string_view content, const std::string& name) {
  MeshSource source(content, name);
  source.swaps_bytes = std::endian::native == std::endian::big;
  source.skip(kHeaderBytes);
  const auto count = source.binary<std::uint32_t>();
  JoinedTriangles triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    source.skip(3 * sizeof(float));  // the normal: the order of the corners tells it too
    std::array<std::array<double, 3>, 3> corners;
    for (auto& corner : corners)
      for (double& coordinate : corner) {
        coordinate = source.binary<float>();
        if (!std::isfinite(coordinate))
          source.refuse_at_byte(fmt::format("a coordinate of triangle {} is {}, must be finite", i, coordinate));
      }
    source.skip(2);
    triangles.add(corners);
  }
  return triangles.take();
}

ImportedMesh parse_text_stl(std::string_view content, const std::string& name) {
  MeshSource source(content, name);
  if (!is_word(source.word(), "solid"))
    source.refuse("neither begins with 'solid' nor has as many bytes as the triangles of a binary file");
  source.line();  // a name
  JoinedTriangles triangles;
  for (bool is_inside = true;;) {
    const std::string_view word = source.word();
    if (word.empty() && !is_inside) break;
    if (word.empty()) source.refuse("the file ends without 'endsolid'");
    if (is_word(word, is_inside ? "endsolid" : "solid")) {
      source.line();
      is_inside = !is_inside;
      continue;
    }
    if (!is_inside || !is_word(word, "facet"))
      source.refuse(fmt::format("'{}', must be {}", excerpt(word),
                                is_inside ? "'facet' or 'endsolid'" : "'solid', or the end of the file"));
    expect_word(source, "normal");
    for (int d = 0; d < 3; ++d) source.word();  // need not be numbers where a triangle has no normal
    expect_word(source, "outer");
    expect_word(source, "loop");
    std::array<std::array<double, 3>, 3> corners;
    for (auto& corner : corners) {
      expect_word(source, "vertex");
      for (double& coordinate : corner) coordinate = source.real("a coordinate");
    }
    expect_word(source, "endloop");
    expect_word(source, "endfacet");
    triangles.add(corners);
  }
  return triangles.take();
}

}  // namespace

ImportedMesh parse_stl(std::string_view content, const std::string& name) {
  ImportedMesh mesh = is_binary_stl(content, name) ? parse_binary_stl(content, name) : parse_text_stl(content, name);
  if (mesh.triangles.empty()) MeshSource(content, name).refuse("the file holds no triangle");
  return mesh;
}

}  // namespace hexaplast
