// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <locale>
#include <numeric>
#include <optional>
#include <sstream>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "scene/interfaces.hpp"
#include "solve/loads.hpp"

namespace hexaplast::components {
namespace {

scene::RigidState& frames_of(scene::Component& component) {
  auto* state = dynamic_cast<scene::RigidState*>(component.node().nearest<scene::State>());
  if (!state) component.reject("needs rigid frames: a MechanicalObject with template Rigid3d in its node or above");
  if (state->stage() == scene::Component::Stage::kFailed) throw scene::DependencyFailure();
  if (state->stage() != scene::Component::Stage::kReady)
    component.reject(fmt::format("needs its MechanicalObject ('{}') before it in the scene", state->name()));
  return *state;
}

/// UniformMass of frames.
class RigidMass final : public scene::Mass {
 public:
  RigidMass() : Mass(attributes::kRigidMass) {}

  void init() override {
    num_frames_ = frames_of(*this).num_frames();
    inertia_ = Mat3::Identity();
    const bool has_vertex_mass = is_given("vertexMass");
    if (has_vertex_mass) take_vertex_mass();
    if (is_given("totalMass")) {
      if (has_vertex_mass) remark(scene::Severity::kWarning, "vertexMass", "gives the inertia alone: totalMass counts");
      mass_ = real("totalMass") / num_frames_;
    } else if (!has_vertex_mass) {
      reject("totalMass", "is not given, and vertexMass neither: one of them is needed");
    }
    inertia_ *= mass_;
    rayleigh_mass_ = real("rayleighMass");
  }

  void add_gravity(const Vec3& gravity, Points f) const override {
    for (int i = 0; i < num_frames_; ++i) f.row(2 * i) += mass_ * gravity.transpose();
  }
  void add_product(double factor, ConstPoints dx, Points df) const override {
    for (int i = 0; i < num_frames_; ++i) {
      df.row(2 * i) += factor * mass_ * dx.row(2 * i);
      df.row(2 * i + 1) += factor * (inertia_ * dx.row(2 * i + 1).transpose()).transpose();
    }
  }
  void add_blocks(double factor, BlockMatrix& A) const override {
    for (int i = 0; i < num_frames_; ++i) {
      A.add(2 * i, 2 * i, factor * mass_ * Mat3::Identity());
      A.add(2 * i + 1, 2 * i + 1, factor * inertia_);
    }
  }
  double kinetic_energy(ConstPoints v) const override {
    double energy = 0;
    for (int i = 0; i < num_frames_; ++i) {
      const Vec3 turning = v.row(2 * i + 1).transpose();
      energy += (mass_ * v.row(2 * i).squaredNorm() + turning.dot(inertia_ * turning)) / 2;
    }
    return energy;
  }
  bool add_diagonal(double factor, Points diagonal) const override {
    const Vec3 about_axes = inertia_.diagonal();
    if (!inertia_.isApprox(Mat3(about_axes.asDiagonal()), 0)) return false;
    for (int i = 0; i < num_frames_; ++i) {
      diagonal.row(2 * i).array() += factor * mass_;
      diagonal.row(2 * i + 1) += factor * about_axes.transpose();
    }
    return true;
  }
  double rayleigh_mass() const override { return rayleigh_mass_; }

 private:
  /// SOFA writes a matrix as [a b c,d e f,g h i].
  void take_vertex_mass() {
    std::string text = this->text("vertexMass");
    std::ranges::replace_if(
        text, [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    std::vector<double> numbers;
    for (double number; stream >> number;) numbers.push_back(number);
    const bool is_finite = std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
    if (!stream.eof() || !is_finite || (numbers.size() != 1 && numbers.size() != 11))
      reject("vertexMass", fmt::format("'{}' must be one number, or eleven", this->text("vertexMass")));
    mass_ = numbers[0];
    if (!(mass_ > 0)) reject("vertexMass", fmt::format("the mass is {}, must be greater than 0", mass_));
    if (numbers.size() == 1) return;
    inertia_ = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&numbers[2]);
    const bool is_symmetric = (inertia_ - inertia_.transpose()).isZero(1e-9 * inertia_.norm());
    if (!is_symmetric || !(Eigen::SelfAdjointEigenSolver<Mat3>(inertia_).eigenvalues()[0] > 0))
      reject("vertexMass", "the inertia matrix must be symmetric and positive definite");
  }

  int num_frames_ = 0;
  double mass_ = 0;                  // [kg] of a frame
  Mat3 inertia_ = Mat3::Identity();  // [kg m^2]
  double rayleigh_mass_ = 0;
};

/// Some frames, held while it is active.
class FrameConstraint : public scene::ProjectiveConstraint {
 public:
  using ProjectiveConstraint::ProjectiveConstraint;

