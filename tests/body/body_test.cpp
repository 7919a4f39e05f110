// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Eigen/Eigenvalues>

#include "element/samples.hpp"
#include "plastic/isolated_flow.hpp"
#include "support/bar.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

const Material kYielding = stretching(100), kTurning = yielding(100, 0.01);

/// A distorted block that has yielded already, and current positions at which it goes on yielding.
class YieldingBody : public testing::Test {
 protected:
  YieldingBody() { body.flow(current, kStep); }

  PointArray force() const {
    PointArray f = PointArray::Zero(current.rows(), 3);
    body.add_force(f);
    return f;
  }
  PointArray product(const PointArray& dx) const {
    PointArray df = PointArray::Zero(current.rows(), 3);
    body.add_stiffness_product(-1, dx, df);
    return df;
  }
  std::string history_hash() const { return hash_of(body); }

  Random random{161};
  Body body{distorted_block({2, 2, 3}, kEdge, 0.15, 162), {kYielding}};
  PointArray current = body.mesh().positions() + random.field(36, 0.2 * kEdge);
  PointArray elsewhere = body.mesh().positions() + random.field(36, 0.5 * kEdge);
};

TEST_F(YieldingBody, IsNotChangedByEvaluation) {
  const std::string before = history_hash();
  body.linearize(current);
  const PointArray f = force(), df = product(elsewhere);
  const double energy = body.energy(current);
  body.energy(elsewhere);
  body.fields(elsewhere);
  EXPECT_EQ(force(), f) << "the linearization stays";
  EXPECT_EQ(product(elsewhere), df);

  body.linearize(elsewhere);
  force();
  body.fields(elsewhere);
  body.energy(elsewhere);
  EXPECT_EQ(history_hash(), before);

  body.linearize(current);
  EXPECT_EQ(force(), f);
  EXPECT_EQ(product(elsewhere), df);
  EXPECT_EQ(body.energy(current), energy);
}

TEST_F(YieldingBody, AddsToWhatIsThere) {
  PointArray f = elsewhere;
  const PointArray added = force_at(body, current);
  body.add_force(f);
  EXPECT_LE(max_abs(f - elsewhere - added), 1e-12 * max_abs(added));
}

TEST_F(YieldingBody, RefusesTimeStepsAndKeepsItsHistory) {
  const std::string before = history_hash();
  for (const double dt : {0.0, -0.01, -1e300, double(NAN), double(INFINITY)})
    EXPECT_TRUE(refuses<InputError>([&] { body.flow(current, dt); }, {"dt = ", "(0, inf)"})) << dt;
  EXPECT_EQ(history_hash(), before);
  Body joined(body.mesh(), body.materials(), kJoined);
  EXPECT_TRUE(refuses<InputError>([&] { joined.flow(current, 0.5); }, {"flow_rate", "dt"}));
  Body restoring(body.mesh(), body.materials(), {.rest_shape = RestShape::kJoined, .volume_restitution = 100});
  EXPECT_TRUE(refuses<InputError>([&] { restoring.flow(current, kStep); }, {"volume_restitution"}));

  Body fresh(body.mesh(), body.materials(), body.settings());
  EXPECT_THROW(fresh.flow(current, 0), InputError) << "also as the first";
  fresh.flow(current, kStep);
  fresh.set_materials(body.materials());
  EXPECT_THROW(fresh.flow(current, 0), InputError);
}

TEST_F(YieldingBody, KeepsTheArraysOfItsMeshWhereTheyAre) {
  const double* const nodes = body.mesh().positions().data();
  const Hexahedron* const hexahedra = body.mesh().hexahedra().data();
  std::stringstream saved;
  body.save(saved);
  body.load(saved);
  body.set_materials(body.materials());
  const Body moved = std::move(body);
  EXPECT_EQ(moved.mesh().positions().data(), nodes);
  EXPECT_EQ(moved.mesh().hexahedra().data(), hexahedra);
}

TEST_F(YieldingBody, RefusesHexahedraThatAreNotThere) {
  for (const int hexahedron : {-1, body.mesh().num_elements()}) {
    EXPECT_THROW(body.material(hexahedron), InputError);
    EXPECT_THROW(body.initial_volume(hexahedron), InputError);
    EXPECT_THROW(body.element_rest_shape(hexahedron), InputError);
  }
}

// Squares of large positions are beyond all numbers, they themselves are not.
TEST_F(YieldingBody, RefusesWhatIsNotFiniteAndKeepsItsHistory) {
  Body plain(body.mesh(), body.materials(), {.implementation = Implementation::kPlain});
  for (Body* of : {&body, &plain}) {
    const std::string before = hash_of(*of);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      PointArray spoiled = current;
      spoiled(7, 2) = bad;
      EXPECT_TRUE(refuses<NumericalError>([&] { of->flow(spoiled, kStep); }, {"node 7"}));
    }
    for (const double scale : {1e155, 1e200, 1e300})
      EXPECT_TRUE(refuses<NumericalError>([&] { of->flow(scale * current, kStep); }, {"not finite"}));
    EXPECT_EQ(hash_of(*of), before);
    EXPECT_GT(of->flow(current, kStep).yielded, 0) << "it goes on as if nothing had been";
  }
}

