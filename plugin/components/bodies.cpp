// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <limits>
#include <optional>

#include "attributes/hexaplast.hpp"
#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/base/memory.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/filling.hpp"
#include "hexaplast/mesh/quality.hpp"
#include "hexaplast/survey.hpp"
#include "scene/potential.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();  // a limit that is not given

/// The enumerator that belongs to a word of the attribute table.
template <class Enum>
Enum chosen(const std::string& word, std::initializer_list<std::pair<std::string_view, Enum>> words) {
  for (const auto& [name, value] : words)
    if (name == word) return value;
  return words.begin()->second;  // the table admits no other word
}

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
  bool to_kernels(double factor, KernelSystem& system) const override {
    body_->to_kernels(factor, system);
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
  virtual Material common_material() { return {}; }
  virtual std::vector<double> yield_stresses(std::size_t /*num_elements*/) { return {kNever}; }
  virtual Settings given_settings() { return {}; }

  const std::vector<double>& one_or_per_element(std::string_view name, std::size_t num_elements) {
    const std::vector<double>& values = reals(name);
    if (values.size() != 1 && values.size() != num_elements)
      reject(name, fmt::format("{} values given, must be one or {} (one per hexahedron)", values.size(), num_elements));
    return values;
  }

 private:
  /// Tells the scene which hexahedra have gone since it was told last.
  void announce() {
    const std::span<const int> gone = body_->removed().subspan(num_announced_);
    num_announced_ += gone.size();
    if (!gone.empty()) scene::announce_removed(*this, gone);
  }

  /// One for all hexahedra, or one for each.
  std::vector<Material> given_materials(std::size_t num_elements) {
    const std::span<const double> fill = topology_->fill();
    const std::vector<double>&young = one_or_per_element("youngModulus", num_elements),
          &poisson = one_or_per_element("poissonRatio", num_elements);
    const std::vector<double> yield = yield_stresses(num_elements);
    std::vector<Material> materials(
        std::max({young.size(), poisson.size(), yield.size(), fill.empty() ? 1 : fill.size()}), common_material());
    for (std::size_t e = 0; e < materials.size(); ++e) {
      materials[e].young_modulus = young[young.size() == 1 ? 0 : e];
      materials[e].poisson_ratio = poisson[poisson.size() == 1 ? 0 : e];
      materials[e].yield_stress = yield[yield.size() == 1 ? 0 : e];
      if (!fill.empty()) materials[e] = filled(materials[e], fill[e]);
    }
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

 private:
  Material common_material() override {
    Material common;
    common.flow_rate = real("plasticFlowRate");
    common.rotation_yield = real("rotationYield");
    common.rotation_flow_rate = real("rotationFlowRate");
    common.hardening = real("hardening");
    common.fracture_stress = real_if_given("fractureStress").value_or(kNever);
    common.fracture_stretch = real_if_given("fractureStretch").value_or(kNever);
    return common;
  }

  std::vector<double> yield_stresses(std::size_t num_elements) override {
    if (!is_given("yieldStress")) return {kNever};
    return one_or_per_element("yieldStress", num_elements);
  }

  Settings given_settings() override {
    Settings settings;
    settings.gradient = chosen<GradientScheme>(text("gradient"), {{"blended", GradientScheme::kBlended},
                                                                  {"vertex", GradientScheme::kVertex},
                                                                  {"centre", GradientScheme::kCentre}});
    settings.yield_norm = chosen<YieldNorm>(
        text("yieldNorm"),
        {{"vonMises", YieldNorm::kVonMises}, {"frobenius", YieldNorm::kFrobenius}, {"spectral", YieldNorm::kSpectral}});
    settings.rotation_plasticity =
        chosen<RotationPlasticity>(text("rotationPlasticity"), {{"objective", RotationPlasticity::kObjective},
                                                                {"vertex", RotationPlasticity::kVertex},
                                                                {"centre", RotationPlasticity::kCentre},
                                                                {"none", RotationPlasticity::kNone}});
    settings.rotation_frame = chosen<RotationFrame>(
        text("rotationFrame"), {{"bestFit", RotationFrame::kBestFit}, {"world", RotationFrame::kWorld}});
    settings.averaging =
        chosen<AveragingMethod>(text("averaging"), {{"gaussNewton", AveragingMethod::kGaussNewton},
                                                    {"gaussNewtonIsolated", AveragingMethod::kGaussNewtonIsolated},
                                                    {"localGlobal", AveragingMethod::kLocalGlobal},
                                                    {"jacobi", AveragingMethod::kJacobi}});
    settings.averaging_steps = integer("averagingSteps");
    settings.averaging_tolerance = real("averagingTolerance");
    settings.precision =
        chosen<Precision>(text("precision"), {{"double", Precision::kDouble}, {"mixed", Precision::kMixed}});
    settings.volume_restitution = real("volumeRestitution");
    settings.inversion_threshold = real("inversionThreshold");
    return settings;
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
