// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <string>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"
#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

class NodeCopies;

/// What mechanical systems are made of: states, and what acts on them. Nodal fields are num_nodes x 3.

/// What time integrators move and mappings carry.
class NodalState {
 public:
  virtual ~NodalState() = default;

  virtual PointArray& positions() = 0;   ///< x [m]
  virtual PointArray& velocities() = 0;  ///< v [m/s]

  int num_nodes() { return static_cast<int>(positions().rows()); }
};

/// The mass matrix M of a state, lumped: a mass at every node.
class NodalMass {
 public:
  virtual ~NodalMass() = default;

  virtual void add_gravity(const Vec3& gravity, Points f) const = 0;             ///< f += M g [N]
  virtual void add_product(double factor, ConstPoints dx, Points df) const = 0;  ///< df += factor M dx
  virtual void add_blocks(double factor, BlockMatrix& A) const = 0;              ///< A += factor M
  virtual void add_diagonal(double factor, Points diagonal) const = 0;           ///< diagonal += that of factor M
  virtual double kinetic_energy(ConstPoints v) const = 0;                        ///< v.M v / 2 [J]

  /// [1/s] damping by this mass in the system matrix alone.
  virtual double rayleigh_mass() const { return 0; }
};

/// Forces f(x, v, time) on a mechanical state, or between two: `In` and `Out` are a nodal field, or one of each state.
/// K = df/dx, which is negative semi-definite for an elastic body, and B = df/dv.
template <class In, class Out, class... FirstNodes>
class Forces {
 public:
  using Verbs = Forces;

  virtual ~Forces() = default;

  /// What follows is of a step of dt [s]; infinite: of an equilibrium.
  virtual void set_time_step(double /*dt*/) {}

  /// f += forces [N] at (x, v, time). Evaluates only: it may be called at any positions, any number of times. Fixes the
  /// positions that the derivatives below refer to.
  virtual void add_force(double time, In x, In v, Out f) = 0;

  /// df += factor K dx, A += factor K. FirstNodes of two states: where the nodes of each begin in A; -1: it is at rest,
  /// and A has none of them.
  virtual void add_stiffness_product(double /*factor*/, In /*dx*/, Out /*df*/) const {}
  virtual void add_stiffness_blocks(double /*factor*/, BlockMatrix& /*A*/, FirstNodes... /*first*/) const {}

  /// The same with B; between two states for one-sided forces alone.
  virtual void add_damping_product(double /*factor*/, In /*dx*/, Out /*df*/) const {}
  virtual void add_damping_blocks(double /*factor*/, BlockMatrix& /*A*/, FirstNodes... /*first*/) const {}

  /// Whether K or B has entries at the positions of the latest forces; where not, linear systems are as without it.
  virtual bool is_in_matrix() const { return true; }

  /// [s] stiffness-proportional damping of these forces in the system matrix alone.
  virtual double rayleigh_stiffness() const { return 0; }

  /// For one-sided forces on independent states: whether there are any, and letting go of those that would pull at the
  /// end of a step (MechanicalSystem::release). Returns whether there were any.
  virtual bool is_one_sided() const { return false; }
  virtual bool release(In /*x_end*/, In /*v_end*/) { return false; }
};

/// Forces on a state.
class NodalForces : public Forces<ConstPoints, Points> {
 public:
  /// The stiffness for solvers that work on the kernels' own vectors. False, and nothing added, where the kernels
  /// cannot express it; the solvers then use the verbs above beside them.
  virtual bool add_operator(double /*factor*/, MatrixFreeSystem& /*system*/) const { return false; }

  /// diagonal += that of factor B, for a B that has no other entries and forces whose stiffness the kernels can
  /// express. The default is no damping: add_operator of forces with another B returns false.
  virtual void add_damping_diagonal(double /*factor*/, Points /*diagonal*/) const {}

  /// Whether they are the elasticity of a body, which is no load.
  virtual bool is_body() const { return false; }
};

/// Forces between two states, or within one.
class PairForces : public Forces<const Pair<ConstPoints>&, Pair<Points>, std::array<int, 2>> {
 public:
  /// Within one state: diagonal += that of factor K, where K has no other entries; false, and nothing added, where it
  /// has. The same of B then, which has no others either.
  virtual bool add_stiffness_diagonal(double /*factor*/, Points /*diagonal*/) const { return false; }
  virtual void add_damping_diagonal(double /*factor*/, Points /*diagonal*/) const {}
};

/// The beginning of a step.
struct Step {
  double time = 0;                ///< [s]
  double dt = 0;                  ///< [s]
  double rayleigh_stiffness = 0;  ///< [s] of the time integrator; contact is told it, as it does not act on contact
};

/// Forces that decide at the beginning of a step what acts in it, as contacts and grips do.
class StepForces : public PairForces {
 public:
  /// By accepted positions and velocities: the same for everyone until the step ends.
  virtual void begin_step(const Step& /*step*/, const Pair<ConstPoints>& /*x*/, const Pair<ConstPoints>& /*v*/) {}

  /// The step has ended at x.
  virtual void end_step(const Pair<ConstPoints>& /*x*/) {}

  /// Nodes of a state (0 or 1) are others than before. What these forces were made from names initial nodes; they act
  /// on all copies of these, on each by its share. split_from: of the last nodes, which have come since, the one that
  /// each was split from; empty after reset, and where a state is to be read. Between two steps.
  virtual void nodes_changed(int /*state*/, const NodeCopies& /*copies*/, std::span<const int> /*split_from*/) {}

  /// Why nodes cannot split where these forces act; empty: they can, and nodes_changed is called.
  virtual std::string cannot_follow() const { return "other forces do not know of nodes that split"; }

  /// As they were made.
  virtual void reset() {}

  /// What the next step depends on besides what they were made from. Throws InputError for values that cannot be.
  virtual void serialize(Archive& /*archive*/) {}
};

/// Makes a state follow another one: positions, velocities and displacements go down, forces and stiffness come up.
/// Nodal fields of the followed state are `above`, those of its own `below`. Positions below are J times those above,
/// and J never changes.
class NodalMapping {
 public:
  virtual ~NodalMapping() = default;

  virtual void apply(ConstPoints above, Points below) const = 0;                               ///< below = J above
  virtual void add_transposed(ConstPoints below, Points above) const = 0;                      ///< above += J^T below
  virtual void add_transposed_blocks(const BlockMatrix& below, BlockMatrix& above) const = 0;  ///< above += J^T below J
};

class NodalConstraint {
 public:
  virtual ~NodalConstraint() = default;

  virtual void fix(NodeMaskRows free) const = 0;  ///< clears the degrees of freedom that it constrains

  /// Prescribed motion, applied after init and after every solve, at the time t_n of the step's beginning.
  virtual void project_motion(double /*time*/, Points /*x*/, Points /*v*/) const {}
};

/// The same between two states that one integrator moves. The first one may follow another state where it only leads
/// the second one.
class PairConstraint {
 public:
  virtual ~PairConstraint() = default;

  /// Whether it projects motions of one state to those of the other: no matrix has that.
  virtual bool couples() const = 0;

  virtual void project(Pair<Points> field) const = 0;  ///< where it couples
  virtual void fix(NodeMaskRows second) const = 0;     ///< where it does not: clears what it constrains
  virtual void project_motion(double time, Pair<Points> x, Pair<Points> v) const = 0;
};

}  // namespace hexaplast
