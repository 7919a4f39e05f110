// SPDX-License-Identifier: LGPL-2.1-or-later
// Shipped scenes in SOFA and in the embedded host: the same positions and the same plastic history.
#include <gtest/gtest.h>

#include <fstream>

#include "hexaplast/body.hpp"
#include "scene/plugin.hpp"
#include "scene/reader.hpp"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

struct Case
{
    std::string scene;
    int steps;
    double bound;  ///< of the body's size
};

class ShippedSceneInSofa : public testing::TestWithParam<Case>
{
};

TEST_P(ShippedSceneInSofa, MovesAndFlowsAsInTheEmbeddedHost)
{
    const std::filesystem::path file = std::filesystem::path(HEXAPLAST_SCENES) / (GetParam().scene + ".scn");
    SofaScene sofa = SofaScene::from_file(file);

    scene::Factory factory;
    scene::PluginLoader loader(factory, {HEXAPLAST_PLUGINS});
    loader.load("Hexaplast");
    scene::Scene host = scene::read_scene(file, factory, loader);
    host.init();
    const scene::ForceField* field = nullptr;
    host.root().for_each<scene::ForceField>(
        [&](const scene::ForceField& each)
        {
            if (each.body()) field = &each;
        });
    ASSERT_TRUE(field);
    scene::MechanicalState& state = *field->node().nearest<scene::MechanicalState>();

    const double size = (sofa.positions().colwise().maxCoeff() - sofa.positions().colwise().minCoeff()).norm();
    double positions = 0, material = 0, travel = 0;
    for (int step = 0; step < GetParam().steps; ++step)
    {
        sofa.step();
        host.step();
        positions = std::max(positions, (sofa.positions() - state.positions()).cwiseAbs().maxCoeff());
        material = std::max(
            material,
            (sofa.body().plastic_rest_positions() - field->body()->plastic_rest_positions()).cwiseAbs().maxCoeff());
        travel = std::max(travel, (state.positions() - state.rest_positions()).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(positions, GetParam().bound * size);
    EXPECT_LE(material, GetParam().bound * size);
    EXPECT_GT(travel, 1e-3 * size) << "something happened";
    RecordProperty("positions", std::to_string(positions / size));
    std::cout << GetParam().scene << ": largest difference in " << GetParam().steps << " steps: positions "
              << positions / size << ", material " << material / size << " of the body's size\n";
}

// Direct solvers; conjugate gradients, which stop at the tolerances of their scenes, take the differences of rounding
// further. The vessel's strands tear from step 62 on: what rounding differs by grows while they snap (1e-9 without
// AVX-512).
INSTANTIATE_TEST_SUITE_P(Bars, ShippedSceneInSofa,
                         testing::Values(Case{"bar_stretch_high", 300, 1e-9}, Case{"bar_stretch_low", 200, 1e-9},
                                         Case{"bar_twist_high", 200, 1e-9}, Case{"bar_twist_low", 200, 1e-9},
                                         Case{"bar_stretch_face", 200, 1e-9}),
                         [](const auto& info) { return info.param.scene; });
INSTANTIATE_TEST_SUITE_P(Tissue, ShippedSceneInSofa,
                         testing::Values(Case{"peritoneum_tear", 130, 1e-5}, Case{"vessel_mobilise", 140, 1e-8},
                                         Case{"fatty_tissue", 60, 1e-5}, Case{"liver_cage", 60, 1e-5}),
                         [](const auto& info) { return info.param.scene; });

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
