// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deque>
#include <vector>

#include "hexaplast/body.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {

inline constexpr double kSlabStep = 0.01;  ///< [s]
inline const Vec3 kSlabSize(0.16, 0.16, 0.04);

/// Blocks between nodes, which the kernels do not know.
class Ties final : public NodalOperator {
 public:
  void add_product(double factor, ConstPoints p, Points Fp) const override {
    for (const auto& [a, b, block] : blocks) Fp.row(a) += factor * p.row(b) * block.transpose();
  }
  void add_blocks(double factor, BlockMatrix& A) const override {
    for (const auto& [a, b, block] : blocks) A.add(a, b, factor * block);
  }
  void add(int a, int b, const Mat3& block) { blocks.push_back({a, b, block}); }

  struct Block {
    int a, b;
    Mat3 block;
  };
  std::vector<Block> blocks;
};

/// diagonal + dt^2 (stiffness of the bodies) + ties, on the nodes of a slab that is held at x = 0.
class Slab final : public LinearSystem, public Projector {
 public:
  explicit Slab(HexMesh of) : mesh(std::move(of)), diagonal(PointArray::Constant(mesh.num_nodes(), 3, kNodalMass)) {}

  /// Hexahedra [first, last) of the mesh.
  void add_body(int first, int last, double young_modulus, Precision precision = Precision::kDouble) {
    const std::vector<Hexahedron> some(mesh.hexahedra().begin() + first, mesh.hexahedra().begin() + last);
    Body& body = bodies.emplace_back(HexMesh(mesh.positions(), some),
                                     std::vector{Material{.young_modulus = young_modulus, .poisson_ratio = 0.45}},
                                     Settings{.precision = precision});
    body.linearize(mesh.positions());
  }

  int num_nodes() const override { return mesh.num_nodes(); }

  void apply(ConstPoints p, Points Ap) const override {
    Ap = diagonal.cwiseProduct(p);
    for (const Body& body : bodies) body.add_stiffness_product(-kSlabStep * kSlabStep, p, Ap);
    ties.add_product(1, p, Ap);
    project(Ap);
  }

  void assemble(BlockMatrix& A) const override {
    for (int n = 0; n < num_nodes(); ++n) A.add(n, n, Mat3(diagonal.row(n).asDiagonal()));
    for (const Body& body : bodies) body.add_stiffness_blocks(-kSlabStep * kSlabStep, A);
    ties.add_blocks(1, A);
    for (const int n : held)
      for (int axis = 0; axis < 3; ++axis) A.pin(n, axis);
  }

  bool matrix_free(MatrixFreeSystem& system) const override {
    system.diagonal = diagonal;
    system.constraints.reset(num_nodes());
    for (const int n : held) system.constraints.free.row(n).setZero();
    if (slides) system.constraints.projector = this;
    for (const Body& body : bodies) body.add_operator(-kSlabStep * kSlabStep, system);
    if (!ties.blocks.empty()) system.others.emplace_back(&ties);
    return true;
  }

  /// Held nodes stay; where they slide, those at the far end keep to planes.
  void project(Points field) const override {
    for (const int n : held) field.row(n).setZero();
    if (!slides) return;
    const Eigen::RowVector3d normal(0, 0.6, 0.8);
    for (int n = 0; n < num_nodes(); ++n)
      if (mesh.positions()(n, 0) > kSlabSize[0] - 1e-9) field.row(n) -= field.row(n).dot(normal) * normal;
  }

  static constexpr double kNodalMass = 1e-3;  // [kg] 1000 kg/m^3 in cells of a centimetre

  HexMesh mesh;
  PointArray diagonal;
  std::deque<Body> bodies;
  Ties ties;
  std::vector<int> held = nodes_at(mesh, 0, 0);
  bool slides = false;
};

inline HexMesh slab_mesh() { return regular_grid({16, 16, 4}, Vec3::Zero(), kSlabSize); }

inline Slab slab_of_one_body(double young_modulus, Precision precision = Precision::kDouble) {
  Slab slab(slab_mesh());
  slab.add_body(0, slab.mesh.num_elements(), young_modulus, precision);
  return slab;
}

}  // namespace hexaplast::support
