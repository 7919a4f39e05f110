// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "hexaplast/layout/linear_system.hpp"
#include "layout/chunked_operator.hpp"
#include "layout/partition.hpp"
#include "solve/body_residuals.hpp"
#include "solve/constants.hpp"
#include "solve/node_blocks.hpp"

namespace hexaplast {

/// The vectors of conjugate gradients and what is done to them; the methods decide on numbers alone.
class CgSpace {
 public:
  virtual ~CgSpace() = default;

  /// x = start, or 0 when null; r = b - A x. Returns r.r.
  virtual double begin(ConstPoints b, const ConstPoints* start) = 0;

  /// z, the preconditioned r. Returns r.z.
  virtual double precondition() = 0;

  /// p = z + beta p (beta 0: p = z); Ap = A p. Returns p.Ap.
  virtual double product(double beta) = 0;

  /// x += alpha p, r -= alpha Ap. Returns r.r.
  virtual double advance(double alpha) = 0;

  /// |r|, or more where the residual of one body of several is large beside what acts on it (BodyResiduals).
  virtual double size(double r_r) { return std::sqrt(r_r); }

  virtual void end(Points x) const = 0;

  virtual void residual(Points r) const = 0;

  /// Whether z is a diagonal's or a cycle's approximation of A^-1 r, rather than r or whatever a system makes of it.
  virtual bool is_preconditioned() const = 0;

  /// p.Ap that is not told from 0, relative to p.Mp times the largest eigenvalue of M^-1 A, M being the
  /// preconditioner. Of rigid motions rounding leaves the square of its own size: 1e-32 and 1e-14. The softest
  /// directions of a sound body have 1e-8 in a bar of 200 hexahedra, and more iterations are needed than anybody waits
  /// for where it is less.
  virtual double rounding() const = 0;

  /// What rounding may have left in b - A x beyond r: a rounding unit of |D x|, D being the diagonal of A. Stiff bodies
  /// that nothing holds have |A x| far below it.
  virtual double rounding_of_residual() = 0;

  /// |b - A x| for the x of the latest `end`, r its scratch: the terms beside the body in double precision, the body as
  /// its products are.
  virtual double residual_beside_others(const MatrixFreeSystem& system, ConstPoints b, ConstPoints x, PointArray& r) {
    static_cast<void>(system), static_cast<void>(b), static_cast<void>(x), static_cast<void>(r);
    return std::numeric_limits<double>::infinity();
  }
};

/// What every KernelBody::device is: L on a device, where the vectors of conjugate gradients are too.
class DeviceVectors : public DeviceOperator {
 public:
  virtual int num_nodes() const = 0;

  /// Ap += factor L p, in the precision of the device; void is then what its vectors have.
  virtual void multiply(double factor, ConstPoints p, Points Ap) const = 0;

  /// Those of a system of this body and other terms. of_preconditioner: its part that is not of L; null: there is none.
  virtual CgSpace& space(const MatrixFreeSystem& system, const NodalPart* of_preconditioner) = 0;

  /// Preconditions the latest space by cycles in place of its diagonal, if the mesh has any; and, unless always, if
  /// they cost less. radii: as of Multigrid::setup. Returns whether the radii were valid; nothing: by the diagonal.
  virtual std::optional<bool> use_cycles(bool always, SpectralRadii& radii) = 0;
  virtual bool has_coarse_meshes() const = 0;

  // Of one of several bodies, for their preconditioner.

  virtual void find_diagonal(double factor, Points diagonal) = 0;  ///< of factor L
  virtual void add_preconditioned(ConstPoints r, Points z) = 0;    ///< z += what the latest space makes of r
};

/// Null: the body is computed by the CPU.
inline DeviceVectors* device_of(const KernelBody& body) { return static_cast<DeviceVectors*>(body.device); }

/// A power of two that brings a number of this size near 1: to scale by it changes no bit, and keeps what is squared in
/// single precision away from its limits.
inline double scale_to_one(double size) {
  return size > 0 && std::isfinite(size) ? std::ldexp(1.0, -std::ilogb(size)) : 1;
}

/// z = an approximation of A^-1 r on nodal fields, symmetric and positive definite.
class NodalPreconditioner {
 public:
  virtual ~NodalPreconditioner() = default;
  virtual void apply(const PointArray& r, PointArray& z) = 0;
};

/// Any linear system, in double precision; without preconditioner, with its own, or with another one.
class NodalCgSpace final : public CgSpace {
 public:
  /// constraints: of A, if it has told them; otherwise null, and starts are to keep them. rounding: what `rounding`
  /// returns, which A's products decide. bodies: what `size` asks, or null.
  void setup(const LinearSystem& A, bool preconditioned, const Constraints* constraints = nullptr,
             NodalPreconditioner* preconditioner = nullptr, double rounding = kDoubleRounding,
             BodyResiduals* bodies = nullptr) {
    A_ = &A;
    constraints_ = constraints;
    bodies_ = bodies;
    rounding_ = rounding;
    preconditioned_ = preconditioned;
    preconditioner_ = preconditioner;
  }
  double begin(ConstPoints b, const ConstPoints* start) override;
  double precondition() override;
  double product(double beta) override;
  double advance(double alpha) override;
  double size(double r_r) override;
  void end(Points x) const override { x = x_ / scale_; }
  void residual(Points r) const override { r = r_ / scale_; }
  bool is_preconditioned() const override { return preconditioner_ != nullptr; }
  double rounding() const override { return rounding_; }
  double rounding_of_residual() override;

 private:
  double unscaled(double square) const { return square / scale_ / scale_; }

