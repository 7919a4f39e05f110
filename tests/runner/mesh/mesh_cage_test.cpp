// SPDX-License-Identifier: LGPL-2.1-or-later
#include <string>

#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "support/command.hpp"

namespace {

using namespace hexaplast;
using namespace support;

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
  ImportedMesh written() { return read_vtk(directory_ / "cage.vtu"); }
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
  const ImportedMesh surface = read_obj(directory_ / "plate.obj");
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

}  // namespace
