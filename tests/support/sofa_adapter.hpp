// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <gtest/gtest.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>
#include <sofa/core/ObjectFactory.h>
#include <sofa/linearalgebra/BaseMatrix.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/AnimateEndEvent.h>

#include <string>
#include <utility>
#include <vector>

#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

extern "C" void registerObjects(sofa::core::ObjectFactory* factory);

/// The SOFA plugin's own files over the stand-in for SOFA's headers (sofa_standin/README.md): they compile, and do the
/// right thing at each of SOFA's calls. plugin/sofa/tests has the tests in SOFA itself.
namespace hexaplast::sofa_plugin::test {

using sofa::component::topology::container::constant::MeshTopology;
using sofa::core::objectmodel::BaseComponent;
using sofa::core::objectmodel::BaseContext;
using sofa::core::objectmodel::Data;
using sofa::core::objectmodel::New;
using sofa::simulation::AnimateBeginEvent;
using sofa::simulation::AnimateEndEvent;
using sofa::type::vector;
using DataTypes = Vec3Types;
using Field = PartForceField<Vec3Types>;
using Elastoplastic = HexahedronElastoplasticFEMForceField<Vec3Types>;
using support::Random;

inline constexpr double kStep = 0.02;  // [s]

using Attributes = std::vector<std::pair<std::string, std::string>>;

inline const Attributes kPlastic{{"youngModulus", "7000"},   {"poissonRatio", "0.3"},      {"yieldStress", "100"},
                                 {"plasticFlowRate", "2"},   {"rotationYield", "0.01"},    {"rotationFlowRate", "2"},
                                 {"hardening", "0.2"},       {"volumeRestitution", "1.5"}, {"averagingSteps", "2"},
                                 {"yieldNorm", "frobenius"}, {"averaging", "jacobi"},      {"implementation", "plain"}};

/// The same by hand.
inline Material plastic_material() {
  Material m;
  m.young_modulus = 7000;
  m.poisson_ratio = 0.3;
  m.yield_stress = 100;
  m.flow_rate = 2;
  m.rotation_yield = 0.01;
  m.rotation_flow_rate = 2;
  m.hardening = 0.2;
  return m;
}
inline Settings plastic_settings() {
  Settings s;
  s.volume_restitution = 1.5;
  s.averaging_steps = 2;
  s.yield_norm = YieldNorm::kFrobenius;
  s.averaging = AveragingMethod::kJacobi;
  s.implementation = Implementation::kPlain;
  return s;
}

inline Attributes with(Attributes attributes, const Attributes& more) {
  attributes.insert(attributes.end(), more.begin(), more.end());
  return attributes;
}

inline const sofa::core::ObjectFactory& factory() {
  static const sofa::core::ObjectFactory made = [] {
    sofa::core::ObjectFactory filled;
    registerObjects(&filled);
    return filled;
  }();
  return made;
}

inline std::string said() {
  std::string all;
  for (const auto& message : sofa_standin::messages()) all += message.text + "\n";
  return all;
}

inline std::string history_of(const Body& body) {
  StateHash hash;
  body.add_to(hash);
  return hash.text();
}

/// Sums what is added, with our own rows and columns behind it.
class DenseMatrix final : public sofa::linearalgebra::BaseMatrix {
 public:
  explicit DenseMatrix(int size) : values(Eigen::MatrixXd::Zero(size, size)) {}
  void add(int row, int column, SReal value) override { values(row, column) += value; }
  long rowSize() const override { return values.rows(); }

  Eigen::MatrixXd values;
};

/// 2 x 2 x 3 crooked hexahedra in a node below the root, and the components that a test gives it.
class Adapter : public testing::Test {
 protected:
  Adapter() {
    sofa_standin::messages().clear();
    root.setDt(kStep);
    auto& hexahedra = *cells.d_seqHexahedra.beginEdit();
    for (const Hexahedron& corners : mesh.hexahedra()) {
      auto& hexahedron = hexahedra.emplace_back();
      for (std::size_t a = 0; a < corners.size(); ++a) hexahedron[a] = static_cast<sofa::Index>(corners[a]);
    }
    for (const auto& field : {nodes.writeRestPositions(), nodes.writePositions(), nodes.writeVelocities()}) {
      auto writable = field;
      writable.resize(static_cast<std::size_t>(mesh.num_nodes()));
    }
    view(nodes.writeRestPositions().wref()) = mesh.positions();
    view(nodes.writePositions().wref()) = mesh.positions();
  }

