// SPDX-License-Identifier: LGPL-2.1-or-later
// An instrument that touches a body in SOFA and in the embedded host: the same motion, forces and contacts.
#include <Hexaplast/InstrumentContactForceField.h>
#include <gtest/gtest.h>
#include <sofa/core/visual/VisualParams.h>

#include <filesystem>
#include <fstream>

#include "block_scene.h"
#include "embedded_scene.h"
#include "messages.h"
#include "recording_draw_tool.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

using Contact = InstrumentContactForceField;

/// A block of 4 x 3 x 8 cubes on the ground that a plate presses and strokes.
std::string stroked_block(const std::string& solver, const std::string& contact = "",
                          const std::string& integrator = R"(rayleighMass="0.1" rayleighStiffness="0.02")")
{
    return R"(<Node name="root" dt="0.01" gravity="0 -9.81 0"><DefaultAnimationLoop/>)" +
           required({"AnimationLoop", "Constraint.Projective", "LinearSolver.Direct", "LinearSolver.Iterative", "Mass",
                     "ODESolver.Backward", "StateContainer", "Topology.Container.Grid"}) +
           R"(<Node name="tissue"><EulerImplicitSolver )" + integrator + "/>" + solver +
           R"(<RegularGridTopology name="grid" n="5 4 9" min="0 0 0" max="0.04 0.03 0.08"/>
        <MechanicalObject name="nodes" template="Vec3d"/><DiagonalMass massDensity="1000"/>
        <HexahedronElastoplasticFEMForceField name="body" template="Vec3d" youngModulus="8000" poissonRatio="0.4"
            yieldStress="900" plasticFlowRate="3"/>
        <FixedProjectiveConstraint indices="0 1 2 3 4 20 21 22 23 24 40 41 42 43 44 60 61 62 63 64 80 81 82 83 84
            100 101 102 103 104 120 121 122 123 124 140 141 142 143 144 160 161 162 163 164"/>
        <InstrumentContactForceField name="tool" shape="box" size="0.03 0.008 0.06" friction="0.4"
            keyTimes="0 0.5 1.2 1.6 1.8"
            positions="0.02 0.036 0.04  0.02 0.032 0.04  0.028 0.0325 0.046  0.026 0.034 0.046  0.026 0.06 0.05"
            orientations="0 0 0 1  0 0 0 1  0 0.05 0 0.99875  0 0.05 0 0.99875  0 0 0 1" )" +
           contact + "/></Node></Node>";
}

constexpr const char* kOurSolver = R"(<MultigridCGLinearSolver tolerance="1e-8"/>)";

struct Differences
{
    double positions = 0;  ///< of the body's size
    int touching = 0, slipping = 0;
    int stepsWithBoth = 0;  ///< that have 100 points that touch and 10 that slip
    double force = 0;       ///< [N] the largest
};

Differences compared(SofaScene& sofa, EmbeddedScene& host, int steps)
{
    const double size = (sofa.positions().colwise().maxCoeff() - sofa.positions().colwise().minCoeff()).norm();
    auto& contact = sofa.only<Contact>();
    Differences found;
    for (int step = 0; step < steps; ++step)
    {
        sofa.step();
        host.step();
        found.positions = std::max(found.positions, (sofa.positions() - host.positions()).cwiseAbs().maxCoeff() / size);
        const int touching = value_of<int>(contact, "touching"), slipping = value_of<int>(contact, "slipping");
        found.touching = std::max(found.touching, touching);
        found.slipping = std::max(found.slipping, slipping);
        if (touching >= 100 && slipping >= 10) ++found.stepsWithBoth;
        found.force = std::max(found.force, value_of<sofa::type::Vec3>(contact, "force").norm());
    }
    std::cout << "largest difference in " << steps << " steps: " << found.positions << " of the body's size; "
              << found.touching << " points touched, " << found.slipping << " slipped; 100 and 10 in "
              << found.stepsWithBoth << " steps; force up to " << found.force << " N\n";
    return found;
}

