// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "geometry/placement.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/offset.hpp"
#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::components {
namespace {

class ExtrudeQuadsAndGenerateHexas final : public scene::Engine {
 public:
  ExtrudeQuadsAndGenerateHexas() : Engine(attributes::kExtrudeQuadsAndGenerateHexas) {}

  void init() override { integers("extrudedHexas"); }  // so that mistakes are found, whoever uses the outputs

 private:
  void compute(std::string_view) override {
    PointArray vertices = vectors3("surfaceVertices");
    hexaplast::place(vertices, vector3("scale"), Vec3::Zero(), Vec3::Zero());
    std::vector<Quad> quads = cells_of<4>(*this, "surfaceQuads", static_cast<int>(vertices.rows()));
    const ShellThickness thickness{real("thicknessIn"), real("thicknessOut"), integer("numberOfSlices")};
    try {
      const QuadSurface surface(std::move(vertices), std::move(quads));
      const Shell shell = offset(surface, thickness);
      found("extrudedVertices", flattened(shell.mesh.positions()));
      found("extrudedSurfaceQuads", flattened<4>(quads_of_layer(surface, thickness.layers, 0)));
      found("extrudedQuads", flattened<4>(faces_of(shell.mesh.hexahedra())));
      found("extrudedHexas", flattened<8>(shell.mesh.hexahedra()));
    } catch (const InputError& error) {
      reject("surfaceQuads", error.what());
    }
  }
};

}  // namespace

void add_extrusion(scene::Factory& factory) {
  factory.add<ExtrudeQuadsAndGenerateHexas>(attributes::kExtrudeQuadsAndGenerateHexas);
}

}  // namespace hexaplast::components
