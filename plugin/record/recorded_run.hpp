// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/embedded_surface.hpp"
#include "picture/quantity.hpp"

namespace hexaplast {
struct ImportedState;
}

namespace hexaplast::output {

/// A run that was written before, as its .pvd and .vtu files hold it.
class RecordedRun {
 public:
  struct Entry {
    double time = 0;  ///< [s]
    std::filesystem::path file;
    std::optional<long> step;  ///< by the number that the file's name ends with
  };

  struct State {
    PointArray positions;                   ///< [m] num_nodes x 3
    PointArray plastic_rest;                ///< [m] the same of the rest shape
    std::vector<double> values;             ///< of a quantity, one per hexahedron or per node
    std::vector<unsigned char> alive;       ///< one per hexahedron, 0 for those that are removed
    BoundaryConditions conditions;          ///< as far as the files hold them
    std::shared_ptr<const OpenFaces> open;  ///< faces between hexahedra of the mesh; null: none, or not in the files
  };

  /// place: the directory of a run, or its .pvd file. Throws OutputError where there is none, InputError where it names
  /// no state, or where it or the first state cannot be understood.
  explicit RecordedRun(const std::filesystem::path& place);

  const std::filesystem::path& directory() const { return directory_; }  ///< that of the .pvd file
  const std::string& name() const { return name_; }                      ///< of the directory
  const std::vector<Entry>& entries() const { return entries_; }         ///< in the order of the file, at least one

  /// The hexahedra of the first state in their initial shape, with the nodes of the state that was read last.
  const HexMesh& mesh() const { return *mesh_; }

  const Regions& regions() const { return regions_; }

  /// The surfaces that it carries, where surface.pvd beside the .pvd file names some. Throws OutputError or InputError
  /// as above.
  std::vector<EmbeddedSurface> embedded_surfaces() const;

  /// Reads a state, with the instruments and springs where instruments.pvd and springs.pvd name a file of the same
  /// time. Throws InputError for a file that is missing or damaged, lacks an array that is needed, or belongs to
  /// another mesh: then `mesh` stays as it was.
  State state(const Entry& entry, Quantity quantity);

 private:
  std::size_t index_of(const std::filesystem::path& file, int id) const;  // of a hexahedron, in mesh_
  [[noreturn]] void refuse_hexahedron(const std::filesystem::path& file, int id) const;

  struct Present;
  Present present_in(const std::filesystem::path& file, const ImportedState& state, const std::vector<int>& ids,
                     const std::vector<int>& initial) const;
  std::vector<int> first_nodes(const std::filesystem::path& file, const std::vector<int>& initial) const;

  std::filesystem::path directory_;
  std::string name_;
  std::vector<Entry> entries_;
  std::vector<Entry> instruments_, springs_;  // of the same times; empty: there are none
  std::optional<HexMesh> first_, mesh_;       // of the first state, and of the one that was read last
  Regions regions_;
  std::vector<int> initial_node_;      // per node of first_
  std::vector<int> id_of_hexahedron_;  // in the mesh that the run began with, ascending
};

}  // namespace hexaplast::output
