// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/irregular_field.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "solve/cg_loop.hpp"
#include "solve/constants.hpp"
#include "solve/multigrid.hpp"
#include "solve/several_bodies.hpp"

namespace hexaplast {

namespace {

/// Tells whether conjugate gradients can go on along a direction p = z + beta p', z = M^-1 r, M being the
/// preconditioner. As r is orthogonal to p',
///
///   p.Mp = r.z + beta^2 p'.Mp',   and p.Ap / p.Mp lies between the smallest and the largest eigenvalue of M^-1 A
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
      throw_indefinite(p_Ap);
    return false;
  }

 private:
  double rounding_;
  double r_z_ = 0, p_Mp_ = 0;
  double greatest_;  // p.Ap / p.Mp so far
};

/// p.Ap / r.z of the first direction towards an irregular right-hand side.
double typical_curvature(CgSpace& space, Eigen::Index num_nodes) {
  PointArray any(num_nodes, 3);
  fill_irregularly(any);
  const ConstPoints b(any);
  space.begin(b, nullptr);
  const double r_z = space.precondition();
  return space.product(0) / r_z;
}

/// `iterate` for an A that may be semi-definite: ends where what is left of b lies outside its range. is_indefinite:
/// where given, whether the preconditioner turned out not to be positive definite, which ends it too; else that throws.
template <class Converged>
double iterate_within_range(CgSpace& space, ConstPoints b, const ConstPoints* start, double r_r, int max,
                            int& iterations, const Converged& has_converged, bool* is_indefinite = nullptr) {
  const int iterations_before = iterations;
  bool is_outside = false;
  Curvature curvature(space.rounding(), space.is_preconditioned() ? kOfPreconditioned : 0);
  const auto goes_on = [&](double rho, double p_Ap) {
    if (is_indefinite && (*is_indefinite = rho < 0)) return false;
    is_outside = !curvature.is_positive(rho, p_Ap, [&] { return typical_curvature(space, b.rows()); });
    if (!is_outside) require_definite(rho);
    return !is_outside;
  };
  r_r = iterate(space, r_r, max, iterations, has_converged, goes_on);
  // what has blown up is worse than none
  const bool begins_anew = is_outside && (iterations == iterations_before || r_r > hexaplast::dot(b, b));
  return begins_anew ? space.begin(b, start) : r_r;
}

/// A cycle in single precision as a preconditioner of a system in double.
class SinglePrecisionPreconditioner final : public SlotPreconditioner<double> {
 public:
  explicit SinglePrecisionPreconditioner(Multigrid& multigrid) : multigrid_(multigrid) {}
  void apply(const AlignedVector<double>& r, AlignedVector<double>& z) override {
    r_.resize(r.size());
    z_.resize(r.size());
    std::transform(r.begin(), r.end(), r_.begin(), [](double entry) { return static_cast<float>(entry); });
    multigrid_.apply(r_, z_);
    std::copy(z_.begin(), z_.end(), z.begin());
  }
  double diagonal_norm(const AlignedVector<double>& x) override {
    r_.resize(x.size());
    std::transform(x.begin(), x.end(), r_.begin(), [](double entry) { return static_cast<float>(entry); });
    return multigrid_.diagonal_norm(r_);
  }

 private:
  Multigrid& multigrid_;
  AlignedVector<float> r_, z_;
};

}  // namespace

/// With the system's own preconditioner where the kernels do not know it.
struct PreconditionedConjugateGradients::Spaces {
  MatrixFreeSystem system;
  LumpedTerms lumped;
  NodalCgSpace nodal;
  SlotCgSpace<double> in_double;
  SlotCgSpace<float> in_single;
  Multigrid multigrid;
  SinglePrecisionPreconditioner single_precision{multigrid};
  BlockJacobi<double> jacobi_double;
  BlockJacobi<float> jacobi_single;
  SeveralBodies several;
  BodyResiduals bodies;
  PointArray right_hand_side, correction;
  CgSpace* latest = nullptr;  // for the latest system
  PreconditionedBy preconditioned_by = PreconditionedBy::kNothing;
  std::vector<SpectralRadii> radii;  // SolverMemory::radii of the present solve
  bool has_known_radii = false;      // the latest preconditioner has some that it was given
  bool has_outdated_radii = false;   // they made it indefinite
  bool has_others() const { return knows_kernels && !system.others.empty(); }
  bool refines() const { return knows_kernels && rounds_products(system); }
  bool knows_residual() const { return knows_kernels && has_exact_products(system); }

