// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <numeric>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/base/parallel.hpp"
#include "mesh/consistent_mass.hpp"
#include "mesh/lumped_mass.hpp"

namespace hexaplast::components {
namespace {

/// The positions at which a mass measures its volumes.
const PointArray& measured_positions(scene::Mass& mass) {
  auto& state = *mass.node().nearest<scene::MechanicalState>();
  return mass.boolean("computeMassOnRest") ? state.rest_positions() : state.positions();
}

void add_blocks_of(const Eigen::VectorXd& masses, double factor, BlockMatrix& A) {
  for (int n = 0; n < static_cast<int>(masses.size()); ++n) A.add(n, n, factor * masses[n] * Mat3::Identity());
}

/// A mass at every node.
class LumpedMass : public scene::Mass {
 public:
  using Mass::Mass;

  void init() override {
    const auto num_nodes = static_cast<Eigen::Index>(needed_ready<scene::MechanicalState>().num_nodes());
    mass_ = nodal_masses(num_nodes);
    rayleigh_mass_ = real("rayleighMass");
  }

  void add_gravity(const Vec3& gravity, Points f) const override { hexaplast::add_gravity(mass_, gravity, f); }
  void add_product(double factor, ConstPoints dx, Points df) const override { df += factor * mass_.asDiagonal() * dx; }
  void add_blocks(double factor, BlockMatrix& A) const override { add_blocks_of(mass_, factor, A); }
  double kinetic_energy(ConstPoints v) const override { return hexaplast::kinetic_energy(mass_, v); }
  bool add_diagonal(double factor, Points diagonal) const override {
    diagonal.colwise() += factor * mass_;
    return true;
  }
  double rayleigh_mass() const override { return rayleigh_mass_; }

 protected:
  virtual Eigen::VectorXd nodal_masses(Eigen::Index num_nodes) = 0;  ///< [kg]

  /// Says which of several given attributes counts.
  void remark_unused(std::string_view used, std::string_view unused) {
    if (is_given(unused)) remark(scene::Severity::kWarning, unused, fmt::format("is ignored: {} counts", used));
  }

 private:
  Eigen::VectorXd mass_;  // [kg] per node
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
    const std::vector<double>& masses = reals("vertexMass");
    const auto num_given = static_cast<Eigen::Index>(masses.size());
    if (num_given == 1) return Eigen::VectorXd::Constant(num_nodes, masses[0]);
    if (num_given == num_nodes) return Eigen::Map<const Eigen::VectorXd>(masses.data(), num_nodes);
    reject("vertexMass",
           fmt::format("{} values given for {} nodes, must be one or one per node", num_given, num_nodes));
  }

  Eigen::VectorXd rest_volumes(Eigen::Index num_nodes) {
    return nodal_volumes(measured_positions(*this),
                         hexahedra_on(*this, linked<scene::Topology>("topology"), static_cast<int>(num_nodes)));
  }
};

class MeshMatrixMass final : public scene::Mass {
 public:
  MeshMatrixMass() : Mass(attributes::kMeshMatrixMass) {}

  void init() override {
    is_lumped_ = boolean("lumping");
    auto& topology = linked<scene::Topology>("topology");
    if (topology.hexahedra().empty() && (!topology.quads().empty() || !topology.triangles().empty()))
      take_faces(topology);
    else
      take_hexahedra(topology);
    rayleigh_mass_ = real("rayleighMass");
  }

  void add_gravity(const Vec3& gravity, Points f) const override {
    hexaplast::add_gravity(is_lumped_ ? lumped_ : coupled_.row_sums(), gravity, f);
  }
  void add_product(double factor, ConstPoints dx, Points df) const override {
    if (is_lumped_)
      df += factor * lumped_.asDiagonal() * dx;
    else
      coupled_.add_product(factor, dx, df);
  }
  void add_blocks(double factor, BlockMatrix& A) const override {
    if (is_lumped_)
      add_blocks_of(lumped_, factor, A);
    else
      coupled_.add_blocks(factor, A);
  }
  bool add_diagonal(double factor, Points diagonal) const override {
    if (is_lumped_) diagonal.colwise() += factor * lumped_;
    return is_lumped_;
  }
  double rayleigh_mass() const override { return rayleigh_mass_; }

 private:
  void take_hexahedra(scene::Topology& topology) {
    const int num_nodes = needed_ready<scene::MechanicalState>().num_nodes();
    const std::vector<Hexahedron>& hexahedra = hexahedra_on(*this, topology, num_nodes);
    const std::vector<double> masses =
        element_masses(element_volumes(measured_positions(*this), hexahedra), "hexahedron");
    if (is_lumped_)
      lumped_ = nodal_masses(num_nodes, hexahedra, masses);
    else
      coupled_ = ConsistentMass(measured_positions(*this), hexahedra, masses);
  }

  /// Of a topology without hexahedra: its quads, or its triangles.
  void take_faces(scene::Topology& topology) {
    const int num_nodes = needed_ready<scene::MechanicalState>().num_nodes();
    require_same_nodes(*this, topology, num_nodes);
    const PointArray& x = measured_positions(*this);
    const auto take = [&](const auto& faces, const char* kind) {
      for (const auto& face : faces)
        for (const int node : face)
          if (node >= num_nodes)
            reject(fmt::format("a face has node {}, the mechanical state has {} nodes", node, num_nodes));
      std::vector<double> areas;
      for (const auto& face : faces) areas.push_back(area(face, x));
      coupled_ = ConsistentMass::of_faces(num_nodes, faces, element_masses(std::move(areas), kind));
    };
    if (!topology.quads().empty())
      take(topology.quads(), "quad");
    else
      take(topology.triangles(), "triangle");
    if (is_lumped_) lumped_ = coupled_.row_sums();
  }

  /// Two triangles, for a quad.
  template <std::size_t N>
  static double area(const std::array<int, N>& face, const PointArray& x) {
    double sum = 0;
    for (std::size_t a = 1; a + 1 < N; ++a) {
      const Eigen::RowVector3d to_a = x.row(face[a]) - x.row(face[0]), to_next = x.row(face[a + 1]) - x.row(face[0]);
      sum += to_a.cross(to_next).norm() / 2;
    }
    return sum;
  }

  std::vector<double> element_masses(std::vector<double> volumes, const char* kind) {
    if (is_given("totalMass") || !is_given("massDensity")) {
      if (is_given("massDensity")) remark(scene::Severity::kWarning, "massDensity", "is ignored: totalMass counts");
      const double density =
          real_if_given("totalMass").value_or(1) / std::accumulate(volumes.begin(), volumes.end(), 0.0);
      for (double& mass : volumes) mass *= density;
      return volumes;
    }
    const std::vector<double>& densities = reals("massDensity");
    if (densities.size() != 1 && densities.size() != volumes.size())
      reject("massDensity",
             fmt::format("{} values given, must be one or {} (one per {})", densities.size(), volumes.size(), kind));
    for (std::size_t e = 0; e < volumes.size(); ++e) volumes[e] *= densities[densities.size() == 1 ? 0 : e];
    return volumes;
  }

  bool is_lumped_ = false;
  Eigen::VectorXd lumped_;  // [kg] per node
  ConsistentMass coupled_;
  double rayleigh_mass_ = 0;
};

}  // namespace

void add_masses(scene::Factory& factory) {
  factory.add<UniformMass>(attributes::kUniformMass);
  factory.add<DiagonalMass>(attributes::kDiagonalMass);
  factory.add<MeshMatrixMass>(attributes::kMeshMatrixMass);
}

}  // namespace hexaplast::components
