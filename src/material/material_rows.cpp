// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <iterator>
#include <numbers>

#include "hexaplast/base/error.hpp"
#include "hexaplast/material/rows.hpp"

namespace hexaplast {

namespace {

constexpr Row<Material> kMaterialRows[] = {
    {.member = "young_modulus",
     .name = "youngModulus",
     .group = kElasticity,
     .unit = "Pa",
     .range = {.min = 0, .exclusive_min = true},
     .may_vary = true,
     .help = "Young's modulus.",
     .at = kMember<&Material::young_modulus>},
    {.member = "poisson_ratio",
     .name = "poissonRatio",
     .group = kElasticity,
     .range = {.min = 0, .max = 0.5, .exclusive_max = true},
     .may_vary = true,
     .help = "Poisson's ratio.",
     .at = kMember<&Material::poisson_ratio>},
    {.member = "yield_stress",
     .name = "yieldStress",
     .group = kYield,
     .unit = "Pa",
     .range = {.min = 0},
     .may_vary = true,
     .help = "Norm of the stress at which plastic flow begins. Without it the body never yields.",
     .at = kMember<&Material::yield_stress>},
    {.member = "flow_rate",
     .name = "plasticFlowRate",
     .group = kFlow,
     .unit = "1/s",
     .range = {.min = 0},
     .per_step = {.max = kLargestFlowPerStep},
     .recommended_per_step = kRecommendedFlowPerStep,
     .help = "Fraction of the stretch above yield that becomes permanent per second. Times dt: at most 1; at most 0.05 "
             "is recommended.",
     .at = kMember<&Material::flow_rate>},
    {.member = "rotation_yield",
     .name = "rotationYield",
     .group = kFlow,
     .unit = "rad",
     .range = {.min = 0, .max = std::numbers::pi},
     .help = "Angle between a corner and its hexahedron at which rotation begins to flow. Scale it with the size of "
             "the hexahedra.",
     .at = kMember<&Material::rotation_yield>},
    {.member = "rotation_flow_rate",
     .name = "rotationFlowRate",
     .group = kFlow,
     .unit = "1/s",
     .range = {.min = 0},
     .per_step = {.max = kLargestFlowPerStep},
     .recommended_per_step = kRecommendedFlowPerStep,
     .help =
         "Fraction of the rotation above rotationYield that becomes permanent per second, for restShape=\"joined\". "
         "Limits as for plasticFlowRate.",
     .at = kMember<&Material::rotation_flow_rate>},
    {.member = "hardening",
     .name = "hardening",
     .group = kHardening,
     .range = {.max = 1e6},  // thresholds stay finite: an infinite one never yields
     .help = "Growth of yieldStress and rotationYield with the flow; negative values soften, down to 0.",
     .at = kMember<&Material::hardening>},
    {.member = "fracture_stress",
     .name = "fractureStress",
     .group = kFracture,
     .unit = "Pa",
     .range = {.min = 0},
     .help =
         "A hexahedron breaks (fracture) when hardening raises its yield stress above this value at a corner. Needs "
         "plasticFlowRate, hardening, and a yieldStress that is not larger; of values per hexahedron some may be "
         "larger: these tear as soon as they flow. Without it nothing tears by stress.",
     .at = kMember<&Material::fracture_stress>},
    {.member = "fracture_stretch",
     .name = "fractureStretch",
     .group = kFracture,
     .range = {.min = 1, .exclusive_min = true},
     .help =
         "A hexahedron breaks (fracture) when the largest principal plastic stretch at a corner exceeds this value. "
         "Without it nothing tears by stretch.",
     .at = kMember<&Material::fracture_stretch>},
    {.member = "fracture_energy",
     .name = "fractureEnergy",
     .group = kFracture,
     .unit = "J/m^2",
     .range = {.min = 0},
     .help = "With fracture=\"face\", what a crack takes per area: a face at its front opens only where at least this "
             "much becomes free. With 0 the load at which a crack grows depends on the mesh.",
     .at = kMember<&Material::fracture_energy>},
};
static_assert(std::size(kMaterialRows) == num_members<Material>(), "a member has no row");

}  // namespace

std::span<const Row<Material>> material_rows() { return kMaterialRows; }

std::string_view called(std::string_view member, Names names) {
  if (const auto* row = find_row(material_rows(), member, Names::kMembers)) return row->called(names);
  if (const auto* row = find_row(settings_rows(), member, Names::kMembers)) return row->called(names);
  throw InputError(fmt::format("{} is no member of Material or Settings", member));
}

}  // namespace hexaplast
