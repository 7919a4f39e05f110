// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hexaplast::output {

std::optional<Quantity> quantity_of(std::string_view word) {
  const auto found = std::ranges::find(kQuantities, word, &QuantityEntry::word);
  return found == kQuantities.end() ? std::nullopt : std::optional(found->quantity);
}

std::vector<double> values_of(Quantity quantity, const Bodies& bodies, ConstPoints positions, ConstPoints velocities,
                              const Regions& regions) {
  if (quantity == Quantity::kSpeed) return speeds(velocities);
  if (quantity == Quantity::kRegion) {
    std::vector<double> numbers(regions.of_hexahedra.begin(), regions.of_hexahedra.end());
    numbers.resize(static_cast<std::size_t>(bodies.mesh().num_elements()), 0);
    return numbers;
  }
  return values_in(bodies.fields(positions), quantity);
}

const std::vector<double>& values_in(const ElementFields& fields, Quantity quantity) {
  switch (quantity) {
    case Quantity::kStress:
      return fields.stress_norm;
    case Quantity::kYield:
      return fields.yield_stress;
    case Quantity::kVolumeRatio:
      return fields.volume_ratio;
    case Quantity::kStrain:
      return fields.strain;
    default:
      return fields.plastic_strain;
  }
}

std::string with_unit(double value, std::string_view unit) {
  static constexpr std::array<std::string_view, 7> kPrefixes{"n", "µ", "m", "", "k", "M", "G"};
  // of the number as it is written, so that 999.9 m becomes 1 k
  const double written = std::strtod(fmt::format("{:.2e}", value).c_str(), nullptr);
  const int thousands =
      value == 0 ? 0 : std::clamp(static_cast<int>(std::floor(std::log10(std::abs(written)) / 3)), -3, 3);
  return fmt::format("{:.3g} {}{}", written / std::pow(1000, thousands), kPrefixes[thousands + 3], unit);
}

std::vector<double> speeds(ConstPoints velocities) {
  std::vector<double> lengths(static_cast<std::size_t>(velocities.rows()));
  for (std::size_t n = 0; n < lengths.size(); ++n) lengths[n] = velocities.row(static_cast<Eigen::Index>(n)).norm();
  return lengths;
}

}  // namespace hexaplast::output
