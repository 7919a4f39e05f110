// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/averaging.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <optional>
#include <variant>

#include "hexaplast/base/parallel.hpp"
#include "plastic/averaging_pass.hpp"

namespace hexaplast {

namespace {

// a linear field over the 2 x 2 x 2 children of a cell costs as much in them as in the cell, of twice their edges, with
// weight 2
constexpr float kFractionOfChild = 0.25;

// H_k <= P_k <= I, and the diagonal of P_k is 7/8
constexpr double kSpectralRadius = 8.0 / 7 * (1 + kRegularisation);

long next_version() {
  static std::atomic<long> latest = 0;
  return ++latest;
}

/// The averaging on a coarse mesh.
struct CoarseAveraging {
  explicit CoarseAveraging(const CoarseMesh& mesh)
      : position(slot_vector<double>(*mesh.partition)), weight(mesh.children.size()), op(mesh.partition) {}

  /// weight_of(element of the finer mesh)
  template <class Weight>
  void gather_weights(const CoarseMesh& mesh, const Weight& weight_of) {
    parallel_for(static_cast<int>(weight.size()), [&](int cell) {
      weight[cell] = 0;
      for (const int child : mesh.children[cell])
        if (child >= 0) weight[cell] += kFractionOfChild * weight_of(child);
    });
  }

  AlignedVector<double> position;  // [m] slots
  std::vector<float> weight;       // per cell
  AveragingOperator<float> op;
};

}  // namespace

struct Averaging::Kernels {
  explicit Kernels(const Model& model)
      : op(model.settings.precision == Precision::kDouble ? Operator(AveragingOperator<double>(model.partition))
                                                          : Operator(AveragingOperator<float>(model.partition))),
        present(model.partition->num_blocks),
        misfit(model.partition->num_blocks),
        size(model.partition->num_blocks) {
    slots.resize(*model.partition);
  }

  /// Best rotations of history.rest_shape at history.plastic_rest_positions into history.rotation_map; returns E. With
  /// `prepares`: operator, gradient and size as well.
  double fit(const Model& model, History& history, bool prepares) {
    const Partition& partition = *model.partition;
    slots.resize(partition);
    to_slots(partition, history.plastic_rest_positions, plastic_rest());
    if (prepares) std::fill(gradient().begin(), gradient().end(), 0.0);
    std::visit(
        [&]<class T>(AveragingOperator<T>& of) {
          const FitPass<T> pass{.partition = partition,
                                .plastic_rest = plastic_rest().data(),
                                .present = present.data(),
                                .rest_shape = history.rest_shape.data(),
                                .rotation_map = history.rotation_map.data(),
                                .coef = prepares ? of.coef.data() : nullptr,
                                .gradient = prepares ? gradient().data() : nullptr,
                                .misfit = misfit.data(),
                                .size = prepares ? size.data() : nullptr};
          parallel_for(partition.num_chunks, [&](int chunk) { fit_elements(pass, chunk); });
        },
        op);
    if (prepares)
      parallel_for(partition.num_chunks, [&](int chunk) { reduce_ghosts(partition, chunk, gradient().data()); });
    return std::accumulate(misfit.begin(), misfit.end(), 0.0);
  }

  /// Takes the elements whose entry is not 0.
  void setup(const Model& model, const std::vector<unsigned char>& elements) {
    const Partition& partition = *model.partition;
    std::visit(
        [&]<class T>(AveragingOperator<T>& of) {
          using Op = AveragingOperator<T>;
          for (int block = 0; block < partition.num_blocks; ++block) {
            T* weight = of.coef.data() + (static_cast<std::size_t>(block) * Op::kComponents + Op::kWeight) * kBlock;
            present[block] = 0;
            for (int place = 0; place < kBlock; ++place) {
              const int e = partition.element(block, place);
              const bool counts = e >= 0 && elements[e];
              weight[place] = counts ? T(1) : T(0);
              if (counts) present[block] |= static_cast<std::uint16_t>(1u << place);
            }
          }
        },
        op);
    chosen = elements;
    version = next_version();
    if (!coarse.empty()) gather_weights(model);
  }

  /// The operator in single precision.
  const AveragingOperator<float>& narrow(bool projects) {
    const auto& wide = std::get<AveragingOperator<double>>(op);
    if (!single) single.emplace(wide.shared_partition());
    single->projects = projects;
    constexpr int kNumbers = AveragingOperator<double>::kComponents * kBlock;
    parallel_for(wide.partition().num_blocks, [&](int block) {
      const double* from = wide.coef.data() + static_cast<std::size_t>(block) * kNumbers;
      float* to = single->coef.data() + static_cast<std::size_t>(block) * kNumbers;
      for (int n = 0; n < kNumbers; ++n) to[n] = static_cast<float>(from[n]);
    });
    return *single;
  }

