// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/make.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <numbers>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/geometry/offset.hpp"
#include "hexaplast/geometry/shapes.hpp"
#include "runner/exit_code.hpp"
#include "runner/mesh/file.hpp"
#include "runner/mesh/info.hpp"

namespace hexaplast::runner {
namespace {

constexpr double kMaxCells = 16'777'216;  // as in scenes: refused before anything is allocated
constexpr double kDegree = std::numbers::pi / 180;

void require_feasible(double num_cells) {
  if (num_cells > kMaxCells)
    throw InputError(fmt::format("{:.4g} hexahedra, must be at most {:.10g}", num_cells, kMaxCells));
}

void save(const std::filesystem::path& out, const HexMesh& mesh, const InputFiles& inputs) {
  save_mesh(out,
            {.points = {mesh.positions().data(), static_cast<std::size_t>(mesh.positions().size())},
             .hexahedra = mesh.hexahedra()},
            inputs);
}

/// Makes a mesh of `cells` and writes it.
template <class Make>
void write_shape(const std::filesystem::path& out, const std::array<int, 3>& cells, const Make& make,
                 const InputFiles& inputs = {}) {
  require_vtu(out);
  require_feasible(static_cast<double>(cells[0]) * cells[1] * cells[2]);
  const HexMesh mesh = make();
  save(out, mesh, inputs);
  fmt::print("{}\n  nodes               {}\n", printable_line(out.stem().string()), mesh.num_nodes());
  print_hexahedra(mesh);
}

ShellThickness thickness_of(const MeshOffsetOptions& options) {
  const double T = options.thickness;
  if (options.direction == "inward") return {T, 0, options.layers};
  if (options.direction == "outward") return {0, T, options.layers};
  return {T / 2, T / 2, options.layers};
}

/// The surface of a file. Vertices that no face has are left out, with a warning: editors leave them behind.
QuadSurface load_surface(const std::filesystem::path& file) {
  ImportedMesh mesh = load_mesh(file);
  if (!mesh.hexahedra.empty())
    throw InputError(fmt::format("{} hexahedra, must be a surface of quads", mesh.hexahedra.size()));
  mesh.edges.clear();
  const Eigen::Index count = mesh.positions.rows();
  remove_unused_nodes(mesh);
  if (mesh.positions.rows() < count && !mesh.quads.empty())
    spdlog::warn("{}: warning: {} vertices without a face are left out, and the others numbered without them",
                 file.string(), count - mesh.positions.rows());
  return surface_of(mesh);
}

}  // namespace

void make_grid(const MeshGridOptions& options) {
  const Vec3 min(options.origin.data()), size(options.size.data());
  write_shape(options.out, options.cells, [&] { return regular_grid(options.cells, min, min + size); });
}

void make_sheet(const MeshSheetOptions& options) {
  write_shape(options.out, options.cells,
              [&] { return sheet(options.cells, options.size, options.thickness, options.curvature); });
}

void make_tube(const MeshTubeOptions& options) {
  if (options.length.has_value() == options.along.has_value())
    throw UsageError("mesh tube: either --length or --along must be given");
  const auto make = [&] {
    const int num_points = options.cells[2] + 1;
    const Centreline curve = options.length ? arc(*options.length, options.bend * kDegree, num_points)
                                            : curve_through(load_mesh(*options.along).positions, num_points);
    return tube(options.cells, options.inner, options.outer, curve);
  };
  write_shape(options.out, options.cells, make, options.along ? InputFiles({*options.along}) : InputFiles());
}

void make_sphere_patch(const MeshSpherePatchOptions& options) {
  write_shape(options.out, options.cells,
              [&] { return sphere_patch(options.cells, options.inner, options.outer, options.angle * kDegree); });
}

void make_shell(const MeshOffsetOptions& options) {
  require_vtu(options.out);
  const QuadSurface surface = load_surface(options.surface);
  require_feasible(static_cast<double>(surface.num_quads()) * options.layers);
  const Shell shell = offset(surface, thickness_of(options));

  save(options.out, shell.mesh, InputFiles({options.surface}));
  fmt::print("{}: shell over {} quads of a{} surface\n  nodes               {}\n",
             printable_line(options.out.stem().string()), surface.num_quads(),
             surface.is_closed() ? " closed" : "n open", shell.mesh.num_nodes());
  print_hexahedra(shell.mesh);
  fmt::print("  worst shaped over   quads {}\n", fmt::join(shell.worst_quads, ", "));
}

}  // namespace hexaplast::runner