  CgSpace& choose(const LinearSystem& A, Preconditioner preconditioner) {
    system.clear();
    system.wants_levels = preconditioner != Preconditioner::kDiagonal;
    knows_kernels = A.matrix_free(system);
    preconditioned_by = PreconditionedBy::kNothing;
    if (!knows_kernels) {
      nodal.setup(A, true, &system.constraints);
      return nodal;
    }
    const NodeGroup all{0, static_cast<int>(system.diagonal.rows())};
    const std::span<const NodeGroup> groups =
        system.has_one_body() ? std::span(&all, 1) : std::span<const NodeGroup>(several.find_groups(system));
    if (!system.others.empty()) lumped.find(system, groups);
    if (device_of(system)) return on_device(preconditioner);
    const bool has_levels = system.wants_levels && std::ranges::any_of(system.bodies, SeveralBodies::has_coarse_meshes);
    return precondition(
        A, has_levels && (preconditioner == Preconditioner::kMultigrid || is_stiff(nodal_part().diagonal)));
  }

  /// The present system by cycles, or by the diagonal.
  CgSpace& precondition(const LinearSystem& A, bool cycles) {
    if (device_of(system)) return on_device(cycles ? Preconditioner::kMultigrid : Preconditioner::kDiagonal);
    const NodalPart rest = nodal_part();
    preconditioned_by = cycles ? PreconditionedBy::kMultigrid : PreconditionedBy::kDiagonal;
    if (radii.size() != system.bodies.size()) radii.assign(system.bodies.size(), {});
    has_known_radii = false;
    if (!system.has_one_body()) {
      has_known_radii = several.setup(system, rest, system.others.empty() ? nullptr : &lumped, cycles, radii);
      const bool is_single = std::ranges::any_of(system.bodies, [](const KernelBody& b) { return !b.double_operator; });
      nodal.setup(A, true, &system.constraints, &several, is_single ? kSingleRounding : kDoubleRounding, &bodies);
      return nodal;
    }
    const KernelBody& body = system.bodies.front();
    if (cycles) has_known_radii = multigrid.setup(body, rest, radii.front());
    if (!body.double_operator) return refer(in_single, &multigrid, jacobi_single, rest, cycles);
    return refer(in_double, &single_precision, jacobi_double, rest, cycles);
  }

 private:
  bool knows_kernels = false;

  NodalPart nodal_part() const {
    return {.diagonal = system.others.empty() ? system.diagonal : lumped.diagonal(),
            .free = system.constraints.free,
            .blocks = system.others.empty() ? std::span<const NodeBlock>() : std::span(lumped.blocks()),
            .own_diagonal = system.others.empty() ? nullptr : &system.diagonal};
  }

  CgSpace& on_device(Preconditioner preconditioner) {
    DeviceVectors& device = *device_of(system);
    const NodalPart rest = nodal_part();
    CgSpace& space = device.space(system, &rest);
    radii.resize(1);
    std::optional<bool> has_known;
    if (preconditioner != Preconditioner::kDiagonal)
      has_known = device.use_cycles(preconditioner == Preconditioner::kMultigrid, radii.front());
    has_known_radii = has_known.value_or(false);
    preconditioned_by = has_known ? PreconditionedBy::kMultigrid : PreconditionedBy::kDiagonal;
    return space;
  }

  template <class T>
  CgSpace& refer(SlotCgSpace<T>& space, SlotPreconditioner<T>* cycle, BlockJacobi<T>& jacobi, const NodalPart& rest,
                 bool cycles) {
    const KernelBody& body = system.bodies.front();
    if (cycles) {
      space.setup(system, false, cycle);
    } else if (!system.others.empty()) {
      jacobi.setup(*body.op<T>(), static_cast<T>(body.factor), rest);
      space.setup(system, false, &jacobi);
    } else {
      space.setup(system, true);
    }
    return space;
  }

