// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "base/simd.hpp"
#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/quality.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/staging.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

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

/// Which hexahedra bodies have lost, as far as a line holds them.
std::string removed_line(const output::Bodies& bodies, const Totals& totals) {
  constexpr std::size_t kMaxNamed = 8;
  std::vector<std::string> named;
  for (const output::Bodies::Entry& entry : bodies.all())
    for (const int hexahedron : entry.body->removed())
      if (named.size() < kMaxNamed)
        named.push_back(fmt::format("{}{}", hexahedron, bodies.is_one() ? "" : " of " + entry.name));
  return fmt::format("{} in steps {} to {}: {}{}", bodies.num_removed(), totals.first_removal, totals.latest_removal,
                     fmt::join(named, ", "), named.size() < bodies.num_removed() ? ", ..." : "");
}

/// Which of a body's hexahedra were inverted.
std::string inverted_line(int at_end, const Totals& totals) {
  return fmt::format("{} at the end, at most {} in step {}", at_end, totals.max_inverted, totals.max_inverted_in);
}

/// Where the work went.
std::string energy_line(const EnergyBalance& energy, double put_in) {
  constexpr double kNoise = 1e-9;  // of the work: rounding in the shape that a scene begins with is no energy
  const double work = energy.load_work + energy.support_work;
  std::string others = energy.recovery_work != 0 ? fmt::format(" and {:.4g} J of recovery", energy.recovery_work) : "";
  if (energy.change_work != 0) others += fmt::format(" and {:.4g} J of changes", energy.change_work);
  return fmt::format(
      "work {:.4g} J{}{} = in the body {:.4g} + flow {:.4g} + damping {:.4g} + integrator {:.4g} + unexplained {:.2g} "
      "({:.2g} %)",
      work, energy.initial > kNoise * std::abs(work) ? fmt::format(" and {:.4g} J at first", energy.initial) : "",
      others, energy.kinetic + energy.elastic, energy.flow_loss, energy.damping_loss, energy.numerical_loss,
      energy.error(), put_in > 0 ? 100 * energy.error() / put_in : 0);
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

std::vector<output::Figure> figures_of(Simulation& simulation) {
  std::vector<output::Figure> figures;
  const auto add = [&](std::string label, std::string value) {
    figures.push_back({std::move(label), std::move(value)});
  };
  // of a run that fails, the latest step may have been beyond all numbers already
  const auto add_finite = [&](const char* label, std::initializer_list<double> numbers, std::string value) {
    if (std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); })) add(label, std::move(value));
  };
  const Totals& totals = simulation.totals();
  const long num_steps = simulation.latest().step;
  const double per_step = totals.step_ms / static_cast<double>(std::max(num_steps, 1L));
  for (std::size_t p = 0; p < simulation.probes().size(); ++p) {
    const double reading = simulation.latest().probes[p];
    const auto& [min, min_at, max, max_at] = totals.probes[p];
    add_finite(simulation.probes()[p]->name().c_str(), {reading, min, max},
               fmt::format("{:.6g} {}  (min {:.6g} at {:.6g} s, max {:.6g} at {:.6g} s)", reading,
                           simulation.probes()[p]->unit(), min, min_at, max, max_at));
  }
  add("nodes", fmt::format("{}", simulation.num_nodes()));
  if (const output::Bodies* bodies = simulation.bodies()) {
    const output::Summary summary = output::summarise(*bodies, simulation.positions());
    add("hexahedra", fmt::format("{}", bodies->mesh().num_elements()));
    if (!bodies->is_one())
      for (const output::Bodies::Entry& entry : bodies->all())
        add("body " + entry.name,
            fmt::format("{} hexahedra, {} nodes", entry.body->mesh().num_elements(), entry.body->mesh().num_nodes()));
    for (const RegionFigure& region : regions_of(simulation.scene())) add("region " + region.path, describe(region));
    if (bodies->num_removed() > 0) add("removed", removed_line(*bodies, totals));
    if (bodies->num_opened() > 0) add("opened", fmt::format("{} joints", bodies->num_opened()));
    if (bodies->num_removed() + bodies->num_opened() > 0)
      add("connected parts", fmt::format("{} of what is left", summary.num_pieces));
    if (totals.max_inverted > 0) add("inverted", inverted_line(simulation.latest().flow.inverted, totals));
    if (totals.rolled_back > 0)
      add("rolled back",
          fmt::format("{} plastic steps of hexahedra, where averaging would have flattened one", totals.rolled_back));
    const bool has_ends = measures_ends(simulation);
    if (has_ends)
      add_finite("plastic elongation", {summary.plastic_elongation, summary.current_elongation},
                 fmt::format("{:+.3f} %  (current {:+.3f} %)", rounded(100 * summary.plastic_elongation, 1e-3),
                             rounded(100 * summary.current_elongation, 1e-3)));
    if (has_ends)
      add_finite("plastic twist", {summary.plastic_twist_deg, summary.current_twist_deg},
                 fmt::format("{:+.3f} deg  (current {:+.3f} deg)", rounded(summary.plastic_twist_deg, 1e-3),
                             rounded(summary.current_twist_deg, 1e-3)));
    add_finite(
        "volume error", {summary.plastic_rest_volume_ratio, summary.current_volume_ratio},
        fmt::format("{:+.4f} %  (worst hexahedron {:.4f} %, current {:+.4f} %)",
                    rounded(100 * (summary.plastic_rest_volume_ratio - 1), 1e-4),
                    100 * summary.worst_element_volume_error, rounded(100 * (summary.current_volume_ratio - 1), 1e-4)));
    const PointArray& x = simulation.positions();
    const double size = (x.colwise().maxCoeff() - x.colwise().minCoeff()).matrix().norm();
    const auto add_largest = [&](const char* label, const char* words, const output::Largest& largest) {
      const Vec3 place = largest.place.unaryExpr([&](double number) { return rounded(number, 1e-6 * size); });
      if (largest.hexahedron >= 0 && largest.value > 0)
        add_finite(label, {largest.value, place.sum()},
                   fmt::format("{:.4f} {} hexahedron {} at ({:.4g}, {:.4g}, {:.4g}) m", largest.value, words,
                               largest.hexahedron, place.x(), place.y(), place.z()));
    };
    add_largest("largest strain", "in", summary.strain);
    add_largest("plastic strain", "max, in", summary.plastic_strain);
    if (num_steps > 0) add("speed", fmt::format("{:.1f} hex/ms", bodies->mesh().num_elements() / per_step));
  }
  if (const std::optional<EnergyBalance>& energy = simulation.latest().energy)
    add_finite("energy", {energy->error()}, energy_line(*energy, totals.energy_put_in));
  if (num_steps > 0)
    add("step", fmt::format("{:.3f} ms, {:.1f} solver iterations, {:.3g} times real time", per_step,
                            static_cast<double>(totals.iterations) / static_cast<double>(num_steps),
                            1000 * simulation.dt() / per_step));
  if (totals.threshold_solves > 0)
    add("not solved", fmt::format("{} of {} steps, in which the linear solver stopped at its threshold above its "
                                  "tolerance",
                                  totals.threshold_solves, num_steps));
  if (std::string line = preconditioner_line(totals); !line.empty()) add("preconditioner", std::move(line));
  add("instruction set", simd_target());
  if (const output::Bodies* bodies = simulation.bodies())
    for (const output::Bodies::Entry& entry : bodies->all())
      if (entry.body->device() != "cpu")
        add(bodies->is_one() ? "device" : "device of " + entry.name, entry.body->device());
  add("state hash", simulation.state_hash());
  return figures;
}

void print_summary(Simulation& simulation, const std::filesystem::path& scene_file) {
  fmt::print("{}: {} steps of {:.6g} s, to t = {:.6g} s\n", printable_line(scene_file.stem().string()),
             simulation.latest().step, simulation.dt(), simulation.time());
  for (const output::Figure& figure : figures_of(simulation))
    fmt::print("  {:<18}  {}\n", printable_line(figure.label), figure.value);
}

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
