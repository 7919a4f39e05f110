// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/base/rows.hpp"
#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// One row per member, in the order of the members.
std::span<const Row<Material>> material_rows();
std::span<const Row<Settings>> settings_rows();

/// The groups of these rows, in the order in which hosts show them.
inline constexpr std::string_view kElasticity = "Elasticity", kYield = "Yield", kFlow = "Flow",
                                  kHardening = "Hardening", kVolume = "Volume", kFracture = "Fracture",
                                  kNumerics = "Numerics";
inline constexpr std::array kBodyGroups = {kElasticity, kYield, kFlow, kHardening, kVolume, kFracture, kNumerics};

/// What a member of either struct is called.
std::string_view called(std::string_view member, Names names);

}  // namespace hexaplast
