// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <optional>
#include <span>

#include "attributes/parts.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "parts/probe.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

class Probe final : public scene::Probe, public scene::FollowsNodes {
 public:
  Probe() : scene::Probe(attributes::kProbe) {}

  // An index stays with the copy that keeps it.
  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (points_) {
      if (&state == &needed_ready<scene::MechanicalState>())
        points_->follow(present_hexahedra(needed_ready<scene::Topology>().hexahedra(), state), state.num_nodes());
    } else if (probe_ && holds_vectors() && is_of_nodes(state)) {
      probe_->follow(*state.copies());
    }
  }
  std::string cannot_follow(const scene::MechanicalState& state, const Body& body) const override {
    if (!points_ || node().nearest<scene::MechanicalState>() != &state) return {};
    return are_others(node().nearest<scene::Topology>()->hexahedra(), body);
  }

  // When the outputs of all components are there.
  void bwd_init() override {
    if (!is_given("value")) reject("value", "is not given: there is nothing to record");
    if (is_given("component") && !holds_vectors())
      reject("component", "is given for a value that holds no vectors: its entries are single numbers");
    if (is_given("points")) embed();
    probe_.emplace(read_options<parts::ProbeOptions>(*this), holds_vectors() ? 3 : 1);
    scene::Readings readings;
    read(readings);
  }
  bool looks_by_itself() const override { return true; }

  double read(scene::Readings& readings) override {
    probe_->set_options(read_options<parts::ProbeOptions>(*this));
    const std::vector<double>& values = readings.reals(*this, "value");
    return accepted(
        *this, [&] { return points_ ? probe_->read(at_points(values)) : probe_->read(values, alive(values.size())); });
  }
  std::string_view unit() override { return source().attribute().unit; }

 private:
  /// Finds the hexahedra of the points, in the body as it is at the beginning.
  void embed() {
    if (is_given("indices")) reject("points", "are given besides indices: entries are the ones or the others");
    if (!holds_vectors()) reject("points", "need one vector per node for a value, as @nodes.position is");
    auto& state = needed_ready<scene::MechanicalState>();
    auto& topology = needed_ready<scene::Topology>();
    if (topology.hexahedra().empty()) reject("points", "need hexahedra: the nearest topology has none");
    const PointArray points = vectors3("points");
    try {
      points_.emplace(state.rest_positions(), topology.hexahedra(), points);
    } catch (const NumericalError& error) {
      reject("points", error.what());
    }
    if (points_->num_outside() > 0)
      remark(scene::Severity::kWarning, "points",
             fmt::format("{} of {} lie outside of all hexahedra, by up to {:.3g} m: they follow the nearest one",
                         points_->num_outside(), points_->num_points(), points_->greatest_distance()));
  }

  /// Whether the value has a vector for each node of a state.
  bool is_of_nodes(const scene::MechanicalState& state) {
    const scene::Object& owner = source().owner();
    const auto* field = dynamic_cast<const scene::ForceField*>(&owner);
    return dynamic_cast<const scene::MechanicalState*>(&owner) == &state ||
           (field && field->body() && scene::acts_on(*field, state));
  }

  const std::vector<double>& at_points(const std::vector<double>& nodes) {
    const auto& state = needed_ready<scene::MechanicalState>();
    const Eigen::Index num_nodes = state.rest_positions().rows();
    if (static_cast<Eigen::Index>(nodes.size()) != 3 * num_nodes)
      throw parts::OptionError(
          "value", fmt::format("holds {} numbers, must be 3 for each of {} nodes", nodes.size(), num_nodes));
    values_at_points_.resize(static_cast<std::size_t>(points_->num_points()) * 3);
    points_->apply(Eigen::Map<const PointArray>(nodes.data(), num_nodes, 3),
                   Eigen::Map<PointArray>(values_at_points_.data(), points_->num_points(), 3));
    return values_at_points_;
  }

  /// Of a value per hexahedron of a body: 0 once it is removed. Empty for other values.
  std::span<const unsigned char> alive(std::size_t num_values) {
    const auto* field = dynamic_cast<const scene::ForceField*>(&source().owner());
    const Body* body = field && !holds_vectors() ? field->body() : nullptr;
    return body && body->alive().size() == num_values ? body->alive() : std::span<const unsigned char>();
  }

  /// The attribute that the value follows in the end.
  scene::Data& source() {
    scene::Data* data = find_data("value");
    while (data->source()) data = data->source();
    return *data;
  }
  bool holds_vectors() {
    const attributes::Type type = source().attribute().type;
    return type == attributes::Type::kVector3 || type == attributes::Type::kVectors3;
  }

  std::optional<parts::Probe> probe_;
  std::optional<Embedding> points_;
  std::vector<double> values_at_points_;
};

}  // namespace

void add_probes(scene::Factory& factory) { factory.add<Probe>(attributes::kProbe); }

}  // namespace hexaplast::components
