// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"

namespace hexaplast::output {

/// Reading or writing failed; the message names the file and the system's reason. The runner exits with 5.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a run is, known before its first step.
struct RunPlan {
  std::string title;               ///< shown in pictures and plots: the scene's name
  long num_steps = 0;
  double dt = 0;                   ///< [s]
  int output_every = 25;           ///< steps between two .vtu files; the first and the last state are always written
  int num_frames = 8;              ///< pictures, spread evenly over the run, the last state among them; 0: none
  bool force = false;              ///< write into a directory that holds an earlier run
  std::vector<int> loaded_nodes;   ///< nodes that carry prescribed forces, ascending; may be empty
};

/// One accepted step, or the initial state (step 0).
struct StepRecord {
  long step = 0;
  double time = 0;              ///< [s] at the end of the step
  double kinetic_energy = 0;    ///< [J]
  FlowReport flow;
  int solver_iterations = 0;
  double residual = 0;          ///< relative residual of the linear solve
  double step_ms = 0;           ///< wall time of the step without output
};

/// Writes the directory of a run: history.csv, mesh.pvd with .vtu files, frames/*.png, plot.svg.
/// Every file appears whole under its final name (written beside it first, then renamed), and mesh.pvd names only complete files.
class Recorder {
 public:
  /// Creates the directory. Throws OutputError when it cannot be written, is a file, or holds an earlier run and `force` is not set;
  /// nothing is touched then.
  Recorder(std::filesystem::path directory, const Body& body, RunPlan plan);
  ~Recorder();

  /// positions, velocities: world state after the step. Call once with step 0 before the first step, then once per step.
  void record(const StepRecord& record, ConstPoints positions, ConstPoints velocities);

  /// Completes the files and draws the pictures. Returns warnings (one sentence each), e.g. that no renderer is installed.
  std::vector<std::string> finish();

 private:
  struct Files;
  std::unique_ptr<Files> files_;
};

/// What the summary at the end of a run shows, computed from a body and its world state.
struct Summary {
  double plastic_elongation = 0;      ///< [-] of the material mesh along the longest axis
  double plastic_twist_deg = 0;       ///< of the material mesh about that axis
  double world_elongation = 0;
  double world_twist_deg = 0;
  double material_volume_ratio = 0;   ///< material volume / original volume, whole body
  double world_volume_ratio = 0;
  double worst_element_volume_error = 0;  ///< greatest |material volume / original - 1| of a hexahedron
  double largest_strain = 0;          ///< greatest |D - 1| and the hexahedron and place where it is
  int largest_strain_element = 0;
  Vec3 largest_strain_place = Vec3::Zero();  ///< [m] world centre of that hexahedron
};
Summary summarise(const Body& body, ConstPoints positions);

/// The state hash of decisions: XXH64 over step count, positions, velocities and every History array.
std::string state_hash(long step, ConstPoints positions, ConstPoints velocities, const Body& body);

/// Writes `--final FILE.json`: time, positions, velocities, material_positions (num_nodes x 3), per hexahedron volume_ratio and
/// yield_stress (null where infinite), state_hash; 17 significant digits.
void write_final(const std::filesystem::path& file, long step, double time, ConstPoints positions, ConstPoints velocities,
                 const Body& body);

}  // namespace hexaplast::output