  /// Whether a cycle costs less than Jacobi's iterations. Counted are the degrees of freedom that more than half of the
  /// stiffness acts on: what holds some nodes is not theirs alone.
  bool is_stiff(const PointArray& diagonal) {
    double stiff = 0, all = 0;
    const auto count = [&](double stiffness, double rest) {
      all += stiffness;
      if (stiffness > kBreakEven * rest) stiff += stiffness;
    };
    if (system.has_one_body()) {
      const KernelBody& body = system.bodies.front();
      const LevelOperator& fine = body.levels.front();
      const std::vector<int>& slot = fine.op->partition().slot_of_node;
      for (std::size_t n = 0; n < slot.size(); ++n)
        for (std::size_t i = 0; i < 3; ++i)
          count(body.factor * static_cast<double>(fine.diagonal[4 * static_cast<std::size_t>(slot[n]) + i]),
                diagonal(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(i)));
    } else {
      several.visit_stiffness([&](int first_node, const PointArray& stiffness) {
        for (int n = 0; n < stiffness.rows(); ++n)
          for (int i = 0; i < 3; ++i) count(stiffness(n, i), diagonal(first_node + n, i));
      });
    }
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
  spaces_->radii.clear();
  return iterate(A, b, nullptr, x);
}

SolveReport PreconditionedConjugateGradients::solve_next(const LinearSystem& A, ConstPoints b, Points x,
                                                         SolverMemory& memory) {
  spaces_->radii = memory.radii;
  const SolveReport report = iterate(A, b, nullptr, x);
  if (report.preconditioner == PreconditionedBy::kMultigrid)
    for (SpectralRadii& radii : spaces_->radii) radii.update(report.iterations);
  memory.radii = spaces_->radii;
  return report;
}

SolveReport PreconditionedConjugateGradients::solve_from_guess(const LinearSystem& A, ConstPoints b, Points x,
                                                               SolverMemory& memory) {
  std::vector<SpectralRadii>& radii = spaces_->radii;
  radii = memory.radii;
  for (SpectralRadii& of_body : radii) of_body.num_solves = 0;  // valid in the whole step
  const ConstPoints start(x);                                   // which is read before x is written
  const SolveReport report = iterate(A, b, &start, x);
  for (std::size_t k = 0; k < radii.size(); ++k)
    if (k < memory.radii.size() && radii[k].of_level == memory.radii[k].of_level)
      radii[k] = memory.radii[k];
    else
      radii[k].update(report.iterations);
  memory.radii = radii;
  return report;
}

namespace {

/// Adds to `report`; ends at a residual of `enough` relative to norm_b. The answer is left in `space`. is_indefinite:
/// as in iterate_within_range.
void run(CgSpace& space, ConstPoints b, const ConstPoints* start, double norm_b, double enough, int max_iterations,
         SolveReport& report, bool* is_indefinite = nullptr) {
  const auto relative = [&](double r_r) { return std::sqrt(r_r) / norm_b; };
  // of each body too, which is asked only where all of them together are near enough
  const auto is_enough = [&](double r_r) { return relative(r_r) <= enough && space.size(r_r) / norm_b <= enough; };
  double r_r = space.begin(b, start);
  if (start && !(relative(r_r) <= 1)) {  // worse than none
    start = nullptr;
    r_r = space.begin(b, start);
  }
  r_r = iterate_within_range(space, b, start, r_r, max_iterations, report.iterations, is_enough, is_indefinite);
  report.residual = space.size(r_r) / norm_b;
  report.converged = report.residual <= enough;
}

}  // namespace

PreparedSystem PreconditionedConjugateGradients::prepare(const LinearSystem& A, SolverMemory& memory) {
  PreparedSystem prepared;
  spaces_->radii = memory.radii;
  for (SpectralRadii& radii : spaces_->radii) radii.num_solves = 0;  // valid for all solvers of A
  spaces_->latest = &spaces_->choose(A, preconditioner_);
  memory.radii = spaces_->radii;
  const MatrixFreeSystem& system = spaces_->system;
  if (system.constraints.free.rows() == A.num_nodes()) prepared.constraints = &system.constraints;
  // a device has one set of vectors for all solvers
  prepared.is_concurrent =
      spaces_->preconditioned_by != PreconditionedBy::kNothing && system.is_one_body() && !system.bodies.front().device;
  return prepared;
}

SolveReport PreconditionedConjugateGradients::approximate(ConstPoints b, double residual, bool has_start, Points x,
                                                          Points r) {
  SolveReport report;
  CgSpace& space = *spaces_->latest;
  const ConstPoints start(x);  // which is read before x is written
  const double b_b = hexaplast::dot(b, b), enough = residual * residual * b_b;
  double r_r = space.begin(b, has_start ? &start : nullptr), rho_before = 0;
  if (has_start && !(r_r <= b_b)) r_r = space.begin(b, nullptr);  // worse than none
  for (; report.iterations < iterations_ && !(r_r <= enough); ++report.iterations) {
    const double rho = space.precondition();
    require_finite(0, rho);
    require_definite(rho);
    const double p_Ap = space.product(report.iterations == 0 ? 0 : rho / rho_before);
    require_finite(p_Ap, rho);
    if (p_Ap <= 0) throw_indefinite(p_Ap);
    r_r = space.advance(rho / p_Ap);
    rho_before = rho;
  }
  space.end(x);
  space.residual(r);
  report.residual = b_b > 0 ? std::sqrt(r_r / b_b) : 0;
  report.converged = r_r <= enough;
  return report;
}

void PreconditionedConjugateGradients::refine_residual(ConstPoints b, ConstPoints x, Points r) {
  if (!spaces_->refines()) return;
  exact_residual(spaces_->system, b, x, spaces_->correction);
  r = spaces_->correction;
}

// What radii of an earlier step are too small for is solved again with those of the present one: the cells of a sheet
// that turns fast.
SolveReport PreconditionedConjugateGradients::iterate(const LinearSystem& A, ConstPoints b, const ConstPoints* start,
                                                      Points x) {
  require_sizes(A, b, x);
  SolveReport report = attempt(A, b, start, x);
  if (!std::exchange(spaces_->has_outdated_radii, false)) return report;
  spaces_->radii.clear();
  const int lost = report.iterations;
  report = attempt(A, b, start, x);
  report.iterations += lost;
  return report;
}

SolveReport PreconditionedConjugateGradients::attempt(const LinearSystem& A, ConstPoints given,
                                                      const ConstPoints* start, Points x) {
  SolveReport report;
  const double norm_b = std::sqrt(finite_square(given));
  if (norm_b == 0) {
    x.setZero();
    return report;
  }
  spaces_->latest = &spaces_->choose(A, preconditioner_);
  report.preconditioner = spaces_->preconditioned_by;
  // where forces cancel, constraints that couple coordinates leave as much outside of their range as the forces round
  // to; a second time they leave the rounding of what is left
  const Constraints& constraints = spaces_->system.constraints;
  const bool has_ties = constraints.projector;
  if (has_ties) {
    spaces_->right_hand_side = given;
    constraints.project(spaces_->right_hand_side);
  }
  const ConstPoints b = has_ties ? ConstPoints(spaces_->right_hand_side) : given;
  spaces_->bodies.setup(spaces_->system, b);
  const double enough = std::max(tolerance_, A.rounding() / norm_b);
  const bool is_single = spaces_->refines(), refines = is_single && enough < kSingleSuffices;
  PointArray &r = spaces_->system.scratch, &correction = spaces_->correction;
  const auto size_of_exact_residual = [&](ConstPoints at) {
    const double norm = exact_residual(spaces_->system, b, at, r);
    return std::max(norm, spaces_->bodies.size_at(r, at));
  };

  // A cycle that turns out not to be positive definite is outdated, or gives way to the diagonal, from where it has
  // come. False: the solve is to be made anew.
  const auto run_on = [&](ConstPoints of, const ConstPoints* from, double norm, double until, Points answer) {
    const bool cycles = report.preconditioner == PreconditionedBy::kMultigrid;
    bool is_indefinite = false;
    run(*spaces_->latest, of, from, norm, until, iterations_, report, cycles ? &is_indefinite : nullptr);
    spaces_->has_outdated_radii = is_indefinite && spaces_->has_known_radii;
    if (spaces_->has_outdated_radii) return false;
    spaces_->latest->end(answer);
    if (!is_indefinite) return true;
    spaces_->radii.clear();
    spaces_->latest = &spaces_->precondition(A, false);
    report.preconditioner = spaces_->preconditioned_by;
    const ConstPoints reached(answer);
    run(*spaces_->latest, of, &reached, norm, until, iterations_, report);
    spaces_->latest->end(answer);
    return true;
  };
  if (refines) {
    if (start) {
      x = *start;
      constraints.project(x);
    } else {
      x.setZero();
    }
  } else {
    if (!run_on(b, start, norm_b, enough, x)) return report;
    // rounding leaves more than the tolerance where the stiffness is far above what b asks for, and where other terms
    // are much stiffer than the body
    if (!spaces_->knows_residual()) return report;
    const bool is_doubtful = spaces_->latest->rounding_of_residual() > kDoubt * enough * norm_b;
    if (!spaces_->has_others() && !is_doubtful) return report;
    if (is_single && !is_doubtful && enough > 2 * kHalfLeavesOut) {
      report.residual = spaces_->latest->residual_beside_others(spaces_->system, b, x, r) / norm_b;
      report.converged = report.residual + kHalfLeavesOut <= enough;
      if (report.converged) return report;
    }
  }
  double norm_r = size_of_exact_residual(x);
  if (!std::isfinite(norm_r)) {  // the start was no number
    x.setZero();
    r = b;
    norm_r = norm_b;
  }

  // corrections to an answer in double, until its own residual is small
  correction.resize(b.rows(), 3);
  for (int k = 0; k < kMaxCorrections && !(norm_r <= enough * norm_b) && report.iterations < iterations_; ++k) {
    const double of_correction = std::max(0.5 * enough * norm_b / norm_r, is_single ? kCorrection : 0);
    if (!run_on(r, nullptr, norm_r, of_correction, correction)) return report;
    correction += x;
    const double norm_before = std::exchange(norm_r, size_of_exact_residual(correction));
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
