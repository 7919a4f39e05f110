// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/recorded_run.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/file_import.hpp"
#include "output/files.hpp"

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
  std::error_code error;
  if (!fs::is_regular_file(pvd, error))
    throw OutputError(
        fmt::format("{}: is not there, or no file: must be the directory of a run, or its .pvd file", pvd.string()));
  const auto refuse = [&](int line, const std::string& what) {
    throw InputError(fmt::format("{}:{}: {}", pvd.string(), line, what));
  };
  tinyxml2::XMLDocument document;
  if (document.LoadFile(pvd.c_str()) != tinyxml2::XML_SUCCESS)
    refuse(document.ErrorLineNum(), fmt::format("not well-formed XML ({})", document.ErrorName()));
  const tinyxml2::XMLElement* root = document.RootElement();
  const tinyxml2::XMLElement* collection = root ? root->FirstChildElement("Collection") : nullptr;
  if (!collection) refuse(1, "must be a VTKFile with a Collection");

  std::vector<RecordedRun::Entry> entries;
  for (const auto* at = collection->FirstChildElement("DataSet"); at; at = at->NextSiblingElement("DataSet")) {
    const char* file = at->Attribute("file");
    const char* time = at->Attribute("timestep");
    RecordedRun::Entry entry;
    if (!file) refuse(at->GetLineNum(), "DataSet names no file");
    if (!time) refuse(at->GetLineNum(), "DataSet has no timestep");
    const std::string_view text(time);
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), entry.time);
    if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(entry.time))
      refuse(at->GetLineNum(), fmt::format("DataSet.timestep '{}', must be a finite number", text));
    entry.file = pvd.parent_path() / file;
    entry.step = number_at_end(entry.file.stem().string());
    entries.push_back(std::move(entry));
  }
  if (entries.empty()) throw InputError(fmt::format("{}: names no state", pvd.string()));
  return entries;
}

/// An array that a picture needs, as one row per point or cell.
Eigen::Map<const Eigen::MatrixXd> rows_of(const fs::path& file, const char* kind,
                                          const std::vector<ImportedArray>& arrays, std::string_view name,
                                          int num_components, Eigen::Index count) {
  const auto found = std::ranges::find(arrays, name, &ImportedArray::name);
  if (found == arrays.end()) {
    std::string others;
    for (const ImportedArray& other : arrays) others += (others.empty() ? "" : ", ") + other.name;
    throw InputError(fmt::format("{}: holds no array '{}' of {}; it holds: {}", file.string(), name, kind,
                                 others.empty() ? "none" : others));
  }
  if (found->num_components != num_components ||
      static_cast<Eigen::Index>(found->values.size()) != num_components * count)
    throw InputError(fmt::format("{}: array '{}' has {} components for {} {}, must have {} for {}", file.string(), name,
                                 found->num_components, found->values.size() / found->num_components, kind,
                                 num_components, count));
  return {found->values.data(), num_components, count};  // column-major: transposed
}

PointArray vectors(const fs::path& file, const ImportedState& state, std::string_view name) {
  return rows_of(file, "points", state.point_data, name, 3, state.mesh.positions.rows()).transpose();
}

std::vector<double> scalars(const fs::path& file, const ImportedState& state, std::string_view name) {
  const auto values =
      rows_of(file, "cells", state.cell_data, name, 1, static_cast<Eigen::Index>(state.mesh.hexahedra.size()));
  return {values.data(), values.data() + values.size()};
}

ImportedState read(const fs::path& file) {
  ImportedState state = read_vtu_state(file);
  const ImportedMesh& mesh = state.mesh;
  if (mesh.num_skipped > 0 || !mesh.edges.empty() || !mesh.triangles.empty() || !mesh.quads.empty())
    throw InputError(
        fmt::format("{}: holds cells that are no hexahedra: pictures are made of hexahedra alone", file.string()));
  return state;
}

/// Numbers of the hexahedra in the mesh that the run began with.
std::vector<int> ids_of(const fs::path& file, const ImportedState& state) {
  const std::vector<double> values = scalars(file, state, "id");
  std::vector<int> ids(values.begin(), values.end());
  if (!std::ranges::is_sorted(ids, std::less_equal()))
    throw InputError(fmt::format("{}: array 'id' must ascend", file.string()));
  return ids;
}

}  // namespace

RecordedRun::RecordedRun(const fs::path& place) {
  std::error_code error;
  const fs::path pvd = fs::is_directory(place, error) ? place / "mesh.pvd" : place;
  entries_ = entries_of(pvd);
  name_ = fs::weakly_canonical(fs::absolute(pvd)).parent_path().filename().string();

  const fs::path& first = entries_.front().file;
  ImportedState state = read(first);
  id_of_hexahedron_ = ids_of(first, state);
  const PointArray original = state.mesh.positions - vectors(first, state, "displacement");
  try {
    mesh_.emplace(original, std::move(state.mesh.hexahedra));
  } catch (const InputError& reason) {
    throw InputError(fmt::format("{}: {}", first.string(), reason.what()));
  }
}

RecordedRun::State RecordedRun::state(const Entry& entry, Quantity quantity) const {
  const ImportedState read_state = read(entry.file);
  const Eigen::Index num_nodes = read_state.mesh.positions.rows();
  if (num_nodes != mesh_->num_nodes())
    throw InputError(fmt::format("{}: has {} points, must have {} as {} has", entry.file.string(), num_nodes,
                                 mesh_->num_nodes(), entries_.front().file.string()));

  State state;
  state.positions = read_state.mesh.positions;
  state.material = vectors(entry.file, read_state, "material_position");

  const QuantityEntry& wanted = entry_of(quantity);
  if (wanted.of_nodes) {
    state.values = speeds(vectors(entry.file, read_state, wanted.array));
  } else {
    state.values.assign(mesh_->num_elements(), 0);
  }
  const std::vector<double> of_cells =
      wanted.of_nodes ? std::vector<double>() : scalars(entry.file, read_state, wanted.array);

  state.alive.assign(mesh_->num_elements(), 0);
  const std::vector<int> ids = ids_of(entry.file, read_state);
  for (std::size_t cell = 0; cell < ids.size(); ++cell) {
    const auto found = std::ranges::lower_bound(id_of_hexahedron_, ids[cell]);
    const auto e = static_cast<std::size_t>(found - id_of_hexahedron_.begin());
    if (found == id_of_hexahedron_.end() || *found != ids[cell] ||
        read_state.mesh.hexahedra[cell] != mesh_->hexahedra()[e])
      throw InputError(fmt::format("{}: hexahedron {} is not that of {}", entry.file.string(), ids[cell],
                                   entries_.front().file.string()));
    state.alive[e] = 1;
    if (!wanted.of_nodes) state.values[e] = of_cells[cell];
  }
  return state;
}

}  // namespace hexaplast::output
