// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "layout/coarse_mesh.hpp"
#include "solve/slot_kernels.hpp"
#include "solve/spectrum.hpp"

namespace hexaplast {

namespace {

/// Ad = A d on the nodes, ghosts of d included; without blocks.
void apply(MultigridLevel& level) {
  const Partition& partition = level.partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    for (std::size_t i = first; i < first + size; ++i) level.Ad[i] = level.diagonal[i] * level.d[i];
  });
  multiply(*level.of.op, level.factor, level.d, level.Ad);
  parallel_for(partition.num_chunks, [&](int chunk) {
    reduce_ghosts(partition, chunk, level.Ad.data());
    level.fixed.clear(chunk, level.Ad);
  });
}

/// r -= (A - D) d.
void subtract_product(MultigridLevel& level) {
  const Partition& partition = level.partition();
  multiply(*level.of.op, -level.factor, level.d, level.r);
  parallel_for(partition.num_chunks, [&](int chunk) {
    reduce_ghosts(partition, chunk, level.r.data());
    if (!level.blocks.empty()) level.blocks.add_product(chunk, -1, level.d, level.r);
    level.fixed.clear(chunk, level.r);
  });
}

/// The nodes of a chunk from those of another mesh.
void map_nodes(const NodalMap& map, const Partition& partition, int chunk, const AlignedVector<float>& from,
               AlignedVector<float>& to) {
  for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot) {
    Eigen::Array4f sum = Eigen::Array4f::Zero();
    for (int k = map.first[slot]; k < map.first[slot + 1]; ++k)
      sum += map.weight[k] * numbers_at(from.data(), map.column[k]);
    numbers_at(to.data(), slot) = sum;
  }
}

/// sum a b over the nodes, added chunk by chunk
double dot(MultigridLevel& level, const AlignedVector<float>& a, const AlignedVector<float>& b) {
  const Partition& partition = level.partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    level.partial[chunk] = slot_dot(size, a.data() + first, b.data() + first);
  });
  return std::accumulate(level.partial.begin(), level.partial.end(), 0.0);
}

/// v lies in d, the vector before it in r, D v in x.
class LanczosOnLevel final : public LanczosSpace {
 public:
  explicit LanczosOnLevel(MultigridLevel& level) : level_(level) {
    for (AlignedVector<float>* vector : {&level.x, &level.Ad}) vector->resize(level.d.size(), 0.0f);
  }
  double start() override {
    std::fill(level_.d.begin(), level_.d.end(), 0.0f);
    std::fill(level_.r.begin(), level_.r.end(), 0.0f);
    IrregularNumbers number;
    for (std::size_t i = 0; i < 4 * static_cast<std::size_t>(level_.partition().num_nodes); ++i) {
      const float next = number();
      if (level_.inverse[i] > 0) level_.d[i] = next;
    }
    for (int chunk = 0; chunk < level_.partition().num_chunks; ++chunk) level_.fixed.clear(chunk, level_.d);
    return square();
  }
  double multiply(double scale) override {
    for_each_number([&](std::size_t i) { level_.d[i] *= static_cast<float>(scale); });
    apply(level_);
    return dot(level_, level_.d, level_.Ad);
  }
  double advance(double along, double before) override {
    const auto a = static_cast<float>(along), b = static_cast<float>(before);
    for_each_number(
        [&](std::size_t i) { level_.r[i] = level_.inverse[i] * level_.Ad[i] - a * level_.d[i] - b * level_.r[i]; });
    std::swap(level_.d, level_.r);
    return square();
  }

 private:
  template <class Visit>
  void for_each_number(const Visit& visit) {
    parallel_for(level_.partition().num_chunks, [&](int chunk) {
      const auto [first, size] = OwnedRange(level_.partition(), chunk);
      for (std::size_t i = first; i < first + size; ++i) visit(i);
    });
  }
  double square() {
    for_each_number(
        [&](std::size_t i) { level_.x[i] = level_.inverse[i] > 0 ? level_.d[i] / level_.inverse[i] : 0.0f; });
    return dot(level_, level_.d, level_.x);
  }

  MultigridLevel& level_;
};

}  // namespace

void MultigridLevel::resize() {
  const std::size_t size = 4 * static_cast<std::size_t>(partition().num_slots);
  for (AlignedVector<float>* vector : {&diagonal, &inverse, &x, &r, &d})
    if (vector->size() != size) vector->assign(size, 0.0f);
  partial.resize(partition().num_chunks);
}

// Terms beside the bodies do not raise the spectral radii: they add the same to A and to D. So these are found without
// them, and are valid for all solves of a step, however contacts come and go.
bool Multigrid::setup(const KernelBody& body, const NodalPart& rest, SpectralRadii& radii) {
  levels_.resize(body.levels.size());
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    levels_[k].of = body.levels[k];
    levels_[k].factor = static_cast<float>(body.factor);
    levels_[k].resize();
  }
  const bool are_known = find_radii(body, rest, radii);
  set_diagonals(rest.diagonal, rest.free, rest.blocks);
  return are_known;
}

