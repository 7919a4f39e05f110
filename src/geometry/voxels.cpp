// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/voxels.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "geometry/grid_cells.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

using Places = std::array<unsigned char, 256>;  // of labels: 0 for those that do not count

/// "1 (liver), 2"
std::string listed(const LabelledVolume& volume) {
  std::vector<int> labels = volume.labels();
  std::ranges::sort(labels);
  std::vector<std::string> words;
  for (const int label : labels) {
    const auto name = volume.names.find(label);
    words.push_back(name == volume.names.end() ? std::to_string(label) : fmt::format("{} ({})", label, name->second));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Each place as it is, or 0 where its label does not count.
Places counted(const LabelledVolume& volume, const std::vector<int>& labels) {
  Places places{};
  if (labels.empty())
    for (std::size_t p = 1; p <= volume.labels().size(); ++p) places[p] = static_cast<unsigned char>(p);
  for (const int label : labels) {
    if (label == 0) throw InputError("label 0 is the background, and makes no hexahedra");
    const auto found = std::ranges::find(volume.labels(), label);
    if (found == volume.labels().end())
      throw InputError(fmt::format("no voxel has the label {}: must be one of {}", label, listed(volume)));
    const auto place = static_cast<std::size_t>(found - volume.labels().begin()) + 1;
    if (places[place] != 0) throw InputError(fmt::format("label {} is given twice", label));
    places[place] = static_cast<unsigned char>(place);
  }
  return places;
}

/// Cells in each direction.
std::array<int, 3> grid_of(const LabelledVolume& volume, int coarsening) {
  std::array<int, 3> cells;
  for (int d = 0; d < 3; ++d) cells[d] = (volume.size()[d] - 1) / coarsening + 1;
  return cells;
}

/// Whether some voxel in a row of cells counts: most of a volume is background.
bool counts_somewhere(const LabelledVolume& volume, const Places& places, int j, int k, int coarsening) {
  const auto [nx, ny, nz] = volume.size();
  const int y = j * coarsening, num_rows = std::min(coarsening, ny - y);
  for (int z = k * coarsening; z < std::min((k + 1) * coarsening, nz); ++z) {
    const auto rows = volume.places().subspan(static_cast<std::size_t>(nx) * (y + static_cast<std::size_t>(ny) * z),
                                              static_cast<std::size_t>(nx) * num_rows);
    if (std::ranges::any_of(rows, [&](unsigned char place) { return places[place] != 0; })) return true;
  }
  return false;
}

/// Counts the labels of the voxels in one cell after the other.
class LabelCount {
 public:
  LabelCount(const LabelledVolume& volume, const Places& places, const VoxelCells& cells)
      : volume_(volume), places_(places), coarsening_(cells.coarsening), covers_(cells.covers) {}

  /// Place of the label of a cell; 0: it is background.
  int place(const GridCell& cell) {
    std::array<int, 3> begin, end;
    for (int d = 0; d < 3; ++d) {
      begin[d] = cell[d] * coarsening_;
      end[d] = std::min(begin[d] + coarsening_, volume_.size()[d]);
    }
    const auto [nx, ny, nz] = volume_.size();
    int total = 0;
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j) {
        const unsigned char* const row =
            volume_.places().data() + static_cast<std::size_t>(nx) * (j + std::size_t(ny) * k);
        for (int i = begin[0]; i < end[0]; ++i)
          if (const unsigned char place = places_[row[i]]; place != 0) {
            if (count_[place]++ == 0) found_.push_back(place);
            ++total;
          }
      }
    int best = 0;
    for (const unsigned char place : found_)
      if (best == 0 || count_[place] > count_[best] ||
          (count_[place] == count_[best] && volume_.labels()[place - 1u] < volume_.labels()[best - 1u]))
        best = place;
    for (const unsigned char place : found_) count_[place] = 0;
    found_.clear();
    const std::int64_t size = std::int64_t{coarsening_} * coarsening_ * coarsening_;
    return covers_ || 2 * std::int64_t{total} >= size ? best : 0;
  }

 private:
  const LabelledVolume& volume_;
  const Places& places_;
  int coarsening_;
  bool covers_;
  std::array<int, 256> count_{};
  std::vector<unsigned char> found_;
};

/// Cells of the grid that become hexahedra.
struct Chosen {
  std::vector<GridCell> cells;  // x fastest
  std::vector<int> labels;
};

void require_number(double count) {
  if (count > kMaxVoxelCells)
    throw InputError(
        fmt::format("{:.10g} hexahedra or more, must be at most {:.10g}: coarsen them", count, kMaxVoxelCells));
}

Chosen choose(const LabelledVolume& volume, const VoxelCells& options) {
  if (options.coarsening < 1 || options.coarsening > kMaxCoarsening)
    throw InputError(fmt::format("a coarsening of {}, must lie in [1, {}]", options.coarsening, kMaxCoarsening));
  const Places places = counted(volume, options.labels);
  if (volume.labels().empty()) throw InputError("no voxel has a label other than 0");
  require_feasible(volume, options);

  Chosen chosen;
  LabelCount count(volume, places, options);
  const int N = options.coarsening;
  const auto [nx, ny, nz] = grid_of(volume, N);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j) {
      if (!counts_somewhere(volume, places, j, k, N)) continue;
      for (int i = 0; i < nx; ++i)
        if (const int place = count.place({i, j, k}); place != 0) {
          chosen.cells.push_back({i, j, k});
          chosen.labels.push_back(volume.labels()[static_cast<std::size_t>(place) - 1]);
        }
    }
  require_number(static_cast<double>(chosen.cells.size()));
  if (chosen.cells.empty())
    throw InputError(fmt::format("no cell of {0} x {0} x {0} voxels is at least half full of labels", N));
  return chosen;
}

