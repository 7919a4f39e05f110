// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/cage.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/geometry/offset.hpp"
#include "parts/grids.hpp"
#include "record/vtu.hpp"
#include "runner/command.hpp"
#include "runner/mesh/mesh.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/scene_file.hpp"
#include "runner/subcommand.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::runner {
namespace {

struct MeshExportOptions {
  SceneOptions scene;
  std::filesystem::path out;
};

/// Writes the bodies of a scene, as they are before the first step, for other programs.
void export_mesh(const MeshExportOptions& options) {
  require_vtu(options.out);
  scene::Scene scene = load_scene(options.scene);
  const std::filesystem::path out = output_place(options.out, scene.root().files().inputs);
  std::vector<output::Bodies::Entry> entries = view::entries_of(scene::bodies_of(scene));
  if (entries.empty())
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene: there is nothing to export"));
  const output::Bodies bodies(std::move(entries));
  const std::vector<scene::MechanicalState*> states = scene::shown_states(scene);
  PointArray x, v;
  const PointArray& positions = scene::positions_of(states, x);
  output::write_vtu(out, bodies, positions, scene::velocities_of(states, v), bodies.fields(positions));
}

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

struct BoxOptions {
  std::vector<int> cells;
  std::array<double, 3> size{}, origin{};  ///< [m]; origin: the lower corner
};

/// A shape, and the file for its hexahedra.
template <class Shape>
struct ShapeOptions {
  Shape shape;
  std::filesystem::path out;
};
struct MeshTubeOptions : ShapeOptions<parts::TubeGridOptions> {
  std::optional<double> length;
  std::optional<std::filesystem::path> along;  ///< its vertices are points of the centreline
};
struct MeshOffsetOptions {
  std::filesystem::path surface;
  double thickness = 0;  ///< [m]
  int layers = 1;
  std::string direction = "outward";  ///< inward, outward, or both: half to either side
  std::filesystem::path out;
};

void save(const std::filesystem::path& out, const HexMesh& mesh, const InputFiles& inputs) {
  save_mesh(out, {.points = coordinates_of(mesh.positions()), .hexahedra = mesh.hexahedra()}, inputs);
}

HexMesh make_grid(const BoxOptions& box) {
  const Vec3 min(box.origin.data()), size(box.size.data());
  parts::check_num_hexahedra("cells", static_cast<double>(box.cells[0]) * box.cells[1] * box.cells[2]);
  return regular_grid({box.cells[0], box.cells[1], box.cells[2]}, min, min + size);
}

/// Makes hexahedra, writes them and prints what they are.
template <class Shape>
void write_shape(const Shape& shape, const std::filesystem::path& out, const InputFiles& inputs = {}) {
  require_vtu(out);
  try {
    const HexMesh mesh = make_grid(shape);
    save(out, mesh, inputs);
    fmt::print("{}\n  nodes               {}\n", printable_line(out.stem().string()), mesh.num_nodes());
    print_hexahedra(mesh);
  } catch (const parts::OptionError& error) {  // of all that is wrong, the first
    throw InputError(fmt::format("{}: {}", error.reasons().front().attribute, error.reasons().front().text));
  }
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

template <class Shape>
void make_shape(const ShapeOptions<Shape>& options) {
  write_shape(options.shape, options.out);
}

void make_tube(const MeshTubeOptions& options) {
  if (options.length.has_value() == options.along.has_value())
    throw UsageError("mesh tube: either --length or --along must be given");
  parts::TubeGridOptions shape = options.shape;
  if (options.length) shape.length = *options.length;
  if (options.along) shape.centreline = load_mesh(*options.along).positions;
  write_shape(shape, options.out, options.along ? InputFiles({*options.along}) : InputFiles());
}

void make_shell(const MeshOffsetOptions& options) {
  require_vtu(options.out);
  const QuadSurface surface = load_surface(options.surface);
  parts::check_num_hexahedra("layers", static_cast<double>(surface.num_quads()) * options.layers);
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
  add_option(defined.first, "--cells", defined.second.shape.cells, "N",
             fmt::format("Number of hexahedra {}", directions))
      ->expected(3)
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

void add_radii(CLI::App& command, double& inner, double& outer) {
  add_option(command, "--inner", inner, "M", "Inner radius [m]")->required();
  add_option(command, "--outer", outer, "M", "Outer radius [m]")->required();
}

}  // namespace

void add_mesh_export(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "export", "Write the scene's bodies for other programs", export_mesh,
                     [](const MeshExportOptions& given) { return given.scene.file.string(); });
  add_scene(command, options.scene);
  add_out(command, options.out);
}

void add_mesh_cage(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "cage", "Lay coarse hexahedra around a surface of triangles or quads", make_cage,
                     [](const MeshCageOptions& given) { return given.surface.string(); });
  add_option(command, "surface", options.surface, "SURFACE", "Mesh file: .obj, .stl, .vtk, .vtu or .msh")->required();
  add_option(command, "--cells", options.cells, "N", "Number of cubes along the longest side of the surface's box")
      ->check(CLI::Range(1, 1'000'000))
      ->required();
  add_out(command, options.out);
  command.add_flag("--allow-parts", options.allow_parts, "Accept a cage with unconnected parts");
}