  void gather_weights(const Model& model) {
    const std::vector<CoarseMesh>& meshes = model.coarse_meshes();
    for (std::size_t k = 0; k < coarse.size(); ++k)
      coarse[k].gather_weights(meshes[k], [&](int child) {
        return k > 0 ? coarse[k - 1].weight[child] : static_cast<float>(chosen[child]);
      });
  }

  /// The operators on the coarse meshes at the positions of the latest fit.
  std::span<const CoarseOperator> coarsen(const Model& model, bool projects) {
    const std::vector<CoarseMesh>& meshes = model.coarse_meshes();
    if (coarse.empty() && !meshes.empty()) {
      for (const CoarseMesh& mesh : meshes) coarse.emplace_back(mesh);
      gather_weights(model);
    }
    operators.clear();
    const AlignedVector<double>* finer = &plastic_rest();
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      CoarseAveraging& level = coarse[k];
      meshes[k].place(*finer, level.position);
      level.op.projects = projects;
      parallel_for(meshes[k].partition->num_chunks,
                   [&](int chunk) { fit_cells(level.position.data(), level.weight.data(), chunk, level.op); });
      operators.push_back({&level.op, &meshes[k]});
      finer = &level.position;
    }
    return operators;
  }

  using Operator = std::variant<AveragingOperator<double>, AveragingOperator<float>>;
  Operator op;
  std::optional<AveragingOperator<float>> single;  // beside one in double, where coarse meshes are worked on
  long version = 0;                       // MatrixFreeSystem::diagonal_version: no two sets of elements share one
  std::vector<unsigned char> chosen;      // the elements that count
  std::vector<std::uint16_t> present;     // the same, per block a bit per element
  std::vector<CoarseAveraging> coarse;    // of Model::coarse_meshes, made when a solver first asks for them
  std::vector<CoarseOperator> operators;  // of `coarse`
  AlignedVector<double>& plastic_rest() { return slots.first; }  // [m] of the latest fit
  AlignedVector<double>& gradient() { return slots.second; }     // [m] its own
  SlotScratch slots;
  std::vector<double> misfit, size;  // [m^2] per block
};

/// P or H of eq. 31 as a linear system.
class Averaging::System final : public LinearSystem {
 public:
  System(const Model& model, const Averaging& averaging, bool projects)
      : model_(model), averaging_(averaging), projects_(projects) {
    std::visit([&](auto& op) { op.projects = projects; }, averaging.kernels_->op);
  }

  int num_nodes() const override { return model_.mesh.num_nodes(); }
  bool leaves_rotation() const { return projects_; }

  void apply(ConstPoints p, Points Ap) const override {
    const Partition& partition = *model_.partition;
    std::visit(
        [&]<class T>(const AveragingOperator<T>& op) {
          AlignedVector<T> from = slot_vector<T>(partition), to = slot_vector<T>(partition);
          to_slots(partition, p, from);
          for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, 1, from.data(), to.data());
          for (int chunk = 0; chunk < partition.num_chunks; ++chunk) reduce_ghosts(partition, chunk, to.data());
          for (int n = 0; n < num_nodes(); ++n)
            for (int i = 0; i < 3; ++i) Ap(n, i) = to[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];
        },
        averaging_.kernels_->op);
  }

  // column by column through apply's own element product; the translations of each part are pinned at its first node
  void assemble(BlockMatrix& A) const override {
    PointArray unit(num_nodes(), 3), column(num_nodes(), 3);
    for (int b = 0; b < num_nodes(); ++b)
      for (int axis = 0; axis < 3; ++axis) {
        unit.setZero();
        unit(b, axis) = 1;
        apply(unit, column);
        for (int a = 0; a < num_nodes(); ++a) {
          if (column.row(a).isZero(0)) continue;
          Mat3 block = Mat3::Zero();
          block.col(axis) = column.row(a).transpose();
          A.add(a, b, block);
        }
      }
    std::vector<bool> pinned(averaging_.parts_.count, false);
    for (int n = 0; n < num_nodes(); ++n) {
      const int part = averaging_.parts_.part_of_node[n];
      if (part >= 0 && pinned[part]) continue;
      A.add(n, n, Mat3::Identity());
      if (part >= 0) pinned[part] = true;
    }
  }

  void precondition(ConstPoints r, Points z) const override {
    parallel_for(num_nodes(), [&](int n) {
      const double weight = averaging_.node_weight_[n];
      if (weight > 0)
        z.row(n) = r.row(n) / weight;
      else
        z.row(n).setZero();
    });
  }

  bool describe(MatrixFreeSystem& system) const override {
    Kernels& kernels = *averaging_.kernels_;
    if (system.diagonal_version != kernels.version) {
      system.diagonal_version = kernels.version;
      system.diagonal.setZero(num_nodes(), 3);
      system.free.setOnes(num_nodes(), 3);
    }
    KernelBody& body = system.bodies.emplace_back();
    body.factor = 1;
    body.spectral_radius = kSpectralRadius;
    body.double_operator = std::get_if<AveragingOperator<double>>(&kernels.op);
    body.single_operator = std::get_if<AveragingOperator<float>>(&kernels.op);
    if (system.wants_coarse) body.coarse = kernels.coarsen(model_, projects_);
    if (body.double_operator && !body.coarse.empty()) body.cycle_operator = &kernels.narrow(projects_);
    return true;
  }

  // b adds eight differences of positions at each node
  double rounding() const override { return 4 * std::numeric_limits<double>::epsilon() * averaging_.before_.norm(); }

 private:
  const Model& model_;
  const Averaging& averaging_;
  bool projects_;
};

