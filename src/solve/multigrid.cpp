// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/multigrid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hexaplast/base/parallel.hpp"
#include "layout/coarse_mesh.hpp"
#include "solve/constants.hpp"
#include "solve/slot_kernels.hpp"

namespace hexaplast {

bool SpectralRadii::is_valid_for(const SpectralRadii& other) const {
  return num_levels == other.num_levels && num_solves < kMaxSolvesOfRadii && factor == other.factor &&
         diagonal == other.diagonal && num_free == other.num_free &&
         std::abs(stiffness - other.stiffness) <= kMaxChangeOfRadii * other.stiffness;
}

void SpectralRadii::update(int iterations_now) {
  if (num_levels == 0) return;
  if (num_solves == 1) iterations = iterations_now;
  if (iterations_now > kMaxGrowthOfIterations * iterations + 1) num_solves = kMaxSolvesOfRadii;
}

bool SpectralRadii::is_valid() const {
  return num_levels >= 0 && num_levels <= kMaxLevels && num_solves >= 0 &&
         std::all_of(of_level.begin(), of_level.begin() + num_levels,
                     [](double radius) { return radius > 0 && std::isfinite(radius); });
}

namespace {

/// Ad = A d on the nodes, ghosts of d included; without blocks.
template <class T>
void apply(MultigridLevel<T>& level) {
  const Partition& partition = level.op->partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    for (std::size_t i = first; i < first + size; ++i) level.Ad[i] = level.diagonal[i] * level.d[i];
  });
  multiply(*level.op, level.factor, level.d, level.Ad);
  parallel_for(partition.num_chunks, [&](int chunk) {
    reduce_ghosts(partition, chunk, level.Ad.data());
    level.fixed.clear(chunk, level.Ad);
  });
}

/// r -= A d.
template <class T>
void subtract_product(MultigridLevel<T>& level) {
  const Partition& partition = level.op->partition();
  if (level.has_diagonal)
    parallel_for(partition.num_chunks, [&](int chunk) {
      const auto [first, size] = OwnedRange(partition, chunk);
      for (std::size_t i = first; i < first + size; ++i) level.r[i] -= level.diagonal[i] * level.d[i];
    });
  multiply(*level.op, -level.factor, level.d, level.r);
  parallel_for(partition.num_chunks, [&](int chunk) {
    reduce_ghosts(partition, chunk, level.r.data());
    if (!level.blocks.empty()) level.blocks.add_product(chunk, T(-1), level.d, level.r);
    level.fixed.clear(chunk, level.r);
  });
}

/// The nodes of a chunk from those of another mesh, summed in single precision.
template <class From, class To>
void map_nodes(const NodalMap& map, const Partition& partition, int chunk, const AlignedVector<From>& from,
               AlignedVector<To>& to) {
  for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot) {
    Eigen::Array4f sum = Eigen::Array4f::Zero();
    for (int k = map.first[slot]; k < map.first[slot + 1]; ++k)
      sum += map.weight[k] * numbers_at(from.data(), map.column[k]).template cast<float>();
    numbers_at(to.data(), slot) = sum.template cast<To>();
  }
}

/// sum a b over the nodes, added chunk by chunk
template <class T>
double dot(MultigridLevel<T>& level, const AlignedVector<T>& a, const AlignedVector<T>& b) {
  const Partition& partition = level.op->partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    level.partial[chunk] = slot_dot(size, a.data() + first, b.data() + first);
  });
  return std::accumulate(level.partial.begin(), level.partial.end(), 0.0);
}

/// What Lanczos has found of a matrix: tridiagonal, of a size that needs no allocation.
struct Tridiagonal {
  template <int kRows, int kMaxRows>
  using Column = Eigen::Matrix<double, kRows, 1, 0, kMaxRows, 1>;
  Column<kMaxLanczosSteps, kMaxLanczosSteps> diagonal = decltype(diagonal)::Zero(), beside = diagonal;

  /// Of the first `size` rows.
  double largest_eigenvalue(int size) const {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLanczosSteps, kMaxLanczosSteps>;
    Eigen::SelfAdjointEigenSolver<Matrix> solver(size);
    solver.computeFromTridiagonal(Column<Eigen::Dynamic, kMaxLanczosSteps>(diagonal.head(size)),
                                  Column<Eigen::Dynamic, kMaxLanczosSteps - 1>(beside.head(size - 1)),
                                  Eigen::EigenvaluesOnly);
    return solver.eigenvalues()[size - 1];
  }
};

