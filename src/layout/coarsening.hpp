// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A sparse linear map between nodal fields: to[row] = sum_k weight[k] from[column[k]], k in [first[row], first[row +
/// 1]).
struct NodalMap {
  std::vector<int> first;  ///< rows + 1
  std::vector<int> column;
  std::vector<float> weight;

  int num_rows() const { return static_cast<int>(first.size()) - 1; }
  NodalMap transposed(int num_columns) const;
};

/// Hexahedra of twice the edge length that cover a mesh: along the lattice that neighbours across faces form, up to
/// 2 x 2 x 2 elements make one cell. Where the lattice ends within a cell, or elements are missing, a cell has fewer
/// children, and corners that are no node of the mesh.
struct Coarsening {
  int num_nodes = 0;
  std::vector<Hexahedron> cells;                    ///< corners: coarse nodes
  std::vector<std::array<int, kCorners>> children;  ///< per cell and corner: the element there, or -1
  NodalMap prolongation;                            ///< coarse to fine: trilinear within the cells
  NodalMap placement;                               ///< fine to coarse positions: nodes as they are, other corners by
                                                    ///< affine extension of the nearest child
  std::vector<int> fine_node;                       ///< per coarse node: the fine node there, or -1
};

/// Nothing where coarsening gains little: fewer elements than a direct treatment deserves, elements that form no
/// lattice, a cell that meets itself around a loop, or cells that do not meet where the mesh is connected.
std::optional<Coarsening> coarsen(int num_nodes, const std::vector<Hexahedron>& hexahedra);

}  // namespace hexaplast
