// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/painter.hpp"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "picture/ink.hpp"
#include "record/files.hpp"

namespace hexaplast::view {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr int kNumColours = 256;
constexpr int kShadowSize = 1024;  // [texels]

Vector4f rgba(const output::Colour& colour, float opacity = 1) {
  return {colour.red, colour.green, colour.blue, opacity};
}

// How a surface is lit.
enum Light { kUnlit, kTissue, kThing };

constexpr const char* kSurfaceVertex = R"(#version 330 core
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
uniform mat4 clip, view, light;
uniform vec2 scale;  // min, 1 / (max - min)
uniform vec4 cut;    // what lies above is left out: normal, offset
out vec3 eye_place, eye_normal, in_light;
out float fraction;
void main() {
  gl_Position = clip * vec4(place, 1);
  gl_ClipDistance[0] = cut.w - dot(cut.xyz, place);
  eye_place = (view * vec4(place, 1)).xyz;
  eye_normal = mat3(view) * normal;
  in_light = (light * vec4(place, 1)).xyz * 0.5 + 0.5;
  fraction = (value - scale.x) * scale.y;
})";

// The light of the pictures (picture/ink.hpp), with one lamp that casts soft shadows.
constexpr const char* kSurfaceFragment = R"(
in vec3 eye_place, eye_normal, in_light;
in float fraction;
uniform sampler2D colours;
uniform sampler2DShadow shadow;
uniform vec3 lamp;   // towards it, seen from the eye
uniform vec4 paint;  // in place of the scale, where its alpha is 1
uniform int lighting;
out vec4 colour;

const vec2 kDisc[12] = vec2[](vec2(-0.33, -0.40), vec2(-0.84, -0.07), vec2(-0.70, 0.46), vec2(-0.20, 0.62),
                              vec2(0.96, -0.19), vec2(0.47, -0.48), vec2(0.52, 0.77), vec2(0.19, -0.89),
                              vec2(0.51, 0.06), vec2(0.90, 0.41), vec2(-0.32, -0.93), vec2(-0.79, -0.60));

float arriving(vec3 normal) {
  float bias = 0.003 + 0.009 * (1 - clamp(dot(normal, lamp), 0, 1)), lit = 0;
  for (int k = 0; k < 12; ++k)
    lit += texture(shadow, vec3(in_light.xy + 0.006 * kDisc[k], in_light.z - bias)) / 12;
  return lit;
}

void main() {
  vec3 towards = normalize(-eye_place), normal = normalize(eye_normal);
  if (dot(normal, towards) < 0) normal = -normal;
  vec3 base = mix(texture(colours, vec2(clamp(fraction, 0.002, 0.998), 0.5)).rgb, paint.rgb, paint.a);
  if (lighting == 1) base = lit_tissue(base, normal, towards, arriving(normal));
  if (lighting == 2) base = lit_thing(base, normal);
  colour = vec4(base, 1);
})";

constexpr const char* kFlatVertex = R"(#version 330 core
layout(location = 0) in vec3 place;
uniform mat4 clip;
uniform float nearer;  // pulled towards the viewer by this much of the depth
uniform float point_size;
uniform vec4 cut;
void main() {
  gl_Position = clip * vec4(place, 1);
  gl_ClipDistance[0] = cut.w - dot(cut.xyz, place);
  gl_Position.z -= nearer * gl_Position.w;
  gl_PointSize = point_size;
})";

constexpr const char* kFlatFragment = R"(#version 330 core
uniform vec4 ink;
uniform bool is_round;
uniform float point_size;
out vec4 colour;
void main() {
  colour = ink;
  if (is_round) colour.a *= clamp(point_size * (0.5 - length(gl_PointCoord - 0.5)), 0, 1);
})";

unsigned compiled(unsigned kind, const char* text) {
  const unsigned shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  int is_good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
  if (is_good) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<int>(log.size()), nullptr, log.data());
  throw output::OutputError(fmt::format("the graphics driver refuses a program: {}", log.data()));
}

unsigned linked(const char* vertex, const std::string& fragment) {
  const unsigned program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair{GL_VERTEX_SHADER, vertex}, std::pair{GL_FRAGMENT_SHADER, fragment.c_str()}}) {
    const unsigned shader = compiled(kind, text);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  int is_good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &is_good);
  if (!is_good) throw output::OutputError("the graphics driver cannot link a program");
  return program;
}

int place_of(unsigned program, const char* uniform) { return glGetUniformLocation(program, uniform); }

void set(unsigned program, const char* uniform, const Matrix4f& matrix) {
  glUniformMatrix4fv(place_of(program, uniform), 1, GL_FALSE, matrix.data());
}

void declare(unsigned attribute, int count, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(attribute);
  glVertexAttribPointer(attribute, count, GL_FLOAT, GL_FALSE, static_cast<int>(stride),
                        reinterpret_cast<const void*>(offset));
}

