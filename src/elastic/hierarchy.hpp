// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>

#include "elastic/cell_operator.hpp"
#include "elastic/cycle_operator.hpp"
#include "layout/chunked_operator.hpp"
#include "layout/coarse_mesh.hpp"
#include "state/linearization.hpp"

namespace hexaplast {

/// The stiffness operator on coarser and coarser meshes, for multigrid.                         theory.md section 9.5
///
/// Missing children, removed elements and mixed materials need no more than the moduli of the cells' children.
class ElementHierarchy {
 public:
  explicit ElementHierarchy(const Model& model);

  /// What cycles take for L at the positions that `at` holds, from fine to coarse; computed anew when these have
  /// changed. Valid until the next call. Empty where the mesh has no lattice.
  std::span<const LevelOperator> update(const Model& model, const Linearization& at);

 private:
  struct Level {
    Level(const CoarseMesh& mesh, RestShape rest_shape);

    AlignedVector<double> plastic_rest, current;  // [m] slots
    AlignedVector<float> mean_plastic;            // Gm of the children, [block][child][kMeanPlastic][cell]; or empty
    CellOperator op;
    AlignedVector<float> diagonal;  // of op, in slots
  };

  std::optional<CycleOperator> cycle_;
  AlignedVector<float> diagonal_;         // of it
  std::vector<Level> levels_;             // of Model::coarse_meshes
  std::vector<LevelOperator> operators_;  // of the cycle operator and the levels
  long revision_ = -1;                    // Linearization::revision that the operators belong to
};

}  // namespace hexaplast
