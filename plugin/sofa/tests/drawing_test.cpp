// SPDX-License-Identifier: LGPL-2.1-or-later
// What SOFA's windows show of a body, by a tool that keeps what is drawn.
#include <gtest/gtest.h>
#include <sofa/core/visual/VisualParams.h>

#include <Eigen/Geometry>
#include <fstream>
#include <set>

#include "block_scene.h"
#include "hexaplast/body.hpp"
#include "recording_draw_tool.h"
#include "sofa_scene.h"

namespace hexaplast::sofa_plugin::test
{
namespace
{

using Corners = std::vector<sofa::type::Vec3>;

class Drawing : public testing::Test
{
protected:
    RecordingDrawTool draw(bool shows_force_fields = true)
    {
        RecordingDrawTool tool;
        sofa::core::visual::VisualParams vparams;
        vparams.drawTool() = &tool;
        vparams.displayFlags().setShowForceFields(shows_force_fields);
        scene.field().draw(&vparams);
        return tool;
    }

    SofaScene scene = SofaScene::from_text(block(kPlastic));
    const PointArray rest = scene.positions();
};

/// [m^3] within triangles whose front is outside.
double enclosed(const Corners& corners)
{
    double volume = 0;
    for (std::size_t i = 0; i < corners.size(); i += 3)
    {
        const auto corner = [&](std::size_t k) { return Eigen::Map<const Eigen::Vector3d>(corners[i + k].ptr()); };
        volume += corner(0).dot(corner(1).cross(corner(2))) / 6;
    }
    return volume;
}

TEST_F(Drawing, ShowsTheSurfaceWhereItIs)
{
    const RecordingDrawTool at_rest = draw();
    EXPECT_EQ(at_rest.corners.size(), 3 * 2 * (2 * (2 * 2) + 4 * (2 * 3))) << "two triangles on each outer face";
    EXPECT_NEAR(enclosed(at_rest.corners), 0.2 * 0.2 * 0.3, 1e-15);
    scene.move_to(rest * Eigen::Vector3d(0.9, 0.8, 1.4).asDiagonal());
    EXPECT_NEAR(enclosed(draw().corners), 0.2 * 0.2 * 0.3 * 0.9 * 0.8 * 1.4, 1e-15);
}

TEST_F(Drawing, ColoursWhatHasFlowed)
{
    const RecordingDrawTool initial = draw();
    ASSERT_EQ(initial.colours.size(), initial.corners.size());
    for (const auto& colour : initial.colours) EXPECT_EQ(colour, initial.colours.front());
    EXPECT_GT(initial.colours.front().b(), initial.colours.front().r()) << "blue: nothing has flowed";

    PointArray x = rest;
    for (int n = 0; n < x.rows(); ++n)
        if (x(n, 2) > 0.25) x(n, 2) += 0.1;  // the upper slice alone
    scene.move_to(x);
    scene.step();
    const RecordingDrawTool plastic = draw();
    double upper = 0, lower = 0;
    for (std::size_t i = 0; i < plastic.corners.size(); ++i)
    {
        if (plastic.corners[i][2] > 0.25) upper += plastic.colours[i].r() - plastic.colours[i].b();
        if (plastic.corners[i][2] < 0.05) lower += plastic.colours[i].r() - plastic.colours[i].b();
    }
    EXPECT_GT(upper, 0) << "red: most has flowed";
    EXPECT_LT(lower, 0);
}

TEST_F(Drawing, ShowsTheShapeWithoutForcesOnDemand)
{
    scene.move_to(rest * Eigen::Vector3d(0.9, 0.9, 1.4).asDiagonal());
    scene.step();
    EXPECT_TRUE(draw().ends.empty());
    scene.field().findData("drawPlasticRestShape")->read("1");
    const RecordingDrawTool tool = draw();
    EXPECT_EQ(tool.ends.size(), 2 * 4 * (2 * (2 * 2) + 4 * (2 * 3))) << "four edges of each outer face";
    const PointArray& material = scene.body().plastic_rest_positions();
    std::set<double> heights, expected;
    for (const auto& end : tool.ends) heights.insert(end[2]);
    for (int n = 0; n < material.rows(); ++n)
        if (scene.body().mesh().incident(n).size() < 8) expected.insert(material(n, 2));
    EXPECT_EQ(heights, expected);
}

TEST_F(Drawing, LeavesTheToolAsItWasAndObeysTheFlags)
{
    const RecordingDrawTool tool = draw();
    EXPECT_EQ(tool.num_open_states, 0);
    EXPECT_EQ(tool.num_others, 0);
    EXPECT_TRUE(tool.is_lit);
    EXPECT_TRUE(draw(false).corners.empty());
}

TEST_F(Drawing, BoundsTheBody)
{
    const PointArray x = rest * Eigen::Vector3d(0.9, 0.8, 1.4).asDiagonal();
    scene.move_to(x);
    scene.field().computeBBox(sofa::core::execparams::defaultInstance());
    const auto& box = scene.field().f_bbox.getValue();
    for (int i = 0; i < 3; ++i)
    {
        EXPECT_EQ(box.minBBox()[i], x.col(i).minCoeff());
        EXPECT_EQ(box.maxBBox()[i], x.col(i).maxCoeff());
    }
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
