// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/painter.hpp"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "picture/ink.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Matrix3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr int kNumColours = 256;

// of the many lamps
constexpr float kEvenStrength = 0.45f;  // of those far from the main lamp; the rest gathers around it
constexpr float kMainWidth = 0.45f;     // [rad] of what gathers there
constexpr float kMainStrength = 6;      // in its middle

// of the maps of depths [texels]
constexpr float kRim = 3;      // free around the bodies
constexpr float kLift = 1.5f;  // that a place is looked at above its surface, so that it shades not itself
constexpr float kSlack = 1;    // by which something must be nearer to the lamp to cast a shadow
constexpr float kSoft = 6;     // radius of the disc that softens the shadows of a single lamp

// Triangles step back by this and by what they slope over half a line, so that lines lie in front over their full
// width.
constexpr float kPushUnits = 16;
constexpr float kLinesNearer = 2e-4f, kDotsNearer = 8e-3f;  // depth by which they stand before what they are on

struct PageVertex {
  Vector3f place;
  Vector4f ink;
};

// How a surface is lit.
enum Lit { kUnlit, kTissue, kThing };

constexpr const char* kVersion = "#version 330 core\n";

// What lies outside is left out.
constexpr const char* kClip = R"(
uniform vec4 cut;       // normal, offset: what lies above
uniform vec3 low, high; // of a box
out float gl_ClipDistance[7];
void leave_out(vec3 place) {
  gl_ClipDistance[0] = cut.w - dot(cut.xyz, place);
  for (int k = 0; k < 3; ++k) {
    gl_ClipDistance[1 + k] = place[k] - low[k];
    gl_ClipDistance[4 + k] = high[k] - place[k];
  }
}
)";
constexpr int kNumClips = 7;

// What a place of the surface receives of the light: found at the vertices where there are many lamps, at every pixel
// where there is one. Places are seen along right, up and towards the viewer, around the middle of the bodies, which
// reach to 1.
constexpr const char* kReceived = R"(
uniform sampler2DArrayShadow shadow;
uniform mat3 lamps[kNumLamps];
uniform float strength[kNumLamps];
uniform vec4 eye;  // homogeneous
uniform int lighting;

const vec2 kDisc[12] = vec2[](vec2(-0.33, -0.40), vec2(-0.84, -0.07), vec2(-0.70, 0.46), vec2(-0.20, 0.62),
                              vec2(0.96, -0.19), vec2(0.47, -0.48), vec2(0.52, 0.77), vec2(0.19, -0.89),
                              vec2(0.51, 0.06), vec2(0.90, 0.41), vec2(-0.32, -0.93), vec2(-0.79, -0.60));

vec3 sight_from(vec3 place) { return normalize(eye.xyz - eye.w * place); }
vec3 turned(vec3 normal, vec3 sight) { return normalize(dot(normal, sight) < 0 ? -normal : normal); }

float received(vec3 place, vec3 normal) {
  float sum = kNumLamps == 1 ? sky(normal) : 0.0;
  vec3 above = place + kLift * normal;
  for (int k = 0; k < kNumLamps; ++k) {
    float slant = (lamps[k] * normal).z;
    if (slant <= 0) continue;
    vec3 at = 0.5 + 0.5 * (lamps[k] * above);
    float arriving = 0;
    for (int tap = 0; tap < kNumTaps; ++tap)
      arriving += texture(shadow, vec4(at.xy + kSoft * kDisc[tap], k, 1 - at.z - kSlack));
    sum += strength[k] * slant * arriving / kNumTaps;
  }
  return sum;
}
)";

constexpr const char* kSurfaceVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
uniform mat4 clip, seen;
uniform vec2 scale;  // min, 1 / (max - min)
uniform float grow;  // along the normal
out vec3 seen_place, seen_normal;
out float fraction, gap, light;
void main() {
  gl_Position = clip * vec4(place + grow * normal, 1);
  leave_out(place);
  seen_place = (seen * vec4(place, 1)).xyz;
  seen_normal = mat3(seen) * normal;
  gap = abs(value) < 1e38 ? 0.0 : 1.0;
  fraction = gap > 0 ? 0.0 : (value - scale.x) * scale.y;
  light = 0;
  if (kNumLamps > 1 && lighting == 1) light = received(seen_place, turned(seen_normal, sight_from(seen_place)));
})";

