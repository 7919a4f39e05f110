// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/tangential_load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "attributes/parts.hpp"
#include "parts/key_times.hpp"
#include "parts/option.hpp"
#include "solve/loads.hpp"

namespace hexaplast::parts {

TangentialLoad::TangentialLoad(TangentialLoadOptions options, int num_nodes) : options_(std::move(options)) {
  OptionRanges ranges(attributes::kTangentialForceField, options_);
  ranges.collect([&] { check_nodes("indices", options_.indices, num_nodes); });
  if (ranges.accepts("group_size") && options_.indices.size() % static_cast<std::size_t>(options_.group_size) != 0)
    ranges.add(
        {"indices", fmt::format("{} nodes do not form groups of {}", options_.indices.size(), options_.group_size)});
  if (options_.axis.isZero(0)) ranges.add({"axis", "is zero, must have a direction"});
  ranges.collect([&] { check_key_times("times", options_.times, "forces", options_.forces.size()); });
  ranges.throw_all();
}

void TangentialLoad::add_force(double time, ConstPoints x, Points f) const {
  const double first = options_.times.front();
  if (!has_come(first, time)) return;
  const KeyPhase phase = phase_at(options_.times, std::max(time, first));
  add_tangential_forces(options_.indices, options_.group_size, options_.axis, options_.centre,
                        interpolate(phase, options_.forces), x, f);
}

}  // namespace hexaplast::parts
