// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/core.hpp"

namespace hexaplast {
namespace {

class GoldenMesh : public testing::TestWithParam<std::string> {
 protected:
  const std::string mode = GetParam();
  const Json data = golden("mesh_" + mode + (mode == "objective" ? "_gn" : ""));
  const Json& params = data["parameters"];
  Body body{HexMesh(matrix(data["X"]), hexahedra(data["H"])),
            {material(params)},
            settings(params, mode, RotationFrame::kBestFit)};

  GoldenMesh() { body.state().model.turns_isolated_shapes = true; }
};

TEST_P(GoldenMesh, ThreePlasticStepsAtHeldPositions) {
  constexpr double tolerance = 1e-8;
  const PointArray current = matrix(data["xh"]);
  for (const Json& step : data["steps"]) {
    const std::vector<double> beta = body.fields(current).volume_ratio;
    body.flow(current, params["dt"]);

    const History& history = body.state().history;
    EXPECT_TRUE(agrees(history.plastic_rest_positions, matrix(step["x"]), tolerance));
    for (int e = 0; e < body.mesh().num_elements(); ++e) {
      EXPECT_TRUE(agrees(beta[e], step["beta"][e].get<double>(), tolerance));
      EXPECT_TRUE(agrees(history.rest_shape[e], matrix(step["y"][e]), tolerance));
      const ElementHistory element = history.element(body.state().model, e);
      for (int a = 0; a < kCorners; ++a) {
        const Json& Pi = mode == "paper_vertex" ? step["Pi_vertex"][e][a] : step["Pi"][e];
        EXPECT_TRUE(agrees(element.rotation_map[a], matrix(Pi), tolerance));
        EXPECT_TRUE(agrees(history.yield_stress[e][a], step["tau"][e][a].get<double>(), tolerance));
        EXPECT_TRUE(agrees(history.rotation_yield[e][a], step["tauR"][e][a].get<double>(), tolerance));
      }
    }
  }
}

TEST_P(GoldenMesh, TwentyDynamicSteps) {
  constexpr double tolerance = 1e-6;
  const Json& dynamic = data["dynamic"];
  std::vector<int> loaded;  // 8 N along z on every node above 0.15 m
  for (int n = 0; n < body.mesh().num_nodes(); ++n) {
    if (body.mesh().positions()(n, 2) > 0.15) loaded.push_back(n);
  }
  Motion setup;
  setup.density = params["density"];
  setup.dt = dynamic["dt"];
  setup.euler = {.rayleigh_mass = params["rayleighMass"], .rayleigh_stiffness = params["rayleighStiffness"]};
  setup.fixed = dynamic["fixed"].get<std::vector<int>>();
  setup.load = [&](double, ConstPoints, Points f) {
    for (const int n : loaded) f(n, 2) += 8;
  };
  MovingBody simulation(std::move(body), std::move(setup));

  simulation.run(1);
  EXPECT_TRUE(agrees(simulation.positions, matrix(dynamic["xh_step1"]), tolerance));
  simulation.run(4);
  EXPECT_TRUE(agrees(simulation.positions, matrix(dynamic["xh_step5"]), tolerance));
  simulation.run(15);
  EXPECT_TRUE(agrees(simulation.positions, matrix(dynamic["xh_step20"]), tolerance));
  EXPECT_TRUE(agrees(simulation.body.state().history.plastic_rest_positions, matrix(dynamic["x_step20"]), tolerance));
}

INSTANTIATE_TEST_SUITE_P(Modes, GoldenMesh, testing::Values("objective", "paper_vertex", "paper_centre"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace hexaplast
