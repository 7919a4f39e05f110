// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/bar.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "hexaplast/geometry/grid.hpp"
#include "mesh/lumped_mass.hpp"

namespace hexaplast::bench {

namespace {

constexpr double kDensity = 1000;  // [kg/m^3]

std::array<int, 3> cells_of(const BarSettings& settings) { return settings.cells.value_or(cells_for(settings.size)); }

HexMesh make_mesh(const BarSettings& settings) {
  const std::array<int, 3> cells = cells_of(settings);
  const double h = kBarLength / cells[2];
  return regular_grid(cells, Vec3::Zero(), Vec3(cells[0] * h, cells[1] * h, kBarLength));
}

std::vector<Material> make_materials(const BarSettings& settings) {
  Material material{.young_modulus = settings.young_modulus, .poisson_ratio = settings.poisson_ratio};
  if (settings.mode == Mode::kElastic) return {material};
  material.flow_rate = 2;
  material.hardening = 0.2;
  // no stress gets near the one, every stress is above the other
  material.yield_stress = settings.mode == Mode::kPlastic ? 1e-6 : 1e12;
  if (settings.mode != Mode::kPlasticPart) return {material};
  const std::array<int, 3> cells = cells_of(settings);
  const int count = cells[0] * cells[1] * cells[2];
  std::vector<Material> materials(static_cast<std::size_t>(count), material);
  for (long e = 0; e < std::lround(count * kYieldingPart); ++e) materials[e].yield_stress = 1e-6;  // z is slowest
  return materials;
}

Settings make_settings(const BarSettings& settings) {
  Settings made = settings.element;
  made.precision = settings.precision;
  return made;
}

}  // namespace

std::string_view name(Mode mode) {
  switch (mode) {
    case Mode::kElastic:
      return "elastic";
    case Mode::kPlasticIdle:
      return "plastic_idle";
    case Mode::kPlasticPart:
      return "plastic_part";
    case Mode::kPlastic:
      return "plastic";
  }
  return "";
}

std::array<int, 3> cells_for(int size) {
  // a cross-section of a bit more than half the length
  const double even_length = std::cbrt(size / 0.35);
  const int length = std::max(2, static_cast<int>(16 * std::exp2(std::round(std::log2(even_length / 16)))));
  const int width = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(size) / length))));
  return {width, width, length};
}

Bar::Bar(const BarSettings& settings)
    : body_(make_mesh(settings), make_materials(settings), make_settings(settings)),
      masses_(kDensity * nodal_volumes(body_.mesh().positions(), body_.mesh().hexahedra())),
      x_(body_.mesh().positions()),
      v_(PointArray::Zero(x_.rows(), 3)) {
  body_.set_time_step(kBarDt);
  for (int n = 0; n < num_nodes(); ++n)
    if (x_(n, 2) == 0) fixed_.push_back(n);
  if (!settings.is_pressed) return;
  const std::array<int, 3> cells = cells_of(settings);
  const double h = kBarLength / cells[2], width = cells[0] * h, stiffness = 30 * settings.young_modulus / h;
  const Vec3 size(0.02, 1, 2 * kBarLength / 3);
  plate_.emplace(Solid::box(size),
                 ContactSettings{.stiffness = stiffness, .tangential_stiffness = stiffness, .friction = 0.3},
                 SurfaceSamples::on(body_.mesh(), {}, h / 2, 2));
  plate_pose_.position = {width + size.x() / 2 - 1e-3 * h, width / 2, kBarLength - 0.4 * size.z()};
}

Bar::Step Bar::step(LinearSolver& solver) {
  Step done;
  const auto begin = std::chrono::steady_clock::now();
  if (plate_) plate_->begin_step(x_, v_, kBarDt, plate_pose_, plate_pose_);
  done.solve = euler_.step(*this, solver, 0, kBarDt, x_, v_);
  if (plate_) plate_->end_step(x_);
  done.flow = body_.flow(x_, kBarDt);
  done.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  ++num_steps_;
  if (plate_) {
    done.contacts = plate_->num_touching();
    done.slipping = plate_->num_slipping();
  }
  return done;
}

PointArray Bar::increment(LinearSolver& solver) {
  PointArray x = x_, v = v_;
  if (plate_) plate_->begin_step(x_, v_, kBarDt, plate_pose_, plate_pose_);
  euler_.step(*this, solver, 0, kBarDt, x, v);
  return v - v_;
}

std::string Bar::hash() const {
  StateHash hash;
  const std::int64_t steps = num_steps_;
  hash.add(&steps, sizeof steps);
  hash.add(x_.data(), x_.size() * sizeof(double));
  hash.add(v_.data(), v_.size() * sizeof(double));
  body_.add_to(hash);
  return hash.text();
}

void Bar::compute_force(double, ConstPoints x, ConstPoints v, Points f) {
  body_.linearize(x);
  f.setZero();
  add_gravity(masses_, gravity(), f);
  body_.add_force(f);
  if (plate_) plate_->terms().add_force(x, v, f);
}

void Bar::add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  if (factors.mass != 0) df += factors.mass * masses_.asDiagonal() * dx;
  if (factors.stiffness == 0) return;
  body_.add_stiffness_product(factors.stiffness, dx, df);
  if (plate_) plate_->terms().add_stiffness_product(factors.stiffness, dx, df);
}

void Bar::add_blocks(const OperatorFactors& factors, BlockMatrix& A) const {
  for (int n = 0; n < num_nodes(); ++n) A.add(n, n, factors.mass * masses_[n] * Mat3::Identity());
  body_.add_stiffness_blocks(factors.stiffness, A);
  if (plate_) plate_->terms().add_stiffness_blocks(factors.stiffness, A);
}

bool Bar::add_operator(const OperatorFactors& factors, MatrixFreeSystem& system) const {
  system.diagonal.colwise() += factors.mass * masses_;
  body_.add_operator(factors.stiffness, system);
  if (plate_ && plate_->num_touching() > 0) {
    terms_.terms = &plate_->terms();
    system.others.emplace_back(&terms_, factors.stiffness);
  }
  return true;
}

bool Bar::release(double, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
                  Points product) {
  if (!plate_) return false;
  const auto add = [&](double sign) {
    released_.setZero(x.rows(), 3);
    plate_->terms().add_force(x, v, released_);
    force += sign * released_;
    plate_->terms().add_stiffness_product(sign, v, product);
  };
  add(-1);
  const bool has_released = plate_->release(x_end, v_end);
  add(1);
  return has_released;
}

void Bar::constrain(Constraints& constraints) const {
  for (const int n : fixed_) constraints.free.row(n).setZero();
}

double relative_error(const Eigen::VectorXd& masses, const PointArray& a, const PointArray& b) {
  const auto squared = [&](const PointArray& v) { return v.rowwise().squaredNorm().dot(masses); };
  return std::sqrt(squared(a - b) / squared(b));
}

}  // namespace hexaplast::bench
