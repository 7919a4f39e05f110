// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/ends.hpp"

#include <algorithm>
#include <set>

#include "hexaplast/geometry/sections.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/loads.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::runner {

bool measures_ends(Simulation& simulation) {
  const output::Bodies* bodies = simulation.bodies();
  if (!bodies) return false;
  if (simulation.end_sections() != "auto") return simulation.end_sections() == "yes";
  if (!bodies->is_one() || !simulation.scene().root().all<scene::Instrument>().empty()) return false;

  std::set<int> acted_on = loaded_nodes(simulation);
  for (const int node : fixed_nodes(simulation)) acted_on.insert(node);
  const auto is_acted_on = [&](int node) { return acted_on.contains(node); };
  const EndSections ends = end_sections(bodies->mesh());
  if (std::ranges::none_of(ends.min, is_acted_on) || std::ranges::none_of(ends.max, is_acted_on)) return false;
  for (const std::vector<int>* end : {&ends.min, &ends.max})
    for (const int node : *end) acted_on.erase(node);
  for (const std::vector<int>& section : ends.layers)
    if (std::ranges::all_of(section, is_acted_on))
      for (const int node : section) acted_on.erase(node);
  return acted_on.empty();
}

}  // namespace hexaplast::runner
