// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <optional>

#include "attributes/hexaplast.hpp"
#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/base/memory.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/filling.hpp"
#include "hexaplast/material/rows.hpp"
#include "hexaplast/mesh/quality.hpp"
#include "hexaplast/survey.hpp"
#include "scene/potential.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {
namespace {

/// A body as a force field. What it does not say otherwise is elastic.
class HexahedronField : public scene::ForceField, public scene::Potential {
 public:
  using ForceField::ForceField;

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    topology_ = &linked<scene::Topology>("topology");
    const std::vector<Hexahedron>& hexahedra = hexahedra_on(*this, *topology_, state_->num_nodes());
    const Settings settings = given_settings();
    std::vector<Material> materials = given_materials(hexahedra.size());
    require_memory(static_cast<double>(hexahedra.size()), bytes_per_hexahedron(materials, settings));
    body_.emplace(HexMesh(state_->rest_positions(), hexahedra), std::move(materials), settings);
    for (const std::string& advice : check_shapes(quality(body_->mesh())))
      remark(scene::Severity::kWarning, {}, advice);
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  // The material may change during a run: what flowed stays.
  void refresh() override {
    if (!(given_settings() == body_->settings()))
      reject("only youngModulus, poissonRatio, yieldStress, the rates, limits and damping may change during a run");
    body_->set_materials(given_materials(static_cast<std::size_t>(body_->mesh().num_elements())));
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  void reset() override {
    body_->reset();
    report_ = {};
    num_announced_ = 0;
  }

  void serialize(Archive& archive) override {
    body_->serialize(archive);
    archive(report_.yielded, report_.inverted, report_.guarded, report_.repaired, report_.removed,
            report_.worst_volume_error, report_.averaging.skipped, report_.averaging.fell_back,
            report_.averaging.iterations, report_.averaging.residual, report_.averaging.converged);
    num_announced_ = body_->removed().size();
  }

  void add_force(double, ConstPoints x, ConstPoints, Points f) override {
    body_->linearize(x);
    body_->add_force(f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    body_->add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override { body_->add_stiffness_blocks(factor, A); }
  bool describe(double factor, MatrixFreeSystem& system) const override {
    body_->describe(factor, system);
    return true;
  }
  double potential_energy(double, ConstPoints x) const override { return body_->energy(x); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  void end_step(double dt) override {
    if (dt != dt_ && body_->can_flow()) check_time_step(body_->materials(), body_->settings(), dt, Names::kScenes);
    dt_ = dt;
    report_ = body_->flow(state_->positions(), dt);
    announce();
  }

  const Body* body() const override { return body_ ? &*body_ : nullptr; }
  const FlowReport* flow_report() const override { return &report_; }
  void remove_elements(std::span<const int> elements) override {
    body_->remove(elements);
    announce();
  }

 protected:
  ConstPoints positions() const { return state_->positions(); }

 private:
  /// Tells the scene which hexahedra have gone since it was told last.
  void announce() {
    const std::span<const int> gone = body_->removed().subspan(num_announced_);
    num_announced_ += gone.size();
    if (!gone.empty()) scene::announce_removed(*this, gone);
  }

  /// The number of a member; none where the component has no such attribute, or no value for it.
  template <class Options>
  std::optional<double> given(const Row<Options>& row) {
    if (!find_data(row.name)) return std::nullopt;
    switch (row.at.type) {
      case MemberType::kWord:
        return place_of_word(row, text(row.name));
      case MemberType::kInteger:
        return integer(row.name);
      case MemberType::kReal:
        break;
    }
    return real_if_given(row.name);
  }

  Settings given_settings() {
    Settings settings;
    for (const Row<Settings>& row : settings_rows())
      if (const auto value = given(row)) row.at.set(settings, *value);
    return settings;
  }

  /// The values of a member, one or one per hexahedron; none as above.
  std::vector<double> given_values(const Row<Material>& row, std::size_t num_elements) {
    if (!row.may_vary) {
      const auto value = given(row);
      return value ? std::vector{*value} : std::vector<double>();
    }
    const scene::Data* data = find_data(row.name);
    if (!data || (!data->is_given() && data->attribute().initial.empty())) return {};
    const std::vector<double>& values = reals(row.name);
    if (values.size() != 1 && values.size() != num_elements)
      reject(row.name,
             fmt::format("{} values given, must be one or {} (one per hexahedron)", values.size(), num_elements));
    return values;
  }

  /// One for all hexahedra, or one for each.
  std::vector<Material> given_materials(std::size_t num_elements) {
    const std::span<const double> fill = topology_->fill();
    std::vector<Material> materials(fill.empty() ? 1 : fill.size());
    for (const Row<Material>& row : material_rows()) {
      const std::vector<double> values = given_values(row, num_elements);
      if (values.empty()) continue;
      if (values.size() > materials.size()) materials.resize(values.size(), Material(materials.front()));
      for (std::size_t e = 0; e < materials.size(); ++e) row.at.set(materials[e], values[values.size() == 1 ? 0 : e]);
    }
    if (!fill.empty())
      for (std::size_t e = 0; e < materials.size(); ++e) materials[e] = filled(materials[e], fill[e]);
    validate(materials, Names::kScenes);
    dt_ = node().clock().dt;
    for (const std::string& advice : check_time_step(materials, given_settings(), dt_, Names::kScenes))
      remark(scene::Severity::kWarning, {}, advice);
    for (const std::string& advice : fracture_advice(materials, Names::kScenes))
      remark(scene::Severity::kWarning, {}, advice);
    return materials;
  }

  scene::MechanicalState* state_ = nullptr;
  scene::Topology* topology_ = nullptr;
  std::optional<Body> body_;
  FlowReport report_;
  std::size_t num_announced_ = 0;  // of the hexahedra that have gone
  double rayleigh_stiffness_ = 0;
  double dt_ = 0;  // [s] that the rates were checked with
};

class HexahedronElastoplasticFEMForceField final : public HexahedronField {
 public:
  HexahedronElastoplasticFEMForceField() : HexahedronField(attributes::kHexahedronElastoplasticFEMForceField) {}

  void provide(scene::Data& output) override {
    if (!body()) return;
    const std::string_view name = output.attribute().name;
    if (name == "materialPositions") {
      output.set(flattened(body()->plastic_rest_positions()));
    } else if (name == "removed") {
      output.set(std::vector<std::int64_t>(body()->removed().begin(), body()->removed().end()));
    } else if (name == "plasticStrain" || name == "presentYieldStress" || name == "volumeRatio") {
      const ElementFields fields = body()->fields(positions());
      output.set(name == "plasticStrain"        ? fields.plastic_strain
                 : name == "presentYieldStress" ? fields.yield_stress
                                                : fields.volume_ratio);
    }
  }
};

class HexahedronFEMForceField final : public HexahedronField {
 public:
  HexahedronFEMForceField() : HexahedronField(attributes::kHexahedronFEMForceField) {}

  void init() override {
    HexahedronField::init();
    if (text("method") == "small")
      remark(scene::Severity::kWarning, "method", "is small: rotations are taken out here all the same");
  }
};

}  // namespace

void add_bodies(scene::Factory& factory) {
  factory.add<HexahedronElastoplasticFEMForceField>(attributes::kHexahedronElastoplasticFEMForceField);
  factory.add<HexahedronFEMForceField>(attributes::kHexahedronFEMForceField);
}

}  // namespace hexaplast::components
