// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::runner {

/// A part of the runs of a sweep. A run belongs to one of `count` shards by a hash of its values alone, so that other
/// values of the sweep make no difference to it.
struct Shard {
  int index = 1, count = 1;  ///< index: from 1

  bool is_whole() const { return count == 1; }
  bool has(const std::vector<std::string>& assignments) const;  ///< of a run: PATH.attribute=VALUE each
  std::string text() const;                                     ///< i/n
};

/// Reads i/n. Throws UsageError.
Shard parse_shard(std::string_view text);

}  // namespace hexaplast::runner
