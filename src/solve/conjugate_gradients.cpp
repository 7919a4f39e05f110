// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/conjugate_gradients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/irregular_field.hpp"
#include "hexaplast/base/parallel.hpp"
#include "solve/multigrid.hpp"
#include "solve/several_bodies.hpp"

namespace hexaplast {

struct ConjugateGradients::Spaces {
  KernelSystem system;
  NodalCgSpace nodal;
  SlotCgSpace<double> in_double;
  SlotCgSpace<float> in_single;

  CgSpace& choose(const LinearSystem& A) {
    system.clear();
    if (A.to_kernels(system) && system.is_one_body()) {
      if (system.bodies.front().double_operator) {
        in_double.refer_to(system, false);
        return in_double;
      }
      in_single.refer_to(system, false);
      return in_single;
    }
    nodal.refer_to(A, false);
    return nodal;
  }
};

namespace {

/// b.b; throws NumericalError where it is beyond all numbers, as products of directions would be.
double finite_square(ConstPoints b) {
  const double square = hexaplast::dot(b, b);
  if (!std::isfinite(square))
    throw NumericalError("conjugate gradients: the right-hand side or its square is not finite");
  return square;
}

/// p.Ap and r.z of finite vectors; throws NumericalError where the matrix, or its preconditioner, makes none of them.
void require_finite(double p_Ap, double r_z) {
  if (!std::isfinite(p_Ap) || !std::isfinite(r_z))
    throw NumericalError(fmt::format(
        "conjugate gradients: the matrix or its preconditioner is not finite (p.Ap = {}, r.z = {})", p_Ap, r_z));
}

/// Throws NumericalError where z is not what a positive definite preconditioner makes of r.
void require_definite(double r_z) {
  if (r_z < 0)
    throw NumericalError(
        fmt::format("conjugate gradients: the preconditioner is not positive definite (r.z = {})", r_z));
}

}  // namespace

ConjugateGradients::ConjugateGradients(ConjugateGradientSettings settings)
    : settings_(settings), spaces_(std::make_unique<Spaces>()) {}
ConjugateGradients::~ConjugateGradients() = default;

SolveReport ConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  require_sizes(A, b, x);
  // SOFA lets the first iteration of the very first solve pass its stopping rules
  const bool first_solve = std::exchange(first_solve_, false);
  SolveReport report;

  const double norm_b = std::sqrt(finite_square(b));
  if (norm_b == 0) {
    x.setZero();
    return report;
  }

  CgSpace& space = spaces_->choose(A);
  const ConstPoints previous(previous_);
  const bool warm = settings_.warm_start && previous.rows() == b.rows();
  double rho = space.begin(b, warm ? &previous : nullptr), rho_before = 0;
  report.converged = false;
  for (int iteration = 1; iteration <= settings_.iterations; ++iteration) {
    const bool must_go_on = first_solve && iteration == 1;
    if (std::sqrt(rho) / norm_b <= settings_.tolerance && !must_go_on) break;

    const double curvature = space.product(iteration == 1 ? 0 : rho / rho_before);
    require_finite(curvature, rho);
    if (curvature == 0 || (std::abs(curvature) <= settings_.threshold && !must_go_on)) {
      report.converged = true;
      break;
    }
    if (curvature < 0)
      throw NumericalError(
          fmt::format("conjugate gradients: the matrix is not positive definite (p.Ap = {})", curvature));

    report.iterations = iteration;
    rho_before = rho;
    rho = space.advance(rho / curvature);
  }
  space.end(x);
  report.residual = std::sqrt(rho) / norm_b;
  // what products with rounded coefficients leave is not what the system leaves; where nobody asks, it costs nothing
  if (&space == &spaces_->in_single && settings_.tolerance > 0)
    report.residual = exact_residual(A, spaces_->system, b, x, spaces_->system.scratch) / norm_b;
  report.converged = report.converged || report.residual <= settings_.tolerance;
  // a start that is no number would spoil every later solve
  if (settings_.warm_start && x.allFinite()) previous_ = x;
  return report;
}

