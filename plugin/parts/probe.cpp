// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/probe.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>

#include "parts/option.hpp"

namespace hexaplast::parts {

double Probe::component_of(const std::array<double, 3>& entry) const {
  if (width_ == 1) return entry[0];
  switch (options_.component) {
    case ProbeOptions::Component::kX:
      return entry[0];
    case ProbeOptions::Component::kY:
      return entry[1];
    case ProbeOptions::Component::kZ:
      return entry[2];
    case ProbeOptions::Component::kNorm:
      break;
  }
  return std::hypot(entry[0], entry[1], entry[2]);
}

void Probe::follow(const NodeCopies& copies) {
  if (first_.size() < 3 * static_cast<std::size_t>(copies.num_initial())) return;  // no entries of nodes
  std::vector<double> first;
  for (const int node : copies.initial())
    for (int axis = 0; axis < 3; ++axis) first.push_back(first_[static_cast<std::size_t>(3 * node + axis)]);
  first_ = std::move(first);
}

double Probe::read(std::span<const double> values, std::span<const unsigned char> alive) {
  using Statistic = ProbeOptions::Statistic;
  const int count = static_cast<int>(values.size()) / width_;
  if (count == 0) throw OptionError("value", "holds no number");
  if (values.size() != static_cast<std::size_t>(count) * width_)
    throw OptionError("value", fmt::format("holds {} numbers, must be {} for each entry", values.size(), width_));
  std::vector<int> entries;
  if (options_.indices) {
    entries = *options_.indices;
    if (entries.empty()) throw OptionError("indices", "holds none, must hold at least one of the entries");
  } else {
    entries.resize(static_cast<std::size_t>(count));
    std::iota(entries.begin(), entries.end(), 0);
  }
  for (const int entry : entries)
    if (entry < 0 || entry >= count)
      throw OptionError("indices", fmt::format("holds {}, must lie in [0, {})", entry, count));

  if (options_.change) {
    if (first_.empty()) first_.assign(values.begin(), values.end());
    if (first_.size() != values.size())
      throw OptionError("value", fmt::format("holds {} numbers, {} at first: there is no change of that", values.size(),
                                             first_.size()));
  }
  if (!alive.empty()) std::erase_if(entries, [&](int entry) { return alive[static_cast<std::size_t>(entry)] == 0; });
  if (entries.empty()) return 0;

  const auto entry_at = [&](int entry) {
    std::array<double, 3> numbers{};
    for (int i = 0; i < width_; ++i) {
      const std::size_t k =
          static_cast<std::size_t>(entry) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(i);
      numbers[static_cast<std::size_t>(i)] = options_.change ? values[k] - first_[k] : values[k];
    }
    return numbers;
  };
  if (options_.statistic == Statistic::kMin || options_.statistic == Statistic::kMax) {
    double found = component_of(entry_at(entries.front()));
    for (const int entry : entries) {
      const double value = component_of(entry_at(entry));
      found = options_.statistic == Statistic::kMin ? std::fmin(found, value) : std::fmax(found, value);
    }
    return found;
  }
  std::array<double, 3> sum{};
  for (const int entry : entries) {
    const std::array<double, 3> numbers = entry_at(entry);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += numbers[i];
  }
  if (options_.statistic == Statistic::kMean)
    for (double& component : sum) component /= static_cast<double>(entries.size());
  return component_of(sum);
}

}  // namespace hexaplast::parts
