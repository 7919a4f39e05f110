// SPDX-License-Identifier: LGPL-2.1-or-later
// Several bodies in one system of SOFA: contact between tissues as in the embedded host, and what else joins them.
#include <Hexaplast/ContactOf.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <sstream>

#include "block_scene.h"
#include "embedded_scene.h"
#include "messages.h"
#include "parts/tissue_contact.hpp"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

using Contact = ContactOf<parts::Tissues>;

/// A shipped scene that is solved to a residual without influence.
std::string shipped(const std::string& name)
{
    std::ifstream file(std::filesystem::path(HEXAPLAST_SCENES) / (name + ".scn"));
    std::ostringstream text;
    text << file.rdbuf();
    return replaced(text.str(), R"(tolerance="0.001")", R"(tolerance="1e-10")");
}

PointArray positions(SofaScene& scene)
{
    std::vector<SofaScene::Field*> fields;
    scene.root().get<SofaScene::Field>(&fields, sofa::core::objectmodel::BaseContext::SearchDown);
    PointArray all(0, 3);
    for (SofaScene::Field* field : fields)
    {
        const auto x = view(field->getMState()->readPositions().ref());
        all.conservativeResize(all.rows() + x.rows(), 3);
        all.bottomRows(x.rows()) = x;
    }
    return all;
}

double size_of(const PointArray& x) { return (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm(); }

struct Differences
{
    double positions = 0;  ///< of the size of all
    int touching = 0, slipping = 0;
};

Differences compared(const std::string& text, int steps)
{
    SofaScene sofa = SofaScene::from_text(text);
    EmbeddedScene host(text);
    auto& contact = sofa.only<Contact>();
    const double size = size_of(positions(sofa));
    Differences found;
    for (int step = 0; step < steps; ++step)
    {
        sofa.step();
        host.step();
        found.positions = std::max(found.positions, (positions(sofa) - host.positions()).cwiseAbs().maxCoeff() / size);
        found.touching = std::max(found.touching, value_of<int>(contact, "touching"));
        found.slipping = std::max(found.slipping, value_of<int>(contact, "slipping"));
    }
    const auto output = [&](const char* name)
    { return host.output<scene::InteractionForceField>("TissueContactForceField", name); };
    const double force = 1e-3 + value_of<sofa::type::Vec3>(contact, "force").norm();
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(value_of<sofa::type::Vec3>(contact, "force")[k], output("force")[k], 1e-6 * force);
    EXPECT_NEAR(value_of<SReal>(contact, "depth"), output("depth")[0], 1e-9);
    EXPECT_EQ(value_of<int>(contact, "touching"), output("touching")[0]);
    EXPECT_EQ(value_of<int>(contact, "slipping"), output("slipping")[0]);
    std::cout << "largest difference in " << steps << " steps: " << found.positions << " of the size; "
              << found.touching << " points touched, " << found.slipping << " slipped\n";
    return found;
}

TEST(TissuesInSofa, TwoBodiesTouchAsInTheEmbeddedHost)
{
    const Differences found = compared(shipped("two_organs"), 150);
    EXPECT_LE(found.positions, 1e-9);
    EXPECT_GE(found.touching, 50) << "something happened";
    EXPECT_GE(found.slipping, 10);
}

// As shipped, the upper half lands with its nodes on the edges of the lower one: rounding decides on which side.
TEST(TissuesInSofa, ABodyTouchesItselfAsInTheEmbeddedHost)
{
    const Differences found = compared(shipped("fold"), 170);
    EXPECT_LE(found.positions, 1e-9);
    EXPECT_GE(found.touching, 50) << "something happened";
}

/// A block that lies on another one, with what joins them in the node above both, where `solver` is.
std::string two_blocks(const std::string& solver, const std::string& joint,
                       const std::string& loop = "<DefaultAnimationLoop/>")
{
    const std::string modules = required(
        {"AnimationLoop", "Constraint.Lagrangian.Correction", "Constraint.Lagrangian.Model",
         "Constraint.Lagrangian.Solver", "Constraint.Projective", "LinearSolver.Direct", "LinearSolver.Iterative",
         "Mass", "ODESolver.Backward", "SolidMechanics.Spring", "StateContainer", "Topology.Container.Grid"});
    const auto body =
        [](const std::string& name, const std::string& grid, const std::string& young, const std::string& behind)
    {
        return "<Node name=\"" + name + R"("><RegularGridTopology name="grid" )" + grid +
               R"(/><MechanicalObject name="nodes" template="Vec3d"/><DiagonalMass massDensity="1000"/>
               <HexahedronElastoplasticFEMForceField name="body" template="Vec3d" poissonRatio="0.4" youngModulus=")" +
               young + "\"/>" + behind + "</Node>";
    };
    std::string held;
    for (int k = 0; k < 7; ++k)
        for (int i = 0; i < 9; ++i) held += std::to_string(i + 9 * 5 * k) + " ";
    return R"(<Node name="root" dt="0.01" gravity="0 -9.81 0">)" + modules + loop + R"(<Node name="both">
        <EulerImplicitSolver name="euler" rayleighMass="0.1" rayleighStiffness="0.02"/>)" +
           solver +
           body("lower", R"(n="9 5 7" min="0 0 0" max="0.05 0.03 0.04")", "6000",
                "<FixedProjectiveConstraint indices=\"" + held + "\"/>") +
           body("upper", R"(n="9 5 5" min="0.007 0.0297 0.006" max="0.037 0.0497 0.031")", "15000", "") + joint +
           "</Node></Node>";
}

