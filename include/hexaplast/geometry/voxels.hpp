// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

inline constexpr double kMaxVoxels = 268'435'456;     // of a volume: a byte each
inline constexpr double kMaxVoxelCells = 16'777'216;  // hexahedra that are made of one
inline constexpr double kMaxCosineOfAxes = 1e-4;      // between two axes of a volume
inline constexpr int kMaxCoarsening = 256;            // voxels along an edge of a hexahedron

/// A segmentation: a label for each voxel of an image. Voxel (i, j, k) has the number i + n0 (j + n1 k), and its centre
/// lies at origin + axes (i, j, k)^T. Label 0 is the background.
class LabelledVolume {
 public:
  /// size: voxels in each direction; axes: column d leads from a voxel to the next one in direction d [mm]; origin: the
  /// centre of voxel (0, 0, 0) [mm]. All labels are 0 at first, and take no memory until they are set.
  /// Throws InputError for a size < 1, more than kMaxVoxels voxels, numbers that are not finite, and axes that are
  /// flat or not perpendicular (kMaxCosineOfAxes). They may be left-handed.
  LabelledVolume(const std::array<int, 3>& size, const Mat3& axes, const Vec3& origin);

  const std::array<int, 3>& size() const { return size_; }
  const Mat3& axes() const { return axes_; }
  const Vec3& origin() const { return origin_; }
  std::size_t num_voxels() const { return num_voxels_; }

  /// Throws InputError where the volume would have more than 255 different labels.
  void set(std::size_t voxel, int label) {
    if (label != latest_label_) find(label);
    --counts_[places_[voxel]];
    places_[voxel] = latest_place_;
    ++counts_[latest_place_];
  }

  /// The different labels other than 0, in the order in which they were set first.
  const std::vector<int>& labels() const { return labels_; }

  /// How many voxels have the label that is in that place, counted from 1; 0: how many are background.
  std::int64_t count(std::size_t place) const { return counts_[place]; }

  /// Of each voxel: 0 for label 0, otherwise 1 + the place of its label in labels().
  std::span<const unsigned char> places() const { return {places_.get(), num_voxels_}; }

  std::map<int, std::string> names;  ///< of labels, where the file has them

 private:
  struct Free {
    void operator()(unsigned char* memory) const { std::free(memory); }
  };
  void find(int label);

  std::array<int, 3> size_;
  Mat3 axes_;
  Vec3 origin_;
  std::size_t num_voxels_ = 0;
  std::unique_ptr<unsigned char[], Free> places_;
  std::vector<int> labels_;
  std::array<std::int64_t, 256> counts_{};
  std::unordered_map<int, unsigned char> place_of_;
  int latest_label_ = 0;
  unsigned char latest_place_ = 0;
};

/// How voxels become hexahedra.
struct VoxelCells {
  std::vector<int> labels = {};  ///< of voxels that count, the others are background; empty: all but 0
  int coarsening = 1;            ///< voxels along each edge of a hexahedron
  bool covers = false;           ///< every voxel that counts lies in a hexahedron
  bool largest_part = false;     ///< only the largest part that is connected by faces
  double mm_per_length = 1000;   ///< of the positions: 1000 for m
};

/// Throws InputError where so many voxels have labels that count that there would be more than kMaxVoxelCells
/// hexahedra.
void require_feasible(const LabelledVolume& volume, const VoxelCells& cells);

/// Hexahedra that are made of voxels. They are cells of one grid: neighbours share whole faces.
struct VoxelMesh {
  HexMesh mesh;             ///< hexahedra in the order of the voxels
  std::vector<int> labels;  ///< of each hexahedron
  int num_parts = 0;        ///< hexahedra that hang together by faces form one part
  int num_hinges = 0;       ///< nodes at which hexahedra meet that are not joined by faces there
  int num_left_out = 0;     ///< hexahedra that are not of the largest part
};

/// One hexahedron for each cell of coarsening^3 voxels of which at least half, or where `covers` any, have a label that
/// counts, beginning with voxel (0, 0, 0); what lies beyond the volume is background. The hexahedron has the most
/// frequent of these labels; of equally frequent ones the smallest. All hexahedra have positive volumes, also where the
/// axes of the volume are left-handed. Throws InputError for a coarsening < 1, for a label that is 0, given twice or
/// that no voxel has, for more than kMaxVoxelCells hexahedra, and where no hexahedron is left.
VoxelMesh mesh_of_voxels(const LabelledVolume& volume, const VoxelCells& cells);

/// A closed surface around the hexahedra of one label.
struct VoxelSurface {
  PointArray positions;     ///< in the unit of the mesh
  std::vector<Quad> quads;  ///< counter-clockwise seen from outside
};

/// The faces between the hexahedra of a label and all others, smoothed: steps vanish, and volumes stay nearly as they
/// are (Taubin's two factors). No vertex moves by more than half a cell in any direction of the grid. Hexahedra that
/// share an edge or a node alone have vertices of their own there, so that two faces meet at each edge; unless both
/// ends of the edge are connected around it.
/// cell: column d is the edge of a hexahedron in direction d of the grid. Throws InputError for a label that no
/// hexahedron has.
VoxelSurface surface_of_label(const VoxelMesh& voxels, int label, const Mat3& cell);

}  // namespace hexaplast
