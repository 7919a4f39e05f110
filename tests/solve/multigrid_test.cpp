// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/cell_operator.hpp"
#include "hexaplast/geometry/shapes.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

/// A straight tube of `around` hexahedra by `layers` by `along`.
HexMesh straight_tube(int around, int layers, int along) {
  return tube({layers, around, along}, 0.1, 0.1 + 0.01 * layers, arc(0.02 * along, 0, along + 1));
}

/// A cylinder of five blocks: a square in the middle, `across` hexahedra wide, and four as wide around it. Around four
/// of its lines only three hexahedra meet, so that no single lattice numbers all of them.
HexMesh o_grid(int along, int across = 4) {
  const double edge = 0.04 / across, middle = across / 2.0;
  std::vector<Eigen::Vector2d> points;
  const auto find = [&](const Eigen::Vector2d& at) {
    for (std::size_t n = 0; n < points.size(); ++n)
      if ((points[n] - at).norm() < 1e-9) return static_cast<int>(n);
    points.push_back(at);
    return static_cast<int>(points.size()) - 1;
  };
  std::vector<std::array<int, 4>> quads;
  const auto add = [&](int n0, int n1, const auto& at) {
    for (int j = 0; j < n1; ++j)
      for (int i = 0; i < n0; ++i)
        quads.push_back({find(at(i, j)), find(at(i + 1, j)), find(at(i + 1, j + 1)), find(at(i, j + 1))});
  };
  add(across, across, [&](int i, int j) { return Eigen::Vector2d(edge * (i - middle), edge * (j - middle)); });
  for (int side = 0; side < 4; ++side)
    add(across, across, [&](int i, int j) -> Eigen::Vector2d {
      const double angle = std::numbers::pi / 2 / across * (j - middle), out = static_cast<double>(i) / across;
      const Eigen::Vector2d inner(0.02, edge * (j - middle)), outer(0.05 * std::cos(angle), 0.05 * std::sin(angle));
      return Eigen::Rotation2Dd(std::numbers::pi / 2 * side) * Eigen::Vector2d((1 - out) * inner + out * outer);
    });
  const int per_layer = static_cast<int>(points.size());
  PointArray X(per_layer * (along + 1), 3);
  for (int n = 0; n < X.rows(); ++n) X.row(n) << points[n % per_layer].transpose(), 0.01 * (n / per_layer);
  std::vector<Hexahedron> hexahedra;
  for (int k = 0; k < along; ++k)
    for (const auto& [a, b, c, d] : quads) {
      const int low = k * per_layer, high = low + per_layer;
      hexahedra.push_back({low + a, low + b, low + c, low + d, high + a, high + b, high + c, high + d});
    }
  return HexMesh(X, hexahedra);
}

/// The same mesh `count` times, far apart.
HexMesh copies(const HexMesh& mesh, int count) {
  HexMesh all = mesh;
  for (int k = 1; k < count; ++k) all = joined(all, shifted(mesh, Vec3(k, 0, 0)));
  return all;
}

/// A block without the cells of one corner region and some others, a voxel cage; every third hexahedron is turned by a
/// quarter about its third axis.
HexMesh cage() {
  const HexMesh block = regular_grid({9, 10, 11}, Vec3::Zero(), Vec3(0.9, 1.0, 1.1));
  std::vector<Hexahedron> kept;
  for (int e = 0; e < block.num_elements(); ++e) {
    const int i = e % 9, j = e / 9 % 10, k = e / 90;
    if ((i > 5 && j > 6) || (k == 4 && i < 2) || (i + j + k) % 17 == 0) continue;
    kept.push_back(block.hexahedra()[e]);
    if (kept.size() % 3 == 0) {
      const auto [a, b, c, d, f, g, h, l] = kept.back();
      kept.back() = {b, c, d, a, g, h, l, f};
    }
  }
  return HexMesh(block.positions(), kept);
}

