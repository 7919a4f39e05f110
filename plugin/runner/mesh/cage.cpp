// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/cage.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "runner/mesh/command.hpp"
#include "runner/mesh/file.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

struct MeshCageOptions {
  std::filesystem::path surface;
  int cells = 0;  ///< cubes along the longest side of the surface's box
  std::filesystem::path out;
  bool allow_parts = false;
};

void save_cage(const Cage& cage, const MeshCageOptions& options) {
  const HexMesh& mesh = cage.mesh;
  std::vector<double> enclosed(static_cast<std::size_t>(mesh.num_elements()), 1);
  std::fill_n(enclosed.begin(), cage.num_touched, 0);
  save_mesh(options.out,
            {.points = coordinates_of(mesh.positions()),
             .hexahedra = mesh.hexahedra(),
             .cell_fields = {{.name = "enclosed", .values = enclosed}}},
            InputFiles({options.surface}));
}

void print_summary(const MeshCageOptions& options, const Cage& cage, const CageGrid& grid) {
  fmt::print("{}: cage of cubes of {:.6g} m\n", printable_line(options.surface.stem().string()),
             (grid.max[0] - grid.min[0]) / grid.cells[0]);
  fmt::print("  nodes               {}\n", cage.mesh.num_nodes());
  fmt::print("  hexahedra           {}  ({} touched by the surface, {} enclosed)\n", cage.mesh.num_elements(),
             cage.num_touched, cage.mesh.num_elements() - cage.num_touched);
  fmt::print("  parts               {}\n", cage.num_parts);
}

/// Writes the coarse hexahedra around a surface as .vtu, with the cell data `enclosed` (1 where the surface does not
/// pass), and prints what they are.
void make_cage(const MeshCageOptions& options) {
  require_vtu(options.out);
  const ImportedMesh surface = load_mesh(options.surface);
  const CageGrid grid = cubes_around(surface.positions, options.cells);
  const Cage cage = cage_around(surface.positions, surface.triangles, surface.quads, grid);
  if (cage.num_parts > 1 && !options.allow_parts)
    throw InputError(fmt::format("the cage has {} parts that share no face: use fewer, larger cells, or --allow-parts",
                                 cage.num_parts));
  if (cage.num_hinges > 0)
    spdlog::warn("warning: hexahedra meet at {} nodes without sharing a face there: they fold freely about them",
                 cage.num_hinges);

  save_cage(cage, options);
  print_summary(options, cage, grid);
}

}  // namespace

void add_mesh_cage(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "cage", "Lay coarse hexahedra around a surface of triangles or quads", make_cage,
                     [](const MeshCageOptions& given) { return given.surface.string(); });
  command.add_option("surface", options.surface, "Mesh file: .obj, .stl, .vtk, .vtu or .msh")
      ->type_name("SURFACE")
      ->required();
  command.add_option("--cells", options.cells, "Number of cubes along the longest side of the surface's box")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000))
      ->required();
  add_out(command, options.out);
  command.add_flag("--allow-parts", options.allow_parts, "Accept a cage with unconnected parts");
}

}  // namespace hexaplast::runner
