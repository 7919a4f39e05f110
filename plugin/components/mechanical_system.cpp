// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/mechanical_system.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"

namespace hexaplast::components {

NodeSystem::NodeSystem(scene::Node& node)
    : node_(node),
      masses_(node.all<scene::Mass>()),
      force_fields_(node.all<scene::ForceField>()),
      constraints_(node.all<scene::ProjectiveConstraint>()) {
  const std::vector<scene::MechanicalState*> states = node.all<scene::MechanicalState>();
  if (states.size() != 1)
    throw InputError(fmt::format("{} mechanical states in its node and below, must be one", states.size()));
  state_ = states[0];
}

void NodeSystem::compute_force(double time, ConstPoints x, ConstPoints v, Points f) {
  f.setZero();
  state_->add_external_force(f);
  for (const scene::Mass* mass : masses_) mass->add_gravity(node_.clock().gravity, f);
  for (scene::ForceField* field : force_fields_) field->add_force(time, x, v, f);
}

// A mass damps by its own factor, a force field by its own: both through the damping factor b of m M + b B + k K.
void NodeSystem::add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  for (const scene::Mass* mass : masses_)
    mass->add_product(factors.mass - factors.damping * mass->rayleigh_mass(), dx, df);
  for (const scene::ForceField* field : force_fields_) {
    field->add_stiffness_product(factors.stiffness + factors.damping * field->rayleigh_stiffness(), dx, df);
    field->add_damping_product(factors.damping, dx, df);
  }
}

void NodeSystem::add_blocks(const OperatorFactors& factors, BlockMatrix& A) const {
  for (const scene::Mass* mass : masses_) mass->add_blocks(factors.mass - factors.damping * mass->rayleigh_mass(), A);
  for (const scene::ForceField* field : force_fields_) {
    field->add_stiffness_blocks(factors.stiffness + factors.damping * field->rayleigh_stiffness(), A);
    field->add_damping_blocks(factors.damping, A);
  }
}

bool NodeSystem::to_kernels(const OperatorFactors& factors, KernelSystem& system) const {
  system.double_operator = nullptr;
  system.single_operator = nullptr;
  for (const scene::Mass* mass : masses_)
    if (!mass->add_diagonal(factors.mass - factors.damping * mass->rayleigh_mass(), system.diagonal)) return false;
  for (const scene::ForceField* field : force_fields_)
    if (!field->to_kernels(factors.stiffness + factors.damping * field->rayleigh_stiffness(), system)) return false;
  return system.double_operator || system.single_operator;
}

void NodeSystem::project(Points field) const {
  for (const scene::ProjectiveConstraint* constraint : constraints_) constraint->project(field);
}

void NodeSystem::pin(BlockMatrix& A) const {
  for (const scene::ProjectiveConstraint* constraint : constraints_) constraint->pin(A);
}

double NodeSystem::kinetic_energy() const {
  double energy = 0;
  for (const scene::Mass* mass : masses_) energy += mass->kinetic_energy(state_->velocities());
  return energy;
}

void NodeSystem::project_motion(double time) const {
  for (const scene::ProjectiveConstraint* constraint : constraints_)
    constraint->project_motion(time, state_->positions(), state_->velocities());
}

}  // namespace hexaplast::components