/// Largest eigenvalue of D^-1 A, from below: Lanczos in the scalar product of D, `min_steps` and on until one finds
/// little more. Unlike the power method it finds what a single element stands out by.
template <class T>
double spectral_radius(MultigridLevel<T>& level, int min_steps) {
  const Partition& partition = level.op->partition();
  for (AlignedVector<T>* vector : {&level.x, &level.Ad})
    if (vector->size() != level.d.size()) vector->assign(level.d.size(), T(0));
  const auto for_each_number = [&](const auto& visit) {
    parallel_for(partition.num_chunks, [&](int chunk) {
      const auto [first, size] = OwnedRange(partition, chunk);
      for (std::size_t i = first; i < first + size; ++i) visit(i);
    });
  };
  // a start that no symmetry of a mesh is blind to, the same in every run
  std::uint32_t state = 12345;
  std::fill(level.d.begin(), level.d.end(), T(0));
  std::fill(level.r.begin(), level.r.end(), T(0));
  for (std::size_t i = 0; i < 4 * static_cast<std::size_t>(partition.num_nodes); ++i) {
    state = state * 1664525u + 1013904223u;
    if (level.inverse[i] > 0) level.d[i] = static_cast<T>(static_cast<double>(state >> 8) / (1 << 24) - 0.5);
  }
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) level.fixed.clear(chunk, level.d);

  // d: the present vector, r: the one before, x: D d
  Tridiagonal found;
  auto &alpha = found.diagonal, &beta = found.beside;
  double largest = 0;
  for (int step = 0;; ++step) {
    for_each_number([&](std::size_t i) { level.x[i] = level.inverse[i] > 0 ? level.d[i] / level.inverse[i] : T(0); });
    const double norm = std::sqrt(dot(level, level.d, level.x));
    if (step > 0) beta[step - 1] = norm;
    if (step == kMaxLanczosSteps || !(norm > kRangeEnds * alpha[0])) break;

    for_each_number([&](std::size_t i) { level.d[i] *= static_cast<T>(1 / norm); });
    apply(level);
    alpha[step] = dot(level, level.d, level.Ad);
    const double before_step = std::exchange(largest, found.largest_eigenvalue(step + 1));
    if (step + 1 >= min_steps && !(largest > kLanczosGrowth * before_step)) break;
    const T along = static_cast<T>(alpha[step]), before = static_cast<T>(step > 0 ? norm : 0);
    for_each_number(
        [&](std::size_t i) { level.r[i] = level.inverse[i] * level.Ad[i] - along * level.d[i] - before * level.r[i]; });
    std::swap(level.d, level.r);
  }
  return largest > 0 ? largest : 1;
}

}  // namespace

template <class T>
void MultigridLevel<T>::resize() {
  const std::size_t size = 4 * static_cast<std::size_t>(op->partition().num_slots);
  for (AlignedVector<T>* vector : {&diagonal, &inverse, &r, &d})
    if (vector->size() != size) vector->assign(size, T(0));
  partial.resize(op->partition().num_chunks);
}

/// Blocks go down lumped, as the diagonal does. A node between coarse ones follows these only as far as its block lets
/// it (SlotBlocks::follow), and ties them by no more than its own stiffness, as a fixed one does.
template <class T>
template <class Finer>
void Multigrid<T>::restrict_blocks(MultigridLevel<Finer>& finer, const CoarseMesh& mesh, MultigridLevel<float>& level) {
  if (finer.blocks.empty()) return;
  block_of_slot_.assign(finer.op->partition().num_nodes, -1);
  const auto& entries = finer.blocks.entries();
  for (std::size_t k = 0; k < entries.size(); ++k) block_of_slot_[entries[k].slot] = static_cast<int>(k);
  for (int slot = 0; slot < level.op->partition().num_nodes; ++slot)
    if (const int there = mesh.finer_slot[slot]; there >= 0 && block_of_slot_[there] >= 0)
      finer.blocks.set_coarse(block_of_slot_[there]);
  for (int slot = 0; slot < level.op->partition().num_nodes; ++slot) {
    Mat3 sum = Mat3::Zero();
    for (int n = mesh.restriction.first[slot]; n < mesh.restriction.first[slot + 1]; ++n)
      if (const int k = block_of_slot_[mesh.restriction.column[n]]; k >= 0)
        sum += static_cast<double>(mesh.restriction.weight[n]) * entries[k].goes_down;
    for (int axis = 0; axis < 3; ++axis)
      if (level.is_fixed[4 * static_cast<std::size_t>(slot) + axis]) {
        sum.row(axis).setZero();
        sum.col(axis).setZero();
      }
    if (!sum.isZero(0)) level.blocks.add(slot, sum);
  }
}

