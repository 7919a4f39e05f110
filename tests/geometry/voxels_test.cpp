// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/voxels.hpp"

#include <map>

#include "hexaplast/mesh/quality.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

using Voxel = std::array<int, 3>;

/// Voxels of 1 x 2 x 4 mm whose first one has its centre at (10, 20, 30) mm.
LabelledVolume box_volume(const Voxel& size, const Vec3& spacing = Vec3(1, 2, 4)) {
  return LabelledVolume(size, spacing.asDiagonal().toDenseMatrix(), Vec3(10, 20, 30));
}

void mark(LabelledVolume& volume, const Voxel& at, int label) {
  const auto [nx, ny, nz] = volume.size();
  volume.set(static_cast<std::size_t>(at[0] + nx * (at[1] + ny * at[2])), label);
}

void fill(LabelledVolume& volume, const Voxel& from, const Voxel& to, int label) {
  for (int k = from[2]; k < to[2]; ++k)
    for (int j = from[1]; j < to[1]; ++j)
      for (int i = from[0]; i < to[0]; ++i) mark(volume, {i, j, k}, label);
}

Vec3 centre_of(const HexMesh& mesh, int e) {
  return gather(mesh.positions(), mesh.hexahedra()[static_cast<std::size_t>(e)]).colwise().mean().transpose();
}

// A voxel's hexahedron lies around the voxel's centre: in m, (10 + 2, 20 + 2 * 3, 30 + 4 * 1) mm.
TEST(Voxels, BecomeHexahedraAroundTheirCentres) {
  LabelledVolume volume = box_volume({5, 6, 3});
  mark(volume, {2, 3, 1}, 9);
  const VoxelMesh made = mesh_of_voxels(volume, {});
  ASSERT_EQ(made.mesh.num_elements(), 1);
  EXPECT_EQ(made.labels, std::vector<int>{9});
  EXPECT_TRUE(agrees(centre_of(made.mesh, 0), Vec3(0.012, 0.026, 0.034), 1e-15));
  EXPECT_TRUE(agrees(Vec3(made.mesh.positions().row(0).transpose()), Vec3(0.0115, 0.025, 0.032), 1e-15));
  EXPECT_NEAR(quality(made.mesh).volume, 8e-9, 1e-22);
  const VoxelMesh in_mm = mesh_of_voxels(volume, {.mm_per_length = 1});
  EXPECT_EQ(centre_of(in_mm.mesh, 0), Vec3(12, 26, 34));
}

// Two labels in a block of 4 x 3 x 2: 24 hexahedra with 5 * 4 * 3 nodes, in the order of the voxels.
TEST(Voxels, NeighboursShareNodesAndKeepTheirLabels) {
  LabelledVolume volume = box_volume({6, 5, 4});
  fill(volume, {1, 1, 1}, {5, 4, 3}, 3);
  mark(volume, {2, 1, 1}, -8);
  const VoxelMesh made = mesh_of_voxels(volume, {});
  EXPECT_EQ(made.mesh.num_elements(), 24);
  EXPECT_EQ(made.mesh.num_nodes(), 60);
  EXPECT_EQ(made.num_parts, 1);
  EXPECT_EQ(made.num_hinges, 0);
  EXPECT_EQ(std::ranges::count(made.labels, 3), 23);
  EXPECT_EQ(made.labels[1], -8);
  EXPECT_NEAR(quality(made.mesh).volume, 24 * 8e-9, 1e-20);
  EXPECT_EQ(made.mesh.boundary_faces().size(), 2u * (12 + 8 + 6));
}

// Left-handed axes: the first one points back. The mesh has positive volumes, or HexMesh would refuse it.
TEST(Voxels, LeftHandedAxesGivePositiveVolumes) {
  Mat3 axes = Vec3(-1, 2, 4).asDiagonal().toDenseMatrix();
  LabelledVolume volume({3, 2, 2}, axes, Vec3(10, 20, 30));
  mark(volume, {2, 1, 0}, 1);
  mark(volume, {1, 1, 0}, 2);
  const VoxelMesh made = mesh_of_voxels(volume, {});
  EXPECT_NEAR(quality(made.mesh).volume, 2 * 8e-9, 1e-22);
  EXPECT_EQ(made.labels, (std::vector<int>{2, 1}));
  EXPECT_TRUE(agrees(centre_of(made.mesh, 1), Vec3(0.008, 0.022, 0.030), 1e-15));
}