void ConjugateGradients::reset() {
  first_solve_ = true;
  previous_.resize(0, 3);
}

namespace {

/// Tells whether conjugate gradients can go on along a direction p = z + beta p', z = M^-1 r, M being the
/// preconditioner. As r is orthogonal to p',
///
///   p.Mp = r.z + beta^2 p'.Mp',   and p.Ap / p.Mp lies between the least and the greatest eigenvalue of M^-1 A
class Curvature {
 public:
  /// rounding: CgSpace::rounding. known: p.Ap / p.Mp that M^-1 A has at least somewhere, 0 where none is known.
  explicit Curvature(double rounding, double known = 0) : rounding_(rounding), greatest_(known) {}

  /// False where p.Ap is no more than rounding, of either sign: what is left of b lies outside the range of a
  /// semi-definite A. Throws NumericalError where A is not semi-definite, or not finite. typical(): p.Ap / p.Mp of a
  /// direction without any regularity, asked for where there is nothing to compare a negative one with.
  template <class Typical>
  bool is_positive(double r_z, double p_Ap, const Typical& typical) {
    require_finite(p_Ap, r_z);
    const double beta = r_z_ > 0 ? r_z / r_z_ : 0;
    p_Mp_ = std::abs(r_z) + beta * beta * p_Mp_;
    r_z_ = r_z;
    if (p_Ap > rounding_ * p_Mp_ * greatest_) {
      greatest_ = std::max(greatest_, p_Ap / p_Mp_);
      return true;
    }
    if (p_Ap < 0 && -p_Ap > kNegative * p_Mp_ * (greatest_ > 0 ? greatest_ : std::abs(typical())))
      throw NumericalError(fmt::format("conjugate gradients: the matrix is not positive definite (p.Ap = {})", p_Ap));
    return false;
  }

 private:
  static constexpr double kNegative = 1e-5;  // products in single precision make no more of it

  double rounding_;
  double r_z_ = 0, p_Mp_ = 0;
  double greatest_;  // p.Ap / p.Mp so far
};

}  // namespace

SolveReport SolverPreconditionedConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  require_sizes(A, b, x);
  SolveReport report;
  product_.resize(b.rows(), 3);
  preconditioned_.resize(b.rows(), 3);
  x.setZero();
  const double b_squared = finite_square(b);
  if (b_squared == 0) return report;

  if (preconditioner_) preconditioner_->setup(A);
  const auto precondition = [&](const PointArray& r) {
    if (preconditioner_)
      preconditioner_->solve_again(A, r, preconditioned_);
    else
      preconditioned_ = r;
    return dot(r, preconditioned_);
  };
  const auto typical_curvature = [&] {
    PointArray any(b.rows(), 3);
    fill_irregularly(any);
    const double r_z = precondition(any);
    A.apply(preconditioned_, product_);
    return dot(preconditioned_, product_) / r_z;
  };

  Curvature curvature(CgSpace::kDoubleRounding);
  residual_ = b;
  double rho = precondition(residual_);
  direction_ = preconditioned_;
  if (preconditioner_) report.preconditioner = PreconditionedBy::kFactorisation;
  while (report.iterations < iterations_ && !(std::abs(rho) <= tolerance_ * b_squared)) {
    require_definite(rho);
    A.apply(direction_, product_);
    const double p_Ap = dot(direction_, product_);
    if (!curvature.is_positive(rho, p_Ap, typical_curvature)) {
      if (dot(residual_, residual_) > b_squared) {  // what has blown up is worse than none
        x.setZero();
        residual_ = b;
        rho = b_squared;
      }
      break;
    }

    const double alpha = rho / p_Ap;
    x += alpha * direction_;
    residual_ -= alpha * product_;
    ++report.iterations;

    const double rho_before = std::exchange(rho, precondition(residual_));
    direction_ = preconditioned_ + (rho / rho_before) * direction_;
  }
  report.residual = std::sqrt(dot(residual_, residual_) / b_squared);
  report.converged = std::abs(rho) <= tolerance_ * b_squared;
  return report;
}

