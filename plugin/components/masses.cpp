// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "loaded_body.hpp"

namespace hexaplast::components {
namespace {

/// A mass at every node.
class LumpedMass : public LumpedMasses<scene::Mass> {
 public:
  using LumpedMasses::LumpedMasses;

  void init() override {
    const auto num_nodes = static_cast<Eigen::Index>(needed_ready<scene::MechanicalState>().num_nodes());
    masses = nodal_masses(num_nodes);
    rayleigh_mass_ = real("rayleighMass");
  }

  double rayleigh_mass() const override { return rayleigh_mass_; }

 protected:
  virtual Eigen::VectorXd nodal_masses(Eigen::Index num_nodes) = 0;  ///< [kg]

  /// Says which of several given attributes counts.
  void remark_unused(std::string_view used, std::string_view unused) {
    if (is_given(unused)) remark(scene::Severity::kWarning, unused, fmt::format("is ignored: {} counts", used));
  }

 private:
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
      return real_if_given("totalMass").value_or(1) / volumes.sum() * volumes;
    }
    if (by_density) {
      remark_unused("massDensity", "vertexMass");
      return real("massDensity") * rest_volumes(num_nodes);
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
    return nodal_volumes(boolean("computeMassOnRest") ? state.rest_positions() : state.positions(),
                         hexahedra_on(*this, linked<scene::Topology>("topology"), static_cast<int>(num_nodes)));
  }
};

}  // namespace

void add_masses(scene::Factory& factory) {
  factory.add<UniformMass>(attributes::kUniformMass);
  factory.add<DiagonalMass>(attributes::kDiagonalMass);
}

}  // namespace hexaplast::components
