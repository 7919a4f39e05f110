// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/trace.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "page/thinning.hpp"

namespace hexaplast::view {

void Trace::add(double at, double value) {
  points_.push_back({at, value});
  while (points_.front().at < at - span_) points_.pop_front();
}

void Trace::forget_after(double at) {
  while (!points_.empty() && points_.back().at > at) points_.pop_back();
}

void Trace::extend_range(double begin, double& min, double& max) const {
  for_each_since(begin, [&](double, double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  });
}

double Trace::quantile(double fraction) const {
  std::vector<double> values;
  for (const Point& point : points_) values.push_back(point.value);
  std::ranges::sort(values);
  return output::percentile(values, fraction);
}

void Traces::add(const Snapshot& snapshot) {
  const Sample& sample = snapshot.sample;
  if (!plastic_strain.empty() && sample.time < plastic_strain.latest_time()) {  // it went back
    for (Trace* trace : {&current_elongation, &plastic_elongation, &plastic_strain, &current_volume,
                         &plastic_rest_volume, &kinetic, &elastic, &dissipated})
      trace->forget_after(sample.time);
    for (Trace& trace : probes) trace.forget_after(sample.time);
    step_ms.forget_after(static_cast<double>(snapshot.step) - static_cast<double>(snapshot.step_ms.size()));
  }
  const double time = sample.time;
  current_elongation.add(time, 100 * sample.measures.current_elongation);
  plastic_strain.add(time, sample.greatest_plastic_strain);
  current_volume.add(time, 100 * (sample.measures.current_volume_ratio - 1));
  plastic_rest_volume.add(time, 100 * (sample.measures.plastic_rest_volume_ratio - 1));
  if (std::isfinite(sample.measures.plastic_elongation))  // it was found
    plastic_elongation.add(time, 100 * sample.measures.plastic_elongation);
  kinetic.add(time, sample.kinetic_energy);
  elastic.add(time, sample.elastic_energy);
  dissipated.add(time, sample.dissipated_energy);
  if (probes.size() < sample.probes.size()) probes.resize(sample.probes.size(), Trace(kSpan));
  for (std::size_t p = 0; p < sample.probes.size(); ++p) probes[p].add(time, sample.probes[p]);
  const auto first = snapshot.step - static_cast<long>(snapshot.step_ms.size());
  for (std::size_t k = 0; k < snapshot.step_ms.size(); ++k)
    step_ms.add(static_cast<double>(first) + static_cast<double>(k + 1), snapshot.step_ms[k]);
}

}  // namespace hexaplast::view
