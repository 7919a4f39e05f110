// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "hexaplast/base/types.hpp"

namespace hexaplast::parts {

/// Gives new nodes of a state the rows of those that they were split from, behind its present ones, which lie at
/// [first, end).
inline void insert_rows(PointArray& field, std::span<const int> split_from, Eigen::Index first, Eigen::Index end) {
  const PointArray before = field;
  const Eigen::Index count = std::ssize(split_from), behind = before.rows() - end;
  field.resize(before.rows() + count, 3);
  field.topRows(end) = before.topRows(end);
  for (Eigen::Index i = 0; i < count; ++i)
    field.row(end + i) = before.row(first + split_from[static_cast<std::size_t>(i)]);
  field.bottomRows(behind) = before.bottomRows(behind);
}

}  // namespace hexaplast::parts
