// SPDX-License-Identifier: LGPL-2.1-or-later
// MultigridCGLinearSolver with what SOFA has beside our bodies, against SOFA's own solvers.
#include <Hexaplast/fields.h>
#include <gtest/gtest.h>

#include "block_scene.h"
#include "messages.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

const std::string kOurs = R"(<MultigridCGLinearSolver name="solver" tolerance="1e-11" iterations="500"/>)";
const std::string kConjugateGradients =
    R"(<CGLinearSolver template="GraphScattered" iterations="3000" tolerance="1e-12" threshold="1e-40"/>)";
const std::string kDirect = R"(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)";
const std::string kLumped = R"(<DiagonalMass massDensity="1000"/>)";

/// 3 x 3 x 4 cubes that hang under their weight from the nodes at z = 0, with what stands beside them.
std::string hanging(const std::string& solver, const std::string& beside = "", const std::string& mass = kLumped)
{
    return "<Node name='root' dt='0.01' gravity='3 0 -9.81'><DefaultAnimationLoop/>" +
           required({"AnimationLoop", "Constraint.Projective", "LinearSolver.Direct", "LinearSolver.Iterative",
                     "Mapping.Linear", "Mass", "MechanicalLoad", "ODESolver.Backward", "SolidMechanics.Spring",
                     "StateContainer", "Topology.Container.Grid"}) +
           "<Node name='tissue'><EulerImplicitSolver name='euler' rayleighMass='0' rayleighStiffness='0.02'/>" +
           solver +
           "<RegularGridTopology name='grid' n='4 4 5' min='0 0 -0.04' max='0.03 0.03 0'/>"
           "<MechanicalObject name='nodes' template='Vec3d'/>" +
           mass +
           "<HexahedronElastoplasticFEMForceField name='body' youngModulus='4000' poissonRatio='0.4' "
           "rayleighStiffness='0.1'/><FixedProjectiveConstraint indices='64-79'/>" +
           beside + "</Node></Node>";
}

struct Case
{
    std::string name, beside;
    std::string mass = kLumped;
    bool hasMatrix = true;  ///< SOFA's direct solvers can solve it
};
void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

class BesideOurBody : public testing::TestWithParam<Case>
{
};

TEST_P(BesideOurBody, MovesAsWithSolversOfSofa)
{
    const auto [name, beside, mass, hasMatrix] = GetParam();
    SofaScene ours = SofaScene::from_text(hanging(kOurs, beside, mass)),
              iterative = SofaScene::from_text(hanging(kConjugateGradients, beside, mass)),
              direct = SofaScene::from_text(hanging(kDirect, beside, mass));
    const PointArray rest = ours.positions();
    for (int step = 0; step < 15; ++step)
        for (SofaScene* scene : {&ours, &iterative, &direct}) scene->step();
    const double moved = (ours.positions() - rest).norm();
    EXPECT_GT(moved, 1e-4) << "something happened";
    EXPECT_LE((ours.positions() - iterative.positions()).norm(), 1e-8 * moved);
    if (hasMatrix)
    {
        EXPECT_LE((ours.positions() - direct.positions()).norm(), 1e-8 * moved);
    }
}

// One stiffness for all springs: of several, SOFA's matrix takes those at the numbers of the nodes.
INSTANTIATE_TEST_SUITE_P(
    All, BesideOurBody,
    testing::Values(
        Case{"lumped_masses", ""},
        Case{"masses_that_damp", "", R"(<DiagonalMass massDensity="1000" rayleighMass="9"/>)"},
        Case{"masses_that_couple_nodes", "", R"(<MeshMatrixMass massDensity="1000"/>)"},
        Case{"springs_of_sofa", R"(<RestShapeSpringsForceField points="3 7" stiffness="20"/>)"},
        Case{"dashpots_of_a_grip",
             "<GraspForceField radius='0.011' keyTimes='0 1' positions='0 0 -0.04 0.02 0 -0.03' "
             "stiffness='20' damping='7'/>"},
        Case{"an_oblique_plane", R"(<FixedPlaneProjectiveConstraint direction="0 0.6 0.8" indices="5 6"/>)", kLumped,
             false},
        Case{"a_plane_through_the_diagonal",
             R"(<FixedPlaneProjectiveConstraint direction="0.70710678118654757 -0.70710678118654757 0" indices="5"/>)",
             kLumped, false},
        Case{"points_that_follow",
             "<Node name='skin'><MechanicalObject template='Vec3d' position='0.01 0.01 -0.035 0.02 0.02 "
             "-0.03'/><ConstantForceField "
             "indices='0' forces='0.01 0 0'/><BarycentricMapping/></Node>"}),
    [](const auto& each) { return each.param.name; });

