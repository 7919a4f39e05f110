// SPDX-License-Identifier: LGPL-2.1-or-later
// Every bar of tests/data/calculix/bar.json and its variations, solved with this library, as CSV on standard output:
//
//   case,refine,gradient,yield_norm,peak_mean,peak_central,residual_mean,residual_central,residual_volume_ratio,
//   unsolved_steps
//
// for the twisted bar the angle of every layer, and the tip of the beam of locking.json. Takes some minutes;
// docs/validation.md sets the figures against CalculiX's.
#include <fmt/format.h>

#include <cstdio>
#include <limits>

#include "support/calculix_bar.hpp"
#include "support/cantilever.hpp"

namespace {

using namespace hexaplast;
using support::BarCase;
using support::BarRun;
using support::EndLoad;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr const char* kGradients[] = {"blended", "vertex", "centre"};
constexpr const char* kNorms[] = {"vonMises", "frobenius", "spectral"};

BarRun report(const std::string& name, const BarCase& bar) {
  const BarRun run = support::run_bar(bar);
  fmt::print("{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{}\n", name, bar.refine,
             kGradients[static_cast<int>(bar.settings.gradient)], kNorms[static_cast<int>(bar.settings.yield_norm)],
             run.peak.mean_elongation, run.peak.central_elongation, run.residual.mean_elongation,
             run.residual.central_elongation, run.residual.volume_ratio, run.unsolved);
  std::fflush(stdout);
  return run;
}

BarCase plastic(double yield_stress, double flow_rate, EndLoad load, double force, support::Schedule schedule = {}) {
  BarCase bar{.material = support::calculix_material(yield_stress, flow_rate), .load = load};
  bar.force = force;
  bar.schedule = schedule;
  bar.settings.rotation_plasticity = RotationPlasticity::kNone;
  return bar;
}

}  // namespace

int main() {
  fmt::print(
      "case,refine,gradient,yield_norm,peak_mean,peak_central,residual_mean,residual_central,"
      "residual_volume_ratio,unsolved_steps\n");
  for (const double force : {0.1, 0.45}) {
    BarCase bar = plastic(kNever, 0, EndLoad::kCentralStretch, force, {.ramp = 1, .hold = 1, .release = 2, .end = 2});
    bar.dt = 0.25;
    report(fmt::format("elastic_F{}", force), bar);
  }

  report("visco_tau50_F0.05", plastic(50, 5, EndLoad::kCentralStretch, 0.05));
  BarCase visco = plastic(100, 5, EndLoad::kCentralStretch, 0.1);
  report("visco_tau100_F0.1", visco);
  visco.settings.gradient = GradientScheme::kVertex;
  report("visco_tau100_F0.1", visco);
  visco.settings.gradient = GradientScheme::kBlended;
  visco.settings.yield_norm = YieldNorm::kFrobenius;
  report("visco_tau100_F0.1", visco);
  visco.settings.yield_norm = YieldNorm::kVonMises;
  visco.refine = 2;
  report("visco_tau100_F0.1", visco);
  report("visco_face_tau100_F0.117", plastic(100, 5, EndLoad::kFaceStretch, 0.117));

  // rate-independent references: slow loading and fast flow
  for (const int refine : {1, 2}) {
    BarCase bar = plastic(250, 20, EndLoad::kFaceStretch, 0.3, {.ramp = 2, .hold = 5, .release = 6, .end = 8});
    bar.refine = refine;
    report("face_tau250_F0.3", bar);
  }
  const BarRun twisted = report("face_twist_tau100_f0.06", plastic(100, 20, EndLoad::kFaceTwist, 0.06,
                                                                   {.ramp = 2, .hold = 4, .release = 6, .end = 8}));
  fmt::print("\nlayer,peak_twist_deg,residual_twist_deg\n");
  for (std::size_t layer = 0; layer < twisted.peak.twist_deg.size(); ++layer)
    fmt::print("{},{:.4f},{:.4f}\n", layer, twisted.peak.twist_deg[layer], twisted.residual.twist_deg[layer]);

  fmt::print("\npoisson_ratio,deflection,deflection_refined\n");
  for (const double poisson_ratio : {0.0, 0.3, 0.45, 0.49, 0.499})
    fmt::print("{},{:.4f},{:.4f}\n", poisson_ratio, support::relative_deflection(2, poisson_ratio),
               support::relative_deflection(4, poisson_ratio));
}
