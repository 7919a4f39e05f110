// SPDX-License-Identifier: LGPL-2.1-or-later
// The cycle as a matrix: conjugate gradients may lean on it only where it is symmetric and positive definite.
#include <Eigen/Dense>

#include "hexaplast/geometry/shapes.hpp"
#include "solve/multigrid.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

constexpr double kTimeStep = 0.1;
constexpr double kGreatest = 5;  // eigenvalue of M^-1 A: a coarse operator may be softer than what it stands for

/// M + h^2 K of a body twisted about z, one end fixed, or free and at rest, and its cycle.
class Cycle {
 public:
  Cycle(Precision precision, const HexMesh& mesh, const std::vector<Material>& materials,
        const std::vector<int>& removed = {}, std::vector<NodeBlock> blocks = {}, bool is_free = false)
      : body_(mesh, materials, {.precision = precision}), blocks_(std::move(blocks)) {
    PointArray x = mesh.positions();
    const double low = x.col(2).minCoeff(), height = x.col(2).maxCoeff() - low;
    for (int n = 0; n < x.rows(); ++n) {
      const double angle = is_free ? 0 : 0.5 * (x(n, 2) - low) / height;
      x.row(n).head<2>() = (Eigen::Rotation2Dd(angle) * Eigen::Vector2d(x(n, 0), x(n, 1))).transpose();
    }
    body_.remove(removed);
    body_.linearize(x);
    system_.wants_levels = true;
    body_.add_operator(-kTimeStep * kTimeStep, system_);
    system_.diagonal = (1000 * nodal_volumes(mesh.positions(), mesh.hexahedra())).replicate(1, 3);
    system_.constraints.reset(mesh.num_nodes());
    for (int n = 0; n < mesh.num_nodes(); ++n)
      if ((!is_free && mesh.positions()(n, 2) < low + 0.01 * height) || mesh.incident(n).empty())
        system_.constraints.free.row(n).setZero();
    std::erase_if(blocks_, [&](const NodeBlock& block) { return system_.constraints.free(block.node, 0) == 0; });
    SpectralRadii none;
    cycle_.setup(part(), {.diagonal = system_.diagonal, .free = system_.constraints.free, .blocks = blocks_}, none);
  }
  Cycle(const Cycle&) = delete;

  int num_levels() const { return static_cast<int>(part().levels.size()); }
  int size() const { return 3 * static_cast<int>(system_.constraints.free.rows()); }
  bool is_free(Eigen::Index i) const { return system_.constraints.free(i / 3, i % 3) != 0; }

  Eigen::VectorXd random(std::uint64_t seed) const {
    Random numbers(seed);
    return Eigen::VectorXd::NullaryExpr(size(), [&](auto i) { return is_free(i) ? numbers.uniform(-1, 1) : 0; });
  }

  Eigen::VectorXd preconditioned(const Eigen::VectorXd& r) {
    const AlignedVector<float> from = slots(r);
    AlignedVector<float> to(from.size(), 0.0f);
    cycle_.apply(from, to);
    return field(to);
  }

  Eigen::VectorXd product(const Eigen::VectorXd& p) const {
    const PointArray nodal = unstacked(p);
    PointArray Ap = system_.diagonal.cwiseProduct(nodal);
    body_.add_stiffness_product(-kTimeStep * kTimeStep, nodal, Ap);
    for (const auto& [node, block] : blocks_) Ap.row(node) += nodal.row(node) * block.transpose();
    return stacked(Ap.cwiseProduct(system_.constraints.free.cast<double>()));
  }

 private:
  const KernelBody& part() const { return system_.bodies.front(); }
  const Partition& partition() const { return part().levels.front().op->partition(); }
  std::size_t number(int i) const {
    return 4 * static_cast<std::size_t>(partition().slot_of_node[i / 3]) + static_cast<std::size_t>(i % 3);
  }
  AlignedVector<float> slots(const Eigen::VectorXd& from) const {
    AlignedVector<float> out = slot_vector<float>(partition());
    for (int i = 0; i < size(); ++i) out[number(i)] = static_cast<float>(from[i]);
    return out;
  }
  Eigen::VectorXd field(const AlignedVector<float>& from) const {
    Eigen::VectorXd out(size());
    for (int i = 0; i < size(); ++i) out[i] = static_cast<double>(from[number(i)]);
    return out;
  }

  Body body_;
  std::vector<NodeBlock> blocks_;
  MatrixFreeSystem system_;
  Multigrid cycle_;
};

struct Range {
  double min = 0, greatest = 0;
};

