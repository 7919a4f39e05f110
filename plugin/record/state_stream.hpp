// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "picture/bodies.hpp"
#include "picture/boundary_conditions.hpp"

namespace hexaplast::output {

/// What a stream can hold of a state.
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
  /// One number per hexahedron; null: three per node.
  std::vector<double> ElementFields::*of_elements = nullptr;
};

inline constexpr std::array<FieldEntry, 10> kFields{{
    {Field::kDisplacement, "displacement", "m", "from the initial position"},
    {Field::kVelocity, "velocity", "m/s", "of the node"},
    {Field::kPlasticDisplacement, "plasticDisplacement", "m",
     "of the plastic rest position (without load, up to a rigid motion) from the initial position"},
    {Field::kLoads, "load", "N",
     "external forces without weight: of the beginning of the step, at the positions of its end"},
    {Field::kContactForce, "contactForce", "N",
     "forces of instruments: of the beginning of the step, at the positions of its end"},
    {Field::kPlasticStrain, "plasticStrain", "1", "accumulated, mean of the corners", &ElementFields::plastic_strain},
    {Field::kStrain, "strain", "1", "largest of the corners", &ElementFields::strain},
    {Field::kStress, "stress", "Pa", "norm that is compared with the yield stress, largest of the corners",
     &ElementFields::stress_norm},
    {Field::kYieldStress, "yieldStress", "Pa", "largest of the corners; infinite if it never yields",
     &ElementFields::yield_stress},
    {Field::kVolumeRatio, "volumeRatio", "1", "volume without load over initial volume", &ElementFields::volume_ratio},
}};

constexpr const FieldEntry& entry_of(Field field) { return kFields[static_cast<std::size_t>(field)]; }

/// The field of a word; none where no field is called so.
std::optional<Field> field_of(std::string_view word);

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// What a stream is to hold of a run.
struct StatePlan {
  std::vector<Field> fields;
  long every = 1;                          ///< steps between two states; the last one is always there
  std::vector<std::string> probes = {};    ///< their names, one per value of a state
  std::vector<std::string> measures = {};  ///< the same of quantities of a body that is stretched by its ends
  NamedTexts attributes = {};              ///< of the run
  NamedTexts overrides = {};               ///< what has been replaced in the scene: PATH.attribute and its value
};

/// A moment of a run.
struct StreamState {
  long step = 0;
  double time = 0;  ///< [s]
  ConstPoints positions, velocities;
  const BoundaryConditions& conditions;
  std::span<const double> probes;
  std::vector<double> measures = {};
};

/// Writes the states of a run for a program in Python, which makes data sets of them (hexaplast_study/states.py):
///
///   one line        "hexaplast states 2 " and JSON: nodes, hexahedra, probes, measures, fields, attributes, overrides
///   positions       n x 3 double [m]; hexahedra: m x 8 int32
///   each state      step int64, time double [s], probes and measures double, fields double (n x 3, or m)
///   where nodes     before a state: -2 int64; k int64, number of new nodes; for each of them the initial one that it
///   have split      is a copy of, int32; hexahedra as above. n is larger by k from here on
///   the end         -1 int64, and JSON to the end of the stream: more attributes
///
/// Nodes keep their numbers: new ones, of whichever body, come behind those before. Numbers are those of the machine. A
/// hexahedron that is gone has NaN. A stream without its end is that of a run that failed. All throw OutputError.
class StateStream {
 public:
  /// descriptor: file or socket, which stays open. The bodies must outlive the stream.
  StateStream(int descriptor, Bodies bodies, StatePlan plan);

  /// Whether the state after a step is one of those to be recorded.
  bool wants(long step) const { return step % plan_.every == 0; }
  void record(const StreamState& state);
  long last_step() const { return last_step_; }  ///< that was recorded; -1: none
  void complete(const NamedTexts& attributes);

 private:
  void write_split();
  PointArray in_order_of_stream(const PointArray& values) const;  // one row per node
  void write(const void* data, std::size_t bytes) const;

  int descriptor_;
  Bodies bodies_;
  StatePlan plan_;
  long last_step_ = -1;
  std::vector<std::vector<int>> node_of_stream_;  // per body and its nodes
  int num_nodes_ = 0;                             // of the stream
};

}  // namespace hexaplast::output
