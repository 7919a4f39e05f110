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
     .range = {.least = 0, .without_least = true},
     .may_vary = true,
     .help = "Young's modulus.",
     .at = kMember<&Material::young_modulus>},
    {.member = "poisson_ratio",
     .name = "poissonRatio",
     .group = kElasticity,
     .range = {.least = 0, .most = 0.5, .without_most = true},
     .may_vary = true,
     .help = "Poisson's ratio.",
     .at = kMember<&Material::poisson_ratio>},
    {.member = "yield_stress",
     .name = "yieldStress",
     .group = kYield,
     .unit = "Pa",
     .range = {.least = 0},
     .may_vary = true,
     .help = "Size of the stress at which plastic flow begins. Without it the body never yields.",
     .at = kMember<&Material::yield_stress>},
    {.member = "flow_rate",
     .name = "plasticFlowRate",
     .group = kFlow,
     .unit = "1/s",
     .range = {.least = 0},
     .per_step = {.most = kLargestFlowPerStep},
     .advised_per_step = kAdvisedFlowPerStep,
     .help = "Share of the stretch in excess of yield that becomes permanent per second. Times dt: at most 1, wisely "
             "at most 0.05.",
     .at = kMember<&Material::flow_rate>},
    {.member = "rotation_yield",
     .name = "rotationYield",
     .group = kFlow,
     .unit = "rad",
     .range = {.least = 0, .most = std::numbers::pi},
     .help = "Angle between a corner and its hexahedron at which rotation begins to flow. Scale it with the size of "
             "the hexahedra.",
     .at = kMember<&Material::rotation_yield>},
    {.member = "rotation_flow_rate",
     .name = "rotationFlowRate",
     .group = kFlow,
     .unit = "1/s",
     .range = {.least = 0},
     .per_step = {.most = kLargestFlowPerStep},
     .advised_per_step = kAdvisedFlowPerStep,
     .help = "Share of the rotation in excess of rotationYield that becomes permanent per second. Limits as for "
             "plasticFlowRate.",
     .at = kMember<&Material::rotation_flow_rate>},
    {.member = "hardening",
     .name = "hardening",
     .group = kHardening,
     .help = "Growth of yieldStress and rotationYield with the flow; negative values soften, down to 0.",
     .at = kMember<&Material::hardening>},
    {.member = "fracture_stress",
     .name = "fractureStress",
     .group = kFracture,
     .unit = "Pa",
     .range = {.least = 0},
     .help = "A hexahedron is removed in the step in which hardening carries its yield stress past this value at some "
             "corner: needs plasticFlowRate, hardening, and a yieldStress not above it. Where yieldStress has a value "
             "for each hexahedron some may lie above: these tear as soon as they flow. Without it nothing tears by "
             "stress.",
     .at = kMember<&Material::fracture_stress>},
    {.member = "fracture_stretch",
     .name = "fractureStretch",
     .group = kFracture,
     .range = {.least = 1, .without_least = true},
     .help = "A hexahedron is removed when the largest principal plastic stretch at some corner passes this value. "
             "Without it nothing tears by stretch.",
     .at = kMember<&Material::fracture_stretch>},
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
