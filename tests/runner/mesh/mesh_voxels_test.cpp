// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast mesh voxels: the synthetic liver of scenes/mesh/liver_tumour.py, and files made to hurt.
#include <zlib.h>

#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "support/cost.hpp"

namespace {

using namespace hexaplast;
using namespace support;

class MeshVoxels : public Command {
 protected:
  /// Draws the liver as files of that ending.
  void draw(const std::string& ending) {
    const std::string script = HEXAPLAST_SOURCE_DIR "/scenes/mesh/liver_tumour.py";
    const Outcome drawn = shell("/usr/bin/python3 '" + script + "' liver" + ending);
    ASSERT_EQ(drawn.code, 0) << drawn.err;
  }
  ImportedState written(const std::string& name) { return read_vtu_state(directory_ / name); }
};

TEST_F(MeshVoxels, MakesTheSameMeshOfEveryFormat) {
  std::vector<ImportedState> states;
  for (const std::string ending : {".seg.nrrd", ".nii.gz", ".mha"}) {
    draw(ending);
    succeeds("mesh voxels liver" + ending + " -o liver" + ending + ".vtu");
    states.push_back(written("liver" + ending + ".vtu"));
    ASSERT_EQ(states.back().cell_data.size(), 1u);
    EXPECT_EQ(states.back().cell_data.front().name, "label");
    EXPECT_TRUE(states.back().mesh.is_of_patient);
  }
  for (const ImportedState& state : states) {
    EXPECT_EQ(state.mesh.hexahedra, states.front().mesh.hexahedra);
    EXPECT_EQ(state.cell_data.front().values, states.front().cell_data.front().values);
    // single precision of NIfTI at 1.3 m
    EXPECT_LT((state.mesh.positions - states.front().mesh.positions).cwiseAbs().maxCoeff(), 2e-7);
  }
}

TEST_F(MeshVoxels, PrintsLabelsNamesAndVolumes) {
  draw(".seg.nrrd");
  const Outcome all = hexaplast("mesh voxels liver.seg.nrrd -o liver.vtu");
  EXPECT_EQ(all.out,
            "liver: hexahedra of 5 x 4.5 x 4 mm\n  nodes               11601\n  hexahedra           9674 in 2 parts\n"
            "  label 1             8978 hexahedra, 808.02 ml  liver\n"
            "  label 2             432 hexahedra, 38.88 ml  tumour\n"
            "  label 3             264 hexahedra, 23.76 ml  vessel\n"
            "  from                -0.111344 -0.0510919 1.234 m\n  to                  0.0906084 0.127878 1.318 m\n");
  EXPECT_EQ(all.err, "");
  const Outcome coarse =
      succeeds("mesh voxels liver.seg.nrrd --coarsen 2 --largest-part --labels 1,2 --unit mm -o liver.vtu");
  EXPECT_TRUE(has(coarse.out, "hexahedra of 10 x 9 x 8 mm\n"));
  EXPECT_TRUE(has(coarse.out, "in 1 part\n  left out            "));
  EXPECT_FALSE(has(coarse.out, "label 3"));
  EXPECT_GT(written("liver.vtu").mesh.positions.maxCoeff(), 1200);
}

// The mesh of scenes/mesh is what the command of docs/commands.md makes of the drawing.
TEST_F(MeshVoxels, ShippedMeshIsThatOfTheDrawing) {
  draw(".seg.nrrd");
  const std::string folder = HEXAPLAST_SOURCE_DIR "/scenes/mesh/";
  succeeds("mesh voxels liver.seg.nrrd --coarsen 2 --largest-part -o liver_tumour.vtu");
  const Outcome of_file = hexaplast("mesh voxels '" + folder +
                                    "liver_tumour.seg.nrrd' --coarsen 2 --largest-part -o liver_tumour_file.vtu");
  const ImportedState drawn = written("liver_tumour.vtu"), from_file = written("liver_tumour_file.vtu"),
                      shipped = read_vtu_state(folder + "liver_tumour.vtu");
  for (const ImportedState* other : {&drawn, &from_file}) {
    EXPECT_EQ(other->mesh.hexahedra, shipped.mesh.hexahedra);
    EXPECT_EQ(other->cell_data.front().values, shipped.cell_data.front().values);
    EXPECT_LT((other->mesh.positions - shipped.mesh.positions).cwiseAbs().maxCoeff(), 1e-12);
  }
  const std::string page = content(HEXAPLAST_SOURCE_DIR "/docs/commands.md");
  const std::string printed = of_file.out.substr(of_file.out.find('\n'));
  EXPECT_TRUE(has(page, printed)) << of_file.out;
}

// Coarse cells of which half count leave out voxels at the border.
TEST_F(MeshVoxels, CoverKeepsEveryVoxel) {
  draw(".mha");
  for (const std::string options : {" -o fine.vtu", " --coarsen 3 -o half.vtu", " --coarsen 3 --cover -o cover.vtu"})
    succeeds("mesh voxels liver.mha" + options);
  const ImportedMesh fine = written("fine.vtu").mesh;
  PointArray centres(static_cast<Eigen::Index>(fine.hexahedra.size()), 3);
  for (std::size_t e = 0; e < fine.hexahedra.size(); ++e)
    centres.row(static_cast<Eigen::Index>(e)) = gather(fine.positions, fine.hexahedra[e]).colwise().mean();
  const auto num_outside = [&](const std::string& file) {
    const ImportedMesh mesh = written(file).mesh;
    return Embedding(mesh.positions, mesh.hexahedra, centres).num_outside();
  };
  EXPECT_EQ(num_outside("cover.vtu"), 0);
  EXPECT_GT(num_outside("half.vtu"), 100);
}

TEST_F(MeshVoxels, SceneOfASegmentationRuns) {
  draw(".seg.nrrd");
  const std::string make = "mesh voxels liver.seg.nrrd --coarsen 3 --largest-part --cover -o meshes/liver.vtu ";
  std::filesystem::create_directory(directory_ / "meshes");
  succeeds(make + "--scene 'a & b.scn'");
  const Outcome checked = succeeds("check 'a & b.scn' --json");
  EXPECT_EQ(checked.err, "");
  const Json found = Json::parse(checked.out);
  ASSERT_EQ(found["regions"].size(), 2u) << "the liver has the material of the body";
  EXPECT_EQ(found["regions"][0]["path"], "organ/tumour");
  EXPECT_GT(found["held_nodes"], 10);
  EXPECT_LT(found["held_nodes"], found["nodes"].get<int>() / 4);
  const ImportedMesh surface = read_mesh(directory_ / "meshes/liver_surface.obj"),
                     mesh = written("meshes/liver.vtu").mesh;
  EXPECT_LT(Embedding(mesh.positions, mesh.hexahedra, surface.positions).greatest_distance(), 0.5 * 5e-3)
      << "smoothing moves it by half a voxel at most";
  const std::string said = succeeds("run 'a & b.scn' --steps 70 --summary sum").err;
  EXPECT_TRUE(has(said, "warning: the probe 'pull' was 0 throughout\n")) << "the forceps come later";
  EXPECT_FALSE(has(said, "push"));
  EXPECT_GT(json("sum")["probes"]["push"], 0.1) << "[N] in the middle of the time for which the ball presses";

  // two segments of one name, and one that a region without a name would have
  write("twice.seg.nrrd",
        replaced(replaced(read("liver.seg.nrrd"), "Name:=vessel", "Name:=tumour"), "Name:=liver", "Name:=label_3"));
  succeeds("mesh voxels twice.seg.nrrd --coarsen 4 --largest-part --cover -o twice.vtu --scene twice--x.scn");
  const Json twice = Json::parse(succeeds("check twice--x.scn --json").out);
  EXPECT_EQ(twice["regions"][0]["path"], "organ/tumour");
  EXPECT_EQ(twice["regions"][1]["path"], "organ/label_3");
  succeeds("run twice--x.scn --steps 1");

  // a scene that is there has been edited, perhaps
  const std::string before = read("a & b.scn");
  EXPECT_EQ(hexaplast(make + "--hold left --scene 'a & b.scn'").code, 5);
  EXPECT_EQ(read("a & b.scn"), before);
  succeeds(make + "--hold left --scene 'a & b.scn' --force");
  EXPECT_NE(read("a & b.scn"), before);

  for (const auto& [hold, what] : {std::pair("'9 9 9 9 9 9'", "0 of "), {"above", "a side or a box"}}) {
    fails(make + "--scene new.scn --force --hold " + hold, 2, what);
    EXPECT_FALSE(is_there("new.scn"));
  }
}

// SOFA's reader counts the numbers of the connectivity by their blanks, and takes offsets for 32-bit numbers.
TEST_F(MeshVoxels, AsTextIsTheSameMeshInTheFormThatSofaReads) {
  draw(".seg.nrrd");
  const std::string make = "mesh voxels liver.seg.nrrd --coarsen 2 --largest-part ";
  succeeds(make + "-o binary.vtu");
  succeeds(make + "--ascii -o text.vtu");
  const ImportedState binary = written("binary.vtu"), text = written("text.vtu");
  EXPECT_EQ(text.mesh.positions, binary.mesh.positions);
  EXPECT_EQ(text.mesh.hexahedra, binary.mesh.hexahedra);
  EXPECT_EQ(text.cell_data.at(0).values, binary.cell_data.at(0).values);

  const std::string content = read("text.vtu");
  EXPECT_FALSE(has(content, "\"Int64\""));
  const std::size_t begin = content.find('>', content.find("connectivity")) + 1;
  const std::string numbers = content.substr(begin, content.find('<', begin) - begin);
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), ' ') + 1, static_cast<long>(8 * text.mesh.hexahedra.size()));
  EXPECT_EQ(numbers.find_last_of('\n'), numbers.size() - 1);
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), '\n'), 2);
}

