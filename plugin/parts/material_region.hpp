// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "hexaplast/material/rows.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// Hexahedra of a body that have values of their own. In scenes: MaterialRegion, whose attributes are the rows of
/// Material.
struct MaterialRegion {
  /// Of one member: one value, or one per hexahedron of the region.
  struct Values {
    const Row<Material>* row = nullptr;
    std::vector<double> values = {};
  };

  std::vector<int> hexahedra = {};  ///< their numbers in the body
  std::vector<Values> values = {};  ///< members that are not among them stay as they are
};

/// Throws OptionError for values that the row does not admit, and unless there is one of them, or one for each of
/// `count` things: "hexahedron".
void check_values(const Row<Material>& row, std::span<const double> values, std::size_t count, std::string_view things);

/// Throws OptionError where a value is a rate that is too fast for the time step [s].
void check_rate(const Row<Material>& row, std::span<const double> values, double dt);

/// The hexahedra of a region, given by their nodes, eight each in any order, or by their numbers. Throws OptionError
/// unless exactly one of the two is given, for none and for one that is given twice, and for what the body has not.
std::vector<int> region_hexahedra(const std::optional<std::vector<int>>& nodes,
                                  const std::optional<std::vector<int>>& numbers,
                                  const std::vector<Hexahedron>& of_body);

/// A region from what a host has for attributes. given(row): the values of a member, none where it has none. dt [s]:
/// what rates must fit to. Throws OptionError with all that is wrong.
template <class Given>
MaterialRegion material_region(const Given& given, std::vector<int> hexahedra, double dt) {
  MaterialRegion region{.hexahedra = std::move(hexahedra)};
  OptionErrors errors;
  for (const Row<Material>& row : material_rows())
    errors.collect([&] {
      std::optional<std::vector<double>> values = given(row);
      if (!values) return;
      check_values(row, *values, region.hexahedra.size(), "hexahedron of the region");
      check_rate(row, *values, dt);
      region.values.push_back({&row, std::move(*values)});
    });
  errors.throw_all();
  return region;
}

/// Gives the region's values to the materials of a body, one or one per hexahedron before, one per hexahedron after.
void apply(const MaterialRegion& region, std::size_t num_hexahedra, std::vector<Material>& materials);

}  // namespace hexaplast::parts
