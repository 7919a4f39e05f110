// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast render, and the pictures that hexaplast run makes.
#include "support/command.hpp"

namespace {

using namespace hexaplast;
using namespace support;

/// A bar without any held node, so that a picture shows nothing that its files do not know: pulled at both ends, it
/// yields.
const std::string kBar =
    "<Node name='root' gravity='0 0 0' dt='0.01'>\n<DefaultAnimationLoop/><RunSettings steps='10' outputEvery='5'/>"
    "<EulerImplicitSolver/><SparseLDLSolver/>\n<RegularGridTopology n='2 2 4' max='0.25 0.25 0.75'/><MechanicalObject/>"
    "<DiagonalMass massDensity='1000'/>\n<HexahedronElastoplasticFEMForceField youngModulus='5000' poissonRatio='0.3' "
    "yieldStress='100' plasticFlowRate='4'/>\n<ConstantForceField indices='0 1 2 3' forces='0 0 -4'/>"
    "<ConstantForceField indices='12 13 14 15' forces='0 0.5 4'/></Node>";

/// The same, held at one end, under gravity and a load, in the hand of an instrument, with a surface in its cage and a
/// camera.
const std::string kScene =
    "<Node name='root' gravity='0 -9.81 0' dt='0.005'>\n<DefaultAnimationLoop/><RunSettings steps='10' "
    "outputEvery='5'/>"
    "<VisualStyle displayFlags='showVisualModels showBehaviorModels'/>"
    "<InteractiveCamera position='1.2 0.9 1.6' lookAt='0.1 0.1 0.4' fieldOfView='34'/>"
    "<EulerImplicitSolver/><SparseLDLSolver/>\n<RegularGridTopology n='2 2 4' max='0.25 0.25 0.75'/><MechanicalObject/>"
    "<DiagonalMass massDensity='1000'/>\n<HexahedronElastoplasticFEMForceField youngModulus='50000' poissonRatio='0.3' "
    "yieldStress='100' plasticFlowRate='4'/>\n<FixedProjectiveConstraint indices='0 1 2 3'/>"
    "<ConstantForceField indices='6 11' forces='3 0 -4'/>"
    "<GraspForceField radius='0.2' keyTimes='0 0.05' positions='0.2 0.2 0.8  0.2 0.25 0.85' stiffness='900'/>"
    "<Node name='skin'><OglModel position='0.04 0.13 0.1  0.2 0.05 0.1  0.07 0.2 0.7  0.21 0.1 0.65  0.1 0.12 0.8' "
    "quads='0 1 3 2' triangles='2 3 4'/><BarycentricMapping/></Node></Node>";

/// A block with a skin, which a blade cuts from the side while hexahedra beside the cut break, and behind it a bar in
/// the hand of an instrument, which breaks while the cut goes on.
const std::string kCutScene =
    "<Node gravity='0 0 0' dt='0.01'>\n<DefaultAnimationLoop/><RunSettings steps='12' outputEvery='4'/>"
    "<VisualStyle displayFlags='showVisualModels showBehaviorModels'/>"
    "<InteractiveCamera position='-1.4 0.9 0.2' lookAt='0.2 0.2 0.2' fieldOfView='34'/>"
    "<EulerImplicitSolver rayleighMass='1'/><SparseLDLSolver/>\n<Node name='block'>"
    "<RegularGridTopology n='5 5 5' max='.4 .4 .4'/><MechanicalObject/><DiagonalMass massDensity='1000'/>"
    "<HexahedronElastoplasticFEMForceField youngModulus='2000' yieldStress='1e9' plasticFlowRate='40' "
    "fractureStretch='9'/><MaterialRegion indices='37 38' yieldStress='10' fractureStretch='1.01'/>"
    "<FixedProjectiveConstraint indices='0-24'/><ConstantForceField indices='100-124' totalForce='0 0 60'/>"
    "<BladeController points='0 -1 0  0 1 0' keyTimes='0 0.12' positions='-.1 0 .21  .32 0 .21'/>"
    "<Node name='skin'><OglModel position='.03 .03 .03  .37 .03 .03  .03 .37 .03  .37 .37 .03  .03 .03 .37  "
    ".37 .03 .37  .03 .37 .37  .37 .37 .37' quads='0 1 5 4  2 6 7 3  0 2 3 1  4 5 7 6  0 4 6 2  1 3 7 5'/>"
    "<BarycentricMapping/></Node></Node>\n<Node name='bar'>"
    "<RegularGridTopology n='2 2 4' min='.6 0 0' max='.7 .1 .3'/><MechanicalObject/><DiagonalMass massDensity='1000'/>"
    "<HexahedronElastoplasticFEMForceField youngModulus='5000' yieldStress='1e9' plasticFlowRate='40' "
    "fractureStretch='9'/><MaterialRegion indices='1' yieldStress='10' fractureStretch='1.01'/>"
    "<FixedProjectiveConstraint indices='0-3'/><GraspForceField radius='0.2' keyTimes='0 0.12' "
    "positions='.65 .05 .3  .65 .05 .4' stiffness='900'/></Node></Node>";

int num_frames(const std::string& film) {
  const std::size_t at = film.find("acTL");
  return at == film.npos ? 0 : static_cast<unsigned char>(film[at + 7]);
}

class Render : public Command {
 protected:
  Render() {
    write("bar.scn", kBar);
    const Outcome run = succeeds("run bar.scn --out bar --frames 0 --quiet");
  }

