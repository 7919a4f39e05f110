// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/geometry/offset.hpp"
#include "hexaplast/geometry/shapes.hpp"
#include "runner/exit_code.hpp"
#include "runner/mesh/command.hpp"
#include "runner/mesh/file.hpp"
#include "runner/mesh/info.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

// Lengths in m.
struct ShapeOptions {
  std::array<int, 3> cells{};
  std::filesystem::path out;
};
struct MeshGridOptions : ShapeOptions {
  std::array<double, 3> size{};
  std::array<double, 3> origin{};  ///< the lower corner
};
struct MeshSheetOptions : ShapeOptions {
  std::array<double, 2> size{};
  double thickness = 0;
  double curvature = 0;  ///< [1/m]
};
struct MeshTubeOptions : ShapeOptions {  ///< outward, around, along
  double inner = 0, outer = 0;
  std::optional<double> length;
  double bend = 0;                             ///< [deg]
  std::optional<std::filesystem::path> along;  ///< its vertices are points of the centreline
};
struct MeshSpherePatchOptions : ShapeOptions {
  double inner = 0, outer = 0;
  double angle = 90;  ///< [deg]
};
struct MeshOffsetOptions {
  std::filesystem::path surface;
  double thickness = 0;  ///< [m]
  int layers = 1;
  std::string direction = "outward";  ///< inward, outward, or both: half to either side
  std::filesystem::path out;
};

constexpr int kMaxAlong = 1'000'000;      // hexahedra along one direction
constexpr double kMaxCells = 16'777'216;  // as in scenes: refused before anything is allocated
constexpr double kDegree = std::numbers::pi / 180;

void require_feasible(double num_cells) {
  if (num_cells > kMaxCells)
    throw InputError(fmt::format("{:.4g} hexahedra, must be at most {:.10g}", num_cells, kMaxCells));
}

void save(const std::filesystem::path& out, const HexMesh& mesh, const InputFiles& inputs) {
  save_mesh(out, {.points = coordinates_of(mesh.positions()), .hexahedra = mesh.hexahedra()}, inputs);
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

// Each writes hexahedra (.vtu) and prints what they are.

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

/// Defines a subcommand that makes hexahedra along three directions.
template <class Options>
std::pair<CLI::App&, Options&> add_shape(CLI::App& mesh, Call& call, const char* name, const char* help,
                                         const char* directions, void (*make)(const Options&)) {
  const auto defined = add_subcommand(mesh, call, name, help, make,
                                      [name](const Options&) { return fmt::format("hexaplast mesh {}", name); });
  defined.first.add_option("--cells", defined.second.cells, fmt::format("Number of hexahedra {}", directions))
      ->type_name("N N N")
      ->check(CLI::Range(1, kMaxAlong))
      ->required();
  add_out(defined.first, defined.second.out);
  return defined;
}

/// A length that makes sense; CLI11's own check names the largest number there is.
std::string refuse_length(const std::string& word) {
  double length = 0;
  const bool is_length = CLI::detail::lexical_cast(word, length) && length > 0 && std::isfinite(length);
  return is_length ? "" : fmt::format("{}: must be a finite number greater than 0", word);
}

CLI::Option* add_length(CLI::App& command, const char* name, double& length, const char* help) {
  return command.add_option(name, length, help)->type_name("M")->check(refuse_length)->required();
}

}  // namespace

void add_mesh_grid(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_shape(mesh, call, "grid", "Make a box of hexahedra", "along x, y and z", make_grid);
  command.add_option("--size", options.size, "Lengths along x, y and z [m]")
      ->type_name("M M M")
      ->check(refuse_length)
      ->required();
  command.add_option("--origin", options.origin, "Its lower corner [m]")->type_name("M M M")->capture_default_str();
}

void add_mesh_sheet(CLI::App& mesh, Call& call) {
  const auto [command, options] = add_shape(mesh, call, "sheet", "Make a sheet, flat or bent, about the origin",
                                            "along x, along y and across", make_sheet);
  command.add_option("--size", options.size, "Lengths along x and y, of the middle [m]")
      ->type_name("M M")
      ->check(refuse_length)
      ->required();
  add_length(command, "--thickness", options.thickness, "Thickness [m]");
  command.add_option("--curvature", options.curvature, "One over the radius about y [1/m]; negative: ends upwards")
      ->type_name("K")
      ->capture_default_str();
}

void add_mesh_tube(CLI::App& mesh, Call& call) {
  const auto [command, options] = add_shape(mesh, call, "tube", "Make a tube along z, along an arc or along a curve",
                                            "outward, around and along", make_tube);
  add_length(command, "--inner", options.inner, "Inner radius [m]");
  add_length(command, "--outer", options.outer, "Outer radius [m]");
  CLI::Option* length = command.add_option("--length", options.length, "Length of a tube from the origin along z [m]")
                            ->type_name("M")
                            ->check(refuse_length);
  command.add_option("--bend", options.bend, "Angle by which it is bent towards x on its way [deg]")
      ->type_name("DEG")
      ->check(CLI::Range(-359.0, 359.0))
      ->needs(length);
  command
      .add_option("--along", options.along,
                  "Mesh file (.obj, ...) whose vertices, in their order, are points of a smooth centreline")
      ->type_name("FILE")
      ->excludes(length);
}

void add_mesh_sphere_patch(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_shape(mesh, call, "sphere-patch", "Make a square patch of a spherical shell about the origin",
                "along x, along y and outward", make_sphere_patch);
  add_length(command, "--inner", options.inner, "Inner radius [m]");
  add_length(command, "--outer", options.outer, "Outer radius [m]");
  command.add_option("--angle", options.angle, "Angle from side to side, seen from the centre [deg]")
      ->type_name("DEG")
      ->check(CLI::Range(1e-3, 179.0))
      ->capture_default_str();
}

void add_mesh_offset(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "offset", "Grow a shell of hexahedra from a surface of quads", make_shell,
                     [](const MeshOffsetOptions& given) { return given.surface.string(); });
  command.add_option("surface", options.surface, "Mesh file: .obj, .vtk, .vtu or .msh, with quads alone")
      ->type_name("SURFACE")
      ->required();
  add_length(command, "--thickness", options.thickness, "Thickness, measured normal to the quads [m]");
  command.add_option("--layers", options.layers, "Number of hexahedra across it")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxAlong))
      ->capture_default_str();
  command
      .add_option("--direction", options.direction,
                  "outward: on the side from which the quads run counter-clockwise; both: half to either side")
      ->type_name("inward|outward|both")
      ->check(CLI::IsMember({"inward", "outward", "both"}))
      ->capture_default_str();
  add_out(command, options.out);
}

}  // namespace hexaplast::runner
