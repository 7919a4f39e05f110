// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/material_region.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "hexaplast/base/error.hpp"

namespace hexaplast::parts {
namespace {

/// Numbers of hexahedra that are given by their nodes, in the order of these.
std::vector<int> numbers_of(std::span<const int> nodes, const std::vector<Hexahedron>& of_body) {
  constexpr std::size_t kNodes = std::tuple_size_v<Hexahedron>;
  if (nodes.size() % kNodes != 0)
    throw OptionError("hexahedra", fmt::format("{} numbers given, must be groups of {}", nodes.size(), kNodes));

  struct Wanted {
    Hexahedron corners;  // ascending
    std::size_t place;
  };
  std::vector<Wanted> wanted(nodes.size() / kNodes);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    std::copy_n(&nodes[i * kNodes], kNodes, wanted[i].corners.begin());
    std::ranges::sort(wanted[i].corners);
    wanted[i].place = i;
  }
  std::ranges::stable_sort(wanted, {}, &Wanted::corners);

  std::vector<int> numbers(wanted.size(), -1);
  for (std::size_t e = 0; e < of_body.size(); ++e) {
    Hexahedron corners = of_body[e];
    std::ranges::sort(corners);
    for (auto found = std::ranges::lower_bound(wanted, corners, {}, &Wanted::corners);
         found != wanted.end() && found->corners == corners; ++found)
      numbers[found->place] = static_cast<int>(e);
  }
  if (const auto missing = std::ranges::find(numbers, -1); missing != numbers.end()) {
    const auto begin = static_cast<std::size_t>(missing - numbers.begin()) * kNodes;
    throw OptionError("hexahedra", fmt::format("{} are the nodes of no hexahedron of the body, must be of one",
                                               fmt::join(nodes.subspan(begin, kNodes), " ")));
  }
  return numbers;
}

}  // namespace

void check_values(const Row<Material>& row, std::span<const double> values, std::size_t count,
                  std::string_view things) {
  for (const double value : values) check_admissible(row, value);
  if (values.empty() || (values.size() != 1 && values.size() != count))
    throw OptionError(row.name,
                      fmt::format("{} values given, must be one or {} (one per {})", values.size(), count, things));
}

void check_rate(const Row<Material>& row, std::span<const double> values, double dt) {
  for (const double value : values)
    if (!row.per_step.contains(value * dt))
      throw OptionError(row.name, fmt::format("{} times dt = {} s is {:.6g}: must be at most {:.6g}", value, dt,
                                              value * dt, row.per_step.max));
}

std::vector<int> region_hexahedra(const std::optional<std::vector<int>>& nodes,
                                  const std::optional<std::vector<int>>& numbers,
                                  const std::vector<Hexahedron>& of_body) {
  if (!nodes && !numbers) throw OptionError("hexahedra", "is not given, nor is indices: one of the two is needed");
  if (nodes && numbers) throw OptionError("indices", "is given besides hexahedra: must be one of the two");
  const std::string_view option = nodes ? "hexahedra" : "indices";
  const int count = static_cast<int>(of_body.size());
  if (numbers) check_nodes(option, *numbers, count);

  std::vector<int> found = nodes ? numbers_of(*nodes, of_body) : *numbers;
  if (found.empty()) throw OptionError(option, "has no hexahedron, must have at least one of the body");
  std::vector<bool> is_taken(of_body.size(), false);
  for (const int e : found) {
    if (is_taken[static_cast<std::size_t>(e)])
      throw OptionError(option, fmt::format("hexahedron {} is given twice, must be given once", e));
    is_taken[static_cast<std::size_t>(e)] = true;
  }
  return found;
}

void apply(const MaterialRegion& region, std::size_t num_hexahedra, std::vector<Material>& materials) {
  if (materials.size() < num_hexahedra) materials.resize(num_hexahedra, Material(materials.front()));
  for (const auto& [row, values] : region.values)
    for (std::size_t i = 0; i < region.hexahedra.size(); ++i)
      row->at.set(materials[static_cast<std::size_t>(region.hexahedra[i])], values[values.size() == 1 ? 0 : i]);
}

}  // namespace hexaplast::parts
