// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/quantity.hpp"

#include <algorithm>

namespace hexaplast::output {

std::optional<Quantity> quantity_of(std::string_view word) {
  const auto found = std::ranges::find(kQuantities, word, &QuantityEntry::word);
  return found == kQuantities.end() ? std::nullopt : std::optional(found->quantity);
}

std::vector<double> values_of(Quantity quantity, const Body& body, ConstPoints positions, ConstPoints velocities) {
  if (quantity == Quantity::kSpeed) return speeds(velocities);
  ElementFields fields = body.fields(positions);
  switch (quantity) {
    case Quantity::kStress:
      return std::move(fields.stress_norm);
    case Quantity::kYield:
      return std::move(fields.yield_stress);
    case Quantity::kVolumeRatio:
      return std::move(fields.volume_ratio);
    default:
      return std::move(fields.plastic_strain);
  }
}

std::vector<double> speeds(ConstPoints velocities) {
  std::vector<double> lengths(static_cast<std::size_t>(velocities.rows()));
  for (std::size_t n = 0; n < lengths.size(); ++n) lengths[n] = velocities.row(static_cast<Eigen::Index>(n)).norm();
  return lengths;
}

}  // namespace hexaplast::output