// In as many steps as radii serve, those of a body that flows by a few hundredths per step change by less than kSafety
// allows for.
bool Multigrid::find_radii(const KernelBody& body, const NodalPart& rest, SpectralRadii& radii) {
  const PointArray& own_diagonal = rest.own_diagonal ? *rest.own_diagonal : rest.diagonal;
  const Eigen::Map<const Eigen::VectorXf> of_body(levels_.front().of.diagonal.data(), 4 * own_diagonal.rows());
  SpectralRadii of_system{.num_levels = static_cast<int>(levels_.size()),
                          .num_solves = 1,
                          .factor = body.factor,
                          .diagonal = own_diagonal.sum(),
                          .stiffness = body.factor * of_body.cast<double>().sum(),
                          .num_free = rest.free.cast<std::int64_t>().sum()};
  const bool are_known = radii.is_valid_for(of_system);
  if (are_known) {
    ++radii.num_solves;
    for (std::size_t k = 0; k < levels_.size(); ++k) levels_[k].radius = radii.of_level[k];
    return true;
  }
  set_diagonals(own_diagonal, rest.free, {});
  find_radii_of_meshes(
      of_system.num_levels, [&](int k) { return LanczosOnLevel(levels_[k]); },
      [&](int k, double radius) {
        levels_[k].radius = radius;
        if (k < SpectralRadii::kMaxLevels) of_system.of_level[k] = radius;
      });
  radii = levels_.size() > SpectralRadii::kMaxLevels ? SpectralRadii() : of_system;
  return false;
}

void Multigrid::set_diagonals(const PointArray& diagonal, const NodeMask& free, std::span<const NodeBlock> blocks) {
  MultigridLevel& fine = levels_.front();
  const Partition& partition = fine.partition();
  to_slots(partition, diagonal, fine.diagonal);
  invert_sum(partition, fine.factor, fine.of.diagonal, fine.diagonal, fine.inverse);
  fine.fixed.find(partition, [&](int slot, int axis) { return free(partition.node_of_slot[slot], axis) == 0; });
  fine.mark_fixed();
  fine.blocks.clear();
  fine.blocks.setup(partition, blocks, fine.inverse);
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    MultigridLevel& level = levels_[k];
    descend(levels_[k - 1], level);
    level.blocks.clear();
    restrict_blocks(levels_[k - 1], level);
    level.blocks.complete(level.partition(), level.inverse);
  }
}

void MultigridLevel::mark_fixed() {
  is_fixed.assign(4 * static_cast<std::size_t>(partition().num_nodes), 0);
  for (const std::size_t number : fixed.number) is_fixed[number] = 1;
}

/// The diagonal and what is fixed, of the next coarser mesh.
void Multigrid::descend(const MultigridLevel& finer, MultigridLevel& level) const {
  const CoarseMesh& mesh = *level.of.mesh;
  const Partition& partition = level.partition();
  // a corner beyond the mesh is fixed where a node that hangs on it alone is; the others where their own node is
  level.fixed.find(partition, [&](int slot, int axis) {
    const int there = mesh.finer_slot[slot];
    return there >= 0 && finer.is_fixed[4 * static_cast<std::size_t>(there) + axis];
  });
  level.mark_fixed();
  // the diagonal part goes down lumped; a fixed node between coarse ones ties them by its fraction of the stiffness
  parallel_for(partition.num_nodes, [&](int slot) {
    Eigen::Array4d sum = Eigen::Array4d::Zero();
    for (int n = mesh.restriction.first[slot]; n < mesh.restriction.first[slot + 1]; ++n) {
      const int from = mesh.restriction.column[n];
      const double weight = static_cast<double>(mesh.restriction.weight[n]);
      const Eigen::Array4d diagonal = numbers_at(finer.diagonal.data(), from).cast<double>();
      const auto is_fixed = numbers_at(finer.is_fixed.data(), from);
      if ((is_fixed == 0).all()) [[likely]] {
        sum += weight * diagonal;
        continue;
      }
      const Eigen::Array4d inverse = numbers_at(finer.inverse.data(), from).cast<double>();
      for (int axis = 0; axis < 3; ++axis) {
        if (is_fixed[axis])
          sum[axis] += inverse[axis] > 0 ? weight * weight / inverse[axis] : 0;
        else
          sum[axis] += weight * diagonal[axis];
      }
    }
    numbers_at(level.diagonal.data(), slot) = sum.cast<float>();
  });
  invert_sum(partition, level.factor, level.of.diagonal, level.diagonal, level.inverse);
}

