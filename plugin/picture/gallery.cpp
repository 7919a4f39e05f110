// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/gallery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hexaplast/mesh/faces.hpp"
#include "picture/lamps.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

constexpr float kAround = 0.5f;  // how far around the body instruments are shown, in diagonals of its box
constexpr std::array kArrowLengths{1.0f, 0.8f, 0.6f, 0.45f};  // that are tried, in parts of the longest arrow
constexpr float kSmallest = 0.9f;     // size that arrows leave to the body, in parts of that without
constexpr float kAlongSight = 0.05f;  // of gravity that is seen: below, it has no direction on the page

}  // namespace

int time_decimals(double dt) {
  return dt > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(dt) - 1e-9)), 2, 6) : 2;
}

Gallery::Gallery(const HexMesh& mesh, std::string title, int time_decimals, Staging staging)
    : title_(std::move(title)),
      time_decimals_(time_decimals),
      shapes_(mesh, std::move(staging)),
      viewpoint_(shapes_.staging.seen_from(mesh)) {
  if (shapes_.staging.cut) {
    // what is left out lies above
    Plane& cut = *shapes_.staging.cut;
    const double viewer = viewpoint_.eye ? cut.height(viewpoint_.eye->position) : cut.normal.dot(viewpoint_.towards);
    if (viewer < 0) cut = {-cut.normal, -cut.offset};
  }
}

void Gallery::add(long step, double time, ConstPoints positions, const std::vector<double>& values,
                  std::span<const unsigned char> alive, const BoundaryConditions& conditions, const PointArray* ghost,
                  const std::shared_ptr<const OpenFaces>& open) {
  const bool is_nodal = entry_of(shapes_.staging.quantity).of_nodes;
  states_.push_back({shapes_.at(positions, is_nodal ? values : nodal_means(shapes_.mesh(), values, alive), alive,
                                conditions, ghost, open),
                     step, time});
}

Strongest Gallery::strongest_forces() const {
  Strongest strongest{.arrow = shapes_.longest_arrow(), .girth = kArrowGirth * shapes_.longest_arrow()};
  for (const State& state : states_) {
    for (const Moment::Load& load : state.loads) strongest.load = std::max(strongest.load, load.force.norm());
    if (shapes_.staging.shows_loads)
      for (const Moment::Tool& tool : state.tools) strongest.tool = std::max(strongest.tool, tool.force.norm());
  }
  return strongest;
}

// Where instruments are shown: around all that is shown of the body in any state. What lies farther off would make the
// body small.
Eigen::AlignedBox3f Gallery::surroundings() const {
  Eigen::AlignedBox3f box;
  const auto hold = [&](const Moment::Places& points) {
    for (const Vector3f& point : points) box.extend(point);
  };
  for (const State& state : states_) {
    hold(state.body.points);
    for (const Moment::Shown& embedded : state.embedded_surfaces) hold(embedded.points);
  }
  const Vector3f margin = Vector3f::Constant(kAround * box.sizes().norm());
  return {box.min() - margin, box.max() + margin};
}

void Gallery::see_arrows(Camera& camera, const Strongest& strongest) const {
  const auto see = [&](const std::optional<Arrow>& arrow) {
    if (arrow) camera.see(std::array{arrow->from, arrow->to});
  };
  for (const State& state : states_) {
    for (const Moment::Load& load : state.loads) see(strongest.arrow_of(load));
    for (const Moment::Tool& tool : state.tools) see(strongest.arrow_of(tool));
  }
}

// Arrows that would make the body small are shorter, in all pictures alike.
void Gallery::fit(Camera& camera, Scale& scale, Strongest& strongest, const Eigen::AlignedBox3f& room) const {
  const Staging& staging = shapes_.staging;
  const bool shows_body = !staging.has_surfaces() || staging.shows_hexahedra;
  const auto is_near = [&](const Vector3f& place) { return room.contains(place); };
  bool reaches_out = false;
  for (const State& state : states_) {
    if (shows_body) camera.see(state.body.points);
    for (const Moment::Shown& embedded : state.embedded_surfaces) camera.see(embedded.points);
    for (const Moment::Shown& ghost : state.ghosts) camera.see(ghost.points);
    for (const Moment::Tool& tool : state.tools) {
      if (!tool.surface && is_near(tool.place)) camera.see({&tool.place, 1});
      if (std::ranges::all_of(tool.points, is_near))
        camera.see(tool.points);
      else
        reaches_out = true;
    }
    for (const SpringLine& spring : state.springs)
      for (const Vector3f end : {spring.from.cast<float>(), spring.to.cast<float>()})
        if (is_near(end))
          camera.see({&end, 1});
        else
          reaches_out = true;
    for (const Moment::Shown* shown : state.filled(staging)) scale.see(shown->values);
    scale.see(state.cut.values);
  }
  if (shows_body) camera.see(shapes_.original().surface->original());
  // what reaches out is drawn to where it leaves the room
  for (int corner = 0; reaches_out && corner < kCorners; ++corner) {
    const Vector3f place = room.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner));
    camera.see_depths({&place, 1});
  }
  const Window window = Page(staging.width, staging.height).window();
  Camera without_arrows = camera;
  without_arrows.fit(window);
  for (const float part : kArrowLengths) {
    Camera with_arrows = camera;
    strongest.arrow = part * shapes_.longest_arrow();
    see_arrows(with_arrows, strongest);
    with_arrows.fit(window);
    if (with_arrows.scale() < kSmallest * without_arrows.scale() && part > kArrowLengths.back()) continue;
    camera = with_arrows;
    return;
  }
}

