// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "record/manifest.hpp"
#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

/// What a run has come to in its latest step, line by line: what it prints, and what its report shows.
std::vector<output::Figure> figures_of(Simulation& simulation);

/// Prints them, below the scene's name and how far it went.
void print_summary(Simulation& simulation, const std::filesystem::path& scene_file);

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

// Errors of energies are measured by what was put in, at its peak: work that is taken back, by a tool that leads tissue
// to where it was, is known no better than it was done. Where nothing was put in, a strain of 1e-6 counts. Without a
// balance of energy nothing is known of energies.

/// Throws NumericalError, which names the latest step, where kinetic and elastic energy are not finite or more than a
/// hundred times what was put in: they come out of nothing.
void require_supplied(const Simulation& simulation);

/// Why the results that a simulation has come to are not to be trusted, a sentence each. None: nothing speaks against
/// them.
std::vector<std::string> check_results(const Simulation& simulation);

/// The multiple of `unit` next to a number that people are shown; zero has no sign.
inline double rounded(double value, double unit) { return std::round(value / unit) * unit + 0.0; }

}  // namespace hexaplast::runner