  void refresh() override { init(); }

  void project(Points field) const override {
    if (!is_active()) return;
    for (const int frame : frames_) field.middleRows(2 * frame, 2).setZero();
  }
  void pin(BlockMatrix& A) const override {
    if (!is_active()) return;
    for (const int frame : frames_)
      for (int row = 0; row < 2; ++row)
        for (int axis = 0; axis < 3; ++axis) A.pin(2 * frame + row, axis);
  }

 protected:
  virtual bool is_active() const { return true; }

  std::vector<int> frames_;
};

class RigidFixed final : public FrameConstraint {
 public:
  RigidFixed() : FrameConstraint(attributes::kRigidFixed) {}

  void init() override {
    const int count = frames_of(*this).num_frames();
    frames_ = indices("indices", count);
    if (boolean("fixAll")) {
      frames_.resize(static_cast<std::size_t>(count));
      std::iota(frames_.begin(), frames_.end(), 0);
    }
    takes_velocity_ = boolean("activate_projectVelocity");
  }
  void project_motion(double, Points, Points v) const override {
    if (takes_velocity_) project(v);
  }

 private:
  bool takes_velocity_ = false;
};

/// LinearMovementProjectiveConstraint of frames.
class RigidMovement final : public FrameConstraint {
 public:
  RigidMovement() : FrameConstraint(attributes::kRigidMovement) {}

  void init() override {
    state_ = &frames_of(*this);
    frames_ = indices("indices", state_->num_frames());
    is_relative_ = boolean("relativeMovements");
    const PointArray rows = vectors3("movements");
    if (rows.rows() % 2 != 0)
      reject("movements", fmt::format("{} numbers given, must be groups of 6", 3 * rows.rows()));
    const Eigen::Index count = rows.rows() / 2;
    times_ = key_times(*this, "keyTimes", "movements", static_cast<std::size_t>(count));
    translations_.resize(count, 3);
    angles_.resize(count, 3);
    for (Eigen::Index k = 0; k < count; ++k) {
      translations_.row(k) = rows.row(2 * k);
      angles_.row(k) = rows.row(2 * k + 1);
    }
    first_positions_ = state_->positions();
    first_orientations_.assign(state_->orientations().begin(), state_->orientations().end());
  }

  void project_motion(double time, Points x, Points v) const override {
    const KeyPhase phase = phase_at(times_, time);
    if (!lies_between_keys(phase)) return;
    const Eigen::RowVector3d translation = interpolate(phase, translations_);
    const Eigen::Quaterniond turn = turn_at(phase);
    for (const int frame : frames_) {
      x.row(2 * frame) = translation;
      if (is_relative_) x.row(2 * frame) += first_positions_.row(2 * frame);
      v.row(2 * frame) = slope(phase, times_, translations_);
      v.row(2 * frame + 1) = slope(phase, times_, angles_);
      const Eigen::Quaterniond goal = is_relative_ ? first_orientations_[frame] * turn : turn;
      const Eigen::AngleAxisd from_accepted(goal * state_->orientations()[frame].conjugate());
      x.row(2 * frame + 1) = (from_accepted.angle() * from_accepted.axis()).transpose();
    }
  }

 private:
  bool is_active() const override { return lies_between_keys(phase_at(times_, node().clock().time)); }
  bool lies_between_keys(const KeyPhase& phase) const {
    return phase.key >= 0 && phase.key + 1 < static_cast<int>(times_.size());
  }

