// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "elastic/evaluate_pass.hpp"
#include "hexaplast/plastic/flow_report.hpp"

namespace hexaplast {

/// What computes a body: the kernels, the plain implementation, or a device. The verbs are those of Body, which checks
/// their arguments and their order; as an operator it is df/dx with rotations held fixed (eq. 16). Model, history and
/// branches are the body's; of the verbs `flow` alone changes the history.
class Backend : public NodalOperator {
 public:
  Backend(const Model& of, History& its_history, const std::vector<BranchStep>& its_branches)
      : model(of), history(its_history), branches(its_branches) {}
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  virtual void linearize(ConstPoints x) = 0;
  virtual void add_force(Points f) const = 0;                                  ///< f += [N]       eq. 15, P14, E25
  virtual void add_stiffness_blocks(double factor, BlockMatrix& K) const = 0;  ///< K += factor df/dx            eq. 17
  virtual void add_operator(double factor, MatrixFreeSystem& system) = 0;
  virtual double energy(ConstPoints x) = 0;  ///< [J]                                                eq. 18, P17, E25
  virtual FlowReport flow(ConstPoints x, double dt) = 0;

  /// Writes those of the elements that are there, at x; stress is that of the moment.
  virtual void find_fields(ConstPoints x, const EvaluatedFields& fields) = 0;

  virtual const Recovery& recovery() const = 0;              ///< at the linearized positions
  virtual const Recovery& find_recovery(ConstPoints x) = 0;  ///< at others; the linearization stays

  virtual bool is_plain() const { return false; }
  virtual std::string device() const { return "cpu"; }
  /// Brings to the host what has become of the history on the device.
  virtual void download() {}
  /// Somebody else changes the history, or the branches: what was found for them before is void.
  virtual void forget() {}
  /// The model has become another one, and its sizes may be others.
  virtual void renew() {}

 protected:
  const Model& model;
  History& history;
  const std::vector<BranchStep>& branches;
};

}  // namespace hexaplast
