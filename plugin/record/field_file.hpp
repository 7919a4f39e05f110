// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "picture/bodies.hpp"
#include "picture/boundary_conditions.hpp"

namespace hexaplast::output {

/// What a data set can hold of a state.
enum class Field {
  kDisplacement,
  kVelocity,
  kPlasticDisplacement,
  kLoads,
  kContactForce,
  kPlasticStrain,
  kStrain,
  kStress,
  kYieldStress,
  kVolumeRatio,
};

struct FieldEntry {
  Field field;
  std::string_view word;  ///< on the command line, and the name of the data set
  std::string_view unit;
  std::string_view help;
  bool of_nodes;  ///< three numbers per node, else one per hexahedron
};

inline constexpr std::array<FieldEntry, 10> kFields{{
    {Field::kDisplacement, "displacement", "m", "from the initial position", true},
    {Field::kVelocity, "velocity", "m/s", "of the node", true},
    {Field::kPlasticDisplacement, "plasticDisplacement", "m",
     "of the plastic rest position (without load, up to a rigid motion) from the initial position", true},
    {Field::kLoads, "load", "N",
     "external forces without weight: of the beginning of the step, at the positions of its end", true},
    {Field::kContactForce, "contactForce", "N",
     "forces of instruments: of the beginning of the step, at the positions of its end", true},
    {Field::kPlasticStrain, "plasticStrain", "1", "accumulated, mean of the corners", false},
    {Field::kStrain, "strain", "1", "largest of the corners", false},
    {Field::kStress, "stress", "Pa", "norm that is compared with the yield stress, largest of the corners", false},
    {Field::kYieldStress, "yieldStress", "Pa", "largest of the corners; infinite if it never yields", false},
    {Field::kVolumeRatio, "volumeRatio", "1", "volume without load over initial volume", false},
}};

constexpr const FieldEntry& entry_of(Field field) { return kFields[static_cast<std::size_t>(field)]; }

/// The field of a word; none where no field is called so.
std::optional<Field> field_of(std::string_view word);

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// What a data set of a run is to hold.
struct FieldPlan {
  std::vector<Field> fields;
  long every = 1;                        ///< steps between two states; the last one is always there
  std::vector<std::string> probes = {};  ///< their names, one per value of a state
  NamedTexts attributes = {};            ///< of the file
  NamedTexts overrides = {};             ///< what has been replaced in the scene: PATH.attribute and its value
};

/// A moment of a run.
struct FieldState {
  long step = 0;
  double time = 0;  ///< [s]
  ConstPoints positions, velocities;
  const BoundaryConditions& conditions;
  std::span<const double> probes;
};

/// An HDF5 file with states of a run, for programs that learn from many runs. It is there whole or not at all
/// (WholeFile), and equal runs write equal bytes.
///
///   /positions        n x 3      [m] initial positions of the nodes
///   /hexahedra        m x 8      nodes of each hexahedron
///   /step, /time      T          of each state; time in s
///   /fields/WORD      T x n x 3  or T x m (FieldEntry); compressed. A hexahedron that is gone has no number there
///   /probes/NAME      T          of each Probe
///   /overrides                   attributes alone
///
/// Every data set with a unit has it as attribute `unit`. All throw OutputError.
class FieldFile {
 public:
  virtual ~FieldFile() = default;  ///< without complete(): removes what there is

  /// Whether the state after a step is one of those to be recorded.
  virtual bool wants(long step) const = 0;
  virtual void record(const FieldState& state) = 0;

  virtual long last_step() const = 0;  ///< that was recorded; -1: none

  /// Puts the file in place, with more attributes.
  virtual void complete(const NamedTexts& attributes) = 0;
};

/// Begins a file. The bodies must outlive it.
std::unique_ptr<FieldFile> make_field_file(const std::filesystem::path& file, Bodies bodies, FieldPlan plan);

/// What is known of each run of a study beside its fields, one value per run.
struct StudyColumn {
  std::string name, unit;
  std::vector<double> numbers;     ///< or
  std::vector<std::string> texts;  ///< where there are no numbers
};

/// Writes one HDF5 file over the files of many runs (FieldFile): every data set that has the same shape in all of them
/// stands in it once more, under the same name, with the runs in front of its dimensions. It holds no copy of the data
/// but reads it from the files (a virtual data set), which must stay beside it. A run without a file (an empty path)
/// has fill values: not a number, or -1. Columns are written as they are. Returns the names of data sets whose shapes
/// differ, which are left out.
std::vector<std::string> write_study_file(const std::filesystem::path& file,
                                          std::span<const std::filesystem::path> runs,
                                          std::span<const StudyColumn> columns, const NamedTexts& attributes);

/// What the module with the HDF5 library does. It is loaded when the first such file is written, so that programs that
/// write none stay small.
struct FieldFileModule {
  decltype(&make_field_file) make;
  decltype(&write_study_file) write_study;
};

}  // namespace hexaplast::output
