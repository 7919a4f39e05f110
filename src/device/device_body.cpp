// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device/device_body.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "element/samples.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "mesh/trilinear.hpp"
#include "plastic/fracture.hpp"
#include "plastic/isolated_flow.hpp"
#include "solve/constants.hpp"
#include "solve/spectrum.hpp"

namespace hexaplast {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<DeviceKernels> load(const std::string& name) {
  if (name != "cuda" && name != "emulation")
    throw InputError(fmt::format("device {}: must be cpu, cuda or emulation", name));
  Dl_info here{};
  ::dladdr(reinterpret_cast<void*>(&not_on_device), &here);
  const fs::path file =
      fs::absolute(here.dli_fname ? here.dli_fname : "").parent_path() / "hexaplast" / ("hexaplast_" + name + ".so");
  const auto refuse = [&](const std::string& why) { return InputError(fmt::format("device {}: {}", name, why)); };
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // for the life of the process
  if (!library)
    throw refuse(fmt::format("its library cannot be loaded (docs/gpu.md says how it is built): {}", ::dlerror()));
  void* const entry = ::dlsym(library, HEXAPLAST_DEVICE_ENTRY);
  DeviceKernels* kernels = nullptr;
  try {
    if (entry) kernels = reinterpret_cast<DeviceKernels* (*)(int)>(entry)(kDeviceVersion);
  } catch (const std::runtime_error& error) {
    throw refuse(error.what());
  }
  if (!kernels) throw refuse(file.string() + " belongs to another version of Hexaplast");
  return std::unique_ptr<DeviceKernels>(kernels);
}

constexpr double kOfBlocks = 1e-12;  ///< of a product at a node, that one by blocks may differ: rounding

/// [-] Corner ratio below which springs may act, in single precision.
float thin_from(const Model& model) {
  const double from = Recovery::from(model.settings);
  return static_cast<float>(from + 1e-4);
}

/// to, four numbers per node of the device, = scale field.
template <class T>
void to_nodes(const Bricks& bricks, ConstPoints field, double scale, std::vector<T>& to) {
  to.resize(4 * static_cast<std::size_t>(bricks.num_nodes()), T(0));
  parallel_for(bricks.num_nodes(), [&](int n) {
    for (int i = 0; i < 3; ++i)
      to[4 * static_cast<std::size_t>(n) + i] = static_cast<T>(scale * field(bricks.node_of[n], i));
  });
}

/// add(entry of the field, number) for all.
template <class Add>
void from_nodes(const Bricks& bricks, const std::vector<float>& from, Points field, const Add& add) {
  parallel_for(bricks.num_nodes(), [&](int n) {
    for (int i = 0; i < 3; ++i)
      add(field(bricks.node_of[n], i), static_cast<double>(from[4 * static_cast<std::size_t>(n) + i]));
  });
}

/// visit(k, number) for all numbers of the history of a hexahedron.
template <class Visit>
void visit_history(History& history, int e, const Visit& visit) {
  static const CornerTensors none = [] {
    CornerTensors one;
    one.fill(Mat3::Identity());
    return one;
  }();
  CornerTensors identity = none;
  CornerTensors& G = history.plastic_inverse.empty() ? identity : history.plastic_inverse[e];
  for (int k = 0; k < 9; ++k)
    for (int i = 0; i < kCorners; ++i) visit(kCorners * k + i, G[i](k / 3, k % 3));
  for (int i = 0; i < kCorners; ++i) visit(9 * kCorners + i, history.yield_stress[e][i]);
  for (int i = 0; i < kCorners; ++i) visit(10 * kCorners + i, history.plastic_strain[e][i]);
}

/// Where that number of a place is among all.
std::size_t history_index(int num_bricks, int place, int k) {
  const std::size_t lanes = static_cast<std::size_t>(num_bricks) * kBrick;
  if (k < 9 * kCorners) return Bricks::index(place, 9 * kCorners, k);
  return (k < 10 * kCorners ? 9 : 10) * kCorners * lanes + Bricks::index(place, kCorners, k % kCorners);
}

}  // namespace

