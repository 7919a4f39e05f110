// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/operators.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "elastic/exact_product.hpp"
#include "elastic/linearize_pass.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

namespace {

/// Calls visit(node, slot) for every node, in parallel.
template <class Visit>
void for_each_node(const Partition& partition, const Visit& visit) {
  parallel_for(partition.num_chunks, [&](int chunk) {
    for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot)
      visit(partition.node_of_slot[slot], slot);
  });
}

/// Row by row, nodal += factor * slots.
template <class T>
void add_slots(const Partition& partition, double factor, const AlignedVector<T>& slots, Points nodal) {
  for_each_node(partition, [&](int node, int slot) {
    for (int i = 0; i < 3; ++i) nodal(node, i) += factor * slots[4 * static_cast<std::size_t>(slot) + i];
  });
}

/// A bit per element of a block that is there and alive.
std::uint16_t present(const Partition& partition, const History& history, int block) {
  std::uint32_t bits = 0;
  for (int place = 0; place < kBlock; ++place) {
    const int e = partition.element(block, place);
    if (e >= 0 && history.alive[e]) bits |= 1u << place;
  }
  return static_cast<std::uint16_t>(bits);
}

/// G per element; null where nothing in a block has flowed by isolated rest shapes.
const CornerTensors* flowed_at(const Partition& partition, const History& history, int block) {
  if (history.has_flowed.empty()) return nullptr;
  for (int place = 0; place < kBlock; ++place)
    if (const int e = partition.element(block, place); e >= 0 && history.has_flowed[e])
      return history.plastic_inverse.data();
  return nullptr;
}

/// What a block of the history has to say to the next linearization.
void take_history(const Model& model, const History& history, int block, Linearization& at) {
  const Partition& partition = *model.partition;
  if (!at.has_flowed.empty()) at.has_flowed[block] = flowed_at(partition, history, block) != nullptr;
  double& least = at.least_yield[block];
  least = std::numeric_limits<double>::infinity();
  for (int place = 0; place < kBlock; ++place)
    if (const int e = partition.element(block, place); e >= 0 && model.material(e).flow_rate > 0)
      least = std::min(least, std::ranges::min(history.yield_stress[e]));
}

template <class T, class Coef>
void add_product(const ElementOperator<T, Coef>& op, double factor, ConstPoints dx, AlignedVector<T>& argument,
                 AlignedVector<T>& product, Points df) {
  const Partition& partition = op.partition();
  argument.resize(4 * static_cast<std::size_t>(partition.num_slots), T(0));
  product.resize(argument.size(), T(0));
  std::fill(argument.end() - 4 * kCorners, argument.end(), T(0));  // of elements that are not there
  to_slots(partition, dx, argument);
  std::fill(product.begin(), product.end(), T(0));
  parallel_for(partition.num_chunks, [&](int chunk) { op.add_product(chunk, T(1), argument.data(), product.data()); });
  parallel_for(partition.num_chunks, [&](int chunk) { reduce_ghosts(partition, chunk, product.data()); });
  add_slots(partition, -factor, product, df);
}

/// Calls visit(EvaluatedBlock) for all blocks at x, in parallel.
template <class Visit>
void for_each_block_at(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps,
                       SlotScratch& slots, const Visit& visit) {
  const Partition& partition = *model.partition;
  slots.resize(partition);
  to_slots(partition, history.plastic_rest_positions, slots.first);
  to_slots(partition, x, slots.second);
  const Branches branches = history.branches(steps);
  parallel_for(partition.num_blocks, [&](int block) {
    visit(EvaluatedBlock{.model = model,
                         .plastic_inverse = flowed_at(partition, history, block),
                         .branches = branches,
                         .plastic_rest = slots.first.data(),
                         .current = slots.second.data(),
                         .present = present(partition, history, block),
                         .block = block});
  });
}

}  // namespace

void update_material(const Model& model, const History& history, Linearization& at) {
  if (at.plastic_rest_version == history.version) return;
  const Partition& partition = *model.partition;
  to_slots(partition, history.plastic_rest_positions, at.plastic_rest);
  for (int block = 0; block < partition.num_blocks; ++block) at.present[block] = present(partition, history, block);
  // an initial shape that is off by rounding is a box; what plastic flow made is taken as it is
  const double alike = history.plastic_rest_positions == model.mesh.positions() ? 1e-12 : 1e-15;
  parallel_for(partition.num_chunks, [&](int chunk) {
    find_general_blocks(partition, at.plastic_rest.data(), at.present.data(), alike, chunk, at.is_general.data());
  });
  std::visit(
      [&](auto& op) {
        op.kind = {.sampling = sampling_of(model.settings), .law = model.settings.law};
        op.resize(at.is_general);
      },
      at.op);
  for (int block = 0; block < partition.num_blocks; ++block) take_history(model, history, block, at);
  at.plastic_rest_version = history.version;
  at.forget();
}

