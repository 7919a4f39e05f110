// SPDX-License-Identifier: LGPL-2.1-or-later
// How a gallery draws the states that it has collected.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "picture/gallery.hpp"
#include "picture/lighting.hpp"
#include "picture/picture_cut.hpp"
#include "picture/quantity.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

constexpr float kPatch = 12;      // size on the page of the flat pieces that a face is drawn with
constexpr int kMaxParts = 8;      // of them along an edge
constexpr int kShadeParts = 6;    // the same of a warped face where it keeps light off
constexpr float kWarped = 0.02f;  // of a quad's diagonals: what its middle is off the plane, four times
constexpr float kNearer = 4e-3f;  // depth by which marks stand before the surface that they are on

constexpr float kWireWidth = 1.5f;
constexpr float kAround = 0.5f;  // how far around the body instruments are shown, in diagonals of its box

constexpr std::array kArrowLengths{1.0f, 0.8f, 0.6f, 0.45f};  // that are tried, in parts of longest_arrow_
constexpr float kSmallest = 0.9f;     // size that arrows leave to the body, in parts of that without
constexpr float kShortestArrow = 3;   // on the page; shorter ones are left out
constexpr float kBetweenArrows = 24;  // on the page: of denser ones the strongest are drawn
constexpr float kAlongSight = 0.05f;  // of gravity that is seen: below, it has no direction on the page

/// Towards white by a fraction, for the gleam of what is moist.
Colour gleaming(const Colour& colour, float fraction) {
  return {colour.red + fraction * (1 - colour.red), colour.green + fraction * (1 - colour.green),
          colour.blue + fraction * (1 - colour.blue)};
}

/// Weights of a quad's corners at a place in it.
std::array<float, 4> weights_at(float s, float t) { return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t}; }

/// Whether the middle of a quad is far from its diagonals, for its size.
bool is_warped(const std::vector<Vector3f>& points, const Surface::Face& face) {
  const auto& [a, b, c, d] = face;
  const float across = std::max((points[c] - points[a]).norm(), (points[d] - points[b]).norm());
  return (points[a] - points[b] + points[c] - points[d]).norm() > kWarped * across;
}

/// What lies above all of them lies in the box.
std::vector<Plane> planes_around(const Eigen::AlignedBox3f& box) {
  std::vector<Plane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    planes.push_back({Vec3::Unit(axis), static_cast<double>(box.min()[axis])});
    planes.push_back({-Vec3::Unit(axis), -static_cast<double>(box.max()[axis])});
  }
  return planes;
}

bool straddles(const Plane& plane, const std::vector<Vector3f>& points, const Surface::Face& face) {
  const auto is_above = [&](int point) { return height(plane, points[point]) >= 0; };
  return std::ranges::any_of(face, is_above) && !std::ranges::all_of(face, is_above);
}

}  // namespace

std::vector<const Gallery::Shown*> Gallery::shown_in(const State& state) const {
  std::vector<const Shown*> shown;
  if (shows_body()) shown.push_back(&state.body);
  for (const Shown& embedded : state.embedded_surfaces) shown.push_back(&embedded);
  return shown;
}

// What is drawn lies above these.
std::vector<Plane> Gallery::sides(const Camera& camera) const {
  std::vector<Plane> above;
  if (camera.front()) above.push_back(*camera.front());
  if (staging_.cut) above.push_back(*staging_.cut);
  return above;
}

Gallery::Strongest Gallery::strongest_forces() const {
  Strongest strongest;
  strongest.arrow = longest_arrow_;
  for (const State& state : states_) {
    for (const Load& load : state.loads) strongest.load = std::max(strongest.load, load.force.norm());
    for (const Tool& tool : state.tools) strongest.tool = std::max(strongest.tool, tool.force.norm());
  }
  return strongest;
}

std::optional<Arrow> Gallery::arrow_of(const Load& load, const Strongest& strongest) const {
  if (!(strongest.load > 0)) return std::nullopt;
  return ArrowScale{strongest.arrow, strongest.load, kArrowGirth * longest_arrow_}.of_load(load.place, load.force,
                                                                                           load.outwards);
}

std::optional<Arrow> Gallery::arrow_of(const Tool& tool, const Strongest& strongest) const {
  if (!staging_.shows_loads || !(strongest.tool > 0)) return std::nullopt;
  return ArrowScale{strongest.arrow, strongest.tool, kArrowGirth * longest_arrow_}.of_tool(tool.place, tool.force);
}

