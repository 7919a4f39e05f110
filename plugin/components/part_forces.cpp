// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/components.hpp"
#include "components/part_force.hpp"
#include "parts/grasp.hpp"
#include "parts/instrument.hpp"
#include "parts/instrument_shape.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"
#include "scene/potential.hpp"
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

}  // namespace

void add_part_forces(scene::Factory& factory) {
  add_force<parts::TangentialLoad>(factory);
  factory.add<GripField>(parts::Grasp::description());
  factory.add<InstrumentField>(parts::Instrument::description());
  add_force<parts::Tissues>(factory);
}

}  // namespace hexaplast::components
