// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/shapes.hpp"

#include <memory>
#include <optional>

#include "components/components.hpp"
#include "components/made_topology.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/grids.hpp"

namespace hexaplast::components {
namespace {

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
    try {
      mesh_ = accepted(*this, [&] { return parts::make_grid(read_options<Options>(*this)); });
    } catch (const InputError& error) {
      reject(error.what());
    }
    return *mesh_;
  }

  std::optional<HexMesh> mesh_;
};

}  // namespace

void add_shapes(scene::Factory& factory) {
  const auto add = [&]<class Options>(const attributes::Description& description, const Options&) {
    factory.add(description, [&description] { return std::make_unique<ShapeTopology<Options>>(description); });
  };
  add(attributes::kTubeGridTopology, parts::TubeGridOptions());
  add(attributes::kSheetGridTopology, parts::SheetGridOptions());
  add(attributes::kSpherePatchGridTopology, parts::SpherePatchGridOptions());
}

}  // namespace hexaplast::components
