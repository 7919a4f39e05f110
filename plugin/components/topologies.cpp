// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "attributes/shapes.hpp"
#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/cage.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "mesh/copies.hpp"
#include "parts/grids.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

/// A topology that makes its nodes and cells itself, when they are first asked for: it may stand behind the components
/// that use it.
class MadeTopology : public scene::Topology {
 public:
  using Topology::Topology;

  void provide(scene::Data& output) override {
    const std::string_view name = output.attribute().name;
    if (name == "position") output.set_once([this] { return flattened(positions()); });
    if (name == "hexahedra") output.set_once([this] { return flattened<8>(hexahedra()); });
    if (name == "quads") output.set_once([this] { return flattened<4>(quads()); });
    if (name == "edges") output.set_once([this] { return flattened<2>(edges()); });
  }

  const std::vector<Quad>& quads() final { return quads_ ? *quads_ : quads_.emplace(make_quads()); }
  const std::vector<Edge>& edges() final { return edges_ ? *edges_ : edges_.emplace(make_edges()); }

 private:
  // those of the hexahedra, in their order, where a topology has no order of its own
  virtual std::vector<Quad> make_quads() { return faces_of(hexahedra()); }
  virtual std::vector<Edge> make_edges() { return edges_of(hexahedra()); }

  std::optional<std::vector<Quad>> quads_;
  std::optional<std::vector<Edge>> edges_;
};

/// The cells of a grid in each direction, as reals: their product may be too large for any whole number.
Vec3 num_cells(scene::Topology& grid) {
  const std::vector<std::int64_t>& n = grid.integers("n");
  if (n.size() != 3) grid.reject("n", fmt::format("{} numbers given, must be three", n.size()));
  return Vec3(static_cast<double>(n[0] - 1), static_cast<double>(n[1] - 1), static_cast<double>(n[2] - 1));
}

class RegularGridTopology final : public MadeTopology {
 public:
  RegularGridTopology() : MadeTopology(attributes::kRegularGridTopology) {}

  void init() override { mesh(); }

  const PointArray& positions() override { return mesh().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return mesh().hexahedra(); }

 private:
  std::vector<Quad> make_quads() override { return grid_quads((mesh(), cells_)); }
  std::vector<Edge> make_edges() override { return grid_edges((mesh(), cells_)); }

  const HexMesh& mesh() {
    if (mesh_) return *mesh_;
    const Vec3 min = vector3("min"), max = vector3("max"), count = num_cells(*this);
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

  void init() override { taken(); }

  const PointArray& positions() override { return taken().positions_; }
  const std::vector<Hexahedron>& hexahedra() override { return taken().hexahedra_; }
  const std::vector<Quad>& quads() override {
    if (taken().quads_.empty()) quads_ = faces_of(hexahedra_);
    return quads_;
  }
  const std::vector<Triangle>& triangles() override { return taken().triangles_; }
  const std::vector<Edge>& edges() override {
    if (taken().edges_.empty()) edges_ = edges_of(hexahedra_);
    return edges_;
  }

 private:
  // When first asked for: a topology may stand behind the components that use it.
  const GivenTopology& taken() {
    if (is_taken_) return *this;
    positions_ = vectors3("position");
    const int num_nodes =
        positions_.rows() == 0 ? std::numeric_limits<int>::max() : static_cast<int>(positions_.rows());
    hexahedra_ = cells_of<8>(*this, "hexahedra", num_nodes);
    accepted(*this, "hexahedra", [&] { require_own_nodes(hexahedra_); });
    quads_ = cells_of<4>(*this, "quads", num_nodes);
    triangles_ = cells_of<3>(*this, "triangles", num_nodes);
    edges_ = cells_of<2>(*this, "edges", num_nodes);
    is_taken_ = true;
    return *this;
  }

  bool is_taken_ = false;
  PointArray positions_;
  std::vector<Hexahedron> hexahedra_;
  std::vector<Quad> quads_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
};

class SparseGridTopology final : public MadeTopology {
 public:
  SparseGridTopology() : MadeTopology(attributes::kSparseGridTopology) {}

