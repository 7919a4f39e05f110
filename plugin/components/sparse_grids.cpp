// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/grid_topology.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/cage.hpp"
#include "parts/grids.hpp"

namespace hexaplast::components {
namespace {

class SparseGridTopology final : public GridTopology {
 public:
  SparseGridTopology() : GridTopology(attributes::kSparseGridTopology) {}

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
    Cage cage = cage_around(surface.positions, surface.triangles, surface.quads, given_grid(surface.positions),
                            boolean("onlyInsideCells") ? CageCells::kEnclosed : CageCells::kTouchedOrEnclosed);
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
    const Vec3 count = num_cells(grid.max - grid.min);
    accepted(*this, [&] { parts::check_num_cells("n", count.prod()); });  // of which the surface may meet few
    for (int d = 0; d < 3; ++d) grid.cells[d] = static_cast<int>(count[d]);
    return grid;
  }

  std::vector<double> fill_;
  std::optional<Cage> cage_;
  bool is_refused_ = false;
};

}  // namespace

void add_sparse_grids(scene::Factory& factory) { factory.add<SparseGridTopology>(attributes::kSparseGridTopology); }

}  // namespace hexaplast::components
