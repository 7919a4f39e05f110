// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/interfaces.hpp"

#include <algorithm>

#include "hexaplast/body.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "hexaplast/mesh/node_copies.hpp"

namespace hexaplast::scene {

namespace {

// Engines that ask one another, each on the stack of the one before.
constexpr int kMaxEngines = 100;
thread_local int num_asking = 0;

}  // namespace

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

const NodeCopies* MechanicalState::copies() const { return split_by_ ? &split_by_->copies() : nullptr; }

int MechanicalState::num_initial_nodes() { return split_by_ ? split_by_->copies().num_initial() : num_nodes(); }

void PresentCells::follow(std::span<int> cell) const {
  if (!body_) return;
  const HexMesh& mesh = body_->mesh();
  const NodeCopies& copies = body_->copies();
  const auto corner_at = [&](int element, int initial) {
    const Hexahedron& corners = mesh.hexahedra()[element];
    const auto at = std::ranges::find(corners, initial, [&](int node) { return copies.initial()[node]; });
    return at == corners.end() ? -1 : *at;
  };
  int lowest = -1;
  for (const int copy : copies.of(cell.front()))
    for (const HexMesh::Incidence& at : mesh.incident(copy)) {
      const int element = at.element;
      const bool is_better = lowest < 0 || (body_->alive()[element] > body_->alive()[lowest]) ||
                             (body_->alive()[element] == body_->alive()[lowest] && element < lowest);
      if (is_better && std::ranges::all_of(cell, [&](int node) { return corner_at(element, node) >= 0; }))
        lowest = element;
    }
  if (lowest >= 0)
    for (int& node : cell) node = corner_at(lowest, node);
}

SurvivingCells::SurvivingCells(MechanicalState& state) {
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

std::vector<MechanicalState*> independent_states(const Node& node) {
  std::vector<MechanicalState*> states = node.all<MechanicalState>();
  for (const Mapping* mapping : node.all<Mapping>()) std::erase(states, mapping->output());
  return states;
}

bool acts_on(const Component& component, const MechanicalState& state) {
  const auto* interaction = dynamic_cast<const Interaction*>(&component);
  if (interaction && interaction->states()[0]) return false;
  return component.node().nearest<MechanicalState>() == &state;
}

std::vector<Mass*> masses_of(const Node& node, const MechanicalState& state) {
  std::vector<Mass*> masses = node.all<Mass>();
  std::erase_if(masses, [&](const Mass* mass) { return !acts_on(*mass, state); });
  return masses;
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

  if (!new_inputs().empty()) computed_.clear();
  accept_inputs();
  if (!computed_.contains(&output)) compute(output.attribute().name);
}

void Engine::found(std::string_view output, Value value) {
  Data& data = *find_data(output);
  data.set(std::move(value));
  computed_.insert(&data);
}

}  // namespace hexaplast::scene
