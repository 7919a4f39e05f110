// SPDX-License-Identifier: LGPL-2.1-or-later
// SOFA's own contact on our bodies, and MultigridCGLinearSolver within it.
#include <gtest/gtest.h>
#include <sofa/core/MechanicalParams.h>
#include <sofa/core/behavior/LinearSolver.h>
#include <sofa/linearalgebra/FullMatrix.h>
#include <sofa/linearalgebra/SparseMatrix.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <tuple>

#include "block_scene.h"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "messages.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

/// A shipped scene as text, with its meshes wherever it is read.
std::string shipped(const std::string& name)
{
    std::ifstream file(std::filesystem::path(HEXAPLAST_SCENES) / "sofa" / (name + ".scn"));
    std::ostringstream text;
    text << file.rdbuf();
    const std::string scene = text.str();
    return scene.find("../mesh/") == scene.npos ? scene : replaced(scene, "../mesh/", HEXAPLAST_SCENES "/mesh/");
}

constexpr const char* kConverged =
    R"(<CGLinearSolver template="GraphScattered" iterations="3000" tolerance="1e-11" threshold="1e-40"/>)";

TEST(PenaltyContactInSofa, IsInOurSystemWithOurPreconditioner)
{
    const std::string solver = R"(<MultigridCGLinearSolver tolerance="0.001"/>)";
    const std::string scene = replaced(shipped("penalty_contact"), R"(precision="mixed")", "");
    SofaScene expected = SofaScene::from_text(
        replaced(replaced(scene, solver, kConverged), "<Node name=\"fat\">",
                 "<Node name=\"fat\"><RequiredPlugin pluginName=\"Sofa.Component.LinearSolver.Iterative\"/>"));
    Messages messages;
    SofaScene ours = SofaScene::from_text(
        replaced(scene, solver, R"(<MultigridCGLinearSolver tolerance="1e-10" printLog="true"/>)"));
    const double size = 0.08;
    PointArray start = ours.positions();
    double difference = 0;
    for (int step = 0; step < 40; ++step)
    {
        ours.step();
        expected.step();
        difference = std::max(difference, (ours.positions() - expected.positions()).cwiseAbs().maxCoeff() / size);
    }
    std::cout << "largest difference from SOFA's conjugate gradients: " << difference << " of the body's size\n";
    EXPECT_LE(difference, 1e-6);
    EXPECT_EQ(messages.count("preconditioner multigrid"), 40) << messages.text().substr(0, 3000);
    // it would have fallen by 780 mm
    EXPECT_GT((ours.positions() - start).col(1).minCoeff(), -0.03) << "the gutter holds it";
    EXPECT_LT((ours.positions() - start).col(1).minCoeff(), -0.01) << "it has fallen into it";
}

constexpr const char* kDirect = R"(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)";
constexpr const char* kOurs = R"(<MultigridCGLinearSolver tolerance="0.001"/>)";

std::string with_direct_solver(const std::string& scene)
{
    return replaced(replaced(scene, kOurs, kDirect), "<Node name=\"fat\">",
                    "<Node name=\"fat\"><RequiredPlugin pluginName=\"Sofa.Component.LinearSolver.Direct\"/>");
}

struct Motions
{
    double difference = 0;  ///< [m] largest
    PointArray ours, start;
};

Motions compared(const std::string& scene, const std::string& other, int steps)
{
    SofaScene expected = SofaScene::from_text(other), ours = SofaScene::from_text(scene);
    Motions found;
    found.start = ours.positions();
    for (int step = 0; step < steps; ++step)
    {
        ours.step();
        expected.step();
        found.difference = std::max(found.difference, (ours.positions() - expected.positions()).cwiseAbs().maxCoeff());
    }
    found.ours = ours.positions();
    return found;
}

// It falls, and is caught by about 70 contacts: then the friction of each decides anew in every step.
TEST(ConstraintContactInSofa, MovesAsWithADirectSolver)
{
    const std::string scene = shipped("constraint_contact");
    const Motions found = compared(scene, with_direct_solver(scene), 30);
    std::cout << "largest difference from a direct solver: " << found.difference << " m\n";
    EXPECT_LE(found.difference, 2e-3);
    const PointArray moved = found.ours - found.start;
    EXPECT_LT(moved.col(1).minCoeff(), -0.006) << "it has fallen onto the liver";
    EXPECT_GT(moved.col(1).minCoeff(), -0.03) << "which holds it";
}

