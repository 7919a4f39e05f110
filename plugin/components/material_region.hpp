// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "components/body_field.hpp"
#include "parts/material_region.hpp"
#include "scene/region.hpp"

namespace hexaplast::components {

class MaterialRegion final : public scene::MaterialRegion, public scene::Changeable {
 public:
  MaterialRegion();

  /// The regions of a body, in the order of the scene.
  static std::vector<MaterialRegion*> all_of(const BodyField& body);

  /// What it gives to its body, at present, whether its init is done or not: bodies ask in their own. Rejects the scene
  /// where it cannot be.
  const parts::MaterialRegion& values(const std::vector<Hexahedron>& of_body);

  void init() override;
  void bwd_init() override;
  void refresh(std::span<const std::string_view> changed) override;

  std::span<const int> hexahedra() const override { return present_.hexahedra; }
  const scene::ForceField* field() override { return find_body(*this); }

 private:
  bool was_asked_ = false;
  parts::MaterialRegion present_;
};

}  // namespace hexaplast::components