constexpr const char* kSurfaceFragment = R"(
in vec3 seen_place, seen_normal;
in float fraction, gap, light;
uniform sampler2D colours;
uniform vec4 paint;  // in place of the scale, where its alpha is 1
uniform vec3 no_value;
uniform float opacity;
out vec4 colour;
void main() {
  vec3 sight = sight_from(seen_place), normal = turned(seen_normal, sight);
  vec3 base = mix(texture(colours, vec2(clamp(fraction, 0.002, 0.998), 0.5)).rgb, no_value, gap);
  base = mix(base, paint.rgb, paint.a);
  if (lighting == 1) base = moist(base, normal, sight, kNumLamps > 1 ? light : received(seen_place, normal));
  if (lighting == 2) base = lit_thing(base, normal);
  colour = vec4(base, opacity);
})";

constexpr const char* kFlatVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 ink;
uniform mat4 clip;
uniform float nearer;  // pulled towards the viewer by this much of the depth
uniform float point_size;
out vec4 paint;
void main() {
  gl_Position = clip * vec4(place, 1);
  leave_out(place);
  gl_Position.z -= nearer * gl_Position.w;
  gl_PointSize = point_size;
  paint = ink;
})";

constexpr const char* kFlatFragment = R"(
in vec4 paint;
uniform bool is_round;
uniform float point_size;
out vec4 colour;
void main() {
  colour = paint;
  if (is_round) colour.a *= clamp(point_size * (0.5 - length(gl_PointCoord - 0.5)), 0, 1);
})";

unsigned compiled(unsigned kind, const std::string& text) {
  const unsigned shader = glCreateShader(kind);
  const char* start = text.c_str();
  glShaderSource(shader, 1, &start, nullptr);
  glCompileShader(shader);
  int is_good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
  if (is_good) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<int>(log.size()), nullptr, log.data());
  throw RendererUnavailable(fmt::format("the graphics driver refuses a program: {}", log.data()));
}

unsigned linked(const std::string& common, const std::string& vertex, const std::string& fragment) {
  const unsigned program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair{GL_VERTEX_SHADER, kClip + common + vertex}, {GL_FRAGMENT_SHADER, common + fragment}}) {
    const unsigned shader = compiled(kind, kVersion + text);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  int is_good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &is_good);
  if (!is_good) throw RendererUnavailable("the graphics driver cannot link a program");
  return program;
}

int place_of(unsigned program, const char* uniform) { return glGetUniformLocation(program, uniform); }

void set(unsigned program, const char* uniform, const Matrix4f& matrix) {
  glUniformMatrix4fv(place_of(program, uniform), 1, GL_FALSE, matrix.data());
}

void set(unsigned program, const char* uniform, const Vector4f& vector) {
  glUniform4fv(place_of(program, uniform), 1, vector.data());
}

void set(unsigned program, const char* uniform, float number) { glUniform1f(place_of(program, uniform), number); }

/// What is drawn from now on is left out above the cut and outside the room.
void set_clips(unsigned program, const std::optional<Plane>& cut, const Eigen::AlignedBox3f& room) {
  Vector4f plane(0, 0, 0, 1);
  if (cut) plane << cut->normal.cast<float>(), static_cast<float>(cut->offset);
  set(program, "cut", plane);
  constexpr float kFar = 1e30f;
  const Vector3f low = room.isEmpty() ? Vector3f(-kFar, -kFar, -kFar) : room.min(),
                 high = room.isEmpty() ? Vector3f(kFar, kFar, kFar) : room.max();
  glUniform3fv(place_of(program, "low"), 1, low.data());
  glUniform3fv(place_of(program, "high"), 1, high.data());
}

void declare(unsigned attribute, int count, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(attribute);
  glVertexAttribPointer(attribute, count, GL_FLOAT, GL_FALSE, static_cast<int>(stride),
                        reinterpret_cast<const void*>(offset));
}

template <class T>
void send(unsigned buffer, const std::vector<T>& content, unsigned target = GL_ARRAY_BUFFER) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(content.size() * sizeof(T)), content.data(), GL_STREAM_DRAW);
}

