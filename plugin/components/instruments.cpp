// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/parts.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "parts/grasp.hpp"
#include "scene/interfaces.hpp"
#include "scene/load.hpp"
#include "scene/potential.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

class GraspForceField final : public scene::ForceField,
                              public scene::Changeable,
                              public scene::Stateful,
                              public scene::Load,
                              public scene::Instrument,
                              public scene::Potential {
 public:
  GraspForceField() : ForceField(attributes::kGraspForceField) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    grasp_.emplace(accepted(*this, [&] { return parts::Grasp(options(), state_->num_nodes()); }));
  }
  void refresh(std::span<const std::string_view>) override {
    accepted(*this, [&] { grasp_->set_options(options()); });
  }
  void begin_step() override { pass_on(*this, grasp_->begin_step(node().clock().time, state_->positions())); }
  void reset() override { grasp_->reset(); }
  void serialize(Archive& archive) override { grasp_->serialize(archive); }

  void add_force(double time, ConstPoints x, ConstPoints v, Points f) override { grasp_->add_force(time, x, v, f); }
  void add_load(double time, ConstPoints x, ConstPoints, Points f) const override {
    grasp_->add_spring_force(time, x, f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    grasp_->add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override { grasp_->add_stiffness_blocks(factor, A); }
  bool is_in_matrix() const override { return grasp_->is_closed(); }
  bool describe(double factor, MatrixFreeSystem& system) const override {
    return grasp_->add_stiffness_diagonal(factor, system.diagonal);
  }
  void add_damping_product(double factor, ConstPoints dx, Points df) const override {
    grasp_->add_damping_product(factor, dx, df);
  }
  void add_damping_blocks(double factor, BlockMatrix& A) const override { grasp_->add_damping_blocks(factor, A); }
  void add_damping_diagonal(double factor, Points diagonal) const override {
    grasp_->add_damping_diagonal(factor, diagonal);
  }
  double potential_energy(double time, ConstPoints x) const override { return grasp_->energy(time, x); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  std::optional<Vec3> place(double time) const override {
    if (!grasp_->is_closed()) return {};
    return grasp_->tool_at(time);
  }

  void provide(scene::Data& output) override {
    if (!grasp_) return;
    if (output.attribute().name == "grasped") {
      const std::span<const int> held = grasp_->held_nodes();
      output.set(std::vector<std::int64_t>(held.begin(), held.end()));
    }
    const auto set = [&](const Vec3& vector) { output.set(std::vector<double>(vector.begin(), vector.end())); };
    if (output.attribute().name == "force") set(grasp_->force());
    if (output.attribute().name == "torque") set(grasp_->torque());
  }

 private:
  parts::GraspOptions options() {
    rayleigh_stiffness_ = real("rayleighStiffness");
    return read_options<parts::GraspOptions>(*this);
  }

  scene::MechanicalState* state_ = nullptr;
  std::optional<parts::Grasp> grasp_;
  double rayleigh_stiffness_ = 0;
};

}  // namespace

void add_instruments(scene::Factory& factory) { factory.add<GraspForceField>(attributes::kGraspForceField); }

}  // namespace hexaplast::components
