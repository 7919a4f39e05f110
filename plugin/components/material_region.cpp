// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/material_region.hpp"

#include <fmt/format.h>

#include <limits>

#include "attributes/hexaplast.hpp"
#include "components/components.hpp"
#include "components/part.hpp"

namespace hexaplast::components {
MaterialRegion::MaterialRegion() : scene::MaterialRegion(attributes::kMaterialRegion) {}

std::vector<MaterialRegion*> MaterialRegion::all_of(const BodyField& body) {
  std::vector<MaterialRegion*> regions = body.node().root().all<MaterialRegion>();
  std::erase_if(regions, [&](MaterialRegion* region) { return find_body(*region) != &body; });
  return regions;
}

const parts::MaterialRegion& MaterialRegion::values(const std::vector<Hexahedron>& of_body) {
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

void MaterialRegion::init() { needed_body(*this); }

// What a body has not asked for, because it has failed before, is wrong all the same.
void MaterialRegion::bwd_init() {
  if (const std::vector<Hexahedron>* of_body = find_body(*this)->hexahedra(); of_body && !was_asked_) values(*of_body);
  if (present_.values.empty() && find_body(*this)->stage() == Stage::kReady)
    remark(scene::Severity::kWarning, {}, "gives its hexahedra no value: it has no effect");
}

// The body takes what all of its regions give.
void MaterialRegion::refresh(std::span<const std::string_view> changed) { find_body(*this)->refresh(changed); }

void add_regions(scene::Factory& factory) { factory.add<MaterialRegion>(attributes::kMaterialRegion); }

}  // namespace hexaplast::components
