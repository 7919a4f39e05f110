// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/trace.hpp"

#include <algorithm>

namespace hexaplast::view {

void Trace::add(double at, double value) {
  points_.push_back({at, value});
  while (points_.front().at < at - span_) points_.pop_front();
}

void Trace::extend_range(double begin, double& least, double& most) const {
  for_each_since(begin, [&](double, double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  });
}

double Trace::quantile(double share) const {
  if (points_.empty()) return 0;
  std::vector<double> values;
  for (const Point& point : points_) values.push_back(point.value);
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), rank, values.end());
  return *rank;
}

void Traces::add(const Snapshot& snapshot) {
  const Sample& sample = snapshot.sample;
  if (!plastic_strain.empty() && sample.time < plastic_strain.latest_time()) *this = {};  // it was reset
  const double time = sample.time;
  world_elongation.add(time, 100 * sample.measures.world_elongation);
  plastic_elongation.add(time, 100 * sample.measures.plastic_elongation);
  plastic_strain.add(time, sample.greatest_plastic_strain);
  world_volume.add(time, 100 * (sample.measures.world_volume_ratio - 1));
  material_volume.add(time, 100 * (sample.measures.material_volume_ratio - 1));
  kinetic.add(time, sample.kinetic_energy);
  elastic.add(time, sample.elastic_energy);
  dissipated.add(time, sample.dissipated_energy);
  const auto first = snapshot.step - static_cast<long>(snapshot.step_ms.size());
  for (std::size_t k = 0; k < snapshot.step_ms.size(); ++k)
    step_ms.add(static_cast<double>(first) + static_cast<double>(k + 1), snapshot.step_ms[k]);
}

}  // namespace hexaplast::view
