// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "picture/bodies.hpp"
#include "picture/regions.hpp"

namespace hexaplast::output {

/// What a picture shows by colours.
enum class Quantity { kPlasticStrain, kStress, kYield, kVolumeRatio, kStrain, kSpeed, kRegion };

/// How a quantity is called, and where it is found.
struct QuantityEntry {
  Quantity quantity;
  std::string_view word;   ///< on the command line and in scenes
  std::string_view label;  ///< in pictures
  std::string_view unit;
  std::string_view array;  ///< in .vtu files
  bool of_nodes;           ///< one value per node, else per hexahedron
  bool from_zero;          ///< its scale begins at 0, else at the smallest value shown
};

inline constexpr std::array<QuantityEntry, 7> kQuantities{{
    {Quantity::kPlasticStrain, "plastic_strain", "plastic strain", "–", "plastic_strain", false, true},
    {Quantity::kStress, "stress", "stress norm", "Pa", "stress_norm", false, true},
    {Quantity::kYield, "yield", "yield stress", "Pa", "yield_stress", false, false},
    {Quantity::kVolumeRatio, "volume_ratio", "volume ratio", "–", "volume_ratio", false, false},
    {Quantity::kStrain, "strain", "strain", "–", "strain", false, true},
    {Quantity::kSpeed, "speed", "speed", "m/s", "velocity", true, true},
    {Quantity::kRegion, "region", "region", "–", "region", false, true},
}};

constexpr const QuantityEntry& entry_of(Quantity quantity) { return kQuantities[static_cast<std::size_t>(quantity)]; }

/// The quantity of a word; none where no quantity is called so.
std::optional<Quantity> quantity_of(std::string_view word);

/// The values that a quantity of hexahedra has among the fields of a body. Not of regions, which a body does not know.
const std::vector<double>& values_in(const ElementFields& fields, Quantity quantity);

/// Values of a body's present state, one per hexahedron or per node. A yield stress is infinite where there is none.
/// regions: which a body does not know; where there are none, all hexahedra have 0.
std::vector<double> values_of(Quantity quantity, const Bodies& bodies, ConstPoints positions, ConstPoints velocities,
                              const Regions& regions);

/// A number of three digits with a unit of the SI and the prefix that suits it: "312 mN". 0 has none.
std::string with_unit(double value, std::string_view unit);

/// Lengths [m/s] of velocities, one per node.
std::vector<double> speeds(ConstPoints velocities);

}  // namespace hexaplast::output
