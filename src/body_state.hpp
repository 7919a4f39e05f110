// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deque>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "device/device_body.hpp"
#include "elastic/exact_product.hpp"
#include "elastic/hierarchy.hpp"
#include "elastic/operators.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "material/relaxation.hpp"
#include "plain/plain.hpp"
#include "plastic/flow.hpp"
#include "released_shape.hpp"

namespace hexaplast {

/// What a body solves its averaging with.
PreconditionedConjugateGradients averaging_solver(const Model& model);

/// A body's device, if it has one; a copy of the body has one of its own.
class OnDevice : public std::unique_ptr<DeviceBody> {
 public:
  OnDevice() = default;
  explicit OnDevice(const std::string& name) : std::unique_ptr<DeviceBody>(std::make_unique<DeviceBody>(name)) {}
  OnDevice(const OnDevice& other) : OnDevice(other ? OnDevice(other->name()) : OnDevice()) {}
  OnDevice(OnDevice&&) = default;
  OnDevice& operator=(OnDevice&&) = default;
};

/// What of a body a system cannot have as a KernelBody: its recovery, or all of a plain one.
struct BodyTerm final : NodalOperator {
  const plain::Elasticity* elasticity = nullptr;
  const Recovery* recovery = nullptr;
  double factor = 0;  // of df/dx

  void add_product(ConstPoints p, Points Fp) const override {
    elasticity ? elasticity->add_stiffness_product(factor, p, Fp) : recovery->add_product(-factor, p, Fp);
  }
  bool has_diagonal() const override { return true; }
  void add_diagonal(Points diagonal) const override {
    elasticity ? elasticity->add_stiffness_diagonal(factor, diagonal) : recovery->add_diagonal(-factor, diagonal);
  }
};

/// All that a body is.
struct Body::State {
  State(HexMesh mesh, std::vector<Material> materials, Settings settings);

  /// Puts these in place of the present ones. call: which has done so, for messages.
  void take(Model changed, History changed_history, const char* call);

  /// What was derived from mesh and history before is old, and its sizes may be others.
  void renew(const char* call);

  void write(Archive& archive) const;
  std::pair<Model, History> read(Archive& archive) const;
  void require_field(const char* call, const char* name, ConstPoints field) const;
  void require_linearized(const char* call) const;
  void require_hexahedron(int hexahedron) const;
  void require_relaxing_step(const char* call) const;  // that there is one, where something relaxes

  /// Of bodies that flow or relax, but for plain ones.
  void make_flow() {
    flow.reset();
    if ((model.can_flow() || model.settings.num_branches() > 0) && !is_plain()) flow.emplace(model, history);
  }

  /// The faces that are to open after a plastic step that led to x.
  std::vector<int> torn_faces(ConstPoints x);

  /// What has flowed on the device comes into `history`.
  void download() {
    if (device) device->download(history);
  }

  /// Throws InputError where there is a device and it cannot compute this.
  void require_device(const Model& changed) const;

  /// The same; and the device is to take all of it again.
  void take_from_device();
  /// The springs of `recovery` at x.
  Recovery springs_at(ConstPoints x);

  bool is_plain() const { return model.is_plain; }
  const Recovery& recovery() const { return is_plain() ? plain.recovery() : at.recovery; }  // of the linearized body

  Model model;
  History history;
  Linearization at;
  const char* not_linearized_since = "the body was made";  // null while `at` is what the caller linearized
  plain::Elasticity plain;                                 // of a plain body, in place of `at`
  std::optional<FlowWorkspace> flow;                       // of bodies whose history changes, but for plain ones
  PreconditionedConjugateGradients averaging_solver;
  bool skip_screening = false;  // in the latest plastic step: screening first would be in vain
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double checked_dt = kNone;                  // time step that passed check_time_step
  double time_step = kNone;                   // of what follows
  std::vector<BranchStep> branches;           // how they take it
  SlotScratch slots;                          // of solvers, `energy` and `fields`
  ProductWorkspace product;                   // of add_stiffness_product and energy
  DoublePrecisionOperator exact;              // of mixed precision
  std::deque<BodyTerm> terms;                 // of the systems described since `linearize`, one for each factor
  std::optional<ElementHierarchy> hierarchy;  // made when a solver first asks for levels
  long revision = 0;                          // Body::revision
  OnDevice device;                            // computes it, in place of the kernels and of `at` but for its springs
  ReleasedShape released;                     // of isolated rest shapes, made when it is first asked for
};

}  // namespace hexaplast