std::string not_on_device(const Model& model) {
  const Settings& settings = model.settings;
  if (model.is_plain) return "implementation, or what only the plain implementation has: the default element is needed";
  if (settings.precision != Precision::kMixed) return "precision must be mixed";
  if (settings.bending != Bending::kAssumedCorner || settings.volumetric != Volumetric::kVolumeRatio)
    return "bending and volumetric must be those of the default element";
  if (settings.law != ElasticLaw::kCorotated) return "law must be corotated";
  if (settings.rest_shape != RestShape::kIsolated) return "restShape must be isolated";
  if (settings.yield_norm != YieldNorm::kVonMises && model.can_flow()) return "yieldNorm must be vonMises";
  if (settings.num_branches() > 0) return "relaxation must be empty";
  for (std::size_t e = 0; e < model.volume.size(); ++e) {
    if (model.is_thin()[e])
      return fmt::format("hexahedron {} is so thin that its coefficients leave half precision", e);
    if (!is_parallelepiped(gather(model.mesh.positions(), model.mesh.hexahedra()[e])))
      return fmt::format("hexahedron {} is no parallelepiped", e);
  }
  return {};
}

DeviceBody::DeviceBody(const Model& of, History& its_history, const std::vector<BranchStep>& its_branches,
                       std::string name)
    : KernelBackend(of, its_history, its_branches),
      name_(std::move(name)),
      kernels_(load(name_)),
      space_(*kernels_, bricks_) {}

void DeviceBody::renew() {
  KernelBackend::renew();
  forget();
}

void DeviceBody::set_up(ConstPoints x) {
  if (!is_set_up_) {
    bricks_ = Bricks(model, history);
    try {
      kernels_->set_bricks(bricks_.arrays());
    } catch (const std::runtime_error& error) {
      throw InputError(fmt::format("device {}: {} hexahedra: {}", name_, model.mesh.num_elements(), error.what()));
    }
    const int places = static_cast<int>(bricks_.element.size());
    numbers_.resize(static_cast<std::size_t>(places) * kHistoryNumbers);
    parallel_for(places, [&](int place) {
      visit_history(history, bricks_.like(place),
                    [&](int k, double& number) { numbers_[history_index(bricks_.num_bricks(), place, k)] = number; });
    });
    kernels_->set_history(numbers_.data());
    status_.resize(places);
    can_break_ = std::ranges::any_of(model.materials, [](const Material& material) {
      return std::isfinite(std::min(material.fracture_stress, material.fracture_stretch));
    });
    is_set_up_ = true;
    has_newer_history_ = false;
  }
  to_nodes(bricks_, x, 1, positions_);
  kernels_->set_positions(positions_.data());
}

void DeviceBody::download() {
  if (!has_newer_history_) return;
  kernels_->get_history(numbers_.data());
  parallel_for(static_cast<int>(bricks_.element.size()), [&](int place) {
    const int e = bricks_.element[place];
    if (e < 0 || !history.alive[e]) return;
    visit_history(history, e,
                  [&](int k, double& number) { number = numbers_[history_index(bricks_.num_bricks(), place, k)]; });
    if (!history.has_flowed.empty()) history.has_flowed[e] = is_flowed(history.plastic_inverse[e]);
  });
  has_newer_history_ = false;
}

void DeviceBody::linearize(ConstPoints x) {
  set_up(x);
  at.recovery = Recovery();
  if (kernels_->linearize(thin_from(model)) == 0) return;
  download();
  at.recovery = KernelBackend::find_recovery(x);
}

void DeviceBody::add_force(Points f) const {
  product_.resize(4 * static_cast<std::size_t>(bricks_.num_nodes()));
  kernels_->get_force(product_.data());
  from_nodes(bricks_, product_, f, [](double& entry, double number) { entry += number; });
  at.recovery.add_force(f);
}

