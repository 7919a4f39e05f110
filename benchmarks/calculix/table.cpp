// SPDX-License-Identifier: LGPL-2.1-or-later
// calculix_table [OPTION]: what docs/validation.md compares with CalculiX, solved with this library, as rows of its
// tables. Without an option the bars of the published element, with peak and permanent values; for the twisted bar the
// angle of every layer. --locking: the beams of locking.json and locking_meshes.json; --hyperelastic: what
// hyperelastic.json strains far; --isolated: joined and isolated rest shapes of the default element; --relaxation:
// viscoelastic branches. Takes some minutes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/beyond_yield.hpp"
#include "support/calculix_bar.hpp"
#include "support/cantilever.hpp"
#include "support/large_strain.hpp"
#include "support/relaxation.hpp"

namespace {

using namespace hexaplast;
using support::BarCase;
using support::BarRun;
using support::EndLoad;
using support::Json;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Element {
  const char* name;
  Bending bending;
  Volumetric volumetric;
  ElasticLaw law = ElasticLaw::kCorotated;

  Settings settings(Settings others = {}) const {
    others.bending = bending;
    others.volumetric = volumetric;
    others.law = law;
    return others;
  }
};
constexpr Element kPublished{"published", Bending::kBlended, Volumetric::kSample};
constexpr Element kDefault{"assumedCorner volumeRatio", Bending::kAssumedCorner, Volumetric::kVolumeRatio};

void print_row(const std::string& name, const std::vector<std::string>& cells) {
  fmt::print("| {} | {} |\n", name, fmt::join(cells, " | "));
  std::fflush(stdout);
}

/// Each number as `format` writes it.
std::vector<std::string> texts(const char* format, std::span<const double> numbers) {
  std::vector<std::string> all;
  for (const double number : numbers) all.push_back(fmt::format(fmt::runtime(format), number));
  return all;
}

std::string both(double peak, double residual) { return fmt::format("{:.6f} / {:.6f}", peak, residual); }

constexpr support::Schedule kSlowStretch{.ramp = 2, .hold = 5, .release = 6, .end = 8};
constexpr support::Schedule kSlowTwist{.ramp = 2, .hold = 4, .release = 6, .end = 8};

BarCase plastic(double yield_stress, double flow_rate, EndLoad load, double force, support::Schedule schedule = {}) {
  BarCase bar{.material = support::calculix_material(yield_stress, flow_rate), .load = load};
  bar.force = force;
  bar.schedule = schedule;
  bar.settings.rotation_plasticity = RotationPlasticity::kNone;
  return bar;
}

void report_bars() {
  fmt::print(
      "bar: case, refinement | elongation, peak / permanent | of the central ninth | permanent volume | unsolved\n");
  const auto report = [](const char* name, BarCase bar, int max_refine) {
    for (bar.refine = 1; bar.refine <= max_refine; ++bar.refine) {
      const BarRun run = support::run_bar(bar);
      print_row(fmt::format("{}, {}", name, bar.refine),
                {both(run.peak.mean_elongation, run.residual.mean_elongation),
                 both(run.peak.central_elongation, run.residual.central_elongation),
                 fmt::format("{:.6f}", run.residual.volume_ratio), fmt::to_string(run.unsolved)});
      if (bar.load != EndLoad::kFaceTwist) continue;
      print_row("layers, peak [deg]", texts("{:.4f}", run.peak.twist_deg));
      print_row("layers, permanent [deg]", texts("{:.4f}", run.residual.twist_deg));
    }
  };
  const auto central = EndLoad::kCentralStretch, face = EndLoad::kFaceStretch;
  for (const double force : {0.1, 0.45}) {
    BarCase bar = plastic(kNever, 0, central, force, {.ramp = 1, .hold = 1, .release = 2, .end = 2});
    bar.dt = 0.25;
    report(fmt::format("elastic, F {}", force).c_str(), bar, 1);
  }
  report("viscoplastic, tau 50, F .05", plastic(50, 5, central, 0.05), 1);
  report("viscoplastic, tau 100, F .1", plastic(100, 5, central, 0.1), 2);
  report("viscoplastic, tau 100, F .117, face", plastic(100, 5, face, 0.117), 2);
  // rate-independent references: slow loading and fast flow
  report("tau 250, F .3, face", plastic(250, 20, face, 0.3, kSlowStretch), 2);
  report("tau 100, twist", plastic(100, 20, EndLoad::kFaceTwist, 0.06, kSlowTwist), 2);
}

void report_locking() {
  constexpr double kPoissonRatios[] = {0, 0.3, 0.45, 0.49, 0.499};
  fmt::print("mesh | C3D8 | C3D8I | C3D20R | published | default\n");
  for (const char* name : {"cubes", "one cell thick", "twice as long", "five times as long", "slanted by 27 degrees",
                           "slanted by 45 degrees", "trapezoids", "moved by 0.15", "moved by 0.3"}) {
    const support::BeamMesh beam = support::beam_mesh(name);
    std::vector<std::string> cells;
    const auto add = [&](const std::vector<double>& row) {
      cells.push_back(fmt::format("{:.3f}", fmt::join(row, " ")));
    };
    for (const char* type : {"C3D8", "C3D8I", "C3D20R"}) add(beam.reference[type].get<std::vector<double>>());
    for (const Element& element : {kPublished, kDefault}) {
      std::vector<double> row;
      for (const double poisson_ratio : kPoissonRatios)
        row.push_back(support::relative_deflection(beam.mesh, beam.weights, poisson_ratio, element.settings()));
      add(row);
    }
    print_row(name, cells);
  }
}

// ---- large strain

constexpr Element with_law(const char* name, Volumetric volumetric, ElasticLaw law) {
  return {name, Bending::kAssumedCorner, volumetric, law};
}
constexpr Element kNeoHookean = with_law("neoHookean", Volumetric::kVolumeRatio, ElasticLaw::kNeoHookean);
constexpr Element kStableNeoHookean =
    with_law("stableNeoHookean", Volumetric::kVolumeRatio, ElasticLaw::kStableNeoHookean);
constexpr Element kMooneyRivlin = with_law("mooneyRivlin", Volumetric::kVolumeRatio, ElasticLaw::kMooneyRivlin);

constexpr Element kOfEveryForm[] = {
    kPublished,        {"blended volumeRatio", Bending::kBlended, Volumetric::kVolumeRatio},
    kDefault,          kNeoHookean,
    kStableNeoHookean, kMooneyRivlin};

std::string name_of(const Json& row) {
  return fmt::format("{}, {}", row.value("element", "C3D8I"), row["law"].get<std::string>());
}

std::string cell(const support::Strained& found) {
  return fmt::format("{:.3f}, {:+.1f} %", found.force, 100 * (found.volume_ratio - 1));
}

/// Nominal stress over E and change of volume at every stretch, then shear stress over mu at every shear.
void report_cube(double poisson_ratio, const Json& uniaxial, const Json& shear) {
  fmt::print("cube, {}: stretch {}, shear {}\n", poisson_ratio, uniaxial[0]["stretch"].dump(),
             shear[0]["shear"].dump());
  for (std::size_t row = 0; row < uniaxial.size(); ++row) {
    if (uniaxial[row]["poisson_ratio"] != poisson_ratio) continue;
    std::vector<std::string> cells;
    for (std::size_t k = 0; k < uniaxial[row]["stretch"].size(); ++k)
      cells.push_back(cell({uniaxial[row]["stress"][k], uniaxial[row]["volume_ratio"][k]}));
    std::ranges::copy(texts("{:.3f}", shear[row]["stress"].get<std::vector<double>>()), std::back_inserter(cells));
    print_row(name_of(uniaxial[row]), cells);
  }
  for (const Element& element : kOfEveryForm) {
    const Settings settings = element.settings();
    std::vector<std::string> cells;
    for (const double stretch : uniaxial[0]["stretch"])
      cells.push_back(cell(support::uniaxial(poisson_ratio, stretch, settings)));
    for (const double value : shear[0]["shear"])
      cells.push_back(fmt::format("{:.3f}", support::shear_stress(poisson_ratio, value, settings)));
    print_row(element.name, cells);
  }
}

/// Rows of one element and law are the cells of one row of the table.
template <class Cell>
void report_reference(const Json& rows, const Cell& cell_of) {
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> cells;
  for (const Json& row : rows) {
    const std::string name = name_of(row);
    if (!cells.contains(name)) names.push_back(name);
    cells[name].push_back(cell_of(row));
  }
  for (const std::string& name : names) print_row(name, cells[name]);
}

void report_large_strain() {
  const Json reference = support::calculix("hyperelastic");
  for (const double poisson_ratio : {0.45, 0.49}) report_cube(poisson_ratio, reference["uniaxial"], reference["shear"]);

  fmt::print("block: 1.5, .45 | .6, .45 | 1.5, .49 | .6, .49\n");
  report_reference(reference["block"], [](const Json& row) { return cell({row["force"], row["volume_ratio"]}); });
  for (const Element& element : kOfEveryForm) {
    std::vector<std::string> cells;
    for (const double poisson_ratio : {0.45, 0.49})
      for (const double stretch : {1.5, 0.6})
        cells.push_back(cell(support::held_block(poisson_ratio, stretch, element.settings())));
    print_row(element.name, cells);
  }

  fmt::print("cantilever: 20 x 2 x 2 at .3, .45, .49 | 10 x 1 x 1 at the same\n");
  report_reference(reference["cantilever"],
                   [](const Json& row) { return fmt::format("{:.4f}", row["deflection"].get<double>()); });
  for (const Element& element : kOfEveryForm) {
    std::vector<std::string> cells;
    for (const auto& [across, force] : {std::pair(2, 0.0875), std::pair(1, 0.35)})
      for (const double poisson_ratio : {0.3, 0.45, 0.49})
        cells.push_back(
            fmt::format("{:.4f}", support::large_deflection(poisson_ratio, across, force, element.settings())));
    print_row(element.name, cells);
  }
}

// ---- isolated rest shapes

std::string both(const support::BentCantilever& beam) { return both(1e3 * beam.loaded, 1e3 * beam.released); }

/// [mm] under the load and after it.
void report_cantilevers(const Json& reference) {
  fmt::print("cantilever: load, mesh | beam theory | joined, 15 / nu | creep in 1 / nu | isolated | creep | C3D8I\n");
  for (const Json& row : reference) {
    support::Cantilever beam{.cells = row["cells"], .load = row["load"], .poisson_ratio = row["poisson_ratio"]};
    const support::BentCantilever isolated = support::bend(beam);
    beam.rest_shape = RestShape::kJoined;
    beam.time = 15;
    const support::BentCantilever joined = support::bend(beam);
    print_row(fmt::format("{}, {}, nu {}", beam.load, fmt::join(beam.cells, "x"), beam.poisson_ratio),
              {both(support::bend_in_theory(beam)), both(joined), fmt::format("{:.1e}", joined.creep), both(isolated),
               fmt::format("{:.1e}", isolated.creep), both({.loaded = row["loaded"], .released = row["released"]})});
  }
}

/// Peak and permanent elongation, or twist [deg] of the end, with joined and isolated rest shapes, beside C3D8I.
void report_isolated_bar(const std::string& name, double yield_stress, double flow_rate, EndLoad load, double force,
                         support::Schedule schedule, const std::string& file, const std::string& key,
                         const std::string& value) {
  for (const int refine : {1, 2}) {
    const Json wanted = {{key, value}, {"element", "C3D8I"}, {"refine", refine}};
    const Json theirs = support::row_of(support::calculix(file), wanted);
    const auto expected = [&](const char* when) -> double {
      constexpr int kEnd = 5;  // of the layers from the middle
      return load == EndLoad::kFaceTwist ? support::twist_deg(theirs[when], kEnd)
                                         : theirs[when]["mean_elongation"].get<double>();
    };
    const double peak = expected("peak"), residual = expected("residual");
    std::vector<std::string> cells{fmt::format("{:.4g} / {:.4g}", peak, residual)};
    for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated}) {
      BarCase bar = plastic(yield_stress, flow_rate, load, force, schedule);
      bar.settings = kDefault.settings({.recovery = RecoveryMode::kNone});
      bar.settings.rotation_plasticity = RotationPlasticity::kNone;
      bar.settings.rest_shape = rest_shape;
      if (rest_shape == RestShape::kIsolated && yield_stress > 200)  // where strains are large
        bar.settings.yield_stress_measure = YieldStressMeasure::kCauchy;
      bar.refine = refine;
      bar.dt = 1 / (2 * flow_rate);
      const BarRun run = support::run_bar(bar);
      const auto found = [&](const support::BarState& state) {
        return load == EndLoad::kFaceTwist ? state.twist_deg.back() : state.mean_elongation;
      };
      cells.push_back(fmt::format("{:.4g} / {:.4g} ({:+.1f} / {:+.1f} %, {} unsolved)", found(run.peak),
                                  found(run.residual), 100 * (found(run.peak) / peak - 1),
                                  100 * (found(run.residual) / residual - 1), run.unsolved));
    }
    print_row(fmt::format("{}, refined {}", name, refine - 1), cells);
  }
}

