// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes whose bodies are on a device, by its emulation.
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

std::string beam(const std::string& body,
                 const std::string& solver = "<CGLinearSolver tolerance='1e-6' iterations='200'/>") {
  return "<Node name='root' dt='0.01'><EulerImplicitSolver/>" + solver +
         "<RegularGridTopology name='grid' n='4 2 2' max='3 1 1'/><MechanicalObject name='nodes'/>"
         "<DiagonalMass massDensity='10'/><HexahedronElastoplasticFEMForceField name='body' poissonRatio='0.4' " +
         body + "/></Node>";
}

// Grips take part in every iteration of the solver.
TEST(Device, ComputesAShippedScene) {
  scene::Scene cpu = shipped("liver_cage"), device = shipped("liver_cage", {"liver/material.device=emulation"});
  for (scene::Scene* scene : {&cpu, &device}) run(*scene, 60);
  const auto moved = [](scene::Scene& scene) -> const PointArray& {
    return at<scene::MechanicalState>(scene, "liver/nodes").positions();
  };
  const PointArray& start = body(cpu, "liver/material").mesh().positions();
  EXPECT_GT((moved(cpu) - start).cwiseAbs().maxCoeff(), 0.005);
  EXPECT_LE((moved(device) - moved(cpu)).cwiseAbs().maxCoeff(), 2e-5);
  EXPECT_GT(body(cpu, "liver/material").dissipated_energy(), 0);
  EXPECT_EQ(body(device, "liver/material").device(), "emulation");
  EXPECT_TRUE(device.diagnostics().take_warnings().empty());
}

TEST(Device, IsRefusedByTheAttribute) {
  const std::string who = "test.scn:1: error: HexahedronElastoplasticFEMForceField.device: = 'emulation': ";
  EXPECT_EQ(errors_of(beam("device='emulation'")), who + "precision must be mixed");
  EXPECT_EQ(errors_of(beam("device='emulation' precision='mixed' law='neoHookean'")), who + "law must be corotated");
  EXPECT_NE(errors_of(beam("device='opencl'")).find("'opencl'"), std::string::npos);
}

TEST(Device, StaysWhatItIs) {
  EXPECT_NE(
      errors_of(beam("precision='mixed'", "<CGLinearSolver/>" + attribute_change("body", "device", "0", "emulation")))
          .find("has no attribute 'device' that may change"),
      std::string::npos);
}

TEST(Device, IsSolvedForByConjugateGradientsAloneOrWithOtherBodies) {
  const std::string body = "device='emulation' precision='mixed'";
  const auto error_of = [](const std::string& text) -> std::string {
    scene::Scene scene = read_and_init(text);
    try {
      run(scene, 1);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_NE(error_of(beam(body, "<SparseLDLSolver/>")).find("its solver must be one of conjugate gradients"),
            std::string::npos);
  for (const char* solver : {"<CGLinearSolver/>", "<MultigridCGLinearSolver/>"}) {
    const std::string of_body = beam(body, ""), node = of_body.substr(of_body.find("<RegularGridTopology"));
    const std::string both = "<Node name='root' dt='0.01'><EulerImplicitSolver/>" + std::string(solver) +
                             "<Node name='a'>" + node + "<Node name='b'>" + node + "</Node>";
    EXPECT_EQ(error_of(both), "nothing");
  }
}

TEST(Device, RefusesAMaterialThatItCannotCompute) {
  scene::Scene scene =
      read_and_init(beam("device='emulation' precision='mixed' plasticFlowRate='1' yieldNorm='frobenius'",
                         "<CGLinearSolver/>" + attribute_change("body", "yieldStress", "0", "100")));
  try {
    run(scene, 1);
    FAIL();
  } catch (const scene::SceneError& error) {
    EXPECT_NE(
        std::string(error.what()).find("HexahedronElastoplasticFEMForceField.device: = 'emulation': yieldNorm must be"),
        std::string::npos)
        << error.what();
  }
}

}  // namespace
