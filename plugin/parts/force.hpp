// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/solve/mechanics.hpp"
#include "parts/option.hpp"

namespace hexaplast {
class Body;
}

namespace hexaplast::parts {

/// What a force acts on: each state's initial nodes, and for contact its body, which must outlive the force. Of one
/// state, or of one twice, both are the same.
struct Surroundings {
  std::array<int, 2> num_nodes = {};
  std::array<const Body*, 2> bodies = {};
};

/// Forces on a state or between two: what every host drives by one template. Fields have one row per node of each
/// state; those of a single state are given as `first` (a field converts to a Pair), and forces are added there.
///
/// Of a part, hosts know besides:
///
///   Part::Options           what it is made from, with each(options, visit)
///   Part::description()     its attributes
///   Part::kNumStates        1 or 2
///   Part::kIsContact        its bodies are needed, and an integrator that suits contact (integrator_lacks)
///   Part::outputs(visit)    visit(name, of) for each output attribute, whose value is of(part): a Vec3, a number, a
///                           count, or a span of nodes
///   Part(options, around), set_options(options)
///                           throw OptionError; what it remembers stays where options change
class Force : public StepForces {
 public:
  static constexpr int kNumStates = 1;
  static constexpr bool kIsContact = false;
  static void outputs(const auto& /*visit*/) {}

  /// Once, before all steps of a scene: warns of what is wrong there.
  virtual void look_at_start(double /*time*/, const Pair<ConstPoints>& /*x*/) {}

  void add_force(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) override {
    add_load(time, x, v, f);
  }

  /// f += what of it loads the body from outside [N], for files and pictures; changes nothing but f.
  virtual void add_load(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) const = 0;

  std::string cannot_follow() const override { return {}; }

  /// [J] where forces are minus a gradient.
  virtual std::optional<double> potential_energy(double /*time*/, ConstPoints /*x*/) const { return std::nullopt; }

  /// Nodes that carry forces prescribed by the scene.
  virtual std::span<const int> loaded_nodes() const { return {}; }

  std::vector<Remark> take_warnings() { return std::exchange(warnings_, {}); }

 protected:
  void warn(std::string attribute, std::string text) { warnings_.push_back({std::move(attribute), std::move(text)}); }

 private:
  std::vector<Remark> warnings_;
};

}  // namespace hexaplast::parts