Averaging::Averaging(const Model& model)
    : node_weight_(model.mesh.num_nodes()),
      gradient_(model.mesh.num_nodes(), 3),
      increment_(model.mesh.num_nodes(), 3),
      before_(model.mesh.num_nodes(), 3),
      kernels_(std::make_unique<Kernels>(model)) {}
Averaging::~Averaging() = default;
Averaging::Averaging(const Averaging& other)
    : parts_(other.parts_),
      removed_(other.removed_),
      node_weight_(other.node_weight_),
      of_part_(other.of_part_),
      part_moves_(other.part_moves_),
      chosen_(other.chosen_),
      gradient_(other.gradient_),
      increment_(other.increment_),
      before_(other.before_),
      kernels_(std::make_unique<Kernels>(*other.kernels_)) {}
Averaging::Averaging(Averaging&&) noexcept = default;
SlotScratch& Averaging::slots() { return kernels_->slots; }
Averaging& Averaging::operator=(Averaging other) noexcept {
  std::swap(parts_, other.parts_);
  std::swap(removed_, other.removed_);
  std::swap(node_weight_, other.node_weight_);
  std::swap(of_part_, other.of_part_);
  std::swap(part_moves_, other.part_moves_);
  std::swap(chosen_, other.chosen_);
  std::swap(gradient_, other.gradient_);
  std::swap(increment_, other.increment_);
  std::swap(before_, other.before_);
  std::swap(kernels_, other.kernels_);
  return *this;
}

const ConnectedParts& Averaging::parts(const Model& model, const History& history) {
  if (removed_ != history.removed) {
    removed_ = history.removed;
    parts_ = connected_parts(model.mesh, history.alive);
    of_part_.assign(parts_.count, Part{});
    for (int n = 0; n < model.mesh.num_nodes(); ++n) {
      node_weight_[n] = 0;
      for (const auto& [element, corner] : model.mesh.incident(n)) node_weight_[n] += history.alive[element];
      if (parts_.part_of_node[n] < 0) continue;
      Part& part = of_part_[parts_.part_of_node[n]];
      part.node = n;
      ++part.num_nodes;
    }
  }
  return parts_;
}

// Nodes in a fixed number of ranges, so that sums do not depend on threads.
template <class Add>
void Averaging::sum_over_nodes(const Add& add) {
  constexpr int kRanges = 16;
  const auto num_nodes = static_cast<Eigen::Index>(parts_.part_of_node.size());
  const std::size_t count = of_part_.size();
  partial_.resize(kRanges * count);
  parallel_for(kRanges, [&](int range) {
    Sums* const sums = partial_.data() + range * count;
    std::fill_n(sums, count, Sums{});
    for (Eigen::Index n = num_nodes * range / kRanges; n < num_nodes * (range + 1) / kRanges; ++n)
      if (const int part = parts_.part_of_node[n]; part >= 0) add(static_cast<int>(n), of_part_[part], sums[part]);
  });
  for (std::size_t part = 0; part < count; ++part) {
    Sums& all = of_part_[part].sums = {};
    for (std::size_t range = 0; range < kRanges; ++range) {
      const Sums& sums = partial_[range * count + part];
      all.field += sums.field;
      all.arms += sums.arms;
      all.spread += sums.spread;
    }
  }
}

