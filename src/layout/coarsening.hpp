// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "layout/charts.hpp"

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

/// Hexahedra of twice the edge length that cover a mesh: along the lattice of its charts, up to 2 x 2 x 2 elements make
/// one cell. Where the lattice ends within a cell, or elements are missing, a cell has fewer children, and corners that
/// are no node of the mesh.
///
/// Where nodes have split, elements make one cell that have the node in its middle in common: one that is cut through
/// is there once on each side. Corners of cells at one point of the lattice are one coarse node where the cells have a
/// node in common between that corner and others of theirs; where no node has split, in any case.
struct Coarsening {
  int num_nodes = 0;
  std::vector<Hexahedron> cells;                    ///< corners: coarse nodes
  std::vector<std::array<int, kCorners>> children;  ///< per cell and corner: the element there, or -1
  std::vector<int> chart_cell;                      ///< per cell: that of the charts which it is, or is one side of
  NodalMap prolongation;                            ///< coarse to fine: trilinear within the cells
  NodalMap placement;                               ///< fine to coarse positions: nodes as they are, other corners by
                                                    ///< affine extension of the nearest child
  std::vector<int> fine_node;                       ///< per coarse node: the fine node there, or -1
};

/// Of a mesh with the elements of a level of charts: those of the initial mesh, whose nodes may have split since; or
/// cells, and chart_element the Coarsening::chart_cell of each. Pieces for which there is a cell to almost every
/// element have none where such pieces are many, as crumbs are. Nothing where there are no other ones.
std::optional<Coarsening> coarsen(const Charts::Level& charts, int num_nodes, std::span<const Hexahedron> hexahedra,
                                  std::span<const int> chart_element = {});

}  // namespace hexaplast