TEST(ConstraintContactInSofa, IsTheSameForBothCorrectionsOfSofa)
{
    const std::string scene = shipped("constraint_contact");
    const Motions found =
        compared(scene, replaced(scene, "<LinearSolverConstraintCorrection/>", "<GenericConstraintCorrection/>"), 15);
    EXPECT_LE(found.difference, 1e-9);
    EXPECT_LT((found.ours - found.start).col(1).minCoeff(), -0.006);
}

/// A block of 2,058 hexahedra that is held at its bottom, after a step.
std::string block_below_contacts(const std::string& solver)
{
    return R"(<Node name="root" dt="0.01" gravity="0 0 -9.81"><DefaultAnimationLoop/>)" +
           required({"AnimationLoop", "Constraint.Projective", "Engine.Select", "LinearSolver.Direct", "Mass",
                     "ODESolver.Backward", "StateContainer", "Topology.Container.Grid"}) +
           R"(<Node name="tissue"><EulerImplicitSolver/>)" + solver +
           R"(<RegularGridTopology n="15 15 11" min="0 0 0" max="0.14 0.14 0.1"/><MechanicalObject template="Vec3d"/>
        <DiagonalMass massDensity="1000"/><HexahedronElastoplasticFEMForceField template="Vec3d" youngModulus="6000"
            poissonRatio="0.45" precision="mixed"/><BoxROI name="bottom" box="-1 -1 -0.001  1 1 0.001"/>
        <FixedProjectiveConstraint indices="@bottom.indices"/></Node></Node>)";
}

/// The rows of 20 frictional contacts in faces of its top, in another place for each `step`.
sofa::linearalgebra::SparseMatrix<SReal> contact_rows(int numNodes, int step)
{
    sofa::linearalgebra::SparseMatrix<SReal> J(60, 3 * numNodes);
    for (int k = 0; k < 20; ++k)
    {
        const int i = 1 + k * 5 % 13, j = 1 + k * 3 % 13;
        const double s = 0.1 + 0.02 * step, t = 0.4;
        const double weights[] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
        for (int a = 0; a < 4; ++a)
            for (int axis = 0; axis < 3; ++axis)
                J.add(3 * k + axis, 3 * (i + a % 2 + 15 * (j + a / 2 + 15 * 10)) + axis, weights[a]);
    }
    return J;
}

/// Forces at x, which fix where products with the stiffness are.
void evaluate(SofaScene& scene, const PointArray& x)
{
    sofa::core::objectmodel::Data<Vec3Types::VecCoord> position;
    sofa::core::objectmodel::Data<Vec3Types::VecDeriv> force, velocity;
    for (auto* field : {&force, &velocity}) field->beginEdit()->resize(x.rows());
    position.beginEdit()->resize(x.rows());
    view(*position.beginEdit()) = x;
    scene.field().addForce(sofa::core::mechanicalparams::defaultInstance(), force, position, velocity);
}

// As near as its own solver is asked to come.
TEST(ConstraintContactInSofa, ComplianceIsThatOfADirectSolver)
{
    using Clock = std::chrono::steady_clock;
    set_num_threads(2);
    for (const auto& [tolerance, numSteps, allowed] : {std::tuple("0.001", 6, 0.01), {"1e-10", 1, 1e-7}})
    {
        SofaScene ours = SofaScene::from_text(
            block_below_contacts("<MultigridCGLinearSolver tolerance='" + std::string(tolerance) + "'/>"));
        SofaScene direct = SofaScene::from_text(block_below_contacts(kDirect));
        const int numNodes = static_cast<int>(ours.positions().rows());
        std::cout << "compliance of 60 rows, tolerance " << tolerance << " [ms], and its error:";
        for (int step = 0; step < numSteps; ++step)
        {
            Eigen::MatrixXd W[2];
            for (SofaScene* scene : {&ours, &direct})
            {
                const PointArray x = scene->positions();
                scene->step();
                evaluate(*scene, x);  // where the matrix of the step is: plastic flow has come since
                auto J = contact_rows(numNodes, step);
                sofa::linearalgebra::FullMatrix<SReal> found(60, 60);
                found.clear();
                const auto begin = Clock::now();
                EXPECT_TRUE(scene->only<sofa::core::behavior::LinearSolver>().addJMInvJt(&found, &J, 0.01));
                if (scene == &ours)
                    std::cout << " " << std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
                W[scene == &direct] = Eigen::Map<const Eigen::Matrix<double, 60, 60, Eigen::RowMajor>>(found.ptr());
            }
            const double error = (W[0] - W[1]).norm() / W[1].norm();
            std::cout << " (" << error << ")";
            EXPECT_LE(error, allowed);
        }
        std::cout << "\n";
    }
    set_num_threads(1);
}