unsigned texture_of(unsigned kind) {
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(kind, texture);
  for (const unsigned filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTexParameteri(kind, filter, GL_LINEAR);
  for (const unsigned wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTexParameteri(kind, wrap, GL_CLAMP_TO_EDGE);
  return texture;
}

/// Lamps and what fraction of the light each of them gives: that of all together makes the brightest normal 1.
std::pair<std::vector<Matrix3f>, std::vector<float>> lamps_and_strengths(int count) {
  const auto from_viewer = [](const Direction& direction) {
    return direction.of(Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ());
  };
  const Vector3f zenith = from_viewer(kZenith), main = from_viewer(kMainLamp);
  const Vector3f first = zenith.unitOrthogonal(), second = zenith.cross(first);
  std::vector<Vector3f> towards;
  std::vector<float> strengths;
  if (count == 1) {
    towards = {main};
    strengths = {1 - kSkyFraction};
  } else {
    // equal fractions of the hemisphere: equal steps of height, the golden angle from one to the next
    const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
    for (int k = 0; k < count; ++k) {
      const float height = (static_cast<float>(k) + 0.5f) / static_cast<float>(count);
      const float radius = std::sqrt(1 - height * height), angle = golden * static_cast<float>(k);
      towards.push_back(height * zenith + radius * (std::cos(angle) * first + std::sin(angle) * second));
      const float from_main = std::acos(std::clamp(towards.back().dot(main), -1.0f, 1.0f)) / kMainWidth;
      strengths.push_back(kEvenStrength + kMainStrength * (1 - kEvenStrength) * std::exp(-from_main * from_main));
    }
    float brightest = 0;
    for (const Vector3f& normal : towards) {
      float sum = 0;
      for (int k = 0; k < count; ++k) sum += strengths[k] * std::max(0.0f, towards[k].dot(normal));
      brightest = std::max(brightest, sum);
    }
    for (float& strength : strengths) strength /= brightest;
  }

  std::vector<Matrix3f> lamps;
  for (const Vector3f& direction : towards) {
    const Vector3f right = direction.unitOrthogonal();
    lamps.emplace_back();
    lamps.back() << right.transpose(), direction.cross(right).transpose(), direction.transpose();
  }
  return {lamps, strengths};
}

/// Turns places so that the viewer looks along them, and the bodies around [0, 0, 0] reach to 1, free of the rim.
Matrix4f seen_by(const Camera& camera, const Geometry& geometry, int map_size) {
  Eigen::AlignedBox3f box;
  for (const Geometry::Vertices* vertices : {&geometry.surface, &geometry.cut_faces})
    for (const Geometry::Vertex& vertex : *vertices) box.extend(vertex.place);
  const Vector3f centre = box.isEmpty() ? Vector3f(0, 0, 0) : Vector3f(box.center());
  float radius = std::numeric_limits<float>::min();
  for (const Geometry::Vertices* vertices : {&geometry.surface, &geometry.cut_faces})
    for (const Geometry::Vertex& vertex : *vertices) radius = std::max(radius, (vertex.place - centre).norm());
  const float reach = radius / (1 - 2 * kRim / static_cast<float>(map_size));
  Matrix4f matrix = Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() << camera.right().transpose(), camera.up().transpose(), camera.towards().transpose();
  matrix.topLeftCorner<3, 3>() /= reach;
  matrix.topRightCorner<3, 1>() = -matrix.topLeftCorner<3, 3>() * centre;
  return matrix;
}

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
  return {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, -1), corner(1, 1), corner(-1, 1)};
}

}  // namespace

