// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

struct SlotScratch;
struct CoarseMesh;
template <class T>
class ChunkedProduct;
template <class T>
class ChunkedOperator;

/// What a multigrid cycle takes for the operator L of a body, on one of its meshes.
struct LevelOperator {
  const ChunkedOperator<float>* op = nullptr;
  std::span<const float> diagonal = {};  ///< of it, in its slots
  const CoarseMesh* mesh = nullptr;      ///< null on the finest mesh
};

/// Per node and axis, yes or no, and some rows of it.
using NodeMask = Eigen::Matrix<unsigned char, Eigen::Dynamic, 3, Eigen::RowMajor>;
using NodeMaskRows = Eigen::Ref<NodeMask, 0, Eigen::OuterStride<3>>;

/// A projection of nodal fields that ties degrees of freedom to each other.
class Projector {
 public:
  virtual ~Projector() = default;
  virtual void project(Points field) const = 0;
};

/// What constraints leave of a nodal field: P field.
struct Constraints {
  NodeMask free;                         ///< num_nodes x 3: 1 where free, 0 where fixed
  const Projector* projector = nullptr;  ///< what P does beside zeroing entries; null: nothing
  std::vector<std::array<int, 2>> ties;  ///< of the projector: a node of each of two states that it ties

  /// All is free, as before anything constrains it.
  void reset(int num_nodes) {
    free.setOnes(num_nodes, 3);
    projector = nullptr;
    ties.clear();
  }
  void project(Points field) const;
  /// Pins what is fixed (BlockMatrix::pin): no matrix has ties.
  void pin(BlockMatrix& A) const;
};

/// L on a device; what else solvers know of it, says DeviceVectors (solve/cg_space.hpp).
class DeviceOperator {
 public:
  virtual ~DeviceOperator() = default;
};

/// One body's part of a linear system: factor L, L applied chunk by chunk on slots.
struct KernelBody {
  const ChunkedOperator<double>* double_operator = nullptr;  ///< L in double precision, or null
  const ChunkedOperator<float>* single_operator = nullptr;   ///< L in single precision, or null
  const ChunkedProduct<double>* exact_operator = nullptr;    ///< beside single_operator: L in double, slower
  DeviceOperator* device = nullptr;                          ///< in place of all of them
  double factor = 0;                                         ///< of L
  int first_node = 0;                                        ///< of the system's: where the body's nodes begin
  SlotScratch* scratch = nullptr;  ///< of solvers, borrowed from the body; without it they do not check their residuals
  std::span<const LevelOperator> levels = {};  ///< of cycles, from fine to coarse; empty where the mesh has no lattice

  /// That of the two which works on numbers T.
  template <class T>
  const ChunkedOperator<T>* op() const {
    if constexpr (std::is_same_v<T, double>)
      return double_operator;
    else
      return single_operator;
  }
};

/// A symmetric operator F on nodal fields, of what the kernels do not know.
class NodalOperator {
 public:
  virtual ~NodalOperator() = default;

  /// Fp += factor F p. Allocates nothing when it was called before; the same bits for any number of threads.
  virtual void add_product(double factor, ConstPoints p, Points Fp) const = 0;

  /// Whether F gives its diagonal to preconditioners; they find out what else does to constant fields.
  virtual bool has_diagonal() const { return false; }
  /// diagonal += factor diag(F), num_nodes x 3.
  virtual void add_diagonal(double /*factor*/, Points /*diagonal*/) const {}

  /// A += factor F, as far as F has blocks; A is of the same nodes.
  virtual void add_blocks(double /*factor*/, BlockMatrix& /*A*/) const {}
};

/// factor F, of num_nodes nodes from `first_node` on; num_nodes -1: of all.
struct NodalTerm {
  explicit NodalTerm(const NodalOperator* of, double times = 1) : op(of), factor(times) {}

  const NodalOperator* op;
  double factor;
  int first_node = 0, num_nodes = -1;

