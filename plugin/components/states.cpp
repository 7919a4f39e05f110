// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "geometry/placement.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

class MechanicalObject final : public scene::MechanicalState,
                               public scene::Changeable,
                               public scene::Stateful,
                               public scene::FollowsNodes {
 public:
  MechanicalObject() : MechanicalState(attributes::kMechanicalObject) {}

  void init() override {
    first_positions_ = given_positions();
    if (first_positions_.rows() == 0) reject("has no nodes: needs position or a topology");
    hexaplast::place(first_positions_, real("scale") * vector3("scale3d"), vector3("rotation"), vector3("translation"));
    rest_positions_ = is_given("rest_position") ? one_row_per_node("rest_position") : first_positions_;
    first_velocities_ = one_row_per_node("velocity");
    first_rest_positions_ = rest_positions_;
    positions_ = first_positions_;
    velocities_ = first_velocities_;
  }

  // A link gives the first positions and velocities: what becomes of its source later does not matter.
  void refresh(std::span<const std::string_view>) override {}
  bool may_change(std::string_view) const override { return false; }

  void reset() override {
    positions_ = of_copies(first_positions_);
    velocities_ = of_copies(first_velocities_);
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int> split_from) override {
    if (&state != this) return;
    rest_positions_ = of_copies(first_rest_positions_);
    if (split_from.empty()) return reset();
    append_rows(split_from, positions_);
    append_rows(split_from, velocities_);
  }

  void serialize(Archive& archive) override {
    const Eigen::Index num_rows = rest_positions_.rows();
    archive(positions_, velocities_);
    if (positions_.rows() != num_rows || velocities_.rows() != num_rows)
      throw InputError(fmt::format("{} positions and {} velocities are saved for {} nodes", positions_.rows(),
                                   velocities_.rows(), num_rows));
  }

  PointArray& positions() override { return positions_; }
  PointArray& velocities() override { return velocities_; }
  const PointArray& rest_positions() const override { return rest_positions_; }

  void provide(scene::Data& output) override {
    if (stage() != Stage::kReady) return;  // until then they hold what the scene gives
    const std::string_view name = output.attribute().name;
    const PointArray& field = name == "position" ? positions_ : name == "velocity" ? velocities_ : rest_positions_;
    output.set(flattened(field));
  }

 private:
  PointArray given_positions() {
    const PointArray own = vectors3("position");
    // one node that is given counts unless the topology stands beside it, as in SOFA
    const bool has_topology = is_given("topology") || node().local<scene::Topology>() ||
                              (own.rows() == 0 && node().nearest<scene::Topology>());
    if (own.rows() > 1 || !has_topology) return own;
    const PointArray& nodes = linked<scene::Topology>("topology").positions();
    return nodes.rows() > 0 ? nodes : own;
  }

  // The rows of initial nodes, for all copies.
  PointArray of_copies(const PointArray& initial) const {
    return copies() ? PointArray(initial(copies()->initial(), Eigen::all)) : initial;
  }

  // Zero where not given.
  PointArray one_row_per_node(std::string_view name) {
    const Eigen::Index num_rows = first_positions_.rows();
    const PointArray field = vectors3(name);
    if (field.rows() == 0) return PointArray::Zero(num_rows, 3);
    if (field.rows() != num_rows) reject(name, fmt::format("{} vectors given for {} nodes", field.rows(), num_rows));
    return field;
  }

  PointArray positions_, velocities_;
  PointArray rest_positions_;
  PointArray first_positions_, first_velocities_;  // what reset returns to
  PointArray first_rest_positions_;
};

}  // namespace

void add_states(scene::Factory& factory) { factory.add<MechanicalObject>(attributes::kMechanicalObject); }

}  // namespace hexaplast::components