/// Of the eigenvalues of M^-1 A, M^-1 the cycle, by as many steps of conjugate gradients as find both ends.
Range eigenvalues(Cycle& cycle) {
  constexpr int kSteps = 40;
  Eigen::VectorXd r = cycle.random(1), z = cycle.preconditioned(r), p = z;
  Eigen::VectorXd diagonal(kSteps), beside = Eigen::VectorXd::Zero(kSteps);
  double rho = r.dot(z), alpha_before = 0, beta = 0;
  for (int step = 0; step < kSteps; ++step) {
    EXPECT_GT(rho, 0) << "step " << step;
    const Eigen::VectorXd Ap = cycle.product(p);
    const double alpha = rho / p.dot(Ap);
    diagonal[step] = 1 / alpha + (step > 0 ? beta / alpha_before : 0);
    r -= alpha * Ap;
    z = cycle.preconditioned(r);
    beta = r.dot(z) / rho;
    rho *= beta;
    if (!(rho > 0) || !(alpha > 0)) return {rho, rho};
    beside[step] = std::sqrt(beta) / alpha;
    alpha_before = alpha;
    p = z + beta * p;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, Eigen::VectorXd(beside.head(kSteps - 1)), Eigen::EigenvaluesOnly);
  return {solver.eigenvalues()[0], solver.eigenvalues()[kSteps - 1]};
}

void expect_definite_in(const char* name, Cycle&& cycle) {
  SCOPED_TRACE(name);
  EXPECT_GT(cycle.num_levels(), 1);
  const Eigen::VectorXd a = cycle.random(11), b = cycle.random(12);
  const Eigen::VectorXd of_a = cycle.preconditioned(a), of_b = cycle.preconditioned(b);
  EXPECT_LE(std::abs(a.dot(of_b) - b.dot(of_a)), 1e-5 * std::sqrt(a.dot(of_a) * b.dot(of_b)));
  const Range range = eigenvalues(cycle);
  EXPECT_GT(range.min, 0);
  EXPECT_LT(range.greatest, kGreatest);
}

template <class Make>
void expect_definite(const char* name, const Make& make) {
  expect_definite_in(name, make(Precision::kDouble));
  expect_definite_in(name, make(Precision::kMixed));
}

Material stiff(double poisson_ratio) { return {.young_modulus = 1e6, .poisson_ratio = poisson_ratio}; }

/// nu 0, every seventh nu .49; every fifth a thousand times as stiff as the others.
std::vector<Material> mixture(int count) {
  std::vector<Material> out(count, stiff(0));
  for (int e = 0; e < count; ++e) {
    if (e % 7 == 0) out[e].poisson_ratio = 0.49;
    if (e % 5 != 0) out[e].young_modulus = 1e3;
  }
  return out;
}

TEST(MultigridCycle, IsPositiveDefiniteOnDistortedMeshes) {
  for (const double nu : {0.3, 0.49})
    for (const double fraction : {0.0, 0.2, 0.25})
      expect_definite("distorted", [&](Precision precision) {
        return Cycle(precision, distorted_block({12, 12, 12}, 0.01, fraction, 1), {stiff(nu)});
      });
}

TEST(MultigridCycle, IsPositiveDefiniteForMixedMaterials) {
  const HexMesh block = support::block({12, 12, 12}, 0.01);
  expect_definite("mixture",
                  [&](Precision precision) { return Cycle(precision, block, mixture(block.num_elements())); });
  std::vector<Material> one(block.num_elements(), stiff(0));
  one[700].poisson_ratio = 0.49;
  one[700].young_modulus = 1e9;
  expect_definite("one stiff one", [&](Precision precision) { return Cycle(precision, block, one); });
  const HexMesh moved = distorted_block({12, 12, 12}, 0.01, 0.25, 2);
  expect_definite("distorted mixture",
                  [&](Precision precision) { return Cycle(precision, moved, mixture(moved.num_elements())); });
}

// Lanczos sees an element that differs a little late.
TEST(MultigridCycle, IsPositiveDefiniteBesideAnElementThatDiffersMildly) {
  const HexMesh block = support::block({12, 12, 12}, 0.01);
  for (const int element : {0, 5, 78, 700, 1000})
    for (const auto& [nu, of_one, ratio] :
         {std::tuple{0.3, 0.46, 1.0}, std::tuple{0.0, 0.44, 1.0}, std::tuple{0.3, 0.3, 10.0}}) {
      SCOPED_TRACE(element);
      std::vector<Material> one(block.num_elements(), stiff(nu));
      one[element].poisson_ratio = of_one;
      one[element].young_modulus *= ratio;
      expect_definite("one that differs", [&](Precision precision) { return Cycle(precision, block, one); });
    }
}