void expect_same_outputs(SofaScene& sofa, EmbeddedScene& host)
{
    auto& contact = sofa.only<Contact>();
    const double size = 1 + value_of<sofa::type::Vec3>(contact, "force").norm();
    const auto output = [&](const char* name)
    { return host.output<scene::ForceField>("InstrumentContactForceField", name); };
    const std::vector<double> force = output("force"), torque = output("torque");
    for (int k = 0; k < 3; ++k)
    {
        EXPECT_NEAR(value_of<sofa::type::Vec3>(contact, "force")[k], force[k], 1e-6 * size);
        EXPECT_NEAR(value_of<sofa::type::Vec3>(contact, "torque")[k], torque[k], 1e-8 * size);
    }
    EXPECT_NEAR(value_of<SReal>(contact, "depth"), output("depth")[0], 1e-9);
    EXPECT_EQ(value_of<int>(contact, "touching"), output("touching")[0]);
    EXPECT_EQ(value_of<int>(contact, "slipping"), output("slipping")[0]);
}

TEST(InstrumentInSofa, TouchesAsInTheEmbeddedHost)
{
    const std::string scene = stroked_block(kOurSolver);
    SofaScene sofa = SofaScene::from_text(scene);
    EmbeddedScene host(scene);
    const Differences found = compared(sofa, host, 100);
    expect_same_outputs(sofa, host);
    EXPECT_LE(found.positions, 1e-9);
    EXPECT_LE(compared(sofa, host, 100).positions, 1e-9);
    EXPECT_GE(found.stepsWithBoth, 10) << "something happened";
    EXPECT_GT(found.force, 0.1);
}

TEST(InstrumentInSofa, TouchesTheShippedLiverAsInTheEmbeddedHost)
{
    const auto file = std::filesystem::path(HEXAPLAST_SCENES) / "probe_liver.scn";
    SofaScene sofa = SofaScene::from_file(file);
    EmbeddedScene host(file);
    const Differences found = compared(sofa, host, 200);
    EXPECT_LE(found.positions, 1e-9);
    EXPECT_GT(found.force, 0.1);
}

// SOFA's own linear solvers do not release what pulls within the step, nor correct friction: both last one step longer.
TEST(InstrumentInSofa, MovesNearlyAlikeWithALinearSolverOfSofa)
{
    const std::string scene = stroked_block(R"(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)");
    SofaScene sofa = SofaScene::from_text(scene);
    EmbeddedScene host(scene);
    Messages messages;
    EXPECT_LE(compared(sofa, host, 200).positions, 2e-2);
    EXPECT_EQ(messages.count("not a MultigridCGLinearSolver"), 1) << messages.text();
    EXPECT_EQ(sofa.only<Contact>().rayleighStiffness.getValue(), 0) << "what is given stays";
}

TEST(InstrumentInSofa, BeginsAnewAfterReset)
{
    const std::string text = stroked_block(kOurSolver);
    SofaScene sofa = SofaScene::from_text(text);
    for (int step = 0; step < 60; ++step) sofa.step();
    const PointArray before = sofa.positions();
    auto& contact = sofa.only<Contact>();
    EXPECT_GT(value_of<int>(contact, "touching"), 0);
    sofa.reset();
    EXPECT_EQ(value_of<int>(contact, "touching"), 0);
    EXPECT_EQ(value_of<sofa::type::Vec3>(contact, "force").norm(), 0);
    for (int step = 0; step < 60; ++step) sofa.step();
    EXPECT_EQ(sofa.positions(), before);
}

