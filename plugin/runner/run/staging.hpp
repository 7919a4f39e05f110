// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "picture/gallery.hpp"
#include "runner/run/common_options.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// A region of the body as reports tell of it.
struct RegionFigure {
  /// A value that it gives; of values per hexahedron the smallest and the largest.
  struct Value {
    std::string_view name, unit;
    double min = 0, max = 0;
  };

  std::string path;  ///< from the root, as --set takes it: "bar/tumour"
  std::size_t num_hexahedra = 0;
  std::vector<Value> values = {};
};

/// Those of a scene that is ready, in its order.
std::vector<RegionFigure> regions_of(scene::Scene& scene);

/// "12 hexahedra, youngModulus 30000 Pa, yieldStress 2000 to 2500 Pa"
std::string describe(const RegionFigure& region);

/// "5000", "5000 to 8000"
std::string min_to_max(double min, double max);

/// What the command line says of it. Throws UsageError for a region that is not there.
void stage(const PictureOptions& options, output::Staging& staging);

}  // namespace hexaplast::runner