// Where instruments are shown: around all that is shown of the body in any state. What lies farther off would make the
// body small.
Eigen::AlignedBox3f Gallery::surroundings() const {
  Eigen::AlignedBox3f box;
  const auto hold = [&](const Places& points) {
    for (const Vector3f& point : points) box.extend(point);
  };
  for (const State& state : states_) {
    hold(state.body.points);
    for (const Shown& embedded : state.embedded_surfaces) hold(embedded.points);
  }
  const Vector3f margin = Vector3f::Constant(kAround * box.sizes().norm());
  return {box.min() - margin, box.max() + margin};
}

void Gallery::see_arrows(Camera& camera, const Strongest& strongest) const {
  const auto see = [&](const std::optional<Arrow>& arrow) {
    if (arrow) camera.see(std::array{arrow->from, arrow->to});
  };
  for (const State& state : states_) {
    for (const Load& load : state.loads) see(arrow_of(load, strongest));
    for (const Tool& tool : state.tools)
      if (!tool.force.isZero(0)) see(arrow_of(tool, strongest));
  }
}

// Arrows that would make the body small are shorter, in all pictures alike.
void Gallery::fit(Camera& camera, Scale& scale, Strongest& strongest) const {
  const Eigen::AlignedBox3f near = surroundings();
  const auto is_near = [&](const Vector3f& place) { return near.contains(place); };
  for (const State& state : states_) {
    if (embedded_surfaces_.empty() || shows_cage()) camera.see(state.body.points);
    for (const Shown& embedded : state.embedded_surfaces) camera.see(embedded.points);
    for (const Shown& ghost : state.ghosts) camera.see(ghost.points);
    for (const Tool& tool : state.tools) {
      if (!tool.surface && is_near(tool.place)) camera.see({&tool.place, 1});
      if (std::ranges::all_of(tool.points, is_near)) {
        camera.see(tool.points);
      } else {
        for (const auto& [a, b, c, d] : tool.surface->faces())
          for_each_part({{{tool.points[a], {}}, {tool.points[b], {}}, {tool.points[c], {}}}}, planes_around(near),
                        [&](const std::array<Corner, 3>& part) {
                          for (const Corner& corner : part) camera.see_depths({&corner.place, 1});
                        });
      }
    }
    for (const Spring& spring : state.springs)
      for (const Vector3f& end : {spring.from, spring.to})
        if (is_near(end)) {
          camera.see({&end, 1});
        } else {  // drawn to where it leaves the box
          for (int corner = 0; corner < kCorners; ++corner) {
            const Vector3f place = near.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner));
            camera.see_depths({&place, 1});
          }
        }
    for (const Shown* shown : shown_in(state)) scale.see(shown->values);
    scale.see(state.cut.values);
  }
  if (embedded_surfaces_.empty() || shows_cage()) camera.see(original_->surface->original());
  const Window window = Page(staging_.width, staging_.height).window();
  Camera without_arrows = camera;
  without_arrows.fit(window);
  for (const float part : kArrowLengths) {
    Camera with_arrows = camera;
    strongest.arrow = part * longest_arrow_;
    see_arrows(with_arrows, strongest);
    with_arrows.fit(window);
    if (with_arrows.scale() < kSmallest * without_arrows.scale() && part > kArrowLengths.back()) continue;
    camera = with_arrows;
    return;
  }
}

Drawing Gallery::drawing(const State& state, const Camera& camera, const Scale& scale,
                         const Strongest& strongest) const {
  Page page(staging_.width, staging_.height);
  Drawing& picture = page.drawing();
  draw_ghosts(state, camera, picture);
  if (staging_.is_wireframe) {
    draw_wires(state, camera, scale, picture);
  } else {
    draw_surfaces(state, camera, scale, picture);
    draw_edges(state, camera, picture);
  }
  draw_springs(state, camera, picture);
  draw_tools(state, camera, picture);
  draw_loads(state, camera, strongest, picture);
  draw_marks(state, camera, page);
  page.add_title(title_, fmt::format("t = {:.{}f} s", state.time, time_decimals_));
  page.add_colour_bar(scale);
  page.add_keys(keys_of_shapes(scale), keys_of_forces(state, camera, strongest));
  return std::move(page).finished();
}