void DeviceBody::multiply(double factor, ConstPoints p, Points Ap) const {
  const double scale = scale_to_one(std::sqrt(dot(p, p)));
  to_nodes(bricks_, p, scale, field_);
  product_.resize(field_.size());
  kernels_->multiply(1, field_.data(), product_.data());
  from_nodes(bricks_, product_, Ap, [&](double& entry, double number) { entry += factor / scale * number; });
}

void DeviceBody::add_product(double factor, ConstPoints dx, Points df) const {
  multiply(-factor, dx, df);
  at.recovery.add_product(-factor, dx, df);
}

void DeviceBody::add_stiffness_blocks(double, BlockMatrix&) const {
  throw InputError(
      "a body on a device (attribute device) has no matrix: its solver must be one of conjugate gradients");
}

void DeviceBody::add_operator(double factor, MatrixFreeSystem& system) {
  if (at.recovery.acts()) system.others.emplace_back(&at.recovery, -factor);
  KernelBody& body = system.bodies.emplace_back();
  body.factor = -factor;
  body.device = this;
}

double DeviceBody::energy(ConstPoints x) {
  set_up(x);
  const DeviceKernels::Sums sums = kernels_->energy(thin_from(model));
  if (sums.first == 0) return sums.value;
  download();
  return KernelBackend::energy(x);
}

const Recovery& DeviceBody::find_recovery(ConstPoints x) {
  static const Recovery none;
  set_up(x);
  if (kernels_->energy(thin_from(model)).first == 0) return none;
  download();
  return KernelBackend::find_recovery(x);
}

FlowReport DeviceBody::flow(ConstPoints x, double dt) {
  set_up(x);
  FlowReport report;
  const Settings& settings = model.settings;
  const DeviceKernels::Sums sums =
      kernels_->flow(static_cast<float>(dt), static_cast<float>(settings.inversion_threshold),
                     settings.yield_stress_measure == YieldStressMeasure::kCauchy);
  report.yielded = sums.second;
  double dissipated = sums.value;
  near_limit_.clear();
  if (sums.first > 0 || can_break_) kernels_->get_status(status_.data());
  if (sums.first > 0) dissipated += flow_left_over(x, dt, report);
  if (report.yielded == 0) return report;
  for (std::size_t place = 0; can_break_ && place < status_.size(); ++place) {
    const int e = bricks_.element[place];
    if (!(status_[place] & kMayBreak) || e < 0 || !history.alive[e]) continue;
    take_hexahedron(static_cast<int>(place));
    near_limit_.push_back({e, history.yield_stress[e]});
  }
  kernels_->take_flow();
  has_newer_history_ = true;
  ++history.version;
  history.dissipated_energy += dissipated;
  if (!near_limit_.empty()) break_hexahedra(x, report);
  return report;
}

/// Brings the history of one to the host, that of the others has not come.
void DeviceBody::take_hexahedron(int place) {
  double numbers[kHistoryNumbers];
  has_newer_history_ = true;
  kernels_->get_hexahedron(place, numbers);
  visit_history(history, bricks_.element[place], [&](int k, double& number) { number = numbers[k]; });
}

/// Those that have passed their limits go, or tear.
void DeviceBody::break_hexahedra(ConstPoints x, FlowReport& report) {
  std::vector<int> broken;
  for (const auto& [e, tau_before] : near_limit_) {
    take_hexahedron(bricks_.place_of[e]);
    if (is_broken(model, tau_before, history, e)) broken.push_back(e);
  }
  if (broken.empty()) return;
  std::ranges::sort(broken);
  download();
  if (tear()) {
    tear()->broken = broken;
    report.torn = torn_faces(x);
    return;
  }
  for (const int e : broken) {
    history.alive[e] = 0;
    history.removed.push_back(e);
  }
  report.removed = static_cast<int>(broken.size());
  forget();
}

