// SPDX-License-Identifier: LGPL-2.1-or-later
// SOFA's own contact on our bodies, and MultigridCGLinearSolver within it.
#include <gtest/gtest.h>
#include <sofa/core/behavior/LinearSolver.h>
#include <sofa/helper/logging/Message.h>
#include <sofa/helper/logging/MessageDispatcher.h>
#include <sofa/helper/logging/MessageHandler.h>
#include <sofa/linearalgebra/FullMatrix.h>
#include <sofa/linearalgebra/SparseMatrix.h>

#include <chrono>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "hexaplast/body.hpp"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

/// What SOFA's components say while it lives.
class Messages final : public sofa::helper::logging::MessageHandler
{
public:
    Messages() { sofa::helper::logging::MessageDispatcher::addHandler(this); }
    ~Messages() override { sofa::helper::logging::MessageDispatcher::rmHandler(this); }
    void process(sofa::helper::logging::Message& message) override { m_text += message.messageAsString() + "\n"; }

    std::string getName() const override { return "test"; }
    const std::string& text() const { return m_text; }
    int count(const std::string& words) const
    {
        int found = 0;
        for (std::size_t at = m_text.find(words); at != m_text.npos; at = m_text.find(words, at + 1)) ++found;
        return found;
    }

private:
    std::string m_text;
};

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
    const std::size_t at = text.find(from);
    if (at == text.npos) throw std::runtime_error("no '" + from + "' in the scene");
    return text.replace(at, from.size(), to);
}

/// A shipped scene as text, with its meshes wherever it is read.
std::string shipped(const std::string& name)
{
    std::ifstream file(std::filesystem::path(HEXAPLAST_SCENES) / "sofa" / (name + ".scn"));
    std::ostringstream text;
    text << file.rdbuf();
    return replaced(text.str(), "../mesh/", HEXAPLAST_SCENES "/mesh/");
}

constexpr const char* kConverged =
    R"(<CGLinearSolver template="GraphScattered" iterations="3000" tolerance="1e-11" threshold="1e-40"/>)";

TEST(PenaltyContactInSofa, IsInOurSystemWithOurPreconditioner)
{
    const std::string solver = R"(<MultigridCGLinearSolver tolerance="0.001"/>)";
    const std::string scene = replaced(shipped("penalty_contact"), R"(precision="mixed")", "");
    SofaScene expected = SofaScene::from_text(replaced(
        replaced(scene, solver, kConverged), "<Node name=\"fat\">",
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
    EXPECT_GT((ours.positions() - start).col(1).minCoeff(), -0.03) << "the liver holds it";
    EXPECT_LT((ours.positions() - start).col(1).minCoeff(), -0.006) << "it has fallen onto it";
}

constexpr const char* kDirect = R"(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)";
constexpr const char* kOurs = R"(<MultigridCGLinearSolver tolerance="0.001"/>)";

std::string with_direct_solver(const std::string& scene)
{
    return replaced(replaced(scene, kOurs, kDirect), "<Node name=\"fat\">",
                    "<Node name=\"fat\"><RequiredPlugin pluginName=\"Sofa.Component.LinearSolver.Direct\"/>");
}

TEST(ConstraintContactInSofa, MovesAsWithADirectSolver)
{
    const std::string scene = shipped("constraint_contact");
    SofaScene direct = SofaScene::from_text(with_direct_solver(scene));
    SofaScene ours = SofaScene::from_text(scene);
    const PointArray start = ours.positions();
    for (int step = 0; step < 60; ++step)
    {
        ours.step();
        direct.step();
        const double difference = (ours.positions() - direct.positions()).cwiseAbs().maxCoeff();
        if (step % 5 == 4)
            std::cout << step << " " << difference << " moved " << (ours.positions() - start).colwise().mean() << " / "
                      << (direct.positions() - start).colwise().mean() << "\n";
    }
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
