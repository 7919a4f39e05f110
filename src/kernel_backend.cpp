// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernel_backend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "elastic/linearize_pass.hpp"
#include "hexaplast/base/parallel.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"

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

}  // namespace

KernelBackend::KernelBackend(const Model& of, History& its_history, const std::vector<BranchStep>& its_branches)
    : Backend(of, its_history, its_branches), at(model) {
  make_flow();
}

void KernelBackend::make_flow() {
  flow_.reset();
  if (model.can_flow() || model.settings.num_branches() > 0) flow_.emplace(model, history);
}

void KernelBackend::forget() {
  at.forget();
  evaluated_.version = -1;
}

void KernelBackend::renew() {
  at = Linearization(model);
  make_flow();
  skips_screening = false;
  hierarchy_.reset();
  slots_ = {};
  argument_ = product_ = {};
  evaluated_ = {};
}

// ------------------------------------------------------------------------------------------------------- linearization

/// What a block of the history has to say to the next linearization.
void KernelBackend::take_history(int block) {
  const Partition& partition = *model.partition;
  if (!at.has_flowed.empty()) at.has_flowed[block] = flowed_at(partition, history, block) != nullptr;
  double& least = at.least_yield[block];
  least = std::numeric_limits<double>::infinity();
  for (int place = 0; place < kBlock; ++place)
    if (const int e = partition.element(block, place); e >= 0 && model.material(e).flow_rate > 0)
      least = std::min(least, std::ranges::min(history.yield_stress[e]));
}

/// Brings what `at` holds of the plastic rest shape up to date with the history.
void KernelBackend::update_material() {
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
  for (int block = 0; block < partition.num_blocks; ++block) take_history(block);
  at.plastic_rest_version = history.version;
  at.forget();
}

/// After a plastic step that has removed nothing, at the positions of `at`: of the plastic rest shape the rest stays.
void KernelBackend::take_flow() {
  const Partition& partition = *model.partition;
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk)
    for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
      if (!flow_->differs[block]) continue;
      take_history(block);
      at.is_stale[chunk] = 1;
      at.is_current = false;
    }
  at.plastic_rest_version = history.version;
}

/// All that the plastic step needs besides the plastic rest shape.
void KernelBackend::set_positions(ConstPoints x) {
  if (at.x.rows() == x.rows() && at.x == x) return;
  at.forget();
  at.x = x;
  to_slots(*model.partition, x, at.current);
}

