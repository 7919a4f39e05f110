// SPDX-License-Identifier: LGPL-2.1-or-later
// What components say that they cannot be, materials of regions, attributes that change during a run, and the state
// that a run leaves.
#include <Hexaplast/MaterialRegion.h>
#include <gtest/gtest.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "attributes/parts.hpp"
#include "block_scene.h"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "messages.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

struct Refused
{
    std::string name;  ///< of the component
    std::string scene;
    std::vector<std::string> said;
};
void PrintTo(const Refused& refused, std::ostream* out) { *out << refused.name; }

class RefusedInSofa : public testing::TestWithParam<Refused>
{
};

// The animation goes on without it, and every step says so once.
TEST_P(RefusedInSofa, IsSaidAtOnceAndInEveryStep)
{
    Messages messages;
    SofaScene scene = SofaScene::from_text(GetParam().scene);
    for (const std::string& words : GetParam().said) EXPECT_GT(messages.count(words), 0) << messages.text();
    EXPECT_TRUE(isInvalid(scene.named(GetParam().name)));
    if (!scene.named(GetParam().name).f_listening.getValue()) return;
    scene.root().setAnimate(true);
    const std::string words = GetParam().name + " is invalid (see its error above): it does nothing in this step";
    for (int step = 1; step <= 3; ++step)
    {
        scene.step();
        EXPECT_EQ(messages.count(words), step) << messages.text();
    }
    EXPECT_TRUE(scene.root().getAnimate());
}

INSTANTIATE_TEST_SUITE_P(
    All, RefusedInSofa,
    testing::Values(
        Refused{"body",
                block(R"(yieldNorm="vonMiss" averagingSteps="0" yieldStress="-1"
                         rayleighStiffness="-1")"),
                {"test.scn:1: error: HexahedronElastoplasticFEMForceField.yieldNorm: 'vonMiss' must be vonMises, "
                 "frobenius or spectral (did you mean 'vonMises'?)",
                 "ForceField.averagingSteps: 0 must lie in [1, 1000]", "ForceField.yieldStress: -1 must be",
                 "ForceField.rayleighStiffness: -1 must be >= 0"}},
        Refused{"body",
                block(R"(yieldStress="1 2")"),
                {"ForceField.yieldStress: 2 values given, must be one or 12 (one per hexahedron)"}},
        Refused{"body", block("", ""), {"needs a topology with hexahedra"}},
        Refused{"body",
                block("", "<HexahedronSetTopologyContainer name='grid'/>"),
                {"its topology 'grid' has no hexahedra"}},
        Refused{"body", block("topology='@nowhere'"), {"ForceField.topology: '@nowhere' leads to nothing"}},
        Refused{"body", block("plasticFlowRate='zz'"), {"ForceField.plasticFlowRate: = 'zz': must be one number"}},
        Refused{"tool",
                block("", kGrid, "",
                      "<GraspForceField name='tool' keyTimes='1 0' positions='0 0 0 1 0 0' stiffness='-1' "
                      "rayleighStiffness='-2'/>"),
                {"GraspForceField.keyTimes: ", "GraspForceField.stiffness: -1", "ForceField.rayleighStiffness: -2"}},
        Refused{
            "wheel",
            block("", kGrid, "",
                  "<TangentialForceField name='wheel' indices='99' groupSize='0' axis='0 0 0' times='0' "
                  "forces='1'/>"),
            {"TangentialForceField.indices: 99", "TangentialForceField.groupSize: 0", "TangentialForceField.axis: "}},
        Refused{"body",
                block("", kGrid, "", "<MaterialRegion name='tip' indices='5 12' youngModulus='900'/>"),
                {"MaterialRegion.indices: 12 must lie in [0, 12)", "its MaterialRegion 'tip' is invalid"}},
        Refused{"body",
                block("", kGrid, "", "<MaterialRegion indices='5 5' youngModulus='900'/>"),
                {"MaterialRegion.indices: hexahedron 5 is given twice, must be given once"}},
        Refused{"body",
                block("", kGrid, "", "<MaterialRegion indices='5' youngModulus='1 2' poissonRatio='0.5'/>"),
                {"MaterialRegion.youngModulus: 2 values given, must be one or 1 (one per hexahedron of the region)",
                 "MaterialRegion.poissonRatio: 0.5 must lie in [0, 0.5)"}},
        Refused{"lonely",
                block("", kGrid, "<MaterialRegion name='lonely' indices='5'/>"),
                {"MaterialRegion: needs a HexahedronElastoplasticFEMForceField in its node or above"}},
        Refused{"change",
                block("", kGrid, "",
                      "<AttributeChange name='change' component='@body' attribute='yungModulus' keyTimes='0' "
                      "values='1'/>"),
                {"AttributeChange.attribute: HexahedronElastoplasticFEMForceField 'body' has no attribute "
                 "'yungModulus'"}}));

