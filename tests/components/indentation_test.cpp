// SPDX-License-Identifier: LGPL-2.1-or-later
// A ball that is pressed into an elastic block, against Hertz and CalculiX (docs/validation.md).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using Json = nlohmann::json;

const Json& reference() {
  static const Json table = Json::parse(std::ifstream(HEXAPLAST_TEST_DATA "/calculix/indentation.json"));
  return table;
}

const Json& coarse() { return reference()["meshes"]["coarse"]; }

/// Coordinates of a graded mesh [m]: those of the coarse one [mm] with each interval in equal parts.
std::vector<double> refined(const Json& coarse, int parts) {
  std::vector<double> places;
  for (std::size_t k = 0; k + 1 < coarse.size(); ++k)
    for (int n = 0; n < parts; ++n) {
      const double low = coarse[k], high = coarse[k + 1];
      places.push_back(1e-3 * (low + (high - low) * n / parts));
    }
  places.push_back(1e-3 * coarse.back().get<double>());
  return places;
}

/// A quarter of the block with planes of symmetry, held at its bottom, and a ball that comes down by each depth [m] and
/// stays there for a while. Steps of .1 s are longer than a period of the block: every stay ends at rest.
struct Indentation {
  static constexpr double kStep = 0.1;         // [s]
  static constexpr int kDown = 5, kStay = 15;  // steps

  Indentation(int parts, double poisson_ratio, const std::vector<double>& depths, double stiffness) {
    const std::vector<double> x = refined(coarse()["across"], parts), z = refined(coarse()["up"], parts);
    const int n = static_cast<int>(x.size()), m = static_cast<int>(z.size());
    std::string positions, hexahedra, bottom, left, front;
    for (int k = 0; k < m; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          positions += fmt::format("{} {} {} ", x[i], x[j], z[k]);
          const int node = (k * n + j) * n + i;
          if (k == 0) bottom += fmt::format("{} ", node);
          if (i == 0 && k > 0) left += fmt::format("{} ", node);
          if (j == 0 && k > 0) front += fmt::format("{} ", node);
          if (i + 1 == n || j + 1 == n || k + 1 == m) continue;
          for (const int corner : {0, 1, n + 1, n, n * n, n * n + 1, n * n + n + 1, n * n + n})
            hexahedra += fmt::format("{} ", node + corner);
        }
    const double radius = reference()["radius"], top = z.back() + radius;
    std::string times = "0", places = fmt::format("0 0 {}", top);
    for (std::size_t d = 0; d < depths.size(); ++d) {
      const double begin = kStep * static_cast<double>(d * (kDown + kStay));
      times += fmt::format(" {} {}", begin + kStep * kDown, begin + kStep * (kDown + kStay));
      for (int end = 0; end < 2; ++end) places += fmt::format("  0 0 {}", top - depths[d]);
    }
    const auto planes = [](const std::string& nodes, const std::string& direction) {
      return "<PartialFixedProjectiveConstraint indices='" + nodes + "' fixedDirections='" + direction + "'/>";
    };
    scene = std::make_unique<scene::Scene>(support::read_and_init(fmt::format(
        "<Node dt='{}' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/>"
        "<MultigridCGLinearSolver tolerance='1e-6'/><MeshTopology position='{}' hexahedra='{}'/>"
        "<MechanicalObject name='nodes'/><UniformMass totalMass='.01'/>"
        "<HexahedronElastoplasticFEMForceField youngModulus='{}' poissonRatio='{}'/>"
        "<FixedProjectiveConstraint indices='{}'/>{}{}"
        "<InstrumentContactForceField name='ball' radius='{}' contactStiffness='{}' keyTimes='{}' positions='{}'/>"
        "</Node>",
        kStep, positions, hexahedra, reference()["young_modulus"].get<double>(), poisson_ratio, bottom,
        planes(left, "1 0 0"), planes(front, "0 1 0"), radius, stiffness, times, places)));
    for (std::size_t d = 0; d < depths.size(); ++d) {
      support::run(*scene, kDown + kStay);
      forces.push_back(4 * at<scene::Component>(*scene, "ball").reals("force")[2]);
    }
  }

  std::unique_ptr<scene::Scene> scene;
  std::vector<double> forces;  // [N] on the whole ball, at the end of each stay
};

/// [N] Hertz, with the correction for a layer that sticks to a rigid ground (Dimitriadis et al., Biophys. J. 82, 2002).
double hertz(double depth, double E, double nu, double radius, double thickness) {
  constexpr double pi = std::numbers::pi;
  const double chi = std::sqrt(radius * depth) / thickness;
  const double a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  const double factor = 1 - 2 * a / pi * chi + 4 * a * a / (pi * pi) * chi * chi -
                        8 / std::pow(pi, 3) * (std::pow(a, 3) + 4 * pi * pi / 15 * b) * std::pow(chi, 3) +
                        16 * a / std::pow(pi, 4) * (std::pow(a, 3) + 3 * pi * pi / 5 * b) * std::pow(chi, 4);
  return 4 * E * std::sqrt(radius) * std::pow(depth, 1.5) / (3 * (1 - nu * nu)) * factor;
}

double thickness() { return 1e-3 * coarse()["up"].back().get<double>(); }

int refinement() {
  const char* given = std::getenv("HEXAPLAST_REFINEMENT");
  return given ? std::atoi(given) : 1;
}

// On the coarse mesh, or with each of its edges in HEXAPLAST_REFINEMENT parts.
TEST(Indentation, AgreesWithCalculixAndHertz) {
  const int parts = refinement();
  const double E = reference()["young_modulus"], nu = reference()["poisson_ratio"], radius = reference()["radius"];
  const std::vector<double> depths = {0.25e-3, 0.5e-3, 1e-3};
  const Indentation ours(parts, nu, depths, reference()["penalty"]);
  for (std::size_t d = 0; d < depths.size(); ++d) {
    const double by_hertz = hertz(depths[d], E, nu, radius, thickness());
    std::cout << fmt::format("depth {:.2f} mm, refinement {}: {:.5f} N, Hertz {:.5f}", 1e3 * depths[d], parts,
                             ours.forces[d], by_hertz);
    EXPECT_NEAR(ours.forces[d], by_hertz, 0.05 * by_hertz) << depths[d];
    for (const Json& row : reference()["cases"]) {
      const double by_calculix = row["force"][d];
      const std::string law = row["law"], mesh = row["mesh"];
      std::cout << fmt::format(", {} {} {:.5f}", mesh, law, by_calculix);
      // St. Venant-Kirchhoff's law is softer under pressure than the others
      if (parts == 1 && law != "stVenantKirchhoff") {
        EXPECT_NEAR(ours.forces[d], by_calculix, 0.05 * by_calculix) << depths[d] << " " << law;
      }
    }
    std::cout << "\n";
  }
}

}  // namespace