const std::string kContact =
    R"(<TissueContactForceField name="contact" object1="@lower/nodes" object2="@upper/nodes" friction="0.3"
        damping="20"/>)";
const std::string kSprings =
    R"(<SpringForceField name="springs" template="Vec3d" object1="@lower/nodes" object2="@upper/nodes"
        spring="82 0 40 0.5 0.0002  88 8 60 0.5 0.0001  262 180 30 0.2 0.0003  175 94 90 0.2 0.001"/>)";
const std::string kOurs =
    R"(<MultigridCGLinearSolver name="solver" preconditioner="multigrid" tolerance="1e-10" printLog="true"/>)";
const std::string kConjugateGradients =
    R"(<CGLinearSolver template="GraphScattered" iterations="3000" tolerance="1e-11" threshold="1e-40"/>)";
const std::string kDirect = R"(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)";

double difference(const std::string& ours, const std::string& expected, int steps)
{
    SofaScene one = SofaScene::from_text(ours), other = SofaScene::from_text(expected);
    const PointArray start = positions(one);
    double found = 0;
    for (int step = 0; step < steps; ++step)
    {
        one.step();
        other.step();
        found = std::max(found, (positions(one) - positions(other)).cwiseAbs().maxCoeff());
    }
    EXPECT_GT((positions(one) - start).norm(), 1e-3 * size_of(start)) << "something happened";
    std::cout << "largest difference in " << steps << " steps: " << found / size_of(start) << " of the size\n";
    return found / size_of(start);
}

// By products of SOFA's visitors and by its matrix. What pulls is not released by them; here nothing does.
TEST(TwoBodiesInSofa, TouchInSystemsOfSofasSolvers)
{
    const std::string smooth =
        replaced(replaced(kContact, R"(friction="0.3")", R"(contactStiffness="3e5")"), "20", "3e4");
    const std::string expected = two_blocks(kConjugateGradients, smooth);
    EXPECT_LE(difference(two_blocks(kOurs, smooth), expected, 12), 1e-9);
    EXPECT_LE(difference(two_blocks(kDirect, smooth), expected, 12), 1e-9);
    EXPECT_LE(difference(two_blocks(kDirect, kContact), two_blocks(kConjugateGradients, kContact), 12), 1e-9);
}

TEST(TwoBodiesInSofa, HangOnSpringsOfSofa)
{
    Messages messages;
    EXPECT_LE(difference(two_blocks(kOurs, kSprings), two_blocks(kDirect, kSprings), 30), 1e-9);
    EXPECT_EQ(messages.count("preconditioner multigrid"), 30) << messages.text().substr(0, 2000);
}

/// Largest difference of positions from the embedded host, of the size of both bodies.
double difference_of_hosts(const std::string& text, int steps)
{
    SofaScene sofa = SofaScene::from_text(text);
    EmbeddedScene host(text);
    const PointArray start = positions(sofa);
    double found = 0;
    for (int step = 0; step < steps; ++step)
    {
        sofa.step();
        host.step();
        found = std::max(found, (positions(sofa) - host.positions()).cwiseAbs().maxCoeff());
    }
    EXPECT_GT((positions(sofa) - start).norm(), 1e-3 * size_of(start)) << "something happened";
    std::cout << "largest difference in " << steps << " steps: " << found / size_of(start) << " of the size\n";
    return found / size_of(start);
}

