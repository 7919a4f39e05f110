// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <functional>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/solve/implicit_euler.hpp"
#include "hexaplast/solve/mechanics.hpp"

namespace hexaplast {

class LoadedBody;

/// External nodal forces: adds to f [N], num_nodes x 3, given the time [s] and the positions [m] at the beginning of a
/// step. Taken as constant over the step.
using NodalLoad = std::function<void(double time, ConstPoints x, Points f)>;

/// density times the volume of each hexahedron, an eighth to each of its corners [kg]; one mass per node. It is the
/// trilinear volume, that of the elasticity; masses of scenes have SOFA's, which is another where faces
/// are not plane.
std::vector<double> lumped_masses(const Body& body, double density);

/// What moves a body, besides itself.
struct Motion {
  double density = 1000;        ///< [kg/m^3]
  double dt = 0.01;             ///< [s]
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
  EulerSettings euler = {};
  std::vector<int> fixed = {};  ///< nodes that do not move
  NodalLoad load = {};          ///< none when empty
};

/// What some steps did together.
struct RunReport {
  int steps = 0;
  int stalled = 0;  ///< steps in which the linear solver, or the one of the averaging, stopped before its tolerance
  SolveReport solve = {};  ///< most iterations of a step, largest residual; converged: in every step
  FlowReport flow = {};    ///< largest counts of a step, but all that were removed; averaging: as for `solve`

  void add(const SolveReport& solved, const FlowReport& flowed);
};

/// A body by itself in time, for programs that have no scene: an implicit step of the positions, then one plastic flow
/// at the accepted positions. Nodes without hexahedron have no mass and stay where they are. May be moved, not copied.
class MovingBody {
 public:
  /// Starts at the body's initial positions, at rest, at time 0. solver: sparse Cholesky when null, which is exact and
  /// suits up to about a thousand hexahedra; PreconditionedConjugateGradients beyond. Throws InputError where a fixed
  /// node does not exist, or a number of `motion` is not positive, or a rate of the material too great for dt.
  MovingBody(Body body, Motion motion, std::unique_ptr<LinearSolver> solver = nullptr);
  MovingBody(MovingBody&&) noexcept;
  MovingBody& operator=(MovingBody&&) noexcept;
  ~MovingBody();

  /// One time step. Throws NumericalError naming the first node or element that left the finite numbers, and what the
  /// load throws; everything is then as before the step, time, prescribed displacements and solver_memory() included,
  /// to the last bit.
  FlowReport step();
  SolveReport latest;  ///< of the latest step

  /// Several steps. Throws as `step` does: those before the one that fails are done.
  RunReport run(int steps);

  /// Nodes stay where they are from now on. Throws InputError where a node does not exist, as do the two below.
  void fix(std::span<const int> nodes);

  /// The same, but in the next step they move to `target` [m] (one row per node), at the velocity that this takes:
  /// the other nodes feel it within the step. After it they stand still.
  void prescribe(std::span<const int> nodes, ConstPoints target);

  /// Nodes move freely from now on.
  void release(std::span<const int> nodes);

  /// Per node: 1 where it is fixed or prescribed.
  std::vector<unsigned char> fixed() const;

  /// Body::open between two steps, all else following: new nodes have position, velocity and fixing of those that they
  /// were split from, masses are those of the hexahedra. Throws InputError for numbers that are not there, and where
  /// forces that were added cannot follow; everything is then as before.
  std::vector<int> open(std::span<const int> joints, std::span<const double> crossings = {});

  /// From now on `forces` act too, such as contacts and grips (parts/instrument.hpp, parts/grasp.hpp). They must
  /// outlive this, which stays where it is from then on if they refer to its body. Throws InputError in first order and
  /// in the trapezoidal scheme, which do not suit contact.
  void add(StepForces& forces);

  /// From now on steps find the forces of supports too, at the cost of some products. The motion has the same bits.
  void measure_supports() { euler_.measure_energy(); }

  /// [N] on each node by which it was fixed or prescribed in the latest step; zero where it was free. No rows before a
  /// step in which they are measured.
  PointArray support_forces() const { return euler_.support_forces(); }

  /// Back to the beginning: the initial body at rest, at time 0, without solver memory. Nodes that are fixed stay so.
  void reset();

  /// Writes all that the next step depends on besides what the constructor was given: positions, velocities, the number
  /// of steps, fixed nodes, prescribed displacements, solver_memory(), the body (Body::save) and what forces remember.
  /// A motion that loads it goes on as this one does, bit for bit, whatever it and its solver have done before. Throws
  /// InputError when the stream does not take it all.
  void save(std::ostream& out) const;

  /// Takes over what `save` wrote for a body of the same mesh and settings, with the same masses, dt, gravity, damping
  /// order of the scheme, and forces; reads no byte beyond. The load and the solver are the caller's to repeat. Throws
  /// InputError for what is damaged, of another format version or of another motion; this is then as before.
  void load(std::istream& in);

  /// What the steps so far have left for the linear solver of the next one: the third part of the motion, besides
  /// positions and velocities. A caller that replaces these resets it, or what comes depends on what was solved before.
  SolverMemory& solver_memory() { return euler_.memory(); }

  long steps() const { return steps_; }                              ///< so far
  double dt() const { return dt_; }                                  ///< [s]
  double time() const { return static_cast<double>(steps_) * dt_; }  ///< [s]

  /// XXH64, as 16 hexadecimal digits, over positions, velocities and everything plastic.
  std::string state_hash() const;

  const std::vector<double>& mass() const { return mass_; }  ///< [kg] per present node

  Body body;              ///< joints open, and are closed by reset or load, through the motion alone
  PointArray positions;   ///< [m] num_nodes x 3
  PointArray velocities;  ///< [m/s] num_nodes x 3

 private:
  void require_own_nodes() const;
  void take_nodes();  // the system, masses and fixed nodes, of the body's present ones
  void tell_fixed();  // the system, what held_ says
  void arrive();      // prescribed nodes are fixed from here on
  void save_forces(std::ostream& out) const;
  void load_forces(std::istream& in);

  double density_;
  Vec3 gravity_;
  NodalLoad load_;
  std::vector<double> mass_;
  std::vector<StepForces*> forces_;
  std::unique_ptr<LoadedBody> system_;
  ImplicitEuler euler_;
  std::unique_ptr<LinearSolver> solver_;
  double dt_;
  EulerSettings settings_;
  std::array<double, 10> given_;     // what a saved motion must have too
  std::vector<unsigned char> held_;  // per node: free, fixed, or prescribed for the next step
  long steps_ = 0;
  PointArray positions_before_, velocities_before_;  // of the step under way
  SolverMemory memory_before_;
  std::vector<std::byte> forces_before_;
};

}  // namespace hexaplast