void Averaging::remove_translation(PointArray& field) {
  sum_over_nodes([&](int n, const Part&, Sums& sums) { sums.field += field.row(n).transpose(); });
  parallel_for(static_cast<int>(field.rows()), [&](int n) {
    const int part = parts_.part_of_node[n];
    if (part < 0)
      field.row(n).setZero();
    else
      field.row(n) -= (of_part_[part].sums.field / of_part_[part].num_nodes).transpose();
  });
}

void Averaging::remove_rotation(PointArray& field, ConstPoints positions) {
  const auto arm = [&](int n, const Part& part) -> Vec3 {
    return (positions.row(n) - positions.row(part.node)).transpose();
  };
  sum_over_nodes([&](int n, const Part& part, Sums& sums) {
    const Vec3 r = arm(n, part);
    sums.arms += r;
    sums.spread += r * r.transpose();
    sums.field += r.cross(Vec3(field.row(n)));
  });
  for (Part& part : of_part_) {
    part.centre = part.sums.arms / part.num_nodes;
    const Mat3 spread = part.sums.spread - part.num_nodes * part.centre * part.centre.transpose();
    const Mat3 inertia = spread.trace() * Mat3::Identity() - spread;
    part.turn = inertia.ldlt().solve(part.sums.field);
  }
  parallel_for(static_cast<int>(field.rows()), [&](int n) {
    if (parts_.part_of_node[n] < 0) return;
    const Part& part = of_part_[parts_.part_of_node[n]];
    field.row(n) -= part.turn.cross(arm(n, part) - part.centre).transpose();
  });
}

void Averaging::step(const Model& model, LinearSolver& solver, History& history, AveragingReport& report) {
  const double E = kernels_->fit(model, history, true);
  const double size = std::accumulate(kernels_->size.begin(), kernels_->size.end(), 0.0);
  if (!(E > kFitted * size)) return;
  report.skipped = false;

  const Partition& partition = *model.partition;
  parallel_for(model.mesh.num_nodes(), [&](int n) {
    for (int i = 0; i < 3; ++i)
      gradient_(n, i) = kernels_->gradient()[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];
  });
  remove_translation(gradient_);  // they are rounding, and outside the range of H and P
  before_ = history.plastic_rest_positions;
  const auto move = [&](bool leaves_rotation) {
    remove_translation(increment_);
    if (leaves_rotation) remove_rotation(increment_, before_);
    history.plastic_rest_positions = before_ + increment_;
    ++history.version;
  };
  const auto solve = [&](const System& system) {
    const bool warm = history.averaging_increment.size() > 0;
    if (warm) increment_ = history.averaging_increment;
    const SolveReport solved =
        warm ? solver.solve_from_guess(system, gradient_, increment_) : solver.solve(system, gradient_, increment_);
    report.iterations += solved.iterations;
    report.residual = solved.residual;
    report.converged = report.converged && solved.converged;
    move(system.leaves_rotation());
    if (warm) history.averaging_increment = increment_;
  };

  solve(System(model, *this, true));
  if (kernels_->fit(model, history, false) > E) {
    // far from the fit the projected step may overshoot; the local/global step never raises E
    report.fell_back = true;
    history.plastic_rest_positions = before_;
    kernels_->fit(model, history, false);  // the maps that it starts from, and keeps
    solve(System(model, *this, false));
  }
}

/// The elements of the parts that move; the others have no part in E, nor in the increment to start from.
void Averaging::choose_elements(const Model& model, History& history, std::span<const unsigned char> changed) {
  const auto part_of = [&](int e) { return parts_.part_of_node[model.mesh.hexahedra()[e][0]]; };
  part_moves_.assign(parts_.count, changed.empty());
  for (std::size_t e = 0; e < changed.size(); ++e)
    if (changed[e] && history.alive[e]) part_moves_[part_of(static_cast<int>(e))] = 1;
  chosen_ = history.alive;
  if (std::find(part_moves_.begin(), part_moves_.end(), 0) != part_moves_.end()) {
    for (int e = 0; e < model.mesh.num_elements(); ++e)
      if (chosen_[e]) chosen_[e] = part_moves_[part_of(e)];
    for (int n = 0; n < history.averaging_increment.rows(); ++n)
      if (parts_.part_of_node[n] < 0 || !part_moves_[parts_.part_of_node[n]])
        history.averaging_increment.row(n).setZero();
  }
  if (kernels_->chosen != chosen_) kernels_->setup(model, chosen_);
}

AveragingReport Averaging::advance(const Model& model, LinearSolver& solver, History& history,
                                   std::span<const unsigned char> changed) {
  parts(model, history);
  choose_elements(model, history, changed);
  AveragingReport report;
  for (int step_number = 0; step_number < model.settings.averaging_steps; ++step_number)
    step(model, solver, history, report);
  return report;
}

}  // namespace hexaplast