TEST(TwoBodiesInSofa, HangOnSpringsAsInTheEmbeddedHost)
{
    for (const std::string& solver : {kOurs, kConjugateGradients, kDirect})
        EXPECT_LE(difference_of_hosts(two_blocks(solver, kSprings), 30), 1e-9) << solver;
}

// SOFA's direct solvers apply the constraint in one way to nodes of the first state, and that in both ways not at all.
TEST(TwoBodiesInSofa, AreAttachedAsInTheEmbeddedHost)
{
    // nodes of both blocks in one place: those of the upper one lie elsewhere in x and z
    const std::string grids = R"(n="9 5 7" min="0 0 0" max="0.05 0.03 0.04")",
                      above = R"(n="9 5 5" min="0.007 0.0297 0.006" max="0.037 0.0497 0.031")";
    for (const std::string& solver : {kOurs, kConjugateGradients})
        for (const std::string way : {"", "twoWay=\"true\" "})
        {
            const std::string text = replaced(
                two_blocks(solver, "<AttachProjectiveConstraint object1=\"@lower/nodes\" object2=\"@upper/nodes\" " +
                                       way + R"(indices1="36 44 306 314" indices2="0 8 180 188"/>)"),
                above, R"(n="9 5 5" min="0 0.03 0" max="0.05 0.05 0.04")");
            ASSERT_NE(text.find(grids), std::string::npos);
            EXPECT_LE(difference_of_hosts(text, 30), 1e-9) << solver << way;
        }
}

TEST(TwoBodiesInSofa, FollowEachOtherOnSpringsAsInTheEmbeddedHost)
{
    const std::string springs =
        R"(<RestShapeSpringsForceField stiffness="20 30" points="0 8" external_rest_shape="@../lower/nodes" external_points="82 88"/>)";
    std::string text = two_blocks(kOurs, "");
    text.insert(text.rfind("</Node></Node></Node>"), springs);
    EXPECT_LE(difference_of_hosts(text, 30), 1e-9);
}

TEST(TwoBodiesInSofa, AreTiedByConstraints)
{
    const std::string loop = R"(<FreeMotionAnimationLoop/><BlockGaussSeidelConstraintSolver maxIterations="1000"
        tolerance="1e-12"/>)";
    const std::string ties =
        R"(<GenericConstraintCorrection/><BilateralLagrangianConstraint template="Vec3d" object1="@lower/nodes"
            object2="@upper/nodes" first_point="82 88 262" second_point="0 8 180"/>)";
    EXPECT_LE(difference(two_blocks(kOurs, ties, loop), two_blocks(kDirect, ties, loop), 20), 2e-3);
}

TEST(TwoBodiesInSofa, NeedACorrectionThatKnowsBoth)
{
    const std::string correction =
        R"(<LinearSolverConstraintCorrection linearSolver="@../solver" ODESolver="@../euler"/></Node>)";
    std::string text = two_blocks(
        kOurs, R"(<BilateralLagrangianConstraint template="Vec3d" object1="@lower/nodes" object2="@upper/nodes"
            first_point="82" second_point="0"/>)",
        "<FreeMotionAnimationLoop/><BlockGaussSeidelConstraintSolver/>");
    for (const std::string node : {"name=\"lower\"", "name=\"upper\""})
        text.replace(text.find("</Node>", text.find(node)), 7, correction);
    SofaScene scene = SofaScene::from_text(text);
    Messages messages;
    scene.step();
    EXPECT_EQ(messages.count("knows one of its MechanicalObjects: use a GenericConstraintCorrection"), 1)
        << messages.text();
}

// The contact stands in the node above: it hears of a step before the bodies. One is softened, the other made anew.
TEST(TissuesInSofa, FollowTheirBodies)
{
    const std::string change =
        R"(<AttributeChange component="@upper/body" attribute="youngModulus" keyTimes="0.05" values="7000"/>)";
    const std::string text =
        replaced(two_blocks(kOurs, kContact), R"(<Node name="lower">)", change + R"(<Node name="lower">)");
    const std::string front = replaced(replaced(text, kContact, ""), change, change + kContact);
    SofaScene sofa = SofaScene::from_text(front);
    EmbeddedScene host(text);
    const double size = size_of(positions(sofa));
    for (int step = 0; step < 10; ++step)
    {
        sofa.step();
        host.step();
        EXPECT_LE((positions(sofa) - host.positions()).cwiseAbs().maxCoeff(), 1e-9 * size) << step;
    }
    sofa.field().init();
    sofa.step();
    EXPECT_GT(value_of<int>(sofa.only<Contact>(), "touching"), 0) << "the body that is made in its place";
    sofa.set("contact", "active", "false");
    sofa.step();
    EXPECT_EQ(value_of<int>(sofa.only<Contact>(), "touching"), 0) << "from the next step on";
}

