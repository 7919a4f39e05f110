// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast::support {

/// External nodal forces: adds to f [N], given the time [s] and the positions [m] at the beginning of a step.
using Load = std::function<void(double time, ConstPoints x, Points f)>;

/// rho V0 / 8 to each corner of every element [kg], one mass per node.
std::vector<double> lumped_mass(const Model& model, double density);

/// A body with lumped masses, fixed nodes and a load, as a time integrator sees it.
class LoadedBody : public MechanicalSystem {
 public:
  LoadedBody(Body& body, std::vector<double> mass, std::vector<int> fixed, Load load);

  int num_nodes() const override { return body_.mesh().num_nodes(); }
  void compute_force(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override;
  bool to_kernels(const OperatorFactors& factors, KernelSystem& system) const override;
  void project(Points field) const override;
  void pin(BlockMatrix& A) const override;

 private:
  Body& body_;
  std::vector<double> mass_;
  std::vector<int> fixed_;
  Load load_;
};

/// What a simulation is made of besides its body.
struct SimulationSetup {
  double density = 1000;  ///< [kg/m^3]
  double dt = 0.01;       ///< [s]
  EulerSettings euler;
  std::vector<int> fixed;  ///< nodes that do not move
  Load load;               ///< none when empty
};

/// The library's path through one time step: an implicit step of the world, then one plastic flow at the accepted
/// positions.
class Simulation {
 public:
  /// Starts at the body's original positions, at rest, at time 0; `solver` defaults to sparse Cholesky.
  Simulation(Body body, SimulationSetup setup, std::unique_ptr<LinearSolver> solver = nullptr);

  Simulation(const Simulation&) = delete;  // the system refers to the body
  Simulation& operator=(const Simulation&) = delete;

  FlowReport step();
  SolveReport latest;  ///< of the latest step
  void run(int steps);

  double time() const { return steps_ * dt_; }
  std::string state_hash() const;

  Body body;
  std::vector<double> mass;  ///< [kg] per node
  PointArray x;              ///< [m]
  PointArray v;              ///< [m/s]

 private:
  LoadedBody system_;
  ImplicitEuler euler_;
  std::unique_ptr<LinearSolver> solver_;
  double dt_;
  int steps_ = 0;
};

}  // namespace hexaplast::support
