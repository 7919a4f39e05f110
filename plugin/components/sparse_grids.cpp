// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/grid_topology.hpp"
#include "components/part.hpp"
#include "geometry/coarsened_cage.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/cage.hpp"
#include "parts/grids.hpp"

namespace hexaplast::components {
namespace {

/// SparseGridTopology and SparseGridRamificationTopology, which keeps branches apart.
class SparseGridTopology : public GridTopology {
 public:
  SparseGridTopology(const attributes::Description& description, SeparateParts separate)
      : GridTopology(description), separate_(separate) {}

  void init() override {
    cage();
    if (num_doubled_ > 0)
      remark(scene::Severity::kNote, {},
             fmt::format("{} hexahedra lie in one place with others, as they belong to separate branches: points that "
                         "are embedded there follow the first of them",
                         num_doubled_));
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
  const Cage& cage() {
    if (stage() == Stage::kFailed || is_refused_) throw scene::DependencyFailure();
    if (cage_) return *cage_;
    is_refused_ = true;  // until it is there: whoever asks again has no more to say
    cage_ = made();
    is_refused_ = false;
    return *cage_;
  }

  virtual Cage made() {
    const ImportedMesh surface = loaded("fileTopology", text("fileTopology"));
    const CageGrid grid = given_grid(surface.positions);
    const int levels = integer("nbVirtualFinerLevels");
    return levels > 0 || looks_at_crossings() ? coarsened(surface, grid, levels) : cage_on(surface, grid);
  }

  Cage cage_on(const ImportedMesh& surface, const CageGrid& grid) {
    Cage cage = cage_around(surface.positions, surface.triangles, surface.quads, grid,
                            boolean("onlyInsideCells") ? CageCells::kEnclosed : CageCells::kTouchedOrEnclosed);
    if (boolean("fillWeighted")) {
      fill_.assign(cage.mesh.hexahedra().size(), 1);
      std::fill_n(fill_.begin(), cage.num_touched, kTouchedFill);
    }
    return cage;
  }

  bool looks_at_crossings() { return separate_ == SeparateParts::kOwnHexahedra && boolean("finestConnectivity"); }

  Cage coarsened(const ImportedMesh& surface, const CageGrid& grid, int levels) {
    require_all_cells();
    if (real("cellWidth") > 0 && levels > 0)
      reject("cellWidth", "is not possible with nbVirtualFinerLevels: n is needed");
    CoarsenedCage cage = coarsened_cage(surface.positions, surface.triangles, surface.quads, grid, levels, separate_,
                                        boolean("fillWeighted") ? kTouchedFill : 1,
                                        looks_at_crossings() ? CellsMeet::kWhereCrossed : CellsMeet::kAtFaces);
    return taken(std::move(cage));
  }

 protected:
  void require_all_cells() {
    if (boolean("onlyInsideCells"))
      reject("onlyInsideCells", "is not possible with nbVirtualFinerLevels or finestConnectivity");
  }

  Cage taken(CoarsenedCage cage) {
    fill_ = std::move(cage.fill);
    num_doubled_ = cage.num_doubled;
    return {.mesh = std::move(cage.mesh), .cells = {}, .num_parts = 1};
  }

  /// The surface that an attribute names.
  ImportedMesh loaded(std::string_view attribute, const std::string& name) {
    if (name.empty()) reject(attribute, "is not given, must name a mesh file");
    const std::filesystem::path file = node().files().input(name, place());
    try {
      return read_mesh(file);
    } catch (const InputError& error) {
      const bool is_missing = !std::filesystem::exists(file);
      reject(attribute, error.what(), is_missing ? node().files().search.places_of(name) : "");
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

 private:
  static constexpr double kTouchedFill = 0.5;  // what SOFA takes for every cell that the surface passes through

  SeparateParts separate_;
  std::optional<Cage> cage_;
  int num_doubled_ = 0;
  bool is_refused_ = false;
};

/// SparseGridMultipleTopology: several surfaces in one grid, each with its stiffness.
class SparseGridMultipleTopology final : public SparseGridTopology {
 public:
  SparseGridMultipleTopology()
      : SparseGridTopology(attributes::kSparseGridMultipleTopology, SeparateParts::kOwnHexahedra) {}

  std::span<const double> mass_fill() override {
    fill();
    return mass_fill_;
  }

 private:
  /// What the surfaces make of the cells of a grid, x fastest. In single precision, as SOFA.
  struct Blend {
    std::vector<CageCell> cells;
    std::vector<float> stiffness, mass;
  };

  Cage made() override {
    const std::vector<ImportedMesh> surfaces = surfaces_given();
    PointArray points(0, 3);
    for (const ImportedMesh& surface : surfaces) {
      points.conservativeResize(points.rows() + surface.positions.rows(), 3);
      points.bottomRows(surface.positions.rows()) = surface.positions;
    }
    if (real("cellWidth") > 0) reject("cellWidth", "is not possible with several surfaces: n is needed");
    const CageGrid grid = given_grid(points);
    const int levels = integer("nbVirtualFinerLevels");
    const CageGrid fine_grid = finer(grid, levels);
    const Blend blend = blended(surfaces, fine_grid);
    Cage fine = cage_of(blend.cells, fine_grid,
                        boolean("onlyInsideCells") ? CageCells::kEnclosed : CageCells::kTouchedOrEnclosed);
    std::vector<double> stiffness, mass;
    for (const std::size_t cell : fine.cells) {
      stiffness.push_back(blend.stiffness[cell]);
      mass.push_back(blend.mass[cell]);
    }

    const bool is_crossed = boolean("finestConnectivity") && (levels > 0 || boolean("computeRamifications"));
    if (levels == 0 && !is_crossed) {
      fill_ = std::move(stiffness);
      mass_fill_ = std::move(mass);
      return fine;
    }
    require_all_cells();
    std::optional<ImportedMesh> crossing;
    std::optional<CageCrossings> edges;
    if (is_crossed) {
      crossing = loaded("fileTopology", text("fileTopology"));
      edges.emplace(CageCrossings{crossing->positions, crossing->triangles, crossing->quads});
    }
    const auto made_coarse = [&](const std::vector<double>& fill) {
      return coarsened_cage(fine, fine_grid, fill, levels, SeparateParts::kOwnHexahedra, edges);
    };
    mass_fill_ = made_coarse(mass).fill;
    return taken(made_coarse(stiffness));
  }

  std::vector<ImportedMesh> surfaces_given() {
    std::vector<ImportedMesh> surfaces;
    std::istringstream names(text("fileTopologies"));
    for (std::string name; names >> name;) surfaces.push_back(loaded("fileTopologies", name));
    if (surfaces.empty()) reject("fileTopologies", "is not given, must name mesh files");
    return surfaces;
  }

  std::vector<double> coefficients(std::string_view attribute, std::size_t count) {
    const std::vector<double>& given = reals(attribute);
    if (given.empty()) return std::vector<double>(count, 1);
    if (given.size() != count)
      reject(attribute, fmt::format("{} numbers for {} files, must be one for each", given.size(), count));
    return given;
  }

  Blend blended(const std::vector<ImportedMesh>& surfaces, const CageGrid& grid) {
    const std::vector<double> stiffness = coefficients("stiffnessCoefs", surfaces.size()),
                              mass = coefficients("massCoefs", surfaces.size());
    const bool is_weighted = boolean("fillWeighted"), erases = boolean("erasePreviousCoef");
    Blend blend;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const std::vector<CageCell> met =
          cells_around(surfaces[i].positions, surfaces[i].triangles, surfaces[i].quads, grid);
      blend.cells.resize(met.size(), CageCell::kOutside);
      blend.stiffness.resize(met.size());
      blend.mass.resize(met.size());
      for (std::size_t w = 0; w < met.size(); ++w) {
        if (met[w] == CageCell::kOutside) continue;
        const bool is_full = met[w] == CageCell::kEnclosed || !is_weighted;
        if (is_full || blend.cells[w] == CageCell::kOutside)
          blend.cells[w] = is_full ? CageCell::kEnclosed : CageCell::kTouched;
        const auto mix = [&](float& before, double now) {
          before = is_full || erases ? static_cast<float>(now) : (before + static_cast<float>(now)) / 2;
        };
        mix(blend.stiffness[w], stiffness[i]);
        mix(blend.mass[w], mass[i]);
      }
    }
    return blend;
  }

  std::vector<double> mass_fill_;
};

}  // namespace

void add_sparse_grids(scene::Factory& factory) {
  for (const auto& [description, separate] :
       {std::pair(&attributes::kSparseGridTopology, SeparateParts::kShareHexahedron),
        std::pair(&attributes::kSparseGridRamificationTopology, SeparateParts::kOwnHexahedra)})
    factory.add(*description, [description = description, separate = separate] {
      return std::make_unique<SparseGridTopology>(*description, separate);
    });
  factory.add<SparseGridMultipleTopology>(attributes::kSparseGridMultipleTopology);
}

}  // namespace hexaplast::components
