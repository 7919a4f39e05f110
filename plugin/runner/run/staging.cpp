// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/staging.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "runner/command.hpp"
#include "scene/region.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::runner {
namespace {

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
        figures.emplace_back(RegionFigure{.path = view::path_of(*region), .num_hexahedra = region->hexahedra().size()});
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

void stage(const PictureOptions& options, output::Staging& staging) {
  if (!options.field.empty() || !options.regions.empty())
    staging.quantity = output::quantity_of(options.field).value_or(output::Quantity::kRegion);
  if (!options.up.empty()) staging.up = (options.up.front() == '-' ? -1 : 1) * Vec3::Unit(options.up.back() - 'x');
  for (const std::string& word : options.regions) {
    const std::vector<std::string>& names = staging.regions.names;
    staging.shown_regions.push_back(staging.regions.number_of(word));
    if (staging.shown_regions.back() == 0)
      throw UsageError(
          fmt::format("--region {}: {}", word,
                      names.empty() ? "there are no regions" : fmt::format("must be {}", fmt::join(names, " or "))));
  }
}

}  // namespace hexaplast::runner
