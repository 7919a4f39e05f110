// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/made_topology.hpp"
#include "elastic/corotated_triangles.hpp"
#include "elastic/dense_tetrahedra.hpp"
#include "hexaplast/material/material.hpp"

namespace hexaplast::components {
namespace {

/// SOFA's elements of another shape than ours: they deform, and nothing else.
template <class Elements>
class ElasticField : public scene::ForceField {
 public:
  using ForceField::ForceField;

  void init() override {
    elements_.emplace(make(needed_ready<scene::MechanicalState>(), linked<scene::Topology>("topology")));
    rayleigh_stiffness_ = real("rayleighStiffness");
  }
  void refresh() override { init(); }

  void add_force(double, ConstPoints x, ConstPoints, Points f) override { elements_->add_force(x, f); }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    elements_->add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    elements_->add_stiffness_blocks(factor, A);
  }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

 protected:
  virtual Elements make(scene::MechanicalState& state, scene::Topology& topology) = 0;

  double value_of(const char* name, std::size_t element, std::size_t num_elements) {
    const std::vector<double>& values = reals(name);
    if (values.size() != 1 && values.size() != num_elements)
      reject(name, fmt::format("{} values given, must be one or {} (one per element)", values.size(), num_elements));
    return values[values.size() == 1 ? 0 : element];
  }

 private:
  std::optional<Elements> elements_;
  double rayleigh_stiffness_ = 0;
};

/// The hexahedra of a topology, cut into six tetrahedra each as SOFA's element does: mirrored from one to the next, as
/// far as a grid says which is the next.
std::vector<scene::Tetrahedron> cut_into_six(scene::Topology& topology) {
  static constexpr scene::Tetrahedron kSix[] = {{0, 5, 1, 6}, {0, 1, 3, 6}, {1, 3, 6, 2},
                                                {6, 3, 0, 7}, {6, 7, 0, 5}, {7, 5, 4, 0}};
  static constexpr Hexahedron kMirrored[] = {{1, 0, 3, 2, 5, 4, 7, 6},   // along x
                                             {3, 2, 1, 0, 7, 6, 5, 4},   // along y
                                             {4, 5, 6, 7, 0, 1, 2, 3}};  // along z
  auto* made = dynamic_cast<MadeTopology*>(&topology);
  const auto [nx, ny] = made ? made->cells_across() : std::array<int, 2>{2, 1};
  std::vector<scene::Tetrahedron> tetrahedra;
  int i = 0;
  for (Hexahedron corners : topology.hexahedra()) {
    const bool mirrors[] = {i % nx % 2 == 0, i / nx % ny % 2 == 1, i / (nx * ny) % 2 == 1};
    for (int d = 0; d < 3; ++d) {
      if (!mirrors[d]) continue;
      const Hexahedron before = corners;
      for (int a = 0; a < kCorners; ++a) corners[a] = before[kMirrored[d][a]];
    }
    for (const scene::Tetrahedron& one : kSix)
      tetrahedra.push_back({corners[one[0]], corners[one[1]], corners[one[2]], corners[one[3]]});
    ++i;
  }
  return tetrahedra;
}

class TetrahedronFEMForceField final : public ElasticField<DenseTetrahedra> {
 public:
  TetrahedronFEMForceField() : ElasticField(attributes::kTetrahedronFEMForceField) {}

 private:
  DenseTetrahedra make(scene::MechanicalState& state, scene::Topology& topology) override {
    std::vector<scene::Tetrahedron> tetrahedra = topology.tetrahedra();
    if (tetrahedra.empty()) tetrahedra = cut_into_six(topology);
    if (tetrahedra.empty()) reject("topology", "has neither tetrahedra nor hexahedra");
    std::vector<Lame> all;
    for (std::size_t e = 0; e < tetrahedra.size(); ++e)
      all.push_back(
          lame(value_of("youngModulus", e, tetrahedra.size()), value_of("poissonRatio", e, tetrahedra.size())));
    return DenseTetrahedra(state.rest_positions(), std::move(tetrahedra), all, frame());
  }

  TetrahedronFrame frame() {
    const std::string& method = text("method");
    if (method == "small") return TetrahedronFrame::kWorld;
    return method == "polar" ? TetrahedronFrame::kPolar : TetrahedronFrame::kFirstEdges;
  }
};

/// TriangularFEMForceField and TriangleFEMForceField.
class TriangleField final : public ElasticField<CorotatedTriangles> {
 public:
  using ElasticField::ElasticField;

 private:
  CorotatedTriangles make(scene::MechanicalState& state, scene::Topology& topology) override {
    std::vector<Triangle> triangles = topology.triangles();
    auto* made = dynamic_cast<MadeTopology*>(&topology);
    if (triangles.empty() && made) triangles = made->halves_of_quads();
    const bool has_thickness = find_data("thickness");
    if (triangles.empty() && has_thickness) triangles = halves(topology.quads());
    if (triangles.empty()) reject("topology", "has no triangles");
    const double thickness = has_thickness ? real("thickness") : 1;
    std::vector<CorotatedTriangles::Membrane> membranes;
    for (std::size_t e = 0; e < triangles.size(); ++e)
      membranes.push_back({.young_modulus = thickness * value_of("youngModulus", e, triangles.size()),
                           .poisson_ratio = value_of("poissonRatio", e, triangles.size()),
                           .is_plane_strain = has_thickness && boolean("planeStrain")});
    return CorotatedTriangles(state.rest_positions(), std::move(triangles), membranes);
  }

  static std::vector<Triangle> halves(const std::vector<Quad>& quads) {
    std::vector<Triangle> triangles;
    for (const Quad& quad : quads) {
      triangles.push_back({quad[0], quad[1], quad[2]});
      triangles.push_back({quad[0], quad[2], quad[3]});
    }
    return triangles;
  }
};

}  // namespace

void add_simplices(scene::Factory& factory) {
  factory.add<TetrahedronFEMForceField>(attributes::kTetrahedronFEMForceField);
  for (const attributes::Description* description :
       {&attributes::kTriangularFEMForceField, &attributes::kTriangleFEMForceField})
    factory.add(*description, [description] { return std::make_unique<TriangleField>(*description); });
}

}  // namespace hexaplast::components