  void init() override {
    if (cage().num_parts > 1)
      remark(scene::Severity::kWarning, {}, fmt::format("has {} parts that share no face", cage().num_parts));
    if (cage().num_hinges > 0)
      remark(scene::Severity::kWarning, {},
             fmt::format("hexahedra meet at {} nodes without sharing a face there: they fold freely about them",
                         cage().num_hinges));
  }

  const PointArray& positions() override { return cage().mesh.positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return cage().mesh.hexahedra(); }
  std::span<const double> fill() override {
    cage();
    return fill_;
  }

 private:
  static constexpr double kTouchedFill = 0.5;  // what SOFA takes for every cell that the surface passes through

  const Cage& cage() {
    if (stage() == Stage::kFailed || is_refused_) throw scene::DependencyFailure();
    if (cage_) return *cage_;
    is_refused_ = true;  // until it is there: whoever asks again has no more to say
    cage_ = made();
    is_refused_ = false;
    return *cage_;
  }

  Cage made() {
    const ImportedMesh surface = loaded();
    Cage cage = cage_around(surface.positions, surface.triangles, surface.quads, given_grid(surface.positions));
    if (boolean("fillWeighted")) {
      fill_.assign(cage.mesh.hexahedra().size(), 1);
      std::fill_n(fill_.begin(), cage.num_touched, kTouchedFill);
    }
    return cage;
  }

  ImportedMesh loaded() {
    const std::string& name = text("fileTopology");
    if (name.empty()) reject("fileTopology", "is not given, must name a mesh file");
    const std::filesystem::path file = node().files().input(name, place());
    try {
      return read_mesh(file);
    } catch (const InputError& error) {
      const bool is_missing = !std::filesystem::exists(file);
      reject("fileTopology", error.what(), is_missing ? node().files().search.places_of(name) : "");
    }
  }

  CageGrid given_grid(ConstPoints surface) {
    CageGrid grid{.min = vector3("min"), .max = vector3("max")};
    if (grid.min.isZero(0) && grid.max.isZero(0)) {
      const Eigen::AlignedBox3d box = box_around(surface);
      grid.min = box.min();
      grid.max = box.max();
    }
    const Vec3 count = num_cells(*this);
    accepted(*this, [&] { parts::check_num_cells("n", count.prod()); });  // of which the surface may meet few
    for (int d = 0; d < 3; ++d) grid.cells[d] = static_cast<int>(count[d]);
    return grid;
  }

  std::vector<double> fill_;
  std::optional<Cage> cage_;
  bool is_refused_ = false;
};

/// A grid that is bent into the shape of an organ.
template <class Options>
class ShapeTopology final : public MadeTopology {
 public:
  using MadeTopology::MadeTopology;

  void init() override { mesh(); }

  const PointArray& positions() override { return mesh().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return mesh().hexahedra(); }

 private:
  const HexMesh& mesh() {
    if (mesh_) return *mesh_;
    return mesh_.emplace(accepted(*this, [&] { return parts::make_grid(read_options<Options>(*this)); }));
  }

  std::optional<HexMesh> mesh_;
};

}  // namespace

void add_topologies(scene::Factory& factory) {
  factory.add<RegularGridTopology>(attributes::kRegularGridTopology);
  factory.add<SparseGridTopology>(attributes::kSparseGridTopology);
  for (const attributes::Description* description :
       {static_cast<const attributes::Description*>(&attributes::kMeshTopology),
        &attributes::kHexahedronSetTopologyContainer, &attributes::kQuadSetTopologyContainer,
        &attributes::kTriangleSetTopologyContainer})
    factory.add(*description, [description] { return std::make_unique<GivenTopology>(*description); });
  const auto add = [&]<class Options>(const attributes::Description& description, const Options&) {
    factory.add(description, [&description] { return std::make_unique<ShapeTopology<Options>>(description); });
  };
  add(attributes::kTubeGridTopology, parts::TubeGridOptions());
  add(attributes::kSheetGridTopology, parts::SheetGridOptions());
  add(attributes::kSpherePatchGridTopology, parts::SpherePatchGridOptions());
}

}  // namespace hexaplast::components