// Wherever the body stands, it takes its Data in the same step; the default stiffness of the contact follows.
TEST(InstrumentInSofa, FollowsTheDataOfABodyBehindIt)
{
    std::string before = stroked_block(kOurSolver);
    const std::size_t at = before.find("<InstrumentContactForceField");
    const std::string tool = before.substr(at, before.find("/>", at) + 2 - at), body = "<HexahedronElastoplastic";
    const std::string change =
        R"(<AttributeChange component="@body" attribute="youngModulus" keyTimes="0.3" values="16000"/>)";
    before.insert(before.find(body), change);
    const std::string behind = replaced(replaced(before, tool, ""), body, tool + body);
    for (const std::string& text : {before, behind})
    {
        SofaScene sofa = SofaScene::from_text(text);
        EmbeddedScene host(before);
        const Differences found = compared(sofa, host, 60);
        EXPECT_LE(found.positions, 1e-9);
        EXPECT_GT(found.touching, 0);
    }
}

// The mesh is lost with its body: the instrument touches the one that is made in its place.
TEST(InstrumentInSofa, FollowsABodyThatIsMadeAnew)
{
    SofaScene sofa = SofaScene::from_text(stroked_block(kOurSolver));
    Messages messages;
    for (int step = 0; step < 60; ++step)
    {
        if (step == 50) sofa.field().init();
        sofa.step();
    }
    EXPECT_GT(value_of<int>(sofa.only<Contact>(), "touching"), 0);
    EXPECT_EQ(messages.count("deep in the body"), 0) << "it does not begin anew";
}

// Data count from the next step on: until then, and where they are refused, the instrument is the one before.
TEST(InstrumentInSofa, IsSeenWhereItIs)
{
    SofaScene sofa = SofaScene::from_text(stroked_block(kOurSolver));
    for (int step = 0; step < 45; ++step) sofa.step();
    auto& contact = sofa.only<Contact>();
    ASSERT_GT(value_of<int>(contact, "touching"), 0);
    const auto draw = [&](bool forces, bool visuals)
    {
        RecordingDrawTool drawn;
        sofa::core::visual::VisualParams vparams;
        vparams.drawTool() = &drawn;
        vparams.displayFlags().setShowForceFields(forces);
        vparams.displayFlags().setShowVisualModels(visuals);
        contact.draw(&vparams);
        return drawn;
    };
    const RecordingDrawTool tool = draw(true, false);
    double lowest = 1;
    for (const auto& corner : tool.corners) lowest = std::min<double>(lowest, corner[1]);
    EXPECT_EQ(tool.corners.size(), 36u) << "a box";
    EXPECT_NEAR(lowest, 0.036 - 0.9 * 0.004 - 0.004, 1e-6) << "at 0.45 s of its path";
    EXPECT_EQ(static_cast<int>(tool.points.size()), value_of<int>(contact, "touching"));
    EXPECT_EQ(tool.ends.size(), 2 * tool.points.size());
    EXPECT_EQ(tool.num_others, 0);
    EXPECT_EQ(tool.num_open_states, 0);

    sofa.set("tool", "drawForceScale", "0.5");
    sofa::type::Vec3 sum;
    const RecordingDrawTool to_scale = draw(true, false);
    for (std::size_t i = 0; i < to_scale.ends.size(); i += 2) sum += to_scale.ends[i + 1] - to_scale.ends[i];
    EXPECT_LE((sum + value_of<sofa::type::Vec3>(contact, "force") * 0.5).norm(), 1e-9 * sum.norm());
    EXPECT_EQ(draw(false, true).corners.size(), 36u);
    EXPECT_TRUE(draw(false, true).ends.empty());
    EXPECT_TRUE(draw(false, false).corners.empty());
    for (const char* shape : {"capsule", "cube"})
    {
        contact.findData("shape")->read(shape);
        EXPECT_EQ(draw(true, false).corners.size(), 36u) << shape;
    }
    contact.computeBBox(sofa::core::execparams::defaultInstance());
    EXPECT_GT(contact.f_bbox.getValue().maxBBox()[1], 0.036 - 0.9 * 0.004 + 0.004);
    sofa.set("tool", "drawInstrument", "false");
    EXPECT_TRUE(draw(true, true).corners.empty());
    EXPECT_EQ(draw(true, true).ends.size(), tool.ends.size());
}

