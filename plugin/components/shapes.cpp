// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/shapes.hpp"

#include <optional>

#include "components/components.hpp"
#include "components/made_topology.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/grids.hpp"

namespace hexaplast::components {
namespace {

class ShapeTopology : public MadeTopology {
 public:
  using MadeTopology::MadeTopology;

  void init() override { mesh(); }

  const PointArray& positions() override { return mesh().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return mesh().hexahedra(); }

 protected:
  virtual HexMesh make() = 0;

  std::vector<int> cells() {
    const std::vector<std::int64_t>& given = integers("cells");
    return {given.begin(), given.end()};
  }

 private:
  const HexMesh& mesh() {
    if (mesh_) return *mesh_;
    try {
      mesh_ = accepted(*this, [&] { return make(); });
    } catch (const InputError& error) {
      reject(error.what());
    }
    return *mesh_;
  }

  std::optional<HexMesh> mesh_;
};

class TubeGridTopology final : public ShapeTopology {
 public:
  TubeGridTopology() : ShapeTopology(attributes::kTubeGridTopology) {}

 private:
  HexMesh make() override {
    parts::TubeGridOptions options{.cells = cells(),
                                   .inner_radius = real("innerRadius"),
                                   .outer_radius = real("outerRadius"),
                                   .length = real("length"),
                                   .bend = real("bend")};
    if (is_given("centreline")) options.centreline = vectors3("centreline");
    return make_grid(options);
  }
};

class SheetGridTopology final : public ShapeTopology {
 public:
  SheetGridTopology() : ShapeTopology(attributes::kSheetGridTopology) {}

 private:
  HexMesh make() override {
    return make_grid(parts::SheetGridOptions{
        .cells = cells(), .size = reals("size"), .thickness = real("thickness"), .curvature = real("curvature")});
  }
};

class SpherePatchGridTopology final : public ShapeTopology {
 public:
  SpherePatchGridTopology() : ShapeTopology(attributes::kSpherePatchGridTopology) {}

 private:
  HexMesh make() override {
    return make_grid(parts::SpherePatchGridOptions{.cells = cells(),
                                                   .inner_radius = real("innerRadius"),
                                                   .outer_radius = real("outerRadius"),
                                                   .angle = real("angle")});
  }
};

}  // namespace

void add_shapes(scene::Factory& factory) {
  factory.add<TubeGridTopology>(attributes::kTubeGridTopology);
  factory.add<SheetGridTopology>(attributes::kSheetGridTopology);
  factory.add<SpherePatchGridTopology>(attributes::kSpherePatchGridTopology);
}

}  // namespace hexaplast::components