void add_mesh_grid(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_shape(mesh, call, "grid", "Make a box of hexahedra", "along x, y and z", make_shape<BoxOptions>);
  add_option(command, "--size", options.shape.size, "M M M", "Lengths along x, y and z [m]")
      ->check(refuse_length)
      ->required();
  add_option(command, "--origin", options.shape.origin, "M M M", "Its lower corner [m]")->capture_default_str();
}

void add_mesh_sheet(CLI::App& mesh, Call& call) {
  const auto [command, options] = add_shape(mesh, call, "sheet", "Make a sheet, flat or bent, about the origin",
                                            "along x, along y and across", make_shape<parts::SheetGridOptions>);
  add_option(command, "--size", options.shape.size, "M", "Lengths along x and y, of the middle [m]")
      ->expected(2)
      ->required();
  add_option(command, "--thickness", options.shape.thickness, "M", "Thickness [m]")->required();
  add_option(command, "--curvature", options.shape.curvature, "K",
             "One over the radius about y [1/m]; negative: ends upwards")
      ->capture_default_str();
}

void add_mesh_tube(CLI::App& mesh, Call& call) {
  const auto [command, options] = add_shape(mesh, call, "tube", "Make a tube along z, along an arc or along a curve",
                                            "outward, around and along", make_tube);
  add_radii(command, options.shape.inner_radius, options.shape.outer_radius);
  CLI::Option* length =
      add_option(command, "--length", options.length, "M", "Length of a tube from the origin along z [m]");
  add_option(command, "--bend", options.shape.bend, "DEG", "Angle by which it is bent towards x on its way [deg]")
      ->needs(length);
  add_option(command, "--along", options.along, "FILE",
             "Mesh file (.obj, ...) whose vertices, in their order, are points of a smooth centreline")
      ->excludes(length);
}

void add_mesh_sphere_patch(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_shape(mesh, call, "sphere-patch", "Make a square patch of a spherical shell about the origin",
                "along x, along y and outward", make_shape<parts::SpherePatchGridOptions>);
  add_radii(command, options.shape.inner_radius, options.shape.outer_radius);
  add_option(command, "--angle", options.shape.angle, "DEG", "Angle from side to side, seen from the centre [deg]")
      ->capture_default_str();
}

void add_mesh_offset(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "offset", "Grow a shell of hexahedra from a surface of quads", make_shell,
                     [](const MeshOffsetOptions& given) { return given.surface.string(); });
  add_option(command, "surface", options.surface, "SURFACE", "Mesh file: .obj, .vtk, .vtu or .msh, with quads alone")
      ->required();
  add_option(command, "--thickness", options.thickness, "M", "Thickness, measured normal to the quads [m]")
      ->check(refuse_length)
      ->required();
  add_option(command, "--layers", options.layers, "N", "Number of hexahedra across it")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  add_choice(command, "--direction", options.direction, {"inward", "outward", "both"},
             "outward: on the side from which the quads run counter-clockwise; both: half to either side");
  add_out(command, options.out);
}

}  // namespace hexaplast::runner