/// What the solver reports of the first step of a body under gravity, one end fixed; the answer is compared with the
/// direct solver's.
SolveReport first_solve(const HexMesh& mesh, std::vector<Material> materials, Precision precision, double tolerance,
                        Preconditioner preconditioner) {
  Settings settings;
  settings.precision = precision;
  Motion setup;
  const double low = mesh.positions().col(2).minCoeff();
  for (int n = 0; n < mesh.num_nodes(); ++n)
    if (mesh.positions()(n, 2) < low + 1e-6 || mesh.incident(n).empty()) setup.fixed.push_back(n);
  setup.load = [](double, ConstPoints, Points f) { f.col(0).array() += 0.001; };
  MovingBody fast(Body(mesh, materials, settings), setup,
                  std::make_unique<PreconditionedConjugateGradients>(tolerance, 500, preconditioner));
  MovingBody direct(Body(mesh, materials), setup, std::make_unique<CholeskySolver>());
  fast.step();
  direct.step();
  EXPECT_LE((fast.velocities - direct.velocities).norm(), 20 * tolerance * direct.velocities.norm());
  return fast.latest;
}

/// To a relative residual of 1e-6, of a stiff body, in double precision.
int iterations_of(const HexMesh& mesh, Preconditioner preconditioner = Preconditioner::kMultigrid) {
  return first_solve(mesh, {Material{.young_modulus = 1e6}}, Precision::kDouble, 1e-6, preconditioner).iterations;
}

TEST(Multigrid, NeedsFewIterationsWhereJacobiNeedsMany) {
  const auto gains = [](const HexMesh& mesh, double factor) {
    const int multigrid = iterations_of(mesh), jacobi = iterations_of(mesh, Preconditioner::kDiagonal);
    EXPECT_LT(factor * multigrid, jacobi) << multigrid << " and " << jacobi << " for " << mesh.num_elements();
  };
  gains(regular_grid({8, 8, 16}, Vec3::Zero(), Vec3(0.1, 0.1, 0.2)), 3);
  gains(straight_tube(24, 2, 20), 3);
  gains(cage(), 1.5);  // holes in one cell of two
}

TEST(Multigrid, NeedsAsManyIterationsForManyPartsAsForOne) {
  const HexMesh part = regular_grid({8, 8, 8}, Vec3::Zero(), Vec3(0.1, 0.1, 0.1));
  const int of_one = iterations_of(part);
  for (const int count : {3, 6, 40}) EXPECT_LE(iterations_of(copies(part, count)), of_one + 1) << count << " parts";
}

TEST(Multigrid, TakesDistortedMeshesAndSeveralLattices) {
  for (const std::uint64_t seed : {1, 2}) {
    const int mildly = iterations_of(distorted_block({12, 12, 12}, 0.1 / 12, 0.2, seed));
    EXPECT_LE(iterations_of(distorted_block({12, 12, 12}, 0.1 / 12, 0.25, seed)), 2 * mildly) << seed;
  }
  const int of_grid = iterations_of(regular_grid({8, 8, 12}, Vec3::Zero(), Vec3(0.08, 0.08, 0.12)));
  EXPECT_LE(iterations_of(o_grid(12)), 2 * of_grid);
  EXPECT_LE(iterations_of(o_grid(12, 6)), 2.5 * of_grid);  // cells meet on the first coarse mesh, not on the second
}

TEST(Multigrid, HoldsInMixedPrecisionAndForMixedStiffness) {
  const HexMesh mesh = regular_grid({8, 8, 16}, Vec3::Zero(), Vec3(0.1, 0.1, 0.2));
  std::vector<Material> materials(mesh.num_elements());
  for (int e = 0; e < mesh.num_elements(); ++e) materials[e].young_modulus = e / 64 % 8 < 3 ? 1e6 : 1e4;
  for (const Preconditioner preconditioner : {Preconditioner::kMultigrid, Preconditioner::kAuto})
    EXPECT_LT(first_solve(mesh, materials, Precision::kMixed, 1e-3, preconditioner).iterations, 40);
}

TEST(MixedPrecision, GivesTheDoubleAnswerToItsTolerance) {
  const HexMesh mesh = distorted_block({6, 6, 12}, 0.02, 0.1, 95);
  const Material stiff{.young_modulus = 1e5};
  for (const Preconditioner preconditioner : {Preconditioner::kDiagonal, Preconditioner::kMultigrid})
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9})
      EXPECT_GT(first_solve(mesh, {stiff}, Precision::kMixed, tolerance, preconditioner).iterations, 0);
}

// Of one that is too small, and of those whose cells would not meet across a seam.
TEST(Multigrid, FallsBackToTheDiagonalWhereThereIsNoLattice) {
  for (const HexMesh& mesh : {support::block({2, 2, 3}, 0.1), o_grid(8, 3), o_grid(8, 5), straight_tube(17, 2, 10)})
    EXPECT_EQ(first_solve(mesh, {Material{}}, Precision::kDouble, 1e-8, Preconditioner::kMultigrid).preconditioner,
              PreconditionedBy::kDiagonal)
        << mesh.num_elements();
}

