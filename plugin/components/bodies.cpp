// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "attributes/hexaplast.hpp"
#include "components/body_field.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "components/part_force.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "loaded_body.hpp"
#include "parts/hexahedral_body.hpp"
#include "parts/material_region.hpp"
#include "plastic/fracture.hpp"
#include "scene/interfaces.hpp"
#include "scene/region.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {
namespace {

class MaterialRegion final : public scene::MaterialRegion, public scene::Changeable {
 public:
  MaterialRegion() : scene::MaterialRegion(attributes::kMaterialRegion) {}

  /// The regions of a body, in the order of the scene.
  static std::vector<MaterialRegion*> all_of(const BodyField& body) {
    std::vector<MaterialRegion*> regions = body.node().root().all<MaterialRegion>();
    std::erase_if(regions, [&](MaterialRegion* region) { return find_body(*region) != &body; });
    return regions;
  }

  /// What it gives to its body, at present, whether its init is done or not: bodies ask in their own. Rejects the scene
  /// where it cannot be.
  const parts::MaterialRegion& values(const std::vector<Hexahedron>& of_body) {
    was_asked_ = true;
    const auto numbers = [&](std::string_view attribute) -> std::optional<std::vector<int>> {
      if (!is_given(attribute)) return std::nullopt;
      return indices(attribute, std::numeric_limits<int>::max());
    };
    const auto given = [&](const Row<Material>& row) { return values_of(*this, row); };
    return present_ = accepted(*this, [&] {
             std::vector<int> hexahedra = parts::region_hexahedra(numbers("hexahedra"), numbers("indices"), of_body);
             return parts::material_region(given, std::move(hexahedra), node().clock().dt);
           });
  }

  void init() override { needed_body(*this); }
  // What a body has not asked for, because it has failed before, is wrong all the same.
  void bwd_init() override {
    if (const std::vector<Hexahedron>* of_body = find_body(*this)->hexahedra(); of_body && !was_asked_)
      values(*of_body);
    if (present_.values.empty() && find_body(*this)->stage() == Stage::kReady)
      remark(scene::Severity::kWarning, {}, "gives its hexahedra no value: it has no effect");
  }
  // The body takes what all of its regions give.
  void refresh(std::span<const std::string_view> changed) override { find_body(*this)->refresh(changed); }

  std::span<const int> hexahedra() const override { return present_.hexahedra; }
  const scene::ForceField* field() override { return find_body(*this); }

 private:
  bool was_asked_ = false;
  parts::MaterialRegion present_;
};

/// A body as a force field.
class HexahedronElastoplasticFEMForceField final : public ElasticForces<BodyField>,
                                                   public scene::Stateful,
                                                   public scene::Potential {
 public:
  HexahedronElastoplasticFEMForceField() : ElasticForces(attributes::kHexahedronElastoplasticFEMForceField) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    topology_ = &linked<scene::Topology>("topology");
    hexahedra_ = &hexahedra_on(*this, *topology_, state_->num_nodes());
    part_.emplace(accepted(*this, [&] {
      return parts::HexahedralBody(state_->rest_positions(), *hexahedra_, options(), node().clock().dt);
    }));
    elastic = &part_->body();
    pass_on(*this, part_->take_warnings());
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  void bwd_init() override { require_followers(elastic->materials(), elastic->settings()); }

  // Once more, when all that stands behind it is there.
  void begin_step() override {
    if (!std::exchange(has_asked_, true)) require_followers(elastic->materials(), elastic->settings());
  }

  // The material may change during a run: what flowed stays.
  void refresh(std::span<const std::string_view>) override {
    announce_change();
    accepted(*this, [&] {
      const parts::HexahedralBodyOptions given = options();
      require_followers(given.materials, given.settings);
      part_->set_options(given, node().clock().dt);
    });
    pass_on(*this, part_->take_warnings());
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  bool may_change(std::string_view attribute) const override {
    return attribute != "device" &&
           std::ranges::none_of(settings_rows(), [&](const auto& row) { return row.name == attribute; });
  }

  void end_step(double dt) override {
    part_->end_step(state_->positions(), dt);
    announce();
  }
  void reset() override {
    const bool was_split = elastic->copies().is_split();
    part_->reset();
    if (was_split) scene::announce_nodes(*this, {});
  }
  void serialize(Archive& archive) override {
    const bool was_split = elastic->copies().is_split();
    part_->serialize(archive);
    if (archive.reads() && (was_split || elastic->copies().is_split())) scene::announce_nodes(*this, {});
  }

  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }
  const std::vector<Hexahedron>* hexahedra() const override { return hexahedra_; }
  const Body* body() const override { return elastic; }
  const FlowReport* flow_report() const override { return part_ ? &part_->report() : nullptr; }
  void remove_elements(std::span<const int> elements) override {
    announce_change();
    part_->remove(elements);
    announce();
  }

  void open(std::span<const int> joints, std::span<const double> crossings) override {
    scene::require_followers(*this);
    announce_change();
    const std::vector<int> split_from = part_->open(joints, crossings);
    if (!split_from.empty()) scene::announce_nodes(*this, split_from);
  }

  double potential_energy(double, ConstPoints x) const override { return elastic->energy(x); }

  void provide(scene::Data& output) override {
    if (!body()) return;
    parts::HexahedralBody::outputs([&](std::string_view name, const auto& of) {
      if (name == output.attribute().name) output.set(shown(of(*body(), state_->positions())));
    });
  }

 private:
  /// What cannot follow a body that may tear refuses before it does.
  void require_followers(const std::vector<Material>& materials, const Settings& settings) {
    if (may_tear(materials, settings)) scene::require_followers(*this);
  }

  void announce_change() {
    if (auto* integrator = node().nearest<scene::OdeSolver>()) integrator->body_changes();
  }

  /// Tells the scene which hexahedra have gone since it was told last.
  void announce() {
    if (const std::span<const int> gone = part_->take_removed(); !gone.empty()) scene::announce_removed(*this, gone);
  }

  parts::HexahedralBodyOptions options() {
    std::vector<parts::MaterialRegion> regions;
    for (MaterialRegion* region : MaterialRegion::all_of(*this)) regions.push_back(region->values(*hexahedra_));
    return parts::body_options([this](const auto& row) { return values_of(*this, row); }, text("device"),
                               hexahedra_->size(), topology_->fill(), regions);
  }

  scene::MechanicalState* state_ = nullptr;
  scene::Topology* topology_ = nullptr;
  const std::vector<Hexahedron>* hexahedra_ = nullptr;
  std::optional<parts::HexahedralBody> part_;
  double rayleigh_stiffness_ = 0;
  bool has_asked_ = false;  // in a step
};

}  // namespace

void add_bodies(scene::Factory& factory) {
  factory.add<HexahedronElastoplasticFEMForceField>(attributes::kHexahedronElastoplasticFEMForceField);
  factory.add<MaterialRegion>(attributes::kMaterialRegion);
}

}  // namespace hexaplast::components
