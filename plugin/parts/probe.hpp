// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "hexaplast/mesh/node_copies.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// In scenes: Probe.
struct ProbeOptions {
  enum class Component { kX, kY, kZ, kNorm };
  enum class Statistic { kMean, kSum, kMin, kMax };

  std::optional<std::vector<int>> indices = {};  ///< of the entries that count; none: all
  Component component = Component::kNorm;        ///< of vectors
  Statistic statistic = Statistic::kMean;        ///< over the entries
  bool change = false;                           ///< since the first reading

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(indices);
    HEXAPLAST_OPTION(component);
    HEXAPLAST_OPTION(statistic);
    HEXAPLAST_OPTION(change);
  }
};

/// Makes one number of a list of numbers or vectors. Sum and mean are those of the vectors, of which the component is
/// taken then; min and max are those of the components.
class Probe {
 public:
  /// width: 1 for numbers, 3 for vectors.
  Probe(ProbeOptions options, int width) : width_(width), options_(std::move(options)) {}

  /// Other options; the first reading stays.
  void set_options(ProbeOptions options) { options_ = std::move(options); }

  /// Of vectors of initial nodes, which are those of their copies from now on: what had come at first was theirs.
  void follow(const NodeCopies& copies);

  /// alive: which entries count, as hexahedra that are not removed; empty: all. 0 where none of them does. Throws
  /// OptionError where an entry is not there, where there is none, for a part of a vector, and for a change of another
  /// number of entries.
  double read(std::span<const double> values, std::span<const unsigned char> alive = {});

 private:
  double component_of(const std::array<double, 3>& entry) const;

  int width_;
  ProbeOptions options_;
  std::vector<double> first_;  // reading
};

}  // namespace hexaplast::parts
