// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/interfaces.hpp"

#include <algorithm>
#include <cmath>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::scene {

namespace {

// Engines that ask one another, each on the stack of the one before.
constexpr int kMaxEngines = 100;
thread_local int num_asking = 0;

}  // namespace

double MassMatrix::kinetic_energy(ConstPoints v) const {
  PointArray momentum = PointArray::Zero(v.rows(), 3);
  add_product(1, v, momentum);
  return dot(v, momentum) / 2;
}

const std::vector<Quad>& Topology::quads() {
  static const std::vector<Quad> none;
  return none;
}

const std::vector<Triangle>& Topology::triangles() {
  static const std::vector<Triangle> none;
  return none;
}

const std::vector<Edge>& Topology::edges() {
  static const std::vector<Edge> none;
  return none;
}

const std::vector<Tetrahedron>& Topology::tetrahedra() {
  static const std::vector<Tetrahedron> none;
  return none;
}

SurvivingCells::SurvivingCells(State& state) {
  Node& root = state.node().root();
  for (const ForceField* field : root.all<ForceField>())
    if (field->body() && acts_on(*field, state)) bodies_.push_back(field->body());
  for (const Mapping* mapping : root.all<Mapping>()) {
    if (mapping->output() != &state) continue;
    mapping_ = mapping;
    above_ = std::make_unique<const SurvivingCells>(*mapping->input());
  }
}

bool SurvivingCells::has(std::span<const int> cell) const {
  const bool is_held =
      std::ranges::all_of(bodies_, [&](const Body* body) { return hold_together(body->mesh(), body->alive(), cell); });
  return is_held && (!mapping_ || mapping_->is_left(cell, *above_));
}

std::vector<State*> independent_states(const Node& node) {
  std::vector<State*> states = node.all<State>();
  for (const Mapping* mapping : node.all<Mapping>()) std::erase(states, mapping->output());
  return states;
}

bool acts_on(const Component& component, const State& state) {
  const auto* interaction = dynamic_cast<const Interaction*>(&component);
  if (interaction && interaction->states()[0]) return false;
  return component.node().nearest<State>() == &state;
}

std::vector<MassMatrix*> masses_of(const Node& node, const State& state) {
  std::vector<MassMatrix*> masses;
  node.for_each<Component>([&](Component& component) {
    if (auto* mass = dynamic_cast<MassMatrix*>(&component); mass && acts_on(component, state)) masses.push_back(mass);
  });
  return masses;
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& orientation, const Vec3& by) {
  const Vec3 half = by / 2;
  const double angle = half.norm();
  const double sinc = angle > 0 ? std::sin(angle) / angle : 1;
  return Eigen::Quaterniond(std::cos(angle), sinc * half.x(), sinc * half.y(), sinc * half.z()) * orientation;
}

Eigen::Quaterniond RigidState::orientation_at(int frame, ConstPoints x) {
  return turned(orientations()[frame], x.row(2 * frame + 1).transpose());
}

void RigidState::accept() {
  PointArray& x = positions();
  for (int frame = 0; frame < num_frames(); ++frame) {
    if (x.row(2 * frame + 1).isZero(0)) continue;
    orientations()[frame] = orientation_at(frame, x);
    x.row(2 * frame + 1).setZero();
  }
}

void Engine::provide(Data& output) {
  if (is_computing_) reject(output.attribute().name, "depends on itself through links");
  if (num_asking >= kMaxEngines)
    reject(output.attribute().name, "more than " + std::to_string(kMaxEngines) + " components follow one another");
  if (stage() == Stage::kFailed) throw DependencyFailure();

  // Reset on every way out, a refusal of the scene included.
  struct Computing {
    explicit Computing(bool& flag) : on(flag) {
      on = true;
      ++num_asking;
    }
    ~Computing() {
      on = false;
      --num_asking;
    }
    bool& on;
  } const guard(is_computing_);

  const long inputs = inputs_version();
  if (inputs != computed_from_) computed_.clear();
  computed_from_ = inputs;
  if (!computed_.contains(&output)) compute(output.attribute().name);
}

void Engine::found(std::string_view output, Value value) {
  Data& data = *find_data(output);
  data.set(std::move(value));
  computed_.insert(&data);
}

}  // namespace hexaplast::scene