TEST(Fields, AreThoseOfEachHexahedronByItself) {
  const HexMesh mesh = distorted_block({5, 4, 3}, 0.01, 0.2, 71);
  const PointArray at_flow = mesh.positions() + Random(72).field(mesh.num_nodes(), 0.002),
                   x = mesh.positions() + Random(73).field(mesh.num_nodes(), 0.003);
  const Material elastic{.young_modulus = 1e4, .poisson_ratio = 0.45};
  for (const auto& [material, settings] : std::initializer_list<std::pair<Material, Settings>>{
           {elastic, {.law = ElasticLaw::kStableNeoHookean}},
           {kYielding, {.yield_norm = YieldNorm::kFrobenius}},
           {kYielding, {.yield_stress_measure = YieldStressMeasure::kCauchy}},
           {kYielding, {.relaxation = {0.5, 0.1}, .yield_norm = YieldNorm::kSpectral}}}) {
    Body body(mesh, {material}, settings);
    body.set_time_step(kStep);
    body.flow(at_flow, kStep);
    body.remove(std::array{7});
    const History& history = body.state().history;
    const std::vector<BranchStep> sudden = branch_steps(settings, 0);
    const ElementFields fields = body.fields(x);
    for (int e = 0; e < mesh.num_elements(); ++e) {
      const Hexahedron& corners = mesh.hexahedra()[e];
      const ElementPoints rest = gather(history.plastic_rest_positions, corners);
      const CornerTensors* G = history.plastic_inverse_of(e);
      ElementSamples samples = element_samples(rest, gather(x, corners), body.state().model.lame[e], settings, G,
                                               history.branches(sudden).of(e));
      if (G) samples.stress = isolated_stress(rest, *G, samples, settings.yield_stress_measure).relieved;
      double norm = 0, strain = 0;
      for (int i = 0; i < kCorners && e != 7; ++i) {
        norm = std::max(norm, stress_norm(samples.stress[i], settings.yield_norm));
        const Eigen::SelfAdjointEigenSolver<Mat3> stretch(samples.polar[i].S);
        strain = std::max(strain, (stretch.eigenvalues().array() - 1).abs().maxCoeff());
      }
      EXPECT_NEAR(fields.stress_norm[e], norm, 1e-10 * norm);
      EXPECT_NEAR(fields.strain[e], strain, 1e-11);
      EXPECT_NEAR(fields.volume_ratio[e], e == 7 ? 0 : 1, 1e-12);
      if (!G || e == 7) continue;
      const CornerValues& flowed = history.plastic_strain[e];
      EXPECT_EQ(fields.yield_stress[e], std::ranges::max(history.yield_stress[e]));
      EXPECT_NEAR(fields.plastic_strain[e], std::accumulate(flowed.begin(), flowed.end(), 0.0) / 8, 1e-15);
    }
  }
}

TEST_F(YieldingBody, IsCopiedWithAllThatItIs) {
  Body copy(body), assigned(body.mesh(), {Material{}});
  assigned = copy;
  EXPECT_EQ(hash_of(copy), hash_of(body));
  copy.flow(elsewhere, kStep);
  EXPECT_NE(hash_of(copy), hash_of(body)) << "a copy goes on by itself";
  EXPECT_EQ(hash_of(assigned), hash_of(body));
  EXPECT_EQ(assigned.material(0).yield_stress, body.material(0).yield_stress);
}

TEST(Body, WithoutElementsOrWithUnsupportedNodesIsHarmless) {
  Body none(HexMesh(PointArray::Zero(3, 3), {}), {kYielding});
  PointArray f = PointArray::Zero(3, 3);
  none.linearize(f);
  none.add_force(f);
  EXPECT_TRUE(f.isZero(0));
  EXPECT_EQ(none.flow(f, kStep).yielded, 0);

  PointArray positions(9, 3);
  positions << PointArray(cube(1)), 5, 5, 5;
  Body unsupported(HexMesh(positions, {Hexahedron{0, 1, 2, 3, 4, 5, 6, 7}}), {kYielding});
  PointArray current = mapped(positions, Vec3(1.1, 1, 1).asDiagonal());
  EXPECT_EQ(unsupported.flow(current, kStep).yielded, 1);
  EXPECT_EQ(unsupported.state().history.plastic_rest_positions.row(8), positions.row(8));
}

TEST(Body, WithElementsTakenOutIsTheBodyThatNeverHadThem) {
  const HexMesh whole = distorted_block({2, 2, 3}, 0.1, 0.2, 11);
  const std::vector<int> gone = {1, 7, 7};
  std::vector<Hexahedron> left = whole.hexahedra();
  left.erase(left.begin() + 7);
  left.erase(left.begin() + 1);
  Body body(whole, {kYielding}), smaller(HexMesh(whole.positions(), left), {kYielding});
  body.remove(gone);
  EXPECT_EQ(body.state().history.removed, (std::vector<int>{1, 7}));
  EXPECT_THROW(body.remove(std::vector<int>{12}), InputError);
  EXPECT_THROW(body.remove(std::vector<int>{-1}), InputError);

  const PointArray x = stretched_and_twisted(whole, 1.3, 0.4);
  for (int step = 0; step < 5; ++step) {
    body.flow(x, kStep);
    smaller.flow(x, kStep);
  }
  EXPECT_GT(max_abs(body.plastic_rest_positions() - whole.positions()), 1e-4);
  EXPECT_TRUE(agrees(force_at(body, x), force_at(smaller, x), 1e-10));
  EXPECT_NEAR(body.volume(x), smaller.volume(x), 1e-15);
}

