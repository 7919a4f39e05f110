// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/regions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "scene/region.hpp"

namespace hexaplast::runner {
namespace {

std::string path_of(const scene::Component& component) {
  const std::string node = component.node().path();
  return (node == "/" ? "" : node.substr(1) + "/") + component.name();
}

std::vector<double> numbers_of(const scene::Value& value) {
  if (const double* number = std::get_if<double>(&value)) return {*number};
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  return numbers ? *numbers : std::vector<double>();
}

}  // namespace

std::vector<RegionFigure> regions_of(scene::Scene& scene) {
  std::vector<RegionFigure> figures;
  for (scene::MaterialRegion* region : scene.root().all<scene::MaterialRegion>()) {
    RegionFigure& figure =
        figures.emplace_back(RegionFigure{.path = path_of(*region), .num_hexahedra = region->hexahedra().size()});
    for (const Row<Material>& row : material_rows()) {
      scene::Data* data = region->find_data(row.name);
      if (!data || !data->is_given()) continue;
      const std::vector<double> numbers = numbers_of(data->value());
      if (numbers.empty()) continue;
      const auto [min, max] = std::ranges::minmax(numbers);
      figure.values.push_back({row.name, row.unit, min, max});
    }
  }
  return figures;
}

output::Regions shown_regions(scene::Scene& scene, const output::Bodies& bodies) {
  output::Regions regions;
  for (scene::MaterialRegion* region : scene.root().all<scene::MaterialRegion>()) {
    regions.names.push_back(path_of(*region));
    const Body* body = region->field() ? region->field()->body() : nullptr;
    const auto owner = std::ranges::find(bodies.all(), body, &output::Bodies::Entry::body);
    if (owner == bodies.all().end()) continue;
    regions.of_hexahedra.resize(static_cast<std::size_t>(bodies.mesh().num_elements()), 0);
    for (const int hexahedron : region->hexahedra())
      regions.of_hexahedra[static_cast<std::size_t>(owner->first_hexahedron + hexahedron)] =
          static_cast<int>(regions.names.size());
  }
  if (regions.of_hexahedra.empty()) regions.names.clear();
  return regions;
}

std::string describe(const RegionFigure& region) {
  std::string text = fmt::format("{} {}", region.num_hexahedra, region.num_hexahedra == 1 ? "hexahedron" : "hexahedra");
  for (const RegionFigure::Value& value : region.values)
    text += fmt::format(", {} {}{}{}", value.name, min_to_max(value.min, value.max), value.unit.empty() ? "" : " ",
                        value.unit);
  return text;
}

std::string min_to_max(double min, double max) {
  return min == max ? fmt::format("{:.6g}", min) : fmt::format("{:.6g} to {:.6g}", min, max);
}

}  // namespace hexaplast::runner
