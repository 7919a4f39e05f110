// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/grid_topology.hpp"
#include "components/part.hpp"
#include "components/topological_mapping.hpp"
#include "geometry/round_grid.hpp"
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

  void init() override { make(); }

  const PointArray& positions() override {
    make();
    return grid_ ? grid_->positions() : flat_positions_;
  }
  const std::vector<Hexahedron>& hexahedra() override {
    static const std::vector<Hexahedron> none;
    make();
    return grid_ ? grid_->hexahedra() : none;
  }

  std::array<int, 2> cells_across() override {
    make();
    return {cells_[0], cells_[1]};
  }

 private:
  std::vector<Quad> make_quads() override { return grid_quads((make(), cells_)); }
  std::vector<Edge> make_edges() override { return grid_edges((make(), cells_)); }

  void make() {
    if (is_made_) return;
    auto [min, max] = corners();
    const Vec3 count = real("cellWidth") > 0 ? num_cells(max - min) : one_by_one(num_cells(max - min));
    for (int d = 0; d < 3; ++d)
      if (count[d] != 0 && !(min[d] < max[d])) reject("max", "must be greater than min in every direction");
    const bool is_flat = (count.array() == 0).any();
    if (is_given("p0")) {
      max += vector3("p0") - min;
      min = vector3("p0");
    } else {
      // as SOFA does, and not for z
      for (int d = 0; d < 2; ++d)
        if (count[d] == 0) min[d] = (min[d] + max[d]) / 2;
    }
    if (is_flat)
      accepted(*this, [&] { parts::check_num_cells("n", (count.array() + 1).prod()); });
    else
      accepted(*this, [&] { parts::check_num_hexahedra("n", count.prod()); });
    for (int d = 0; d < 3; ++d) cells_[d] = static_cast<int>(count[d]);
    if (is_flat)
      flat_positions_ = grid_points(cells_, min, (max - min).cwiseQuotient(count.cwiseMax(1)));
    else
      grid_ = regular_grid(cells_, min, max);
    is_made_ = true;
  }

  std::pair<Vec3, Vec3> corners() {
    static constexpr const char* kNames[] = {"xmin", "ymin", "zmin", "xmax", "ymax", "zmax"};
    const auto num_given = std::ranges::count_if(kNames, [&](const char* name) { return is_given(name); });
    if (num_given == 0) return {vector3("min"), vector3("max")};
    for (const char* name : kNames)
      if (!is_given(name)) reject(name, "is not given, others of the six are: all are needed");
    return {{real("xmin"), real("ymin"), real("zmin")}, {real("xmax"), real("ymax"), real("zmax")}};
  }

  /// With nx, ny and nz in place of what n says, where they are given.
  Vec3 one_by_one(Vec3 cells) {
    static constexpr const char* kNames[] = {"nx", "ny", "nz"};
    for (int d = 0; d < 3; ++d)
      if (is_given(kNames[d])) cells[d] = integer(kNames[d]) - 1;
    return cells;
  }

  std::array<int, 3> cells_{};
  bool is_made_ = false;
  std::optional<HexMesh> grid_;  // none: the grid is flat
  PointArray flat_positions_;
};

/// CylinderGridTopology and SphereGridTopology.
class RoundGridTopology final : public MadeTopology {
 public:
  using MadeTopology::MadeTopology;

  void init() override { mesh(); }

  const PointArray& positions() override { return mesh().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return mesh().hexahedra(); }
  std::array<int, 2> cells_across() override {
    mesh();
    return {grid_.cells[0], grid_.cells[1]};
  }

 private:
  std::vector<Quad> make_quads() override { return grid_quads((mesh(), grid_.cells)); }
  std::vector<Edge> make_edges() override { return grid_edges((mesh(), grid_.cells)); }

