// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "hexaplast/mesh/grid.hpp"

namespace hexaplast::components {
namespace {

constexpr double kMostCells = 16'777'216;  // some 40 GB of body: refused before anything is allocated

class RegularGridTopology final : public scene::Topology {
 public:
  RegularGridTopology() : Topology(attributes::kRegularGridTopology) {}

  void init() override { grid(); }

  const PointArray& positions() override { return grid().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return grid().hexahedra(); }
  const std::vector<Quad>& quads() override {
    if (!quads_) quads_ = grid_quads((grid(), cells_));
    return *quads_;
  }
  const std::vector<Edge>& edges() override {
    if (!edges_) edges_ = grid_edges((grid(), cells_));
    return *edges_;
  }

  void provide(scene::Data& output) override {
    const std::string_view name = output.attribute().name;
    if (name == "position") {
      const PointArray& x = positions();
      output.set(std::vector<double>(x.data(), x.data() + x.size()));
    }
    if (name == "hexahedra") output.set(flattened<8>(hexahedra()));
    if (name == "quads") output.set(flattened<4>(quads()));
    if (name == "edges") output.set(flattened<2>(edges()));
  }

 private:
  // Made when it is first asked for, so that a grid may stand behind the components that use it.
  const HexMesh& grid() {
    if (!grid_) {
      const auto [least, most] = corners();
      if (!(least.array() < most.array()).all()) reject("max", "must be greater than min in every direction");

      const Vec3 count = num_cells(most - least);
      if (count.prod() > kMostCells)
        reject("n", fmt::format("{:.4g} cells, must be at most {:.10g}", count.prod(), kMostCells));
      for (int d = 0; d < 3; ++d) cells_[d] = static_cast<int>(count[d]);
      grid_ = regular_grid(cells_, least, most);
    }
    return *grid_;
  }

  std::pair<Vec3, Vec3> corners() {
    static constexpr const char* kNames[] = {"xmin", "ymin", "zmin", "xmax", "ymax", "zmax"};
    const auto num_given = std::ranges::count_if(kNames, [&](const char* name) { return is_given(name); });
    if (num_given == 0) return {vector3("min"), vector3("max")};
    for (const char* name : kNames)
      if (!is_given(name)) reject(name, "is not given, others of the six are: all are needed");
    return {{real("xmin"), real("ymin"), real("zmin")}, {real("xmax"), real("ymax"), real("zmax")}};
  }

  /// In each direction, as reals: their product may be too large for any whole number.
  Vec3 num_cells(const Vec3& size) {
    const double width = real("cellWidth");
    if (width > 0) return (size / width).array().ceil();

    const std::vector<std::int64_t>& n = integers("n");
    if (n.size() != 3) reject("n", fmt::format("{} numbers given, must be three", n.size()));
    Vec3 cells(static_cast<double>(n[0] - 1), static_cast<double>(n[1] - 1), static_cast<double>(n[2] - 1));
    static constexpr const char* kNames[] = {"nx", "ny", "nz"};
    for (int d = 0; d < 3; ++d)
      if (is_given(kNames[d])) cells[d] = integer(kNames[d]) - 1;
    return cells;
  }

  std::array<int, 3> cells_{};
  std::optional<HexMesh> grid_;
  std::optional<std::vector<Quad>> quads_;
  std::optional<std::vector<Edge>> edges_;
};

/// MeshTopology and HexahedronSetTopologyContainer.
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
       {&attributes::kMeshTopology, &attributes::kHexahedronSetTopologyContainer})
    factory.add(*description, [description] { return std::make_unique<GivenTopology>(*description); });
}

}  // namespace hexaplast::components
