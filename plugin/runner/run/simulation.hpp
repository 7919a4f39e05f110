// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "record/recorder.hpp"
#include "runner/run/scene_file.hpp"
#include "scene/parts.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::runner {

/// What the accepted steps of a simulation add up to.
struct Totals {
  double step_ms = 0;   ///< wall time of all steps, without output
  long iterations = 0;  ///< of all linear solves
  std::array<long, kPreconditionerNames.size()> steps_by_preconditioner = {};  ///< that had something to solve
  long stalled_solves = 0;     ///< steps whose linear solver stopped before its tolerance
  long stalled_newton = 0;     ///< steps whose Newton iterations met none of their thresholds
  long threshold_solves = 0;   ///< steps whose linear solver stopped at its threshold above its tolerance
  long stalled_averaging = 0;  ///< steps whose rest-shape averaging did
  long first_removal = 0;      ///< step in which the body lost its first hexahedron; 0: none
  long latest_removal = 0;
  long rolled_back = 0;      ///< plastic steps of hexahedra that were rolled back
  int max_inverted = 0;      ///< hexahedra that were inverted in one step
  long max_inverted_in = 0;  ///< the first such step

  /// The least and the greatest reading of a probe, and when [s] it first was so.
  struct Extremes {
    double min = 0, min_at = 0, max = 0, max_at = 0;
  };
  std::vector<Extremes> probes = {};  ///< one per probe

  double energy_put_in = 0;  ///< [J] that it began with, and work of loads and supports: the most so far
};

/// What to do about SolveReport::at_threshold.
inline constexpr const char* kThresholdRemedy = "set threshold=\"0\" or use MultigridCGLinearSolver";

/// A scene in motion, step by step: what all commands share that run one. Any number of states and bodies.
class Simulation {
 public:
  /// Reads and initialises the scene, and logs its warnings. Throws what load_scene throws, and SceneError where there
  /// is no state or no solver of motion.
  explicit Simulation(const SceneOptions& options);

  /// One time step. Throws what Scene::step throws, a NumericalError with the step's number. Positions and velocities
  /// are then those of the latest accepted step, so that they can be reported, but only reset leads on.
  const output::StepRecord& step();

  /// Records of steps hold the balance of energy from now on, where the solver of motion keeps one; at the beginning.
  /// It costs a step about two products.
  void keep_energy_balance();

  /// Back to the beginning.
  void reset();

  /// Where it stands, into a checkpoint between two steps, or from one right after construction: it goes on bit for
  /// bit. Throws InputError when it was another scene's (Scene::serialize).
  void serialize(Archive& archive);

  /// What belongs to its steps besides: figures of the latest one, and totals. To be read after the above.
  void serialize_totals(Archive& archive);

  /// The step after which a checkpoint was written, without reading the rest.
  static long saved_step(Archive archive);

  /// Of the scene as it is carried out (identity_of).
  std::uint64_t scene_identity() const { return scene_identity_; }

  const output::StepRecord& latest() const { return latest_; }  ///< that of step 0 before the first step
  const Totals& totals() const { return totals_; }

  /// Those that RunSettings tells.
  std::optional<long> num_steps() const { return num_steps_; }
  int output_every() const { return output_every_; }
  const std::string& end_sections() const { return end_sections_; }

  double dt() { return scene_.dt(); }      ///< [s]
  double time() { return scene_.time(); }  ///< [s] a running sum

  /// [s] at which the latest step took its loads, its beginning; before the first step, that of the first.
  double load_time() const { return load_time_; }
  scene::Scene& scene() { return scene_; }
  view::ShownScene shown() { return {scene_, bodies(), scene_bodies_, load_time_}; }

  /// Those of the bodies; null: there are only masses.
  const output::Bodies* bodies() const { return bodies_ ? &*bodies_ : nullptr; }
  const std::vector<scene::SceneBody>& scene_bodies() const { return scene_bodies_; }

  /// Of the bodies' nodes (output::Bodies), or, where there is none, of the independent states, one behind the other;
  /// valid until the next call.
  const PointArray& positions();   ///< [m]
  const PointArray& velocities();  ///< [m/s]

  int num_nodes();  ///< of the independent states

  /// Of everything in motion (output::state_hash).
  std::string state_hash();

  const std::vector<scene::Probe*>& probes() const { return probes_; }  ///< in the order of StepRecord::probes

 private:
  output::StepRecord record_of(long step, const SolveReport& solve, double step_ms);
  void note_extremes();

  scene::Scene scene_;
  std::vector<scene::MechanicalState*> states_;  // independent ones
  std::vector<scene::OdeSolver*> solvers_;
  std::vector<scene::SceneBody> scene_bodies_;
  std::vector<scene::MechanicalState*> shown_states_;  // of the bodies, or states_
  std::optional<output::Bodies> bodies_;
  PointArray positions_, velocities_;  // of several shown states
  std::vector<scene::Probe*> probes_;
  std::uint64_t scene_identity_;
  std::optional<long> num_steps_;
  int output_every_ = 25;
  std::string end_sections_ = "auto";
  output::StepRecord latest_;
  double load_time_ = 0;  // [s]
  Totals totals_;
};

/// By what the linear solver was preconditioned, and in how many steps where that changed; empty where nothing was
/// solved.
std::string preconditioner_line(const Totals& totals);

/// How many steps a run has: as many as the command line gives, otherwise as the scene's RunSettings say. Throws
/// UsageError where neither does.
long required_steps(const Simulation& simulation, std::optional<long> given);

}  // namespace hexaplast::runner
