// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/topological_mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast::components {
namespace {

/// The cells whose nodes no other one of them has, in their order.
template <class Cell>
std::vector<Cell> without_twins(const std::vector<Cell>& cells) {
  std::map<Cell, int> count;
  for (const Cell& cell : cells) ++count[sorted(cell)];
  std::vector<Cell> single;
  std::ranges::copy_if(cells, std::back_inserter(single), [&](const Cell& cell) { return count[sorted(cell)] == 1; });
  return single;
}

template <class Cell>
void flip(std::vector<Cell>& cells) {
  for (Cell& cell : cells) std::ranges::reverse(cell);
}

class Hexa2QuadTopologicalMapping final : public TopologicalMapping {
 public:
  Hexa2QuadTopologicalMapping() : TopologicalMapping(attributes::kHexa2QuadTopologicalMapping) {}

  MappedCells make() override {
    std::vector<Quad> faces;
    for (const Hexahedron& hexahedron : input().hexahedra())
      for (const Quad& face : kFaces) faces.push_back(face_of(hexahedron, face));
    MappedCells cells{.positions = input().positions(), .quads = without_twins(faces)};
    if (boolean("flipNormals")) flip(cells.quads);
    return cells;
  }
};

class Quad2TriangleTopologicalMapping final : public TopologicalMapping {
 public:
  Quad2TriangleTopologicalMapping() : TopologicalMapping(attributes::kQuad2TriangleTopologicalMapping) {}

  MappedCells make() override {
    MappedCells cells{.positions = input().positions()};
    for (const Quad& quad : input().quads()) {
      cells.triangles.push_back({quad[0], quad[1], quad[2]});
      cells.triangles.push_back({quad[0], quad[2], quad[3]});
    }
    return cells;
  }
};

class Hexa2TetraTopologicalMapping final : public TopologicalMapping {
 public:
  Hexa2TetraTopologicalMapping() : TopologicalMapping(attributes::kHexa2TetraTopologicalMapping) {}

  MappedCells make() override {
    // around the diagonal from corner 0 to corner 6, one for each way along three edges
    static constexpr scene::Tetrahedron kSix[] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                                  {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
    MappedCells cells{.positions = input().positions()};
    for (const Hexahedron& hexahedron : input().hexahedra())
      for (const scene::Tetrahedron& one : kSix)
        cells.tetrahedra.push_back({hexahedron[one[0]], hexahedron[one[1]], hexahedron[one[2]], hexahedron[one[3]]});
    return cells;
  }
};

class Tetra2TriangleTopologicalMapping final : public TopologicalMapping {
 public:
  Tetra2TriangleTopologicalMapping() : TopologicalMapping(attributes::kTetra2TriangleTopologicalMapping) {}

  MappedCells make() override {
    std::vector<Triangle> faces;
    for (const auto& [a, b, c, d] : input().tetrahedra())
      for (const Triangle& face : {Triangle{a, c, b}, Triangle{a, b, d}, Triangle{b, c, d}, Triangle{a, d, c}})
        faces.push_back(face);
    MappedCells cells{.positions = input().positions(), .triangles = without_twins(faces)};
    if (boolean("flipNormals")) flip(cells.triangles);
    return cells;
  }
};

}  // namespace

void TopologicalMapping::init() {
  if (!find_data("output")->target()) reject("output", "is not given, must lead to a topology");
  if (!output()) linked<scene::Topology>("output");  // which tells where it leads
  if (&input() == output()) reject("output", "leads to the input: must be another topology");
  output()->positions();
}

scene::Topology* TopologicalMapping::output() { return dynamic_cast<scene::Topology*>(find_data("output")->target()); }

scene::Topology& TopologicalMapping::input() {
  if (find_data("input")->target()) return linked<scene::Topology>("input");
  scene::Topology* above = node().parent() ? node().parent()->nearest<scene::Topology>() : nullptr;
  if (!above) reject("input", "is not given, and there is no topology above");
  return *above;
}

void add_topological_mappings(scene::Factory& factory) {
  factory.add<Hexa2QuadTopologicalMapping>(attributes::kHexa2QuadTopologicalMapping);
  factory.add<Quad2TriangleTopologicalMapping>(attributes::kQuad2TriangleTopologicalMapping);
  factory.add<Hexa2TetraTopologicalMapping>(attributes::kHexa2TetraTopologicalMapping);
  factory.add<Tetra2TriangleTopologicalMapping>(attributes::kTetra2TriangleTopologicalMapping);
}

}  // namespace hexaplast::components
