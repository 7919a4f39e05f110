// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/Guest.h>

#include "components/components.hpp"

namespace hexaplast::sofa_plugin {
namespace {

constexpr attributes::Description kState{
    .class_name = "MechanicalState", .category = "MechanicalState", .help = "The state of the host.", .templates = ""};
constexpr attributes::Description kTopology{
    .class_name = "Topology", .category = "Topology", .help = "The topology of the host.", .templates = ""};

/// The hexahedra of a SOFA topology. Their nodes are those of the state.
class Topology final : public scene::Topology {
 public:
  explicit Topology(MeshTopology& source) : scene::Topology(kTopology) {
    for (const auto& hexahedron : source.getHexahedra()) {
      Hexahedron& corners = hexahedra_.emplace_back();
      for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(hexahedron[a]);
    }
  }

  const PointArray& positions() override { return positions_; }
  const std::vector<Hexahedron>& hexahedra() override { return hexahedra_; }

 private:
  PointArray positions_ = PointArray(0, 3);
  std::vector<Hexahedron> hexahedra_;
};

}  // namespace

/// Nodes of a SOFA state, as they were when they were copied last.
class Guest::State final : public scene::MechanicalState {
 public:
  explicit State(const sofa_plugin::MechanicalState& source)
      : scene::MechanicalState(kState), rest_positions_(view(source.readRestPositions().ref())) {}

  PointArray& positions() override { return positions_; }
  PointArray& velocities() override { return velocities_; }
  const PointArray& rest_positions() const override { return rest_positions_; }
  void add_external_force(Points) const override {}  // SOFA's own business

 private:
  PointArray positions_, velocities_, rest_positions_;
};

const scene::Factory& guests() {
  static const scene::Factory factory = [] {
    scene::Factory made;
    components::add_bodies(made);
    components::add_loads(made);
    components::add_instruments(made);
    components::add_shapes(made);
    components::add_solvers(made);
    return made;
  }();
  return factory;
}

Guest::Guest(SofaComponent& host, const attributes::Description& description, AttributeData& attributes,
             sofa_plugin::MechanicalState* state, MeshTopology* topology)
    : host_(host), attributes_(attributes), sofa_state_(state) {
  const scene::Place place = place_of(host);
  const auto introduce = [&](scene::Object& object, const std::string& name) {
    object.introduce(name, place, scene_.diagnostics());
  };
  scene::Node& root = scene_.root();
  introduce(root, "root");
  if (state) {
    auto stand_in = std::make_unique<State>(*state);
    state_ = stand_in.get();
    introduce(root.add(std::move(stand_in)), state->getName());
    copy_positions();
  }
  if (topology) introduce(root.add(std::make_unique<Topology>(*topology)), topology->getName());
  component_ = &root.add(guests().make(description.class_name));
  introduce(*component_, host.getName());

  attributes.give_all_to(*component_);
  if (const auto* context = host.getContext()) {
    root.find_data("dt")->give(double{context->getDt()}, place);
  }
  scene_.init();
  pass_on_warnings();
}

void Guest::follow_attributes() {
  attributes_.give_to(*component_);
  component_->follow_inputs();
  pass_on_warnings();
}

void Guest::begin_step(double time, double dt) {
  attributes_.give_to(*component_);
  scene_.root().clock().time = time;
  scene_.root().clock().dt = dt;
  copy_positions();
  scene::begin_step(scene_.root());
  pass_on_warnings();
}

void Guest::end_step(double dt) {
  copy_positions();
  scene::end_step(scene_.root(), dt);
  scene_.root().clock().time += dt;
  pass_on_warnings();
}

void Guest::reset() {
  scene_.reset();
  copy_positions();
}

void Guest::copy_positions() {
  if (!state_) return;
  state_->positions() = view(sofa_state_->readPositions().ref());
  state_->velocities() = view(sofa_state_->readVelocities().ref());
}

void Guest::pass_on_warnings() {
  for (const scene::Message& message : scene_.diagnostics().take_warnings()) msg_warning(&host_) << message.text;
}

}  // namespace hexaplast::sofa_plugin
