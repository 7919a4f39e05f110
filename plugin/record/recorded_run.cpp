// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include "formats/readable_file.hpp"
#include "formats/xml.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "record/files.hpp"
#include "record/instruments_vtu.hpp"
#include "record/springs_vtu.hpp"
#include "record/state_arrays.hpp"
#include "record/surface_vtu.hpp"
#include "record/vtu.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

/// The number at the end of "mesh_000125".
std::optional<long> number_at_end(const std::string& stem) {
  const std::size_t last = stem.find_last_not_of("0123456789");
  const char* from = stem.data() + (last == stem.npos ? 0 : last + 1);
  long number = 0;
  const auto [end, error] = std::from_chars(from, stem.data() + stem.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

std::vector<RecordedRun::Entry> entries_of(const fs::path& pvd) {
  std::error_code unknown;
  if (!fs::is_regular_file(pvd, unknown))
    throw OutputError(
        fmt::format("{}: is not there, or no file: must be the directory of a run, or its .pvd file", pvd.string()));
  const auto refuse = [&](int line, const std::string& what) {
    throw InputError(fmt::format("{}:{}: {}", pvd.string(), line, what));
  };
  const std::string text = whole_file(pvd);
  XmlDocument document;
  try {
    document = parse_xml(text);
  } catch (const XmlError& error) {
    refuse(error.line(), error.what());
  }
  const XmlElement* collection = document.root.child("Collection");
  if (!collection) refuse(1, "must be a VTKFile with a Collection");

  // all of it is looked at before any of it is kept
  std::vector<double> times;
  for (const XmlElement& at : collection->children) {
    const std::string_view number = at.attribute("timestep");
    if (at.attribute("file").empty()) refuse(at.line, "DataSet names no file");
    const auto [end, status] = std::from_chars(number.data(), number.data() + number.size(), times.emplace_back());
    if (status != std::errc() || end != number.data() + number.size() || !std::isfinite(times.back()))
      refuse(at.line, fmt::format("DataSet.timestep '{}', must be a finite number", number));
  }
  std::vector<RecordedRun::Entry> entries(times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    entries[k].time = times[k];
    entries[k].file = pvd.parent_path() / collection->children[k].attribute("file");
    entries[k].step = number_at_end(entries[k].file.stem().string());
  }
  if (entries.empty()) throw InputError(fmt::format("{}: names no state", pvd.string()));
  return entries;
}

ImportedState read(const fs::path& file) {
  ImportedState state = read_vtu_state(file);
  const ImportedMesh& mesh = state.mesh;
  if (!mesh.skipped.empty() || !mesh.edges.empty() || !mesh.triangles.empty() || !mesh.quads.empty())
    throw InputError(
        fmt::format("{}: holds cells that are no hexahedra: pictures are made of hexahedra alone", file.string()));
  return state;
}

/// Numbers of the hexahedra in the mesh that the run began with.
std::vector<int> ids_of(const fs::path& file, const ImportedState& state) {
  const std::vector<double> values = cell_scalars(file, state, "id");
  std::vector<int> ids(values.begin(), values.end());
  if (!std::ranges::is_sorted(ids, std::less_equal()))
    throw InputError(fmt::format("{}: array 'id' must ascend", file.string()));
  return ids;
}

/// Of each node, the one of the initial mesh that it is a copy of.
std::vector<int> initial_nodes_in(const fs::path& file, const ImportedState& state) {
  if (has_point_data(state, "initial_node")) return point_numbers(file, state, "initial_node");
  std::vector<int> own(static_cast<std::size_t>(state.mesh.positions.rows()));
  std::iota(own.begin(), own.end(), 0);
  return own;
}

/// What holds and loads the body, as far as the file holds it: earlier versions did not write it.
BoundaryConditions conditions_in(const fs::path& file, const ImportedState& state) {
  BoundaryConditions conditions;
  if (has_point_data(state, "fixed"))
    for (const int is_fixed : point_numbers(file, state, "fixed")) conditions.fixed.push_back(is_fixed != 0);
  if (has_point_data(state, "load")) conditions.loads = point_vectors(file, state, "load");
  if (!conditions.loads.allFinite())
    throw InputError(fmt::format("{}: array 'load' must hold finite numbers", file.string()));
  return conditions;
}

}  // namespace

RecordedRun::RecordedRun(const fs::path& place) {
  std::error_code error;
  const fs::path pvd = fs::is_directory(place, error) ? place / "mesh.pvd" : place;
  entries_ = entries_of(pvd);
  directory_ = pvd.parent_path();
  name_ = fs::weakly_canonical(fs::absolute(pvd)).parent_path().filename().string();
  if (const fs::path instruments = directory_ / "instruments.pvd"; fs::exists(instruments, error))
    instruments_ = entries_of(instruments);
  if (const fs::path springs = directory_ / "springs.pvd"; fs::exists(springs, error)) springs_ = entries_of(springs);

  const fs::path& first = entries_.front().file;
  ImportedState state = read(first);
  id_of_hexahedron_ = ids_of(first, state);
  for (const std::string& name : state.field_names)
    if (name.starts_with(kRegionPrefix)) regions_.names.push_back(name.substr(kRegionPrefix.size()));
  if (!regions_.names.empty()) {
    const std::vector<double> numbers = cell_scalars(first, state, entry_of(Quantity::kRegion).array);
    for (const double number : numbers) {
      if (!(number >= 0 && number <= static_cast<double>(regions_.names.size())))
        throw InputError(fmt::format("{}: array '{}' holds {}, must lie in [0, {}]", first.string(),
                                     entry_of(Quantity::kRegion).array, number, regions_.names.size()));
      regions_.of_hexahedra.push_back(static_cast<int>(number));
    }
  }
  std::vector<Hexahedron> hexahedra = std::move(state.mesh.hexahedra);
  initial_node_ = initial_nodes_in(first, state);
  // states that cannot be read are refused when they are asked for
  ImportedState end;
  const auto can_read = [&](std::size_t k) {
    try {
      end = read(entries_[k].file);
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  std::size_t last_entry = entries_.size() - 1;
  while (last_entry > 0 && !can_read(last_entry)) --last_entry;
  const fs::path& last = entries_[last_entry].file;
  has_split_ = end.mesh.positions.rows() > state.mesh.positions.rows();
  if (has_split_) {
    initial_node_ = initial_nodes_in(last, end);
    std::vector<unsigned char> is_known(hexahedra.size(), 0);  // by the last state that has it
    const auto take = [&](const fs::path& file, const ImportedState& from) {
      const std::vector<int> ids = ids_of(file, from);
      for (std::size_t cell = 0; cell < ids.size(); ++cell)
        if (const std::size_t e = index_of(file, ids[cell]); !std::exchange(is_known[e], 1))
          hexahedra[e] = from.mesh.hexahedra[cell];
    };
    take(last, end);
    state = std::move(end);
    for (std::size_t k = last_entry; k-- > 1 && std::ranges::find(is_known, 0) != is_known.end();)
      if (can_read(k)) take(entries_[k].file, end);
  }
  const fs::path& of_nodes = has_split_ ? last : first;
  try {
    mesh_.emplace(state.mesh.positions - point_vectors(of_nodes, state, "displacement"), std::move(hexahedra));
  } catch (const InputError& reason) {
    throw InputError(fmt::format("{}: {}", of_nodes.string(), reason.what()));
  }
}

std::size_t RecordedRun::index_of(const fs::path& file, int id) const {
  const auto found = std::ranges::lower_bound(id_of_hexahedron_, id);
  if (found == id_of_hexahedron_.end() || *found != id) refuse_hexahedron(file, id);
  return static_cast<std::size_t>(found - id_of_hexahedron_.begin());
}

void RecordedRun::refuse_hexahedron(const fs::path& file, int id) const {
  throw InputError(
      fmt::format("{}: hexahedron {} is not that of {}", file.string(), id, entries_.front().file.string()));
}

std::vector<int> RecordedRun::rows_of_nodes(const fs::path& file, const ImportedState& state,
                                            const std::vector<int>& ids) const {
  const std::vector<int> initial = initial_nodes_in(file, state);
  std::vector<int> rows(initial_node_.size(), -1);
  for (std::size_t cell = 0; cell < ids.size(); ++cell)
    for (int a = 0; a < kCorners; ++a) {
      const auto node = static_cast<std::size_t>(mesh_->hexahedra()[index_of(file, ids[cell])][a]);
      const int here = state.mesh.hexahedra[cell][a];
      if (initial[static_cast<std::size_t>(here)] != initial_node_[node] || (rows[node] >= 0 && rows[node] != here))
        refuse_hexahedron(file, ids[cell]);
      rows[node] = here;
    }
  for (std::size_t n = 0; n < rows.size(); ++n) {  // without hexahedron
    if (rows[n] >= 0) continue;
    const auto found = std::ranges::find(initial, initial_node_[n]);
    if (found == initial.end())
      throw InputError(fmt::format("{}: has no node {} of the initial mesh", file.string(), initial_node_[n]));
    rows[n] = static_cast<int>(found - initial.begin());
  }
  return rows;
}

std::shared_ptr<const OpenFaces> RecordedRun::open_in(const fs::path& file, const ImportedState& state,
                                                      const std::vector<int>& ids, const std::vector<int>& rows) const {
  if (!has_cell_data(state, kCrossing)) return nullptr;
  const std::vector<double> crossing = cell_numbers(file, state, kCrossing, 6);
  if (!std::ranges::all_of(crossing, [](double place) { return (place >= 0 && place <= 1) || place == -1; }))
    throw InputError(fmt::format("{}: array '{}' must hold numbers in [0, 1], or -1", file.string(), kCrossing));
  const auto open = std::make_shared<OpenFaces>();
  open->initial_node = initial_node_;
  open->copy = rows;
  std::array<double, 6> closed;
  closed.fill(-1);
  open->crossing.assign(static_cast<std::size_t>(mesh_->num_elements()), closed);
  for (std::size_t cell = 0; cell < ids.size(); ++cell)
    std::copy_n(crossing.begin() + static_cast<std::ptrdiff_t>(6 * cell), 6,
                open->crossing[index_of(file, ids[cell])].begin());
  return open;
}

std::vector<EmbeddedSurface> RecordedRun::embedded_surfaces() const {
  std::error_code error;
  const fs::path surfaces = directory_ / "surface.pvd";
  if (!fs::exists(surfaces, error)) return {};
  return read_embedded_surfaces(entries_of(surfaces).front().file);
}

RecordedRun::State RecordedRun::state(const Entry& entry, Quantity quantity) const {
  const ImportedState read_state = read(entry.file);
  const auto num_nodes = static_cast<int>(read_state.mesh.positions.rows());
  if (num_nodes > mesh_->num_nodes() || (num_nodes < mesh_->num_nodes() && !has_split_))
    throw InputError(fmt::format("{}: has {} points, must have {} as {} has", entry.file.string(), num_nodes,
                                 mesh_->num_nodes(), entries_.front().file.string()));
  const std::vector<int> ids = ids_of(entry.file, read_state);
  const std::vector<int> rows = rows_of_nodes(entry.file, read_state, ids);

  State state;
  state.positions = read_state.mesh.positions(rows, Eigen::all);
  state.plastic_rest = point_vectors(entry.file, read_state, "plastic_rest_position")(rows, Eigen::all);

  const QuantityEntry& wanted = entry_of(quantity);
  if (wanted.of_nodes) {
    state.values = speeds(point_vectors(entry.file, read_state, wanted.array)(rows, Eigen::all));
  } else {
    state.values.assign(mesh_->num_elements(), 0);
  }
  const std::vector<double> of_cells =
      wanted.of_nodes ? std::vector<double>() : cell_scalars(entry.file, read_state, wanted.array);

  state.alive.assign(mesh_->num_elements(), 0);
  for (std::size_t cell = 0; cell < ids.size(); ++cell) {
    const std::size_t e = index_of(entry.file, ids[cell]);
    state.alive[e] = 1;
    if (!wanted.of_nodes) state.values[e] = of_cells[cell];
  }
  state.open = open_in(entry.file, read_state, ids, rows);
  state.conditions = conditions_in(entry.file, read_state);
  BoundaryConditions& conditions = state.conditions;
  if (const std::vector<unsigned char> fixed = std::exchange(conditions.fixed, {}); !fixed.empty())
    for (const int row : rows) conditions.fixed.push_back(fixed[static_cast<std::size_t>(row)]);
  if (conditions.loads.rows() > 0) conditions.loads = PointArray(conditions.loads(rows, Eigen::all));
  if (const auto tied = std::ranges::find(springs_, entry.time, &Entry::time); tied != springs_.end())
    state.conditions.springs = read_springs(tied->file);
  const auto held = std::ranges::find(instruments_, entry.time, &Entry::time);
  if (held == instruments_.end()) return state;
  state.conditions.instruments = read_instruments(held->file);
  for (const Instrument& instrument : state.conditions.instruments)
    for (const int node : instrument.nodes)
      if (node >= num_nodes)
        throw InputError(fmt::format("{}: node {}, must lie in [0, {})", held->file.string(), node, num_nodes));
  return state;
}

}  // namespace hexaplast::output