void take_flow(const Model& model, const History& history, std::span<const unsigned char> blocks, Linearization& at) {
  const Partition& partition = *model.partition;
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk)
    for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
      if (!blocks[block]) continue;
      take_history(model, history, block, at);
      at.is_stale[chunk] = 1;
      at.is_current = false;
    }
  at.plastic_rest_version = history.version;
}

void set_positions(const Model& model, ConstPoints x, Linearization& at) {
  if (at.x.rows() == x.rows() && at.x == x) return;
  at.forget();
  at.x = x;
  to_slots(*model.partition, x, at.current);
}

//   f_a = - sum_i V/8 P_i g~_ia,   P = R sigma(S)                                                             eq. 15
void linearize(const Model& model, const History& history, ConstPoints x, Linearization& at, bool screens,
               std::span<const BranchStep> steps) {
  update_material(model, history, at);
  set_positions(model, x, at);
  if (screens && !at.is_screened) at.forget();
  if (at.is_current) return;
  ++at.revision;
  const Partition& partition = *model.partition;
  const Branches branches = history.branches(steps);
  const auto clear = [&](const std::vector<int>& first, int chunk) {
    std::fill(at.of_chunks.begin() + 4 * static_cast<std::ptrdiff_t>(first[chunk]),
              at.of_chunks.begin() + 4 * static_cast<std::ptrdiff_t>(first[chunk + 1]), 0.0);
  };
  const double thin_from = Recovery::from(model.settings);
  std::visit([&](auto& op) { op.kind.branches = {.sum = branches.moduli(), .in_step = branches.modulus()}; }, at.op);
  const LinearizePass pass{.model = model,
                           .history = history,
                           .branches = branches,
                           .screens = screens && model.can_flow(),
                           .thin_from = thin_from,
                           .safe_strain = 1 - std::cbrt(std::max(thin_from, 0.0)),
                           .at = at};
  parallel_for(partition.num_chunks, [&](int chunk) {
    if (!at.is_stale[chunk]) return;
    clear(partition.first_node, chunk);
    clear(partition.first_ghost, chunk);
    linearize_elements(pass, chunk);
  });
  std::ranges::fill(at.is_stale, 0);
  std::ranges::copy(at.of_chunks, at.force.begin());
  parallel_for(partition.num_chunks, [&](int chunk) { reduce_ghosts(partition, chunk, at.force.data()); });
  at.recovery.find(model, history, at.thin, at.x);
  at.is_current = true;
  at.is_screened = screens;
}

void add_force(const Model& model, const Linearization& at, Points f) {
  add_slots(*model.partition, 1, at.force, f);
  at.recovery.add_force(f);
}

void add_stiffness_product(const Model&, const Linearization& at, double factor, ConstPoints dx, SlotScratch& slots,
                           ProductWorkspace& work, Points df) {
  std::visit(
      [&]<class T, class Coef>(const ElementOperator<T, Coef>& op) {
        if constexpr (std::is_same_v<T, double>)
          add_product(op, factor, dx, slots.first, slots.second, df);
        else
          add_product(op, factor, dx, work.argument, work.product, df);
      },
      at.op);
  at.recovery.add_product(-factor, dx, df);
}

void add_stiffness_blocks(const Model& model, const History& history, const Linearization& at, double factor,
                          BlockMatrix& K) {
  const Partition& partition = *model.partition;
  std::array<ElementMatrix, kBlock> matrices;
  for (int block = 0; block < partition.num_blocks; ++block) {
    element_matrices(model, history, at, block, -factor, matrices.data());
    for (int place = 0; place < kBlock; ++place) {
      const int e = partition.element(block, place);
      if (e < 0) continue;
      // those that are gone add zeros: the pattern, and with it the order in which a direct solver eliminates, is that
      // of the mesh
      const Hexahedron& corners = model.mesh.hexahedra()[e];
      for (int a = 0; a < kCorners; ++a)
        for (int b = 0; b < kCorners; ++b) K.add(corners[a], corners[b], matrices[place].block<3, 3>(3 * a, 3 * b));
    }
  }
  at.recovery.add_blocks(-factor, K);
}

double energy(const Model& model, const History& history, ConstPoints x, SlotScratch& slots, ProductWorkspace& work,
              std::span<const BranchStep> steps) {
  if (work.version == history.version && work.x == x) return work.sum;
  work.energy.resize(model.partition->num_blocks);
  work.thin.resize(model.partition->num_blocks);
  for_each_block_at(model, history, x, steps, slots,
                    [&](const EvaluatedBlock& at) { work.energy[at.block] = block_energy(at, &work.thin[at.block]); });
  work.recovery.find(model, history, work.thin, x);
  work.sum = std::accumulate(work.energy.begin(), work.energy.end(), 0.0) + work.recovery.energy();
  work.x = x;
  work.version = history.version;
  return work.sum;
}

void find_fields(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps,
                 SlotScratch& slots, const EvaluatedFields& fields) {
  const bool yields = !history.plastic_inverse.empty();
  for_each_block_at(model, history, x, steps, slots,
                    [&](const EvaluatedBlock& at) { block_fields(at, yields, fields); });
}

}  // namespace hexaplast
