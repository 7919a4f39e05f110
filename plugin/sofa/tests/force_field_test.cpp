// SPDX-License-Identifier: LGPL-2.1-or-later
// What SOFA demands of a force field: force, energy, product and matrix that fit together, and evaluation without
// memory.
#include <gtest/gtest.h>
#include <sofa/component/topology/container/dynamic/HexahedronSetTopologyModifier.h>
#include <sofa/core/MechanicalParams.h>
#include <sofa/linearalgebra/FullMatrix.h>

#include <algorithm>
#include <limits>
#include <random>

#include "block_scene.h"
#include "hexaplast/body.hpp"
#include "messages.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

using Field = sofa::core::objectmodel::Data<Vec3Types::VecDeriv>;

class ForceFieldChecks : public testing::Test
{
protected:
    PointArray random(double size, unsigned seed) const
    {
        std::mt19937 engine(seed);
        std::uniform_real_distribution<double> number(-size, size);
        PointArray field(rest.rows(), 3);
        for (Eigen::Index i = 0; i < field.size(); ++i) field.data()[i] = number(engine);
        return field;
    }
    PointArray force_at(const PointArray& x)
    {
        sofa::core::objectmodel::Data<Vec3Types::VecCoord> position;
        Field f, v;
        view(*position.beginEdit()) = PointArray(0, 3);
        position.beginEdit()->resize(x.rows());
        view(*position.beginEdit()) = x;
        v.beginEdit()->resize(x.rows());
        f.beginEdit()->resize(x.rows());
        scene.field().addForce(sofa::core::mechanicalparams::defaultInstance(), f, position, v);
        return view(f.getValue());
    }
    double energy_at(const PointArray& x)
    {
        sofa::core::objectmodel::Data<Vec3Types::VecCoord> position;
        position.beginEdit()->resize(x.rows());
        view(*position.beginEdit()) = x;
        return scene.field().getPotentialEnergy(sofa::core::mechanicalparams::defaultInstance(), position);
    }
    PointArray product(const PointArray& dx, const sofa::core::MechanicalParams& params)
    {
        Field df, d;
        d.beginEdit()->resize(dx.rows());
        view(*d.beginEdit()) = dx;
        df.beginEdit()->resize(dx.rows());
        scene.field().addDForce(&params, df, d);
        return view(df.getValue());
    }

    SofaScene scene = SofaScene::from_text(block(kPlastic));
    const PointArray rest = scene.positions();
    const PointArray deformed = rest + random(0.02, 1);
    sofa::core::MechanicalParams params;
};

TEST_F(ForceFieldChecks, ForceIsThatOfTheCoreAndSumsToNothing)
{
    Body body(scene.body().mesh(), scene.body().materials(), scene.body().settings());
    PointArray expected = PointArray::Zero(rest.rows(), 3);
    body.linearize(deformed);
    body.add_force(expected);
    const PointArray f = force_at(deformed);
    EXPECT_EQ(f, expected);
    EXPECT_LE(f.colwise().sum().norm(), 1e-12 * f.norm());
    EXPECT_LE(force_at(rest).norm(), 1e-12 * f.norm());
}

TEST_F(ForceFieldChecks, EnergyFallsAsTheForceWorks)
{
    const PointArray dx = random(1e-5, 2), f = force_at(deformed);
    const double change = energy_at(deformed + dx) - energy_at(deformed - dx);
    const double work = 2 * f.cwiseProduct(dx).sum();
    EXPECT_NEAR(change, -work, 1e-6 * std::abs(work));
}

TEST_F(ForceFieldChecks, ProductIsTheChangeOfTheForceNearRest)
{
    const PointArray dx = random(1e-6, 3);
    const PointArray change = (force_at(rest + dx) - force_at(rest - dx)) / 2;
    force_at(rest);
    params.setKFactor(1);
    EXPECT_LE((product(dx, params) - change).norm(), 1e-5 * change.norm());
}