  /// The picture that options make.
  std::string picture(const std::string& options, const std::string& size = "160x90") {
    const Outcome outcome = succeeds("render bar -o picture.png --size " + size + " " + options);
    return read("picture.png");
  }

  void expect_refusal(const std::string& options, int code, const std::string& part) {
    fails("render " + options, code, part);
    EXPECT_FALSE(is_there("render.png")) << options;
  }

  void replace(const std::string& file, const std::string& from, const std::string& to) {
    write(file, replaced(read(file), from, to));
  }
};

// Surfaces, cage, camera, fixed nodes, loads, instruments, gravity, title and time: all of it is in the files.
TEST_F(Render, MakesThePictureThatTheRunMadeOfAWholeScene) {
  write("scene.scn", kScene);
  succeeds("run scene.scn --out whole --frames 1 --quiet");
  succeeds("render whole");
  EXPECT_EQ(read("render.png"), read("whole/frames/frame_000010.png"));

  fs::remove(directory_ / "render.png");

  // and each of these shows in it
  const auto small = [&](const std::string& options) {
    succeeds("render whole --size 160x90 --out small.png " + options);
    return read("small.png");
  };
  const std::string plain = small("");
  const auto differs = [&](const char* what, const std::string& options) { EXPECT_NE(small(options), plain) << what; };
  differs("surfaces without the cage", "--show surfaces");
  differs("hexahedra", "--show hexahedra");
  differs("no marks", "--no-marks");
  differs("another view", "--view right");
  fs::rename(directory_ / "whole/instruments.pvd", directory_ / "whole/other");
  differs("no instruments", "");
  fs::rename(directory_ / "whole/other", directory_ / "whole/instruments.pvd");
  fs::remove(directory_ / "whole/manifest.json");
  differs("no camera, no gravity", "");
  fs::remove(directory_ / "whole/surface.pvd");
  differs("no surface", "");
  expect_refusal("whole --show surfaces", 2, "--show surfaces: this run holds no surface.pvd");
}

// The film has the states 0, 4, 8, 12: before and amid the cut.
TEST_F(Render, MakesThePicturesOfACutWhileHexahedraGo) {
  write("cut.scn", kCutScene);
  succeeds("run cut.scn --out cut --frames 0 --video run.png --quiet");
  const std::vector<double> removed = history("cut").numbers("removed"), opened = history("cut").numbers("opened");
  ASSERT_EQ(removed.back(), 3);
  const auto gone = std::ranges::find(removed, 3.0) - removed.begin();
  EXPECT_GT(opened[static_cast<std::size_t>(gone)], 0) << "amid the cut";
  EXPECT_LT(opened[static_cast<std::size_t>(gone)], opened.back());
  succeeds("render cut --video film.png");
  EXPECT_EQ(num_frames(read("film.png")), 4);
  EXPECT_EQ(read("film.png"), read("run.png"));
  EXPECT_FALSE(has(read("cut/mesh_000000.vtu"), "Name=\"crossing\""));
  EXPECT_TRUE(has(read("cut/mesh_000012.vtu"), "Name=\"crossing\" NumberOfComponents=\"6\""));
  EXPECT_TRUE(has(read("cut/mesh_000012.vtu"), "Name=\"removed\" NumberOfComponents=\"15\" NumberOfTuples=\"3\""));
  EXPECT_FALSE(has(read("cut/surface_000000.vtu"), "Name=\"wall\""));
  EXPECT_TRUE(has(read("cut/surface_000012.vtu"), "Name=\"wall\""));
  replace("cut/mesh_000012.vtu", "Name=\"removed\" NumberOfComponents=\"15\"",
          "Name=\"removed\" NumberOfComponents=\"14\"");
  expect_refusal("cut", 3, "mesh_000012.vtu:");
}

TEST_F(Render, ShowsNoArrowsWhereTheSceneHidesForceFields) {
  const auto picture_of_scene = [&](const std::string& flags) {
    write("scene.scn", replaced(kScene, "showVisualModels showBehaviorModels", flags));
    succeeds("run scene.scn --out flags --force --frames 0 --quiet");
    succeeds("render flags --size 320x180");
    return read("render.png");
  };
  const std::string shown = picture_of_scene("showVisualModels showBehaviorModels");
  EXPECT_NE(picture_of_scene("showVisualModels showBehaviorModels hideForceFields"), shown);
  EXPECT_EQ(picture_of_scene("hideAll showAll"), shown);
}

TEST_F(Render, RefusesDamagedCompanions) {
  write("scene.scn", kScene);
  succeeds("run scene.scn --out whole --frames 0 --quiet");
  replace("whole/mesh_000010.vtu", "Name=\"load\" NumberOfComponents=\"3\"", "Name=\"load\" NumberOfComponents=\"2\"");
  expect_refusal("whole", 3, "mesh_000010.vtu:");
  replace("whole/instruments_000005.vtu", "Name=\"force\"", "Name=\"farce\"");
  expect_refusal("whole --step 5", 3, "instruments_000005.vtu: holds no array 'force' of points; it holds: id, node");
  replace("whole/surface_000000.vtu", "Name=\"surface\"", "Name=\"sirface\"");
  expect_refusal("whole --step 0", 3, "surface_000000.vtu: holds no array 'surface' of points");
  fs::remove(directory_ / "whole/surface_000000.vtu");
  expect_refusal("whole --step 0", 3, "surface_000000.vtu");
}

TEST_F(Render, FindsStatesByStepAndByTime) {
  const std::string fifth = picture("--step 5");
  EXPECT_EQ(fifth.substr(16, 8), std::string("\0\0\0\xa0\0\0\0\x5a", 8)) << "160 x 90 pixels";
  EXPECT_NE(fifth, picture(""));
  EXPECT_EQ(fifth, picture("--time 0.06"));
  EXPECT_EQ(picture("--time 0.1"), picture("--step 10"));
  expect_refusal("bar --time 99", 2, "--time 99: this run holds 0 to 0.1 s");
  expect_refusal("bar --step 7", 2, "--step 7: this run holds 0, 5, 10");
}

TEST_F(Render, EveryOptionChangesThePicture) {
  const std::string plain = picture("");
  std::vector<std::string> seen{plain};
  for (const char* options :
       {"--field stress", "--field yield", "--field volume_ratio", "--field speed", "--range 0:0.5", "--view top",
        "--view 1,0.2,-0.3", "--camera 1,1,2:0.1,0.1,0.4:30", "--slice z:0.4", "--sections z:3", "--sections x:2",
        "--shape rest", "--ghost rest", "--ghost none", "--no-edges", "--no-marks", "--slice x:0.1 --field stress"}) {
    seen.push_back(picture(options));
    EXPECT_EQ(std::ranges::count(seen, seen.back()), 1) << options;
  }
  EXPECT_EQ(picture("--view front"), picture("--view 0,0,2"));
  EXPECT_EQ(picture("--show hexahedra"), plain);
}

TEST_F(Render, RefusesOptionsThatMakeNoSense) {
  for (const char* size : {"320", "63x200", "320x4097", "320x", "32.5x200", "axb"})
    expect_refusal(std::string("bar --size ") + size, 2, "each from 64 to 4096 pixels");
  for (const char* range : {"1", "1:1", "2:1", "a:b", "0:nan", "0:1:2"})
    expect_refusal(std::string("bar --range ") + range, 2, "two numbers LO:HI");
  for (const char* view : {"up", "1,2", "0,0,0", "1,2,inf"})
    expect_refusal(std::string("bar --view ") + view, 2, "front, back, left, right, top, bottom");
  for (const char* camera : {"1,2,3", "1,2,3:1,2,3:30", "1,2,3:0,0,0:180", "1,2,3:0,0:30", "1,2,3:30"})
    expect_refusal(std::string("bar --camera ") + camera, 2, "field of view");
  for (const char* slice : {"0.1", "w:0.1", "x:", "x:one"})
    expect_refusal(std::string("bar --slice ") + slice, 2, "an axis and a place on it");
  expect_refusal("bar --slice x:0.4", 2, "--slice x:0.4: does not meet the body, which lies between");
  for (const char* sections : {"z", "z:0", "z:2.5", "z:101"})
    expect_refusal(std::string("bar --sections ") + sections, 2, "how many sections, from 1 to 100");
  expect_refusal("bar --field colour", 2, "--field");
  expect_refusal("bar --sections z:3 --slice z:0.1", 2, "--sections");
  expect_refusal("bar --video film.mp4", 2, ".png or .apng; others are made of it by ffmpeg -i film.png");
}

TEST_F(Render, SaysWhatIsMissing) {
  expect_refusal("nowhere", 5, "nowhere: is not there");
  expect_refusal("bar.scn", 3, "bar.scn:");
  write("empty.pvd", "<VTKFile><Collection/></VTKFile>");
  expect_refusal("empty.pvd", 3, "names no state");
  write("odd.pvd", "<VTKFile>\n<Collection>\n<DataSet timestep='soon' file='a.vtu'/></Collection></VTKFile>");
  expect_refusal("odd.pvd", 3, "odd.pvd:3: DataSet.timestep 'soon'");

  replace("bar/mesh_000010.vtu", "Name=\"stress_norm\"", "Name=\"other\"");
  expect_refusal("bar --field stress", 3,
                 "mesh_000010.vtu: holds no array 'stress_norm' of cells; it holds: id, part, other");
  replace("bar/mesh_000005.vtu", "NumberOfPoints=\"16\"", "NumberOfPoints=\"15\"");
  expect_refusal("bar --step 5", 3, "mesh_000005.vtu:");
  fs::remove(directory_ / "bar/mesh_000000.vtu");
  expect_refusal("bar", 3, "mesh_000000.vtu");
  EXPECT_EQ(hexaplast("render bar -o nowhere/picture.png").code, 3);
}

TEST_F(Render, KeepsAnOlderPictureWhereItFails) {
  const std::string plain = picture("");
  EXPECT_EQ(hexaplast("render bar -o picture.png --slice x:9").code, 2);
  EXPECT_EQ(read("picture.png"), plain);
  EXPECT_EQ(hexaplast("render bar -o bar").code, 5) << "a directory";
}

TEST_F(Render, FieldAndUpOfARunAreThoseOfItsPictures) {
  const auto own = [&](const std::string& options) {
    succeeds("run bar.scn --out bar --force --frames 1 --quiet " + options);
    return read("bar/frames/frame_000010.png");
  };
  EXPECT_EQ(own("--field stress"), picture("--field stress", "1280x720"));
  const std::string up = own("--up -x");
  EXPECT_EQ(picture("", "1280x720"), up);
  EXPECT_EQ(picture("--up -x", "1280x720"), up);
  EXPECT_NE(picture("--up y", "1280x720"), up);
  EXPECT_EQ(hexaplast("run bar.scn --out bar --force --field warmth").code, 2);
}

// RunRecord has the numbers that the files hold.
TEST_F(Render, ShowsRegionsByTheirColours) {
  write("regions.scn", replaced(kBar, "</Node>",
                                "<MaterialRegion name='ends' indices='0 2' youngModulus='6000'/>"
                                "<MaterialRegion name='top' indices='2' youngModulus='7000'/></Node>"));
  succeeds("run regions.scn --out regions --frames 1 --field region --quiet");
  succeeds("render regions -o by_region.png --size 160x90 --field region");
  succeeds("render regions -o by_strain.png --size 160x90");
  EXPECT_NE(read("by_region.png"), read("by_strain.png"));
  succeeds("render regions -o within.png --size 160x90 --region top");
  succeeds("render regions -o strain_within.png --size 160x90 --region top --field plastic_strain");
  EXPECT_NE(read("within.png"), read("by_region.png"));
  EXPECT_NE(read("within.png"), read("strain_within.png"));
  succeeds("run regions.scn --out again --frames 1 --region top --quiet");
  succeeds("render regions -o large.png --region top");
  EXPECT_EQ(read("again/frames/frame_000010.png"), read("large.png"));
  expect_refusal("regions --region tumour", 2, "--region tumour: must be ends or top");
  expect_refusal("regions --region top --range 0:1", 2, "--range 0:1: regions have no scale");
  expect_refusal("bar --region top", 2, "--region top: there are no regions");

  // a run without regions has no such array
  expect_refusal("bar --field region", 3, "holds no array 'region' of cells");
}

}  // namespace
