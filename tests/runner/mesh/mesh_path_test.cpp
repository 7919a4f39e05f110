// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes whose meshes lie elsewhere.
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

/// A body on a cube of a mesh file that lies in far/mesh.
class MeshPath : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    fs::create_directories(directory_ / "far/mesh");
    fs::copy(HEXAPLAST_TEST_DATA "/meshes/block.msh", directory_ / "far/mesh/cube.msh");
    write("a.scn",
          "<Node dt='0.01' gravity='0 0 -9.81'><DefaultAnimationLoop/><RunSettings steps='20'/><EulerImplicitSolver/>"
          "<SparseLDLSolver/><MeshGmshLoader name='loader' filename='mesh/cube.msh'/><MeshTopology src='@loader'/>"
          "<MechanicalObject/><UniformMass totalMass='1'/>"
          "<HexahedronElastoplasticFEMForceField youngModulus='1e5' poissonRatio='0.3'/></Node>");
  }
};

TEST_F(MeshPath, IsAnOptionOfEveryVerbThatReadsScenes) {
  EXPECT_EQ(hexaplast("check a.scn").code, 3);
  for (const char* verb : {"check a.scn", "run a.scn --quiet", "mesh export a.scn -o a.vtu",
                           "sweep a.scn --vary .dt=0.01,0.02 --out sweep --jobs 1"}) {
    succeeds(std::string(verb) + " --mesh-path none --mesh-path far");
  }
}

TEST_F(MeshPath, BelongsToARunThatIsResumed) {
  succeeds("run a.scn --mesh-path far --out whole --frames 0 --quiet --final whole.json");
  succeeds("run a.scn --mesh-path far --out half --frames 0 --quiet --steps 10 --checkpoint every=10");
  succeeds("resume half --steps 20 --quiet --final half.json");
  EXPECT_EQ(read("half.json"), read("whole.json"));
  // another mesh of that name is another scene
  fs::copy(HEXAPLAST_TEST_DATA "/meshes/organ.obj", directory_ / "far/mesh/cube.msh",
           fs::copy_options::overwrite_existing);
  EXPECT_NE(hexaplast("resume half --steps 30 --quiet").code, 0);
}

}  // namespace
