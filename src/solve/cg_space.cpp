// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/cg_space.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hexaplast/base/parallel.hpp"
#include "solve/slot_kernels.hpp"

namespace hexaplast {

double NodalCgSpace::begin(ConstPoints b, const ConstPoints* start) {
  scale_ = rounding_ == kSingleRounding ? scale_to_one(std::sqrt(dot(b, b))) : 1;
  p_.setZero(b.rows(), 3);
  Ap_.resize(b.rows(), 3);
  if (start) {
    x_ = scale_ * *start;
    if (constraints_ && constraints_->free.rows() == x_.rows()) constraints_->project(x_);
    A_->apply(x_, Ap_);
    r_ = scale_ * b - Ap_;
  } else {
    x_.setZero(b.rows(), 3);
    r_ = scale_ * b;
  }
  return unscaled(dot(r_, r_));
}

double NodalCgSpace::precondition() {
  if (!preconditioned_) return unscaled(dot(r_, r_));
  z_.resize(r_.rows(), 3);
  if (preconditioner_)
    preconditioner_->apply(r_, z_);
  else
    A_->precondition(r_, z_);
  return unscaled(dot(r_, z_));
}

double NodalCgSpace::product(double beta) {
  p_ = (preconditioned_ ? z_ : r_) + beta * p_;
  A_->apply(p_, Ap_);
  return unscaled(dot(p_, Ap_));
}

double NodalCgSpace::advance(double alpha) {
  x_ += alpha * p_;
  r_ -= alpha * Ap_;
  return unscaled(dot(r_, r_));
}

double NodalCgSpace::size(double r_r) {
  const double norm = std::sqrt(r_r);
  return bodies_ ? std::max(norm, bodies_->size(r_, x_, 1 / scale_)) : norm;
}

// Several bodies, and constraints that couple coordinates, are rare: in single precision they are always looked at
// again.
double NodalCgSpace::rounding_of_residual() {
  return rounding_ == kSingleRounding ? std::numeric_limits<double>::infinity() : 0;
}

namespace {

/// field = factor slots, at the nodes.
template <class T>
void from_slots(const Partition& partition, double factor, const AlignedVector<T>& slots, Points field) {
  parallel_for(partition.num_chunks, [&](int chunk) {
    for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot)
      for (int i = 0; i < 3; ++i)
        field(partition.node_of_slot[slot], i) =
            factor * static_cast<double>(slots[4 * static_cast<std::size_t>(slot) + i]);
  });
}

}  // namespace

template <class T>
void multiply(const ChunkedProduct<T>& op, T factor, AlignedVector<T>& p, AlignedVector<T>& Ap) {
  const Partition& partition = op.partition();
  parallel_for(partition.num_chunks, [&](int chunk) {
    update_ghosts(partition, chunk, p.data());
    std::fill(Ap.begin() + 4 * static_cast<std::ptrdiff_t>(partition.first_ghost[chunk]),
              Ap.begin() + 4 * static_cast<std::ptrdiff_t>(partition.first_ghost[chunk + 1]), T(0));
    op.add_product(chunk, factor, p.data(), Ap.data());
  });
}

template <class T>
void invert_sum(const Partition& partition, T factor, std::span<const T> stiffness, const AlignedVector<T>& diagonal,
                AlignedVector<T>& inverse) {
  parallel_for(partition.num_chunks, [&](int chunk) {
    const OwnedRange own(partition, chunk);
    for (std::size_t i = own.first; i < own.first + own.size; ++i) {
      const T entry = factor * stiffness[i] + diagonal[i];
      inverse[i] = entry > T(0) ? T(1) / entry : T(0);
    }
  });
}

template <class T>
void invert_diagonal(const ChunkedOperator<T>& op, T factor, const AlignedVector<T>& diagonal,
                     AlignedVector<T>& inverse) {
  const Partition& partition = op.partition();
  find_diagonal(op, factor, inverse);
  invert_sum(partition, T(1), std::span<const T>(inverse), diagonal, inverse);
}

template <class T>
double norm_over(const Partition& partition, const AlignedVector<T>& inverse, const AlignedVector<T>& x,
                 std::vector<double>& partial) {
  partial.assign(static_cast<std::size_t>(partition.num_chunks), 0);
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    for (std::size_t i = first; i < first + size; ++i) {
      const double quotient = inverse[i] > T(0) ? static_cast<double>(x[i]) / static_cast<double>(inverse[i]) : 0;
      partial[chunk] += quotient * quotient;
    }
  });
  return std::sqrt(std::accumulate(partial.begin(), partial.end(), 0.0));
}

template <class T>
void BlockJacobi<T>::setup(const ChunkedOperator<T>& op, T factor, const NodalPart& rest) {
  partition_ = &op.partition();
  diagonal_.resize(4 * static_cast<std::size_t>(partition_->num_slots), T(0));
  inverse_.resize(diagonal_.size());
  to_slots(*partition_, rest.diagonal, diagonal_);
  invert_diagonal(op, factor, diagonal_, inverse_);
  blocks_.setup(*partition_, rest.blocks, inverse_);
}