template <class T>
void send(unsigned buffer, const std::vector<T>& content) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(content.size() * sizeof(T)), content.data(), GL_STREAM_DRAW);
}

/// A lamp far away in direction `towards`, and what of a box it sees: orthographic, [-1, 1] in all directions.
Matrix4f lamp_view(const Vector3f& towards, const Eigen::AlignedBox3f& box) {
  const Vector3f right = towards.unitOrthogonal(), up = towards.cross(right);
  const float reach = 0.52f * box.sizes().norm();
  Matrix4f matrix = Matrix4f::Identity();
  matrix.row(0).head<3>() = right / reach;
  matrix.row(1).head<3>() = up / reach;
  matrix.row(2).head<3>() = -towards / reach;
  matrix.topRightCorner<3, 1>() = -matrix.topLeftCorner<3, 3>() * box.center();
  return matrix;
}

}  // namespace

Painter::Painter()
    : surface_(linked(kSurfaceVertex, "#version 330 core\n" + output::light_shader() + kSurfaceFragment)),
      flat_(linked(kFlatVertex, kFlatFragment)) {
  for (Batch* batch : {&triangles_, &places_}) {
    glGenVertexArrays(1, &batch->array);
    glGenBuffers(1, &batch->buffer);
    glBindVertexArray(batch->array);
    glBindBuffer(GL_ARRAY_BUFFER, batch->buffer);
    if (batch == &triangles_) {
      declare(0, 3, sizeof(Figure::Vertex), offsetof(Figure::Vertex, place));
      declare(1, 3, sizeof(Figure::Vertex), offsetof(Figure::Vertex, normal));
      declare(2, 1, sizeof(Figure::Vertex), offsetof(Figure::Vertex, value));
    }
    if (batch == &places_) declare(0, 3, sizeof(Vector3f), 0);
  }

  std::array<float, 3 * kNumColours> colours;
  for (int k = 0; k < kNumColours; ++k) {
    const output::Colour colour = output::colour_of((k + 0.5) / kNumColours);
    colours[3 * k] = colour.red, colours[3 * k + 1] = colour.green, colours[3 * k + 2] = colour.blue;
  }
  glGenTextures(1, &colours_);
  glBindTexture(GL_TEXTURE_2D, colours_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, kNumColours, 1, 0, GL_RGB, GL_FLOAT, colours.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);

  glGenTextures(1, &shadow_);
  glBindTexture(GL_TEXTURE_2D, shadow_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kShadowSize, kShadowSize, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
               nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &shadow_frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Painter::~Painter() {
  for (const Batch& batch : {triangles_, places_}) {
    glDeleteVertexArrays(1, &batch.array);
    glDeleteBuffers(1, &batch.buffer);
  }
  glDeleteTextures(1, &colours_);
  glDeleteTextures(1, &shadow_);
  glDeleteFramebuffers(1, &shadow_frame_);
  for (const unsigned program : {surface_, flat_}) glDeleteProgram(program);
}

void Painter::draw(const Figure& figure, const Camera& camera, const Viewport& viewport, double min, double max) {
  const Matrix4f view = camera.view().cast<float>(), clip = camera.clip(figure.box()).cast<float>();
  const Vector3f lamp = output::kMainLamp.of(Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ());  // from the eye
  const Vec3 towards = (camera.eye() - camera.target()).normalized();
  const Matrix4f light = lamp_view(view.topLeftCorner<3, 3>().transpose() * lamp, figure.box().cast<float>());
  const Vector4f whole(0, 0, 0, 1);
  Vector4f cut = whole;
  if (figure.cut()) cut << figure.cut()->normal.cast<float>(), static_cast<float>(figure.cut()->offset);
  const auto set_cut = [](unsigned program, const Vector4f& plane) {
    glUniform4fv(place_of(program, "cut"), 1, plane.data());
  };
  glEnable(GL_CLIP_DISTANCE0);

  // all that casts shadows
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glViewport(0, 0, kShadowSize, kShadowSize);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(flat_);
  set(flat_, "clip", light);
  glUniform1f(place_of(flat_, "nearer"), 0);
  set_cut(flat_, cut);
  draw_triangles(figure.triangles());
  draw_triangles(figure.tool_triangles());
  set_cut(flat_, whole);
  draw_triangles(figure.cut_triangles());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);

  glViewport(viewport.left, viewport.bottom, viewport.width, viewport.height);
  glClearColor(output::kPaper.red, output::kPaper.green, output::kPaper.blue, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);

  // behind everything else, however near it is
  glUseProgram(flat_);
  set(flat_, "clip", clip);
  glUniform1f(place_of(flat_, "nearer"), 0);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_POLYGON_OFFSET_FILL);  // so that lines lie in front over their full width
  glPolygonOffset(2, 8);
  draw_places(figure.ghost_triangles(), GL_TRIANGLES, rgba(output::kGhost));
  draw_lines(figure.ghost_outline(towards), rgba(output::kOriginal), output::kOutlineWidth * viewport.density);
  glClear(GL_DEPTH_BUFFER_BIT);

  glUseProgram(surface_);
  set(surface_, "clip", clip);
  set(surface_, "view", view);
  set(surface_, "light", light);
  set_cut(surface_, cut);
  glUniform3fv(place_of(surface_, "lamp"), 1, lamp.data());
  glUniform2f(place_of(surface_, "scale"), static_cast<float>(min),
              max > min ? static_cast<float>(1 / (max - min)) : 0);
  glUniform1i(place_of(surface_, "colours"), 0);
  glUniform1i(place_of(surface_, "shadow"), 1);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, shadow_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, colours_);
  const auto draw_lit = [&](const std::vector<Figure::Vertex>& corners, Light how, const Vector4f& paint) {
    glUniform1i(place_of(surface_, "lighting"), how);
    glUniform4fv(place_of(surface_, "paint"), 1, paint.data());
    draw_triangles(corners);
  };
  const Vector4f of_the_scale = Vector4f::Zero();
  draw_lit(figure.triangles(), kTissue, of_the_scale);
  draw_lit(figure.load_arrows(), kThing, rgba(output::kLoad));
  glEnable(GL_DEPTH_CLAMP);  // instruments may be far from the body, to which the depths are fitted
  draw_lit(figure.tool_triangles(), kThing, rgba(output::kMetal));
  set_cut(surface_, whole);
  draw_lit(figure.cut_triangles(), kUnlit, of_the_scale);  // who cuts wants to read values there
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDepthRange(0, 0.01);
  draw_lit(figure.tool_arrows(), kThing, rgba(output::kSteel));
  glDepthRange(0, 1);

  const float density = viewport.density;
  glUseProgram(flat_);
  glUniform1f(place_of(flat_, "nearer"), 2e-4f);
  glDepthMask(GL_FALSE);
  set_cut(flat_, cut);
  draw_lines(figure.tool_outline(towards), rgba(output::kSteel), output::kOutlineWidth * density);
  draw_lines(figure.taut_springs(), rgba(output::kSpring), output::kSpringWidth * density);
  draw_lines(figure.slack_springs(), rgba(output::kSpring, output::kSlackOpacity), output::kSlackWidth * density);
  glDisable(GL_DEPTH_CLAMP);
  const auto length = static_cast<float>(figure.edge_length() / camera.metres_per_pixel(figure.box().center()));
  if (const auto edges = output::edge_ink(length, figure.shows_embedded_surfaces())) {
    // lines are not thinner than a pixel
    const float width = edges->width * density, opacity = edges->opacity * std::min(1.0f, width);
    draw_lines(figure.edges(), rgba(edges->colour, opacity), width);
    set_cut(flat_, whole);
    draw_lines(figure.cut_edges(), rgba(edges->colour, opacity), width);
  }
  set_cut(flat_, whole);
  draw_lines(figure.cut_outline(), rgba(output::kEdge), output::kCutWidth * density);
  glUniform1f(place_of(flat_, "nearer"), 2e-3f);
  const float radius = std::min(output::kDotRadius, output::kDotOfEdge * length);
  draw_places(figure.fixed_places(), GL_POINTS, rgba(output::kInk), 2 * radius * density + 1);  // with a soft rim
  glDepthMask(GL_TRUE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CLIP_DISTANCE0);
  glBindVertexArray(0);
}

void Painter::draw_triangles(const std::vector<Figure::Vertex>& corners) {
  send(triangles_.buffer, corners);
  glBindVertexArray(triangles_.array);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<int>(corners.size()));
}

void Painter::draw_lines(const std::vector<Vector3f>& ends, const Vector4f& colour, float width) {
  glLineWidth(std::max(width, 1.0f));
  draw_places(ends, GL_LINES, colour);
}

void Painter::draw_places(const std::vector<Vector3f>& places, unsigned mode, const Vector4f& colour,
                          float point_size) {
  send(places_.buffer, places);
  glUniform4fv(place_of(flat_, "ink"), 1, colour.data());
  glUniform1i(place_of(flat_, "is_round"), mode == GL_POINTS);
  glUniform1f(place_of(flat_, "point_size"), point_size);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(places_.array);
  glDrawArrays(mode, 0, static_cast<int>(places.size()));
}

output::Image Painter::picture(int width, int height) {
  output::Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const std::size_t row = static_cast<std::size_t>(width) * 3;
  for (int y = 0; y < height; ++y)  // OpenGL counts rows from below
    glReadPixels(0, height - 1 - y, width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                 &image.pixels[static_cast<std::size_t>(y) * row]);
  return image;
}

}  // namespace hexaplast::view
