// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/bricks.hpp"
#include "hexaplast/plastic/flow_report.hpp"
#include "solve/cg_space.hpp"

namespace hexaplast {

/// Why a body cannot be computed on a device: the setting, and what it must be. Empty: it can.
std::string not_on_device(const Model& model);

/// Conjugate gradients on a device, in single precision; preconditioned by the diagonal.
class DeviceCgSpace final : public CgSpace {
 public:
  DeviceCgSpace(DeviceKernels& kernels, const Bricks& bricks) : kernels_(kernels), bricks_(bricks) {}
  void setup(const MatrixFreeSystem& system, const PointArray* of_preconditioner);

  double begin(ConstPoints b, const ConstPoints* start) override;
  double precondition() override { return unscaled(norms_.r_z); }
  double product(double beta) override { return product(false, beta); }
  double advance(double alpha) override;
  void end(Points x) const override;
  void residual(Points r) const override;
  bool is_preconditioned() const override { return is_scaled_; }
  double rounding() const override { return kSingleRounding; }
  double rounding_of_residual() override { return 0; }  // nobody on a device makes it smaller

 private:
  double product(bool has_direction, double beta);
  double unscaled(double square) const { return square / scale_ / scale_; }

  DeviceKernels& kernels_;
  const Bricks& bricks_;
  std::span<const NodalTerm> others_;
  bool is_scaled_ = false;
  double scale_ = 1;  // of all vectors, for the present b
  DeviceKernels::Norms norms_;
  PointArray free_;             // 1, or 0 where fixed
  PointArray field_, product_;  // for the terms beside the body
  mutable std::vector<float> first_, second_;
};

/// A body on a device: its history lies there, and what is asked for on the host is copied.       docs/gpu.md
class DeviceBody final : public DeviceVectors {
 public:
  /// name: "cuda" or "emulation". Throws InputError where the library or the device is missing.
  explicit DeviceBody(std::string name);

  const std::string& name() const { return name_; }

  /// Model or history on the host are others than before.
  void forget() { is_set_up_ = has_newer_history_ = false; }
  /// Brings them to the device, unless they are there, and positions x. Throws InputError where it has no room.
  void set_up(const Model& model, const History& history, ConstPoints x);
  /// What has flowed on the device becomes the host's history.
  void download(History& history);

  /// The verbs of Body. linearize returns whether some hexahedron has a corner so thin that springs may act (Recovery).
  bool linearize(const Model& model, const History& history, ConstPoints x);
  void add_force(Points f) const;
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;
  /// Nothing where such springs may act.
  std::optional<double> energy(const Model& model, const History& history, ConstPoints x);
  FlowReport flow(const Model& model, ConstPoints x, double dt, History& history);
  CgSpace& space(const MatrixFreeSystem& system, const PointArray* of_preconditioner) override;

 private:
  double flow_left_over(const Model& model, ConstPoints x, double dt, History& history, FlowReport& report);

  std::string name_;
  std::unique_ptr<DeviceKernels> kernels_;
  Bricks bricks_;
  DeviceCgSpace space_;
  bool is_set_up_ = false, has_newer_history_ = false;
  std::vector<double> positions_, numbers_;
  mutable std::vector<float> field_, product_;
};

}  // namespace hexaplast
