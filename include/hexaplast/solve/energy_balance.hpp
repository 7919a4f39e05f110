// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast {

/// What one time step did to the energy of a system [J].                                        theory.md eq. 44-48
struct StepEnergy {
  double load_work = 0;       ///< done by loads, as far as velocity has no part in them
  double support_work = 0;    ///< done by the forces that keep constrained nodes where they are or on their way
  double damping_loss = 0;    ///< to Rayleigh damping, forces that depend on velocity, and the decay of velocity
  double numerical_loss = 0;  ///< to the integrator, as it follows from the scheme for a constant stiffness
};

/// Where the energy of a body came from and where it went, since the beginning [J]:
///
///   kinetic + elastic = initial + load_work + support_work + recovery_work + change_work - damping_loss
///                       - numerical_loss - flow_loss - error
///
/// All but kinetic and elastic are sums over steps.
struct EnergyBalance {
  double kinetic = 0;         ///< at the moment; 0 in the first order scheme, which knows no inertia
  double elastic = 0;         ///< at the moment
  double initial = 0;         ///< kinetic and elastic at the beginning
  double load_work = 0;       ///< done by loads
  double support_work = 0;    ///< done by supports that move
  double damping_loss = 0;    ///< taken by damping
  double numerical_loss = 0;  ///< taken by the integrator
  double recovery_work = 0;   ///< brought in by the springs of `recovery` as they come and go
  double change_work = 0;     ///< elastic energy that changes of a body's material brought in, between two steps
  double flow_loss = 0;       ///< elastic energy that plastic steps took: flow, averaging, fracture

  /// What the terms above leave unexplained: forces are not linear in the displacement of a step, and a linear solver
  /// stops at its tolerance.
  double error() const;

  /// With that of another system, at the same moment.
  EnergyBalance& operator+=(const EnergyBalance& other);

  void begin(double kinetic_now, double elastic_now);

  /// The next step of the integrator; energies are those at its end. recovery: Body::recovery_work there.
  void add_step(const StepEnergy& step, double kinetic_now, double elastic_now, double recovery);

  /// Supports put nodes where they are to be: work of theirs.
  void add_motion_of_supports(double kinetic_now, double elastic_now);

  /// A plastic step, at unchanged positions.
  void add_flow(double elastic_now);

  /// A change of the material of a body or of its hexahedra, at unchanged positions.
  void add_change(double elastic_now);
};

}  // namespace hexaplast