/// Leaves the largest part that is connected by faces, of equally large ones the first; returns how many cells go.
int keep_largest_part(Chosen& chosen) {
  const int count = static_cast<int>(chosen.cells.size());
  const auto before = [](const GridCell& a, const GridCell& b) {
    return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
  };
  DisjointSets parts(count);
  for (int c = 0; c < count; ++c)
    for (int d = 0; d < 3; ++d) {
      GridCell neighbour = chosen.cells[static_cast<std::size_t>(c)];
      --neighbour[d];
      const auto found = std::ranges::lower_bound(chosen.cells, neighbour, before);
      if (found != chosen.cells.end() && *found == neighbour)
        parts.join(static_cast<int>(found - chosen.cells.begin()), c);
    }

  std::vector<int> size(static_cast<std::size_t>(count), 0);
  for (int c = 0; c < count; ++c) ++size[static_cast<std::size_t>(parts.root(c))];
  int largest = 0;
  for (int c = 0; c < count; ++c)
    if (size[static_cast<std::size_t>(parts.root(c))] > size[static_cast<std::size_t>(parts.root(largest))])
      largest = c;

  Chosen kept;
  for (int c = 0; c < count; ++c)
    if (parts.root(c) == parts.root(largest)) {
      kept.cells.push_back(chosen.cells[static_cast<std::size_t>(c)]);
      kept.labels.push_back(chosen.labels[static_cast<std::size_t>(c)]);
    }
  chosen = std::move(kept);
  return count - static_cast<int>(chosen.cells.size());
}

HexMesh voxel_mesh(const std::vector<GridCell>& cells, const LabelledVolume& volume, const VoxelCells& options) {
  GridHexahedra found = grid_hexahedra(cells, grid_of(volume, options.coarsening));
  PointArray positions(static_cast<Eigen::Index>(found.nodes.size()), 3);
  for (std::size_t n = 0; n < found.nodes.size(); ++n) {
    const auto& [i, j, k] = found.nodes[n];
    const Vec3 corner = options.coarsening * Vec3(i, j, k) - Vec3::Constant(0.5);  // in voxels, whose centres are whole
    positions.row(static_cast<Eigen::Index>(n)) =
        ((volume.origin() + volume.axes() * corner) / options.mm_per_length).transpose();
  }
  if (volume.axes().determinant() < 0)
    for (Hexahedron& corners : found.hexahedra) {
      const Hexahedron mirrored = corners;
      for (int a = 0; a < kCorners; ++a) corners[a] = mirrored[kEdgeNeighbour[a][0]];
    }
  return HexMesh(std::move(positions), std::move(found.hexahedra));
}

}  // namespace

