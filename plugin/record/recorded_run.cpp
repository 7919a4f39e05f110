// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "formats/readable_file.hpp"
#include "formats/xml.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "record/conditions_vtu.hpp"
#include "record/files.hpp"
#include "record/state_arrays.hpp"
#include "record/surface_vtu.hpp"
#include "record/vtu.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

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
    entries[k].step = number_at_end(entries[k].file);
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
  if (has_point_data(state, kInitialNode)) return point_numbers(file, state, kInitialNode);
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
  initial_node_ = initial_nodes_in(first, state);
  try {
    first_.emplace(state.mesh.positions - point_vectors(first, state, "displacement"), std::move(state.mesh.hexahedra));
  } catch (const InputError& reason) {
    throw InputError(fmt::format("{}: {}", first.string(), reason.what()));
  }
  mesh_ = first_;
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

/// What a state says of the hexahedra that the run began with.
struct RecordedRun::Present {
  std::vector<Hexahedron> corners;
  std::vector<std::array<double, 6>> crossing;  // of their faces; -1: closed
  std::vector<unsigned char> alive;
};

RecordedRun::Present RecordedRun::present_in(const fs::path& file, const ImportedState& state,
                                             const std::vector<int>& ids, const std::vector<int>& initial) const {
  std::array<double, 6> closed;
  closed.fill(-1);
  const auto num_elements = static_cast<std::size_t>(first_->num_elements());
  Present present{first_->hexahedra(), std::vector(num_elements, closed), std::vector<unsigned char>(num_elements, 0)};
  const auto place = [&](std::size_t e, const Hexahedron& corners, std::span<const double> crossing) {
    for (int a = 0; a < kCorners; ++a)
      if (initial[static_cast<std::size_t>(corners[a])] !=
          initial_node_[static_cast<std::size_t>(first_->hexahedra()[e][a])])
        refuse_hexahedron(file, id_of_hexahedron_[e]);
    present.corners[e] = corners;
    if (!std::ranges::all_of(crossing, [](double at) { return (at >= 0 && at <= 1) || at == -1; }))
      throw InputError(fmt::format("{}: array '{}' must hold numbers in [0, 1], or -1", file.string(), kCrossing));
    std::ranges::copy(crossing, present.crossing[e].begin());
  };
  const bool has_crossings = has_cell_data(state, kCrossing);
  const std::vector<double> crossing = has_crossings ? cell_numbers(file, state, kCrossing, 6) : std::vector<double>();
  for (std::size_t cell = 0; cell < ids.size(); ++cell) {
    const std::size_t e = index_of(file, ids[cell]);
    present.alive[e] = 1;
    place(e, state.mesh.hexahedra[cell],
          has_crossings ? std::span(crossing).subspan(6 * cell, 6) : std::span<const double>());
  }
  const std::vector<double> removed = field_numbers(file, state, kRemoved, kNumbersOfRemoved);
  for (std::size_t at = 0; at < removed.size(); at += kNumbersOfRemoved) {
    const std::span<const double> row = std::span(removed).subspan(at, kNumbersOfRemoved);
    const auto found = std::ranges::find(id_of_hexahedron_, row[0]);
    if (found == id_of_hexahedron_.end()) continue;  // it had gone before the first state
    Hexahedron corners;
    for (int a = 0; a < kCorners; ++a) {
      if (!(row[1 + a] >= 0 && row[1 + a] < static_cast<double>(initial.size())))
        throw InputError(fmt::format("{}: array '{}' names point {}, must lie in [0, {})", file.string(), kRemoved,
                                     row[1 + a], initial.size()));
      corners[a] = static_cast<int>(row[1 + a]);
    }
    place(static_cast<std::size_t>(found - id_of_hexahedron_.begin()), corners, row.subspan(1 + kCorners));
  }
  return present;
}

/// For each node of a state, the one of the first state that it is a copy of.
std::vector<int> RecordedRun::first_nodes(const fs::path& file, const std::vector<int>& initial) const {
  std::map<int, int> row_of;
  for (std::size_t n = 0; n < initial_node_.size(); ++n) row_of.try_emplace(initial_node_[n], static_cast<int>(n));
  std::vector<int> rows;
  for (const int node : initial) {
    const auto found = row_of.find(node);
    if (found == row_of.end())
      throw InputError(fmt::format("{}: node {} is not in {}", file.string(), node, entries_.front().file.string()));
    rows.push_back(found->second);
  }
  return rows;
}

std::vector<EmbeddedSurface> RecordedRun::embedded_surfaces() const {
  std::error_code error;
  const fs::path surfaces = directory_ / "surface.pvd";
  if (!fs::exists(surfaces, error)) return {};
  return read_embedded_surfaces(entries_of(surfaces).front().file);
}

RecordedRun::State RecordedRun::state(const Entry& entry, Quantity quantity) {
  const fs::path& file = entry.file;
  const ImportedState read_state = read(file);
  const auto num_nodes = static_cast<int>(read_state.mesh.positions.rows());
  const bool is_split = has_point_data(read_state, kInitialNode);
  if (is_split ? num_nodes < first_->num_nodes() : num_nodes != first_->num_nodes())
    throw InputError(fmt::format("{}: has {} points, must have {} as {} has", file.string(), num_nodes,
                                 first_->num_nodes(), entries_.front().file.string()));
  const std::vector<int> ids = ids_of(file, read_state), initial = initial_nodes_in(file, read_state);
  Present present = present_in(file, read_state, ids, initial);

  State state;
  state.positions = read_state.mesh.positions;
  state.plastic_rest = point_vectors(file, read_state, "plastic_rest_position");

  const QuantityEntry& wanted = entry_of(quantity);
  if (wanted.of_nodes) {
    state.values = speeds(point_vectors(file, read_state, wanted.array));
  } else {
    state.values.assign(present.alive.size(), 0);
    const std::vector<double> of_cells = cell_scalars(file, read_state, wanted.array);
    for (std::size_t cell = 0; cell < ids.size(); ++cell) state.values[index_of(file, ids[cell])] = of_cells[cell];
  }
  state.alive = std::move(present.alive);
  if (has_cell_data(read_state, kCrossing)) {
    std::vector<int> own(initial.size());
    std::iota(own.begin(), own.end(), 0);
    state.open = std::make_shared<OpenFaces>(OpenFaces{initial, std::move(own), std::move(present.crossing)});
  }
  state.conditions = conditions_in(file, read_state);
  if (const auto tied = std::ranges::find(springs_, entry.time, &Entry::time); tied != springs_.end())
    state.conditions.springs = read_springs(tied->file);
  const auto held = std::ranges::find(instruments_, entry.time, &Entry::time);
  if (held != instruments_.end()) state.conditions.instruments = read_instruments(held->file);
  for (const Instrument& instrument : state.conditions.instruments)
    for (const int node : instrument.nodes)
      if (node >= num_nodes)
        throw InputError(fmt::format("{}: node {}, must lie in [0, {})", held->file.string(), node, num_nodes));
  if (present.corners != mesh_->hexahedra()) *mesh_ = {*first_, first_nodes(file, initial), std::move(present.corners)};
  return state;
}

}  // namespace hexaplast::output