Painter::Painter(const Light& light) : light_(light) {
  const auto [lamps, strengths] = lamps_and_strengths(light.num_lamps);
  lamps_ = lamps;
  const bool is_single = light.num_lamps == 1;
  const float texel = 1 / static_cast<float>(light.map_size), soft = is_single ? kSoft : 0;
  // lifted by what softens its shadow, a plane that stands aslant does not shade itself either
  const std::string constants = fmt::format(
      "const int kNumLamps = {}, kNumTaps = {};\nconst float kLift = {:.9f}, kSlack = {:.9f}, kSoft = {:.9f};\n",
      light.num_lamps, is_single ? 12 : 1, 2 * (kLift + soft) * texel, kSlack * texel, soft * texel);
  surface_ = linked(constants + light_shader() + kReceived, kSurfaceVertex, kSurfaceFragment);
  flat_ = linked("", kFlatVertex, kFlatFragment);
  glUseProgram(surface_);
  glUniformMatrix3fv(place_of(surface_, "lamps"), light.num_lamps, GL_FALSE, lamps_.front().data());
  glUniform1fv(place_of(surface_, "strength"), light.num_lamps, strengths.data());
  glUniform3f(place_of(surface_, "no_value"), kNoValue.red, kNoValue.green, kNoValue.blue);
  glUniform1i(place_of(surface_, "shadow"), 1);

  glGenBuffers(1, &numbers_);
  for (Batch* batch : {&vertices_, &places_, &page_}) {
    glGenVertexArrays(1, &batch->array);
    glGenBuffers(1, &batch->buffer);
    glBindVertexArray(batch->array);
    glBindBuffer(GL_ARRAY_BUFFER, batch->buffer);
    if (batch == &vertices_) {
      declare(0, 3, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, place));
      declare(1, 3, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, normal));
      declare(2, 1, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, value));
    }
    if (batch == &places_) declare(0, 3, sizeof(Vector3f), 0);
    if (batch == &page_) {
      declare(0, 3, sizeof(PageVertex), offsetof(PageVertex, place));
      declare(1, 4, sizeof(PageVertex), offsetof(PageVertex, ink));
    }
  }
  glBindVertexArray(0);

  colours_ = texture_of(GL_TEXTURE_2D);
  send_colours({});

  shadow_ = texture_of(GL_TEXTURE_2D_ARRAY);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT24, light.map_size, light.map_size, light.num_lamps, 0,
               GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &shadow_frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Painter::~Painter() {
  for (const Batch& batch : {vertices_, places_, page_}) {
    glDeleteVertexArrays(1, &batch.array);
    glDeleteBuffers(1, &batch.buffer);
  }
  glDeleteBuffers(1, &numbers_);
  for (const unsigned texture : {colours_, shadow_}) glDeleteTextures(1, &texture);
  glDeleteFramebuffers(1, &shadow_frame_);
  for (const unsigned program : {surface_, flat_}) glDeleteProgram(program);
}

void Painter::send_colours(const std::vector<Colour>& palette) {
  palette_ = palette;
  std::vector<Colour> colours = palette;
  for (int k = 0; palette.empty() && k < kNumColours; ++k) colours.push_back(colour_of((k + 0.5) / kNumColours));
  glBindTexture(GL_TEXTURE_2D, colours_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, static_cast<int>(colours.size()), 1, 0, GL_RGB, GL_FLOAT, colours.data());
}

void Painter::draw_shadows(const Geometry& geometry, const Matrix4f& seen) {
  int frame = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glViewport(0, 0, light_.map_size, light_.map_size);
  glDepthFunc(GL_LESS);
  glUseProgram(flat_);
  set(flat_, "nearer", 0);
  const auto cast = [&](const Geometry::Vertices& vertices, bool is_first) {
    const int count = bind(vertices);
    for (int k = 0; k < light_.num_lamps; ++k) {
      if (k > 0) glFinish();  // Mesa's rasteriser lets up to 64 maps wait, each with all of its triangles
      glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, shadow_, 0, k);
      if (is_first) glClear(GL_DEPTH_BUFFER_BIT);
      Matrix4f turn = Matrix4f::Identity();
      turn.topLeftCorner<3, 3>() = Vector3f(1, 1, -1).asDiagonal() * lamps_[static_cast<std::size_t>(k)];
      set(flat_, "clip", Matrix4f(turn * seen));
      glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, nullptr);
    }
  };
  set_clips(flat_, geometry.cut, {});
  cast(geometry.surface, true);
  if (light_.tools_cast_shadows && !geometry.tools.empty()) cast(geometry.tools, false);
  set_clips(flat_, {}, {});
  if (!geometry.cut_faces.empty() && !geometry.is_hollow) cast(geometry.cut_faces, false);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<unsigned>(frame));
}