  const HexMesh& mesh() {
    if (mesh_) return *mesh_;
    const std::vector<std::int64_t>& n = integers("n");
    if (n.size() != 3) reject("n", fmt::format("{} numbers given, must be three", n.size()));
    static constexpr const char* kNames[] = {"nx", "ny", "nz"};
    Vec3 count;
    for (int d = 0; d < 3; ++d) count[d] = static_cast<double>(is_given(kNames[d]) ? integer(kNames[d]) : n[d]) - 1;
    accepted(*this, [&] { parts::check_num_hexahedra("n", count.prod()); });
    accepted(*this, [&] { parts::check_num_cells("n", (count.array() + 1).prod()); });
    for (int d = 0; d < 3; ++d) grid_.cells[d] = static_cast<int>(count[d]);
    grid_.centre = vector3("center");
    grid_.axis = vector3("axis");
    if (grid_.axis.isZero(0)) reject("axis", "is zero, must have a direction");
    grid_.radius = real("radius");
    if (find_data("length")) grid_.length = real("length");
    mesh_.emplace(grid_points(grid_), regular_grid(grid_.cells, Vec3::Zero(), Vec3::Ones()).hexahedra());
    return *mesh_;
  }

  RoundGrid grid_;
  std::optional<HexMesh> mesh_;
};

/// MeshTopology and the containers. What the scene gives, or a topological mapping makes.
class GivenTopology final : public scene::Topology {
 public:
  using Topology::Topology;

  void init() override { take_cells(); }

  void provide(scene::Data& output) override {
    if (output.is_given() || is_taking_ || stage() == Stage::kFailed) return;
    take_cells();
    if (!is_mapped_) return;
    const std::string_view name = output.attribute().name;
    if (name == "position") output.set_once([this] { return flattened(positions_); });
    if (name == "quads") output.set_once([this] { return flattened<4>(quads_); });
    if (name == "triangles") output.set_once([this] { return flattened<3>(triangles_); });
    if (name == "tetrahedra") output.set_once([this] { return flattened<4>(tetrahedra_); });
  }

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
  const std::vector<scene::Tetrahedron>& tetrahedra() override {
    take_cells();
    return tetrahedra_;
  }

 private:
  // When first asked for: a topology may stand behind the components that use it.
  void take_cells() {
    if (is_taken_) return;
    if (std::exchange(is_taking_, true)) reject("is made of itself by topological mappings");
    try {
      take_given();
      for (TopologicalMapping* mapping : node().root().all<TopologicalMapping>())
        if (mapping->output() == this) take(mapping->make());
    } catch (...) {
      is_taking_ = false;
      throw;
    }
    is_taking_ = false;
    is_taken_ = true;
  }

  void take(MappedCells cells) {
    is_mapped_ = true;
    if (positions_.rows() == 0) positions_ = std::move(cells.positions);
    // what the scene gives besides was read without knowing the nodes
    cells_of<8>(*this, "hexahedra", static_cast<int>(positions_.rows()));
    cells_of<2>(*this, "edges", static_cast<int>(positions_.rows()));
    tetrahedra_ = std::move(cells.tetrahedra);
    quads_ = std::move(cells.quads);
    triangles_ = std::move(cells.triangles);
  }

  void take_given() {
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
    tetrahedra_ = cells_of<4>(*this, "tetrahedra", num_nodes);
  }

  bool is_taken_ = false, is_taking_ = false, is_mapped_ = false;
  PointArray positions_;
  std::vector<Hexahedron> hexahedra_;
  std::vector<Quad> quads_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<scene::Tetrahedron> tetrahedra_;
};

}  // namespace

void add_topologies(scene::Factory& factory) {
  factory.add<RegularGridTopology>(attributes::kRegularGridTopology);
  for (const attributes::Description* description :
       {&attributes::kCylinderGridTopology, &attributes::kSphereGridTopology})
    factory.add(*description, [description] { return std::make_unique<RoundGridTopology>(*description); });
  for (const attributes::Description* description :
       {&attributes::kMeshTopology, &attributes::kHexahedronSetTopologyContainer,
        &attributes::kTetrahedronSetTopologyContainer, &attributes::kQuadSetTopologyContainer,
        &attributes::kTriangleSetTopologyContainer, &attributes::kEdgeSetTopologyContainer,
        &attributes::kPointSetTopologyContainer})
    factory.add(*description, [description] { return std::make_unique<GivenTopology>(*description); });
}

}  // namespace hexaplast::components
