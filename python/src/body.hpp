// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "arrays.hpp"
#include "hexaplast/body.hpp"

namespace hexaplast::python {

/// Something that is used by one thread at a time: steps run without Python's lock.
class Turn {
 public:
  explicit Turn(std::atomic_flag& taken) : taken_(taken) {
    if (taken_.test_and_set()) throw std::runtime_error("in use by another thread: one call at a time");
  }
  ~Turn() { taken_.clear(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  std::atomic_flag& taken_;
};

/// A function that has its first argument to itself while it runs.
template <class Call, class Lambda, class Result, class Self, class... Arguments>
auto in_turn(Call call, Result (Lambda::*)(Self&, Arguments...) const) {
  return [call](Self& self, Arguments... arguments) -> Result {
    const Turn turn(self.taken());
    return call(self, std::forward<Arguments>(arguments)...);
  };
}
template <class Call>
auto in_turn(Call call) {
  return in_turn(call, &Call::operator());
}

/// Another object in the same state, by what pickle takes.
inline py::object copy_of(const py::object& self) { return py::module_::import("copy").attr("deepcopy")(self); }

/// What can be read of a body. A step replaces the arrays of a body's history; those that somebody looks at are kept
/// here, in places that stay, and are filled anew after every change.
class BodyState {
 public:
  /// taken: of bodies that are stepped together.
  explicit BodyState(std::shared_ptr<const hexaplast::Body> body,
                     std::shared_ptr<std::atomic_flag> taken = std::make_shared<std::atomic_flag>())
      : body_(std::move(body)), taken_(std::move(taken)) {}

  const hexaplast::Body& body() const { return *body_; }

  std::atomic_flag& taken() { return *taken_; }

  py::array plastic_rest_positions();
  const std::vector<CornerValues>& plastic_strain();
  const std::vector<CornerValues>& yield_stress();
  const std::vector<unsigned char>& alive();

  /// To be called after every change of the history.
  void refresh();

 protected:
  std::shared_ptr<const hexaplast::Body> body_;

 private:
  std::shared_ptr<std::atomic_flag> taken_;
  ShownField plastic_rest_positions_;
  std::optional<std::vector<CornerValues>> plastic_strain_, yield_stress_;
  std::optional<std::vector<unsigned char>> alive_;
};

/// A body that the caller owns, alone or within a simulation.
class Body final : public BodyState {
 public:
  explicit Body(std::shared_ptr<hexaplast::Body> body) : BodyState(body), body_(std::move(body)) {}

  hexaplast::Body& body() { return *body_; }

  /// From now on the same body lives within a simulation: `body` is what has become of it there.
  void enter_simulation(std::shared_ptr<hexaplast::Body> body) {
    body_ = body;
    BodyState::body_ = std::move(body);
    is_in_simulation_ = true;
  }
  void leave_simulation() { is_in_simulation_ = false; }
  bool is_in_simulation() const { return is_in_simulation_; }

 private:
  std::shared_ptr<hexaplast::Body> body_;
  bool is_in_simulation_ = false;
};

void add_body(py::module_& module);        // Material, Settings, FlowReport, Fields, BodyState, Body
void add_simulation(py::module_& module);  // StepReport, Simulation
void add_batch(py::module_& module);       // Batch
void add_scene(py::module_& module);       // Scene

}  // namespace hexaplast::python