  const LinearSystem* A_ = nullptr;
  const Constraints* constraints_ = nullptr;
  double rounding_ = kDoubleRounding;
  double scale_ = 1;  // of all vectors, for the present b
  bool preconditioned_ = false;
  NodalPreconditioner* preconditioner_ = nullptr;
  BodyResiduals* bodies_ = nullptr;
  PointArray x_, r_, p_, Ap_, z_;
};

/// z = an approximation of A^-1 r on slots, symmetric and positive definite.
template <class T>
class SlotPreconditioner {
 public:
  virtual ~SlotPreconditioner() = default;
  virtual void apply(const AlignedVector<T>& r, AlignedVector<T>& z) = 0;

  /// |D x|, D being the diagonal of A, without nodes that have blocks of their own.
  virtual double diagonal_norm(const AlignedVector<T>& x) = 0;
};

/// The numbers of nodal vectors in slots that belong to degrees of freedom that do not move.
struct ConstrainedDofs {
  std::vector<std::size_t> number;
  std::vector<int> first;  ///< per chunk, and one more

  /// is_fixed(slot, axis)
  template <class Test>
  void find(const Partition& partition, const Test& is_fixed) {
    first.assign(1, 0);
    number.clear();
    for (int chunk = 0; chunk < partition.num_chunks; ++chunk) {
      for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot)
        for (int axis = 0; axis < 3; ++axis)
          if (is_fixed(slot, axis)) number.push_back(4 * static_cast<std::size_t>(slot) + axis);
      first.push_back(static_cast<int>(number.size()));
    }
  }
  template <class T>
  void clear(int chunk, AlignedVector<T>& slots) const {
    for (int k = first[chunk]; k < first[chunk + 1]; ++k) slots[number[k]] = T(0);
  }
};

/// The numbers that a chunk owns.
struct OwnedRange {
  OwnedRange(const Partition& partition, int chunk)
      : first(4 * static_cast<std::size_t>(partition.first_node[chunk])),
        size(4 * static_cast<std::size_t>(partition.first_node[chunk + 1]) - first) {}
  std::size_t first, size;
};

/// Ap += factor L p for all chunks; what the chunks gathered for one another is still in their ghosts.
template <class T>
void multiply(const ChunkedProduct<T>& op, T factor, AlignedVector<T>& p, AlignedVector<T>& Ap);

/// inverse = 1 / (factor stiffness + diagonal) at the nodes, 0 where that is not positive. `inverse` may be
/// `stiffness`.
template <class T>
void invert_sum(const Partition& partition, T factor, std::span<const T> stiffness, const AlignedVector<T>& diagonal,
                AlignedVector<T>& inverse);

/// The same with a stiffness of factor diag(L).
template <class T>
void invert_diagonal(const ChunkedOperator<T>& op, T factor, const AlignedVector<T>& diagonal,
                     AlignedVector<T>& inverse);

/// |x / inverse|, without the numbers where that is 0. partial: scratch, a number per chunk.
template <class T>
double norm_over(const Partition& partition, const AlignedVector<T>& inverse, const AlignedVector<T>& x,
                 std::vector<double>& partial);

/// By the nodes' own part of a matrix, the diagonal of a body's operator included.
template <class T>
class BlockJacobi final : public SlotPreconditioner<T> {
 public:
  void setup(const ChunkedOperator<T>& op, T factor, const NodalPart& rest);
  void apply(const AlignedVector<T>& r, AlignedVector<T>& z) override;
  double diagonal_norm(const AlignedVector<T>& x) override { return norm_over(*partition_, inverse_, x, partial_); }

 private:
  const Partition* partition_ = nullptr;
  AlignedVector<T> diagonal_, inverse_;
  std::vector<double> partial_;
  SlotBlocks<T> blocks_;
};

/// A MatrixFreeSystem of one body in precision T. Where anything is in single precision, cycles included, b is scaled
/// to a length near 1.
template <class T>
class SlotCgSpace final : public CgSpace {
 public:
  /// Divides by the diagonal of A where `scaled`, or applies `preconditioner` where that is not null.
  void setup(const MatrixFreeSystem& system, bool scaled, SlotPreconditioner<T>* preconditioner = nullptr);
  double begin(ConstPoints b, const ConstPoints* start) override;
  double precondition() override;
  double product(double beta) override;
  double advance(double alpha) override;
  void end(Points x) const override;
  void residual(Points r) const override;
  bool is_preconditioned() const override { return scaled_ || preconditioner_; }
  double rounding() const override { return std::is_same_v<T, double> ? kDoubleRounding : kSingleRounding; }
  double rounding_of_residual() override;
  double residual_beside_others(const MatrixFreeSystem& system, ConstPoints b, ConstPoints x, PointArray& r) override;

 private:
  struct Partial {
    double r_r = 0, r_z = 0;
  };
  Partial sum() const;
  void add_others();
  double unscaled(double square) const { return square / scale_ / scale_; }

  const ChunkedOperator<T>* op_ = nullptr;
  std::span<const NodalTerm> others_;
  const Partition* partition_ = nullptr;
  T factor_ = 0;
  double scale_ = 1;  // of all vectors, for the present b
  bool scaled_ = false;
  SlotPreconditioner<T>* preconditioner_ = nullptr;
  AlignedVector<T> x_, r_, p_, Ap_, z_, diagonal_, inverse_;
  ConstrainedDofs fixed_;
  std::vector<Partial> partial_;  // per chunk
  std::vector<double> partial_norm_;
  PointArray field_, product_;  // num_nodes x 3, for the terms beside the body
};

/// r = b - A x of a MatrixFreeSystem, in double precision: by exact operators where products are in single, but for a
/// body on a device. x is
/// none of r and the system's scratch, b is not r. Returns |r|.
double exact_residual(const MatrixFreeSystem& system, ConstPoints b, ConstPoints x, PointArray& r);

}  // namespace hexaplast