// What is removed during a run is not asked any more.
TEST(TissuesInSofa, AreInvalidWhereABodyIsRemoved)
{
    SofaScene scene = SofaScene::from_text(two_blocks(kOurs, kContact));
    for (int step = 0; step < 5; ++step) scene.step();
    EXPECT_GT(value_of<int>(scene.only<Contact>(), "touching"), 0);
    auto* both = dynamic_cast<sofa::simulation::Node&>(scene.root()).getChild("both");
    ASSERT_TRUE(both);
    sofa::simulation::Node::SPtr upper = both->getChild("upper");
    ASSERT_TRUE(upper);
    upper->detachFromGraph();
    upper.reset();
    Messages messages;
    for (int step = 0; step < 2; ++step) scene.step();
    EXPECT_TRUE(isInvalid(scene.named("contact")));
    EXPECT_GT(messages.count("no body on its state"), 0) << messages.text();
}

TEST(TissuesInSofa, SayWhatIsNotAsItShouldBe)
{
    const std::string overlap = replaced(two_blocks(kOurs, kContact), "0.0297", "0.02"),
                      twice = two_blocks(kOurs, kContact + replaced(kContact, R"(name="contact")", ""));
    for (const auto& [text, words] : {std::pair(overlap, "deep in each other"),
                                      {twice, "is between the same bodies"},
                                      {two_blocks(kDirect, kContact), "not a MultigridCGLinearSolver"}})
    {
        Messages messages;
        SofaScene scene = SofaScene::from_text(text);
        scene.step();
        EXPECT_EQ(messages.count(words), 1) << messages.text();
    }
}

TEST(TissuesInSofa, ReturnToTheBeginning)
{
    SofaScene scene = SofaScene::from_text(two_blocks(kOurs, kContact));
    for (int step = 0; step < 10; ++step) scene.step();
    const PointArray before = positions(scene);
    EXPECT_GT(value_of<int>(scene.only<Contact>(), "touching"), 0);
    scene.reset();
    EXPECT_EQ(value_of<int>(scene.only<Contact>(), "touching"), 0);
    for (int step = 0; step < 10; ++step) scene.step();
    EXPECT_EQ(positions(scene), before);
}

TEST(TissuesInSofa, AreInvalidWhereTheyCannotTouch)
{
    const std::string scene = two_blocks(kOurs, kContact), damping = "damping=\"20\"";
    const auto with = [&](const std::string& attributes) { return replaced(scene, damping, attributes); };
    EXPECT_TRUE(SofaScene::from_text(scene).only<Contact>().isComponentStateValid());
    for (const auto& [text, reason] :
         {std::pair(with(R"(damping="-1" maxSubdivision="0")"), "TissueContactForceField.damping: -1"),
          {with(R"(damping="-1" maxSubdivision="0")"), "TissueContactForceField.maxSubdivision: 0"},
          {with(R"(rayleighStiffness="0.1")"), "TissueContactForceField.rayleighStiffness: = 0.1"},
          {with(R"(contactDistance="1")"), "contactDistance"},
          {two_blocks(kOurs, R"(<TissueContactForceField friction="0.3"/>)"), "needs object1, and object2"},
          {replaced(scene, "<EulerImplicitSolver", "<StaticSolver"), "needs an EulerImplicitSolver"},
          {replaced(scene, R"(<Node name="lower">)", R"(<Node name="lower"><EulerImplicitSolver/><CGLinearSolver
                template="GraphScattered" iterations="9" tolerance="1e-3" threshold="1e-9"/>)"),
           "one EulerImplicitSolver and one linear solver in a node above both"}})
    {
        Messages messages;
        EXPECT_FALSE(SofaScene::from_text(text).only<Contact>().isComponentStateValid()) << reason;
        EXPECT_GT(messages.count(reason), 0) << reason << " is missing in " << messages.text();
    }

    SofaScene corrected = SofaScene::from_text(with(R"(damping="-1")"));
    corrected.reset();
    EXPECT_TRUE(isInvalid(corrected.named("contact")));
    corrected.set("contact", "damping", "20");
    corrected.named("contact").reinit();
    EXPECT_FALSE(isInvalid(corrected.named("contact")));
    corrected.step();
    EXPECT_GT(value_of<int>(corrected.only<Contact>(), "touching"), 0);
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
