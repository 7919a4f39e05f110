// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/result_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"

namespace hexaplast::runner {
namespace {

constexpr double kManyInverted = 0.01;       // of the hexahedra: single ones may pass through and recover
constexpr double kLargestUnexplained = 0.2;  // of the energy put in
constexpr double kLargestGain = 100;         // times the energy put in

void check_inversions(const Simulation& simulation, std::vector<std::string>& doubts) {
  const int num_hexahedra = simulation.bodies()->mesh().num_elements();
  const Totals& totals = simulation.totals();
  const int at_end = simulation.latest().flow.inverted;
  if (at_end > 0) doubts.push_back(fmt::format("{} of {} hexahedra are inverted at the end", at_end, num_hexahedra));
  if (totals.max_inverted > std::max(1.0, kManyInverted * num_hexahedra))
    doubts.push_back(fmt::format("{} of {} hexahedra were inverted in step {}", totals.max_inverted, num_hexahedra,
                                 totals.max_inverted_in));
}

/// [J] what errors of energies are measured by.
double energy_put_in(const Simulation& simulation) {
  constexpr double kUnseenStrain = 1e-6;
  double unseen = 0;
  if (const output::Bodies* bodies = simulation.bodies())
    for (const output::Bodies::Entry& entry : bodies->all())
      for (int e = 0; e < entry.body->mesh().num_elements(); ++e)
        unseen +=
            entry.body->material(e).young_modulus * entry.body->initial_volume(e) * kUnseenStrain * kUnseenStrain / 2;
  return std::max(simulation.totals().energy_put_in, unseen);
}

void check_solves(const Simulation& simulation, std::vector<std::string>& doubts) {
  const Totals& totals = simulation.totals();
  const auto check = [&](long steps, const char* what, const std::string& remedy = "") {
    if (steps > 0)
      doubts.push_back(fmt::format("{} in {} of {} steps{}", what, steps, simulation.latest().step, remedy));
  };
  check(totals.threshold_solves, "the linear solver stopped at its threshold above its tolerance",
        fmt::format(": {}", kThresholdRemedy));
  check(totals.stalled_solves, "the linear solver stopped before its tolerance");
  check(totals.stalled_newton, "Newton's iterations stopped before their thresholds");
}

void check_energy(const EnergyBalance& energy, double put_in, const char* solver, std::vector<std::string>& doubts) {
  const auto check = [&](double missed, const char* what, const char* remedy) {
    if (missed > kLargestUnexplained * put_in)
      doubts.push_back(fmt::format("{} {:.3g} J, {:.0f} % of the {:.3g} J that were put in: {}", what, missed,
                                   100 * missed / put_in, put_in, remedy));
  };
  check(std::abs(energy.error()), "the energy balance misses", solver);
  check(-energy.numerical_loss, "the integrator has added", "take a smaller time step");
}

void check_rest_shapes(const output::Bodies& bodies, std::vector<std::string>& doubts) {
  for (const output::Bodies::Entry& entry : bodies.all())
    if (!entry.body->plastic_rest_has_converged())
      doubts.push_back(
          fmt::format("{}: the iterations that find its plastic rest positions did not converge", entry.name));
}

}  // namespace

void require_supplied(const Simulation& simulation) {
  const output::StepRecord& latest = simulation.latest();
  if (!latest.energy) return;
  const double energy = latest.energy->kinetic + latest.energy->elastic;
  if (!std::isfinite(energy))
    throw NumericalError(fmt::format("step {}: the kinetic and elastic energy is not finite", latest.step));
  if (energy <= kLargestGain * simulation.totals().energy_put_in) return;
  const double put_in = energy_put_in(simulation);
  if (energy > kLargestGain * put_in)
    throw NumericalError(
        fmt::format("step {}: the kinetic and elastic energy, {:.3g} J, is more than {} times the {:.3g} J that loads, "
                    "supports and the beginning have put in: the motion has blown up, take a smaller time step",
                    latest.step, energy, kLargestGain, put_in));
}

std::vector<std::string> check_results(const Simulation& simulation) {
  std::vector<std::string> doubts;
  if (simulation.bodies()) check_inversions(simulation, doubts);
  if (simulation.bodies()) check_rest_shapes(*simulation.bodies(), doubts);
  check_solves(simulation, doubts);
  if (simulation.latest().energy)
    check_energy(*simulation.latest().energy, energy_put_in(simulation),
                 simulation.totals().threshold_solves > 0
                     ? kThresholdRemedy
                     : "take a smaller time step, or a linear solver of a smaller tolerance",
                 doubts);
  return doubts;
}

}  // namespace hexaplast::runner
