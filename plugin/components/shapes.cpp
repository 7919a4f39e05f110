// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/shapes.hpp"

#include <fmt/format.h>

#include <numbers>
#include <optional>

#include "attributes/shapes.hpp"
#include "components/components.hpp"
#include "components/made_topology.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::components {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

class ShapeTopology : public MadeTopology {
 public:
  using MadeTopology::MadeTopology;

  void init() override { mesh(); }

  const PointArray& positions() override { return mesh().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return mesh().hexahedra(); }
  const std::vector<Quad>& quads() override {
    if (!quads_) quads_ = faces_of(hexahedra());
    return *quads_;
  }
  const std::vector<Edge>& edges() override {
    if (!edges_) edges_ = edges_of(hexahedra());
    return *edges_;
  }

 protected:
  virtual HexMesh make(const std::array<int, 3>& cells) = 0;

 private:
  const HexMesh& mesh() {
    if (mesh_) return *mesh_;
    const std::vector<std::int64_t>& given = integers("cells");
    if (given.size() != 3) reject("cells", fmt::format("{} numbers given, must be three", given.size()));
    const double count = static_cast<double>(given[0]) * static_cast<double>(given[1]) * static_cast<double>(given[2]);
    require_feasible("cells", count);
    try {
      mesh_ = make({static_cast<int>(given[0]), static_cast<int>(given[1]), static_cast<int>(given[2])});
    } catch (const InputError& error) {
      reject(error.what());
    }
    return *mesh_;
  }

  std::optional<HexMesh> mesh_;
  std::optional<std::vector<Quad>> quads_;
  std::optional<std::vector<Edge>> edges_;
};

class TubeGridTopology final : public ShapeTopology {
 public:
  TubeGridTopology() : ShapeTopology(attributes::kTubeGridTopology) {}

 private:
  HexMesh make(const std::array<int, 3>& cells) override {
    const int num_points = cells[2] + 1;
    const Centreline curve = is_given("centreline") ? curve_through(vectors3("centreline"), num_points)
                                                    : arc(real("length"), real("bend") * kDegree, num_points);
    return tube(cells, real("innerRadius"), real("outerRadius"), curve);
  }
};

class SheetGridTopology final : public ShapeTopology {
 public:
  SheetGridTopology() : ShapeTopology(attributes::kSheetGridTopology) {}

 private:
  HexMesh make(const std::array<int, 3>& cells) override {
    const std::vector<double>& size = reals("size");
    if (size.size() != 2) reject("size", fmt::format("{} numbers given, must be two", size.size()));
    return sheet(cells, {size[0], size[1]}, real("thickness"), real("curvature"));
  }
};

class SpherePatchGridTopology final : public ShapeTopology {
 public:
  SpherePatchGridTopology() : ShapeTopology(attributes::kSpherePatchGridTopology) {}

 private:
  HexMesh make(const std::array<int, 3>& cells) override {
    return sphere_patch(cells, real("innerRadius"), real("outerRadius"), real("angle") * kDegree);
  }
};

}  // namespace

void add_shapes(scene::Factory& factory) {
  factory.add<TubeGridTopology>(attributes::kTubeGridTopology);
  factory.add<SheetGridTopology>(attributes::kSheetGridTopology);
  factory.add<SpherePatchGridTopology>(attributes::kSpherePatchGridTopology);
}

}  // namespace hexaplast::components
