// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast mesh grid, sheet, tube, sphere-patch, offset, cage, info, convert and export, and scenes whose meshes lie
// elsewhere.
#include <cmath>

#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "support/command.hpp"
#include "support/golden.hpp"

namespace {

using namespace hexaplast;
using namespace support;

class MeshMake : public Command {
 protected:
  Json info(const std::string& file) {
    const Outcome outcome = succeeds("mesh info " + file + " --json");
    return Json::parse(outcome.out, nullptr, false);
  }

  /// What a command that must succeed prints.
  std::string made(const std::string& words) {
    const Outcome outcome = succeeds("mesh " + words);
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }

  /// Commands that must fail and leave no file behind.
  void expect_none_made(std::initializer_list<std::tuple<std::string, int, std::string>> lines) {
    for (const auto& [words, code, message] : lines)
      expect_refused({{"mesh " + words + " -o made.vtu", code, message}});
    EXPECT_FALSE(is_there("made.vtu"));
  }
};

// Two quads at a right angle, counter-clockwise seen from above and from +x.
const std::string kCorner = "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 1 0 -1\nv 1 2 -1\nf 1 2 3 4\nf 2 5 6 3\n";

TEST_F(MeshMake, OffsetsAnOpenSurface) {
  write("corner.obj", kCorner);
  EXPECT_EQ(made("offset corner.obj --thickness 0.1 --layers 2 -o shell.vtu"),
            "shell: shell over 2 quads of an open surface\n"
            "  nodes               18\n"
            "  hexahedra           4 in 1 part, 16 faces outside\n"
            "  size                1.1 x 2 x 1.1 m, 0.42 m^3\n"
            "  shape               min scaled Jacobian 0.707 (hexahedron 0), edges 0.05 to 2 m\n"
            "  worst shaped over   quads 0, 1\n");
  EXPECT_NEAR(info("shell.vtu")["body"]["volume"].get<double>(), 2 * (1.1 * 1.1 - 1), 1e-14);
  // the corner of the walls is mitred: 1 x 1 without .9 x .9, and half a layer on either side of both
  made("offset corner.obj --thickness 0.1 --direction inward -o shell.vtu");
  EXPECT_NEAR(info("shell.vtu")["body"]["volume"].get<double>(), 2 * (1 - 0.9 * 0.9), 1e-14);
  made("offset corner.obj --thickness 0.1 --direction both -o shell.vtu");
  EXPECT_NEAR(info("shell.vtu")["body"]["volume"].get<double>(), 2 * (1.05 * 1.05 - 0.95 * 0.95), 1e-14);
}

TEST_F(MeshMake, OffsetRefusesWhatFoldsOrIsNoSurface) {
  write("corner.obj", kCorner);
  write("mixed.obj", kCorner + "f 5 6 1\n");
  write("broken.obj", kCorner + "f 2 5 66 3\n");
  made("grid --cells 1 1 1 --size 1 1 1 -o cube.vtu");
  expect_none_made({{"offset corner.obj --thickness 1.5 --direction inward", 3,
                     "corner.obj: error: 2 quads fold when offset by 1.5 inward and 0 outward: 0, 1; the worst is "},
                    {"offset mixed.obj --thickness 0.1", 3, "mixed.obj: error: 1 triangles, or parts of polygons"},
                    {"offset broken.obj --thickness 0.1", 3, "hexaplast: error: broken.obj:9: '66' is none of the 6"},
                    {"offset absent.obj --thickness 0.1", 5, "absent.obj: error: no such file"},
                    {"offset corner.obj --thickness -0.1", 2, "-0.1: must be a finite number greater than 0"},
                    {"offset corner.obj --thickness 0.1 --layers 0", 2, "--layers"},
                    {"offset corner.obj --thickness 0.1 --direction up", 2, "--direction"},
                    {"offset corner.obj", 2, "--thickness is required"},
                    {"offset cube.vtu --thickness 0.1", 3, "1 hexahedra, must be a surface of quads"}});
}

TEST_F(MeshMake, OffsetLeavesOutVerticesWithoutFaceAndSaysSo) {
  write("corner.obj", "v 7 7 7\n" + kCorner.substr(0, kCorner.find('f')) + "f 2 3 4 5\nf 3 6 7 4\n");
  const Outcome outcome = succeeds("mesh offset corner.obj --thickness 0.1 -o shell.vtu");
  EXPECT_EQ(outcome.err,
            "corner.obj: warning: 1 vertices without a face are left out, and the others numbered without them\n");
  EXPECT_EQ(read_mesh(directory_ / "shell.vtu").positions.rows(), 12);
}

TEST_F(MeshMake, MakesShapes) {
  made("grid --cells 3 2 4 --size 0.3 0.2 0.8 --origin -1 0 2 -o grid.vtu");
  EXPECT_EQ(read_mesh(directory_ / "grid.vtu").positions.row(0), Eigen::RowVector3d(-1, 0, 2));
  EXPECT_NEAR(info("grid.vtu")["body"]["volume"].get<double>(), 0.048, 1e-15);
  made("sheet --cells 8 4 2 --size 0.2 0.1 --thickness 0.01 --curvature 4 -o sheet.vtu");
  EXPECT_NEAR(info("sheet.vtu")["body"]["volume"].get<double>(), 2e-4 * std::sin(0.1) / 0.1, 1e-15);
  made("tube --cells 2 12 5 --inner 0.1 --outer 0.15 --length 0.7 -o tube.vtu");
  EXPECT_NEAR(info("tube.vtu")["body"]["volume"].get<double>(), 3 * (0.0225 - 0.01) * 0.7, 1e-12);
  EXPECT_EQ(info("tube.vtu")["body"]["boundary_faces"], 2 * 12 * 5 + 2 * 12 * 2);
  made("sphere-patch --cells 4 4 2 --inner 0.1 --outer 0.12 --angle 60 -o patch.vtu");
  EXPECT_EQ(info("patch.vtu")["hexahedra"], 32);
}

TEST_F(MeshMake, TubesFollowArcsAndCurves) {
  made("tube --cells 1 8 10 --inner 0.1 --outer 0.15 --length 1 --bend 90 -o bent.vtu");
  const double radius = 2 / std::acos(-1);  // the last section lies in the plane x = radius
  EXPECT_NEAR(read_mesh(directory_ / "bent.vtu").positions.col(0).maxCoeff(), radius, 1e-14);

  write("curve.obj", "v 0 0 0\nv 0 0 1\nv 0 0 3\nl 1 2 3\n");
  made("tube --cells 1 8 6 --inner 0.1 --outer 0.15 --along curve.obj -o along.vtu");
  made("tube --cells 1 8 6 --inner 0.1 --outer 0.15 --length 3 -o straight.vtu");
  EXPECT_LT((read_mesh(directory_ / "along.vtu").positions - read_mesh(directory_ / "straight.vtu").positions)
                .cwiseAbs()
                .maxCoeff(),
            0.01);
}

TEST_F(MeshMake, ShapesRefuseWhatMeansNothing) {
  const std::string tube = "tube --cells 1 8 6 --inner 0.1 --outer 0.15";
  expect_none_made({{tube, 2, "either --length or --along must be given"},
                    {tube + " --bend 90", 2, "--bend requires --length"},
                    {"tube --cells 1 8 --inner 0.1 --outer 0.15 --length 1", 2, "--cells"},
                    {"tube --cells 1 2 6 --inner 0.1 --outer 0.15 --length 1", 3,
                     "hexaplast mesh tube: error: a grid of 2 cells in direction 1: at least 3 needed"},
                    {"grid --cells 100000 100000 100000 --size 1 1 1", 3, "1e+15 cells, must be at most 16777216"},
                    {"sheet --cells 1 1 1 --size 1 1 --thickness 0", 3, "thickness: 0 must be > 0"},
                    {"grid --cells 1 0 1 --size 1 1 1", 3, "0 cells in direction 1"},
                    {"grid --cells 1 1 1 --size 1 0 1", 2, "0: must be a finite number"},
                    {"grid --cells 1 1 1 --size 1 inf 1", 2, "inf: must be a finite number"}});
  expect_refused({{"mesh grid --cells 1 1 1 --size 1 1 1 -o cube.stl", 2, "cube.stl"},
                  {"mesh grid --cells 1 1 1 --size 1 1 1 -o nowhere/cube.vtu", 5, "nowhere/cube.vtu"}});
}

TEST_F(MeshMake, ConvertsEveryKindOfCellAndSaysWhatItLeavesOut) {
  const std::string two = std::string("'") + HEXAPLAST_TEST_DATA + "/meshes/two_41_binary.msh'";
  const Outcome outcome = succeeds("mesh convert " + two + " -o two.vtu");
  EXPECT_TRUE(has(outcome.err, "warning: 1 cells are skipped"));
  const ImportedMesh mesh = read_mesh(directory_ / "two.vtu");
  EXPECT_EQ(mesh.hexahedra.size(), 2u);
  EXPECT_EQ(mesh.quads.size(), 1u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.edges.size(), 1u);
  write("old.vtu", "precious");
  EXPECT_EQ(hexaplast("mesh convert old.vtu -o two.vtu").code, 3);
  EXPECT_EQ(read_mesh(directory_ / "two.vtu").hexahedra.size(), 2u) << "a good file stays";
}

// The commands of the README, on copies of the files that it names: the sheet tears where it is held by the forceps.
TEST_F(MeshMake, TheSheetOfTheReadmeIsGrownAndTorn) {
  for (const char* file : {"sheet.obj", "sheet.scn"})
    write(file, content(std::string(HEXAPLAST_SOURCE_DIR) + "/docs/examples/sheet/" + file));
  made("offset sheet.obj --thickness 0.004 --layers 2 -o sheet.vtu");
  const Outcome check = succeeds("check sheet.scn");
  EXPECT_EQ(check.err, "");
  EXPECT_TRUE(has(check.out, "351, of which 54 are fixed"));
  const Outcome run = succeeds("run sheet.scn --steps 110 --final final.json");
  const Json final = json("final.json");
  const Json& ratios = final["volume_ratio"];
  const auto num_torn = std::ranges::count_if(ratios, [](const Json& ratio) { return ratio == 0; });
  EXPECT_GE(num_torn, 6);
  EXPECT_LE(num_torn, 40);
}

TEST_F(MeshMake, InfoTellsSurfacesFromBodies) {
  write("corner.obj", kCorner);
  EXPECT_EQ(made("info corner.obj"),
            "corner\n  nodes               6\n  quads               2\n  size                1 x 2 x 1 m\n"
            "  surface             open; can be offset less than 1 m inward, any way outward\n");
  const Json surface = info("corner.obj");
  EXPECT_EQ(surface["body"], nullptr);
  EXPECT_EQ(surface["surface"], Json::parse(R"({"closed": false, "most_inward": 1.0, "most_outward": null})"));
  write("mixed.obj", kCorner + "f 5 6 1\n");
  EXPECT_TRUE(has(made("info mixed.obj"), "cannot be offset: 1 triangles"));
  EXPECT_EQ(hexaplast("mesh info absent.vtu").code, 5);
  EXPECT_EQ(hexaplast("mesh info corner.stl").code, 5);
}

TEST_F(MeshMake, InfoNamesWhatIsLeftOut) {
  for (const char* file : {"second_order.msh", "duplicate_hexahedron.msh"})
    write(file, content(std::string(HEXAPLAST_TEST_DATA "/meshes/") + file));
  const Json second_order = info("second_order.msh");
  EXPECT_EQ(second_order["skipped_cells"], 1);
  EXPECT_EQ(second_order["skipped_kinds"], (Json{{"hexahedra of 20 nodes", 1}}));
  EXPECT_TRUE(has(hexaplast("mesh info second_order.msh").err, "first order: 1 hexahedra of 20 nodes\n"));
  const Json copies = info("duplicate_hexahedron.msh");
  EXPECT_EQ(copies["copies"], 1);
  EXPECT_NEAR(copies["body"]["volume"], 2, 1e-12);
  EXPECT_EQ(copies["body"]["boundary_faces"], 10);
}

/// The faces of an axis-aligned box as OBJ, its vertices numbered from `first` on.
std::string box(const Vec3& min, const Vec3& max, int first = 1) {
  std::ostringstream text;
  for (int n = 0; n < 8; ++n)
    text << "v " << (n & 1 ? max : min)[0] << ' ' << (n & 2 ? max : min)[1] << ' ' << (n & 4 ? max : min)[2] << '\n';
  for (const auto& [a, b, c, d] :
       {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    text << "f " << first + a << ' ' << first + b << ' ' << first + c << ' ' << first + d << '\n';
  return text.str();
}

class MeshCage : public Command {
 protected:
  ImportedMesh written() { return read_mesh(directory_ / "cage.vtu"); }
};

// A plate of 2 x 1 x 0.6 m in cubes of 0.204 m: 10 x 5 x 3, of which 8 x 3 x 1 are inside.
TEST_F(MeshCage, LaysCubesAroundASurface) {
  write("plate.obj", box(Vec3(0, 0, 0), Vec3(2, 1, 0.6)));
  const Outcome outcome = succeeds("mesh cage plate.obj --cells 10 -o cage.vtu");
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(outcome.out,
            "plate: cage of cubes of 0.204 m\n  nodes               264\n"
            "  hexahedra           150  (126 touched by the surface, 24 enclosed)\n  parts               1\n");
  const ImportedMesh cage = written();
  EXPECT_EQ(cage.positions.rows(), 264);
  EXPECT_EQ(cage.hexahedra.size(), 150u);
  const ImportedMesh surface = read_mesh(directory_ / "plate.obj");
  EXPECT_EQ(Embedding(cage.positions, cage.hexahedra, surface.positions).num_outside(), 0);
  EXPECT_TRUE(has(read("cage.vtu"), "Name=\"enclosed\""));
}

TEST_F(MeshCage, RefusesPartsUnlessAskedFor) {
  write("two.obj", box(Vec3(0, 0, 0), Vec3(1, 1, 1)) + box(Vec3(4, 0, 0), Vec3(5, 1, 1), 9));
  fails("mesh cage two.obj --cells 10 -o cage.vtu", 3,
        "two.obj: error: the cage has 2 parts that share no face: use fewer, larger cells, or --allow-parts\n");
  EXPECT_FALSE(is_there("cage.vtu"));
  succeeds("mesh cage two.obj --cells 10 -o cage.vtu --allow-parts");
  succeeds("mesh cage two.obj --cells 1 -o cage.vtu");
  EXPECT_EQ(written().hexahedra.size(), 1u);
}

TEST_F(MeshCage, SaysWhereHexahedraAreHinged) {
  write("two.obj", box(Vec3(.1, .1, .1), Vec3(.9, .9, .9)) + box(Vec3(1.1, 1.1, .1), Vec3(1.9, 1.9, .9), 9));
  const Outcome outcome = hexaplast("mesh cage two.obj --cells 2 -o cage.vtu --allow-parts");
  EXPECT_EQ(outcome.err,
            "warning: hexahedra meet at 2 nodes without sharing a face there: they fold freely about them\n");
}

TEST_F(MeshCage, RefusesWhatItCannotDo) {
  write("plate.obj", box(Vec3(0, 0, 0), Vec3(2, 1, 0.6)));
  write("broken.obj", "v 0 0 0\nv 1 0\n");
  write("points.obj", "v 0 0 0\nv 1 0 0\n");
  write("plate.stl", "");
  write("good.vtu", "good");
  const std::string into_good = " -o good.vtu";
  expect_refused({{"mesh cage absent.obj --cells 3" + into_good, 5, "absent.obj: error: no such file\n"},
                  {"mesh cage broken.obj --cells 3" + into_good, 3,
                   "hexaplast: error: broken.obj:2: '' is not a coordinate: must be a finite number\n"},
                  {"mesh cage points.obj --cells 3" + into_good, 3,
                   "points.obj: error: the surface has neither triangles nor quads\n"},
                  {"mesh cage plate.stl --cells 3" + into_good, 3, "plate.stl"},
                  {"mesh cage plate.obj --cells 100000" + into_good, 3, "at most 134217728 are possible"},
                  {"mesh cage plate.obj --cells 0" + into_good, 2, "--cells"},
                  {"mesh cage plate.obj" + into_good, 2, "--cells"},
                  {"mesh cage plate.obj --cells 3 -o cage.obj", 2, "--out cage.obj: the name must end in .vtu\n"},
                  {"mesh cage plate.obj --cells 3 -o nowhere/cage.vtu", 5, "nowhere/cage.vtu"}});
  EXPECT_EQ(read("good.vtu"), "good");
}

/// A body on a cube of a mesh file that lies in far/mesh.
class MeshPath : public Command {
 protected:
  MeshPath() {
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

// Against another program, where it is installed. Without lateral contraction a pulled bar stays a prism, and both laws
// agree to the square of the strain (here 1e-4).
TEST_F(Command, ABarIsPulledAsFarAsByCalculix) {
  if (shell("command -v ccx").code != 0) GTEST_SKIP() << "ccx is not installed";
  write("bar.scn",
        "<Node name='root' gravity='0 0 0'><DefaultAnimationLoop/><RunSettings steps='1'/><StaticSolver/>"
        "<NewtonRaphsonSolver maxNbIterationsNewton='9' absoluteResidualStoppingThreshold='1e-9'/><SparseLDLSolver/>"
        "<RegularGridTopology n='3 2 2'/><MechanicalObject/><HexahedronElastoplasticFEMForceField "
        "youngModulus='1000' poissonRatio='0'/><FixedProjectiveConstraint indices='0 3 6 9'/>"
        "<ConstantForceField indices='2 5 8 11' totalForce='0.1 0 0'/></Node>");
  const Outcome written = shell("PATH=/usr/bin:$PATH '" HEXAPLAST_SOURCE_DIR
                                "/benchmarks/calculix/scene_deck.py' --hexaplast '" HEXAPLAST_COMMAND "' bar.scn");
  ASSERT_EQ(written.code, 0) << written.err;
  write("deck.inp", written.out);
  ASSERT_EQ(shell("OMP_NUM_THREADS=1 ccx -i deck").code, 0);
  Eigen::MatrixXd theirs = Eigen::MatrixXd::Constant(12, 3, std::nan(""));  // displacements [m], of seven digits
  std::istringstream lines(read("deck.dat"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    int node = 0;
    double x = 0, y = 0, z = 0;
    if (numbers >> node >> x >> y >> z) theirs.row(node - 1) << x, y, z;  // of the last increment in the end
  }

  EXPECT_EQ(succeeds("run bar.scn --quiet --final final.json").err, "");
  const Json final = json("final.json");
  const Eigen::MatrixXd ours = matrix(final["positions"]) - matrix(final["plastic_rest_positions"]);
  EXPECT_NEAR(ours(2, 0), 1e-4, 1e-10);
  EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 3e-4 * 1e-4);
}

}  // namespace