TEST_F(ForceFieldChecks, FactorsAndRayleighDampingScaleTheProduct)
{
    const PointArray dx = random(1e-3, 4);
    force_at(deformed);
    params.setKFactor(1);
    const PointArray one = product(dx, params);
    params.setKFactor(-0.02);
    params.setBFactor(-0.5);
    scene.field().rayleighStiffness.setValue(0.1);
    EXPECT_LE((product(dx, params) - (-0.02 - 0.5 * 0.1) * one).norm(), 1e-12 * one.norm());
}

TEST_F(ForceFieldChecks, MatrixIsTheProduct)
{
    const PointArray dx = random(1e-3, 5);
    force_at(deformed);
    params.setKFactor(1);
    const PointArray expected = product(dx, params);
    const auto size = static_cast<int>(3 * rest.rows());
    sofa::linearalgebra::FullMatrix<SReal> K(size + 6, size + 6);
    K.clear();
    unsigned int offset = 6;
    scene.field().addKToMatrix(&K, 2, offset);
    PointArray found = PointArray::Zero(rest.rows(), 3);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) found.data()[i] += K.element(6 + i, 6 + j) * dx.data()[j];
    EXPECT_LE((found - 2 * expected).norm(), 1e-12 * found.norm());
    for (int i = 0; i < 6; ++i) EXPECT_EQ(K.element(i, i), 0);
}

TEST_F(ForceFieldChecks, EvaluationRemembersNothingAndOneStepFlowsOnce)
{
    const PointArray stretched = rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal();
    const PointArray first = force_at(stretched);
    params.setKFactor(1);
    for (int time = 0; time < 10; ++time)
    {
        force_at(deformed);
        energy_at(deformed);
        product(rest, params);
        sofa::linearalgebra::FullMatrix<SReal> K(static_cast<int>(rest.size()), static_cast<int>(rest.size()));
        unsigned int offset = 0;
        scene.field().addKToMatrix(&K, 1, offset);
    }
    EXPECT_EQ(force_at(stretched), first);
    EXPECT_EQ(scene.body().plastic_rest_positions(), rest);

    scene.move_to(stretched);
    scene.step();  // no solver: positions stay
    Body body(scene.body().mesh(), scene.body().materials(), scene.body().settings());
    body.flow(stretched, 0.01);
    EXPECT_EQ(scene.body().plastic_rest_positions(), body.plastic_rest_positions());
    EXPECT_NE(scene.body().plastic_rest_positions(), rest);

    scene.reset();
    EXPECT_EQ(scene.body().plastic_rest_positions(), rest);
}