TEST_F(MeshVoxels, WritesSurfaces) {
  draw(".seg.nrrd");
  write("liver_2.obj", "old");
  succeeds("mesh voxels liver.seg.nrrd --largest-part --surfaces -o liver.vtu");
  for (const std::string label : {"1", "2", "3"}) {
    const Outcome info = succeeds("mesh info liver_" + label + ".obj");
    EXPECT_TRUE(has(info.out, "  surface             closed"));
  }
  // the ball of the tumour is 42 mm wide
  const ImportedMesh tumour = read_mesh(directory_ / "liver_2.obj");
  const Vec3 extent = tumour.positions.colwise().maxCoeff() - tumour.positions.colwise().minCoeff();
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(extent[d], 0.042, 0.0025);
}

/// A segmentation of one byte per voxel, of 1 mm each.
std::string nrrd(const std::string& sizes, const std::string& data, const std::string& encoding = "raw") {
  return "NRRD0004\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: " + sizes +
         "\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: " + encoding + "\n\n" + data;
}

TEST_F(MeshVoxels, WarnsOfHingesAndOfAFileWithoutFrame) {
  write("hinge.nrrd", nrrd("2 2 1", std::string("\1\0\0\1", 4)));
  const Outcome hinge = succeeds("mesh voxels hinge.nrrd -o out.vtu");
  EXPECT_EQ(hinge.err,
            "warning: hexahedra meet at 2 nodes without sharing a face there: they fold freely about them\n");
  write("plain.nrrd", "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nspacings: 1 1 1\nencoding: raw\n\n\1");
  EXPECT_EQ(
      hexaplast("mesh voxels plain.nrrd -o out.vtu").err,
      "plain.nrrd: warning: the file does not say where left, back and head are: its axes are taken for x, y and z\n");
}