/// Blocks are restricted lumped, as the diagonal is. A node between coarse ones follows these only as far as its block
/// lets it (SlotBlocks::prolong), and ties them by no more than its own stiffness, as a fixed one does.
void Multigrid::restrict_blocks(MultigridLevel& finer, MultigridLevel& level) {
  if (finer.blocks.empty()) return;
  const CoarseMesh& mesh = *level.of.mesh;
  block_of_slot_.assign(finer.partition().num_nodes, -1);
  const auto& entries = finer.blocks.entries();
  for (std::size_t k = 0; k < entries.size(); ++k) block_of_slot_[entries[k].slot] = static_cast<int>(k);
  for (int slot = 0; slot < level.partition().num_nodes; ++slot)
    if (const int there = mesh.finer_slot[slot]; there >= 0 && block_of_slot_[there] >= 0)
      finer.blocks.set_coarse(block_of_slot_[there]);
  for (int slot = 0; slot < level.partition().num_nodes; ++slot) {
    Mat3 sum = Mat3::Zero();
    for (int n = mesh.restriction.first[slot]; n < mesh.restriction.first[slot + 1]; ++n)
      if (const int k = block_of_slot_[mesh.restriction.column[n]]; k >= 0)
        sum += static_cast<double>(mesh.restriction.weight[n]) * entries[k].restricted;
    for (int axis = 0; axis < 3; ++axis)
      if (level.is_fixed[4 * static_cast<std::size_t>(slot) + axis]) {
        sum.row(axis).setZero();
        sum.col(axis).setZero();
      }
    if (!sum.isZero(0)) level.blocks.add(slot, sum);
  }
}

namespace {

/// x and r = b - A x after `degree` more Chebyshev steps; r is left as it was before the last of them unless asked for.
void smooth(MultigridLevel& level, int degree, double min_fraction, bool leaves_residual) {
  const Partition& partition = level.partition();
  int step = 0;
  for_each_chebyshev_step(level.radius, min_fraction, degree, [&](double a, double b) {
    if (step++ > 0) subtract_product(level);
    // blocks have a part in d: r -= D d waits for them
    const bool goes_on = leaves_residual || step < degree, has_blocks = !level.blocks.empty();
    parallel_for(partition.num_chunks, [&](int chunk) {
      const auto [first, size] = OwnedRange(partition, chunk);
      hexaplast::smooth(size, static_cast<float>(a), static_cast<float>(b), level.inverse.data() + first,
                        goes_on && !has_blocks ? level.diagonal.data() + first : nullptr, level.r.data() + first,
                        level.d.data() + first, level.x.data() + first);
      if (!has_blocks) return;
      level.blocks.add_inverse_product(chunk, static_cast<float>(b), level.r, level.d);
      level.blocks.add_inverse_product(chunk, static_cast<float>(b), level.r, level.x);
      for (std::size_t i = first; goes_on && i < first + size; ++i) level.r[i] -= level.diagonal[i] * level.d[i];
    });
  });
  if (leaves_residual) subtract_product(level);
}

/// r of the coarser mesh, where x = 0.
void restrict_residual(MultigridLevel& finer, MultigridLevel& level) {
  if (!finer.blocks.empty())  // into d, which prolong overwrites
    parallel_for(finer.partition().num_chunks,
                 [&](int chunk) { finer.blocks.restrict_residual(chunk, finer.r, finer.d); });
  const Partition& partition = level.partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    map_nodes(level.of.mesh->restriction, partition, chunk, finer.r, level.r);
    level.fixed.clear(chunk, level.r);
    const auto [first, size] = OwnedRange(partition, chunk);
    std::fill_n(level.x.begin() + static_cast<std::ptrdiff_t>(first), size, 0.0f);
  });
  if (!finer.blocks.empty())
    parallel_for(finer.partition().num_chunks, [&](int chunk) { finer.blocks.copy(chunk, finer.d, finer.r); });
}

/// d = P x of the coarser mesh, x += d, r -= A d.
void prolong(const MultigridLevel& level, MultigridLevel& finer) {
  const Partition& partition = finer.partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    map_nodes(level.of.mesh->prolongation, partition, chunk, level.x, finer.d);
    if (!finer.blocks.empty()) finer.blocks.prolong(chunk, finer.d);
    finer.fixed.clear(chunk, finer.d);
    const auto [first, size] = OwnedRange(partition, chunk);
    for (std::size_t i = first; i < first + size; ++i) {
      finer.x[i] += finer.d[i];
      finer.r[i] -= finer.diagonal[i] * finer.d[i];
    }
  });
  subtract_product(finer);
}

}  // namespace

void Multigrid::cycle(std::size_t k) {
  MultigridLevel& level = levels_[k];
  if (k + 1 == levels_.size()) return smooth(level, kCoarsestDegree, kCoarsestFraction, false);
  smooth(level, kSmoothing, kSmoothedFraction, true);
  restrict_residual(level, levels_[k + 1]);
  cycle(k + 1);
  prolong(levels_[k + 1], level);
  smooth(level, kSmoothing, kSmoothedFraction, false);
}

void Multigrid::apply(const AlignedVector<float>& r, AlignedVector<float>& z) {
  MultigridLevel& fine = levels_.front();
  const Partition& partition = fine.partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    std::copy_n(r.data() + first, size, fine.r.data() + first);
    std::fill_n(z.data() + first, size, 0.0f);
  });
  fine.x.swap(z);
  cycle(0);
  fine.x.swap(z);
  if (!fine.blocks.empty())
    parallel_for(partition.num_chunks, [&](int chunk) { fine.blocks.add_rigid_product(chunk, r, z); });
}

}  // namespace hexaplast
