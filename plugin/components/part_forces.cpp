// SPDX-License-Identifier: LGPL-2.1-or-later
#include <optional>
#include <utility>

#include "components/body_field.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "components/part_force.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/blade.hpp"
#include "parts/grasp.hpp"
#include "parts/instrument.hpp"
#include "parts/instrument_shape.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"
#include "scene/interfaces.hpp"
#include "scene/scene.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

class GripField final : public PartForce<parts::Grasp>, public scene::Instrument, public scene::Potential {
 public:
  std::optional<Vec3> place(double time) const override {
    if (!part().is_closed()) return {};
    return part().tool_at(time);
  }
  Pose pose(double time) const override { return {.position = part().tool_at(time)}; }
  double potential_energy(double time, ConstPoints x) const override { return *part().potential_energy(time, x); }
};

class InstrumentField final : public PartForce<parts::Instrument>, public scene::Instrument {
 public:
  void bwd_init() override {
    PartForce::bwd_init();
    shape_ = parts::shape_of(part().options());
  }
  void refresh(std::span<const std::string_view> changed) override {
    PartForce::refresh(changed);
    shape_ = parts::shape_of(part().options());
  }

  std::optional<Vec3> place(double time) const override { return part().pose_at(time).position; }
  Pose pose(double time) const override { return part().pose_at(time); }
  std::optional<scene::ContactEnergy> contact_energy() const override {
    const InstrumentContact& contact = part().contact();
    return scene::ContactEnergy{contact.work(), contact.energy(), contact.friction_loss()};
  }
  std::vector<Triangle> shape_triangles() const override { return shape_.triangles; }
  PointArray shape_points(double time) const override { return shape_.at(part().pose_at(time)); }

 private:
  parts::InstrumentShape shape_;
};

class BladeController final : public scene::Blade, public scene::Changeable, public scene::Instrument {
 public:
  BladeController() : Blade(parts::Blade::description()) {}

  // Bodies may be declared later.
  void bwd_init() override {
    field_ = &needed_body(*this);
    if (!field_->body()) throw scene::DependencyFailure{};
    state_ = field_->node().nearest<scene::MechanicalState>();
    accepted(*this, [&] { part_.emplace(read_options<parts::BladeOptions>(*this), *field_->body()); });
    edge_ = parts::edge_of(part_->options());
    scene::require_followers(*field_);
  }

  void refresh(std::span<const std::string_view>) override {
    accepted(*this, [&] { part_->set_options(read_options<parts::BladeOptions>(*this)); });
    edge_ = parts::edge_of(part_->options());
  }

  void begin_step() override {
    if (!std::exchange(has_asked_, true)) scene::require_followers(*field_);  // what stands behind it is there by now
    const scene::Clock& clock = node().clock();
    part_->begin_step({.time = clock.time, .dt = clock.dt, .rayleigh_stiffness = 0}, state_->positions());
  }

  scene::ForceField& field() override { return *field_; }

  std::span<const int> joints() override {
    return accepted(*this, [&]() -> const std::vector<int>& { return part_->end_step(state_->positions()); });
  }

  std::span<const double> crossings() const override { return part_->crossings(); }

  std::optional<Vec3> place(double time) const override {
    return part_->options().active ? std::optional(part_->pose_at(time).position) : std::nullopt;
  }
  Pose pose(double time) const override { return part_->pose_at(time); }
  std::vector<Triangle> shape_triangles() const override { return edge_.triangles; }
  PointArray shape_points(double time) const override { return edge_.at(part_->pose_at(time)); }

 private:
  bool has_asked_ = false;  // in a step
  scene::ForceField* field_ = nullptr;
  scene::MechanicalState* state_ = nullptr;
  std::optional<parts::Blade> part_;
  parts::InstrumentShape edge_;
};

}  // namespace

void add_part_forces(scene::Factory& factory) {
  add_force<parts::TangentialLoad>(factory);
  factory.add<GripField>(parts::Grasp::description());
  factory.add<InstrumentField>(parts::Instrument::description());
  add_force<parts::Tissues>(factory);
  factory.add<BladeController>(parts::Blade::description());
}

}  // namespace hexaplast::components
