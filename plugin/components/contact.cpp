// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/contact.hpp"

#include "components/between_states.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "parts/instrument.hpp"
#include "parts/instrument_shape.hpp"
#include "scene/interfaces.hpp"
#include "scene/load.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

class InstrumentContactForceField final : public scene::ForceField,
                                          public scene::Changeable,
                                          public scene::Stateful,
                                          public scene::Load,
                                          public scene::Instrument {
 public:
  InstrumentContactForceField() : ForceField(attributes::kInstrumentContactForceField) {}

  void init() override { state_ = &needed_ready<scene::MechanicalState>(); }

  // Bodies and integrators may stand behind it.
  void bwd_init() override {
    body_field_ = body_field_on(*state_);
    if (!body_field_) reject("no body on its state: contact is that of a body's surface");
    for (const scene::Mapping* mapping : node().root().all<scene::Mapping>())
      if (mapping->output() == state_) reject("its state follows another one: must be one that an integrator moves");
    integrator_ = node().nearest<scene::OdeSolver>();
    require_implicit_euler(*this, integrator_, "in its node or above");
    instrument_.emplace(accepted(*this, [&] { return parts::Instrument(options(), *body_field_->body()); }));
    shape_ = parts::shape_of(instrument_->options());
    accepted(*this,
             [&] { instrument_->look_at_start(instrument_->pose_at(node().clock().time), state_->positions()); });
    pass_on(*this, instrument_->take_warnings());
  }

  void refresh(std::span<const std::string_view>) override {
    accepted(*this, [&] { instrument_->set_options(options()); });
    shape_ = parts::shape_of(instrument_->options());
    pass_on(*this, instrument_->take_warnings());
  }

  void begin_step() override {
    const scene::Clock& clock = node().clock();
    const double rayleigh_stiffness = integrator_->real("rayleighStiffness");
    accepted(*this, [&] {
      instrument_->begin_step(clock.time, clock.dt, rayleigh_stiffness, state_->positions(), state_->velocities());
    });
    pass_on(*this, instrument_->take_warnings());
  }
  void end_step(double) override {
    instrument_->end_step(state_->positions());
    pass_on(*this, instrument_->take_warnings());
  }
  void reset() override { instrument_->reset(); }
  void serialize(Archive& archive) override { instrument_->serialize(archive); }

  void add_force(double, ConstPoints x, ConstPoints v, Points f) override { instrument_->add_force(x, v, f); }
  void add_load(double, ConstPoints x, ConstPoints v, Points f) const override {
    instrument_->contact().terms().add_force(x, v, f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    instrument_->contact().terms().add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    instrument_->contact().terms().add_stiffness_blocks(factor, A);
  }
  void add_damping_product(double factor, ConstPoints dx, Points df) const override {
    instrument_->contact().terms().add_damping_product(factor, dx, df);
  }
  void add_damping_blocks(double factor, BlockMatrix& A) const override {
    instrument_->contact().terms().add_damping_blocks(factor, A);
  }
  bool is_in_matrix() const override { return !instrument_->contact().terms().empty(); }
  double rayleigh_stiffness() const override { return instrument_->rayleigh_stiffness(); }
  bool is_one_sided() const override { return true; }
  bool release(ConstPoints x_end, ConstPoints v_end) override { return instrument_->contact().release(x_end, v_end); }

  std::optional<Vec3> place(double time) const override { return instrument_->pose_at(time).position; }
  std::optional<scene::ContactEnergy> contact_energy() const override {
    const InstrumentContact& contact = instrument_->contact();
    return scene::ContactEnergy{contact.work(), contact.energy(), contact.friction_loss()};
  }
  std::vector<Triangle> shape_triangles() const override { return shape_.triangles; }
  PointArray shape_points(double time) const override { return shape_.at(instrument_->pose_at(time)); }

  void provide(scene::Data& output) override {
    if (!instrument_) return;
    const InstrumentContact& contact = instrument_->contact();
    const std::string_view name = output.attribute().name;
    const auto set_vector = [&](const Vec3& vector) { output.set(std::vector<double>(vector.begin(), vector.end())); };
    if (name == "force") set_vector(contact.force());
    if (name == "torque") set_vector(contact.torque());
    if (name == "depth") output.set(std::vector<double>{contact.depth()});
    if (name == "touching") output.set(std::vector<double>{1.0 * contact.num_touching()});
    if (name == "slipping") output.set(std::vector<double>{1.0 * contact.num_slipping()});
  }

 private:
  parts::InstrumentOptions options() { return read_options<parts::InstrumentOptions>(*this); }

  scene::MechanicalState* state_ = nullptr;
  scene::ForceField* body_field_ = nullptr;  // that has the body
  scene::OdeSolver* integrator_ = nullptr;
  std::optional<parts::Instrument> instrument_;
  parts::InstrumentShape shape_;
};

}  // namespace

void add_contact(scene::Factory& factory) {
  factory.add<InstrumentContactForceField>(attributes::kInstrumentContactForceField);
}

}  // namespace hexaplast::components