// The ghost is a pale shadow behind everything else, however near it is.
void Gallery::draw_ghosts(const State& state, const Camera& camera, Drawing& picture) const {
  std::vector<Plane> in_front;
  if (camera.front()) in_front.push_back(*camera.front());
  const Pen pen(camera, std::move(in_front), picture, Pen::Layer::kBehind);
  for (const Shown& ghost : state.ghosts) {
    const Places& points = ghost.points;
    for (const auto& [a, b, c, d] : ghost.surface->faces()) {
      pen.fill({{{points[a], kGhost}, {points[b], kGhost}, {points[c], kGhost}}});
      pen.fill({{{points[a], kGhost}, {points[c], kGhost}, {points[d], kGhost}}});
    }
    for (const auto& [a, b] : ghost.surface->outline(points, camera.towards()))
      pen.line({points[a], kOriginal}, {points[b], kOriginal}, kOutlineWidth, 1);
  }
}

void Gallery::draw_surfaces(const State& state, const Camera& camera, const Scale& scale, Drawing& picture) const {
  const std::vector<const Shown*> shown = shown_in(state);
  const std::vector<Plane> above = sides(camera);
  const Pen pen(camera, above, picture);

  // light is kept off by what is left alone
  Places points;
  std::vector<Triangle> triangles;
  const auto keep = [&](const std::array<Corner, 3>& part) {
    const int first = static_cast<int>(points.size());
    for (const Corner& corner : part) points.push_back(corner.place);
    triangles.push_back({first, first + 1, first + 2});
  };
  const auto place_above = [&](const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    for_each_part({{{a, {}}, {b, {}}, {c, {}}}}, above, keep);
  };
  for (const Shown* one : shown)
    for (const Surface::Face& face : one->surface->faces()) {
      if (Surface::is_triangle(face)) {
        place_above(one->points[face[0]], one->points[face[1]], one->points[face[2]]);
        continue;
      }
      // a warped quad would shade itself by triangles that lie off it
      const int parts = is_warped(one->points, face) ? kShadeParts : 1;
      const auto at = [&](int i, int j) {
        const std::array weight = weights_at(static_cast<float>(i) / parts, static_cast<float>(j) / parts);
        return Vector3f(weight[0] * one->points[face[0]] + weight[1] * one->points[face[1]] +
                        weight[2] * one->points[face[2]] + weight[3] * one->points[face[3]]);
      };
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) {
          place_above(at(i, j), at(i + 1, j), at(i + 1, j + 1));
          place_above(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
  for (const auto& [a, b, c] : state.cut.triangles)
    keep({{{state.cut.points[a], {}}, {state.cut.points[b], {}}, {state.cut.points[c], {}}}});
  Lighting lighting(camera.up(), camera.towards());
  lighting.place(points, triangles);

  const Vector3f halfway =
      (kGleamLamp.of(camera.right(), camera.up(), camera.towards()) + camera.towards()).normalized();
  const auto lit = [&](const Vector3f& at, Vector3f normal, float value) {
    if (normal.dot(camera.towards()) < 0) normal = -normal;
    const float received = lighting.received(at, normal);
    const float gleam = kGleam * received * std::pow(std::max(0.0f, normal.dot(halfway)), kGleamExponent);
    return gleaming(brightness(received) * scale.colour(value), gleam);
  };

  for (const Shown* one : shown) {
    const Surface& surface = *one->surface;
    const std::vector<std::array<Vector3f, 4>> normals = surface.corner_normals(one->points);
    const int across = static_cast<int>(surface.mean_edge() * camera.scale() / kPatch);
    std::vector<Corner> grid;
    for (std::size_t f = 0; f < surface.faces().size(); ++f) {
      const Surface::Face& face = surface.faces()[f];
      const auto at = [&](const std::array<float, 4>& weight) {
        Vector3f place = Vector3f::Zero(), outwards = Vector3f::Zero();
        float value = 0;
        for (int k = 0; k < 4; ++k) {
          place += weight[k] * one->points[face[k]];
          outwards += weight[k] * normals[f][k];
          value += weight[k] * one->values[face[k]];
        }
        return Corner{place, lit(place, outwards.normalized(), value)};
      };
      // a warped quad is a bilinear patch: cut finely enough, it shows no preferred diagonal
      const bool meets_cut = staging_.cut && !Surface::is_triangle(face) && straddles(*staging_.cut, one->points, face);
      const int parts = meets_cut ? kCutParts : std::clamp(across, Surface::is_triangle(face) ? 1 : 2, kMaxParts);
      grid.resize((parts + 1) * (parts + 1));
      for (int j = 0; j <= parts; ++j)
        for (int i = 0; i <= parts; ++i)
          grid[j * (parts + 1) + i] = at(weights_at(static_cast<float>(i) / parts, static_cast<float>(j) / parts));
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) {
          const Corner* low = &grid[j * (parts + 1) + i];
          const Corner* high = low + parts + 1;
          if (meets_cut) {
            // as the cut face sees it, so that the two meet
            const Corner middle = 0.25f * low[0] + 0.25f * low[1] + 0.25f * high[0] + 0.25f * high[1];
            pen.fill({{low[0], low[1], middle}});
            pen.fill({{low[1], high[1], middle}});
            pen.fill({{high[1], high[0], middle}});
            pen.fill({{high[0], low[0], middle}});
            continue;
          }
          pen.fill({{low[0], low[1], high[1]}});
          pen.fill({{low[0], high[1], high[0]}});
        }
    }
  }

  if (state.cut.triangles.empty()) return;
  // nothing is left above the cut face in the viewer's direction
  const Pen on_cut(camera, camera.front() ? std::vector{*camera.front()} : std::vector<Plane>(), picture);
  // and who cuts wants to read values there: the colours are those of the colour bar
  std::vector<Corner> corners;
  for (std::size_t n = 0; n < state.cut.points.size(); ++n)
    corners.push_back({state.cut.points[n], scale.colour(state.cut.values[n])});
  for (const auto& [a, b, c] : state.cut.triangles) on_cut.fill({{corners[a], corners[b], corners[c]}});
}

void Gallery::draw_tools(const State& state, const Camera& camera, Drawing& picture) const {
  std::vector<Plane> above = sides(camera);
  for (const Plane& plane : planes_around(surroundings())) above.push_back(plane);
  const Pen pen(camera, above, picture);
  // in light of their own: they keep none from the tissue, whose colours are to be compared
  const Vector3f lamp = kThingLamp.of(camera.right(), camera.up(), camera.towards());
  for (const Tool& tool : state.tools) {
    if (!tool.surface) continue;
    const std::vector<std::array<Vector3f, 4>> normals = tool.surface->corner_normals(tool.points);
    for (std::size_t f = 0; f < normals.size() && !staging_.is_wireframe; ++f) {
      const auto corner = [&](int k) {
        const Vector3f& place = tool.points[tool.surface->faces()[f][k]];
        return Corner{place, brightness(std::max(0.0f, lamp.dot(normals[f][k]))) * kMetal};
      };
      pen.fill({{corner(0), corner(1), corner(2)}});
    }
    for (const auto& [a, b] : tool.surface->outline(tool.points, camera.towards()))
      pen.line({tool.points[a], kSteel}, {tool.points[b], kSteel}, kOutlineWidth, 1);
  }
}

void Gallery::draw_springs(const State& state, const Camera& camera, Drawing& picture) const {
  std::vector<Plane> above = sides(camera);
  for (const Plane& plane : planes_around(surroundings())) above.push_back(plane);
  const Pen pen(camera, above, picture);
  for (const auto& [from, to, is_slack] : state.springs)
    pen.line({from, kSpring}, {to, kSpring}, is_slack ? kSlackWidth : kSpringWidth, is_slack ? kSlackOpacity : 1);
}

void Gallery::draw_edges(const State& state, const Camera& camera, Drawing& picture) const {
  if (!staging_.shows_hexahedra || !staging_.shows_edges) return;
  const Surface& surface = *state.body.surface;
  const std::optional<EdgeInk> ink = edge_ink(surface.mean_edge() * camera.scale(), shows_cage());
  if (!ink) return;
  const auto& [colour, width, opacity] = *ink;
  const Pen pen(camera, sides(camera), picture);
  for (const auto& [a, b] : surface.edges())
    pen.line({state.body.points[a], colour}, {state.body.points[b], colour}, width, opacity);

  const Pen on_cut(camera, camera.front() ? std::vector{*camera.front()} : std::vector<Plane>(), picture);
  const Places& points = state.cut.points;
  for (const auto& [a, b] : state.cut.inner_lines)
    on_cut.line({points[a], colour}, {points[b], colour}, width, opacity);
  for (const auto& [a, b] : state.cut.outline) on_cut.line({points[a], kEdge}, {points[b], kEdge}, kCutWidth, 1);
}

void Gallery::draw_wires(const State& state, const Camera& camera, const Scale& scale, Drawing& picture) const {
  const Pen pen(camera, sides(camera), picture);
  std::vector<const Shown*> shown;
  if (staging_.shows_hexahedra) shown.push_back(&state.body);
  for (const Shown& embedded : state.embedded_surfaces) shown.push_back(&embedded);
  for (const Shown* one : shown)
    for (const auto& [a, b] : one->surface->edges())
      pen.line({one->points[a], scale.colour(one->values[a])}, {one->points[b], scale.colour(one->values[b])},
               kWireWidth, 1);
}

// Where loaded nodes lie close together, the strongest of each neighbourhood stands for the others. Neighbourhoods are
// those of the initial shape, so that arrows do not jump in films.
void Gallery::draw_loads(const State& state, const Camera& camera, const Strongest& strongest, Drawing& picture) const {
  const float across = kBetweenArrows / camera.scale();
  std::map<std::array<int, 3>, const Load*> standing;
  for (const Load& load : state.loads) {
    std::array<int, 3> cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>(std::floor(mesh_.positions()(load.node, axis) / static_cast<double>(across)));
    const Load*& one = standing[cell];
    if (!one || load.force.norm() > 1.001f * one->force.norm()) one = &load;
  }
  const auto draw = [&](const std::optional<Arrow>& arrow, const Pen& pen) {
    if (arrow && (arrow->to - arrow->from).norm() * camera.scale() >= kShortestArrow) arrow->draw(camera, pen);
  };
  const Pen pen(camera, sides(camera), picture);
  for (const auto& [cell, load] : standing) draw(arrow_of(*load, strongest), pen);
  // seen also where they lie within the tissue, as the instruments are
  const Pen before(camera, camera.front() ? std::vector{*camera.front()} : std::vector<Plane>(), picture,
                   Pen::Layer::kInFront);
  for (const Tool& tool : state.tools) draw(arrow_of(tool, strongest), before);
}

void Gallery::draw_marks(const State& state, const Camera& camera, Page& page) const {
  const Pen pen(camera, sides(camera), page.drawing());
  if (staging_.shows_hexahedra) {
    const float radius = kDotOfEdge * state.body.surface->mean_edge() * camera.scale();
    for (const Vector3f& place : state.fixed) {
      if (!pen.reaches(place)) continue;
      Drawing::Vertex centre = camera.project(place);
      centre.depth -= kNearer;
      page.add_dot(centre, radius);
    }
  }
  for (const Tool& tool : state.tools) {
    if (tool.surface || (camera.front() && height(*camera.front(), tool.place) < 0)) continue;
    Drawing::Vertex centre = camera.project(tool.place);
    centre.depth = 0;  // seen also where it lies within the tissue
    page.add_ring(centre);
  }
}

// What the marks mean.
std::vector<Key> Gallery::keys_of_shapes(const Scale& scale) const {
  const bool has_fixed = std::ranges::any_of(states_, [](const State& state) { return !state.fixed.empty(); });
  std::vector<Key> keys;
  const bool has_springs = std::ranges::any_of(states_, [](const State& state) { return !state.springs.empty(); });
  if (!staging_.ghost.empty()) keys.push_back({Key::Mark::kLine, staging_.ghost, kOriginal});
  if (has_springs) keys.push_back({Key::Mark::kLine, "spring, paler where slack", kSpring});
  if (staging_.shows_hexahedra && has_fixed) keys.push_back({Key::Mark::kDot, "fixed"});
  if (scale.has_gaps()) keys.push_back({Key::Mark::kGap, fmt::format("no {}", scale.quantity().label)});
  return keys;
}

// Those of a state; what they say is the same in all pictures.
std::vector<Key> Gallery::keys_of_forces(const State& state, const Camera& camera, const Strongest& strongest) const {
  std::vector<Key> keys;
  if (!state.loads.empty())
    keys.push_back({Key::Mark::kArrow, fmt::format("load, up to {} per node", with_unit(strongest.load, "N")), kLoad});
  if (!state.tools.empty()) {
    const bool shows_force = staging_.shows_loads && strongest.tool > 0;
    const bool has_shapes = std::ranges::all_of(state.tools, [](const Tool& tool) { return tool.surface != nullptr; });
    keys.push_back(
        {has_shapes ? Key::Mark::kShape : Key::Mark::kRing,
         shows_force ? fmt::format("instrument, force up to {}", with_unit(strongest.tool, "N")) : "instrument",
         kSteel});
  }
  if (!staging_.gravity.isZero(0)) {
    const Vector3f down = staging_.gravity.normalized().cast<float>();
    const Eigen::Vector2f on_page(camera.right().dot(down), -camera.up().dot(down));
    keys.push_back({on_page.norm() < kAlongSight ? Key::Mark::kNone : Key::Mark::kArrow,
                    fmt::format("gravity {:.3g} m/s²", staging_.gravity.norm()), kInk, on_page});
  }
  return keys;
}

}  // namespace hexaplast::output
