// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/linearalgebra/SparseMatrix.h>

#include <vector>

#include "hexaplast/solve/compliance.hpp"

namespace hexaplast::sofa_plugin
{

using Jacobian = sofa::linearalgebra::SparseMatrix<SReal>;

/// The rows of a Jacobian of SOFA that have entries, and which they are.
struct ConstraintRows
{
    explicit ConstraintRows(const Jacobian& J)
    {
        for (const auto& [number, line] : J)
        {
            if (line.empty()) continue;
            numbers.push_back(number);
            ConstraintRow& row = rows.emplace_back();
            for (const auto& [column, value] : line)
            {
                const int node = static_cast<int>(column / 3);
                if (row.empty() || row.back().first != node) row.emplace_back(node, Vec3::Zero());
                row.back().second[column % 3] += value;
            }
        }
    }
    std::vector<Jacobian::Index> numbers;
    std::vector<ConstraintRow> rows;
};

}  // namespace hexaplast::sofa_plugin