/// What the kernels leave over: inverted hexahedra, nearly inverted ones, and those of more flow than their series
/// reaches.
double DeviceBody::flow_left_over(ConstPoints x, double dt, FlowReport& report) {
  double dissipated = 0;
  for (std::size_t place = 0; place < status_.size(); ++place) {
    const int e = bricks_.element[place];
    if (!(status_[place] & kIsLeft) || e < 0 || !history.alive[e]) continue;
    if (model.can_flow()) take_hexahedron(static_cast<int>(place));
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const ElementSamples samples = element_samples(gather(model.mesh.positions(), corners), gather(x, corners),
                                                   model.lame[e], model.settings, history.plastic_inverse_of(e));
    const IsolatedStep step = isolated_step(model, e, samples, history, dt);
    report.inverted += step.inverted;
    report.skipped += step.skipped;
    if (!step.yielded) continue;
    ++report.yielded;
    dissipated += step.dissipated;
    if (can_break_) near_limit_.push_back({e, history.yield_stress[e]});
    set_isolated(e, step, history);
    if (!history.is_finite(e) || !std::isfinite(step.dissipated))
      throw NumericalError(fmt::format("the plastic history of hexahedron {} is not finite", e));
    double numbers[kHistoryNumbers];
    visit_history(history, e, [&](int k, double& number) { numbers[k] = number; });
    kernels_->set_hexahedron(static_cast<int>(place), numbers);
  }
  return dissipated;
}

CgSpace& DeviceBody::space(const MatrixFreeSystem& system, const NodalPart* of_preconditioner) {
  space_.setup(system, of_preconditioner);
  return space_;
}

bool DeviceBody::has_coarse_meshes() const {
  const std::size_t below = model.coarse_meshes().size();
  return below > 0 && below < SpectralRadii::kMaxLevels;
}

std::optional<bool> DeviceBody::use_cycles(bool always, SpectralRadii& radii) {
  if (!has_coarse_meshes() || (!always && !space_.is_stiff())) return {};
  if (!levels_) {
    levels_.emplace(model, history, bricks_);
    try {
      kernels_->set_levels(levels_->arrays().data(), levels_->count());
    } catch (const std::runtime_error& error) {
      levels_.reset();
      throw InputError(fmt::format("device {}: multigrid: {}", name_, error.what()));
    }
  }
  return space_.use_cycles(*levels_, radii);
}

void DeviceCgSpace::setup(const MatrixFreeSystem& system, const NodalPart* of_preconditioner) {
  others_ = system.others;
  is_scaled_ = of_preconditioner != nullptr;
  free_ = system.constraints.free.cast<double>();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  field_ = (free_.array() > 0).select(is_scaled_ ? of_preconditioner->diagonal : system.diagonal, kInfinite);
  to_nodes(bricks_, system.diagonal, 1, first_);
  to_nodes(bricks_, field_, 1, second_);
  const double factor = system.bodies.front().factor;
  stiffness_ = kernels_.set_system(static_cast<float>(factor), first_.data(), second_.data(), is_scaled_,
                                   static_cast<float>(kBreakEven));
  has_cycles_ = false;
  if (is_scaled_ && !of_preconditioner->blocks.empty()) set_blocks(of_preconditioner->blocks);
  has_terms_ = set_terms();
  of_system_ = {.num_solves = 1,
                .factor = factor,
                .diagonal = system.diagonal.sum(),
                .stiffness = stiffness_.all,
                .num_free = system.constraints.free.cast<std::int64_t>().sum()};
}

