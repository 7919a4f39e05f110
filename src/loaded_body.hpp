// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/moving_body.hpp"
#include "mesh/lumped_mass.hpp"
#include "solve/layered_system.hpp"

/// A body as a mechanical system.
namespace hexaplast {

/// A mass at every node. Base: NodalMass, or a component that is one.
template <class Base>
class LumpedMasses : public Base {
 public:
  using Base::Base;

  void add_gravity(const Vec3& gravity, Points f) const override { hexaplast::add_gravity(masses, gravity, f); }
  void add_product(double factor, ConstPoints dx, Points df) const override { df += factor * masses.asDiagonal() * dx; }
  void add_blocks(double factor, BlockMatrix& A) const override {
    for (int n = 0; n < static_cast<int>(masses.size()); ++n) A.add(n, n, factor * masses[n] * Mat3::Identity());
  }
  double kinetic_energy(ConstPoints v) const override { return hexaplast::kinetic_energy(masses, v); }
  void add_diagonal(double factor, Points diagonal) const override { diagonal.colwise() += factor * masses; }

  Eigen::VectorXd masses;  ///< [kg] per node
};

/// The forces of a body's elasticity. Base: likewise.
template <class Base>
class ElasticForces : public Base {
 public:
  using Base::Base;

  void set_time_step(double dt) override { elastic->set_time_step(dt); }
  void add_force(double, ConstPoints x, ConstPoints, Points f) override {
    elastic->linearize(x);
    elastic->add_force(f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    elastic->add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override { elastic->add_stiffness_blocks(factor, A); }
  bool add_operator(double factor, MatrixFreeSystem& system) const override {
    elastic->add_operator(factor, system);
    return true;
  }

  Body* elastic = nullptr;  ///< must be there before it is asked for anything, and outlive this
};

/// A body with nodal masses, fixed nodes, a load and other forces, as a time integrator sees it.
class LoadedBody : public LayeredSystem {
 public:
  /// The body must outlive this. mass: one per node [kg]. fixed: nodes that do not move. load: may be empty. Throws
  /// InputError for another number of masses, and for nodes that do not exist.
  LoadedBody(Body& body, const std::vector<double>& mass, std::vector<int> fixed, NodalLoad load,
             const Vec3& gravity = Vec3::Zero());

  /// Fixes other nodes from now on. Throws InputError for nodes that do not exist.
  void fix(std::vector<int> nodes);

  /// Forces act on the body from now on; they must outlive this.
  void add(StepForces& forces) { add_interaction(forces, {&state_, &state_}); }

  /// The same body in another place.
  void set_body(Body& body) { elasticity_.elastic = &body; }

  void constrain(Constraints& constraints) const override;

 private:
  /// The caller of the integrator has the motion: here is its size alone.
  struct State final : NodalState {
    PointArray& positions() override { return sized; }
    PointArray& velocities() override { return sized; }
    PointArray sized;
  };

  struct Elasticity final : ElasticForces<NodalForces> {
    bool is_body() const override { return true; }
  };

  struct Load final : NodalForces {
    void add_force(double time, ConstPoints x, ConstPoints, Points f) override {
      if (act) act(time, x, f);
    }
    bool is_in_matrix() const override { return false; }
    NodalLoad act;
  };

  const Vec3 own_gravity_;  // [m/s^2]
  State state_;
  LumpedMasses<NodalMass> masses_;
  Elasticity elasticity_;
  Load load_;
  std::vector<int> fixed_;
};

}  // namespace hexaplast
