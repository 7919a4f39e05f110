// SPDX-License-Identifier: LGPL-2.1-or-later
// calculix_table: every bar of tests/data/calculix/bar.json and its variations, solved with this library, as CSV on
// standard output, each with the published element and with the default one (without recovery, which has no part here):
//
//   case,refine,element,yield_norm,peak_mean,peak_central,residual_mean,residual_central,residual_volume_ratio,
//   unsolved_steps
//
// for the twisted bar the angle of every layer. calculix_table --locking: the beams of locking.json and
// locking_meshes.json, as rows of docs/validation.md. Takes some minutes.
#include <fmt/format.h>

#include <cstdio>
#include <limits>
#include <string_view>

#include "support/calculix_bar.hpp"
#include "support/cantilever.hpp"

namespace {

using namespace hexaplast;
using support::BarCase;
using support::BarRun;
using support::EndLoad;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr const char* kNorms[] = {"vonMises", "frobenius", "spectral"};

struct Element {
  const char* name;
  Bending bending;
  Volumetric volumetric;

  void use_in(Settings& settings) const {
    settings.bending = bending;
    settings.volumetric = volumetric;
  }
};
constexpr Element kPublished{"published", Bending::kBlended, Volumetric::kSample};
constexpr Element kDefault{"assumedCorner volumeRatio", Bending::kAssumedCorner, Volumetric::kVolumeRatio};
constexpr Element kVertex{"vertex", Bending::kVertex, Volumetric::kSample};

BarRun report(const std::string& name, BarCase bar, const Element& element) {
  element.use_in(bar.settings);
  const BarRun run = support::run_bar(bar);
  fmt::print("{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{}\n", name, bar.refine, element.name,
             kNorms[static_cast<int>(bar.settings.yield_norm)], run.peak.mean_elongation, run.peak.central_elongation,
             run.residual.mean_elongation, run.residual.central_elongation, run.residual.volume_ratio, run.unsolved);
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

void report_bars(const Element& element) {
  for (const double force : {0.1, 0.45}) {
    BarCase bar = plastic(kNever, 0, EndLoad::kCentralStretch, force, {.ramp = 1, .hold = 1, .release = 2, .end = 2});
    bar.dt = 0.25;
    report(fmt::format("elastic_F{}", force), bar, element);
  }

  report("visco_tau50_F0.05", plastic(50, 5, EndLoad::kCentralStretch, 0.05), element);
  BarCase visco = plastic(100, 5, EndLoad::kCentralStretch, 0.1);
  report("visco_tau100_F0.1", visco, element);
  visco.settings.yield_norm = YieldNorm::kFrobenius;
  report("visco_tau100_F0.1", visco, element);
  visco.settings.yield_norm = YieldNorm::kVonMises;
  visco.refine = 2;
  report("visco_tau100_F0.1", visco, element);
  BarCase face = plastic(100, 5, EndLoad::kFaceStretch, 0.117);
  report("visco_face_tau100_F0.117", face, element);
  face.refine = 2;
  report("visco_face_tau100_F0.117", face, element);

  // rate-independent references: slow loading and fast flow
  for (const int refine : {1, 2}) {
    BarCase bar = plastic(250, 20, EndLoad::kFaceStretch, 0.3, {.ramp = 2, .hold = 5, .release = 6, .end = 8});
    bar.refine = refine;
    report("face_tau250_F0.3", bar, element);
  }
  for (const int refine : {1, 2}) {
    BarCase bar = plastic(100, 20, EndLoad::kFaceTwist, 0.06, {.ramp = 2, .hold = 4, .release = 6, .end = 8});
    bar.refine = refine;
    const BarRun twisted = report("face_twist_tau100_f0.06", bar, element);
    for (std::size_t layer = 0; layer < twisted.peak.twist_deg.size(); ++layer)
      fmt::print("  layer {}: {:.4f} {:.4f} deg\n", layer, twisted.peak.twist_deg[layer],
                 twisted.residual.twist_deg[layer]);
  }
}

void report_locking() {
  constexpr double kPoissonRatios[] = {0, 0.3, 0.45, 0.49, 0.499};
  constexpr Element kElements[] = {kPublished,
                                   {"blended mean", Bending::kBlended, Volumetric::kMean},
                                   {"assumed volumeRatio", Bending::kAssumed, Volumetric::kVolumeRatio},
                                   kDefault};
  fmt::print("| mesh | C3D8 | C3D8I | C3D20R");
  for (const Element& element : kElements) fmt::print(" | {}", element.name);
  fmt::print(" |\n");
  for (const char* name : {"cubes", "one cell thick", "twice as long", "five times as long", "slanted by 27 degrees",
                           "slanted by 45 degrees", "trapezoids", "moved by 0.15", "moved by 0.3"}) {
    const support::BeamMesh beam = support::beam_mesh(name);
    fmt::print("| {}", name);
    for (const char* type : {"C3D8", "C3D8I", "C3D20R"}) {
      fmt::print(" |");
      for (const auto& value : beam.reference[type]) fmt::print(" {:.3f}", value.get<double>());
    }
    for (const Element& element : kElements) {
      Settings settings;
      element.use_in(settings);
      fmt::print(" |");
      for (const double poisson_ratio : kPoissonRatios)
        fmt::print(" {:.3f}", support::relative_deflection(beam.mesh, beam.shares, poisson_ratio, settings));
    }
    fmt::print(" |\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--locking") {
    report_locking();
    return 0;
  }
  if (argc > 1) {
    fmt::print(stderr, "usage: calculix_table [--locking]\n");
    return 2;
  }
  fmt::print(
      "case,refine,element,yield_norm,peak_mean,peak_central,residual_mean,residual_central,residual_volume_ratio,"
      "unsolved_steps\n");
  report_bars(kPublished);
  report("visco_tau100_F0.1", plastic(100, 5, EndLoad::kCentralStretch, 0.1), kVertex);
  report_bars(kDefault);
}
