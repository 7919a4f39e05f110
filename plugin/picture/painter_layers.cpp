// SPDX-License-Identifier: LGPL-2.1-or-later
// A view, layer by layer.
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>

#include "picture/gl_program.hpp"
#include "picture/ink.hpp"
#include "picture/lamps.hpp"
#include "picture/painter.hpp"
#include "picture/shaders.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr float kLinesNearer = 2e-4f, kDotsNearer = 8e-3f;  // depth by which they stand before what they are on

/// The plane of the cut, as far as instruments reach.
Geometry::Vertices plane_around(const Geometry& geometry) {
  Eigen::AlignedBox3f box;
  for (const Geometry::Vertex& vertex : geometry.tools) box.extend(vertex.place);
  const Vector3f normal = geometry.cut->normal.cast<float>(), first = normal.unitOrthogonal(),
                 second = normal.cross(first);
  const Vector3f centre = box.center() - static_cast<float>(geometry.cut->height(box.center().cast<double>())) * normal;
  const float reach = box.sizes().norm();
  const auto corner = [&](float right, float up) -> Geometry::Vertex {
    return {centre + reach * (right * first + up * second), normal};
  };
  Geometry::Vertices plane;
  plane.add({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, -1), corner(1, 1), corner(-1, 1)});
  return plane;
}

}  // namespace

void Painter::draw(const View& view, const Viewport& viewport) {
  const Geometry& geometry = view.geometry;
  const Matrix4f clip = view.camera.clip(view.width, view.height).cast<float>(),
                 seen = seen_by(view.camera, geometry, kMapSize);
  const float density = viewport.density, length = geometry.edge_length * view.camera.scale();
  const std::optional<EdgeInk> edges = edge_ink(length, geometry.is_cage);
  for (int k = 0; k < kNumClips; ++k) glEnable(GL_CLIP_DISTANCE0 + k);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_DITHER);
  if (light_ == Light::kLamp) draw_shadow(geometry, seen);

  glViewport(viewport.left, viewport.bottom, viewport.width, viewport.height);
  glClearColor(kPaper.red, kPaper.green, kPaper.blue, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1 + density, kPushUnits);
  glUseProgram(flat_);
  set(flat_, "clip", clip);
  set(flat_, "nearer", 0);
  set_clips(flat_, {}, {});
  draw_behind(geometry, density);

  glUseProgram(surface_);
  set(surface_, "clip", clip);
  set(surface_, "seen", seen);
  set(surface_, "eye", Vector4f(seen * view.camera.eye().cast<float>()));
  set_clips(surface_, geometry.cut, {});
  glUniform2f(place_of(surface_, "scale"), static_cast<float>(view.min),
              view.max > view.min ? static_cast<float>(1 / (view.max - view.min)) : 0);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, shadow_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, colours_);
  if (view.palette != palette_) send_colours(view.palette);
  set(surface_, "opacity", 1);
  draw_body(view, !geometry.cut_outline.empty() || (edges && !geometry.edges.empty() && !geometry.is_cage));
  draw_tools(view);
  draw_marks(view, edges, density);
  draw_veil(geometry);

  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  for (int k = 0; k < kNumClips; ++k) glDisable(GL_CLIP_DISTANCE0 + k);
  glBindVertexArray(0);
  if (!(view.strip > 0)) return;
  glEnable(GL_SCISSOR_TEST);
  glScissor(viewport.left, viewport.bottom, viewport.width, static_cast<int>(view.strip * density));
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
}

// However near it is.
void Painter::draw_behind(const Geometry& geometry, float density) {
  draw_places(geometry.ghost, GL_TRIANGLES, kGhost);
  draw_lines(geometry.ghost_outline, kOriginal, 1, kOutlineWidth * density);
  if (!geometry.ghost.empty()) {
    set_clips(flat_, geometry.cut, {});
    draw_lines(geometry.halo, kPaper, 1, kHaloWidth * density);
  }
  glClear(GL_DEPTH_BUFFER_BIT);
}

void Painter::draw_body(const View& view, bool has_lines) {
  const Geometry& geometry = view.geometry;
  // where no lines lie on it, stepping back would only show what faces away along its silhouette
  if (!has_lines) glDisable(GL_POLYGON_OFFSET_FILL);
  draw_lit(geometry.surface, kTissue, nullptr);
  draw_lit(geometry.walls, kTissue, &kWall, kWallTint);
  glEnable(GL_POLYGON_OFFSET_FILL);
  draw_arrows(geometry.load_arrows, kLoad, view.camera.scale());
}