// As a plane that nothing touches.
TEST(MultigridCGInSofa, WhatActsNowhereChangesNoBit)
{
    SofaScene alone = SofaScene::from_text(hanging(kOurs)),
              beside = SofaScene::from_text(
                  hanging(kOurs, R"(<PlaneForceField normal="0 0 1" d="-9" stiffness="500" damping="0"/>)"));
    for (int step = 0; step < 5; ++step)
    {
        alone.step();
        beside.step();
    }
    EXPECT_EQ(alone.positions(), beside.positions());
}

TEST(MultigridCGInSofa, SaysWhatItDoesNotLike)
{
    const std::string few = replaced(kOurs, "500", "2"),
                      lattice = replaced(kOurs, "/>", R"( preconditioner="multigrid"/>)");
    const auto said = [](const std::string& text)
    {
        Messages messages;
        SofaScene scene = SofaScene::from_text(text);
        for (int step = 0; step < 2; ++step) scene.step();
        return messages.text();
    };
    const std::string plane = R"(<FixedPlaneProjectiveConstraint direction="0 0.6 0.8" indices="5"/>)";
    for (const auto& [text, words] :
         {std::pair(hanging(few), "stopped after 2 iterations"),
          {hanging(lattice), "needs a body whose hexahedra form a lattice"},
          {hanging(replaced(kOurs, "/>", R"( printLog="true"/>)")),
           "iterations, preconditioner diagonal, |r| / |b| = "},
          {hanging(kOurs, replaced(plane, "0 0.6 0.8", "1 -1 0")), "needs a direction of length 1"}})
    {
        EXPECT_NE(said(text).find(words), std::string::npos) << said(text);
        EXPECT_EQ(said(hanging(kOurs, plane)).find(words), std::string::npos);
    }
}

TEST(MultigridCGInSofa, RefusesValuesUntilTheyAreCorrected)
{
    Messages messages;
    SofaScene scene = SofaScene::from_text(hanging(replaced(kOurs, "1e-11", "0")));
    EXPECT_EQ(messages.count("MultigridCGLinearSolver.tolerance: 0"), 1) << messages.text();
    scene.step();
    EXPECT_EQ(messages.count("it does nothing in this step"), 1) << messages.text();
    EXPECT_EQ(scene.velocities().norm(), 0) << "no motion where there is no answer";
    scene.reset();
    EXPECT_TRUE(isInvalid(scene.named("solver"))) << "reset reads no Data";
    scene.set("solver", "tolerance", "1e-11");
    scene.named("solver").reinit();
    EXPECT_FALSE(isInvalid(scene.named("solver")));
    scene.step();
}

TEST(MultigridCGInSofa, GoesOnWithoutABodyThatIsInvalidForAWhile)
{
    SofaScene scene = SofaScene::from_text(hanging(kOurs));
    for (const std::string young : {"-5", "4000"})
    {
        scene.set("body", "youngModulus", young);
        scene.step();
        EXPECT_EQ(isInvalid(scene.field()), young == "-5");
        EXPECT_FALSE(isInvalid(scene.named("solver")));
    }
    scene.set("solver", "iterations", "0");
    scene.step();
    EXPECT_TRUE(isInvalid(scene.named("solver")));
    scene.set("solver", "iterations", "500");
    scene.step();
    EXPECT_FALSE(isInvalid(scene.named("solver"))) << "in the next step";
}

TEST(MultigridCGInSofa, RefusesRigidFramesThatMoveByThemselves)
{
    SofaScene scene = SofaScene::from_text(
        hanging(kOurs,
                "<Node name='tool'><MechanicalObject name='frames' template='Rigid3d' position='0 0 0 0 0 0 1'/>"
                "</Node>"));
    Messages messages;
    scene.root().setAnimate(true);
    scene.step();
    EXPECT_GT(messages.count("must be of template Vec3, which '/tissue/tool/frames' is not"), 0) << messages.text();
    EXPECT_TRUE(isInvalid(scene.named("solver")));
    scene.reset();
    EXPECT_FALSE(isInvalid(scene.named("solver"))) << "the step that was lost is forgotten";
}

// SOFA v26.06 moves no node whose own Node has a mapping, with its own solvers neither.
TEST(MultigridCGInSofa, MovesNodesThatAVisualModelFollows)
{
    const std::string visual = "<RequiredPlugin pluginName='Sofa.Component.Visual'/>",
                      mapping = "<IdentityMapping input='@/tissue/nodes' output='@/tissue/seen/skin'/>";
    const auto seen = [&](const std::string& below, const std::string& beside)
    {
        return SofaScene::from_text(hanging(
            kOurs,
            visual + "<Node name='seen'><VisualModelImpl name='skin' src='@../grid'/>" + below + "</Node>" + beside));
    };
    SofaScene alone = SofaScene::from_text(hanging(kOurs)), shown = seen(mapping, ""), inOwnNode = seen("", mapping);
    for (int step = 0; step < 5; ++step)
    {
        alone.step();
        shown.step();
    }
    EXPECT_EQ(alone.positions(), shown.positions());
    EXPECT_FALSE(followsAnother(inOwnNode.state()));
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
