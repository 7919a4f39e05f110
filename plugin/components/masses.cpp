// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "loaded_body.hpp"
#include "parts/spread_nodes.hpp"

namespace hexaplast::components {
namespace {

/// A mass at every node. Where nodes split, each copy has its share.
class LumpedMass : public LumpedMasses<scene::Mass>, public scene::FollowsNodes {
 public:
  using LumpedMasses::LumpedMasses;

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    masses = initial_ = nodal_masses(state_->num_initial_nodes());
    rayleigh_mass_ = real("rayleighMass");
    if (state_->copies()) masses = masses_of_copies(*state_);
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (&state == state_) masses = masses_of_copies(state);
  }

  double rayleigh_mass() const override { return rayleigh_mass_; }

 protected:
  virtual Eigen::VectorXd nodal_masses(Eigen::Index num_nodes) = 0;  ///< [kg] of the initial nodes

  virtual Eigen::VectorXd masses_of_copies(const scene::MechanicalState& state) const {
    const std::vector<double> all =
        parts::shared_out({initial_.data(), static_cast<std::size_t>(initial_.size())}, *state.copies());
    return Eigen::Map<const Eigen::VectorXd>(all.data(), std::ssize(all));
  }

  /// Says which of several given attributes counts.
  void remark_unused(std::string_view used, std::string_view unused) {
    if (is_given(unused)) remark(scene::Severity::kWarning, unused, fmt::format("is ignored: {} counts", used));
  }

 private:
  scene::MechanicalState* state_ = nullptr;
  Eigen::VectorXd initial_;  // [kg] of the initial nodes
  double rayleigh_mass_ = 0;
};

class UniformMass final : public LumpedMass {
 public:
  UniformMass() : LumpedMass(attributes::kUniformMass) {}

 private:
  Eigen::VectorXd nodal_masses(Eigen::Index num_nodes) override {
    if (is_given("totalMass")) {
      remark_unused("totalMass", "vertexMass");
      return Eigen::VectorXd::Constant(num_nodes, real("totalMass") / static_cast<double>(num_nodes));
    }
    if (!is_given("vertexMass")) reject("totalMass", "is not given, and vertexMass neither: one of them is needed");
    return Eigen::VectorXd::Constant(num_nodes, real("vertexMass"));
  }
};

class DiagonalMass final : public LumpedMass {
 public:
  DiagonalMass() : LumpedMass(attributes::kDiagonalMass) {}

 private:
  Eigen::VectorXd nodal_masses(Eigen::Index num_nodes) override {
    const bool by_density = is_given("massDensity"), by_node = is_given("vertexMass");
    if (is_given("totalMass") || (!by_density && !by_node)) {
      for (const char* unused : {"massDensity", "vertexMass"}) remark_unused("totalMass", unused);
      const Eigen::VectorXd volumes = rest_volumes(num_nodes);
      density_ = real_if_given("totalMass").value_or(1) / volumes.sum();
      return density_ * volumes;
    }
    if (by_density) {
      remark_unused("massDensity", "vertexMass");
      density_ = real("massDensity");
      return density_ * rest_volumes(num_nodes);
    }
    const std::vector<double>& each = reals("vertexMass");
    const auto num_given = static_cast<Eigen::Index>(each.size());
    if (num_given == 1) return Eigen::VectorXd::Constant(num_nodes, each[0]);
    if (num_given == num_nodes) return Eigen::Map<const Eigen::VectorXd>(each.data(), num_nodes);
    reject("vertexMass",
           fmt::format("{} values given for {} nodes, must be one or one per node", num_given, num_nodes));
  }

  Eigen::VectorXd rest_volumes(Eigen::Index num_nodes) {
    auto& state = *node().nearest<scene::MechanicalState>();
    hexahedra_ = &hexahedra_on(*this, linked<scene::Topology>("topology"), static_cast<int>(num_nodes));
    volumes_ = element_volumes(boolean("computeMassOnRest") ? state.rest_positions() : state.positions(),
                               present_hexahedra(*hexahedra_, state));
    return hexaplast::nodal_masses(static_cast<int>(num_nodes), *hexahedra_, volumes_);
  }

  std::string cannot_follow(const scene::MechanicalState& state, const Body& body) const override {
    return hexahedra_ && acts_on(*this, state) ? are_others(*hexahedra_, body) : "";
  }

  // Hexahedra keep their masses: the sums over their present corners.
  Eigen::VectorXd masses_of_copies(const scene::MechanicalState& state) const override {
    if (!hexahedra_) return LumpedMass::masses_of_copies(state);
    return density_ *
           hexaplast::nodal_masses(state.copies()->num_nodes(), present_hexahedra(*hexahedra_, state), volumes_);
  }

  const std::vector<Hexahedron>* hexahedra_ = nullptr;  // that have mass; null: nodes have
  std::vector<double> volumes_;                         // [m^3] of these
  double density_ = 0;                                  // [kg/m^3]
};

}  // namespace

void add_masses(scene::Factory& factory) {
  factory.add<UniformMass>(attributes::kUniformMass);
  factory.add<DiagonalMass>(attributes::kDiagonalMass);
}

}  // namespace hexaplast::components
