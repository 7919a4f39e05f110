// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/moving_body.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/cholesky.hpp"

namespace hexaplast {

std::vector<double> lumped_masses(const Model& model, double density) {
  std::vector<double> mass(model.mesh.num_nodes(), 0.0);
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    for (const int n : model.mesh.hexahedra()[e]) mass[n] += density * model.volume[e] / kCorners;
  }
  return mass;
}

LoadedBody::LoadedBody(Body& body, std::vector<double> mass, std::vector<int> fixed, NodalLoad load)
    : body_(body), mass_(std::move(mass)), fixed_(std::move(fixed)), load_(std::move(load)) {}

void LoadedBody::compute_force(double time, ConstPoints x, ConstPoints, Points f) {
  body_.linearize(x);
  f.setZero();
  body_.add_force(f);
  if (load_) load_(time, x, f);
}

void LoadedBody::add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  for (int n = 0; n < num_nodes(); ++n) df.row(n) += factors.mass * mass_[n] * dx.row(n);
  body_.add_stiffness_product(factors.stiffness, dx, df);
}

void LoadedBody::add_blocks(const OperatorFactors& factors, BlockMatrix& A) const {
  for (int n = 0; n < num_nodes(); ++n) A.add(n, n, factors.mass * mass_[n] * Mat3::Identity());
  body_.add_stiffness_blocks(factors.stiffness, A);
}

bool LoadedBody::to_kernels(const OperatorFactors& factors, KernelSystem& system) const {
  for (int n = 0; n < num_nodes(); ++n) system.diagonal.row(n).array() += factors.mass * mass_[n];
  body_.to_kernels(factors.stiffness, system);
  return true;
}

void LoadedBody::project(Points field) const {
  for (const int n : fixed_) field.row(n).setZero();
}

void LoadedBody::pin(BlockMatrix& A) const {
  for (const int n : fixed_) {
    for (int axis = 0; axis < 3; ++axis) A.pin(n, axis);
  }
}

namespace {

void check(const Motion& motion, const Body& body) {
  for (const auto& [name, value] : {std::pair{"density", motion.density}, std::pair{"dt", motion.dt}})
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(fmt::format("{} = {}: must be a finite number greater than 0", name, value));
  for (const int n : motion.fixed)
    if (n < 0 || n >= body.mesh().num_nodes())
      throw InputError(fmt::format("fixed node {}: the body has nodes 0 to {}", n, body.mesh().num_nodes() - 1));
  if (body.model().can_flow()) check_time_step(body.model().materials, body.model().settings, motion.dt);
}

}  // namespace

MovingBody::MovingBody(Body made, Motion motion, std::unique_ptr<LinearSolver> solver)
    : body(std::move(made)),
      mass(lumped_masses(body.model(), motion.density)),
      x(body.mesh().positions()),
      v(PointArray::Zero(x.rows(), 3)),
      system_(body, mass, motion.fixed, motion.load),
      euler_(motion.euler),
      solver_(solver ? std::move(solver) : std::make_unique<CholeskySolver>()),
      dt_(motion.dt) {
  check(motion, body);
}

FlowReport MovingBody::step() {
  latest = euler_.step(system_, *solver_, time(), dt_, x, v);
  ++steps_;
  return body.flow(x, dt_);
}

void MovingBody::run(int steps) {
  for (int k = 0; k < steps; ++k) step();
}

std::string MovingBody::state_hash() const {
  StateHash hash;
  hash.add(x.data(), x.size() * sizeof(double));
  hash.add(v.data(), v.size() * sizeof(double));
  body.add_to(hash);
  return hash.text();
}

}  // namespace hexaplast