void SolverPreconditionedConjugateGradients::reset() {
  if (preconditioner_) preconditioner_->reset();
}

void SolverPreconditionedConjugateGradients::serialize(Archive& archive) {
  if (preconditioner_) preconditioner_->serialize(archive);
}

namespace {

template <class T>
const ChunkedOperator<T>& operator_of(const KernelBody& body) {
  if constexpr (std::is_same_v<T, double>)
    return *body.double_operator;
  else
    return *body.single_operator;
}

/// A cycle in single precision as a preconditioner of a system in double.
class Narrowed final : public SlotPreconditioner<double> {
 public:
  explicit Narrowed(Multigrid<float>& multigrid) : multigrid_(multigrid) {}
  void apply(const AlignedVector<double>& r, AlignedVector<double>& z) override {
    r_.resize(r.size());
    z_.resize(r.size());
    std::transform(r.begin(), r.end(), r_.begin(), [](double entry) { return static_cast<float>(entry); });
    multigrid_.apply(r_, z_);
    std::copy(z_.begin(), z_.end(), z.begin());
  }

 private:
  Multigrid<float>& multigrid_;
  AlignedVector<float> r_, z_;
};

}  // namespace

/// With the system's own preconditioner where the kernels do not know it.
struct PreconditionedConjugateGradients::Spaces {
  KernelSystem system;
  LumpedTerms lumped;
  NodalCgSpace nodal;
  SlotCgSpace<double> in_double;
  SlotCgSpace<float> in_single;
  Multigrid<double> multigrid_double;
  Multigrid<float> multigrid_single;
  Narrowed narrowed{multigrid_single};
  BlockJacobi<double> jacobi_double;
  BlockJacobi<float> jacobi_single;
  SeveralBodies several;
  PointArray correction;

  bool has_others() const { return knows_kernels && system.others; }
  bool refines() const {
    return knows_kernels && std::ranges::any_of(system.bodies, [](const KernelBody& body) {
             return body.single_operator && body.exact_operator;
           });
  }

  CgSpace& choose(const LinearSystem& A, Preconditioner preconditioner, PreconditionedBy& chosen) {
    system.clear();
    system.wants_coarse = preconditioner != Preconditioner::kDiagonal;
    knows_kernels = A.to_kernels(system);
    chosen = PreconditionedBy::kNothing;
    if (!knows_kernels) {
      nodal.refer_to(A, true);
      return nodal;
    }
    if (system.others) lumped.find(system);
    const NodalPart rest{.diagonal = system.others ? lumped.diagonal() : system.diagonal,
                         .free = system.free,
                         .blocks = system.others ? std::span(lumped.blocks()) : std::span<const NodeBlock>(),
                         .version = system.diagonal_version};
    const bool cycles = has_coarse() && (preconditioner == Preconditioner::kMultigrid || is_stiff(rest.diagonal));
    chosen = cycles ? PreconditionedBy::kMultigrid : PreconditionedBy::kDiagonal;
    if (system.bodies.size() != 1 || system.couples_coordinates) {
      several.refer_to(A, system, rest, cycles);
      const bool is_single = std::ranges::any_of(system.bodies, [](const KernelBody& b) { return !b.double_operator; });
      nodal.refer_to(A, true, &several, is_single ? CgSpace::kSingleRounding : CgSpace::kDoubleRounding);
      return nodal;
    }
    const KernelBody& body = system.bodies.front();
    if (!body.double_operator) return refer(in_single, multigrid_single, jacobi_single, rest, cycles);
    if (!body.single_operator || !cycles) return refer(in_double, multigrid_double, jacobi_double, rest, cycles);
    multigrid_single.refer_to(body, rest);
    in_double.refer_to(system, false, &narrowed);
    return in_double;
  }

