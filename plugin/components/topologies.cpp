// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "hexaplast/mesh/grid.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

constexpr double kMostCells = 16'777'216;  // some 40 GB of body: refused before anything is allocated

class RegularGridTopology final : public scene::Topology {
 public:
  RegularGridTopology() : Topology(attributes::kRegularGridTopology) {}

  void init() override { grid(); }

  const PointArray& positions() override { return grid().positions(); }
  const std::vector<Hexahedron>& hexahedra() override { return grid().hexahedra(); }

  void provide(scene::Data& output) override {
    if (output.attribute().name == "position") {
      const PointArray& x = positions();
      output.set(std::vector<double>(x.data(), x.data() + x.size()));
    } else {
      std::vector<std::int64_t> corners;
      for (const Hexahedron& hexahedron : hexahedra())
        corners.insert(corners.end(), hexahedron.begin(), hexahedron.end());
      output.set(std::move(corners));
    }
  }

 private:
  // Made when it is first asked for, so that a grid may stand behind the components that use it.
  const HexMesh& grid() {
    if (!grid_) {
      const std::vector<std::int64_t>& n = integers("n");
      if (n.size() != 3) reject("n", fmt::format("{} numbers given, must be three", n.size()));
      const double num_cells =
          static_cast<double>(n[0] - 1) * static_cast<double>(n[1] - 1) * static_cast<double>(n[2] - 1);
      if (num_cells > kMostCells)
        reject("n", fmt::format("{:.4g} cells, must be at most {:.10g}", num_cells, kMostCells));

      const Vec3 least = vector3("min"), most = vector3("max");
      if (!(least.array() < most.array()).all()) reject("max", "must be greater than min in every direction");
      const auto cells = [&](int d) { return static_cast<int>(n[d] - 1); };
      grid_ = regular_grid({cells(0), cells(1), cells(2)}, least, most);
    }
    return *grid_;
  }

  std::optional<HexMesh> grid_;
};

}  // namespace

void add_topologies(scene::Factory& factory) { factory.add<RegularGridTopology>(attributes::kRegularGridTopology); }

}  // namespace hexaplast::components
