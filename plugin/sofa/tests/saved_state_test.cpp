// SPDX-License-Identifier: LGPL-2.1-or-later
// The Data `state`: what a scene has kept brings it back to the last bit.
#include <gtest/gtest.h>

#include <map>

#include "block_scene.h"
#include "hexaplast/body.hpp"
#include "messages.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

/// What a script keeps of a scene: time, motion, and the Data `state` of all components that have one.
struct Kept
{
    double time;
    PointArray x, v;
    std::map<std::string, std::string> states;
};

template <class Visit>
void for_each_state(SofaScene& scene, const Visit& visit)
{
    std::vector<SofaComponent*> all;
    scene.root().get<SofaComponent>(&all, sofa::core::objectmodel::BaseContext::SearchDown);
    for (SofaComponent* each : all)
        if (auto* state = dynamic_cast<Data<std::string>*>(each->findData("state"))) visit(each->getName(), *state);
}

Kept kept(SofaScene& scene)
{
    Kept all{scene.root().getTime(), scene.positions(), scene.velocities(), {}};
    for_each_state(
        scene, [&](const std::string& name, const Data<std::string>& state) { all.states[name] = state.getValue(); });
    return all;
}

void bring_back(SofaScene& scene, const Kept& all)
{
    std::vector<sofa::simulation::Node*> nodes{&dynamic_cast<sofa::simulation::Node&>(scene.root())};
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
        nodes[i]->setTime(all.time);
        for (const auto& child : nodes[i]->child) nodes.push_back(child.get());
    }
    scene.move_to(all.x);
    auto v = scene.state().writeVelocities();
    v.wref().resize(static_cast<std::size_t>(all.v.rows()));
    view(v.wref()) = all.v;
    for_each_state(scene,
                   [&](const std::string& name, Data<std::string>& state) { state.setValue(all.states.at(name)); });
}

void walk(SofaScene& scene, int steps)
{
    for (int step = 0; step < steps; ++step) scene.step();
}

// Instruments with friction, a fat that flows, multigrid.
TEST(SavedStateInSofa, BringsARunBackToTheLastBit)
{
    const std::string file = std::string(HEXAPLAST_SCENES) + "/forceps_fat.scn";
    SofaScene scene = SofaScene::from_file(file);
    walk(scene, 60);
    const Kept middle = kept(scene);
    EXPECT_GE(middle.states.size(), 4u);
    walk(scene, 30);
    const PointArray end = scene.positions(), flowed = scene.body().plastic_rest_positions();
    EXPECT_GT((flowed - PointArray(view(scene.state().readRestPositions().ref()))).norm(), 1e-6) << "it has flowed";

    bring_back(scene, middle);
    walk(scene, 30);
    EXPECT_EQ(scene.positions(), end) << "undo";
    EXPECT_EQ(scene.body().plastic_rest_positions(), flowed);

    SofaScene another = SofaScene::from_file(file);
    bring_back(another, middle);
    walk(another, 30);
    EXPECT_EQ(another.positions(), end) << "in another scene";
    EXPECT_EQ(kept(another).states, kept(scene).states);
}

