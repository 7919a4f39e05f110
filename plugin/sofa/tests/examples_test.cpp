// SPDX-License-Identifier: LGPL-2.1-or-later
// The example of each component in SOFA.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "messages.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

std::vector<std::string> examples()
{
    std::vector<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator(HEXAPLAST_EXAMPLES))
        if (file.path().extension() == ".scn") names.push_back(file.path().stem());
    std::sort(names.begin(), names.end());
    return names;
}

class ExampleInSofa : public testing::TestWithParam<std::string>
{
};

TEST_P(ExampleInSofa, IsValidAndStepsWithoutErrors)
{
    Messages messages;
    SofaScene scene = SofaScene::from_file(std::filesystem::path(HEXAPLAST_EXAMPLES) / (GetParam() + ".scn"));
    for (int step = 0; step < 5; ++step) scene.step();
    EXPECT_EQ(messages.errors(), "");

    std::vector<SofaComponent*> all;
    scene.root().get<SofaComponent>(&all, sofa::core::objectmodel::BaseContext::SearchDown);
    bool isThere = false;
    for (SofaComponent* each : all)
    {
        EXPECT_FALSE(isInvalid(*each)) << each->getPathName();
        isThere = isThere || each->getClassName() == GetParam();
    }
    EXPECT_TRUE(isThere) << "the component that the example is of";
}

INSTANTIATE_TEST_SUITE_P(Components, ExampleInSofa, testing::ValuesIn(examples()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
