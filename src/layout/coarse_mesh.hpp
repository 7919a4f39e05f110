// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <vector>

#include "layout/coarsening.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

/// One of the meshes below a mesh that multigrid works on, cut for the kernels: what of it depends on topology alone.
struct CoarseMesh {
  CoarseMesh(const Coarsening& coarsening, const Partition& finer);

  /// Positions of the nodes of the finer mesh to those of this one, ghosts included. Both [m] in slots.
  void place(const AlignedVector<double>& finer, AlignedVector<double>& positions) const;

  std::shared_ptr<const Partition> partition;
  std::vector<Hexahedron> cells;                    ///< corners: nodes of this mesh
  std::vector<std::array<int, kCorners>> children;  ///< per cell and corner: the element there, or -1
  NodalMap prolongation;                            ///< nodes of this mesh to those of the finer one, by slots
  NodalMap restriction;                             ///< its transpose
  NodalMap placement;                               ///< positions of the finer nodes to those of this mesh, by slots
  std::vector<int> finer_slot;                      ///< per slot below num_nodes: that of the finer node there, or -1
};

/// From fine to coarse; none where the mesh forms no lattice, or is small. charts: of the initial mesh, of which `mesh`
/// has the hexahedra and some nodes may have split.
std::vector<CoarseMesh> coarse_meshes(const Charts& charts, const HexMesh& mesh, const Partition& partition);

}  // namespace hexaplast