TEST(SavedStateInSofa, OfASceneFileIsWhatResetReturnsTo)
{
    SofaScene first = SofaScene::from_text(block(kPlastic));
    const PointArray rest = first.positions();
    first.move_to(rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    first.step();
    const std::string state = value_of<std::string>(first.field(), "state");
    const PointArray flowed = first.body().plastic_rest_positions();
    SofaScene second = SofaScene::from_text(block(kPlastic + " state='" + state + "'"));
    EXPECT_EQ(second.body().plastic_rest_positions(), flowed) << "runSofa resets before it runs";
    second.move_to(rest * Eigen::Vector3d(0.8, 0.8, 1.9).asDiagonal());
    walk(second, 3);
    EXPECT_NE(second.body().plastic_rest_positions(), flowed);
    second.reset();
    EXPECT_EQ(second.body().plastic_rest_positions(), flowed);
}

TEST(SavedStateInSofa, IsNotComputedUnlessItIsRead)
{
    SofaScene scene = SofaScene::from_text(block(kPlastic));
    const auto* state = scene.field().findData("state");
    const int counter = state->getCounter();
    walk(scene, 3);
    EXPECT_EQ(state->getCounter(), counter);
}

TEST(SavedStateInSofa, KeepsTheDataOfTheScene)
{
    SofaScene scene = SofaScene::from_text(block(kPlastic));
    const std::string state = value_of<std::string>(scene.field(), "state");
    scene.set("body", "youngModulus", "700");
    scene.step();
    EXPECT_EQ(scene.body().material(0).young_modulus, 700);
    scene.set("body", "state", state);
    scene.step();
    EXPECT_EQ(scene.body().material(0).young_modulus, 700) << "the Data says so";
}

TEST(SavedStateInSofa, ThatCannotBeIsRefusedAndChangesNothing)
{
    SofaScene scene = SofaScene::from_text(block(kPlastic)),
              other = SofaScene::from_text(block(kPlastic, replaced(kGrid, "3 3 4", "3 3 3")));
    scene.move_to(scene.positions() * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    const PointArray flowed = scene.body().plastic_rest_positions();
    const std::string state = value_of<std::string>(scene.field(), "state");
    std::string damaged = state;
    damaged[damaged.size() / 2] = damaged[damaged.size() / 2] == '0' ? '1' : '0';
    for (const auto& [text, words] :
         {std::pair(std::string("plastic"), "state: holds 'p', must be hexadecimal digits"),
          {state.substr(0, state.size() - 1), "state: ends within a byte"},
          {state.substr(0, state.size() / 2), "HexahedronElastoplasticFEMForceField: "},
          {damaged, "HexahedronElastoplasticFEMForceField: "},
          {value_of<std::string>(other.field(), "state"), "HexahedronElastoplasticFEMForceField: "}})
    {
        Messages messages;
        scene.set("body", "state", text);
        scene.field().reinit();
        EXPECT_TRUE(isInvalid(scene.field()));
        EXPECT_GT(messages.count(words), 0) << messages.text();
        EXPECT_EQ(scene.body().plastic_rest_positions(), flowed);
        scene.set("body", "state", state);
        scene.field().reinit();
        EXPECT_FALSE(isInvalid(scene.field())) << messages.text();
        EXPECT_EQ(scene.body().plastic_rest_positions(), flowed);
    }
}

const std::string kSource = "<Node name='source'>" + kGrid + "</Node>";
const std::string kDynamicTopology =
    "<HexahedronSetTopologyContainer name='cells' position='@../source/grid.position' "
    "hexahedra='@../source/grid.hexahedra'/><HexahedronSetTopologyModifier removeIsolated='false'/>";

// A topology loses what the state has lost; it gets nothing back.
TEST(SavedStateInSofa, HoldsWhatIsRemoved)
{
    const std::string text =
        block(kPlastic + R"( fractureStretch="1.001" topology="@cells")", kDynamicTopology, kSource);
    SofaScene scene = SofaScene::from_text(text), fresh = SofaScene::from_text(text);
    const std::string whole = value_of<std::string>(scene.field(), "state");
    auto positions = scene.state().writePositions();
    for (auto& x : positions)
        if (x[2] > 0.25) x[2] += 0.1;
    walk(scene, 20);
    ASSERT_EQ(scene.body().removed().size(), 4u);
    fresh.set("body", "state", value_of<std::string>(scene.field(), "state"));
    fresh.step();
    EXPECT_EQ(fresh.body().removed().size(), 4u);
    EXPECT_EQ(fresh.field().l_topology->getNbHexahedra(), 8u);
    scene.set("body", "state", whole);
    scene.field().reinit();
    EXPECT_EQ(scene.body().removed().size(), 4u) << "the topology stays torn";
}

// Nodes that are given back come when the body takes its state.
TEST(SavedStateInSofa, BringsACutBackToTheLastBit)
{
    const std::string file = std::string(HEXAPLAST_SCENES) + "/sheet_cut.scn";
    SofaScene scene = SofaScene::from_file(file);
    const Kept whole = kept(scene);
    walk(scene, 80);
    const Kept middle = kept(scene);
    ASSERT_GT(middle.x.rows(), whole.x.rows());
    walk(scene, 30);
    const PointArray end = scene.positions();
    ASSERT_GT(end.rows(), middle.x.rows());

    SofaScene another = SofaScene::from_file(file);
    bring_back(another, middle);
    walk(another, 30);
    EXPECT_EQ(another.positions(), end);
    EXPECT_EQ(kept(another).states, kept(scene).states);

    // undone to a time when less was cut: what is open stays open
    Messages messages;
    bring_back(scene, whole);
    scene.step();
    EXPECT_GT(messages.count("stay open"), 0) << messages.text();
    EXPECT_EQ(messages.errors(), "");
    EXPECT_EQ(scene.positions().rows(), end.rows());
    EXPECT_LT((scene.positions().topRows(whole.x.rows()) - whole.x).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