template <class T>
void Multigrid<T>::setup_operators(const KernelBody& body) {
  operators_ = body.coarse;
  fine_.op = body.op<T>();
  if constexpr (std::is_same_v<T, float>)
    if (body.cycle_operator) fine_.op = body.cycle_operator;
  if (coarse_.size() != operators_.size()) radii_of_.revision = stiffness_of_.revision = 0;
  coarse_.resize(operators_.size());
  for (std::size_t k = 0; k < coarse_.size(); ++k) coarse_[k].op = operators_[k].op;
}

template <class T>
const AlignedVector<T>& Multigrid<T>::stiffness(const KernelBody& body) {
  setup_operators(body);
  const bool is_known =
      body.revision != 0 && body.revision == stiffness_of_.revision && body.factor == stiffness_of_.factor;
  if (is_known) return fine_.stiffness;
  const auto find = [&]<class U>(MultigridLevel<U>& level) {
    level.factor = static_cast<U>(body.factor);
    level.stiffness.resize(4 * static_cast<std::size_t>(level.op->partition().num_slots));
    find_diagonal(*level.op, level.factor, level.stiffness);
  };
  find(fine_);
  for (MultigridLevel<float>& level : coarse_) find(level);
  stiffness_of_ = {.revision = body.revision, .factor = body.factor};
  return fine_.stiffness;
}

// Terms beside the bodies do not raise the spectral radii: they add the same to A and to D. So these are found without
// them, and serve all solves with one linearization, however contacts come and go.
template <class T>
void Multigrid<T>::setup(const KernelBody& body, const NodalPart& rest, SpectralRadii* known) {
  setup_operators(body);
  stiffness(body);
  find_radii(body, rest, known);
  place(rest.diagonal, rest.free, rest.blocks);
}

// In as many steps as radii serve, those of a body that flows by a few hundredths per step change by less than kSafety
// allows for.
template <class T>
void Multigrid<T>::find_radii(const KernelBody& body, const NodalPart& rest, SpectralRadii* known) {
  const auto for_each_radius = [&](const auto& visit) {
    visit(fine_.radius, 0);
    for (std::size_t k = 0; k < coarse_.size(); ++k) visit(coarse_[k].radius, k + 1);
  };
  const PointArray& own_diagonal = rest.own_diagonal ? *rest.own_diagonal : rest.diagonal;
  const bool are_of_this = body.revision != 0 && body.revision == radii_of_.revision &&
                           body.factor == radii_of_.factor && own_diagonal.rows() == radii_of_.diagonal.rows() &&
                           own_diagonal == radii_of_.diagonal && rest.free == radii_of_.free;
  if (are_of_this && !known) return;
  if (!are_of_this) {
    radii_of_.revision = body.revision;
    if (body.revision != 0) {
      radii_of_.factor = body.factor;
      radii_of_.diagonal = own_diagonal;
      radii_of_.free = rest.free;
    }
  }

  SpectralRadii of_system;
  if (known) {
    const Eigen::Map<const Eigen::VectorX<T>> stiffness_of_body(fine_.stiffness.data(), 4 * rest.diagonal.rows());
    of_system = {.num_levels = static_cast<int>(coarse_.size()) + 1,
                 .num_solves = 1,
                 .factor = body.factor,
                 .diagonal = own_diagonal.sum(),
                 .stiffness = stiffness_of_body.template cast<double>().sum(),
                 .num_free = rest.free.template cast<std::int64_t>().sum()};
    if (known->is_valid_for(of_system)) {
      ++known->num_solves;
      are_radii_known_ = true;
      return for_each_radius([&](double& radius, std::size_t level) { radius = known->of_level[level]; });
    }
  }
  if (!are_of_this || are_radii_known_) {
    place(own_diagonal, rest.free, {});
    fine_.radius = kSafety * spectral_radius(fine_, kMinLanczosSteps);
    // where elements stand out, coarse ones may, which the first steps pass by; steps on coarse meshes cost little
    const int min_steps = fine_.radius > kSafety * kIrregular ? kMaxLanczosSteps : kMinLanczosSteps;
    for (MultigridLevel<float>& level : coarse_) level.radius = kSafety * spectral_radius(level, min_steps);
    are_radii_known_ = false;
  }
  if (!known || of_system.num_levels > SpectralRadii::kMaxLevels) return;
  for_each_radius([&](double radius, std::size_t level) { of_system.of_level[level] = radius; });
  *known = of_system;
}

