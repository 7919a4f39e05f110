// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/tangential_load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "attributes/parts.hpp"
#include "parts/key_times.hpp"
#include "parts/option.hpp"
#include "solve/loads.hpp"

namespace hexaplast::parts {

const attributes::Description& TangentialLoad::description() { return attributes::kTangentialForceField; }

TangentialLoad::TangentialLoad(TangentialLoadOptions options, const Surroundings& around)
    : num_initial_(around.num_nodes[0]) {
  set_options(std::move(options));
}

void TangentialLoad::set_options(TangentialLoadOptions options) {
  OptionRanges ranges(description(), options);
  ranges.collect([&] { check_nodes("indices", options.indices, num_initial_); });
  if (ranges.accepts("group_size") && options.indices.size() % static_cast<std::size_t>(options.group_size) != 0)
    ranges.add(
        {"indices", fmt::format("{} nodes do not form groups of {}", options.indices.size(), options.group_size)});
  if (options.axis.isZero(0)) ranges.add({"axis", "is zero, must have a direction"});
  ranges.collect([&] { check_key_times("times", options.times, "forces", options.forces.size()); });
  ranges.throw_all();
  options_ = std::move(options);
  spread_nodes();
}

void TangentialLoad::nodes_changed(int /*state*/, const NodeCopies& copies, std::span<const int> /*split_from*/) {
  copies_ = &copies;
  spread_nodes();
}

void TangentialLoad::spread_nodes() {
  spread_ = spread(options_.indices, copies_);
  loaded_ = spread_.nodes;
  std::ranges::sort(loaded_);
  loaded_.erase(std::unique(loaded_.begin(), loaded_.end()), loaded_.end());
}

void TangentialLoad::add_load(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& /*v*/,
                              Pair<Points> f) const {
  const double first = options_.times.front();
  if (!has_come(first, time)) return;
  const KeyPhase phase = phase_at(options_.times, std::max(time, first));
  const double force = interpolate(phase, options_.forces);
  if (!copies_ || !copies_->is_split())
    return add_tangential_forces(options_.indices, options_.group_size, options_.axis, options_.centre, force, x.first,
                                 f.first);
  // a node that has split lies where its copies do in the mean
  const auto count = std::ssize(options_.indices);
  PointArray places = PointArray::Zero(count, 3), forces = places;
  for (std::size_t i = 0; i < spread_.nodes.size(); ++i)
    places.row(spread_.entries[i]) += spread_.shares[i] * x.first.row(spread_.nodes[i]);
  std::vector<int> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  add_tangential_forces(all, options_.group_size, options_.axis, options_.centre, force, places, forces);
  for (std::size_t i = 0; i < spread_.nodes.size(); ++i)
    f.first.row(spread_.nodes[i]) += spread_.shares[i] * forces.row(spread_.entries[i]);
}

}  // namespace hexaplast::parts
