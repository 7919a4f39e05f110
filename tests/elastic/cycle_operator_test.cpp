// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/cycle_operator.hpp"

#include <gtest/gtest.h>

#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::kEdge;
using support::Random;

PointArray product(const ChunkedOperator<float>& op, const PointArray& p) {
  const Partition& partition = op.partition();
  AlignedVector<float> from = slot_vector<float>(partition), to = from;
  to_slots(partition, p, from);
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) update_ghosts(partition, chunk, from.data());
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, 1, from.data(), to.data());
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) reduce_ghosts(partition, chunk, to.data());
  PointArray out(p.rows(), 3);
  for (int n = 0; n < partition.num_nodes; ++n)
    for (int i = 0; i < 3; ++i) out(n, i) = to[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];
  return out;
}

/// Largest difference from the product of the body's own stiffness, over the size of that.
double difference(const HexMesh& mesh, const Settings& settings, const Mat3& F) {
  Body body(mesh, {Material{.young_modulus = 1e4, .poisson_ratio = 0.45}}, settings);
  const PointArray x = support::mapped(mesh.positions(), F);
  if (settings.num_branches() > 0) body.set_time_step(0.1);
  body.linearize(x);
  CycleOperator cycle(body.state().model);
  cycle.update(body.state().model, body.state().at);
  Random random(5);
  const PointArray p = random.field(mesh.num_nodes(), kEdge);
  PointArray own = PointArray::Zero(p.rows(), 3);
  body.add_stiffness_product(-1, p, own);
  return support::max_abs(product(cycle, p) - own) / support::max_abs(own);
}

TEST(CycleOperator, IsTheStiffnessOfTurnedCubes) {
  Random random(6);
  const HexMesh cubes = support::block({5, 4, 3}, kEdge);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    for (const std::vector<double>& relaxation : {std::vector<double>{}, {1.5, 0.3, 3, 0.1}})
      EXPECT_LE(difference(cubes, {.relaxation = relaxation, .precision = precision}, random.rotation()), 2e-3);
}

TEST(CycleOperator, IsNearTheStiffnessOfStretchedAndDistortedElements) {
  const Mat3 F = Vec3(1.5, 0.8, 0.9).asDiagonal();
  const HexMesh mesh = support::distorted_block({5, 4, 3}, kEdge, 0.05, 7);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const double found = difference(mesh, {.precision = precision}, F);
    EXPECT_LE(found, 0.3);
    EXPECT_GE(found, 2e-3);  // it is not the same
  }
}

// All blocks have an element that is no parallelepiped by far, and so their own coefficients.
TEST(CycleOperator, IsTheStiffnessItselfOfElementsWithFlatCorners) {
  const HexMesh mesh = support::distorted_block({5, 4, 3}, kEdge, 0.25, 8);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    EXPECT_LE(difference(mesh, {.precision = precision}, Mat3::Identity()),
              precision == Precision::kDouble ? 1e-5 : 1e-6);
}

// Thin cells beside thick ones: their coefficients do not fit half precision.
TEST(CycleOperator, IsTheStiffnessItselfOfThinElementsBesideOthers) {
  HexMesh mesh = support::block({3, 3, 3}, kEdge);
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 2.5 * kEdge) x(n, 2) = (2 + 1e-5) * kEdge;
  const double found = difference(HexMesh(x, mesh.hexahedra()), {.precision = Precision::kDouble}, Mat3::Identity());
  EXPECT_LE(found, 1e-5);
}

}  // namespace
}  // namespace hexaplast