  BaseComponent& make(const std::string& class_name, const Attributes& attributes) {
    BaseComponent& made = tissue.add(factory().entries.at(class_name).make(), "the" + class_name);
    for (const auto& [name, text] : attributes) EXPECT_TRUE(made.parseField(name, text)) << name;
    return made;
  }
  Field& make_field(const std::string& class_name, const Attributes& attributes) {
    auto& field = dynamic_cast<Field&>(make(class_name, attributes));
    field.init();
    return field;
  }
  Elastoplastic& make_body(const Attributes& attributes) {
    return dynamic_cast<Elastoplastic&>(make_field("HexahedronElastoplasticFEMForceField", attributes));
  }

  void move_to(const PointArray& x) { view(nodes.writePositions().wref()) = x; }
  template <class Event>
  void tell() {
    Event event(kStep);
    root.for_each([&](BaseComponent& each) {
      if (each.f_listening.getValue()) each.handleEvent(&event);
    });
  }
  /// A step that ends at x.
  void step(const PointArray& x) {
    tell<AnimateBeginEvent>();
    move_to(x);
    tell<AnimateEndEvent>();
    root.setTime(root.getTime() + kStep);
  }

  /// `f` plus the forces at x.
  PointArray force(Field& field, const PointArray& x, PointArray f) const {
    Data<DataTypes::VecCoord> position;
    Data<DataTypes::VecDeriv> forces, velocity;
    for (auto* data : {&position, &forces, &velocity}) data->beginEdit()->resize(static_cast<std::size_t>(x.rows()));
    view(*position.beginEdit()) = x;
    view(*forces.beginEdit()) = f;
    field.addForce(&params, forces, position, velocity);
    return view(forces.getValue());
  }
  PointArray force(Field& field, const PointArray& x) const { return force(field, x, zero); }

  PointArray product(Field& field, const PointArray& dx) const {
    Data<DataTypes::VecDeriv> direction, forces;
    for (auto* data : {&direction, &forces}) data->beginEdit()->resize(static_cast<std::size_t>(dx.rows()));
    view(*direction.beginEdit()) = dx;
    field.addDForce(&params, forces, direction);
    return view(forces.getValue());
  }
  double energy(Field& field, const PointArray& x) const {
    Data<DataTypes::VecCoord> position;
    position.beginEdit()->resize(static_cast<std::size_t>(x.rows()));
    view(*position.beginEdit()) = x;
    return field.getPotentialEnergy(&params, position);
  }
  static Eigen::VectorXd flat(const PointArray& field) {
    return Eigen::Map<const Eigen::VectorXd>(field.data(), field.size());
  }

  template <class T>
  static const T& value(const BaseComponent& component, const std::string& name) {
    return dynamic_cast<const Data<T>&>(*component.findData(name)).getValue();
  }

  const HexMesh mesh = support::distorted_block({2, 2, 3}, 0.1, 0.1, 11);
  const PointArray zero = PointArray::Zero(mesh.num_nodes(), 3);
  Random random{12};
  const PointArray deformed = mesh.positions() + random.field(mesh.num_nodes(), 0.015);
  const PointArray stretched = mesh.positions() * Eigen::Vector3d(0.9, 0.95, 1.3).asDiagonal();
  sofa::core::MechanicalParams params;

  BaseContext root;
  BaseContext& tissue = root.add_child("tissue");
  MeshTopology& cells = tissue.add(New<MeshTopology>::make(), "cells");
  MechanicalState& nodes = tissue.add(New<MechanicalState>::make(), "nodes");
};

}  // namespace hexaplast::sofa_plugin::test