void report_isolated() {
  const Json reference = support::calculix("beyond_yield");
  report_cantilevers(reference["cantilever"]);

  fmt::print("limit moment over the exact one: isolated | C3D8I\n");
  for (const Json& row : reference["limit_moment"]) {
    const bool is_plate = row["is_plate"];
    const int cells = row["cells"];
    const double poisson_ratio = row["poisson_ratio"], theirs = row["moment"];
    print_row(fmt::format("{}, {}, nu {}", is_plate ? "plate" : "beam", cells, poisson_ratio),
              texts("{:.3f}", std::array{support::limit_moment(cells, is_plate, poisson_ratio),
                                         theirs / support::exact_limit_moment(is_plate)}));
  }

  fmt::print("loop: cells | residual curvature (1.5556) | moment at .9 on the way back (-.6486) | rms\n");
  for (const Json& row : reference["loop"]) {
    const int cells = row["cells"];
    for (const auto& [name, moments] : {std::pair("isolated", support::bend_to_and_fro(cells)),
                                        std::pair("C3D8I", row["moment"].get<std::vector<double>>())}) {
      const support::BendingLoop loop = support::loop_of(moments);
      print_row(fmt::format("{}, {}", cells, name),
                texts("{:.4f}", std::array{loop.residual_curvature, loop.reversed_moment, loop.rms}));
    }
  }

  fmt::print("tube: cells | outer displacement | residual hoop stress at the bore (exact) | rms\n");
  for (const Json& row : reference["tube"]) {
    const int cells = row["cells"];
    const support::ExpandedTube exact = support::tube_in_theory(cells);
    for (const auto& [name, tube] : {std::pair("isolated", support::expand_tube(cells)),
                                     std::pair("C3D8I", support::ExpandedTube{row["outer_displacement"], row["hoop"]})})
      print_row(fmt::format("{}, {}", cells, name),
                {fmt::format("{:+.2f} %", 100 * (tube.outer_displacement / exact.outer_displacement - 1)),
                 fmt::format("{:.4f} ({:.4f})", tube.hoop[0], exact.hoop[0]),
                 fmt::format("{:.4f}", support::rms(tube.hoop, exact.hoop))});
  }

  fmt::print("block: stretch 1.1 | 1.2 | 1.3\n");
  print_row("C3D8I", texts("{:.3f}", reference["block"][0]["force"].get<std::vector<double>>()));
  for (const auto& [moves, flows] : {std::pair(2, 2), std::pair(2, 6), std::pair(10, 10)})
    print_row(fmt::format("{} plastic steps in each of {} moves per %", flows, moves),
              texts("{:.3f}", support::stretch_block(moves, flows)));

  fmt::print("patch: height 2 mm | 4 | 6 | 8 | 10 | 12, force [N]; least corner ratio\n");
  for (const Json& mesh : reference["patch"])
    print_row(fmt::format("{}, {} mm", mesh["element"].get<std::string>(), 1e3 * mesh["edge"].get<double>()),
              texts("{:.3f}", mesh["force"].get<std::vector<double>>()));
  for (const double edge : {0.01, 0.005}) {
    std::vector<std::string> row;
    for (const support::PulledPatch& found : support::pull_patch(edge, 0.012))
      row.push_back(fmt::format("{:.3f}; {:.2f}", found.force, found.least_corner));
    print_row(fmt::format("isolated, {} mm", 1e3 * edge), row);
  }

  fmt::print("bars: case | C3D8I | joined | isolated\n");
  const auto central = EndLoad::kCentralStretch, face = EndLoad::kFaceStretch, twist = EndLoad::kFaceTwist;
  report_isolated_bar("tau 50, F .05, central", 50, 5, central, 0.05, {}, "bar_variants", "case",
                      "stretch_viscoCalib_tau50_nu5_F0.05_C3D8");
  report_isolated_bar("tau 100, F .1, central", 100, 5, central, 0.1, {}, "bar_variants", "case",
                      "stretch_viscoCalib_tau100_nu5_F0.1_C3D8");
  report_isolated_bar("tau 100, F .117, face", 100, 5, face, 0.117, {}, "bar_elements", "load", "stretchface");
  report_isolated_bar("tau 250, F .3, face", 250, 20, face, 0.3, kSlowStretch, "bar_variants", "case",
                      "refineface_plast_tau250_F0.3_C3D8_r1");
  report_isolated_bar("tau 100, twist", 100, 20, twist, 0.06, kSlowTwist, "bar_variants", "case",
                      "twistface_plast_tau100_f0.06_C3D8");
}

