// SPDX-License-Identifier: LGPL-2.1-or-later
// What the body shows of itself in SOFA.
#include <sofa/core/visual/VisualParams.h>

#include <algorithm>
#include <set>

#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

TEST_F(Adapter, DrawsTheSurfaceInColoursOfPlasticStrain) {
  auto& field = make_body(kPlastic);
  const sofa::type::RGBAColor blue{0, 0, 1, 1}, red{1, 0, 0, 1};
  const std::size_t num_faces = mesh.boundary_faces().size(), num_corners = 6 * num_faces;

  sofa::core::visual::VisualParams initial;
  field.draw(&initial);
  ASSERT_EQ(initial.tool.triangles.size(), 1u);
  EXPECT_EQ(initial.tool.triangles[0].corners.size(), num_corners);
  EXPECT_EQ(initial.tool.triangles[0].colours, std::vector<sofa::type::RGBAColor>(num_corners, blue));
  EXPECT_TRUE(initial.tool.lines.empty());
  EXPECT_EQ(initial.tool.open_states, 0) << "leaves the tool as it was";

  // the upper half alone
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 0.15) x(n, 2) += 0.5 * (x(n, 2) - 0.15);
  step(x);
  dynamic_cast<Data<bool>&>(*field.findData("drawPlasticRestShape")).setValue(true);
  sofa::core::visual::VisualParams plastic;
  field.draw(&plastic);
  const auto& drawn = plastic.tool.triangles.at(0);
  ASSERT_EQ(drawn.colours.size(), drawn.corners.size());
  std::set<float> shades;
  for (const auto& colour : drawn.colours) shades.insert(colour.r);
  EXPECT_GT(std::count(drawn.colours.begin(), drawn.colours.end(), red), 0) << "the most strained";
  EXPECT_LT(*shades.begin(), 0.5f) << "the least strained";
  EXPECT_GT(shades.size(), 2u);
  const auto faces = mesh.boundary_faces();
  for (const int corner : {0, 1, 2})
    for (int i = 0; i < 3; ++i) EXPECT_EQ(drawn.corners[corner][i], x(faces[0][corner], i));
  ASSERT_EQ(plastic.tool.lines.size(), 1u);
  EXPECT_EQ(plastic.tool.lines[0].ends.size(), 8 * num_faces);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(plastic.tool.lines[0].ends[0][i], field.body()->plastic_rest_positions()(faces[0][0], i));

  sofa::core::visual::VisualParams hidden;
  hidden.flags.show_force_fields = false;
  field.draw(&hidden);
  EXPECT_TRUE(hidden.tool.triangles.empty());
}

TEST_F(Adapter, BoundsTheBody) {
  auto& field = make_body(kPlastic);
  move_to(stretched);
  sofa::core::ExecParams eparams;
  field.computeBBox(&eparams);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(field.f_bbox.getValue().min[i], stretched.col(i).minCoeff());
    EXPECT_EQ(field.f_bbox.getValue().max[i], stretched.col(i).maxCoeff());
  }
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
