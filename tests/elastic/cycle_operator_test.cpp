// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/cycle_operator.hpp"

#include "elastic/cell_operator.hpp"
#include "kinematics/polar.hpp"
#include "plain/plain.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

/// The numbers of nodes, of those in slots to which the chunks have added.
PointArray from_slots(const Partition& partition, AlignedVector<float>& slots) {
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) reduce_ghosts(partition, chunk, slots.data());
  PointArray out(partition.num_nodes, 3);
  for (int n = 0; n < partition.num_nodes; ++n)
    for (int i = 0; i < 3; ++i) out(n, i) = slots[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];
  return out;
}

PointArray product(const ChunkedOperator<float>& op, const PointArray& p) {
  const Partition& partition = op.partition();
  AlignedVector<float> from = slot_vector<float>(partition), to = from;
  to_slots(partition, p, from);
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) update_ghosts(partition, chunk, from.data());
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, 1, from.data(), to.data());
  return from_slots(partition, to);
}

PointArray diagonal_of(const ChunkedOperator<float>& op) {
  AlignedVector<float> diagonal = slot_vector<float>(op.partition());
  for (int chunk = 0; chunk < op.partition().num_chunks; ++chunk) op.add_diagonal(chunk, 1, diagonal.data());
  return from_slots(op.partition(), diagonal);
}

/// Largest difference from the product of the body's own stiffness, over the size of that.
double difference(const HexMesh& mesh, const Settings& settings, const Mat3& F) {
  Body body(mesh, {Material{.young_modulus = 1e4, .poisson_ratio = 0.45}}, settings);
  const PointArray x = mapped(mesh.positions(), F);
  if (settings.num_branches() > 0) body.set_time_step(0.1);
  body.linearize(x);
  CycleOperator cycle(body.state().model);
  cycle.update(body.state().model, body.state().at);
  Random random(5);
  const PointArray p = random.field(mesh.num_nodes(), kEdge);
  PointArray own = PointArray::Zero(p.rows(), 3);
  body.add_stiffness_product(-1, p, own);
  return max_abs(product(cycle, p) - own) / max_abs(own);
}

TEST(CycleOperator, IsTheStiffnessOfTurnedCubes) {
  Random random(6);
  const HexMesh cubes = block({5, 4, 3}, kEdge);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    for (const std::vector<double>& relaxation : {std::vector<double>{}, {1.5, 0.3, 3, 0.1}})
      EXPECT_LE(difference(cubes, {.relaxation = relaxation, .precision = precision}, random.rotation()), 2e-3);
}

TEST(CycleOperator, IsNearTheStiffnessOfStretchedAndDistortedElements) {
  const Mat3 F = Vec3(1.5, 0.8, 0.9).asDiagonal();
  const HexMesh mesh = distorted_block({5, 4, 3}, kEdge, 0.05, 7);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const double found = difference(mesh, {.precision = precision}, F);
    EXPECT_LE(found, 0.3);
    EXPECT_GE(found, 2e-3);  // it is not the same
  }
}

// All blocks have an element that is no parallelepiped by far, and so their own coefficients.
TEST(CycleOperator, IsTheStiffnessItselfOfElementsWithFlatCorners) {
  const HexMesh mesh = distorted_block({5, 4, 3}, kEdge, 0.25, 8);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    EXPECT_LE(difference(mesh, {.precision = precision}, Mat3::Identity()),
              precision == Precision::kDouble ? 1e-5 : 1e-6);
}

// Thin cells beside thick ones: their coefficients do not fit half precision.
TEST(CycleOperator, IsTheStiffnessItselfOfThinElementsBesideOthers) {
  HexMesh mesh = block({3, 3, 3}, kEdge);
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 2.5 * kEdge) x(n, 2) = (2 + 1e-5) * kEdge;
  const double found = difference(HexMesh(x, mesh.hexahedra()), {.precision = Precision::kDouble}, Mat3::Identity());
  EXPECT_LE(found, 1e-5);
}

/// A child of a cell: moduli times volume, and Gm.
struct Child {
  double mu, lambda;
  Mat3 Gm;
};

/// A turned and stretched mesh of cells whose children all differ.
struct Cells {
  Cells() {
    Random random(12);
    const Mat3 F = random.rotation() * (Mat3::Identity() + random.matrix(0.2));
    x = mapped(mesh.positions(), F) + random.field(mesh.num_nodes(), 0.05 * kEdge);
    for (std::array<Child, kCorners>& cell : children)
      for (Child& child : cell) {
        Mat3 Gm = Mat3::Identity() + random.matrix(0.2);
        Gm.triangularView<Eigen::StrictlyUpper>().setZero();
        child = {random.uniform(0, 2), random.uniform(0, 9), Gm};
      }
    children[3][5].mu = children[3][5].lambda = 0;  // one is not there
  }

