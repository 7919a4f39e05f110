// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/solve/energy_balance.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/gallery.hpp"
#include "picture/renderer.hpp"
#include "record/files.hpp"
#include "record/measures.hpp"

namespace hexaplast::output {

/// What a run is, known before its first step.
struct RunPlan {
  std::string title;  ///< shown in pictures
  long num_steps = 0;
  double dt = 0;                    ///< [s]
  bool has_energy_balance = false;  ///< every StepRecord has one
  bool has_ends = true;             ///< elongation and twist between the end sections mean something
  bool has_plastic_ends = true;     ///< those of the shape without load are columns of history.csv
  bool has_contact = false;         ///< beside it every StepRecord has what instruments that touch do
  bool has_openings = false;        ///< joints of bodies may open
  int output_every = 25;            ///< steps between two .vtu files; the first and the last state are always written
  bool has_viewer = true;           ///< viewer.json is written, for the report
  int num_frames = 8;               ///< pictures, spread evenly over the run, the last state among them; 0: none
  bool force = false;               ///< write into a directory that holds an earlier run
  InputFiles inputs = {};           ///< files that are read, and so never replaced
  std::vector<int> loaded_nodes = {};    ///< nodes that carry prescribed forces, ascending; may be empty
  bool has_instruments = false;          ///< something in the scene may take hold of the body
  bool has_springs = false;              ///< something in the scene is seen as springs
  Staging staging = {};                  ///< of the pictures
  std::vector<std::string> probes = {};  ///< their names, one per StepRecord::probes
  std::filesystem::path video = {};      ///< film of the run in real time, at most 25 pictures a second; empty: none
};

/// One accepted step, or the initial state (step 0).
struct StepRecord {
  long step = 0;
  double time = 0;            ///< [s] at the end of the step
  double kinetic_energy = 0;  ///< [J]
  std::optional<EnergyBalance> energy = {};
  double instrument_work = 0, contact_energy = 0, friction_loss = 0;  ///< [J] of all instruments that touch
  FlowReport flow = {};
  int solver_iterations = 0;
  double residual = 0;  ///< relative residual of the linear solve
  double step_ms = 0;   ///< wall time of the step without output
  std::vector<double> probes = {};
};

/// Writes the directory of a run: history.csv, removed.csv, mesh.pvd with mesh_<step>.vtu, frames/frame_<step>.png;
/// viewer.json where the plan wants it (viewer_states.hpp); where the staging has embedded surfaces, surface.pvd with
/// surface_<step>.vtu, and where the plan says that there are instruments, instruments.pvd with instruments_<step>.vtu,
/// or springs, springs.pvd with springs_<step>.vtu, for the same steps. history.csv (docs/output.md; the columns of the
/// energy balance, of elongation and of twist only where the run has them) grows by a whole row per step, removed.csv
/// by a row `step,time,hexahedron` per hexahedron that a body has lost in it, in the order of their removal (of several
/// bodies `step,time,hexahedron,body`, with the hexahedron's own number in its body), and where joints may open,
/// opened.csv by a row `step,time,hexahedra` per joint that has, with the hexahedra that it held; every other file
/// appears whole under its final name, and each .pvd file names only complete files. After an OutputError everything
/// that mesh.pvd names can still be read.
class Recorder {
 public:
  /// Prepares the directory (prepare_directory). Throws OutputError when it cannot be written, is a file, or holds an
  /// earlier run and `force` is not set; nothing is touched then. Throws what Gallery throws. The bodies must outlive
  /// the recorder.
  Recorder(
      std::filesystem::path directory, Bodies bodies, RunPlan plan,
      RendererSource renderer = [] { return load_renderer(); });

  /// Goes on with the files of a run where save() left them, whatever was written later: a run that is interrupted and
  /// resumed writes the same as one that is not, but for the wall times and for the pictures, which show what is
  /// still to come. plan.force does not matter. Throws InputError when the files are not those of the checkpoint,
  /// before anything is changed.
  Recorder(
      std::filesystem::path directory, Bodies bodies, RunPlan plan, Archive& saved,
      RendererSource renderer = [] { return load_renderer(); });
  ~Recorder();

  /// Files of states that the run had written and that were gone when it was resumed: the .pvd files no longer name
  /// them.
  const std::vector<std::string>& lost_states() const;

  /// After record(): what the files hold, flushed to disk, into a checkpoint.
  void save(Archive& archive);

  /// positions, velocities: current state after the step, the body being as that step left it; conditions: what held
  /// and loaded it in the step. Call once with step 0 before the first step, then once per step. Throws OutputError.
  void record(const StepRecord& record, ConstPoints positions, ConstPoints velocities,
              BoundaryConditions conditions = {});

  /// Completes the files and draws the pictures; call once, also after a run that ended early. Returns warnings (one
  /// sentence each), e.g. that no renderer is installed. Throws OutputError, also where a film was wanted and there is
  /// no renderer.
  std::vector<std::string> finish();

 private:
  struct Files;
  std::unique_ptr<Files> files_;
};

/// The largest value of the hexahedra that are left, and where it is.
struct Largest {
  double value = 0;
  int hexahedron = -1;        ///< the first one with that value; -1: none is left
  Vec3 place = Vec3::Zero();  ///< [m] its current centre
};

/// What the summary at the end of a run shows, computed from bodies and their current state.
struct Summary : Measures {
  double worst_element_volume_error = 0;  ///< largest |plastic volume / initial - 1| of a hexahedron that is left
  Largest strain = {};                    ///< [-] largest |D - 1| of a corner
  Largest plastic_strain = {};            ///< [-] mean over the corners of the accumulated plastic strain
  int num_pieces = 0;                     ///< connected parts of what is left
};
Summary summarise(const Bodies& bodies, ConstPoints positions);

/// XXH64, as 16 hexadecimal digits, over step count (64 bits), positions, velocities and every History array of the
/// body; null: there is none.
std::string state_hash(long step, ConstPoints positions, ConstPoints velocities, const Body* body);
std::string state_hash(long step, ConstPoints positions, ConstPoints velocities, std::span<const Bodies::Entry> bodies);

/// The column of history.csv that a probe has: its name, after "probe_" unless it begins so. No other column does.
std::string probe_column(std::string_view probe);

/// Looks whether the files of a run are those of a checkpoint, without changing them; `saved` is what save() left.
/// Throws InputError and OutputError.
void require_saved_files(const std::filesystem::path& directory, Archive& saved);

/// Writes `--final FILE.json`: time, positions, velocities, plastic_rest_positions (num_nodes x 3), per hexahedron
/// isolated_shapes (8 x 3: the isolated rest shape in the material frame, about its mean), volume_ratio and
/// yield_stress (null where infinite), removed (hexahedra in the order of their removal), state_hash; numbers with all
/// their bits. Of several bodies all lists hold those of one body behind those of another, `removed` too, and `bodies`
/// tells which is whose: name, first_node, nodes, first_hexahedron, hexahedra.
void write_final(WholeFile& file, double time, ConstPoints positions, ConstPoints velocities, const Bodies& bodies,
                 const std::string& hash);

}  // namespace hexaplast::output
