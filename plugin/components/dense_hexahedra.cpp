// SPDX-License-Identifier: LGPL-2.1-or-later
#include <memory>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part_body_field.hpp"
#include "mesh/corner_sum_mass.hpp"
#include "mesh/lumped_mass.hpp"
#include "parts/dense_body.hpp"

namespace hexaplast::components {
namespace {

/// SOFA's elastic hexahedra as a force field.
class DenseHexahedronField : public PartBodyField<parts::DenseBody> {
 public:
  DenseHexahedronField(const attributes::Description& description, ElementMatrix matrix)
      : PartBodyField(description), matrix_(matrix) {}

  void add_force(double, ConstPoints x, ConstPoints, Points f) override { part().hexahedra().add_force(x, f); }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    part().hexahedra().add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    part().hexahedra().add_stiffness_blocks(factor, A);
  }

 protected:
  ElementMatrix matrix() const { return matrix_; }

 private:
  parts::DenseBody make(parts::HexahedralBodyOptions options, double dt) override {
    const DenseHexahedraSettings settings{.frame = parts::frame_of(text("method")), .matrix = matrix_};
    return {state().rest_positions(), *hexahedra(), std::move(options), settings, dt};
  }
  Settings other_settings() const override { return published_element(); }

  ElementMatrix matrix_;
};

/// SOFA's hexahedra that are their own mass.
class DenseHexahedronFieldAndMass final : public DenseHexahedronField, public scene::MassMatrix {
 public:
  using DenseHexahedronField::DenseHexahedronField;

  void init() override {
    DenseHexahedronField::init();
    make_mass();
  }
  void refresh() override {
    DenseHexahedronField::refresh();
    make_mass();
  }

  void add_gravity(const Vec3& gravity, Points f) const override {
    hexaplast::add_gravity(mass_.weighed(), gravity, f);
  }
  void add_product(double factor, ConstPoints dx, Points df) const override { mass_.add_product(factor, dx, df); }
  void add_blocks(double factor, BlockMatrix& A) const override { mass_.add_blocks(factor, A); }
  bool add_diagonal(double factor, Points diagonal) const override {
    if (mass_.is_lumped()) diagonal.colwise() += factor * mass_.lumped();
    return mass_.is_lumped();
  }
  double rayleigh_mass() const override { return rayleigh_mass_; }

 private:
  // Volumes are those of the edges at corner 0, as in SOFA.
  void make_mass() {
    const PointArray& rest = state().rest_positions();
    const double density = real("density");
    std::vector<double> masses;
    for (const Hexahedron& corners : *hexahedra()) {
      const auto edge = [&](int to) { return (rest.row(corners[to]) - rest.row(corners[0])).norm(); };
      masses.push_back(density * edge(1) * edge(3) * edge(4));
    }
    const std::span<const double> fill = topology().mass_fill();
    if (matrix() == ElementMatrix::kIntegrated)  // the other one does not ask the grid
      for (std::size_t e = 0; e < fill.size(); ++e) masses[e] *= fill[e];
    mass_ = CornerSumMass(static_cast<int>(rest.rows()), *hexahedra(), masses, boolean("lumpedMass"));
    rayleigh_mass_ = real("rayleighMass");
  }

  CornerSumMass mass_;
  double rayleigh_mass_ = 0;
};

}  // namespace

void add_dense_hexahedra(scene::Factory& factory) {
  const auto add = [&](const attributes::Description& description, ElementMatrix matrix) {
    factory.add(description,
                [&description, matrix] { return std::make_unique<DenseHexahedronField>(description, matrix); });
  };
  add(attributes::kHexahedronFEMForceField, ElementMatrix::kIntegrated);
  add(attributes::kParallelHexahedronFEMForceField, ElementMatrix::kIntegrated);
  add(attributes::kHexahedralFEMForceField, ElementMatrix::kCube);
  const auto add_with_mass = [&](const attributes::Description& description, ElementMatrix matrix) {
    factory.add(description,
                [&description, matrix] { return std::make_unique<DenseHexahedronFieldAndMass>(description, matrix); });
  };
  add_with_mass(attributes::kHexahedronFEMForceFieldAndMass, ElementMatrix::kIntegrated);
  add_with_mass(attributes::kHexahedralFEMForceFieldAndMass, ElementMatrix::kCube);
}

}  // namespace hexaplast::components
