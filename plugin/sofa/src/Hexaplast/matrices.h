// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/linearalgebra/BaseMatrix.h>

#include "hexaplast/base/block_matrix.hpp"

/// Blocks of ours as entries of SOFA's matrices.
namespace hexaplast::sofa_plugin
{

/// matrix += factor blocks, from the row and column `offset` on.
inline void add(const BlockMatrix& blocks, SReal factor, unsigned int offset, sofa::linearalgebra::BaseMatrix& matrix)
{
    for (int row = 0; row < blocks.num_nodes(); ++row)
        for (const auto& [column, block] : blocks.row(row))
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    matrix.add(static_cast<int>(offset) + 3 * row + a, static_cast<int>(offset) + 3 * column + b,
                               factor * block(a, b));
}

/// Rows or columns of blocks.
struct NodeRange
{
    int first = 0, count = 0;
    bool contains(int node) const { return node >= first && node < first + count; }
};

/// The part of the blocks that is the derivative of the forces on some nodes by the positions or velocities of others.
template <class Derivative>
void add(const BlockMatrix& blocks, NodeRange rows, NodeRange columns, Derivative derivative)
{
    for (int row = rows.first; row < rows.first + rows.count; ++row)
        for (const auto& [column, block] : blocks.row(row))
        {
            if (!columns.contains(column)) continue;
            sofa::type::Mat<3, 3, SReal> entry(sofa::type::NOINIT);
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) entry(a, b) = block(a, b);
            derivative(3 * (row - rows.first), 3 * (column - columns.first)) += entry;
        }
}

/// Ready to be added to, of so many nodes.
inline void clear(BlockMatrix& blocks, int numNodes)
{
    if (blocks.num_nodes() == numNodes)
        blocks.clear();
    else
        blocks = BlockMatrix(numNodes);
}

}  // namespace hexaplast::sofa_plugin
