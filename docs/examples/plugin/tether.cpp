// SPDX-License-Identifier: LGPL-2.1-or-later
// A plugin with one component: springs that tie every node to a place beside where it began.
#include <scene/factory.hpp>
#include <scene/interfaces.hpp>
#include <scene/plugin.hpp>

namespace {

using namespace hexaplast;

// The attributes: reading, range checks, `hexaplast list --plugin Tether` and messages come from this table.
constexpr attributes::Attribute kAttributes[] = {
    {.name = "stiffness",
     .type = attributes::Type::kReal,
     .initial = "1",
     .unit = "N/m",
     .range = attributes::kPositive,
     .help = "Of each node's spring."},
    {.name = "offset",
     .type = attributes::Type::kVector3,
     .initial = "0 0 0",
     .unit = "m",
     .help = "From a node's rest position to where its spring pulls it."},
};
constexpr attributes::Description kTetherForceField{.class_name = "TetherForceField",
                                                    .category = "ForceField",
                                                    .help = "Ties every node to a place beside its rest position.",
                                                    .templates = attributes::kVec3Templates,
                                                    .attributes = kAttributes};

/// f = -k (x - X - offset) per node; df/dx = -k.
class TetherForceField final : public scene::ForceField {
 public:
  TetherForceField() : ForceField(kTetherForceField) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    stiffness_ = real("stiffness");
    offset_ = vector3("offset");
  }

  void add_force(double /*time*/, ConstPoints x, ConstPoints /*v*/, Points f) override {
    f -= stiffness_ * ((x - state_->rest_positions()).rowwise() - offset_.transpose());
  }

  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    df -= factor * stiffness_ * dx;
  }

  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    for (int n = 0; n < state_->num_nodes(); ++n) A.add(n, n, -factor * stiffness_ * Mat3::Identity());
  }

 private:
  scene::MechanicalState* state_ = nullptr;
  double stiffness_ = 0;
  Vec3 offset_ = Vec3::Zero();
};

}  // namespace

HEXAPLAST_PLUGIN(factory) { factory.add<TetherForceField>(kTetherForceField); }
