// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/measures.hpp"

#include <limits>
#include <numbers>
#include <utility>

namespace hexaplast::output {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

}  // namespace

Measurement::Measurement(Bodies bodies) : bodies_(std::move(bodies)), ends_(end_sections(bodies_.mesh())) {}

Measures Measurement::measure(ConstPoints positions) const {
  Measures found = measure_current(positions);
  const PointArray& material = bodies_.plastic_rest_positions();
  found.plastic_elongation = elongation(ends_, material);
  found.plastic_twist_deg = twist(bodies_.mesh(), ends_, material) * kDegrees;
  return found;
}

Measures Measurement::measure_current(ConstPoints positions) const {
  Measures found;
  found.plastic_elongation = found.plastic_twist_deg = std::numeric_limits<double>::quiet_NaN();
  found.current_elongation = elongation(ends_, positions);
  found.current_twist_deg = twist(bodies_.mesh(), ends_, positions) * kDegrees;
  const double initial = bodies_.initial_volume();
  found.plastic_rest_volume_ratio = initial > 0 ? bodies_.plastic_volume() / initial : 0;
  found.current_volume_ratio = initial > 0 ? bodies_.volume(positions) / initial : 0;
  return found;
}

}  // namespace hexaplast::output