 private:
  bool knows_kernels = false;
  std::tuple<AlignedVector<double>, AlignedVector<float>> scratch_;

  template <class T>
  CgSpace& refer(SlotCgSpace<T>& space, Multigrid<T>& multigrid, BlockJacobi<T>& jacobi, const NodalPart& rest,
                 bool cycles) {
    const KernelBody& body = system.bodies.front();
    if (cycles) {
      multigrid.refer_to(body, rest);
      space.refer_to(system, false, &multigrid);
    } else if (system.others) {
      jacobi.refer_to(operator_of<T>(body), static_cast<T>(body.factor), rest);
      space.refer_to(system, false, &jacobi);
    } else {
      space.refer_to(system, true);
    }
    return space;
  }

  bool has_coarse() const {
    return std::ranges::any_of(system.bodies, [](const KernelBody& body) { return !body.coarse.empty(); });
  }

  /// Jacobi needs about 4 c dt / h iterations for one per cent, multigrid three that cost as much as twelve: they break
  /// even near c dt / h = 4. The stiffness on the diagonal over the rest of it is about (1.6 c dt / h)^2. Counted are
  /// the degrees of freedom that more than half of the stiffness acts on: what holds some nodes is not theirs alone.
  bool is_stiff(const PointArray& diagonal) {
    double stiff = 0, all = 0;
    const auto count = [&]<class T>(const KernelBody& body) {
      constexpr double kBreakEven = 40;
      const ChunkedOperator<T>& op = operator_of<T>(body);
      const Partition& partition = op.partition();
      AlignedVector<T>& stiffness = std::get<AlignedVector<T>>(scratch_);
      stiffness.resize(4 * static_cast<std::size_t>(partition.num_slots));
      find_diagonal(op, static_cast<T>(body.factor), stiffness);
      for (int n = 0; n < partition.num_nodes; ++n)
        for (int i = 0; i < 3; ++i) {
          const auto entry =
              static_cast<double>(stiffness[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i]);
          all += entry;
          if (entry > kBreakEven * diagonal(n, i)) stiff += entry;
        }
    };
    for (const KernelBody& body : system.bodies)
      if (body.double_operator)
        count.template operator()<double>(body);
      else
        count.template operator()<float>(body);
    return stiff > all / 2;
  }
};

PreconditionedConjugateGradients::PreconditionedConjugateGradients(double tolerance, int iterations,
                                                                   Preconditioner preconditioner)
    : tolerance_(tolerance),
      iterations_(iterations),
      preconditioner_(preconditioner),
      spaces_(std::make_unique<Spaces>()) {}
PreconditionedConjugateGradients::~PreconditionedConjugateGradients() = default;
PreconditionedConjugateGradients::PreconditionedConjugateGradients(PreconditionedConjugateGradients&&) noexcept =
    default;

SolveReport PreconditionedConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  return iterate(A, b, nullptr, x);
}

SolveReport PreconditionedConjugateGradients::improve(const LinearSystem& A, ConstPoints b, Points x) {
  const ConstPoints start(x);  // which is read before x is written
  return iterate(A, b, &start, x);
}