LabelledVolume::LabelledVolume(const std::array<int, 3>& size, const Mat3& axes, const Vec3& origin)
    : size_(size), axes_(axes), origin_(origin) {
  double count = 1;
  for (const int n : size) {
    if (n < 1) throw InputError(fmt::format("{} x {} x {} voxels: must be at least 1 each", size[0], size[1], size[2]));
    count *= n;
  }
  if (count > kMaxVoxels)
    throw InputError(
        fmt::format("{} x {} x {} voxels: must be at most {:.10g} in all", size[0], size[1], size[2], kMaxVoxels));
  if (!axes.allFinite() || !origin.allFinite()) throw InputError("axes and origin of voxels must be finite numbers");
  for (int d = 0; d < 3; ++d) {
    const double length = axes.col(d).norm();
    if (!(length > 0 && std::isfinite(1 / length) && std::isfinite(length)))
      throw InputError(fmt::format("voxels are {} mm long in direction {}: must be greater than 0", length, d));
  }
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3;
    const double cosine = axes.col(d).normalized().dot(axes.col(e).normalized());
    if (!(std::abs(cosine) <= kMaxCosineOfAxes))
      throw InputError(
          fmt::format("the axes {} and {} of the voxels are not perpendicular: their cosine is {:.3g}, must "
                      "be at most {}",
                      std::min(d, e), std::max(d, e), std::abs(cosine), kMaxCosineOfAxes));
  }
  num_voxels_ = static_cast<std::size_t>(count);
  // zeros that the system hands out only when they are changed: most of a volume is background
  places_.reset(static_cast<unsigned char*>(std::calloc(num_voxels_, 1)));
  if (!places_) throw std::bad_alloc();
  place_of_[0] = 0;
  counts_[0] = static_cast<std::int64_t>(num_voxels_);
}

void LabelledVolume::find(int label) {
  const auto [found, is_new] = place_of_.try_emplace(label, static_cast<unsigned char>(labels_.size() + 1));
  if (is_new) {
    if (labels_.size() == std::numeric_limits<unsigned char>::max()) {
      place_of_.erase(found);
      throw InputError(
          fmt::format("more than {} different labels: is this an image, and not its segmentation?", labels_.size()));
    }
    labels_.push_back(label);
  }
  latest_label_ = label;
  latest_place_ = found->second;
}

void require_feasible(const LabelledVolume& volume, const VoxelCells& cells) {
  std::int64_t count = 0;
  for (std::size_t l = 0; l < volume.labels().size(); ++l)
    if (cells.labels.empty() || std::ranges::find(cells.labels, volume.labels()[l]) != cells.labels.end())
      count += volume.count(l + 1);
  // some of them may stay without a hexahedron, but not so many
  require_number(static_cast<double>(count) / std::pow(cells.coarsening, 3));
}

VoxelMesh mesh_of_voxels(const LabelledVolume& volume, const VoxelCells& cells) {
  Chosen chosen = choose(volume, cells);
  const int num_left_out = cells.largest_part ? keep_largest_part(chosen) : 0;
  VoxelMesh made{.mesh = voxel_mesh(chosen.cells, volume, cells),
                 .labels = std::move(chosen.labels),
                 .num_left_out = num_left_out};
  const GridConnection connection = connection_of(made.mesh);
  made.num_parts = connection.num_parts;
  made.num_hinges = connection.num_hinges;
  return made;
}

}  // namespace hexaplast