// Their moduli are those of cells above them too.
TEST(CellOperator, HasNothingWhereACellIsInsideOut) {
  const HexMesh mesh = distorted_block({5, 3, 2}, kEdge, 0.1, 9);
  const auto partition = std::make_shared<const Partition>(mesh);
  const Hexahedron corners = mesh.hexahedra()[0];
  PointArray X = mesh.positions();
  X.row(corners[0]) = 2 * X.row(corners[6]) - X.row(corners[0]);
  CellOperator op(partition);
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (int i = 0; i < kCorners; ++i)
      for (const auto which : {CellOperator::kMu, CellOperator::kLambda})
        op.modulus(partition->place_of_element[e], i, which) = 1;
  AlignedVector<double> rest = slot_vector<double>(*partition), current = rest;
  to_slots(*partition, X, rest);
  to_slots(*partition, mesh.positions(), current);
  op.update(rest.data(), current.data(), nullptr, kEdge);
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (int i = 0; i < kCorners; ++i)
      EXPECT_EQ(op.modulus(partition->place_of_element[e], i, CellOperator::kMu), e == 0 ? 0 : 1);
  AlignedVector<float> p = slot_vector<float>(*partition), product = p;
  p[4 * static_cast<std::size_t>(partition->slot_of_node[corners[0]])] = 1;  // a node of this cell alone
  for (int chunk = 0; chunk < partition->num_chunks; ++chunk) op.add_product(chunk, 1, p.data(), product.data());
  for (const float entry : product) EXPECT_EQ(entry, 0);
}

// Where the samples of an element have one gradient: as they have by themselves.
TEST(CycleOperator, HasTheDiagonalOfElements) {
  PointArray X = regular_grid({8, 6, 12}, Vec3::Zero(), {0.04, 0.03, 0.06}).positions();
  X.col(0) += 0.3 * X.col(1) - 0.2 * X.col(2);
  Body body(HexMesh(X, regular_grid({8, 6, 12}, Vec3::Zero(), Vec3::Ones()).hexahedra()), {Material{}},
            {.precision = Precision::kMixed});
  const Mat3 F = Eigen::AngleAxisd(2, Vec3(1, -2, 3).normalized()) * Vec3(1.3, 0.8, 1.1).asDiagonal();
  body.linearize(X.matrix() * F.transpose());
  MatrixFreeSystem system;
  system.wants_levels = true;
  body.add_operator(1, system);
  const KernelBody& kernels = system.bodies.front();
  const Partition& partition = kernels.single_operator->partition();
  AlignedVector<float> of_elements = slot_vector<float>(partition);
  find_diagonal(*kernels.single_operator, 1.0f, of_elements);
  const std::span<const float> of_cycle = kernels.levels.front().diagonal;
  for (int k = 0; k < 4 * partition.num_nodes; ++k)
    EXPECT_NEAR(of_cycle[k], of_elements[k], 2e-3 * of_elements[k]) << k;
}

MovingBody flowing_bar() {
  return MovingBody(Body(regular_grid({4, 4, 16}, Vec3::Zero(), {0.04, 0.04, 0.16}),
                         {{.young_modulus = 5000, .poisson_ratio = 0.45, .yield_stress = 20, .flow_rate = 4}},
                         {.precision = Precision::kMixed}),
                    {.gravity = {1, 0, -9}, .fixed = {0, 1, 2, 3, 4}},
                    std::make_unique<PreconditionedConjugateGradients>(1e-2, 100, Preconditioner::kMultigrid));
}

TEST(SpectralRadii, OfEarlierStepsServeAsWellAsThePresentOnes) {
  MovingBody bar = flowing_bar(), anew = flowing_bar();
  int iterations = 0, iterations_anew = 0;
  double change = 0;
  for (int step = 0; step < 32; ++step) {
    bar.step();
    anew.solver_memory().reset();
    anew.step();
    iterations += bar.latest.iterations;
    iterations_anew += anew.latest.iterations;
    const SpectralRadii &earlier = bar.solver_memory().radii.at(0), &present = anew.solver_memory().radii.at(0);
    for (int level = 0; level < earlier.num_levels; ++level)
      change = std::max(change, std::abs(earlier.of_level[level] / present.of_level[level] - 1));
  }
  EXPECT_GT(std::ranges::max(plastic_strains(bar.body)), 0.9);
  EXPECT_LT(change, 0.15);  // what the margin of the estimates allows for
  EXPECT_NEAR(iterations, iterations_anew, 0.03 * iterations_anew);
}