void Painter::draw(const View& view, const Viewport& viewport) {
  const auto& [geometry, camera, width, height, min, max, strip, palette] = view;
  const Matrix4f clip = camera.clip(width, height).cast<float>(), seen = seen_by(camera, geometry, light_.map_size);
  const float density = viewport.density, length = geometry.edge_length * camera.scale();
  const std::optional<EdgeInk> edges = edge_ink(length, geometry.is_cage);
  for (int k = 0; k < kNumClips; ++k) glEnable(GL_CLIP_DISTANCE0 + k);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_DITHER);
  draw_shadows(geometry, seen);

  glViewport(viewport.left, viewport.bottom, viewport.width, viewport.height);
  glClearColor(kPaper.red, kPaper.green, kPaper.blue, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1 + density, kPushUnits);

  // behind everything else, however near it is
  set(flat_, "clip", clip);
  draw_places(geometry.ghost, GL_TRIANGLES, kGhost);
  draw_lines(geometry.ghost_outline, kOriginal, 1, kOutlineWidth * density);
  if (!geometry.ghost.empty()) {
    set_clips(flat_, geometry.cut, {});
    draw_lines(geometry.halo, kPaper, 1, kHaloWidth * density);
  }
  glClear(GL_DEPTH_BUFFER_BIT);

  glUseProgram(surface_);
  set(surface_, "clip", clip);
  set(surface_, "seen", seen);
  set(surface_, "eye", Vector4f(seen * camera.eye().cast<float>()));
  set_clips(surface_, geometry.cut, {});
  glUniform2f(place_of(surface_, "scale"), static_cast<float>(min),
              max > min ? static_cast<float>(1 / (max - min)) : 0);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, shadow_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, colours_);
  if (palette != palette_) send_colours(palette);
  set(surface_, "opacity", 1);
  const auto draw_lit = [&](const Geometry::Vertices& vertices, Lit how, const Colour* paint,
                            unsigned mode = GL_TRIANGLES) {
    glUniform1i(place_of(surface_, "lighting"), how);
    set(surface_, "paint", paint ? Vector4f(paint->red, paint->green, paint->blue, 1) : Vector4f(0, 0, 0, 0));
    if (!vertices.empty()) glDrawElements(mode, bind(vertices), GL_UNSIGNED_INT, nullptr);
  };
  const auto draw_arrows = [&](const Geometry::Vertices& arrows, const Colour& colour) {
    glDepthMask(GL_FALSE);
    set(surface_, "grow", kRimOfArrows / camera.scale());
    draw_lit(arrows, kUnlit, &kPaper);
    set(surface_, "grow", 0);
    glDepthMask(GL_TRUE);
    draw_lit(arrows, kThing, &colour);
  };
  // Draws what lies in the plane of the cut, as far as that is within closed surfaces: there one sees more of their
  // backs than of their fronts.
  const auto draw_within = [&](const Geometry::Vertices& closed, const Eigen::AlignedBox3f& room,
                               const auto& draw_cap) {
    glEnable(GL_STENCIL_TEST);
    glClear(GL_STENCIL_BUFFER_BIT);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    glStencilFunc(GL_ALWAYS, 0, ~0u);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    set_clips(surface_, geometry.cut, {});
    draw_lit(closed, kUnlit, nullptr);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glStencilFunc(GL_NOTEQUAL, 0, ~0u);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    set_clips(surface_, {}, room);
    draw_cap();
    glDisable(GL_STENCIL_TEST);
  };
  // where no lines lie on it, stepping back would only show what faces away along its silhouette
  const bool has_lines = !geometry.cut_outline.empty() || (edges && !geometry.edges.empty() && !geometry.is_cage);
  if (!has_lines) glDisable(GL_POLYGON_OFFSET_FILL);
  draw_lit(geometry.surface, kTissue, nullptr);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glLineWidth(kWireWidth * density);
  draw_lit(geometry.wires, kUnlit, nullptr, GL_LINES);
  draw_arrows(geometry.load_arrows, kLoad);
  glEnable(GL_DEPTH_CLAMP);  // instruments may be far from the body, to which the depths are fitted
  set_clips(surface_, geometry.cut, geometry.room);
  draw_lit(geometry.tools, kThing, &kMetal);
  set_clips(surface_, {}, {});
  const auto draw_cut_faces = [&] { draw_lit(geometry.cut_faces, kUnlit, nullptr); };  // values shall be readable there
  if (!geometry.is_hollow)
    draw_cut_faces();
  else if (geometry.cut && geometry.is_closed)
    draw_within(geometry.surface, {}, draw_cut_faces);
  glDisable(GL_POLYGON_OFFSET_FILL);
  if (geometry.cut && geometry.are_tools_closed && !geometry.tools.empty())
    draw_within(geometry.tools, geometry.room, [&] { draw_lit(plane_around(geometry), kUnlit, &kMetal); });
  set_clips(surface_, {}, {});
  glDepthRange(0, 0.01);
  draw_arrows(geometry.tool_arrows, kSteel);
  glDepthRange(0, 1);

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
  const float size = 2 * std::min(kDotRadius, kDotOfEdge * length) * density + 1;  // with a soft rim
  set(flat_, "point_size", size);
  glEnable(GL_PROGRAM_POINT_SIZE);
  draw_places(geometry.fixed, GL_POINTS, kInk);
  glDepthMask(GL_TRUE);
  if (!geometry.veil.empty()) {  // its foremost surface
    glUseProgram(surface_);
    set_clips(surface_, geometry.cut, {});
    set(surface_, "opacity", kVeilOpacity);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_lit(geometry.veil, kTissue, nullptr);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    draw_lit(geometry.veil, kTissue, &kVeil);
  }
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  for (int k = 0; k < kNumClips; ++k) glDisable(GL_CLIP_DISTANCE0 + k);
  glBindVertexArray(0);
  if (!(strip > 0)) return;
  glEnable(GL_SCISSOR_TEST);
  glScissor(viewport.left, viewport.bottom, viewport.width, static_cast<int>(strip * density));
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
}