  /// The rotation of a key: about x, then y, then z.
  Eigen::Quaterniond turn_of_key(int key) const {
    return Eigen::AngleAxisd(angles_(key, 2), Vec3::UnitZ()) * Eigen::AngleAxisd(angles_(key, 1), Vec3::UnitY()) *
           Eigen::AngleAxisd(angles_(key, 0), Vec3::UnitX());
  }

  Eigen::Quaterniond turn_at(const KeyPhase& phase) const {
    const Eigen::Quaterniond a = turn_of_key(phase.key), b = turn_of_key(phase.key + 1);
    const double cosine = a.dot(b), t = phase.fraction;
    if (!(std::abs(cosine) < 1 - 1e-12)) return Eigen::Quaterniond((1 - t) * a.coeffs() + t * b.coeffs()).normalized();
    const double angle = std::acos(cosine);  // the long way round too, as in SOFA
    return Eigen::Quaterniond((std::sin((1 - t) * angle) * a.coeffs() + std::sin(t * angle) * b.coeffs()) /
                              std::sin(angle));
  }

  scene::RigidState* state_ = nullptr;
  std::vector<double> times_;         // [s]
  PointArray translations_, angles_;  // [m], [rad] of each time
  PointArray first_positions_;
  std::vector<Eigen::Quaterniond> first_orientations_;
  bool is_relative_ = true;
};

/// RestShapeSpringsForceField of frames.
class RigidSprings final : public scene::ForceField {
 public:
  RigidSprings() : ForceField(attributes::kRigidSprings) {}

  void init() override {
    state_ = &frames_of(*this);
    frames_ = indices("points", state_->num_frames());
    if (frames_.empty()) {
      frames_.resize(static_cast<std::size_t>(state_->num_frames()));
      std::iota(frames_.begin(), frames_.end(), 0);
    }
    stiffness_ = values("stiffness");
    angular_stiffness_ = values("angularStiffness");
    rayleigh_stiffness_ = real("rayleighStiffness");
    if (first_orientations_.empty()) {
      first_positions_ = state_->positions();
      first_orientations_.assign(state_->orientations().begin(), state_->orientations().end());
    }
  }
  void refresh() override { init(); }

  void add_force(double, ConstPoints x, ConstPoints, Points f) override {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const int frame = frames_[i];
      f.row(2 * frame) -= stiffness_[i] * (x.row(2 * frame) - first_positions_.row(2 * frame));
      Eigen::Quaterniond turn = state_->orientation_at(frame, x) * first_orientations_[frame].conjugate();
      if (turn.w() < 0) turn.coeffs() *= -1;
      const double sine = turn.vec().norm();
      if (sine > 0)
        f.row(2 * frame + 1) -= angular_stiffness_[i] * 2 * std::atan2(sine, turn.w()) / sine * turn.vec().transpose();
    }
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      df.row(2 * frames_[i]) -= factor * stiffness_[i] * dx.row(2 * frames_[i]);
      df.row(2 * frames_[i] + 1) -= factor * angular_stiffness_[i] * dx.row(2 * frames_[i] + 1);
    }
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      A.add(2 * frames_[i], 2 * frames_[i], -factor * stiffness_[i] * Mat3::Identity());
      A.add(2 * frames_[i] + 1, 2 * frames_[i] + 1, -factor * angular_stiffness_[i] * Mat3::Identity());
    }
  }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

 private:
  std::vector<double> values(const char* name) {
    std::vector<double> given = reals(name);
    if (given.size() == 1) given.resize(frames_.size(), given[0]);
    if (given.size() != frames_.size())
      reject(name, fmt::format("{} values given for {} frames, must be one or as many", given.size(), frames_.size()));
    return given;
  }

  scene::RigidState* state_ = nullptr;
  std::vector<int> frames_;
  std::vector<double> stiffness_, angular_stiffness_;
  PointArray first_positions_;
  std::vector<Eigen::Quaterniond> first_orientations_;
  double rayleigh_stiffness_ = 0;
};

}  // namespace

void add_rigid_fields(scene::Factory& factory) {
  factory.add<RigidMass>(attributes::kRigidMass);
  factory.add<RigidFixed>(attributes::kRigidFixed);
  factory.add<RigidMovement>(attributes::kRigidMovement);
  factory.add<RigidSprings>(attributes::kRigidSprings);
}

}  // namespace hexaplast::components
