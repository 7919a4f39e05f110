// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "backend.hpp"
#include "hexaplast/body.hpp"
#include "released_shape.hpp"

namespace hexaplast {

/// All that a body is.
struct Body::State {
  State(HexMesh mesh, std::vector<Material> materials, Settings settings);
  State(const State& other);

  /// Of the model and the history here.
  std::unique_ptr<Backend> make_backend(const std::string& device);

  /// Puts these in place of the present ones. call: which has done so, for messages.
  void take(Model changed, History changed_history, const char* call);

  /// Everything derived from model and history before is old.
  void renew(const char* call);

  /// Before somebody changes the history on the host.
  void begin_change(const char* call);

  void write(Archive& archive);
  std::pair<Model, History> read(Archive& archive) const;
  void require_field(const char* call, const char* name, ConstPoints field) const;
  void require_linearized(const char* call) const;
  void require_hexahedron(int hexahedron) const;
  void require_relaxing_step(const char* call) const;  // that there is one, where something relaxes
  void require_device(const Model& changed) const;     // which computes this, where there is one
  bool is_on_device() const { return backend->device() != "cpu"; }

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  Model model;
  History history;
  double time_step = kNone;          // of what follows
  std::vector<BranchStep> branches;  // how they take it
  double checked_dt = kNone;         // time step that passed check_time_step
  long revision = 0;                 // Body::revision
  ReleasedShape released;            // of isolated rest shapes, made when it is first asked for
  std::unique_ptr<Backend> backend;
  const char* not_linearized_since = "the body was made";  // null while the backend has what the caller linearized
};

}  // namespace hexaplast