TEST(Body, OfAnotherMaterialKeepsWhatFlowed) {
  const HexMesh mesh = distorted_block({2, 2, 3}, 0.1, 0.2, 11);
  Material soft = kYielding, hard = soft;
  soft.hardening = hard.hardening = 0.5;
  hard.young_modulus *= 3;
  hard.yield_stress += 100;
  Body body(mesh, {soft});
  const PointArray x = stretched_and_twisted(mesh, 1.3, 0.4);
  for (int step = 0; step < 5; ++step) body.flow(x, kStep);
  const History before = body.state().history;
  EXPECT_THROW(body.set_materials({soft, hard}), InputError);
  const PointArray f = force_at(body, x);
  body.set_materials({hard});
  EXPECT_TRUE(agrees(force_at(body, x), PointArray(3 * f), 1e-9)) << "the force is linear in E";
  EXPECT_EQ(body.state().history.plastic_inverse, before.plastic_inverse);
  EXPECT_EQ(body.state().history.plastic_strain, before.plastic_strain);
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (int i = 0; i < kCorners; ++i)
      EXPECT_DOUBLE_EQ(body.state().history.yield_stress[e][i], before.yield_stress[e][i] + 100);

  hard.yield_stress = std::numeric_limits<double>::infinity();
  body.set_materials({hard});
  body.flow(x, kStep);
  EXPECT_EQ(body.state().history.plastic_inverse, before.plastic_inverse) << "an elastic body does not flow";

  body.set_materials({soft});
  EXPECT_EQ(body.state().history.yield_stress[0][0], soft.yield_stress);
  EXPECT_GT(body.flow(x, kStep).yielded, 0);
  body.reset();
  Body fresh(mesh, {soft});
  fresh.flow(x, kStep);
  body.flow(x, kStep);
  EXPECT_EQ(body.state().history.plastic_inverse, fresh.state().history.plastic_inverse);

  Body elastic(mesh, {hard});
  EXPECT_TRUE(elastic.state().history.plastic_inverse.empty()) << "nothing is kept for what cannot flow";
  elastic.flow(x, kStep);
  elastic.set_materials({soft});
  elastic.flow(x, kStep);
  EXPECT_EQ(hash_of(elastic), hash_of(fresh));
}

TEST(Body, KeepsThresholdsOfRotationFromTheMaterialThatTurns) {
  const HexMesh mesh = block({2, 2, 3}, 0.1);
  Material turning = kTurning, stiff = kTurning;
  turning.hardening = 0.5;
  turning.rotation_yield = 0.02;
  turning.rotation_flow_rate = 4;
  stiff.rotation_flow_rate = 0;
  const PointArray x = stretched_and_twisted(mesh, 1.1, 0.6);
  Body body(mesh, {stiff}, kJoined);
  body.flow(x, kStep);
  EXPECT_TRUE(body.state().history.rotation_yield.empty()) << "nothing is kept for what cannot turn";

  body.set_materials({turning});
  EXPECT_EQ(body.state().history.rotation_yield[0][0], 0.02);
  for (int step = 0; step < 5; ++step) body.flow(x, kStep);
  const std::vector<CornerValues> hardened = body.state().history.rotation_yield;
  EXPECT_GT(hardened[0][0], 0.02);
  body.set_materials({stiff});
  body.flow(x, kStep);
  turning.rotation_yield += 0.01;
  body.set_materials({turning});
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (int i = 0; i < kCorners; ++i)
      EXPECT_DOUBLE_EQ(body.state().history.rotation_yield[e][i], hardened[e][i] - 0.02 + 0.03) << "element " << e;

  body.set_materials({stiff});
  body.reset();
  Body fresh(mesh, {stiff}, kJoined);
  for (int step = 0; step < 3; ++step) {
    body.flow(x, kStep);
    fresh.flow(x, kStep);
  }
  EXPECT_EQ(hash_of(body), hash_of(fresh));
}

TEST(Body, RemembersPlasticStretchFromTheMaterialThatBreaksByIt) {
  const HexMesh mesh = block({2, 2, 2}, 0.1);
  Material m = kTurning;
  Body body(mesh, {m}, kJoined);
  const PointArray x = stretched_and_twisted(mesh, 1.5, 0);
  body.flow(x, kStep);
  m.fracture_stretch = 1.001;
  body.set_materials({m});
  EXPECT_TRUE(body.state().history.removed.empty());
  for (int step = 0; step < 20; ++step) body.flow(x, kStep);
  EXPECT_EQ(body.state().history.removed.size(), 8u);
}

}  // namespace
}  // namespace hexaplast