void Painter::draw_tools(const View& view) {
  const Geometry& geometry = view.geometry;
  glEnable(GL_DEPTH_CLAMP);  // instruments may be far from the body, to which the depths are fitted
  set_clips(surface_, geometry.cut, geometry.room);
  draw_lit(geometry.tools, kThing, &kMetal);
  set_clips(surface_, {}, {});
  const auto draw_cut_faces = [&] { draw_lit(geometry.cut_faces, kUnlit, nullptr); };  // values shall be readable there
  if (!geometry.is_hollow)
    draw_cut_faces();
  else if (geometry.cut && geometry.is_closed)
    draw_within(geometry, {&geometry.surface, &geometry.walls}, {}, draw_cut_faces);
  glDisable(GL_POLYGON_OFFSET_FILL);
  if (geometry.cut && geometry.are_tools_closed && !geometry.tools.empty())
    draw_within(geometry, {&geometry.tools}, geometry.room, [&] { draw_lit(plane_around(geometry), kUnlit, &kMetal); });
  set_clips(surface_, {}, {});
  glDepthRange(0, 0.01);
  draw_arrows(geometry.tool_arrows, kSteel, view.camera.scale());
  glDepthRange(0, 1);
}

void Painter::draw_marks(const View& view, const std::optional<EdgeInk>& edges, float density) {
  const Geometry& geometry = view.geometry;
  glUseProgram(flat_);
  set(flat_, "nearer", kLinesNearer);
  glDepthMask(GL_FALSE);
  set_clips(flat_, geometry.cut, geometry.room);
  draw_lines(geometry.tool_outline, kSteel, 1, kOutlineWidth * density);
  set_clips(flat_, {}, geometry.room);
  draw_lines(geometry.tool_cut_outline, kSteel, 1, kCutWidth * density);
  set_clips(flat_, geometry.cut, geometry.room);
  draw_lines(geometry.taut_springs, kSpring, 1, kSpringWidth * density);
  draw_lines(geometry.slack_springs, kSpring, kSlackOpacity, kSlackWidth * density);
  glDisable(GL_DEPTH_CLAMP);
  if (edges) {
    set_clips(flat_, geometry.cut, {});
    draw_lines(geometry.edges, edges->colour, edges->opacity, edges->width * density);
    set_clips(flat_, {}, {});
    draw_lines(geometry.cut_edges, edges->colour, edges->opacity, edges->width * density);
  }
  set_clips(flat_, {}, {});
  draw_lines(geometry.cut_outline, kEdge, 1, kCutWidth * density);
  set(flat_, "nearer", kDotsNearer);
  const float length = geometry.edge_length * view.camera.scale();
  set(flat_, "point_size", 2 * std::min(kDotRadius, kDotOfEdge * length) * density + 1);  // with a soft rim
  glEnable(GL_PROGRAM_POINT_SIZE);
  draw_places(geometry.fixed, GL_POINTS, kInk);
  glDepthMask(GL_TRUE);
}

// Its foremost surface.
void Painter::draw_veil(const Geometry& geometry) {
  if (geometry.veil.empty()) return;
  glUseProgram(surface_);
  set_clips(surface_, geometry.cut, {});
  set(surface_, "opacity", kVeilOpacity);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_lit(geometry.veil, kTissue, nullptr);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  draw_lit(geometry.veil, kTissue, &kVeil);
}

void Painter::draw_lit(const Geometry::Vertices& vertices, Lit how, const Colour* paint, float opacity_of_paint) {
  glUniform1i(place_of(surface_, "lighting"), how);
  set(surface_, "paint",
      paint ? Vector4f(paint->red, paint->green, paint->blue, opacity_of_paint) : Vector4f(0, 0, 0, 0));
  draw_corners(vertices);
}

void Painter::draw_arrows(const Geometry::Vertices& arrows, const Colour& colour, float scale) {
  glDepthMask(GL_FALSE);
  set(surface_, "grow", kRimOfArrows / scale);
  draw_lit(arrows, kUnlit, &kPaper);
  set(surface_, "grow", 0);
  glDepthMask(GL_TRUE);
  draw_lit(arrows, kThing, &colour);
}

// Draws what lies in the plane of the cut, as far as that is within closed surfaces: there one sees more of their backs
// than of their fronts.
void Painter::draw_within(const Geometry& geometry, std::initializer_list<const Geometry::Vertices*> closed,
                          const Eigen::AlignedBox3f& room, const std::function<void()>& draw_cap) {
  glEnable(GL_STENCIL_TEST);
  glClear(GL_STENCIL_BUFFER_BIT);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDisable(GL_DEPTH_TEST);
  glStencilFunc(GL_ALWAYS, 0, ~0u);
  glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
  glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
  set_clips(surface_, geometry.cut, {});
  for (const Geometry::Vertices* surface : closed) draw_lit(*surface, kUnlit, nullptr);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glStencilFunc(GL_NOTEQUAL, 0, ~0u);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  set_clips(surface_, {}, room);
  draw_cap();
  glDisable(GL_STENCIL_TEST);
}

}  // namespace hexaplast::output