template <class T>
void BlockJacobi<T>::apply(const AlignedVector<T>& r, AlignedVector<T>& z) {
  parallel_for(partition_->num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(*partition_, chunk);
    for (std::size_t i = first; i < first + size; ++i) z[i] = inverse_[i] * r[i];
    blocks_.add_inverse_product(chunk, T(1), r, z);
    blocks_.add_rigid_product(chunk, r, z);
  });
}

template <class T>
void SlotCgSpace<T>::setup(const MatrixFreeSystem& system, bool scaled, SlotPreconditioner<T>* preconditioner) {
  const KernelBody& body = system.bodies.front();
  op_ = body.op<T>();
  others_ = system.others;
  partition_ = &op_->partition();
  const Partition& partition = *partition_;
  factor_ = static_cast<T>(body.factor);
  preconditioner_ = preconditioner;
  scaled_ = scaled;
  const std::size_t size = 4 * static_cast<std::size_t>(partition.num_slots);
  for (AlignedVector<T>* vector : {&x_, &r_, &p_, &Ap_, &diagonal_}) vector->resize(size, T(0));
  partial_.resize(partition.num_chunks);
  to_slots(partition, system.diagonal, diagonal_);
  fixed_.find(partition,
              [&](int slot, int axis) { return system.constraints.free(partition.node_of_slot[slot], axis) == 0; });
  if (preconditioner) z_.resize(size, T(0));
  if (!scaled) return;
  inverse_.resize(size, T(0));
  invert_diagonal(*op_, factor_, diagonal_, inverse_);
}

template <class T>
double SlotCgSpace<T>::precondition() {
  if (!preconditioner_) return sum().r_z;
  preconditioner_->apply(r_, z_);
  parallel_for(partition_->num_chunks, [&](int chunk) {
    const OwnedRange own(*partition_, chunk);
    partial_[chunk].r_z = slot_dot(own.size, r_.data() + own.first, z_.data() + own.first);
  });
  return sum().r_z;
}

template <class T>
typename SlotCgSpace<T>::Partial SlotCgSpace<T>::sum() const {
  Partial all;
  for (const Partial& part : partial_) {
    all.r_r += part.r_r;
    all.r_z += part.r_z;
  }
  return {unscaled(all.r_r), unscaled(all.r_z)};
}

template <class T>
double SlotCgSpace<T>::begin(ConstPoints b, const ConstPoints* start) {
  const Partition& partition = *partition_;
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    for (AlignedVector<T>* vector :
         {&x_, &p_, &Ap_, &r_})  // the fourth number of a slot too, which to_slots leaves alone
      std::fill_n(vector->data() + first, size, T(0));
  });
  scale_ = std::is_same_v<T, float> || preconditioner_ ? scale_to_one(std::sqrt(dot(b, b))) : 1;
  to_slots(partition, b, r_, scale_);
  if (start) to_slots(partition, *start, p_, scale_);  // x as the first direction, of length 1
  parallel_for(partition.num_chunks, [&](int chunk) {
    fixed_.clear(chunk, r_);
    if (!start) return;
    fixed_.clear(chunk, p_);
    const auto [first, size] = OwnedRange(partition, chunk);
    for (std::size_t i = first; i < first + size; ++i) Ap_[i] = diagonal_[i] * p_[i];
  });
  if (start) {
    multiply(*op_, factor_, p_, Ap_);
    if (!others_.empty()) add_others();
    parallel_for(partition.num_chunks, [&](int chunk) {
      reduce_ghosts(partition, chunk, Ap_.data());
      fixed_.clear(chunk, Ap_);
    });
  }
  return advance(start ? 1 : 0);
}

template <class T>
double SlotCgSpace<T>::product(double beta) {
  const Partition& partition = *partition_;
  const AlignedVector<T>& z = preconditioner_ ? z_ : r_;
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    update_search_direction(size, static_cast<T>(beta), z.data() + first, scaled_ ? inverse_.data() + first : nullptr,
                            diagonal_.data() + first, p_.data() + first, Ap_.data() + first);
  });
  multiply(*op_, factor_, p_, Ap_);
  if (!others_.empty()) add_others();
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    reduce_ghosts(partition, chunk, Ap_.data());
    fixed_.clear(chunk, Ap_);
    partial_[chunk].r_r = slot_dot(size, p_.data() + first, Ap_.data() + first);
  });
  return sum().r_r;
}

template <class T>
double SlotCgSpace<T>::advance(double alpha) {
  const Partition& partition = *partition_;
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(partition, chunk);
    partial_[chunk].r_r = hexaplast::advance(size, static_cast<T>(alpha), p_.data() + first, Ap_.data() + first,
                                             scaled_ ? inverse_.data() + first : nullptr, x_.data() + first,
                                             r_.data() + first, partial_[chunk].r_z);
  });
  return sum().r_r;
}

/// Ap += F p.
template <class T>
void SlotCgSpace<T>::add_others() {
  field_.resize(partition_->num_nodes, 3);
  from_slots(*partition_, 1, p_, field_);
  product_.setZero(partition_->num_nodes, 3);
  for (const NodalTerm& other : others_) other.add_product(field_, product_);
  parallel_for(partition_->num_nodes, [&](int n) {
    T* to = Ap_.data() + 4 * static_cast<std::size_t>(partition_->slot_of_node[n]);
    for (int i = 0; i < 3; ++i) to[i] += static_cast<T>(product_(n, i));
  });
}

