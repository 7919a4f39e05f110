// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "hexaplast/base/parallel.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"
#include "plastic/isolated_flow.hpp"

namespace hexaplast::plain {

namespace {

class PlainBackend final : public Backend {
 public:
  PlainBackend(const Model& of, History& its_history, const std::vector<BranchStep>& its_branches)
      : Backend(of, its_history, its_branches), averaging_solver_(averaging_solver(model)) {}

  void linearize(ConstPoints x) override {
    alive_ = history.alive;
    of_elements_.resize(alive_.size());
    elements_->place(model, history, x, history.branches(branches));
    recovery_ = find_recovery(x);
  }

  void add_force(Points f) const override {
    elements_->find_forces(model.mesh, of_elements_);
    add_at_nodes(model.mesh, alive_, of_elements_, 1, f);
    recovery_.add_force(f);
  }

  void add_product(double factor, ConstPoints dx, Points df) const override {
    elements_->find_force_increments(model.mesh, dx, of_elements_);
    add_at_nodes(model.mesh, alive_, of_elements_, factor, df);
    recovery_.add_product(-factor, dx, df);
  }

  void add_stiffness_blocks(double factor, BlockMatrix& K) const override;

  bool has_diagonal() const override { return true; }
  void add_diagonal(double factor, Points diagonal) const override {
    for (int a = 0; a < kCorners; ++a)
      for (int axis = 0; axis < 3; ++axis) {
        ElementPoints unit = ElementPoints::Zero();
        unit(a, axis) = factor;
        elements_->find_force_increments(model.mesh, unit, of_elements_);
        for (std::size_t e = 0; e < alive_.size(); ++e)
          if (alive_[e]) diagonal(model.mesh.hexahedra()[e][a], axis) += of_elements_[e](a, axis);
      }
    recovery_.add_diagonal(-factor, diagonal);
  }

  void add_operator(double factor, MatrixFreeSystem& system) override { system.others.emplace_back(this, factor); }

  double energy(ConstPoints x) override {
    std::vector<double> energies;
    find_energies(model, history, x, history.branches(branches), energies);
    return std::accumulate(energies.begin(), energies.end(), find_recovery(x).energy());
  }

  FlowReport flow(ConstPoints x, double dt) override {
    return plain::flow(model, x, dt, averaging_solver_, history, branches);
  }

  void find_fields(ConstPoints x, const EvaluatedFields& fields) override;

  const Recovery& recovery() const override { return recovery_; }
  const Recovery& find_recovery(ConstPoints x) override {
    const std::vector<std::uint16_t> any(model.partition->num_blocks, 0xffff);
    if (model.settings.recovery != RecoveryMode::kNone) found_.find(model, history, any, x);
    return found_;
  }
  bool is_plain() const override { return true; }

 private:
  PreconditionedConjugateGradients averaging_solver_;
  std::unique_ptr<PlacedElements> elements_ = make_placed_elements();
  std::vector<unsigned char> alive_;                // per element
  mutable std::vector<ElementPoints> of_elements_;  // scratch
  Recovery recovery_, found_;
};

// Column by column. Removed elements add zeros: the pattern is that of the mesh.
void PlainBackend::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  std::array<std::vector<ElementPoints>, 3> columns;
  for (auto& column : columns) column.assign(alive_.size(), ElementPoints::Zero());
  for (int b = 0; b < kCorners; ++b) {
    for (int axis = 0; axis < 3; ++axis) {
      ElementPoints unit = ElementPoints::Zero();
      unit(b, axis) = factor;
      elements_->find_force_increments(model.mesh, unit, columns[axis]);
    }
    for (std::size_t e = 0; e < alive_.size(); ++e) {
      const Hexahedron& corners = model.mesh.hexahedra()[e];
      for (int a = 0; a < kCorners; ++a) {
        Mat3 block;
        for (int axis = 0; axis < 3; ++axis) block.col(axis) = columns[axis][e].row(a).transpose();
        K.add(corners[a], corners[b], block);
      }
    }
  }
  recovery_.add_blocks(-factor, K);
}

void PlainBackend::find_fields(ConstPoints x, const EvaluatedFields& fields) {
  const std::vector<BranchStep> now = branch_steps(model.settings, 0);
  const Settings& settings = model.settings;
  parallel_for(model.mesh.num_elements(), [&](int e) {
    if (!history.alive[e]) return;
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const ElementPoints plastic_rest = gather(history.plastic_rest_positions, corners), current = gather(x, corners);
    const CornerTensors* G = history.plastic_inverse_of(e);
    const Branches of_element = history.branches(now).of(e);
    ElementSamples samples = Element(plastic_rest, current, model.lame[e], settings, G, of_element).samples();
    if (G) samples.stress = isolated_stress(plastic_rest, *G, samples, settings.yield_stress_measure).relieved;
    fields.volume_ratio[e] = samples.volume / model.volume[e];
    for (int i = 0; i < kCorners; ++i) {
      fields.stress_norm[e] = std::max(fields.stress_norm[e], stress_norm(samples.stress[i], settings.yield_norm));
      const Vec3 stretch =
          Eigen::SelfAdjointEigenSolver<Mat3>(samples.polar[i].S, Eigen::EigenvaluesOnly).eigenvalues();
      fields.strain[e] = std::max(fields.strain[e], (stretch.array() - 1).abs().maxCoeff());
    }
  });
}

}  // namespace

void add_at_nodes(const HexMesh& mesh, const std::vector<unsigned char>& counts,
                  const std::vector<ElementPoints>& of_elements, double factor, Points to) {
  parallel_for(mesh.num_nodes(), [&](int n) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [element, corner] : mesh.incident(n))
      if (counts[element]) sum += of_elements[element].row(corner).transpose();
    to.row(n) += factor * sum.transpose();
  });
}

std::unique_ptr<Backend> make_backend(const Model& model, History& history, const std::vector<BranchStep>& branches) {
  return std::make_unique<PlainBackend>(model, history, branches);
}

}  // namespace hexaplast::plain
