// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::output {

/// Parts of bodies that a scene names.
struct Regions {
  std::vector<int> of_hexahedra = {};   ///< from 1, 0: in none; empty: there are no regions
  std::vector<std::string> names = {};  ///< their paths in the scene, that of region 1 first

  /// The region of a path, or of its last name; 0: there is none.
  int number_of(std::string_view word) const {
    const auto found = std::ranges::find_if(names, [&](std::string_view name) {
      return name == word || (name.ends_with(word) && name[name.size() - word.size() - 1] == '/');
    });
    return found == names.end() ? 0 : static_cast<int>(found - names.begin()) + 1;
  }

  static std::string name_of(int number, const std::vector<std::string>& names) {
    return number == 0 ? "in no region" : names[static_cast<std::size_t>(number) - 1];
  }

  /// 0 and those of all regions.
  std::vector<int> numbers() const {
    std::vector<int> all(names.size() + 1);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  /// 1 for the hexahedra of a region that are alive. alive: one per hexahedron; empty: all are.
  std::vector<unsigned char> alive_in(int region, std::span<const unsigned char> alive) const {
    std::vector<unsigned char> found;
    for (std::size_t e = 0; e < of_hexahedra.size(); ++e)
      found.push_back(of_hexahedra[e] == region && (alive.empty() || alive[e] != 0));
    return found;
  }
};

}  // namespace hexaplast::output
