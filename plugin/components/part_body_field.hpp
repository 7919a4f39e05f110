// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>

#include "components/cells.hpp"
#include "components/material_region.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/hexahedral_body.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {

/// A body as a force field, made from a part: HexahedralBody, or one with its calls.
template <class Part>
class PartBodyField : public BodyField {
 public:
  using BodyField::BodyField;

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    topology_ = &linked<scene::Topology>("topology");
    hexahedra_ = &hexahedra_on(*this, *topology_, state_->num_nodes());
    part_.emplace(accepted(*this, [&] { return make(options(), node().clock().dt); }));
    pass_on(*this, part_->take_warnings());
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  // The material may change during a run: what flowed stays.
  void refresh() override {
    try {
      accepted(*this, [&] { part_->set_options(options(), node().clock().dt); });
    } catch (const InputError& error) {
      reject(error.what());
    }
    pass_on(*this, part_->take_warnings());
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  void end_step(double dt) override {
    part_->end_step(state_->positions(), dt);
    announce();
  }
  void reset() override { part_->reset(); }
  void serialize(Archive& archive) override { part_->serialize(archive); }

  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }
  const std::vector<Hexahedron>* hexahedra() const override { return hexahedra_; }
  const Body* body() const override { return part_ ? &part().body() : nullptr; }
  const FlowReport* flow_report() const override { return part_ ? &part_->report() : nullptr; }
  void remove_elements(std::span<const int> elements) override {
    part_->remove(elements);
    announce();
  }

 protected:
  virtual Part make(parts::HexahedralBodyOptions options, double dt) = 0;

  /// What no attribute gives.
  virtual Settings other_settings() const { return {}; }

  Part& part() { return *part_; }
  const Part& part() const { return *part_; }
  scene::Topology& topology() const { return *topology_; }
  scene::MechanicalState& state() const { return *state_; }

 private:
  /// Tells the scene which hexahedra have gone since it was told last.
  void announce() {
    if (const std::span<const int> gone = part_->take_removed(); !gone.empty()) scene::announce_removed(*this, gone);
  }

  parts::HexahedralBodyOptions options() {
    std::vector<parts::MaterialRegion> regions;
    for (MaterialRegion* region : MaterialRegion::all_of(*this)) regions.push_back(region->values(*hexahedra_));
    return parts::body_options([this](const auto& row) { return values_of(*this, row); }, hexahedra_->size(),
                               topology_->fill(), regions, other_settings());
  }

  scene::MechanicalState* state_ = nullptr;
  scene::Topology* topology_ = nullptr;
  const std::vector<Hexahedron>* hexahedra_ = nullptr;
  std::optional<Part> part_;
  double rayleigh_stiffness_ = 0;
};

}  // namespace hexaplast::components