template <class T>
bool Multigrid<T>::forgets_known_radii() {
  if (are_radii_known_) radii_of_.revision = 0;
  return are_radii_known_;
}

template <class T>
void Multigrid<T>::place(const PointArray& diagonal, const NodeMask& free, std::span<const NodeBlock> blocks) {
  const Partition& partition = fine_.op->partition();
  fine_.resize();
  to_slots(partition, diagonal, fine_.diagonal);
  fine_.has_diagonal = !diagonal.isZero(0);
  invert_sum(partition, fine_.stiffness, fine_.diagonal, fine_.inverse);
  const auto is_fixed = [&](int slot, int axis) { return free(partition.node_of_slot[slot], axis) == 0; };
  fine_.fixed.find(partition, is_fixed);
  fine_.blocks.clear();
  fine_.blocks.setup(partition, blocks, fine_.inverse);

  const auto descend = [&](auto& finer, const auto& finer_is_fixed, int k) {
    MultigridLevel<float>& level = coarse_[k];
    const CoarseMesh& mesh = *operators_[k].mesh;
    level.resize();
    level.x.resize(level.d.size(), 0.0f);
    const Partition& cells = level.op->partition();
    // a corner beyond the mesh is fixed where a node that hangs on it alone is; the others where their own node is
    level.fixed.find(cells, [&](int slot, int axis) {
      return mesh.finer_slot[slot] >= 0 && finer_is_fixed(mesh.finer_slot[slot], axis);
    });
    // the diagonal part goes down lumped; a fixed node between coarse ones ties them by its fraction of the stiffness
    parallel_for(cells.num_nodes, [&](int slot) {
      for (int axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (int n = mesh.restriction.first[slot]; n < mesh.restriction.first[slot + 1]; ++n) {
          const int fine = mesh.restriction.column[n];
          const double weight = static_cast<double>(mesh.restriction.weight[n]);
          const std::size_t at = 4 * static_cast<std::size_t>(fine) + axis;
          if (finer_is_fixed(fine, axis))
            sum += finer.inverse[at] > 0 ? weight * weight / static_cast<double>(finer.inverse[at]) : 0;
          else
            sum += weight * static_cast<double>(finer.diagonal[at]);
        }
        level.diagonal[4 * static_cast<std::size_t>(slot) + axis] = static_cast<float>(sum);
      }
    });
    level.has_diagonal = std::ranges::any_of(level.diagonal, [](float entry) { return entry != 0; });
    invert_sum(cells, level.stiffness, level.diagonal, level.inverse);
    level.is_fixed.assign(4 * static_cast<std::size_t>(cells.num_nodes), 0);
    for (const std::size_t number : level.fixed.number) level.is_fixed[number] = 1;
    level.blocks.clear();
    restrict_blocks(finer, mesh, level);
    level.blocks.complete(cells, level.inverse);
  };
  for (std::size_t k = 0; k < coarse_.size(); ++k) {
    if (k == 0) {
      descend(fine_, is_fixed, 0);
    } else {
      const std::vector<unsigned char>& mask = coarse_[k - 1].is_fixed;
      descend(
          coarse_[k - 1], [&](int slot, int axis) { return mask[4 * static_cast<std::size_t>(slot) + axis] != 0; },
          static_cast<int>(k));
    }
  }
}