// A label may vanish: by coarsening, with a part that is left out, or before, in a segment without voxels.
TEST_F(MeshVoxels, WarnsOfLabelsThatAreLost) {
  const std::string segments = "Segment0_LabelValue:=5\nSegment0_Name:=duct\n";
  write("lost.nrrd", nrrd("4 2 2", std::string("\1\1\0\2\1\1\0\0\1\1\0\0\1\1\0\0", 16)).insert(9, segments));
  const std::string segment = "lost.nrrd: warning: no voxel has the label 5 of the segment 'duct'\n",
                    lost = "warning: no hexahedron has the label 2, though voxels have it\n";
  EXPECT_EQ(hexaplast("mesh voxels lost.nrrd -o out.vtu").err, segment);
  EXPECT_EQ(hexaplast("mesh voxels lost.nrrd --coarsen 2 -o out.vtu").err, segment + lost);
  EXPECT_EQ(hexaplast("mesh voxels lost.nrrd --largest-part -o out.vtu").err, segment + lost);
  EXPECT_EQ(hexaplast("mesh voxels lost.nrrd --labels 1 --coarsen 2 -o out.vtu").err, segment);
}

TEST_F(MeshVoxels, RefusesWhatItCannotDo) {
  write("small.nrrd", nrrd("2 2 1", std::string("\1\0\2\1", 4)));
  write("empty.nrrd", nrrd("2 2 1", std::string(4, '\0')));
  write("small.nhdr", nrrd("2 2 1", "").insert(9, "data file: voxels.vtu\n"));
  write("voxels.vtu", std::string("\1\0\2\1", 4));
  write("good.vtu", "good");
  const std::string voxels = "mesh voxels ", into_good = " -o good.vtu", small = voxels + "small.nrrd ";
  expect_refused(
      {{voxels + "absent.nrrd" + into_good, 5, "absent.nrrd: error: no such file\n"},
       {voxels + "good.vtu" + into_good, 3,
        "good.vtu: a segmentation's name must end in .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd\n"},
       {voxels + "empty.nrrd" + into_good, 3, "empty.nrrd: error: no voxel has a label other than 0\n"},
       {small + "--labels 1,5" + into_good, 3, "small.nrrd: error: no voxel has the label 5: must be one of 1, 2\n"},
       {small + "--labels 1,x" + into_good, 2, "--labels"},
       {small + "--coarsen 0" + into_good, 2, "--coarsen"},
       {small + "--unit inch" + into_good, 2, "--unit"},
       {small + "-o good.msh", 2, "--out good.msh: the name must end in .vtu\n"},
       {small + "-o nowhere/good.vtu", 5, "nowhere/good.vtu"},
       {voxels + "small.nhdr -o voxels.vtu", 5, "voxels.vtu: is an input"}});  // the file of its data
  EXPECT_EQ(read("good.vtu"), "good");
  EXPECT_EQ(read("voxels.vtu").size(), 4u);
  succeeds(voxels + "small.nhdr" + into_good);
}