TEST(MultigridCycle, IsPositiveDefiniteOnTornThinAndHollowMeshes) {
  const HexMesh block = support::block({12, 12, 12}, 0.01);
  std::vector<int> torn;
  for (int e = 0; e < block.num_elements(); ++e)
    if ((e / 144 == 5 && e % 12 < 9) || e % 11 == 0) torn.push_back(e);
  expect_definite("torn", [&](Precision precision) { return Cycle(precision, block, {stiff(0.45)}, torn); });
  std::vector<Hexahedron> kept;
  for (int e = 0; e < block.num_elements(); ++e)
    if (e % 12 < 6 || e / 12 % 12 < 5 || e % 17 == 0) kept.push_back(block.hexahedra()[e]);
  const HexMesh voxels(block.positions(), kept);
  expect_definite("voxels", [&](Precision precision) { return Cycle(precision, voxels, {stiff(0.45)}); });
  const HexMesh thin = regular_grid({20, 2, 20}, Vec3::Zero(), Vec3(0.1, 0.001, 0.1));
  expect_definite("thin", [&](Precision precision) { return Cycle(precision, thin, {stiff(0.45)}); });
  const HexMesh ring = tube({2, 16, 20}, 0.1, 0.12, arc(0.4, 1, 21));
  expect_definite("tube", [&](Precision precision) { return Cycle(precision, ring, mixture(ring.num_elements())); });
}

// What resists along one direction alone, not that of an axis, on the nodes of a side and on some within: from a
// thousandth of what a node has to what single precision takes for a constraint.
TEST(MultigridCycle, IsPositiveDefiniteWithBlocksOnNodes) {
  const HexMesh moved = distorted_block({12, 12, 12}, 0.01, 0.2, 3);
  const Vec3 normal(0.36, 0.48, 0.8);
  for (const double stiffness : {0.1, 10.0, 1e3, 1e5, 1e6, 1e8, 1e12}) {
    SCOPED_TRACE(stiffness);
    std::vector<NodeBlock> blocks;
    for (int n = 0; n < moved.num_nodes(); ++n)
      if (moved.positions().row(n).dot(normal) > 0.15 || n % 97 == 0)
        blocks.push_back({n, stiffness * normal * normal.transpose()});
    expect_definite("blocks", [&](Precision precision) { return Cycle(precision, moved, {stiff(0.3)}, {}, blocks); });
  }
}

/// All of the matrix, on meshes that are small enough for it.
void expect_no_negative_eigenvalue(Cycle&& cycle) {
  std::vector<int> free;
  for (int i = 0; i < cycle.size(); ++i)
    if (cycle.is_free(i)) free.push_back(i);
  const int size = static_cast<int>(free.size());
  Eigen::MatrixXd inverse(size, size), A(size, size);
  for (int j = 0; j < size; ++j) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(cycle.size(), free[j]);
    inverse.col(j) = cycle.preconditioned(unit)(free);
    A.col(j) = cycle.product(unit)(free);
  }
  const Eigen::VectorXd scale = A.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * inverse * scale.asDiagonal();
  EXPECT_LE((scaled - scaled.transpose()).cwiseAbs().maxCoeff(), 1e-5 * scaled.cwiseAbs().maxCoeff());
  EXPECT_GT(support::eigenvalues(scaled)[0], 0.05);
  const Eigen::MatrixXd L = A.llt().matrixL();
  const Eigen::VectorXd of_both = support::eigenvalues(L.transpose() * inverse * L);
  EXPECT_GT(of_both[0], 0);
  EXPECT_LT(of_both[size - 1], kGreatest);
}

TEST(MultigridCycle, HasNoNegativeEigenvalue) {
  const HexMesh mesh = distorted_block({4, 4, 5}, 0.01, 0.25, 7);
  expect_no_negative_eigenvalue(Cycle(Precision::kDouble, mesh, mixture(mesh.num_elements())));
}

// Eigenvalues that lie close: six steps of Lanczos see the greatest of a coarse mesh too late.
TEST(MultigridCycle, HasNoNegativeEigenvalueOnSmallRegularGrids) {
  for (const std::array<int, 3>& cells : {std::array{5, 4, 5}, std::array{5, 4, 6}, std::array{5, 5, 6}})
    for (const double nu : {0.3, 0.45}) {
      SCOPED_TRACE(testing::Message() << cells[0] << ' ' << cells[1] << ' ' << cells[2] << ", nu " << nu);
      expect_no_negative_eigenvalue(Cycle(Precision::kDouble, support::block(cells, 0.01), {stiff(nu)}, {}, {}, true));
    }
}

}  // namespace
}  // namespace hexaplast