/// A bar that is pulled until it flows.
std::string pulled_bar(const std::string& loop, const std::string& support)
{
    return R"(<Node name="root" dt="0.01" gravity="0 0 0">)" + loop +
           required({"AnimationLoop", "Constraint.Lagrangian.Correction", "Constraint.Lagrangian.Model",
                     "Constraint.Lagrangian.Solver", "Constraint.Projective", "Engine.Select", "LinearSolver.Direct",
                     "Mass", "MechanicalLoad", "ODESolver.Backward", "StateContainer", "Topology.Container.Grid"}) +
           R"(<Node name="tissue"><EulerImplicitSolver rayleighMass="1"/>)" + kDirect +
           R"(<RegularGridTopology n="3 3 7" min="0 0 0" max="0.1 0.1 0.3"/>
        <MechanicalObject name="nodes" template="Vec3d"/><DiagonalMass massDensity="1000"/>
        <HexahedronElastoplasticFEMForceField name="body" template="Vec3d" youngModulus="5000" poissonRatio="0.3" )" +
           kPlastic + R"(/><BoxROI name="bottom" box="-1 -1 -0.001  1 1 0.001"/>
        <BoxROI name="top" box="-1 -1 0.299  1 1 1"/>
        <ConstantForceField name="pull" indices="@top.indices" totalForce="0 0 2.5"/>)" +
           support + "</Node></Node>";
}

// What holds a body by Lagrange multipliers and what projects move it alike, and flow follows the corrected motion.
TEST(ConstraintsInSofa, LetABodyFlowAsProjectionsDo)
{
    SofaScene projected = SofaScene::from_text(
        pulled_bar("<DefaultAnimationLoop/>", R"(<FixedProjectiveConstraint indices="@bottom.indices"/>)"));
    SofaScene constrained = SofaScene::from_text(pulled_bar(
        R"(<FreeMotionAnimationLoop/><BlockGaussSeidelConstraintSolver tolerance="1e-13" maxIterations="10000"/>)",
        R"(<FixedLagrangianConstraint indices="@bottom.indices"/><LinearSolverConstraintCorrection/>)"));
    double difference = 0, strain = 0;
    for (int step = 0; step < 60; ++step)
    {
        for (SofaScene* scene : {&projected, &constrained})
        {
            if (step == 20) scene->set("pull", "totalForce", "0 0 0");
            scene->step();
        }
        difference = std::max(difference, (projected.positions() - constrained.positions()).cwiseAbs().maxCoeff());
        for (std::size_t e = 0; e < value_of<VecReal>(projected.field(), "plasticStrain").size(); ++e)
        {
            const double flowed = value_of<VecReal>(constrained.field(), "plasticStrain")[e];
            EXPECT_NEAR(value_of<VecReal>(projected.field(), "plasticStrain")[e], flowed, 1e-9) << step;
            strain = std::max(strain, flowed);
        }
    }
    std::cout << "largest difference from projections: " << difference << " m; greatest plastic strain " << strain
              << "\n";
    EXPECT_LE(difference, 1e-10);
    EXPECT_GT(strain, 0.01);
}

// SOFA's correction would look for a matrix that is not there, and crash.
TEST(ConstraintContactInSofa, RefusesConstraintSolversThatAskForSingleConstraints)
{
    Messages messages;
    SofaScene scene = SofaScene::from_text(replaced(shipped("constraint_contact"), "<BlockGaussSeidelConstraintSolver",
                                                    "<UnbuiltGaussSeidelConstraintSolver"));
    EXPECT_GT(messages.count("use BlockGaussSeidelConstraintSolver"), 0);
    scene.step();
    EXPECT_GT(messages.count("it does nothing in this step"), 0);
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
