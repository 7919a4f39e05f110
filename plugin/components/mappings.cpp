// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

/// Knows which state follows which.
class StateMapping : public scene::Mapping, public scene::FollowsNodes {
 public:
  using Mapping::Mapping;

  // When everything has its nodes, and before the solvers above look at it.
  void bwd_init() override {
    output_ = at_output<scene::MechanicalState>();
    if (!output_) return carry_visual_model();
    input_ = &followed();
    if (input_ == output_) reject("input", "is the mapped state itself: must be another one");
    for (const scene::MechanicalState* end : {input_, output_})
      if (end->stage() != Stage::kReady) throw scene::DependencyFailure();
    connect(*input_, *output_);
  }

  scene::MechanicalState* input() const override { return input_; }
  scene::MechanicalState* output() const override { return output_; }

 protected:
  virtual void connect(scene::MechanicalState& above, scene::MechanicalState& below) = 0;

  scene::VisualModel* following_visually() { return at_output<scene::VisualModel>(); }

 private:
  scene::MechanicalState& followed() {
    if (is_given("input")) return linked<scene::MechanicalState>("input");
    const scene::Node* above = node().parent();
    auto* state = above ? above->nearest<scene::MechanicalState>() : nullptr;
    if (!state) reject("needs a MechanicalState in a node above");
    return *state;
  }

  template <class T>
  T* at_output() {
    scene::Object* target = find_data("output")->target();
    if (!target) return node().template local<T>();
    if (const auto* holder = dynamic_cast<scene::Node*>(target)) return holder->template local<T>();
    return dynamic_cast<T*>(target);
  }

  /// An OglModel that follows: pictures look where its points lie; there is nothing to do in a step.
  void carry_visual_model() {
    if (scene::VisualModel* model = following_visually()) return model->carry();
    remark(scene::Severity::kNote, "output", "leads to no mechanical state and to no OglModel: ignored here");
  }

  scene::MechanicalState* input_ = nullptr;
  scene::MechanicalState* output_ = nullptr;
};

class BarycentricMapping final : public StateMapping {
 public:
  BarycentricMapping() : StateMapping(attributes::kBarycentricMapping) {}

  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (&state == input()) embedding_->follow(present_hexahedra(*hexahedra_, state), state.num_nodes());
  }
  std::string cannot_follow(const scene::MechanicalState& state, const Body& body) const override {
    return &state == input() ? are_others(*hexahedra_, body) : "";
  }

  void apply(ConstPoints above, Points below) const override { embedding_->apply(above, below); }
  void add_transposed(ConstPoints below, Points above) const override { embedding_->add_transposed(below, above); }
  void add_transposed_blocks(const BlockMatrix& below, BlockMatrix& above) const override {
    embedding_->add_transposed_blocks(below, above);
  }
  bool is_left(std::span<const int> cell, const scene::SurvivingCells& above) const override {
    return embedding_->is_left(cell, [&](std::span<const int> nodes) { return above.has(nodes); });
  }

 private:
  void connect(scene::MechanicalState& above, scene::MechanicalState& below) override {
    scene::Topology* topology = is_given("input_topology") ? &linked<scene::Topology>("input_topology")
                                                           : above.node().nearest<scene::Topology>();
    if (!topology) reject("needs a Topology at the state that is followed");
    hexahedra_ = &hexahedra_on(*this, *topology, above.num_nodes());
    embedding_.emplace(above.positions(), *hexahedra_, below.positions());
    if (embedding_->num_outside() > 0)
      remark(scene::Severity::kWarning, {},
             fmt::format("{} of {} points lie outside the hexahedra, up to {:.4g} m: they follow the nearest one",
                         embedding_->num_outside(), embedding_->num_points(), embedding_->greatest_distance()));
  }

  const std::vector<Hexahedron>* hexahedra_ = nullptr;
  std::optional<Embedding> embedding_;
};

class IdentityMapping final : public StateMapping, public scene::GivesPoints {
 public:
  IdentityMapping() : StateMapping(attributes::kIdentityMapping) {}

  void nodes_changed(scene::MechanicalState&, std::span<const int>) override {}
  bool is_node_by_node() const override { return true; }

  void apply(ConstPoints above, Points below) const override { below = above; }
  void add_transposed(ConstPoints below, Points above) const override { above += below; }
  void add_transposed_blocks(const BlockMatrix& below, BlockMatrix& above) const override {
    for (int n = 0; n < below.num_nodes(); ++n)
      for (const BlockMatrix::Entry& entry : below.row(n)) above.add(n, entry.column, entry.block);
    if (below.leaves_out()) above.leave_out();
  }
  bool is_left(std::span<const int> cell, const scene::SurvivingCells& above) const override { return above.has(cell); }

  const PointArray* points_for(const scene::VisualModel& model) override {
    if (following_visually() != &model) return nullptr;
    scene::Object* target = find_data("input")->target();
    auto* holder = target ? dynamic_cast<scene::Node*>(target) : node().parent();
    auto* state = dynamic_cast<scene::MechanicalState*>(target);
    if (holder) state = target ? holder->local<scene::MechanicalState>() : holder->nearest<scene::MechanicalState>();
    return state && state->stage() == Stage::kReady ? &state->positions() : nullptr;
  }

 private:
  void connect(scene::MechanicalState& above, scene::MechanicalState& below) override {
    if (above.num_nodes() != below.num_nodes())
      reject(fmt::format("{} nodes follow {}, must be as many", below.num_nodes(), above.num_nodes()));
  }
};

}  // namespace

void add_mappings(scene::Factory& factory) {
  factory.add<BarycentricMapping>(attributes::kBarycentricMapping);
  factory.add<IdentityMapping>(attributes::kIdentityMapping);
}

}  // namespace hexaplast::components
