// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/summary_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hexaplast/mesh/quality.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/result_checks.hpp"

namespace hexaplast::runner {

using Json = nlohmann::ordered_json;

Json summary_json(Simulation& simulation) {
  const output::Bodies& bodies = *simulation.bodies();
  const PointArray& x = simulation.positions();
  const output::StepRecord& latest = simulation.latest();
  const Totals& totals = simulation.totals();
  const output::Summary summary = output::summarise(bodies, x);
  const output::Largest& plastic = summary.plastic_strain;

  Json json = {{"state_hash", simulation.state_hash()},
               {"steps", latest.step},
               {"time", simulation.time()},
               {"step_ms", totals.step_ms / static_cast<double>(std::max(latest.step, 1L))},
               {"solver_iterations", totals.iterations},
               {"preconditioner", preconditioner_line(totals)},
               {"stalled_solves", totals.stalled_solves},
               {"stalled_newton", totals.stalled_newton},
               {"threshold_solves", totals.threshold_solves},
               {"stalled_averaging", totals.stalled_averaging},
               {"rolled_back", totals.rolled_back},
               {"nodes", simulation.num_nodes()},
               {"hexahedra", bodies.mesh().num_elements()},
               {"removed", bodies.num_removed()},
               {"opened", bodies.num_opened()},
               {"connected_parts", summary.num_pieces},
               {"least_scaled_jacobian", quality(bodies.mesh()).min_scaled_jacobian},
               {"inverted", latest.flow.inverted},
               {"most_inverted", totals.max_inverted},
               {"plastic_rest_volume_ratio", summary.plastic_rest_volume_ratio},
               {"volume_error", summary.plastic_rest_volume_ratio - 1},
               {"current_volume_ratio", summary.current_volume_ratio},
               {"worst_element_volume_error", summary.worst_element_volume_error},
               {"largest_plastic_strain", plastic.value},
               {"largest_plastic_strain_hexahedron", plastic.hexahedron < 0 ? Json(nullptr) : Json(plastic.hexahedron)},
               {"kinetic_energy", latest.kinetic_energy},
               {"elastic_energy", bodies.energy(x)},
               {"dissipated_energy", bodies.dissipated_energy()},
               {"energy_error", latest.energy ? Json(latest.energy->error()) : Json(nullptr)},
               {"probes", Json::object()},
               {"probe_extremes", Json::object()},
               {"doubts", check_results(simulation)}};
  if (measures_ends(simulation))
    json.update({{"plastic_elongation", summary.plastic_elongation},
                 {"plastic_twist_deg", summary.plastic_twist_deg},
                 {"current_elongation", summary.current_elongation},
                 {"current_twist_deg", summary.current_twist_deg}});
  for (std::size_t p = 0; p < simulation.probes().size(); ++p) {
    const std::string& name = simulation.probes()[p]->name();
    const auto& [min, min_at, max, max_at] = totals.probes[p];
    json["probes"][name] = latest.probes[p];
    json["probe_extremes"][name] = {{"min", min}, {"min_time", min_at}, {"max", max}, {"max_time", max_at}};
  }
  return json;
}

}  // namespace hexaplast::runner