void DeviceCgSpace::set_blocks(std::span<const NodeBlock> blocks) {
  const int count = static_cast<int>(blocks.size());
  std::vector<int> nodes;
  for (const NodeBlock& block : blocks) nodes.push_back(bricks_.device_node[block.node]);
  first_.resize(4 * blocks.size());
  kernels_.get_diagonal(nodes.data(), count, first_.data());
  std::vector<BlockEntry> entries;
  for (int k = 0; k < count; ++k) {
    Vec3 D;
    for (int i = 0; i < 3; ++i) {
      const double entry = first_[4 * static_cast<std::size_t>(k) + i];
      D[i] = std::isfinite(entry) ? std::max(entry, 0.0) : 0;
    }
    const auto along = SlotBlocks<float>::entry_of(0, D, blocks[k].block);
    BlockEntry& to = entries.emplace_back();
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        to.axes[3 * i + axis] = along.axes(i, axis);
        to.dual[3 * i + axis] = along.dual(i, axis);
      }
      to.stiffness[i] = along.stiffness[i];
      to.inverse[i] = along.inverse[i];
      to.rigid[i] = along.rigid[i];
      to.loss[i] = along.loss[i];
      to.alone[i] = blocks[k].block.row(i).isZero(0) ? 1 : 0;
    }
  }
  kernels_.set_blocks(nodes.data(), entries.data(), count);
}

/// The terms beside the body become a matrix of the kernels, unless they have no blocks for all that their product
/// does, by nodes.
bool DeviceCgSpace::set_terms() {
  if (others_.empty()) return false;
  const int num_nodes = bricks_.num_nodes();
  if (terms_.num_nodes() != num_nodes) terms_ = BlockMatrix(num_nodes);
  terms_.clear();
  for (const NodalTerm& other : others_) other.op->add_blocks(other.factor, terms_);
  terms_.drop_unused();
  if (terms_.leaves_out()) return false;
  field_ = irregular_numbers(num_nodes);
  product_.setZero(num_nodes, 3);
  for (const NodalTerm& other : others_) other.add_product(field_, product_);
  std::vector<int> nodes, first = {0}, column;
  std::vector<double> blocks;
  for (int k = 0; k < num_nodes; ++k) {
    const int n = bricks_.node_of[k];
    double size = 0;
    for (const BlockMatrix::Entry& entry : terms_.row(n)) {
      product_.row(n) -= field_.row(entry.column) * entry.block.transpose();
      size += entry.block.norm() * field_.row(entry.column).norm();
      column.push_back(bricks_.device_node[entry.column]);
      for (int i = 0; i < 9; ++i) blocks.push_back(entry.block(i / 3, i % 3));
    }
    if (!(product_.row(n).norm() <= kOfBlocks * size)) return false;
    if (terms_.row(n).empty()) continue;
    nodes.push_back(k);
    first.push_back(static_cast<int>(column.size()));
  }
  if (!nodes.empty())
    kernels_.set_terms(static_cast<int>(nodes.size()), nodes.data(), first.data(), column.data(), blocks.data());
  return true;
}

namespace {

class LanczosOnDevice final : public LanczosSpace {
 public:
  LanczosOnDevice(DeviceKernels& kernels, int level, int num_nodes)
      : kernels_(kernels), level_(level), num_nodes_(num_nodes) {}
  double start() override {
    std::vector<float> first(4 * static_cast<std::size_t>(num_nodes_));
    IrregularNumbers number;
    for (float& entry : first) entry = number();
    return kernels_.start_lanczos(level_, first.data());
  }
  double multiply(double scale) override {
    scale_ = static_cast<float>(scale);
    return kernels_.multiply_lanczos(level_, scale_);
  }
  double advance(double along, double before) override {
    return kernels_.advance_lanczos(level_, scale_, static_cast<float>(along), static_cast<float>(before));
  }

 private:
  DeviceKernels& kernels_;
  int level_, num_nodes_;
  float scale_ = 1;
};

}  // namespace