TEST(InstrumentInSofa, RefusesSeveralIntegrationsInAStepAndARayleighStiffnessDuringTheRun)
{
    Messages messages;
    SofaScene several = SofaScene::from_text(replaced(stroked_block(kOurSolver), "<DefaultAnimationLoop/>",
                                                      "<MultiStepAnimationLoop integrationSteps='2'/>"));
    several.step();
    EXPECT_TRUE(isInvalid(several.named("tool")));
    EXPECT_GT(messages.count("takes several steps within one"), 0) << messages.text();

    SofaScene one = SofaScene::from_text(stroked_block(kOurSolver));
    one.step();
    one.only<Contact>().rayleighStiffness.setValue(3);
    one.step();
    EXPECT_TRUE(isInvalid(one.named("tool")));
    EXPECT_EQ(messages.count("rayleighStiffness: = 3"), 1) << messages.text();
}

TEST(InstrumentInSofa, WarnsOfABodyThatItIsDeepIn)
{
    Messages messages;
    SofaScene::from_text(replaced(stroked_block(kOurSolver), "0.02 0.036 0.04", "0.02 0.03 0.04"));
    EXPECT_EQ(messages.count("deep in the body, which is pushed out"), 1) << messages.text();
}

TEST(InstrumentInSofa, IsInvalidWhereItCannotWork)
{
    const std::string scene = stroked_block(kOurSolver), friction = R"(friction="0.4")", box = R"(shape="box")";
    const auto with = [&](const std::string& attributes) { return stroked_block(kOurSolver, attributes); };
    const auto integrated = [&](const std::string& scheme) { return stroked_block(kOurSolver, "", scheme); };
    std::string without_body = scene;
    const std::size_t at = scene.find("<HexahedronElastoplastic");
    without_body.erase(at, scene.find("/>", at) + 2 - at);
    for (const auto& [text, reason] :
         {std::pair(without_body, "no body on its state"),
          {replaced(scene, "<EulerImplicitSolver", "<StaticSolver"), "needs an EulerImplicitSolver"},
          {integrated(R"(trapezoidalScheme="true")"), "trapezoidalScheme"},
          {integrated(R"(firstOrder="true")"), "firstOrder"},
          {replaced(scene, box, R"(shape="cube")"), "InstrumentContactForceField.shape: 'cube' must be"},
          {replaced(scene, box, R"(shape="sphere")"), "InstrumentContactForceField.radius: is not given"},
          {replaced(scene, friction, R"(friction="-1")"), "InstrumentContactForceField.friction: -1"},
          {with(R"(damping="-1")"), "InstrumentContactForceField.damping: -1"},
          {with(R"(rayleighStiffness="0.1")"), "InstrumentContactForceField.rayleighStiffness: = 0.1"},
          {replaced(with(R"(surfacePositions="0 0 0 1 0 0 0 1 0" surfaceTriangles="0 1 2")"), box,
                    R"(shape="surface")"),
           "surfaceTriangles"},
          {with(R"(embeddedPositions="0 0 0 1 0 0 0 1 0" embeddedTriangles="0 1 7")"),
           "embeddedTriangles: 7 must lie in [0, 3)"}})
    {
        Messages messages;
        EXPECT_FALSE(SofaScene::from_text(text).only<Contact>().isComponentStateValid()) << reason;
        EXPECT_GT(messages.count(reason), 0) << reason << " is missing in " << messages.text();
    }

    SofaScene corrected = SofaScene::from_text(replaced(scene, friction, R"(friction="-1")"));
    corrected.reset();
    EXPECT_TRUE(isInvalid(corrected.named("tool")));
    corrected.set("tool", "friction", "0.4");
    corrected.named("tool").reinit();
    for (int step = 0; step < 45; ++step) corrected.step();
    EXPECT_GT(value_of<int>(corrected.only<Contact>(), "touching"), 0);
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
