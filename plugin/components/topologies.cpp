// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <limits>
#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/grid_topology.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "mesh/copies.hpp"
#include "parts/grids.hpp"

namespace hexaplast::components {
namespace {

class RegularGridTopology final : public GridTopology {
 public:
  RegularGridTopology() : GridTopology(attributes::kRegularGridTopology) {}

  void init() override { mesh(); }

  const PointArray& positions() override { return mesh().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return mesh().hexahedra(); }

 private:
  std::vector<Quad> make_quads() override { return grid_quads((mesh(), cells_)); }
  std::vector<Edge> make_edges() override { return grid_edges((mesh(), cells_)); }

  const HexMesh& mesh() {
    if (mesh_) return *mesh_;
    const Vec3 min = vector3("min"), max = vector3("max"), count = num_cells(max - min);
    for (int d = 0; d < 3; ++d)
      if (!(min[d] < max[d])) reject("max", "must be greater than min in every direction");
    accepted(*this, [&] { parts::check_num_hexahedra("n", count.prod()); });
    for (int d = 0; d < 3; ++d) cells_[d] = static_cast<int>(count[d]);
    return mesh_.emplace(regular_grid(cells_, min, max));
  }

  std::array<int, 3> cells_{};
  std::optional<HexMesh> mesh_;
};

/// MeshTopology and the containers: what the scene gives.
class GivenTopology final : public scene::Topology {
 public:
  using Topology::Topology;

  void init() override { take_cells(); }

  const PointArray& positions() override {
    take_cells();
    return positions_;
  }
  const std::vector<Hexahedron>& hexahedra() override {
    take_cells();
    return hexahedra_;
  }
  const std::vector<Quad>& quads() override {
    take_cells();
    if (quads_.empty()) quads_ = faces_of(hexahedra_);
    return quads_;
  }
  const std::vector<Triangle>& triangles() override {
    take_cells();
    return triangles_;
  }
  const std::vector<Edge>& edges() override {
    take_cells();
    if (edges_.empty()) edges_ = edges_of(hexahedra_);
    return edges_;
  }

 private:
  // When first asked for: a topology may stand behind the components that use it.
  void take_cells() {
    if (is_taken_) return;
    positions_ = vectors3("position");
    const int num_nodes =
        positions_.rows() == 0 ? std::numeric_limits<int>::max() : static_cast<int>(positions_.rows());
    hexahedra_ = cells_of<8>(*this, "hexahedra", num_nodes);
    try {
      require_own_nodes(hexahedra_);
    } catch (const InputError& error) {
      reject("hexahedra", error.what());
    }
    quads_ = cells_of<4>(*this, "quads", num_nodes);
    triangles_ = cells_of<3>(*this, "triangles", num_nodes);
    edges_ = cells_of<2>(*this, "edges", num_nodes);
    is_taken_ = true;
  }

  bool is_taken_ = false;
  PointArray positions_;
  std::vector<Hexahedron> hexahedra_;
  std::vector<Quad> quads_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
};

}  // namespace

void add_topologies(scene::Factory& factory) {
  factory.add<RegularGridTopology>(attributes::kRegularGridTopology);
  for (const attributes::Description* description :
       {&attributes::kMeshTopology, &attributes::kHexahedronSetTopologyContainer,
        &attributes::kQuadSetTopologyContainer, &attributes::kTriangleSetTopologyContainer})
    factory.add(*description, [description] { return std::make_unique<GivenTopology>(*description); });
}

}  // namespace hexaplast::components