namespace {

// Single precision with half-precision coefficients answers to about 2e-4; beyond this its answers are corrections.
constexpr double kSingleSuffices = 1e-3;
constexpr double kCorrection = 3e-3;  // relative residual of each correction
constexpr int kMostCorrections = 50;

// p.Ap / p.Mp that M^-1 A has at least somewhere: a diagonal has 1, a cycle is made for 1 at the upper end.
constexpr double kOfPreconditioned = 0.1;

/// p.Ap / r.z of the first direction towards an irregular right-hand side.
double typical_curvature(CgSpace& space, Eigen::Index num_nodes) {
  PointArray any(num_nodes, 3);
  fill_irregularly(any);
  space.begin(any, nullptr);
  const double r_z = space.precondition();
  return space.product(0) / r_z;
}

/// Adds to `report`; ends at a residual of `enough` relative to norm_b. The answer is left in `space`.
void run(CgSpace& space, ConstPoints b, const ConstPoints* start, double norm_b, double enough, int most_iterations,
         SolveReport& report) {
  report.residual = std::sqrt(space.begin(b, start)) / norm_b;
  if (start && !(report.residual <= 1)) {  // worse than none
    start = nullptr;
    report.residual = std::sqrt(space.begin(b, start)) / norm_b;
  }
  double rho_before = 0;
  bool first = true;
  Curvature curvature(space.rounding(), space.is_preconditioned() ? kOfPreconditioned : 0);
  while (!(report.residual <= enough) && report.iterations < most_iterations) {
    const double rho = space.precondition();
    const double p_Ap = space.product(first ? 0 : rho / rho_before);
    if (!curvature.is_positive(rho, p_Ap, [&] { return typical_curvature(space, b.rows()); })) {
      if (first || report.residual > 1)  // what has blown up is worse than none
        report.residual = std::sqrt(space.begin(b, start)) / norm_b;
      break;
    }
    require_definite(rho);
    first = false;

    report.residual = std::sqrt(space.advance(rho / p_Ap)) / norm_b;
    ++report.iterations;
    rho_before = rho;
  }
  report.converged = report.residual <= enough;
}

}  // namespace

SolveReport PreconditionedConjugateGradients::iterate(const LinearSystem& A, ConstPoints b, const ConstPoints* start,
                                                      Points x) {
  require_sizes(A, b, x);
  SolveReport report;
  const double norm_b = std::sqrt(finite_square(b));
  if (norm_b == 0) {
    x.setZero();
    return report;
  }
  CgSpace& space = spaces_->choose(A, preconditioner_, report.preconditioner);
  const double enough = std::max(tolerance_, A.rounding() / norm_b);
  const bool is_single = spaces_->refines(), refines = is_single && enough < kSingleSuffices;
  PointArray &r = spaces_->system.scratch, &correction = spaces_->correction;
  if (refines) {
    if (start) {
      x = start->cwiseProduct(spaces_->system.free.cast<double>());
      if (spaces_->system.couples_coordinates) A.project(x);
    } else {
      x.setZero();
    }
  } else {
    run(space, b, start, norm_b, enough, iterations_, report);
    space.end(x);
    if (!spaces_->has_others()) return report;
    // beside what is much stiffer than the body, rounding and half precision leave out much more than they do of it
  }
  double norm_r = exact_residual(A, spaces_->system, b, x, r);
  if (!std::isfinite(norm_r)) {  // the start was no number
    x.setZero();
    r = b;
    norm_r = norm_b;
  }

  // corrections to an answer in double, until its own residual is small
  correction.resize(b.rows(), 3);
  for (int k = 0; k < kMostCorrections && !(norm_r <= enough * norm_b) && report.iterations < iterations_; ++k) {
    const double of_correction = std::max(0.5 * enough * norm_b / norm_r, is_single ? kCorrection : 0);
    run(space, r, nullptr, norm_r, of_correction, iterations_, report);
    space.end(correction);
    correction += x;
    const double norm_before = std::exchange(norm_r, exact_residual(A, spaces_->system, b, correction, r));
    // A is singular, or the answer as good as it gets
    const bool gives_up = !is_single || (!report.converged && report.iterations < iterations_);
    if (gives_up && !(norm_r < norm_before)) {
      norm_r = norm_before;
      break;
    }
    x = correction;
  }
  report.residual = norm_r / norm_b;
  report.converged = report.residual <= enough;
  return report;
}

}  // namespace hexaplast
