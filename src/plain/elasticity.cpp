// SPDX-License-Identifier: LGPL-2.1-or-later
#include <numeric>

#include "hexaplast/base/parallel.hpp"
#include "plain/plain.hpp"

namespace hexaplast::plain {

Recovery find_recovery(const Model& model, const History& history, ConstPoints x) {
  Recovery recovery;
  if (model.settings.recovery == RecoveryMode::kNone) return recovery;
  const std::vector<std::uint16_t> any(model.partition->num_blocks, 0xffff);
  recovery.find(model, history, any, x);
  return recovery;
}

void add_at_nodes(const HexMesh& mesh, const std::vector<unsigned char>& counts,
                  const std::vector<ElementPoints>& of_elements, double factor, Points to) {
  parallel_for(mesh.num_nodes(), [&](int n) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [element, corner] : mesh.incident(n))
      if (counts[element]) sum += of_elements[element].row(corner).transpose();
    to.row(n) += factor * sum.transpose();
  });
}

double energy(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> branches) {
  std::vector<double> energies;
  find_energies(model, history, x, history.branches(branches), energies);
  return std::accumulate(energies.begin(), energies.end(), find_recovery(model, history, x).energy());
}

void Elasticity::linearize(const Model& model, const History& history, ConstPoints x,
                           std::span<const BranchStep> branches) {
  mesh_ = &model.mesh;
  alive_ = history.alive;
  of_elements_.resize(alive_.size());
  elements_->place(model, history, x, history.branches(branches));
  recovery_ = find_recovery(model, history, x);
}

void Elasticity::add_force(Points f) const {
  elements_->find_forces(*mesh_, of_elements_);
  add_at_nodes(*mesh_, alive_, of_elements_, 1, f);
  recovery_.add_force(f);
}

void Elasticity::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  elements_->find_force_increments(*mesh_, dx, of_elements_);
  add_at_nodes(*mesh_, alive_, of_elements_, factor, df);
  recovery_.add_product(-factor, dx, df);
}

// Column by column. Removed elements add zeros: the pattern is that of the mesh.
void Elasticity::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  std::array<std::vector<ElementPoints>, 3> columns;
  for (auto& column : columns) column.assign(alive_.size(), ElementPoints::Zero());
  for (int b = 0; b < kCorners; ++b) {
    for (int axis = 0; axis < 3; ++axis) {
      ElementPoints unit = ElementPoints::Zero();
      unit(b, axis) = factor;
      elements_->find_force_increments(*mesh_, unit, columns[axis]);
    }
    for (std::size_t e = 0; e < alive_.size(); ++e) {
      const Hexahedron& corners = mesh_->hexahedra()[e];
      for (int a = 0; a < kCorners; ++a) {
        Mat3 block;
        for (int axis = 0; axis < 3; ++axis) block.col(axis) = columns[axis][e].row(a).transpose();
        K.add(corners[a], corners[b], block);
      }
    }
  }
  recovery_.add_blocks(-factor, K);
}

void Elasticity::add_stiffness_diagonal(double factor, Points diagonal) const {
  for (int a = 0; a < kCorners; ++a)
    for (int axis = 0; axis < 3; ++axis) {
      ElementPoints unit = ElementPoints::Zero();
      unit(a, axis) = factor;
      elements_->find_force_increments(*mesh_, unit, of_elements_);
      for (std::size_t e = 0; e < alive_.size(); ++e)
        if (alive_[e]) diagonal(mesh_->hexahedra()[e][a], axis) += of_elements_[e](a, axis);
    }
  recovery_.add_diagonal(-factor, diagonal);
}

}  // namespace hexaplast::plain