  void add_product(ConstPoints p, Points Fp) const { op->add_product(factor, part(p), part(Fp)); }
  void add_diagonal(Points diagonal) const { op->add_diagonal(factor, part(diagonal)); }

 private:
  template <class Field>
  Field part(Field field) const {
    return Field(field.middleRows(first_node, num_nodes < 0 ? field.rows() : num_nodes));
  }
};

/// Nodes that follow one another.
struct NodeGroup {
  int first_node = 0, num_nodes = 0;

  auto rows(auto& of_all) const { return of_all.middleRows(first_node, num_nodes); }
};

/// Numbers in [0.5, 1.5) without any regularity, three per node: whatever acts on nodes leaves a trace of them.
PointArray irregular_numbers(int num_nodes);

/// A linear system in the form that the kernels solve: A = P (diagonal + sum of factor L over the bodies + F) P, P
/// being what the constraints leave.
struct MatrixFreeSystem {
  std::vector<KernelBody> bodies;
  std::vector<NodalTerm> others;  ///< whose sum is F; empty: nothing else acts
  PointArray diagonal;            ///< num_nodes x 3
  Constraints constraints;

  bool wants_levels = false;  ///< asks for KernelBody::levels as well

  PointArray scratch;            ///< first of the code that fills the system, then of its solver
  std::vector<NodeGroup> parts;  ///< of add_part: the bodies of each have its nodes only, not all

  /// Before it is filled anew; what it allocated stays.
  void clear() {
    bodies.clear();
    others.clear();
    parts.clear();
    constraints.free.setOnes();
    constraints.projector = nullptr;
    constraints.ties.clear();
  }
  /// A body that has all of the nodes, whatever else acts on them.
  bool has_one_body() const { return bodies.size() == 1 && parts.empty() && !constraints.projector; }
  bool is_one_body() const { return has_one_body() && others.empty(); }

  /// Takes in bodies, other operators and the diagonal of a system over the nodes from `first_node` on: an independent
  /// state of several, whose residual counts by itself.
  void add_part(const MatrixFreeSystem& part, int first_node) {
    const Eigen::Index num_nodes = part.diagonal.rows();
    parts.push_back({first_node, static_cast<int>(num_nodes)});
    diagonal.middleRows(first_node, num_nodes) += part.diagonal;
    for (KernelBody body : part.bodies) {
      body.first_node += first_node;
      bodies.push_back(body);
    }
    for (NodalTerm term : part.others) {
      term.first_node += first_node;
      if (term.num_nodes < 0) term.num_nodes = static_cast<int>(num_nodes);
      others.push_back(term);
    }
  }
};

/// A symmetric positive definite system A x = b over nodal fields, seen by its solvers.
class LinearSystem {
 public:
  virtual ~LinearSystem() = default;

  virtual int num_nodes() const = 0;

  /// Ap = A p. Rows of constrained degrees of freedom are zero.
  virtual void apply(ConstPoints p, Points Ap) const = 0;

  /// A += the same operator as blocks, constrained degrees of freedom pinned (BlockMatrix::pin). `A` is
  /// cleared before. The default throws InputError: solvers that factorise need it, those that iterate do not.
  virtual void assemble(BlockMatrix& A) const;

  /// z = an approximation of A^-1 r, symmetric and positive definite; the default is none (z = r).
  virtual void precondition(ConstPoints r, Points z) const { z = r; }

  /// Writes the system down for the kernels; false where it does not have that form. Input: `system`, cleared
  /// (MatrixFreeSystem::clear), with what else was in it: diagonal and constraints are to be set. Allocates nothing
  /// when it was filled before.
  virtual bool matrix_free(MatrixFreeSystem& /*system*/) const { return false; }

  /// Size of the rounding errors in b: a residual as small as this cannot be improved.
  virtual double rounding() const { return 0; }
};

/// Throws InputError unless b and x have a row per node of A.
void require_sizes(const LinearSystem& A, ConstPoints b, ConstPoints x);

