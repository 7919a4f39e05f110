// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/moving_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <sstream>
#include <utility>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/saved_stream.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "loaded_body.hpp"
#include "mesh/lumped_mass.hpp"
#include "plastic/fracture.hpp"

namespace hexaplast {

std::vector<double> lumped_masses(const Body& body, double density) {
  std::vector<double> mass(static_cast<std::size_t>(body.mesh().num_elements()));
  for (std::size_t e = 0; e < mass.size(); ++e) mass[e] = density * body.initial_volume(static_cast<int>(e));
  const Eigen::VectorXd nodal = nodal_masses(body.mesh().num_nodes(), body.mesh().hexahedra(), mass);
  return {nodal.begin(), nodal.end()};
}

namespace {

void check(const Motion& motion, const Body& body) {
  for (const auto& [name, value] : {std::pair{"density", motion.density}, std::pair{"dt", motion.dt}})
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(fmt::format("{} = {}: must be a finite number greater than 0", name, value));
  if (!motion.gravity.allFinite()) throw InputError("gravity: must be finite");
  for (const auto& [name, value] : {std::pair{"rayleigh_mass", motion.euler.rayleigh_mass},
                                    std::pair{"rayleigh_stiffness", motion.euler.rayleigh_stiffness},
                                    std::pair{"velocity_damping", motion.euler.velocity_damping}})
    if (!(value >= 0 && std::isfinite(value)))
      throw InputError(fmt::format("{} = {}: must be a finite number not below 0", name, value));
  check_time_step(body.materials(), body.settings(), motion.dt);
}

constexpr SavedKind kSavedForces{{'H', 'X', 'P', 'F', 'O', 'R', 'C', '\0'}, 2, "set of forces"};
constexpr std::size_t kMaxSavedForces = std::size_t{1} << 32;
constexpr SavedKind kSavedMotion{{'H', 'X', 'P', 'M', 'O', 'V', 'E', '\0'}, 6, "motion"};

constexpr const char* kGiven[] = {
    "density",          "dt",          "gravity[0]", "gravity[1]", "gravity[2]", "rayleigh_mass", "rayleigh_stiffness",
    "velocity_damping", "first_order", "trapezoidal"};

/// What a motion is given besides its body, load and solver.
std::array<double, std::size(kGiven)> given(const Motion& motion) {
  const EulerSettings& euler = motion.euler;
  return {motion.density,
          motion.dt,
          motion.gravity.x(),
          motion.gravity.y(),
          motion.gravity.z(),
          euler.rayleigh_mass,
          euler.rayleigh_stiffness,
          euler.velocity_damping,
          euler.first_order ? 1.0 : 0.0,
          euler.trapezoidal ? 1.0 : 0.0};
}

/// Numbers of nodes and elements: what fits on them is for the body to say.
std::uint64_t identity_of(const Body& body) {
  return static_cast<std::uint64_t>(body.copies().num_initial()) << 32 |
         static_cast<std::uint32_t>(body.mesh().num_elements());
}

/// Throws InputError where forces cannot follow nodes that split.
void require_followers(const std::vector<StepForces*>& forces) {
  for (const StepForces* one : forces)
    if (const std::string reason = one->cannot_follow(); !reason.empty())
      throw InputError(fmt::format("MovingBody: joints cannot open: {}", reason));
}

enum Held : unsigned char {
  kFree,
  kFixed,
  kPrescribed  // fixed, and brought to its position by the velocity of the next step
};

}  // namespace

LoadedBody::LoadedBody(Body& body, const std::vector<double>& mass, std::vector<int> fixed, NodalLoad load,
                       const Vec3& gravity)
    : LayeredSystem(own_gravity_), own_gravity_(gravity) {
  const int num_nodes = body.mesh().num_nodes();
  require_count("LoadedBody", "mass", std::ssize(mass), num_nodes);
  state_.sized.resize(num_nodes, 3);
  masses_.masses = Eigen::Map<const Eigen::VectorXd>(mass.data(), num_nodes);
  set_body(body);
  load_.act = std::move(load);
  Layer& layer = layers_[add_state(state_)];
  layer.masses = {&masses_};
  layer.forces = {&elasticity_, &load_};
  fix(std::move(fixed));
}

void LoadedBody::fix(std::vector<int> nodes) {
  require_nodes("LoadedBody::fix", nodes, num_nodes());
  fixed_ = std::move(nodes);
}

void LoadedBody::constrain(Constraints& constraints) const {
  require_count("LoadedBody::constrain", "constraints", constraints.free.rows(), num_nodes());
  for (const int n : fixed_) constraints.free.row(n).setZero();
}

MovingBody::MovingBody(Body made, Motion motion, std::unique_ptr<LinearSolver> solver)
    : body(std::move(made)),
      positions(body.mesh().positions()),
      velocities(PointArray::Zero(positions.rows(), 3)),
      density_(motion.density),
      gravity_(motion.gravity),
      load_(motion.load),
      euler_(motion.euler),
      solver_(solver ? std::move(solver) : std::make_unique<CholeskySolver>()),
      dt_(motion.dt),
      settings_(motion.euler),
      given_(given(motion)),
      held_(static_cast<std::size_t>(positions.rows()), kFree) {
  check(motion, body);
  body.set_time_step(dt_);
  take_nodes();
  fix(motion.fixed);
}

void MovingBody::take_nodes() {
  mass_ = lumped_masses(body, density_);
  system_ = std::make_unique<LoadedBody>(body, mass_, std::vector<int>{}, load_, gravity_);
  for (StepForces* forces : forces_) system_->add(*forces);
  tell_fixed();
}

MovingBody::MovingBody(MovingBody&&) noexcept = default;
MovingBody& MovingBody::operator=(MovingBody&&) noexcept = default;
MovingBody::~MovingBody() = default;

std::vector<int> MovingBody::open(std::span<const int> joints, std::span<const double> crossings) {
  require_followers(forces_);
  require_rows("MovingBody", "positions", positions, body.mesh().num_nodes());
  require_rows("MovingBody", "velocities", velocities, body.mesh().num_nodes());
  std::vector<int> parents = body.open(joints, crossings);
  if (parents.empty()) return parents;
  append_rows(parents, positions);
  append_rows(parents, velocities);
  append_rows(parents, held_);
  if (PointArray& start = euler_.memory().start; start.rows() > 0) append_rows(parents, start);
  euler_.memory().radii.clear();  // those of another matrix, whatever it has in common with the next
  take_nodes();
  for (StepForces* forces : forces_) forces->nodes_changed(0, body.copies(), parents);
  return parents;
}

/// Others than the motion may have opened, reset or loaded its body.
void MovingBody::require_own_nodes() const {
  if (std::ssize(held_) != body.mesh().num_nodes())
    throw InputError("MovingBody: the nodes of the body are others: open, load and reset the motion, not its body");
}

FlowReport MovingBody::step() {
  require_own_nodes();
  require_rows("MovingBody", "positions", positions, body.mesh().num_nodes());
  require_rows("MovingBody", "velocities", velocities, body.mesh().num_nodes());
  if (may_tear(body.materials(), body.settings())) require_followers(forces_);
  positions_before_ = positions;
  velocities_before_ = velocities;
  memory_before_ = euler_.memory();
  forces_before_.clear();
  Archive remembered([this](const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    forces_before_.insert(forces_before_.end(), bytes, bytes + size);
  });
  for (StepForces* forces : forces_) forces->serialize(remembered);
  system_->set_body(body);  // which may have moved together with this
  for (std::size_t n = 0; n < held_.size(); ++n)
    if (held_[n] == kFixed) velocities.row(static_cast<Eigen::Index>(n)).setZero();
  // a step of first order does not begin from velocities: the nodes are there when its forces are computed
  for (std::size_t n = 0; n < held_.size() && settings_.first_order; ++n)
    if (const auto row = static_cast<Eigen::Index>(n); held_[n] == kPrescribed)
      positions.row(row) += dt_ * velocities.row(row);
  FlowReport flowed;
  try {
    const Step beginning{.time = time(), .dt = dt_, .rayleigh_stiffness = settings_.rayleigh_stiffness};
    for (StepForces* forces : forces_) forces->begin_step(beginning, positions, velocities);
    const SolveReport solved = euler_.step(*system_, *solver_, time(), dt_, positions, velocities);
    for (StepForces* forces : forces_) forces->end_step(positions);
    flowed = body.flow(positions, dt_);  // last: it is not taken back
    latest = solved;
    ++steps_;
    arrive();
  } catch (...) {
    positions = positions_before_;
    velocities = velocities_before_;
    euler_.memory() = memory_before_;
    Archive archive{std::span<const std::byte>(forces_before_)};
    for (StepForces* forces : forces_) forces->serialize(archive);
    throw;
  }
  if (!flowed.torn.empty()) open(flowed.torn);
  return flowed;
}

void RunReport::add(const SolveReport& solved, const FlowReport& flowed) {
  const auto raise = [](auto& to, auto value) { to = std::max(to, value); };
  ++steps;
  stalled += !solved.converged || !flowed.averaging.converged;
  raise(solve.iterations, solved.iterations);
  raise(solve.residual, solved.residual);
  solve.converged = solve.converged && solved.converged;
  if (solved.iterations > 0) solve.preconditioner = solved.preconditioner;

  raise(flow.yielded, flowed.yielded);
  raise(flow.inverted, flowed.inverted);
  raise(flow.skipped, flowed.skipped);
  raise(flow.repaired, flowed.repaired);
  raise(flow.rolled_back, flowed.rolled_back);
  flow.removed += flowed.removed;
  flow.torn.insert(flow.torn.end(), flowed.torn.begin(), flowed.torn.end());
  raise(flow.worst_volume_error, flowed.worst_volume_error);
  flow.averaging.skipped = flow.averaging.skipped && flowed.averaging.skipped;
  flow.averaging.fell_back = flow.averaging.fell_back || flowed.averaging.fell_back;
  raise(flow.averaging.iterations, flowed.averaging.iterations);
  raise(flow.averaging.residual, flowed.averaging.residual);
  flow.averaging.converged = flow.averaging.converged && flowed.averaging.converged;
}

RunReport MovingBody::run(int steps) {
  RunReport report;
  for (int k = 0; k < steps; ++k) {
    const FlowReport flowed = step();
    report.add(latest, flowed);
  }
  return report;
}

void MovingBody::fix(std::span<const int> nodes) {
  require_own_nodes();
  require_nodes("MovingBody", nodes, body.mesh().num_nodes());
  require_rows("MovingBody", "velocities", velocities, body.mesh().num_nodes());
  for (const int n : nodes) {
    held_[n] = kFixed;
    velocities.row(n).setZero();
  }
  tell_fixed();
}

// Constraints zero the change of a velocity, so that a fixed node moves by the one it has; in first order, `step` moves
// it.
void MovingBody::prescribe(std::span<const int> nodes, ConstPoints target) {
  if (target.rows() != static_cast<Eigen::Index>(nodes.size()))
    throw InputError(fmt::format("{} positions are given for {} nodes", target.rows(), nodes.size()));
  if (!target.allFinite()) throw InputError("a position is not finite");
  require_rows("MovingBody", "positions", positions, body.mesh().num_nodes());
  fix(nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    held_[nodes[i]] = kPrescribed;
    velocities.row(nodes[i]) = (target.row(static_cast<Eigen::Index>(i)) - positions.row(nodes[i])) / dt_;
  }
}

void MovingBody::release(std::span<const int> nodes) {
  require_own_nodes();
  require_nodes("MovingBody", nodes, body.mesh().num_nodes());
  require_rows("MovingBody", "velocities", velocities, body.mesh().num_nodes());
  for (const int n : nodes) {
    if (held_[n] == kPrescribed) velocities.row(n).setZero();  // which was to bring it to its position
    held_[n] = kFree;
  }
  tell_fixed();
}

std::vector<unsigned char> MovingBody::fixed() const {
  std::vector<unsigned char> all(held_.size());
  std::ranges::transform(held_, all.begin(), [](unsigned char how) { return how != kFree; });
  return all;
}

void MovingBody::add(StepForces& forces) {
  if (settings_.first_order || settings_.trapezoidal)
    throw InputError("MovingBody: other forces need implicit Euler, neither of first order nor trapezoidal");
  if (body.copies().is_split()) {
    if (const std::string reason = forces.cannot_follow(); !reason.empty())
      throw InputError(fmt::format("MovingBody: joints are open: {}", reason));
    forces.nodes_changed(0, body.copies(), {});
  }
  forces_.push_back(&forces);
  system_->add(forces);
}

void MovingBody::reset() {
  held_.resize(static_cast<std::size_t>(body.copies().num_initial()));
  body.reset();
  for (StepForces* forces : forces_) {
    forces->nodes_changed(0, body.copies(), {});
    forces->reset();
  }
  euler_.memory().reset();
  positions = body.mesh().positions();
  velocities = PointArray::Zero(positions.rows(), 3);
  arrive();
  if (mass_.size() != held_.size()) take_nodes();
  latest = {};
  steps_ = 0;
}

void MovingBody::arrive() {
  for (std::size_t n = 0; n < held_.size(); ++n) {
    if (held_[n] != kPrescribed) continue;
    velocities.row(static_cast<Eigen::Index>(n)).setZero();
    held_[n] = kFixed;
  }
}

void MovingBody::save(std::ostream& out) const {
  write_saved(out, kSavedMotion, identity_of(body), [&](Archive& archive) {
    auto own = given_;
    PointArray x = positions, v = velocities;
    long steps = steps_;
    std::vector<unsigned char> held = held_;
    SolverMemory memory = euler_.memory();
    archive(own, x, v, steps, held);
    memory.serialize(archive);
  });
  body.save(out);
  save_forces(out);
}

void MovingBody::save_forces(std::ostream& out) const {
  if (forces_.empty()) return;
  write_saved(out, kSavedForces, forces_.size(), [&](Archive& archive) {
    for (StepForces* forces : forces_) forces->serialize(archive);
  });
}

void MovingBody::load_forces(std::istream& in) {
  if (forces_.empty()) return;
  const std::vector<std::byte> bytes = read_saved(in, kSavedForces, forces_.size(), kMaxSavedForces);
  Archive archive{std::span<const std::byte>(bytes)};
  for (StepForces* forces : forces_) {
    if (const std::string reason = forces->cannot_follow(); body.copies().is_split() && !reason.empty())
      throw InputError(fmt::format("the saved motion has open joints: {}", reason));
    forces->nodes_changed(0, body.copies(), {});
    forces->serialize(archive);
  }
  if (archive.rest() != 0) throw InputError("the saved forces are others");
}

void MovingBody::load(std::istream& in) {
  const auto num_nodes = static_cast<std::size_t>(body.copies().num_initial() + kCorners * body.mesh().num_elements());
  const std::size_t max = 64 + sizeof given_ + sizeof(SpectralRadii) + num_nodes * (9 * sizeof(double) + 1);
  const std::vector<std::byte> bytes = read_saved(in, kSavedMotion, identity_of(body), max);
  Archive archive{std::span<const std::byte>(bytes)};
  PointArray x, v;
  long steps = 0;
  std::vector<unsigned char> held;
  SolverMemory memory;
  auto saved = given_;
  archive(saved);
  for (std::size_t k = 0; k < saved.size(); ++k)
    if (saved[k] != given_[k])
      throw InputError(fmt::format("the saved motion has another {}: {}, must be {}", kGiven[k], saved[k], given_[k]));
  archive(x, v, steps, held);
  memory.serialize(archive);
  const auto has_all = [&](const PointArray& field) { return field.rows() == x.rows() && field.allFinite(); };
  if (!has_all(x) || !has_all(v) || !(memory.start.rows() == 0 || has_all(memory.start)) || !memory.is_valid() ||
      steps < 0 || std::ssize(held) != x.rows() || archive.rest() != 0 ||
      std::ranges::any_of(held, [](unsigned char how) { return how > kPrescribed; }))
    throw InputError("the saved motion is of another body");
  std::stringstream before;
  body.save(before);
  save_forces(before);
  body.load(in);
  try {
    if (x.rows() != body.mesh().num_nodes()) throw InputError("the saved motion is of another body");
    load_forces(in);  // by the hexahedra that are left
  } catch (const InputError&) {
    body.load(before);
    load_forces(before);
    throw;
  }

  positions = x;
  velocities = v;
  euler_.memory() = std::move(memory);
  steps_ = steps;
  latest = {};
  held_ = std::move(held);
  take_nodes();
}

void MovingBody::tell_fixed() {
  system_->set_body(body);  // which may have moved together with this
  std::vector<int> fixed;
  for (int n = 0; n < body.mesh().num_nodes(); ++n)
    if (held_[n] != kFree || mass()[n] == 0) fixed.push_back(n);
  system_->fix(std::move(fixed));
}

std::string MovingBody::state_hash() const {
  StateHash hash;
  hash.add(positions.data(), positions.size() * sizeof(double));
  hash.add(velocities.data(), velocities.size() * sizeof(double));
  body.add_to(hash);
  return hash.text();
}

}  // namespace hexaplast
