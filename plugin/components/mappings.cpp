// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/state_mapping.hpp"
#include "hexaplast/geometry/embed.hpp"

namespace hexaplast::components {
namespace {

using PointMapping = StateMapping<scene::MechanicalState>;

class BarycentricMapping final : public PointMapping {
 public:
  BarycentricMapping() : PointMapping(attributes::kBarycentricMapping) {}

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
    const std::vector<Hexahedron>& hexahedra = hexahedra_on(*this, *topology, above.num_nodes());
    if (boolean("useRestPosition"))
      embedding_.emplace(above.rest_positions(), hexahedra, below.rest_positions());
    else
      embedding_.emplace(above.positions(), hexahedra, below.positions());
    if (embedding_->num_outside() > 0)
      remark(scene::Severity::kWarning, {},
             fmt::format("{} of {} points lie outside the hexahedra, up to {:.4g} m: they follow the nearest one",
                         embedding_->num_outside(), embedding_->num_points(), embedding_->greatest_distance()));
  }

  std::optional<Embedding> embedding_;
};

class IdentityMapping final : public PointMapping, public scene::GivesPoints {
 public:
  IdentityMapping() : PointMapping(attributes::kIdentityMapping) {}

  void apply(ConstPoints above, Points below) const override { below = above; }
  void add_transposed(ConstPoints below, Points above) const override { above += below; }
  void add_transposed_blocks(const BlockMatrix& below, BlockMatrix& above) const override {
    for (int n = 0; n < below.num_nodes(); ++n)
      for (const BlockMatrix::Entry& entry : below.row(n)) above.add(n, entry.column, entry.block);
    for (const auto& [factor, u] : below.rank_ones()) above.add_rank_one(factor, u);
  }
  bool is_left(std::span<const int> cell, const scene::SurvivingCells& above) const override { return above.has(cell); }

  const PointArray* points_for(const scene::VisualModel& model) override {
    if (following_visually() != &model) return nullptr;
    scene::Object* target = find_data("input")->target();
    auto* holder = target ? dynamic_cast<scene::Node*>(target) : node().parent();
    scene::State* state = dynamic_cast<scene::State*>(target);
    if (holder) state = target ? holder->local<scene::State>() : holder->nearest<scene::State>();
    const bool is_of_points = dynamic_cast<scene::MechanicalState*>(state);
    return is_of_points && state->stage() == Stage::kReady ? &state->positions() : nullptr;
  }

 private:
  void connect(scene::MechanicalState& above, scene::MechanicalState& below) override {
    if (above.num_nodes() != below.num_nodes())
      reject(fmt::format("{} nodes follow {}, must be as many", below.num_nodes(), above.num_nodes()));
  }
};

/// Nodes that are some of those above.
class SubsetMapping final : public PointMapping {
 public:
  SubsetMapping() : PointMapping(attributes::kSubsetMapping) {}

  void apply(ConstPoints above, Points below) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i) below.row(static_cast<Eigen::Index>(i)) = above.row(nodes_[i]);
  }
  void add_transposed(ConstPoints below, Points above) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i) above.row(nodes_[i]) += below.row(static_cast<Eigen::Index>(i));
  }
  void add_transposed_blocks(const BlockMatrix& below, BlockMatrix& above) const override {
    for (int n = 0; n < below.num_nodes(); ++n)
      for (const BlockMatrix::Entry& entry : below.row(n)) above.add(nodes_[n], nodes_[entry.column], entry.block);
    for (const auto& [factor, u] : below.rank_ones()) {
      PointArray carried = PointArray::Zero(above.num_nodes(), 3);
      add_transposed(u, carried);
      above.add_rank_one(factor, carried);
    }
  }
  bool is_left(std::span<const int> cell, const scene::SurvivingCells& above) const override {
    std::vector<int> nodes;
    for (const int node : cell) nodes.push_back(nodes_[node]);
    return above.has(nodes);
  }

 private:
  void connect(scene::MechanicalState& above, scene::MechanicalState& below) override {
    if (is_given("indices"))
      nodes_ = indices("indices", above.num_nodes());
    else
      find_nodes(above.positions(), below.positions());
    if (static_cast<int>(nodes_.size()) != below.num_nodes())
      reject("indices",
             fmt::format("{} numbers given for {} nodes, must be as many", nodes_.size(), below.num_nodes()));
  }

  /// The nearest one of those above, the first of several, as in SOFA.
  void find_nodes(ConstPoints above, ConstPoints below) {
    const double radius = real("radius");
    for (Eigen::Index i = 0; i < below.rows(); ++i) {
      int nearest = -1;
      double min = radius;
      for (Eigen::Index n = 0; n < above.rows(); ++n) {
        const double distance = (below.row(i) - above.row(n)).norm();
        if (distance >= min) continue;
        nearest = static_cast<int>(n);
        min = distance;
      }
      if (nearest < 0)
        reject("radius", fmt::format("no node of the followed state lies within {} m of node {}", radius, i));
      nodes_.push_back(nearest);
    }
  }

  std::vector<int> nodes_;  // of those above
};

}  // namespace

void add_mappings(scene::Factory& factory) {
  factory.add<BarycentricMapping>(attributes::kBarycentricMapping);
  factory.add<IdentityMapping>(attributes::kIdentityMapping);
  factory.add<SubsetMapping>(attributes::kSubsetMapping);
}

}  // namespace hexaplast::components
