// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/bricks.hpp"
#include "device/device_levels.hpp"
#include "kernel_backend.hpp"
#include "solve/cg_space.hpp"

namespace hexaplast {

/// Why a body cannot be computed on a device: the setting, and what it must be. Empty: it can.
std::string not_on_device(const Model& model);

/// Conjugate gradients on a device, in single precision; preconditioned by the diagonal, or by a cycle.
class DeviceCgSpace final : public CgSpace {
 public:
  DeviceCgSpace(DeviceKernels& kernels, const Bricks& bricks) : kernels_(kernels), bricks_(bricks) {}
  void setup(const MatrixFreeSystem& system, const NodalPart* of_preconditioner);

  /// Whether cycles cost less than the diagonal's iterations (kBreakEven).
  bool is_stiff() const { return stiffness_.stiff > stiffness_.free / 2; }
  /// Preconditions by cycles on the meshes `below`, which the kernels have. Returns whether the radii were valid.
  bool use_cycles(const DeviceLevels& below, SpectralRadii& radii);

  double begin(ConstPoints b, const ConstPoints* start) override;
  double precondition() override { return unscaled(has_cycles_ ? kernels_.precondition() : norms_.r_z); }
  double product(double beta) override { return product(false, beta); }
  double advance(double alpha) override;
  void end(Points x) const override;
  void residual(Points r) const override;
  void find_diagonal(double factor, Points diagonal);
  void add_preconditioned(ConstPoints r, Points z);
  bool is_preconditioned() const override { return is_scaled_; }
  double rounding() const override { return kSingleRounding; }
  double rounding_of_residual() override { return 0; }  // nobody on a device makes it smaller

 private:
  void set_blocks(std::span<const NodeBlock> blocks);
  bool set_terms();
  double product(bool has_direction, double beta);
  double unscaled(double square) const { return square / scale_ / scale_; }

  DeviceKernels& kernels_;
  const Bricks& bricks_;
  std::span<const NodalTerm> others_;
  bool is_scaled_ = false, has_cycles_ = false;
  bool has_terms_ = false;  // the kernels have all of the terms
  BlockMatrix terms_;
  DeviceKernels::Stiffness stiffness_;
  SpectralRadii of_system_;  // without radii: what tells whether others are valid
  double scale_ = 1;         // of all vectors, for the present b
  DeviceKernels::Norms norms_;
  PointArray free_;             // 1, or 0 where fixed
  PointArray field_, product_;  // for the terms beside the body
  mutable std::vector<float> first_, second_;
};

/// A device: the history lies there, and what is asked for on the host is copied. What it cannot do, the kernels of the
/// CPU do: fields, and the springs of thin hexahedra.                                                     docs/gpu.md
class DeviceBody final : public KernelBackend, public DeviceVectors {
 public:
  /// name: "cuda" or "emulation". Throws InputError where the library or the device is missing.
  DeviceBody(const Model& of, History& its_history, const std::vector<BranchStep>& its_branches, std::string name);

  /// Throws InputError where the device has no room.
  void linearize(ConstPoints x) override;
  void add_force(Points f) const override;
  void add_product(double factor, ConstPoints dx, Points df) const override;
  void add_stiffness_blocks(double factor, BlockMatrix& K) const override;
  void add_operator(double factor, MatrixFreeSystem& system) override;
  double energy(ConstPoints x) override;
  FlowReport flow(ConstPoints x, double dt) override;
  const Recovery& find_recovery(ConstPoints x) override;
  std::string device() const override { return name_; }
  void download() override;
  void forget() override {
    is_set_up_ = has_newer_history_ = false;
    levels_.reset();
  }
  void renew() override;

  int num_nodes() const override { return model.mesh.num_nodes(); }
  void multiply(double factor, ConstPoints p, Points Ap) const override;
  CgSpace& space(const MatrixFreeSystem& system, const NodalPart* of_preconditioner) override;
  std::optional<bool> use_cycles(bool always, SpectralRadii& radii) override;
  bool has_coarse_meshes() const override;
  void find_diagonal(double factor, Points diagonal) override { space_.find_diagonal(factor, diagonal); }
  void add_preconditioned(ConstPoints r, Points z) override { space_.add_preconditioned(r, z); }

 private:
  void set_up(ConstPoints x);
  void take_hexahedron(int place);
  double flow_left_over(ConstPoints x, double dt, FlowReport& report);
  void break_hexahedra(ConstPoints x, FlowReport& report);

  const std::string name_;
  std::unique_ptr<DeviceKernels> kernels_;
  Bricks bricks_;
  std::optional<DeviceLevels> levels_;  // once they have been asked for
  DeviceCgSpace space_;
  bool is_set_up_ = false, has_newer_history_ = false;
  bool can_break_ = false;  // some material has a limit
  struct NearLimit {
    int element;
    CornerValues tau_before;  // [Pa]
  };
  std::vector<NearLimit> near_limit_;  // of the latest step
  std::vector<std::uint8_t> status_;
  std::vector<double> positions_, numbers_;
  mutable std::vector<float> field_, product_;
};

}  // namespace hexaplast