Drawing Gallery::drawing(const State& state, const Camera& camera, const Scale& scale, const Strongest& strongest,
                         const Eigen::AlignedBox3f& room) const {
  Page page(shapes_.staging.width, shapes_.staging.height);
  View view{shapes_.geometry(state, camera, strongest),
            camera,
            page.width(),
            page.height(),
            scale.min(),
            scale.max(),
            Page::strip(),
            scale.palette()};
  view.geometry.room = room;
  light_up(view.geometry, camera);
  page.drawing().view = std::make_shared<View>(std::move(view));
  for (const Moment::Tool& tool : state.tools) {
    if (tool.surface || !camera.is_before(tool.place)) continue;
    const Eigen::Vector2f centre = camera.on_page(tool.place);
    page.add_ring({centre.x(), centre.y(), 0, {}});  // seen also where it lies within the tissue
  }
  page.add_title(title_, fmt::format("t = {:.{}f} s", state.time, time_decimals_));
  page.add_axes(camera, shapes_.staging.is_anatomical);
  page.add_colour_bar(scale);
  page.add_keys(keys_of_shapes(scale), keys_of_forces(state, camera, strongest));
  return std::move(page.drawing());
}

// What the marks mean.
std::vector<Key> Gallery::keys_of_shapes(const Scale& scale) const {
  const bool has_fixed = std::ranges::any_of(states_, [](const State& state) { return !state.fixed.empty(); });
  std::vector<Key> keys;
  const bool has_springs = std::ranges::any_of(states_, [](const State& state) { return !state.springs.empty(); });
  if (shapes_.staging.shows_ghost()) keys.push_back({Key::Mark::kLine, shapes_.staging.ghost, kOriginal});
  if (has_springs) keys.push_back({Key::Mark::kLine, "spring, paler where slack", kSpring});
  if (shapes_.staging.shows_hexahedra && has_fixed) keys.push_back({Key::Mark::kDot, "fixed"});
  if (scale.has_gaps()) keys.push_back({Key::Mark::kGap, fmt::format("no {}", scale.quantity().label)});
  return keys;
}

// Those of a state; what they say is the same in all pictures.
std::vector<Key> Gallery::keys_of_forces(const State& state, const Camera& camera, const Strongest& strongest) const {
  std::vector<Key> keys;
  if (!state.loads.empty())
    keys.push_back({Key::Mark::kArrow, fmt::format("load, up to {} per node", with_unit(strongest.load, "N")), kLoad});
  if (!state.tools.empty()) {
    const bool shows_force = shapes_.staging.shows_loads && strongest.tool > 0;
    const bool has_shapes =
        std::ranges::all_of(state.tools, [](const Moment::Tool& tool) { return tool.surface != nullptr; });
    keys.push_back(
        {has_shapes ? Key::Mark::kShape : Key::Mark::kRing,
         shows_force ? fmt::format("instrument, force up to {}", with_unit(strongest.tool, "N")) : "instrument",
         kSteel});
  }
  if (!shapes_.staging.gravity.isZero(0)) {
    const Vector3f down = shapes_.staging.gravity.normalized().cast<float>();
    const Eigen::Vector2f on_page(camera.right().dot(down), -camera.up().dot(down));
    keys.push_back({on_page.norm() < kAlongSight ? Key::Mark::kNone : Key::Mark::kArrow,
                    fmt::format("gravity {:.3g} m/s²", shapes_.staging.gravity.norm()), kInk, on_page});
  }
  return keys;
}

}  // namespace hexaplast::output