/// What makes the iterations of a linear solver few.
enum class PreconditionedBy : int {
  kNothing,        ///< also where there was nothing to solve
  kDiagonal,       ///< Jacobi; blocks of nodes where terms couple their axes
  kMultigrid,      ///< a V-cycle for each body
  kFactorisation,  ///< of the matrix itself
};
inline constexpr std::array<std::string_view, 4> kPreconditionerNames = {"none", "diagonal", "multigrid",
                                                                         "factorisation"};
constexpr std::string_view name_of(PreconditionedBy preconditioner) {
  return kPreconditionerNames[static_cast<std::size_t>(preconditioner)];
}

struct SolveReport {
  int iterations = 0;   ///< 1 for a direct solver
  double residual = 0;  ///< |b - A x| / |b| as the solver knows it (0 for a direct solver); the largest of the bodies,
                        ///< where its tolerance holds for each (PreconditionedConjugateGradients)
  bool converged = true;      ///< false: stopped before the tolerance, by the iteration limit or because A is singular
  bool at_threshold = false;  ///< an absolute threshold ended it above its tolerance
  bool of_newton = false;     ///< `residual` and `converged` are those of Newton's iterations
  PreconditionedBy preconditioner = PreconditionedBy::kNothing;  ///< that was used

  /// A further solve of the same system, from its solution.
  void add(const SolveReport& again);
};

/// What multigrid has estimated of a system, valid for the next ones of a sequence, whose spectra are nearly the same.
struct SpectralRadii {
  static constexpr int kMaxLevels = 16;

  int num_levels = 0;                            ///< 0: nothing has been estimated
  std::array<double, kMaxLevels> of_level = {};  ///< of D^-1 A, from the finest mesh on
  int num_solves = 0;                            ///< that have used them; too many: they are valid no longer
  int iterations = 0;                            ///< of the first of these
  double factor = 0;                             ///< of the system: KernelBody::factor
  double diagonal = 0, stiffness = 0;            ///< of the system: sums of the diagonal, and of that of the body
  std::int64_t num_free = 0;                     ///< of the system: degrees of freedom

  /// Whether they are for another system, of which everything else is given, in place of an estimate.
  bool is_valid_for(const SpectralRadii& other) const;

  /// After a solve: where it took many more iterations than the first one, they are valid no longer.
  void update(int iterations_now);

  /// Whether an archive may hold them.
  bool is_valid() const;
  void serialize(Archive& archive) {
    archive(num_levels, of_level, num_solves, iterations, factor, diagonal, stiffness, num_free);
  }
};

/// What one solve of a sequence leaves for the next one: all of it that a result depends on, to the last bit. The
/// maker of the sequence owns it, as a time integrator does beside the motion, and saves it with the motion.
struct SolverMemory {
  bool is_first = true;              ///< nothing has been solved: SOFA's rules are relaxed then
  PointArray start;                  ///< the latest solution, to start from; without rows: there is none
  std::vector<SpectralRadii> radii;  ///< per body of the system; of another number of bodies they are not used

  void reset() { *this = {}; }

  /// Whether an archive may hold it.
  bool is_valid() const;
  void serialize(Archive& archive) { archive(is_first, start, radii); }
};

/// Solves A x = b; x may have any content before. What a solver keeps from one solve to the next is scratch, and
/// factors of a matrix that it compares: a result depends on A, b and the SolverMemory. Throws InputError where b or x
/// has another number of rows than A nodes, NumericalError when A is found not to be positive semi-definite.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) = 0;

  /// The next solve of a sequence. `memory` is as before where it throws.
  virtual SolveReport solve_next(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& /*memory*/) {
    return solve(A, b, x);
  }

  /// A further solve within the step of the latest solve_next, for an x that is near the solution already; the
  /// tolerance still refers to b. A memory in which nothing is costs the estimates of a first solve.
  virtual SolveReport solve_from_guess(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& /*memory*/) {
    return solve(A, b, x);
  }
};

}  // namespace hexaplast