using HostileVolume = Hostile;

/// `megabytes` of one byte, by zlib.
std::string packed(std::size_t megabytes, char byte) {
  const std::string chunk(1 << 20, byte);
  z_stream stream{};
  deflateInit(&stream, 9);
  std::string all(compressBound(megabytes << 20) / 500 + 1000, '\0');
  stream.next_out = reinterpret_cast<Bytef*>(all.data());
  stream.avail_out = static_cast<uInt>(all.size());
  for (std::size_t i = 0; i < megabytes; ++i) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(chunk.data()));
    stream.avail_in = 1 << 20;
    EXPECT_EQ(deflate(&stream, i + 1 == megabytes ? Z_FINISH : Z_NO_FLUSH), i + 1 == megabytes ? Z_STREAM_END : Z_OK);
  }
  all.resize(stream.total_out);
  deflateEnd(&stream);
  return all;
}

TEST_F(HostileVolume, AreRefused) {
  std::string keys = "NRRD0004\n", intensities;
  for (int i = 0; i < 100'000; ++i) keys += "Segment" + std::to_string(i) + "_Name:=a\n";
  for (int i = 0; i < 30'000; ++i) intensities += std::string{static_cast<char>(i % 251), static_cast<char>(i / 251)};
  const std::string too_many = "hexahedra or more, must be at most 16777216: coarsen them",
                    image = replaced(nrrd("100 100 3", intensities), "type: uchar", "type: ushort\nendian: little");
  for (const auto& [name, bytes, message] : std::vector<std::tuple<const char*, std::string, std::string>>{
           // small files that claim to be large
           {"a.nrrd", nrrd("100000 100000 100000", "abc"), "cannot come from 3 bytes of data"},
           {"a.nrrd", nrrd("2147483647 2147483647 2147483647", "abc", "gzip"),
            "cannot come from 3 bytes of compressed data"},
           {"a.nrrd", nrrd("1024 1024 256", std::string("\x1f\x8b\x08", 3), "gzip"), "cannot come from"},
           {"a.nrrd", nrrd("1024 1024 1024", packed(300, 1), "gzip"), "1024 x 1024 x 1024 voxels: must be at most"},
           // few bytes that stand for many
           {"a.nrrd", nrrd("1024 1024 128", packed(128, 0), "gzip"), "no voxel has a label other than 0"},
           {"a.nrrd", nrrd("1024 1024 16", packed(256, 0), "gzip"), "the data go on after the last voxel"},
           {"a.nrrd", nrrd("1024 1018 128", packed(64, 0) + packed(63, 0), "gzip"), "the data end after"},
           // more hexahedra than can be made
           {"a.nrrd", nrrd("1024 1024 20", packed(20, 1), "gzip"), too_many},
           {"a.nrrd", nrrd("1024 1024 256", packed(256, 1), "gzip"), too_many},
           // long headers, and none
           {"a.nrrd", keys, "the header is longer than 1048576 bytes"},
           {"a.mha", std::string(50'000'000, '='), "the header is longer than 1048576 bytes"},
           {"a.mha", "", "a.mha:1: the file ends in its header"},
           {"a.nii.gz", "", "the data end after 0 bytes"},
           // an image of intensities
           {"a.nrrd", image, "more than 255 different labels: is this an image, and not its segmentation?"}}) {
    expect_bounded({"mesh", "voxels", directory_ / name, "-o", directory_ / "out.vtu"}, name, bytes, message);
    EXPECT_FALSE(is_there("out.vtu"));
  }
}

}  // namespace