bool DeviceCgSpace::use_cycles(const DeviceLevels& below, SpectralRadii& radii) {
  has_cycles_ = true;
  of_system_.num_levels = below.count() + 1;
  const bool are_known = radii.is_valid_for(of_system_);
  if (are_known) {
    ++radii.num_solves;
  } else {  // without other terms, as Multigrid finds them
    kernels_.prepare_cycles(false);
    radii = of_system_;
    find_radii_of_meshes(
        of_system_.num_levels,
        [&](int k) { return LanczosOnDevice(kernels_, k, k == 0 ? bricks_.num_nodes() : below.num_nodes(k - 1)); },
        [&](int k, double radius) { radii.of_level[k] = radius; });
  }
  if (are_known || !others_.empty()) kernels_.prepare_cycles(true);
  for (int k = 0; k <= below.count(); ++k) {
    const bool is_coarsest = k == below.count();
    std::vector<ChebyshevStep> steps;
    for_each_chebyshev_step(radii.of_level[k], is_coarsest ? kCoarsestFraction : kSmoothedFraction,
                            is_coarsest ? kCoarsestDegree : kSmoothing, [&](double a, double b) {
                              steps.push_back({static_cast<float>(a), static_cast<float>(b)});
                            });
    kernels_.set_smoother(k, steps.data(), static_cast<int>(steps.size()));
  }
  return are_known;
}

double DeviceCgSpace::begin(ConstPoints b, const ConstPoints* start) {
  scale_ = scale_to_one(std::sqrt(dot(b, b)));
  field_ = b.cwiseProduct(free_);
  to_nodes(bricks_, field_, scale_, first_);
  if (start) {
    field_ = start->cwiseProduct(free_);
    to_nodes(bricks_, field_, scale_, second_);
  }
  norms_ = kernels_.start(first_.data(), start ? second_.data() : nullptr);
  if (start) {  // x as the first direction, of length 1
    product(true, 0);
    norms_ = kernels_.advance(1);
  }
  return unscaled(norms_.r_r);
}

double DeviceCgSpace::product(bool has_direction, double beta) {
  if (others_.empty() || has_terms_) return unscaled(kernels_.product(has_direction, beta, nullptr));
  first_.resize(4 * static_cast<std::size_t>(bricks_.num_nodes()));
  if (has_direction)
    first_ = second_;
  else
    kernels_.set_direction(beta, first_.data());
  field_.resize(bricks_.num_nodes(), 3);
  from_nodes(bricks_, first_, field_, [](double& entry, double number) { entry = number; });
  product_.setZero(bricks_.num_nodes(), 3);
  for (const NodalTerm& other : others_) other.add_product(field_, product_);
  to_nodes(bricks_, product_, 1, first_);
  return unscaled(kernels_.product(true, 0, first_.data()));
}

double DeviceCgSpace::advance(double alpha) {
  norms_ = kernels_.advance(alpha);
  return unscaled(norms_.r_r);
}

void DeviceCgSpace::end(Points x) const {
  first_.resize(4 * static_cast<std::size_t>(bricks_.num_nodes()));
  kernels_.get_solution(first_.data());
  from_nodes(bricks_, first_, x, [&](double& entry, double number) { entry = number / scale_; });
}

void DeviceCgSpace::find_diagonal(double factor, Points diagonal) {
  first_.assign(4 * static_cast<std::size_t>(bricks_.num_nodes()), 0);
  kernels_.set_system(static_cast<float>(factor), first_.data(), first_.data(), true, static_cast<float>(kBreakEven));
  std::vector<int> all(bricks_.num_nodes());
  std::iota(all.begin(), all.end(), 0);
  kernels_.get_diagonal(all.data(), bricks_.num_nodes(), first_.data());
  from_nodes(bricks_, first_, diagonal, [](double& entry, double number) { entry = number; });
}

void DeviceCgSpace::add_preconditioned(ConstPoints r, Points z) {
  begin(r, nullptr);
  precondition();
  kernels_.set_direction(0, first_.data());
  from_nodes(bricks_, first_, z, [&](double& entry, double number) { entry += number / scale_; });
}

void DeviceCgSpace::residual(Points r) const {
  first_.resize(4 * static_cast<std::size_t>(bricks_.num_nodes()));
  kernels_.get_residual(first_.data());
  from_nodes(bricks_, first_, r, [&](double& entry, double number) { entry = number / scale_; });
}

}  // namespace hexaplast
