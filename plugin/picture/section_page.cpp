// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/section_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/mesh/faces.hpp"
#include "picture/page.hpp"
#include "picture/picture_cut.hpp"

namespace hexaplast::output {
namespace {

constexpr float kGap = 26;                      // between sections
constexpr float kCaption = 34;                  // height of the line below a section
constexpr float kBehind = 0.9f, kFront = 0.5f;  // depths

/// Rows to the right, upwards and towards who looks against an axis.
Eigen::Matrix3f seen_along(int axis, const Vec3& up) {
  const Camera camera({.towards = Vec3::Unit(axis), .up = up});
  Eigen::Matrix3f rows;
  rows << camera.right().transpose(), camera.up().transpose(), camera.towards().transpose();
  return rows;
}

/// How sections of a size fill a window best.
struct Grid {
  int columns = 1, rows = 1;
  float scale = 0;  // [1/m]
};

Grid best_grid(int count, const Window& window, const Eigen::Vector2f& size) {
  Grid best;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const float width = window.width / static_cast<float>(columns) - kGap;
    const float height = window.height / static_cast<float>(rows) - kCaption;
    const float scale = std::min(width / size.x(), height / size.y());
    if (scale > best.scale) best = {columns, rows, scale};
  }
  return best;
}

}  // namespace

Drawing SectionPage::drawing(const HexMesh& mesh, ConstPoints positions, const std::vector<double>& values,
                             std::span<const unsigned char> alive, ConstPoints behind) const {
  PointArray at_nodes = PointArray::Zero(mesh.num_nodes(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(
      (entry_of(quantity).of_nodes ? values : nodal_means(mesh, values, alive)).data(), mesh.num_nodes());
  const auto [min, max] = extent_along(Vec3::Unit(axis), positions, mesh.hexahedra(), alive);
  const auto [min_behind, max_behind] = extent_along(Vec3::Unit(axis), behind, mesh.hexahedra());

  const Eigen::Matrix3f seen = seen_along(axis, up);
  std::vector<CutFace> sections, ghosts;
  std::vector<double> places;
  Scale scale(quantity, range, regions.names);
  const bool shows_numbers = !scale.palette().empty();
  Eigen::AlignedBox2f box;
  const auto extend = [&](const CutFace& section) {
    for (const Eigen::Vector3f& point : section.points) box.extend(Eigen::Vector2f((seen * point).head<2>()));
  };
  for (int k = 0; k < count; ++k) {
    const double fraction = (k + 0.5) / count;
    places.push_back(min + fraction * (max - min));
    const Plane plane{Vec3::Unit(axis), places.back()};
    sections.push_back(shows_numbers
                           ? cut_face(mesh, positions, at_nodes, plane, alive, regions, regions.numbers(), true)
                           : cut_face(mesh, positions, at_nodes, plane, alive));
    scale.see(sections.back().values);
    extend(sections.back());
    if (ghost.empty()) continue;
    const double place_behind = min_behind + fraction * (max_behind - min_behind);
    ghosts.push_back(cut_face(mesh, behind, at_nodes, {Vec3::Unit(axis), place_behind}, {}));
    extend(ghosts.back());
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2f(0, 0));
  const Eigen::Vector2f size = box.sizes().cwiseMax(1e-6f * static_cast<float>(max - min) + 1e-30f);

  Page page(width, height);
  Drawing& picture = page.drawing();
  const Window window = page.window();
  const Grid grid = best_grid(count, window, size);
  const float cell_width = window.width / static_cast<float>(grid.columns);
  const float cell_height = window.height / static_cast<float>(grid.rows);
  const int decimals = std::clamp(static_cast<int>(std::ceil(2 - std::log10(std::max(max - min, 1e-9)))), 0, 9);

  for (int k = 0; k < count; ++k) {
    // a last row that is not full stands in the middle
    const int row = k / grid.columns, in_row = std::min(grid.columns, count - row * grid.columns);
    const float x = window.left + window.width / 2 +
                    (static_cast<float>(k % grid.columns) - static_cast<float>(in_row - 1) / 2) * cell_width;
    const float y = window.top + (static_cast<float>(row) + 0.5f) * cell_height - kCaption / 2;
    const auto on_page = [&](const Eigen::Vector3f& place, float depth, const Colour& colour) {
      const Eigen::Vector2f from_middle = (seen * place).head<2>() - box.center();
      return Drawing::Vertex{x + grid.scale * from_middle.x(), y - grid.scale * from_middle.y(), depth, colour};
    };
    const auto draw_faces = [&](const CutFace& section, float depth, const auto& colour_of_value) {
      const auto corner = [&](int point) {
        return on_page(section.points[point], depth, colour_of_value(section.values[point]));
      };
      for (const auto& [a, b, c] : section.triangles) picture.triangles.push_back({{corner(a), corner(b), corner(c)}});
    };
    const auto draw_lines = [&](const CutFace& section, const std::vector<Edge>& lines, float depth,
                                const Colour& colour, float line_width, float opacity) {
      for (const auto& [a, b] : lines)
        picture.lines.push_back({on_page(section.points[a], depth, colour), on_page(section.points[b], depth, colour),
                                 line_width, opacity});
    };
    if (!ghosts.empty()) {
      draw_faces(ghosts[k], kBehind, [](float) { return kGhost; });
      draw_lines(ghosts[k], ghosts[k].outline, kBehind, kOriginal, kOutlineWidth, 1);
    }
    draw_faces(sections[k], kFront, [&](float value) { return scale.colour(value); });
    if (shows_edges) draw_lines(sections[k], sections[k].inner_lines, kFront, kEdge, 1.1f, 0.6f);
    draw_lines(sections[k], sections[k].outline, kFront, kEdge, 1.7f, 1);
    page.write(x, y + grid.scale * size.y() / 2 + 26, 16, Drawing::Align::kCentre, kInk,
               fmt::format("{} = {:.{}f} m", "xyz"[axis], places[k], decimals));
  }

  page.add_title(title, remark);
  page.add_colour_bar(scale);
  std::vector<Key> keys;
  if (!ghost.empty()) keys.push_back({Key::Mark::kLine, ghost, kOriginal});
  if (scale.has_gaps()) keys.push_back({Key::Mark::kGap, fmt::format("no {}", scale.quantity().label)});
  page.add_keys(keys);
  return std::move(page.drawing());
}

}  // namespace hexaplast::output