TEST(MessagesInSofa, WarningsArePassedOnAndTheBodyWorks)
{
    Messages messages;
    SofaScene scene = SofaScene::from_text(block(R"(yieldStress="100" plasticFlowRate="8")"));
    EXPECT_EQ(messages.count("plasticFlowRate = 8"), 1) << messages.text();
    EXPECT_FALSE(isInvalid(scene.field()));
}

std::vector<double> member(SofaScene& scene, double Material::*value)
{
    std::vector<double> all;
    for (int e = 0; e < scene.body().mesh().num_elements(); ++e) all.push_back(scene.body().material(e).*value);
    return all;
}

// Before the body by numbers, behind it by nodes; the latest one counts.
TEST(RegionsInSofa, GiveTheBodyTheirValuesWhereverTheyStand)
{
    SofaScene scene = SofaScene::from_text(
        block(kPlastic, kGrid + "<MaterialRegion indices='3 4' youngModulus='900 800' hardening='2'/>", "",
              "<MaterialRegion name='region' youngModulus='500' yieldStress='70' hexahedra='9 10 13 12 18 19 22 21 "
              "19 20 23 22 28 29 32 31'/>"));
    std::vector<double> young(12, 5000), yield(12, 100), hardening(12, 0.3);
    young[3] = 900;
    young[4] = young[9] = 500;
    yield[4] = yield[9] = 70;
    hardening[3] = hardening[4] = 2;
    EXPECT_EQ(member(scene, &Material::young_modulus), young);
    EXPECT_EQ(member(scene, &Material::yield_stress), yield);
    EXPECT_EQ(member(scene, &Material::hardening), hardening);

    // a change takes effect at the next step, and what flowed stays
    scene.move_to(scene.positions() * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    const auto strain = value_of<VecReal>(scene.field(), "plasticStrain");
    EXPECT_GT(strain[5], 0);
    scene.set("region", "youngModulus", "1200");
    scene.set("body", "youngModulus", "3000");
    scene.move_to(scene.body().plastic_rest_positions());
    EXPECT_EQ(member(scene, &Material::young_modulus), young);
    for (const char* name : {"body", "region"}) scene.set(name, "yieldStress", "1e9");
    scene.step();
    young.assign(12, 3000);
    young[3] = 900;
    young[4] = young[9] = 1200;
    EXPECT_EQ(member(scene, &Material::young_modulus), young);
    EXPECT_EQ(value_of<VecReal>(scene.field(), "plasticStrain"), strain);
    scene.reset();
    EXPECT_EQ(member(scene, &Material::young_modulus), young);
}

TEST(RegionsInSofa, AreValidAgainWhenTheyAreCorrected)
{
    SofaScene scene =
        SofaScene::from_text(block("", kGrid, "", "<MaterialRegion name='tip' indices='5 12' youngModulus='900'/>"));
    EXPECT_TRUE(isInvalid(scene.named("tip")));
    scene.set("tip", "indices", "5");
    scene.named("tip").reinit();
    EXPECT_FALSE(isInvalid(scene.named("tip")));
    EXPECT_FALSE(isInvalid(scene.field()));
    EXPECT_EQ(scene.body().material(5).young_modulus, 900);
}

TEST(RegionsInSofa, ComeAndGo)
{
    SofaScene scene = SofaScene::from_text(block(""));
    auto& node = dynamic_cast<sofa::simulation::Node&>(*scene.field().getContext());
    const auto region = sofa::core::objectmodel::New<MaterialRegion>();
    region->findData("indices")->read("5");
    region->findData("youngModulus")->read("900");
    node.addObject(region);
    scene.step();
    EXPECT_EQ(scene.body().material(5).young_modulus, 900);
    node.removeObject(region);
    scene.step();
    EXPECT_EQ(scene.body().material(5).young_modulus, 5000);
}

// Links of components keep what they lead to alive, and those of Data do not.
TEST(LinksInSofa, LeadToNothingThatHasLeftTheScene)
{
    const auto probe = [](const std::string& name, const std::string& value)
    { return "<Probe name='" + name + "' value='@/" + value + "'/>"; };
    const std::string source = "<Probe name='source' value='@/tissue/nodes.position' component='z'/>";
    SofaScene scene = SofaScene::from_text(
        block("", kGrid,
              required({"ODESolver.Backward"}) +
                  "<Node name='hand'><MechanicalObject name='frame' template='Rigid3d' position='0 0 1 0 0 0 1'/>" +
                  source + "</Node><Node name='other'>" + source + "</Node>",
              "<EulerImplicitSolver/><MultigridCGLinearSolver/>"
              "<InstrumentContactForceField name='tip' radius='0.01' rigid='@/hand/frame'/>" +
                  probe("kept", "hand/source.reading") + probe("gone", "other/source.reading")));
    Messages messages;
    scene.step();
    EXPECT_EQ(messages.errors(), "");
    auto& root = dynamic_cast<sofa::simulation::Node&>(scene.root());
    const sofa::simulation::Node::SPtr hand = root.getChild("hand");
    root.removeChild(hand);
    root.removeChild(root.getChild("other"));
    scene.step();
    for (const char* name : {"tip", "kept", "gone"}) EXPECT_TRUE(isInvalid(scene.named(name))) << name;
    for (const char* words : {"'frame', which is no longer in the scene", "'source', which is no longer in the scene",
                              "leads to nothing any more"})
        EXPECT_EQ(messages.count(words), 1) << words << "\n" << messages.text();
    EXPECT_FALSE(isInvalid(scene.field()));
}

TEST(AttributeChangeInSofa, FollowsItsLinkAndATimeThatGoesBack)
{
    SofaScene scene = SofaScene::from_text(
        block("", kGrid, "<RunSettings name='one' steps='3'/><RunSettings name='two' steps='4'/>",
              "<AttributeChange name='change' component='@/one' attribute='steps' keyTimes='0.015' values='5'/>"));
    const auto steps = [&](const char* name) { return scene.named(name).findData("steps")->getValueString(); };
    for (int step = 0; step < 3; ++step) scene.step();
    EXPECT_EQ(steps("one"), "5");
    dynamic_cast<sofa::simulation::Node&>(*scene.field().getContext()).setTime(0);
    scene.named("change").handleEvent(std::make_unique<sofa::simulation::AnimateBeginEvent>(0.01).get());
    EXPECT_EQ(steps("one"), "3");
    scene.named("change").findLink("component")->read("@/two");
    for (int step = 0; step < 3; ++step) scene.step();
    EXPECT_EQ(steps("two"), "5");
}

TEST(AttributeChangeInSofa, HappensBeforeTheStepOfItsTime)
{
    SofaScene scene = SofaScene::from_text(block(
        "", kGrid, "<RunSettings name='settings' steps='3'/>",
        "<AttributeChange component='@/settings' attribute='steps' keyTimes='0.015 0.025 0.035' values='5; ;7'/>"));
    const auto* steps = scene.named("settings").findData("steps");
    for (const auto& [value, isSet] : {std::pair("3", true), {"3", true}, {"5", true}, {"3", false}, {"7", true}})
    {
        scene.step();
        EXPECT_EQ(steps->getValueString(), value) << scene.root().getTime();
        EXPECT_EQ(steps->isSet(), isSet) << scene.root().getTime();
    }
    scene.reset();
    EXPECT_EQ(steps->getValueString(), "3");
}

// SOFA writes six digits, and forgets only that a value was given; a link would give its value again.
TEST(AttributeChangeInSofa, IsTakenBackToTheLastDigitAndToTheLink)
{
    SofaScene scene = SofaScene::from_text(
        block("", kGrid, "",
              "<GraspForceField name='source' stiffness='123.456789012345' keyTimes='0' positions='0 0 9' radius='1'/>"
              "<GraspForceField name='linked' stiffness='@source.stiffness' keyTimes='0' positions='0 0 9' radius='1'/>"
              "<AttributeChange component='@source' attribute='stiffness' keyTimes='0 0.01' values='7;'/>"
              "<AttributeChange component='@linked' attribute='stiffness' keyTimes='0' values='8'/>"));
    const auto stiffness = [&](const char* name) -> const Data<SReal>&
    { return dynamic_cast<const Data<SReal>&>(*scene.named(name).findData("stiffness")); };
    EXPECT_EQ(stiffness("linked").getValue(), 123.456789012345);
    scene.step();
    EXPECT_EQ(stiffness("source").getValue(), 7);
    EXPECT_EQ(stiffness("linked").getValue(), 8);
    scene.step();
    const auto& row = attributes::attribute_of(attributes::kGraspForceField, "stiffness");
    EXPECT_EQ(stiffness("source").getValue(), std::stod(std::string(row.initial)));
    EXPECT_FALSE(stiffness("source").isSet());
    EXPECT_EQ(stiffness("linked").getValue(), 8);
    scene.reset();
    EXPECT_EQ(stiffness("source").getValue(), 123.456789012345);
    EXPECT_TRUE(stiffness("source").isSet());
    scene.set("source", "stiffness", "400");
    EXPECT_EQ(stiffness("linked").getValue(), 400);
}

TEST(ExporterInSofa, WritesTheStateAfterItsStep)
{
    SofaScene nameless =
        SofaScene::from_text(block("", kGrid, "", "<FinalStateExporter name='exporter' exportAtStep='2'/>"));
    EXPECT_TRUE(isInvalid(nameless.named("exporter")));
    const auto file = std::filesystem::path(testing::TempDir()) / ("sofa_final_" + std::to_string(getpid()) + ".json");
    std::filesystem::remove(file);
    SofaScene scene = SofaScene::from_text(
        block(kPlastic, kGrid, "", "<FinalStateExporter exportAtStep='2' filename='" + file.string() + "'/>"));
    scene.move_to(scene.positions() * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    EXPECT_FALSE(std::filesystem::exists(file));
    scene.step();
    ASSERT_TRUE(std::filesystem::exists(file));
    const auto state = nlohmann::json::parse(std::ifstream(file));
    std::filesystem::remove(file);
    const PointArray x = scene.positions(), X = scene.body().plastic_rest_positions();
    for (int n = 0; n < x.rows(); ++n)
        for (int i = 0; i < 3; ++i)
        {
            EXPECT_EQ(state["positions"][n][i].get<double>(), x(n, i));
            EXPECT_EQ(state["plastic_rest_positions"][n][i].get<double>(), X(n, i));
        }
}

// The greatest plastic strain, and the way of the upper nodes: values by hand.
TEST(ProbeInSofa, ReadsAfterEveryStepAndWritesATable)
{
    const auto file = std::filesystem::path(testing::TempDir()) / ("sofa_probe_" + std::to_string(getpid()) + ".csv");
    SofaScene scene = SofaScene::from_text(
        block(kPlastic, kGrid,
              "<Probe name='strain' value='@tissue/body.plasticStrain' statistic='max' filename='" + file.string() +
                  "'/><Probe name='way' value='@tissue/nodes.position' indices='27 35' component='z' change='true'/>",
              "<Probe name='inside' value='@nodes.position' points='0.05 0.1 0.15' component='y'/>"));
    EXPECT_EQ(value_of<SReal>(scene.named("strain"), "reading"), 0);
    scene.move_to(scene.positions() * Eigen::Vector3d(0.9, 0.8, 1.4).asDiagonal());
    std::vector<double> strains;
    for (int step = 0; step < 2; ++step)
    {
        scene.step();
        const std::vector<double> strain = scene.body().fields(scene.positions()).plastic_strain;
        strains.push_back(*std::max_element(strain.begin(), strain.end()));
        EXPECT_EQ(value_of<SReal>(scene.named("strain"), "reading"), strains.back());
    }
    EXPECT_GT(strains[1], strains[0]);
    EXPECT_NEAR(value_of<SReal>(scene.named("way"), "reading"), 0.4 * 0.3, 1e-12);
    EXPECT_NEAR(value_of<SReal>(scene.named("inside"), "reading"), 0.8 * 0.1, 1e-12);
    std::ifstream table(file);
    std::string line;
    ASSERT_TRUE(std::getline(table, line));
    EXPECT_EQ(line, "time,strain");
    for (int step = 0; step < 2; ++step)
    {
        double time = 0, reading = 0;
        char comma = 0;
        ASSERT_TRUE(table >> time >> comma >> reading);
        EXPECT_NEAR(time, 0.01 * (step + 1), 1e-15);
        EXPECT_EQ(reading, strains[step]);
    }
    std::filesystem::remove(file);
}

TEST(ProbeInSofa, SaysWhatItCannotRead)
{
    for (const auto& [attributes, words] :
         {std::pair("value='@tissue/body.plasticStrain' component='x'", "Probe.component: is given for a value"),
          {"value='@tissue/nodes.position' indices='36'", "Probe.indices: holds 36, must lie in [0, 36)"},
          {"value='@tissue/body.plasticStrain' points='0 0 0'", "Probe.points: need one vector per node"},
          {"value='@tissue/nodes.position' filename='/nowhere/table.csv'", "Probe.filename: "}})
    {
        Messages messages;
        SofaScene scene =
            SofaScene::from_text(block("", kGrid, "<Probe name='probe' " + std::string(attributes) + "/>"));
        EXPECT_TRUE(isInvalid(scene.named("probe"))) << attributes;
        EXPECT_EQ(messages.count(words), 1) << messages.text();
    }
}

TEST(RunSettingsInSofa, PauseAfterTheirStepsAndSetTheThreads)
{
    const int threads = num_threads();
    SofaScene scene = SofaScene::from_text(block("", kGrid, "<RunSettings name='settings' steps='2' threads='3'/>"));
    EXPECT_EQ(num_threads(), 3);
    set_num_threads(threads);
    for (int time = 0; time < 2; ++time)
    {
        scene.root().setAnimate(true);
        scene.step();
        EXPECT_TRUE(scene.root().getAnimate());
        scene.step();
        EXPECT_FALSE(scene.root().getAnimate());
        scene.reset();
    }
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