//   f_a = - sum_i V/8 P_i g~_ia,   P = R sigma(S)                                                             eq. 15
void KernelBackend::linearize(ConstPoints x, bool screens) {
  update_material();
  set_positions(x);
  if (screens && !at.is_screened) at.forget();
  if (at.is_current) return;
  ++at.revision;
  const Partition& partition = *model.partition;
  const Branches of_elements = history.branches(branches);
  const auto clear = [&](const std::vector<int>& first, int chunk) {
    std::fill(at.of_chunks.begin() + 4 * static_cast<std::ptrdiff_t>(first[chunk]),
              at.of_chunks.begin() + 4 * static_cast<std::ptrdiff_t>(first[chunk + 1]), 0.0);
  };
  const double thin_from = Recovery::from(model.settings);
  std::visit([&](auto& op) { op.kind.branches = {.sum = of_elements.moduli(), .in_step = of_elements.modulus()}; },
             at.op);
  const LinearizePass pass{.model = model,
                           .history = history,
                           .branches = of_elements,
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

void KernelBackend::add_force(Points f) const {
  add_slots(*model.partition, 1, at.force, f);
  at.recovery.add_force(f);
}

void KernelBackend::add_product(double factor, ConstPoints dx, Points df) const {
  std::visit(
      [&]<class T, class Coef>(const ElementOperator<T, Coef>& op) {
        if constexpr (std::is_same_v<T, double>)
          hexaplast::add_product(op, factor, dx, slots_.first, slots_.second, df);
        else
          hexaplast::add_product(op, factor, dx, argument_, product_, df);
      },
      at.op);
  at.recovery.add_product(-factor, dx, df);
}

void KernelBackend::add_stiffness_blocks(double factor, BlockMatrix& K) const {
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

void KernelBackend::add_operator(double factor, MatrixFreeSystem& system) {
  if (at.recovery.acts()) system.others.emplace_back(&at.recovery, -factor);
  KernelBody& body = system.bodies.emplace_back();
  body.factor = -factor;  // L = - df/dx
  body.double_operator = std::get_if<ElementOperator<double, double>>(&at.op);
  if (const auto* half = std::get_if<ElementOperator<float, Half>>(&at.op)) body.single_operator = half;
  if (const auto* single = std::get_if<ElementOperator<float, float>>(&at.op)) body.single_operator = single;
  if (body.single_operator) {
    exact_.setup(model, history, at);
    body.exact_operator = &exact_;
  }
  body.scratch = &slots_;
  if (!system.wants_levels) return;
  if (!hierarchy_) hierarchy_.emplace(model);
  body.levels = hierarchy_->update(model, at);
}

// ----------------------------------------------------------------------------------------- any positions; plastic step

/// Calls visit(EvaluatedBlock) for all blocks at x, in parallel.
template <class Visit>
void KernelBackend::for_each_block_at(ConstPoints x, std::span<const BranchStep> steps, const Visit& visit) {
  const Partition& partition = *model.partition;
  slots_.resize(partition);
  to_slots(partition, history.plastic_rest_positions, slots_.first);
  to_slots(partition, x, slots_.second);
  const Branches of_elements = history.branches(steps);
  parallel_for(partition.num_blocks, [&](int block) {
    visit(EvaluatedBlock{.model = model,
                         .plastic_inverse = flowed_at(partition, history, block),
                         .branches = of_elements,
                         .plastic_rest = slots_.first.data(),
                         .current = slots_.second.data(),
                         .present = present(partition, history, block),
                         .block = block});
  });
}

double KernelBackend::energy(ConstPoints x) {
  Evaluated& e = evaluated_;
  if (e.version == history.version && e.x == x) return e.sum;
  e.energy.resize(model.partition->num_blocks);
  e.thin.resize(model.partition->num_blocks);
  for_each_block_at(x, branches, [&](const EvaluatedBlock& block) {
    e.energy[block.block] = block_energy(block, &e.thin[block.block]);
  });
  e.recovery.find(model, history, e.thin, x);
  e.sum = std::accumulate(e.energy.begin(), e.energy.end(), 0.0) + e.recovery.energy();
  e.x = x;
  e.version = history.version;
  return e.sum;
}

const Recovery& KernelBackend::find_recovery(ConstPoints x) {
  KernelBackend::energy(x);
  return evaluated_.recovery;
}

void KernelBackend::find_fields(ConstPoints x, const EvaluatedFields& fields) {
  const std::vector<BranchStep> now = branch_steps(model.settings, 0);
  const bool yields = !history.plastic_inverse.empty();
  for_each_block_at(x, now, [&](const EvaluatedBlock& block) { block_fields(block, yields, fields); });
}

FlowReport KernelBackend::flow(ConstPoints x, double dt) {
  if (branches.empty() && !(skips_screening && at.plastic_rest_version == history.version)) {
    linearize(x, true);
  } else {
    update_material();
    set_positions(x);
  }
  if (!flow_) return count_inverted(model, at);
  FlowReport report = hexaplast::flow(model, at, dt, history, *flow_, branches);
  if (report.yielded > 0 && report.removed == 0 && branches.empty()) take_flow();
  skips_screening = 2 * report.yielded > model.mesh.num_elements();
  if (tear()) report.torn = torn_faces(x);
  return report;
}

std::vector<int> KernelBackend::torn_faces(ConstPoints x) {
  if (flow_->tear->broken.empty()) return {};
  const std::vector<BranchStep> now = branch_steps(model.settings, 0);  // stress is that of the moment
  const auto forces = [&](int e) -> ElementPoints {
    if (!history.alive[e]) return ElementPoints::Zero();
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    return plain::Element(gather(history.plastic_rest_positions, corners), gather(x, corners), model.lame[e],
                          model.settings, history.plastic_inverse_of(e), history.branches(now).of(e))
        .force();
  };
  return flow_->tear->faces(model, history, x, now, std::ref(forces));
}

}  // namespace hexaplast