void Painter::draw_page(const Drawing& page, int density) {
  std::vector<PageVertex> vertices;
  const auto add = [&](const Drawing::Vertex& vertex, float opacity) {
    const auto& [red, green, blue] = vertex.colour;
    vertices.push_back({{vertex.x, vertex.y, vertex.depth}, {red, green, blue, opacity}});
  };
  for (const Drawing::Triangle& triangle : page.triangles)
    for (const Drawing::Vertex& corner : triangle.corner) add(corner, 1);
  const auto num_corners = static_cast<int>(vertices.size());
  for (const Drawing::Line& line : page.lines)
    for (const Drawing::Vertex& end : {line.from, line.to}) add(end, line.opacity);
  send(page_.buffer, vertices);
  glBindVertexArray(page_.array);

  glUseProgram(flat_);
  Matrix4f clip = Matrix4f::Identity();  // y downwards; depth 0 near, 1 far
  clip.diagonal() << 2 * page.unit / static_cast<float>(page.width), -2 * page.unit / static_cast<float>(page.height),
      2, 1;
  clip.col(3) << -1, 1, -1, 1;
  set(flat_, "clip", clip);
  set(flat_, "nearer", 0);
  set_clips(flat_, {}, {});  // a page without a view is drawn before any view set them
  glUniform1i(place_of(flat_, "is_round"), 0);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glClearColor(kPaper.red, kPaper.green, kPaper.blue, 1);
  glClear(page.view ? GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(0, kPushUnits);
  glDrawArrays(GL_TRIANGLES, 0, num_corners);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (std::size_t k = 0; k < page.lines.size(); ++k) {
    glLineWidth(page.lines[k].width * page.unit * static_cast<float>(density));
    glDepthMask(page.lines[k].opacity < 1 ? GL_FALSE : GL_TRUE);
    glDrawArrays(GL_LINES, num_corners + 2 * static_cast<int>(k), 2);
  }
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
}

int Painter::bind(const Geometry::Vertices& vertices) {
  static_assert(sizeof(Geometry::Vertex) == 7 * sizeof(float), "bytes between its members would differ");
  Geometry::Vertices distinct;  // light is found once for the corners that faces share
  std::vector<unsigned> numbers;
  std::unordered_map<std::string_view, unsigned> number_of;
  for (const Geometry::Vertex& vertex : vertices) {
    const std::string_view bytes(reinterpret_cast<const char*>(&vertex), sizeof(vertex));
    const auto [entry, is_new] = number_of.emplace(bytes, static_cast<unsigned>(distinct.size()));
    if (is_new) distinct.push_back(vertex);
    numbers.push_back(entry->second);
  }
  glBindVertexArray(vertices_.array);
  send(vertices_.buffer, distinct);
  send(numbers_, numbers, GL_ELEMENT_ARRAY_BUFFER);
  return static_cast<int>(numbers.size());
}

void Painter::draw_lines(const Geometry::Places& ends, const Colour& colour, float opacity, float width) {
  // drivers draw no line thinner than a pixel
  glLineWidth(std::max(width, 1.0f));
  draw_places(ends, GL_LINES, colour, opacity * std::min(width, 1.0f));
}

void Painter::draw_places(const Geometry::Places& places, unsigned mode, const Colour& colour, float opacity) {
  if (places.empty()) return;
  send(places_.buffer, places);
  glBindVertexArray(places_.array);
  glVertexAttrib4f(1, colour.red, colour.green, colour.blue, opacity);
  glUniform1i(place_of(flat_, "is_round"), mode == GL_POINTS);
  glDrawArrays(mode, 0, static_cast<int>(places.size()));
}

Image Painter::read(int width, int height) {
  Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const std::size_t row = static_cast<std::size_t>(width) * 3;
  for (int y = 0; y < height; ++y)  // OpenGL counts rows from below
    glReadPixels(0, height - 1 - y, width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                 &image.pixels[static_cast<std::size_t>(y) * row]);
  return image;
}

}  // namespace hexaplast::output