// Cells of 2 x 2 x 2 voxels: the first is half full, the second less, the third has two labels that are equally
// frequent, the fourth lies half outside the volume and is full there.
TEST(Voxels, CoarseCellsHaveTheMostFrequentLabel) {
  LabelledVolume volume = box_volume({7, 2, 2});
  fill(volume, {0, 0, 0}, {2, 2, 1}, 1);
  fill(volume, {2, 0, 0}, {3, 2, 1}, 1);
  mark(volume, {3, 0, 0}, 1);
  fill(volume, {4, 0, 0}, {5, 2, 2}, 6);
  fill(volume, {5, 0, 0}, {6, 2, 2}, 5);
  fill(volume, {6, 0, 0}, {7, 2, 2}, 4);
  const VoxelMesh made = mesh_of_voxels(volume, {.coarsening = 2, .mm_per_length = 1});
  EXPECT_EQ(made.labels, (std::vector<int>{1, 5, 4}));
  EXPECT_EQ(centre_of(made.mesh, 0), Vec3(10.5, 21, 32));
  EXPECT_EQ(centre_of(made.mesh, 2), Vec3(16.5, 21, 32));
  EXPECT_NEAR(quality(made.mesh).volume, 3 * 64, 1e-12);

  // a label that does not count leaves its voxels to the background
  EXPECT_EQ(mesh_of_voxels(volume, {.labels = {5, 1}, .coarsening = 2}).labels, (std::vector<int>{1, 5}));
  EXPECT_EQ(mesh_of_voxels(volume, {.labels = {5, 6}}).labels.size(), 8u);
  EXPECT_TRUE(refuses<InputError>([&] { mesh_of_voxels(volume, {.coarsening = 8}); }, {"8 x 8 x 8", "half full"}));
}

// Three blocks: of 4, 3 and 2 voxels; the second touches the first along an edge, the third touches nothing.
TEST(Voxels, PartsAreConnectedByFaces) {
  LabelledVolume volume = box_volume({9, 4, 4});
  fill(volume, {0, 2, 0}, {3, 3, 1}, 2);
  fill(volume, {3, 1, 0}, {7, 2, 1}, 1);
  fill(volume, {8, 3, 2}, {9, 4, 4}, 2);
  const VoxelMesh all = mesh_of_voxels(volume, {});
  EXPECT_EQ(all.mesh.num_elements(), 9);
  EXPECT_EQ(all.num_parts, 3);
  EXPECT_EQ(all.num_hinges, 2);
  EXPECT_EQ(all.num_left_out, 0);
  const VoxelMesh largest = mesh_of_voxels(volume, {.largest_part = true});
  EXPECT_EQ(largest.labels, std::vector<int>(4, 1));
  EXPECT_EQ(largest.mesh.num_nodes(), 20);
  EXPECT_EQ(largest.num_parts, 1);
  EXPECT_EQ(largest.num_hinges, 0);
  EXPECT_EQ(largest.num_left_out, 5);
}

TEST(Voxels, NamesWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses<InputError>([&] { box_volume({3, 0, 3}); }, {"3 x 0 x 3 voxels", "at least 1"}));
  EXPECT_TRUE(refuses<InputError>([&] { box_volume({100000, 100000, 100000}); }, {"at most 268435456"}));
  EXPECT_TRUE(refuses<InputError>([&] { box_volume({3, 3, 3}, Vec3(1, 0, 1)); }, {"0 mm long in direction 1"}));
  EXPECT_TRUE(refuses<InputError>([&] { box_volume({3, 3, 3}, Vec3(1, nan, 1)); }, {"finite"}));
  Mat3 sheared = Mat3::Identity();
  sheared(0, 2) = 1e-3;
  EXPECT_TRUE(refuses<InputError>(
      [&] {
        LabelledVolume({2, 2, 2}, sheared, Vec3::Zero());
      },
      {"axes 0 and 2", "cosine is 0.001", "at most 0.0001"}));
  sheared(0, 2) = 0.9e-4;
  EXPECT_NO_THROW(LabelledVolume({2, 2, 2}, sheared, Vec3::Zero()));

  LabelledVolume volume = box_volume({16, 16, 2});
  EXPECT_TRUE(refuses<InputError>([&] { mesh_of_voxels(volume, {}); }, {"no voxel has a label other than 0"}));
  volume.names = {{4, "liver"}};
  mark(volume, {0, 0, 0}, 4);
  mark(volume, {1, 0, 0}, 2);
  const auto made = [&](const VoxelCells& cells) { return [=, &volume] { mesh_of_voxels(volume, cells); }; };
  EXPECT_TRUE(refuses<InputError>(made({.labels = {3}}), {"no voxel has the label 3", "one of 2, 4 (liver)"}));
  EXPECT_TRUE(refuses<InputError>(made({.labels = {0}}), {"label 0 is the background"}));
  EXPECT_TRUE(refuses<InputError>(made({.labels = {4, 2, 4}}), {"label 4 is given twice"}));
  EXPECT_TRUE(refuses<InputError>(made({.coarsening = 0}), {"coarsening of 0", "[1, 256]"}));
  EXPECT_TRUE(refuses<InputError>(
      [&] {
        for (int label = 1; label < 400; ++label) volume.set(static_cast<std::size_t>(label), label);
      },
      {"more than 255 different labels"}));
}

