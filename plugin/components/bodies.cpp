// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/hexaplast.hpp"
#include "components/components.hpp"
#include "components/part_body_field.hpp"
#include "hexaplast/body.hpp"
#include "scene/potential.hpp"

namespace hexaplast::components {
namespace {

/// A body as a force field.
class HexahedronElastoplasticFEMForceField final : public PartBodyField<parts::HexahedralBody>,
                                                   public scene::Potential {
 public:
  HexahedronElastoplasticFEMForceField() : PartBodyField(attributes::kHexahedronElastoplasticFEMForceField) {}

  void add_force(double, ConstPoints x, ConstPoints, Points f) override {
    part().body().linearize(x);
    part().body().add_force(f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    part().body().add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    part().body().add_stiffness_blocks(factor, A);
  }
  bool describe(double factor, MatrixFreeSystem& system) const override {
    part().body().describe(factor, system);
    return true;
  }
  double potential_energy(double, ConstPoints x) const override { return part().body().energy(x); }

  void provide(scene::Data& output) override {
    if (!body()) return;
    const std::string_view name = output.attribute().name;
    if (name == "plasticRestPositions") {
      output.set(flattened(body()->plastic_rest_positions()));
    } else if (name == "removed") {
      output.set(std::vector<std::int64_t>(body()->removed().begin(), body()->removed().end()));
    } else if (name == "plasticStrain") {
      output.set(plastic_strains(*body()));
    } else if (name == "presentYieldStress") {
      output.set(present_yield_stresses(*body()));
    } else if (name == "volumeRatio") {
      output.set(plastic_volume_ratios(*body()));
    } else if (name == "volume") {
      output.set(element_volumes(*body(), state().positions()));
    } else if (name == "plasticVolume") {
      output.set(element_volumes(*body(), body()->plastic_rest_positions()));
    }
  }

 private:
  parts::HexahedralBody make(parts::HexahedralBodyOptions options, double dt) override {
    return {state().rest_positions(), *hexahedra(), std::move(options), dt};
  }
};

}  // namespace

void add_bodies(scene::Factory& factory) {
  factory.add<HexahedronElastoplasticFEMForceField>(attributes::kHexahedronElastoplasticFEMForceField);
}

}  // namespace hexaplast::components