// Too small a radius makes a cycle indefinite, or smooth badly: it is found anew, in the same step.
TEST(SpectralRadii, ThatAreTooSmallAreFoundAnew) {
  MovingBody bar = flowing_bar();
  bar.step();
  const double right = bar.solver_memory().radii.at(0).of_level[0];
  for (double& radius : bar.solver_memory().radii.at(0).of_level) radius *= 0.2;
  bar.step();
  EXPECT_EQ(bar.latest.preconditioner, PreconditionedBy::kMultigrid);
  EXPECT_TRUE(bar.latest.converged);
  EXPECT_NEAR(bar.solver_memory().radii.at(0).of_level[0], right, 0.1 * right);
}

/// M + h^2 K of two bodies side by side.
class TwoBodies final : public LinearSystem {
 public:
  int num_nodes() const override { return 2 * count_; }
  void apply(ConstPoints p, Points Ap) const override {
    Ap = mass_ * p;
    for (int k = 0; k < 2; ++k)
      bodies_[k].add_stiffness_product(-1e-3, p.middleRows(k * count_, count_), Ap.middleRows(k * count_, count_));
  }
  bool matrix_free(MatrixFreeSystem& system) const override {
    system.diagonal.setZero(num_nodes(), 3);
    system.constraints.reset(num_nodes());
    for (int k = 0; k < 2; ++k) {
      MatrixFreeSystem part;
      part.wants_levels = system.wants_levels;
      part.diagonal.setConstant(count_, 3, mass_);
      part.constraints.reset(count_);
      bodies_[k].add_operator(-1e-3, part);
      system.add_part(part, k * count_);
    }
    return true;
  }
  void linearize(double stretch) {
    mass_ = 1e-3 * stretch;
    for (Body& body : bodies_) body.linearize(stretch * body.mesh().positions());
  }

 private:
  std::array<Body, 2> bodies_{{{support::block({8, 8, 12}, 0.01), {{.young_modulus = 1e6}}},
                               {support::block({8, 8, 12}, 0.01), {{.young_modulus = 1e4}}}}};
  int count_ = bodies_[0].mesh().num_nodes();
  double mass_ = 1e-3;
};

TEST(SpectralRadii, OfSeveralBodiesServeTheNextSteps) {
  TwoBodies system;
  PreconditionedConjugateGradients solver(1e-6, 300, Preconditioner::kMultigrid);
  const PointArray b = Random(81).field(system.num_nodes(), 1);
  PointArray x(b.rows(), 3);
  SolverMemory memory;
  for (int step = 1; step < 5; ++step) {
    system.linearize(1 + 0.001 * step);
    EXPECT_TRUE(solver.solve_next(system, b, x, memory).converged);
    ASSERT_EQ(memory.radii.size(), 2U);
    for (const SpectralRadii& of_body : memory.radii) EXPECT_EQ(of_body.num_solves, step);
  }
  memory.radii[1].of_level[0] *= 0.2;
  const double spoiled = memory.radii[1].of_level[0];
  EXPECT_TRUE(solver.solve_from_guess(system, b, x = PointArray::Zero(b.rows(), 3), memory).converged);
  EXPECT_GT(memory.radii[1].of_level[0], 2 * spoiled) << "what a further solve finds is kept";
  memory.radii.pop_back();
  EXPECT_TRUE(solver.solve_next(system, b, x, memory).converged);
  EXPECT_EQ(memory.radii.size(), 2U) << "those of another number of bodies are not used";
}

TEST(SpectralRadii, ThatCannotBeAreRefused) {
  for (const auto& spoil :
       {+[](SpectralRadii& radii) { radii.num_levels = SpectralRadii::kMaxLevels + 1; },
        +[](SpectralRadii& radii) { radii.num_solves = -1; }, +[](SpectralRadii& radii) { radii.of_level[0] = NAN; },
        +[](SpectralRadii& radii) { radii.of_level[1] = 0; }}) {
    MovingBody bar = flowing_bar(), other = flowing_bar();
    bar.step();
    spoil(bar.solver_memory().radii.at(0));
    std::stringstream bytes;
    bar.save(bytes);
    EXPECT_THROW(other.load(bytes), InputError);
  }
}

}  // namespace
}  // namespace hexaplast