template <class T>
void SlotCgSpace<T>::end(Points x) const {
  from_slots(*partition_, 1 / scale_, x_, x);
}

template <class T>
void SlotCgSpace<T>::residual(Points r) const {
  from_slots(*partition_, 1 / scale_, r_, r);
}

template <class T>
double SlotCgSpace<T>::rounding_of_residual() {
  if (!is_preconditioned()) return 0;
  const double norm =
      preconditioner_ ? preconditioner_->diagonal_norm(x_) : norm_over(*partition_, inverse_, x_, partial_norm_);
  return 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon()) * norm / scale_;
}

namespace {

/// r, a product of bodies and other terms with x, becomes the residual on the free degrees of freedom. Returns |r|.
double finish_residual(const MatrixFreeSystem& system, ConstPoints b, ConstPoints x, PointArray& r) {
  parallel_for(static_cast<int>(b.rows()), [&](int n) {
    for (int i = 0; i < 3; ++i)
      r(n, i) = system.constraints.free(n, i) * (b(n, i) - system.diagonal(n, i) * x(n, i) - r(n, i));
  });
  return std::sqrt(dot(r, r));
}

}  // namespace

template <class T>
double SlotCgSpace<T>::residual_beside_others(const MatrixFreeSystem& system, ConstPoints b, ConstPoints x,
                                              PointArray& r) {
  r.setZero(b.rows(), 3);  // the product, first
  for (const NodalTerm& other : others_) other.add_product(x, r);
  to_slots(*partition_, x, p_, scale_);
  parallel_for(partition_->num_chunks, [&](int chunk) {
    const auto [first, size] = OwnedRange(*partition_, chunk);
    std::fill_n(Ap_.data() + first, size, T(0));
  });
  multiply(*op_, factor_, p_, Ap_);
  parallel_for(partition_->num_chunks, [&](int chunk) { reduce_ghosts(*partition_, chunk, Ap_.data()); });
  parallel_for(partition_->num_nodes, [&](int n) {
    const T* of_body = Ap_.data() + 4 * static_cast<std::size_t>(partition_->slot_of_node[n]);
    for (int i = 0; i < 3; ++i) r(n, i) += static_cast<double>(of_body[i]) / scale_;
  });
  return finish_residual(system, b, x, r);
}

double exact_residual(const MatrixFreeSystem& system, ConstPoints b, ConstPoints x, PointArray& r) {
  r.setZero(b.rows(), 3);  // the product, first
  for (const NodalTerm& other : system.others) other.add_product(x, r);
  for (const KernelBody& body : system.bodies) {
    if (const DeviceVectors* device = device_of(body)) {
      device->multiply(body.factor, x.middleRows(body.first_node, device->num_nodes()),
                       r.middleRows(body.first_node, device->num_nodes()));
      continue;
    }
    const ChunkedProduct<double>& op = body.exact_operator ? *body.exact_operator : *body.double_operator;
    const Partition& partition = op.partition();
    body.scratch->resize(partition);
    AlignedVector<double>&slots = body.scratch->first, &product = body.scratch->second;
    to_slots(partition, x.middleRows(body.first_node, partition.num_nodes), slots);
    std::fill(product.begin(), product.end(), 0.0);
    multiply(op, body.factor, slots, product);
    parallel_for(partition.num_chunks, [&](int chunk) { reduce_ghosts(partition, chunk, product.data()); });
    parallel_for(partition.num_nodes, [&](int n) {
      const double* from = product.data() + 4 * static_cast<std::size_t>(partition.slot_of_node[n]);
      for (int i = 0; i < 3; ++i) r(body.first_node + n, i) += from[i];
    });
  }
  const double norm = finish_residual(system, b, x, r);
  if (!system.constraints.projector) return norm;
  system.constraints.project(r);
  return std::sqrt(dot(r, r));
}

template void multiply(const ChunkedProduct<double>&, double, AlignedVector<double>&, AlignedVector<double>&);
template void multiply(const ChunkedProduct<float>&, float, AlignedVector<float>&, AlignedVector<float>&);
template void invert_sum(const Partition&, float, std::span<const float>, const AlignedVector<float>&,
                         AlignedVector<float>&);
template void invert_diagonal(const ChunkedOperator<double>&, double, const AlignedVector<double>&,
                              AlignedVector<double>&);
template void invert_diagonal(const ChunkedOperator<float>&, float, const AlignedVector<float>&, AlignedVector<float>&);
template double norm_over(const Partition&, const AlignedVector<double>&, const AlignedVector<double>&,
                          std::vector<double>&);
template double norm_over(const Partition&, const AlignedVector<float>&, const AlignedVector<float>&,
                          std::vector<double>&);
template class BlockJacobi<double>;
template class BlockJacobi<float>;
template class SlotCgSpace<double>;
template class SlotCgSpace<float>;

}  // namespace hexaplast