  CellOperator as_operator(bool has_flowed) const {
    const auto partition = std::make_shared<const Partition>(mesh);
    CellOperator op(partition);
    AlignedVector<float> Gm(static_cast<std::size_t>(partition->num_blocks) * kCorners * kMeanPlastic * kBlock, 0.0f);
    for (int e = 0; e < mesh.num_elements(); ++e)
      for (int i = 0; i < kCorners; ++i) {
        const int place = partition->place_of_element[e];
        op.modulus(place, i, CellOperator::kMu) = static_cast<float>(children[e][i].mu);
        op.modulus(place, i, CellOperator::kLambda) = static_cast<float>(children[e][i].lambda);
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c <= r; ++c)
            Gm[((static_cast<std::size_t>(place / kBlock) * kCorners + i) * kMeanPlastic + of_mean_plastic(r, c)) *
                   kBlock +
               place % kBlock] = static_cast<float>(children[e][i].Gm(r, c));
      }
    AlignedVector<double> rest = slot_vector<double>(*partition), current = rest;
    to_slots(*partition, X, rest);
    to_slots(*partition, x, current);
    op.update(rest.data(), current.data(), has_flowed ? Gm.data() : nullptr, kLength);
    return op;
  }

  /// One sample after the other, as the plain implementation has them.
  BlockMatrix as_blocks(bool has_flowed) const {
    BlockMatrix K(mesh.num_nodes());
    for (int e = 0; e < mesh.num_elements(); ++e) {
      const Hexahedron& corners = mesh.hexahedra()[e];
      const ElementPoints shape = gather(mesh.positions(), corners);
      const auto gradients = plain::Element(shape, shape, {1, 1}, {.bending = Bending::kBlended}).sample_gradients();
      for (int i = 0; i < kCorners; ++i) {
        const auto& [mu, lambda, Gm] = children[e][i];
        ElementPoints g = gradients[i];
        if (has_flowed) g = (g * Gm).eval();
        const Mat3 R = polar(gather(x, corners).transpose() * g).R;
        g = kLength * (g * R.transpose()).eval();
        for (int a = 0; a < kCorners; ++a)
          for (int b = 0; b < kCorners; ++b) {
            const Vec3 ga = g.row(a).transpose(), gb = g.row(b).transpose();
            K.add(corners[a], corners[b],
                  mu * (ga.dot(gb) * Mat3::Identity() + gb * ga.transpose()) + lambda * ga * gb.transpose());
          }
      }
    }
    return K;
  }

  static constexpr double kLength = 2 * kEdge;  // any unit
  HexMesh mesh = distorted_block({5, 3, 2}, kEdge, 0.1, 9);
  PointArray X = mesh.positions(), x;
  std::vector<std::array<Child, kCorners>> children{static_cast<std::size_t>(mesh.num_elements())};
};

TEST(CellOperator, IsTheSumOverSamplesThatStandForChildren) {
  const Cells cells;
  for (const bool has_flowed : {false, true}) {
    const CellOperator op = cells.as_operator(has_flowed);
    const BlockMatrix K = cells.as_blocks(has_flowed);
    Random random(13);
    const PointArray p = random.field(cells.mesh.num_nodes(), kEdge);
    PointArray expected = PointArray::Zero(p.rows(), 3), diagonal = expected;
    for (int n = 0; n < p.rows(); ++n)
      for (const BlockMatrix::Entry& entry : K.row(n)) {
        expected.row(n) += p.row(entry.column) * entry.block.transpose();
        if (entry.column == n) diagonal.row(n) = entry.block.diagonal().transpose();
      }
    EXPECT_LE(max_abs(product(op, p) - expected), 2e-6 * max_abs(expected));
    EXPECT_LE(max_abs(diagonal_of(op) - diagonal), 2e-6 * max_abs(diagonal));
  }
}

// Their moduli are those of cells above them too.
TEST(CellOperator, HasNothingWhereACellIsInsideOut) {
  Cells cells;
  const Hexahedron corners = cells.mesh.hexahedra()[0];
  cells.X.row(corners[0]) = 2 * cells.X.row(corners[6]) - cells.X.row(corners[0]);
  const CellOperator op = cells.as_operator(false);
  const int place = op.partition().place_of_element[0];
  for (int i = 0; i < kCorners; ++i) EXPECT_EQ(op.modulus(place, i, CellOperator::kMu), 0);
  PointArray p = PointArray::Zero(cells.X.rows(), 3);
  p.row(corners[0]).setOnes();  // a node of this cell alone
  EXPECT_TRUE(product(op, p).isZero(0));
}

}  // namespace
}  // namespace hexaplast