double volume_of(const VoxelSurface& surface) { return enclosed_volume(surface.positions, surface.quads); }

/// Every edge is run through once in each direction: the surface is closed, oriented and a manifold.
void expect_closed(const VoxelSurface& surface) {
  std::map<Edge, int> count;
  for (const Quad& quad : surface.quads)
    for (int c = 0; c < 4; ++c) ++count[{quad[c], quad[(c + 1) % 4]}];
  for (const auto& [edge, times] : count) {
    EXPECT_EQ(times, 1) << edge[0] << " " << edge[1];
    EXPECT_EQ(count.contains({edge[1], edge[0]}), true) << edge[0] << " " << edge[1];
  }
}

int euler_number(const VoxelSurface& surface) {
  return static_cast<int>(surface.positions.rows() - static_cast<Eigen::Index>(surface.quads.size()));  // E = 2 F
}

// A ball of 10 mm of voxels of 1 x 1 x 0.5 mm: its steps become small waves, its volume stays.
TEST(VoxelSurface, SmoothsAwayStepsAndKeepsVolume) {
  LabelledVolume volume({25, 25, 49}, Vec3(1, 1, 0.5).asDiagonal().toDenseMatrix(), Vec3(-12, -12, -12));
  double count = 0;
  for (int k = 0; k < 49; ++k)
    for (int j = 0; j < 25; ++j)
      for (int i = 0; i < 25; ++i)
        if (Vec3(i - 12, j - 12, 0.5 * k - 12).norm() <= 10) {
          mark(volume, {i, j, k}, 3);
          ++count;
        }
  const VoxelMesh made = mesh_of_voxels(volume, {.mm_per_length = 1});
  const VoxelSurface surface = surface_of_label(made, 3, volume.axes());
  expect_closed(surface);
  EXPECT_EQ(euler_number(surface), 2);
  EXPECT_NEAR(volume_of(surface), 0.5 * count, 0.02 * 0.5 * count);
  double min = 100, max = 0;
  for (const auto& x : surface.positions.rowwise()) {
    min = std::min(min, x.norm());
    max = std::max(max, x.norm());
  }
  EXPECT_GT(min, 9.55);
  EXPECT_LT(max, 10.45);
}

// Two cubes of a label that share an edge alone have surfaces of their own; a vertex moves by half a voxel at most.
TEST(VoxelSurface, HexahedraThatShareAnEdgeStayApart) {
  LabelledVolume volume = box_volume({4, 4, 2});
  fill(volume, {0, 0, 0}, {2, 2, 2}, 1);
  fill(volume, {2, 2, 0}, {4, 4, 2}, 1);
  fill(volume, {2, 0, 0}, {4, 2, 2}, 2);
  const VoxelMesh made = mesh_of_voxels(volume, {.mm_per_length = 1});
  const VoxelSurface both = surface_of_label(made, 1, volume.axes()),
                     between = surface_of_label(made, 2, volume.axes());
  expect_closed(both);
  expect_closed(between);
  EXPECT_EQ(euler_number(both), 4);
  EXPECT_EQ(euler_number(between), 2);
  EXPECT_EQ(both.quads.size(), 48u);
  const Vec3 lower(9.5, 19, 28), upper = lower + Vec3(4, 8, 8);
  for (const auto& x : both.positions.rowwise())
    for (int d = 0; d < 3; ++d) {
      EXPECT_GE(x[d], lower[d] - 0.5 * volume.axes()(d, d) - 1e-12);
      EXPECT_LE(x[d], upper[d] + 0.5 * volume.axes()(d, d) + 1e-12);
    }
  EXPECT_GT(volume_of(both), 0.5 * 128);
  EXPECT_TRUE(
      refuses<InputError>([&] { surface_of_label(made, 5, volume.axes()); }, {"no hexahedron has the label 5"}));
}

// Left-handed axes: the surface is seen from outside all the same.
TEST(VoxelSurface, IsSeenFromOutside) {
  const Mat3 axes = Vec3(1, -1, 1).asDiagonal().toDenseMatrix();
  LabelledVolume volume({4, 4, 4}, axes, Vec3::Zero());
  fill(volume, {0, 0, 0}, {4, 4, 4}, 1);
  const VoxelMesh made = mesh_of_voxels(volume, {.mm_per_length = 1});
  EXPECT_GT(volume_of(surface_of_label(made, 1, axes)), 40);
}

}  // namespace
}  // namespace hexaplast
