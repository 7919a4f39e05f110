// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

/// What a run has come to, for programs: state_hash, steps, time [s], step_ms (mean wall time of a step),
/// solver_iterations (of all steps), preconditioner, stalled_solves, stalled_newton, threshold_solves,
/// stalled_averaging, rolled_back (plastic steps of hexahedra), nodes, hexahedra, removed, opened (joints),
/// connected_parts (of what is left), least_scaled_jacobian (of the mesh as it began), inverted (at the end),
/// most_inverted (in a step), the last row of history.csv by its names (elongations and twists as there, volume ratios,
/// energies; energy_error is null where no balance is kept), probes by their names, volume_error
/// (plastic_rest_volume_ratio - 1), worst_element_volume_error, largest_plastic_strain with
/// largest_plastic_strain_hexahedron, where it is (null: nothing is left), and doubts: what check_results says. The
/// simulation has a body.
nlohmann::ordered_json summary_json(Simulation& simulation);

}  // namespace hexaplast::runner