/// x and r = b - A x after `degree` more Chebyshev steps; r is left as it was before the last of them unless asked for.
template <class T>
template <class U>
void Multigrid<T>::smooth(MultigridLevel<U>& level, int degree, double min_fraction, bool leaves_residual) {
  const Partition& partition = level.op->partition();
  const double theta = level.radius * (1 + min_fraction) / 2, delta = level.radius * (1 - min_fraction) / 2;
  const double sigma = theta / delta;
  double rho = 1 / sigma;
  for (int step = 0; step < degree; ++step) {
    double a = 0, b = 1 / theta;
    if (step > 0) {
      subtract_product(level);
      const double next = 1 / (2 * sigma - rho);
      a = next * rho;
      b = 2 * next / delta;
      rho = next;
    }
    parallel_for(partition.num_chunks, [&](int chunk) {
      const auto [first, size] = OwnedRange(partition, chunk);
      hexaplast::smooth(size, static_cast<U>(a), static_cast<U>(b), level.inverse.data() + first,
                        level.r.data() + first, level.d.data() + first, level.x.data() + first);
      if (level.blocks.empty()) return;
      level.blocks.add_inverse_product(chunk, static_cast<U>(b), level.r, level.d);
      level.blocks.add_inverse_product(chunk, static_cast<U>(b), level.r, level.x);
    });
  }
  if (leaves_residual) subtract_product(level);
}

template <class T>
template <class Finer>
void Multigrid<T>::restrict_to(MultigridLevel<Finer>& finer, int coarse) {
  MultigridLevel<float>& level = coarse_[coarse];
  if (!finer.blocks.empty())  // into d, which prolong_from overwrites
    parallel_for(finer.op->partition().num_chunks,
                 [&](int chunk) { finer.blocks.follow_transposed(chunk, finer.r, finer.d); });
  const NodalMap& map = operators_[coarse].mesh->restriction;
  const Partition& partition = level.op->partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    map_nodes(map, partition, chunk, finer.r, level.r);
    level.fixed.clear(chunk, level.r);
    const auto [first, size] = OwnedRange(partition, chunk);
    std::fill_n(level.x.begin() + static_cast<std::ptrdiff_t>(first), size, 0.0f);
  });
  if (!finer.blocks.empty())
    parallel_for(finer.op->partition().num_chunks, [&](int chunk) { finer.blocks.copy(chunk, finer.d, finer.r); });
}

/// d = P x of the coarse mesh, x += d, r -= A d.
template <class T>
template <class Finer>
void Multigrid<T>::prolong_from(int coarse, MultigridLevel<Finer>& finer) {
  const MultigridLevel<float>& level = coarse_[coarse];
  const NodalMap& map = operators_[coarse].mesh->prolongation;
  const Partition& partition = finer.op->partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    map_nodes(map, partition, chunk, level.x, finer.d);
    if (!finer.blocks.empty()) finer.blocks.follow(chunk, finer.d);
    finer.fixed.clear(chunk, finer.d);
    const auto [first, size] = OwnedRange(partition, chunk);
    for (std::size_t i = first; i < first + size; ++i) finer.x[i] += finer.d[i];
  });
  subtract_product(finer);
}

template <class T>
void Multigrid<T>::cycle(int coarse) {
  MultigridLevel<float>& level = coarse_[coarse];
  if (coarse + 1 == static_cast<int>(coarse_.size())) {
    smooth(level, kCoarsestDegree, kCoarsestFraction, false);
    return;
  }
  smooth(level, kSmoothing, kSmoothedFraction, true);
  restrict_to(level, coarse + 1);
  cycle(coarse + 1);
  prolong_from(coarse + 1, level);
  smooth(level, kSmoothing, kSmoothedFraction, false);
}

template <class T>
void Multigrid<T>::apply(const AlignedVector<T>& r, AlignedVector<T>& z) {
  parallel_for(fine_.op->partition().num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(fine_.op->partition(), chunk);
    std::copy_n(r.data() + first, size, fine_.r.data() + first);
    std::fill_n(z.data() + first, size, T(0));
  });
  fine_.x.swap(z);
  if (coarse_.empty()) {
    smooth(fine_, kCoarsestDegree, kCoarsestFraction, false);
  } else {
    smooth(fine_, kSmoothing, kSmoothedFraction, true);
    restrict_to(fine_, 0);
    cycle(0);
    prolong_from(0, fine_);
    smooth(fine_, kSmoothing, kSmoothedFraction, false);
  }
  fine_.x.swap(z);
  if (!fine_.blocks.empty())
    parallel_for(fine_.op->partition().num_chunks, [&](int chunk) { fine_.blocks.add_rigid_product(chunk, r, z); });
}

template class Multigrid<double>;
template class Multigrid<float>;

}  // namespace hexaplast
