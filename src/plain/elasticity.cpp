// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plain/plain.hpp"

namespace hexaplast::plain {

Elasticity::Elasticity(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> branches)
    : hexahedra_(model.mesh.hexahedra()), elements_(hexahedra_.size()) {
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!history.alive[e]) continue;
    const Hexahedron& corners = hexahedra_[e];
    const ElementPoints plastic_rest = gather(history.plastic_rest_positions, corners), current = gather(x, corners);
    elements_[e].emplace(plastic_rest, current, model.lame[e], model.settings, history.plastic_inverse_of(e),
                         history.branches(branches).of(e));
  }
  if (model.settings.recovery == RecoveryMode::kNone) return;
  const std::vector<std::uint16_t> any(model.partition->num_blocks, 0xffff);
  recovery_.find(model, history, any, x);
}

double Elasticity::energy() const {
  double sum = recovery_.energy();
  for (const std::optional<Element>& element : elements_)
    if (element) sum += element->energy();
  return sum;
}

void Elasticity::add_force(Points f) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    if (!elements_[e]) continue;
    const ElementPoints force = elements_[e]->force();
    for (int a = 0; a < kCorners; ++a) f.row(hexahedra_[e][a]) += force.row(a);
  }
  recovery_.add_force(f);
}

void Elasticity::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    if (!elements_[e]) continue;
    const Hexahedron& corners = hexahedra_[e];
    const ElementPoints increment = elements_[e]->force_increment(gather(dx, corners));
    for (int a = 0; a < kCorners; ++a) df.row(corners[a]) += factor * increment.row(a);
  }
  recovery_.add_product(-factor, dx, df);
}

// Column by column. Removed elements add zeros: the pattern is that of the mesh.
void Elasticity::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Hexahedron& corners = hexahedra_[e];
    for (int b = 0; b < kCorners; ++b) {
      std::array<Mat3, kCorners> column;
      column.fill(Mat3::Zero());
      for (int axis = 0; axis < 3 && elements_[e]; ++axis) {
        ElementPoints unit = ElementPoints::Zero();
        unit(b, axis) = factor;
        const ElementPoints increment = elements_[e]->force_increment(unit);
        for (int a = 0; a < kCorners; ++a) column[a].col(axis) = increment.row(a).transpose();
      }
      for (int a = 0; a < kCorners; ++a) K.add(corners[a], corners[b], column[a]);
    }
  }
  recovery_.add_blocks(-factor, K);
}

void Elasticity::add_stiffness_diagonal(double factor, Points diagonal) const {
  for (std::size_t e = 0; e < elements_.size(); ++e)
    for (int a = 0; a < kCorners && elements_[e]; ++a)
      for (int axis = 0; axis < 3; ++axis) {
        ElementPoints unit = ElementPoints::Zero();
        unit(a, axis) = factor;
        diagonal(hexahedra_[e][a], axis) += elements_[e]->force_increment(unit)(a, axis);
      }
  recovery_.add_diagonal(-factor, diagonal);
}

}  // namespace hexaplast::plain