TEST_F(ForceFieldChecks, OutputsShowThePlasticStateWhenTheyAreRead)
{
    const auto* strain = dynamic_cast<Data<VecReal>*>(scene.field().findData("plasticStrain"));
    const auto* released = scene.field().findData("plasticRestPositions");
    EXPECT_EQ(strain->getValue(), sofa::type::vector<SReal>(12, 0));
    const int counter = strain->getCounter();
    scene.move_to(rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    EXPECT_EQ(strain->getCounter(), counter) << "computed though nobody reads it";
    const int ofReleased = released->getCounter();
    const ElementFields fields = scene.body().fields(scene.positions());
    ASSERT_EQ(strain->getValue().size(), fields.plastic_strain.size());
    for (std::size_t e = 0; e < fields.plastic_strain.size(); ++e)
    {
        EXPECT_GT(fields.plastic_strain[e], 0);
        EXPECT_EQ(strain->getValue()[e], fields.plastic_strain[e]);
        EXPECT_GT(fields.stress_norm[e], 0);
        EXPECT_EQ(value_of<VecReal>(scene.field(), "stressNorm")[e], fields.stress_norm[e]);
    }
    EXPECT_EQ(released->getCounter(), ofReleased) << "an equilibrium nobody asks for";
    EXPECT_EQ(PointArray(view(value_of<Vec3Types::VecCoord>(scene.field(), "plasticRestPositions"))),
              scene.body().plastic_rest_positions());
    scene.reset();
    EXPECT_EQ(strain->getValue(), sofa::type::vector<SReal>(12, 0));
}

TEST_F(ForceFieldChecks, AMaterialMayChangeDuringTheRun)
{
    scene.move_to(rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    const PointArray released = scene.body().plastic_rest_positions(), f = force_at(deformed);
    const auto strain = value_of<VecReal>(scene.field(), "plasticStrain");
    scene.set("body", "youngModulus", "15000");
    EXPECT_EQ(force_at(deformed), f) << "nothing changes within a step";
    scene.field().reinit();
    EXPECT_LE((force_at(deformed) - 3 * f).norm(), 1e-10 * f.norm());
    EXPECT_EQ(value_of<VecReal>(scene.field(), "plasticStrain"), strain);
    EXPECT_LE((scene.body().plastic_rest_positions() - released).cwiseAbs().maxCoeff(), 1e-5) << "to 1e-4 of an edge";

    scene.move_to(rest);
    scene.set("body", "youngModulus", "5000");
    scene.step();
    EXPECT_EQ(scene.body().material(0).young_modulus, 5000) << "or with the next step";

    Messages messages;
    scene.set("body", "yieldNorm", "spectral");
    scene.field().reinit();
    EXPECT_TRUE(isInvalid(scene.field()));
    EXPECT_EQ(messages.count("yieldNorm: cannot change during a run"), 1) << messages.text();
    scene.set("body", "yieldNorm", "vonMises");
    scene.field().reinit();
    EXPECT_FALSE(isInvalid(scene.field())) << "the value is taken back";
}

TEST(ForceField, HalfFullHexahedraOfASparseGridCarryHalf)
{
    SofaScene scene = SofaScene::from_text(block(
        kPlastic, "<SparseGridTopology name='cage' fileTopology='" HEXAPLAST_SCENES "/mesh/liver.obj' n='16 7 10'/>"));
    const std::vector<Material>& materials = scene.body().materials();
    ASSERT_EQ(materials.size(), static_cast<std::size_t>(scene.body().mesh().num_elements()));
    EXPECT_EQ(materials.front().young_modulus, 2500) << "cells that the surface passes through come first";
    EXPECT_EQ(materials.front().yield_stress, 50);
    EXPECT_EQ(materials.back().young_modulus, 5000);
}

// SOFA would go on with the first word.
TEST(ForceField, AWordThatIsRefusedStaysSoUntilAnotherIsGiven)
{
    SofaScene scene = SofaScene::from_text(block(kPlastic + R"( yieldNorm="frobenus")"));
    for (int time = 0; time < 2; ++time)
    {
        EXPECT_TRUE(isInvalid(scene.field()));
        scene.field().reinit();
    }
    scene.set("body", "yieldNorm", "frobenius");
    scene.field().reinit();
    EXPECT_FALSE(isInvalid(scene.field()));
    EXPECT_EQ(scene.body().settings().yield_norm, YieldNorm::kFrobenius);
}

TEST(ForceField, AStepThatIsLostKeepsTheHistory)
{
    SofaScene scene = SofaScene::from_text(block(kPlastic));
    const PointArray rest = scene.positions(), stretched = rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal();
    scene.move_to(stretched);
    scene.step();
    const PointArray flowed = scene.body().plastic_rest_positions();
    PointArray lost = stretched;
    lost(4, 1) = std::numeric_limits<double>::quiet_NaN();
    scene.move_to(lost);
    for (int step = 0; step < 2; ++step)
    {
        scene.step();
        EXPECT_TRUE(isInvalid(scene.field()));
        EXPECT_EQ(scene.body().plastic_rest_positions(), flowed);
    }

    scene.reset();
    EXPECT_FALSE(isInvalid(scene.field())) << "the step that was lost is forgotten";
    EXPECT_EQ(scene.body().plastic_rest_positions(), rest);
    scene.move_to(stretched);
    scene.step();
    EXPECT_EQ(scene.body().plastic_rest_positions(), flowed);
}

TEST(ForceField, BodiesOfOneNodeDoNotKnowEachOther)
{
    SofaScene scene = SofaScene::from_text(
        block(kPlastic, kGrid, "", "<HexahedronElastoplasticFEMForceField name='stiff' youngModulus='30000'/>"));
    auto& stiff = dynamic_cast<SofaScene::Field&>(scene.named("stiff"));
    const PointArray rest = scene.positions();
    scene.move_to(rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    EXPECT_NE(scene.body().plastic_rest_positions(), rest);
    EXPECT_EQ(stiff.body()->plastic_rest_positions(), rest);
    scene.set("body", "youngModulus", "-1");
    scene.step();
    EXPECT_TRUE(isInvalid(scene.field()));
    EXPECT_FALSE(isInvalid(stiff));
}

// Positions change several times between the events of a step; the body flows once, by the whole of it.
TEST(ForceField, FlowsOncePerStepOfAMultiStepAnimationLoop)
{
    std::string text = block(kPlastic, kGrid, "",
                             "<EulerImplicitSolver rayleighStiffness='0' rayleighMass='0'/><CGLinearSolver "
                             "iterations='50' tolerance='1e-9' threshold='1e-30'/><UniformMass totalMass='1'/>"
                             "<ConstantForceField indices='27 28 29 30 31 32 33 34 35' totalForce='0 0 10'/>");
    const std::string loop = "<DefaultAnimationLoop/>";
    text.replace(text.find(loop), loop.size(),
                 "<RequiredPlugin pluginName='Sofa.Component.AnimationLoop'/>"
                 "<MultiStepAnimationLoop collisionSteps='2' integrationSteps='2'/>" +
                     required({"ODESolver.Backward", "LinearSolver.Iterative", "Mass", "MechanicalLoad"}));
    SofaScene scene = SofaScene::from_text(text);
    Body body(scene.body().mesh(), scene.body().materials(), scene.body().settings());
    for (int step = 0; step < 5; ++step)
    {
        scene.step();
        body.flow(scene.positions(), 0.01);
        EXPECT_EQ(scene.body().plastic_rest_positions(), body.plastic_rest_positions()) << step;
    }
    EXPECT_NE(body.plastic_rest_positions(), PointArray(view(scene.state().readRestPositions().ref())));
}

// What an instrument stores in its springs, against the work on a small way.
TEST(InstrumentContactForceField, EnergyRisesAsItsForceIsWorkedAgainst)
{
    SofaScene scene = SofaScene::from_text(block(
        "", kGrid, "",
        "<GraspForceField name='tool' template='Vec3d' radius='0.15' keyTimes='0' positions='0 0 0.3' "
        "stiffness='800' maxForce='12'/><TangentialForceField name='wheel' template='Vec3d' indices='3' axis='0 0 1' "
        "times='0' forces='2'/>"));
    const PointArray rest = scene.positions();
    scene.step();  // it closes
    std::vector<ForceOnState*> fields;
    scene.root().get<ForceOnState>(&fields, sofa::core::objectmodel::BaseContext::SearchDown);
    ASSERT_EQ(fields.size(), 3u);
    const auto* params = sofa::core::mechanicalparams::defaultInstance();
    const auto energy_at = [&](ForceOnState& field, const PointArray& x)
    {
        sofa::core::objectmodel::Data<Vec3Types::VecCoord> position;
        position.beginEdit()->resize(x.rows());
        view(*position.beginEdit()) = x;
        return field.getPotentialEnergy(params, position);
    };
    ForceOnState& tool = *fields[1];
    EXPECT_EQ(energy_at(tool, rest), 0);
    PointArray x = rest;
    x.rowwise() += Eigen::RowVector3d(0.003, 0, -0.004);  // the springs of the grip, 800 N/m together, by 5 mm
    EXPECT_NEAR(energy_at(tool, x), 800 * 0.005 * 0.005 / 2, 1e-12);
    Messages messages;
    EXPECT_EQ(energy_at(*fields[2], x), 0);
    EXPECT_EQ(messages.count("its forces have no potential energy"), 1) << "they turn with their node";

    sofa::type::vector<sofa::Index> held;
    for (int n = 0; n < rest.rows(); ++n)
        if ((rest.row(n) - Eigen::RowVector3d(0, 0, 0.3)).norm() < 0.15) held.push_back(n);
    EXPECT_EQ(value_of<sofa::type::vector<sofa::Index>>(tool, "grasped"), held);
}

const std::string kSource = "<Node name='source'>" + kGrid + "</Node>";
const std::string kDynamicTopology = R"xml(
    <HexahedronSetTopologyContainer name="cells" position="@../source/grid.position" hexahedra="@../source/grid.hexahedra"/>
    <HexahedronSetTopologyModifier name="modifier" removeIsolated="false"/>)xml";

TEST(Topology, HexahedraThatSofaRemovesLeaveTheBody)
{
    SofaScene scene = SofaScene::from_text(block(kPlastic + R"( topology="@cells")", kDynamicTopology, kSource));
    auto& modifier = scene.only<sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier>();
    modifier.removeHexahedra({3});
    EXPECT_TRUE(std::ranges::equal(scene.body().removed(), std::vector<int>{3}));
    modifier.removeHexahedra({3, 0});  // the last one has taken the place of the third
    EXPECT_TRUE(
        std::ranges::equal(scene.body().alive(), std::vector<unsigned char>{0, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0}));
    scene.step();
    scene.reset();
    EXPECT_EQ(scene.body().removed().size(), 3u) << "the topology stays torn";
}

TEST(Topology, HexahedraThatBreakLeaveIt)
{
    const std::string breaking = kPlastic + R"( fractureStretch="1.001" topology="@cells")";
    SofaScene scene = SofaScene::from_text(block(breaking, kDynamicTopology, kSource));
    auto& cells = *scene.only<sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier>()
                       .getContext()
                       ->getMeshTopologyLink();
    ASSERT_EQ(cells.getNbHexahedra(), 12u);
    auto positions = scene.state().writePositions();
    // the upper slice alone is stretched
    for (auto& x : positions)
        if (x[2] > 0.25) x[2] += 0.1;
    for (int step = 0; step < 20; ++step) scene.step();
    EXPECT_EQ(scene.body().removed().size(), 4u);
    EXPECT_EQ(cells.getNbHexahedra(), 8u);
    for (const int e : scene.body().removed()) EXPECT_GE(e, 8);

    // outputs count hexahedra as the topology does
    const ElementFields fields = scene.body().fields(scene.positions());
    const auto& all = scene.body().mesh().hexahedra();
    for (sofa::Index i = 0; i < cells.getNbHexahedra(); ++i)
    {
        Hexahedron corners;
        for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(cells.getHexahedra()[i][a]);
        const auto e = std::find(all.begin(), all.end(), corners) - all.begin();
        EXPECT_EQ(value_of<VecReal>(scene.field(), "plasticStrain").at(i), fields.plastic_strain.at(e));
        EXPECT_NEAR(value_of<VecReal>(scene.field(), "volumeRatio").at(i), fields.volume_ratio.at(e), 1e-13);
    }
}

TEST(Topology, NodesMayNotGo)
{
    std::string renumbering = kDynamicTopology;
    renumbering.replace(renumbering.find("false"), 5, "true");
    SofaScene scene =
        SofaScene::from_text(block(kPlastic + R"( fractureStretch="1.001" topology="@cells")", renumbering, kSource));
    auto& field = scene.field();
    const PointArray rest = scene.positions();
    Messages messages;
    scene.move_to(rest * Eigen::Vector3d(1, 1, 1.5).asDiagonal());
    for (int step = 0; step < 10; ++step) scene.step();
    EXPECT_FALSE(scene.body().removed().empty());
    EXPECT_FALSE(isInvalid(field)) << "the topology stays whole";
    EXPECT_GT(messages.count("removeIsolated must be false"), 0) << messages.text();

    scene.only<sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier>().removeHexahedra({0});
    EXPECT_TRUE(isInvalid(field));
    scene.reset();
    EXPECT_TRUE(isInvalid(field)) << "for good";
    field.reinit();
    EXPECT_TRUE(isInvalid(field));
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