/// Stress, strain or deflection over that of slow deformation, and the range of its differences from theory.
void report_relaxation() {
  const Json reference = support::calculix("relaxation");
  const std::vector<double> times = reference["time"];
  for (const std::string name : {"held bar", "held shear", "loaded bar", "loaded beam", "loaded thin beam"}) {
    const std::vector<double> exact = support::relax_in_theory(name, times);
    const auto row = [&](const std::string& who, const std::vector<double>& values) {
      std::vector<double> differences;
      for (std::size_t n = 0; n < values.size(); ++n) differences.push_back(100 * (values[n] / exact[n] - 1));
      const auto [least, greatest] = std::ranges::minmax(differences);
      std::vector<std::string> cells = texts("{:.4f}", values);
      cells.push_back(fmt::format("{:+.3f} ... {:+.3f} %", least, greatest));
      print_row(fmt::format("{}, {}", name, who), cells);
    };
    row("exact", exact);
    row("ours", support::relax(name, times));
    for (const Json& theirs : reference["cases"])
      if (theirs["case"] == name) row(theirs["element"], theirs["value"]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string_view, void (*)()> tables{{"", report_bars},
                                                      {"--locking", report_locking},
                                                      {"--hyperelastic", report_large_strain},
                                                      {"--isolated", report_isolated},
                                                      {"--relaxation", report_relaxation}};
  const auto table = tables.find(argc == 1 ? "" : argv[1]);
  if (argc > 2 || table == tables.end()) {
    fmt::print(stderr, "usage: calculix_table [--locking | --hyperelastic | --isolated | --relaxation]\n");
    return 2;
  }
  table->second();
}
