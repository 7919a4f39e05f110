// SPDX-License-Identifier: LGPL-2.1-or-later
#include <memory>
#include <optional>

#include "attributes/stock.hpp"
#include "components/body_field.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/material_region.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "mesh/corner_sum_mass.hpp"
#include "mesh/lumped_mass.hpp"
#include "parts/dense_body.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {
namespace {

/// SOFA's elastic hexahedra as a force field.
class DenseHexahedronField : public BodyField {
 public:
  DenseHexahedronField(const attributes::Description& description, ElementMatrix matrix)
      : BodyField(description), matrix_(matrix) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    topology_ = &linked<scene::Topology>("topology");
    hexahedra_ = &hexahedra_on(*this, *topology_, state_->num_nodes());
    const DenseHexahedraSettings settings{.frame = parts::frame_of(text("method")), .matrix = matrix_};
    body_.emplace(accepted(*this, [&] {
      return parts::DenseBody(state_->rest_positions(), *hexahedra_, options(), settings, node().clock().dt);
    }));
    pass_on(*this, body_->take_warnings());
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  void refresh() override {
    try {
      accepted(*this, [&] { body_->set_options(options(), node().clock().dt); });
    } catch (const InputError& error) {
      reject(error.what());
    }
    pass_on(*this, body_->take_warnings());
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  void reset() override { body_->reset(); }
  void serialize(Archive& archive) override { body_->serialize(archive); }

  void add_force(double, ConstPoints x, ConstPoints, Points f) override { body_->hexahedra().add_force(x, f); }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    body_->hexahedra().add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    body_->hexahedra().add_stiffness_blocks(factor, A);
  }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  void end_step(double dt) override { body_->end_step(state_->positions(), dt); }

  const std::vector<Hexahedron>* hexahedra() const override { return hexahedra_; }
  const Body* body() const override { return body_ ? &body_->body() : nullptr; }
  const FlowReport* flow_report() const override { return body_ ? &body_->report() : nullptr; }
  void remove_elements(std::span<const int> elements) override {
    body_->remove(elements);
    if (const std::span<const int> gone = body_->take_removed(); !gone.empty()) scene::announce_removed(*this, gone);
  }

 private:
  parts::HexahedralBodyOptions options() {
    std::vector<parts::MaterialRegion> regions;
    for (MaterialRegion* region : MaterialRegion::all_of(*this)) regions.push_back(region->values(*hexahedra_));
    return parts::body_options([this](const auto& row) { return values_of(*this, row); }, hexahedra_->size(),
                               topology_->fill(), regions, published_element());
  }

 protected:
  ElementMatrix matrix() const { return matrix_; }
  scene::Topology& topology() const { return *topology_; }
  scene::MechanicalState& state() const { return *state_; }

 private:
  ElementMatrix matrix_;
  scene::MechanicalState* state_ = nullptr;
  scene::Topology* topology_ = nullptr;
  const std::vector<Hexahedron>* hexahedra_ = nullptr;
  std::optional<parts::DenseBody> body_;
  double rayleigh_stiffness_ = 0;
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
  double kinetic_energy(ConstPoints v) const override {
    PointArray momentum = PointArray::Zero(v.rows(), 3);
    add_product(1, v, momentum);
    return dot(v, momentum) / 2;
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
