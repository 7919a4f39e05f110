// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "base/simd.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/regions.hpp"
#include "runner/run/rounded.hpp"

namespace hexaplast::runner {
namespace {

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
  add("state hash", simulation.state_hash());
  return figures;
}

}  // namespace hexaplast::runner
