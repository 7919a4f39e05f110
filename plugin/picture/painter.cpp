// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/painter.hpp"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "picture/gl_program.hpp"
#include "picture/ink.hpp"
#include "picture/lamps.hpp"
#include "picture/shaders.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr int kNumColours = 1024;

constexpr float kSoft = 6;  // [texels] radius of the disc that softens the shadows of the main lamp

Eigen::Matrix3f lamp() { return turned_to(kMainLamp.of(Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ())); }

struct PageVertex {
  Vector3f place;
  Vector4f ink;
};

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

unsigned texture_of(int filter) {
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  for (const unsigned size : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, size, filter);
  for (const unsigned wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

Painter::Painter(Light light) : light_(light) {
  constexpr float kTexel = 1.0f / kMapSize;
  // lifted by what softens its shadow, a plane that stands aslant does not shade itself either
  const std::string constants = fmt::format(
      "const bool kIsLit = {};\nconst float kLift = {:.9f}, kSlack = {:.9f}, kSoft = {:.9f}, kStrength = {:.9f};\n",
      light == Light::kVertices, 2 * (kLift + kSoft) * kTexel, kSlack * kTexel, kSoft * kTexel, 1 - kSkyFraction);
  surface_ = linked(constants + light_shader() + kShading, kSurfaceVertex, kSurfaceFragment);
  flat_ = linked("", kFlatVertex, kFlatFragment);
  glUseProgram(surface_);
  glUniformMatrix3fv(place_of(surface_, "lamp"), 1, GL_FALSE, lamp().data());
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
      declare(3, 1, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, light));
    }
    if (batch == &places_) declare(0, 3, sizeof(Vector3f), 0);
    if (batch == &page_) {
      declare(0, 3, sizeof(PageVertex), offsetof(PageVertex, place));
      declare(1, 4, sizeof(PageVertex), offsetof(PageVertex, ink));
    }
  }
  glBindVertexArray(0);

  colours_ = texture_of(GL_NEAREST);
  send_colours({});

  if (light == Light::kVertices) return;
  shadow_ = texture_of(GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kMapSize, kMapSize, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &shadow_frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_, 0);
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

void Painter::draw_shadow(const Geometry& geometry, const Matrix4f& seen) {
  int frame = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glViewport(0, 0, kMapSize, kMapSize);
  glDepthFunc(GL_LESS);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(flat_);
  set(flat_, "nearer", 0);
  Matrix4f turn = Matrix4f::Identity();
  turn.topLeftCorner<3, 3>() = Vector3f(1, 1, -1).asDiagonal() * lamp();
  set(flat_, "clip", Matrix4f(turn * seen));
  set_clips(flat_, geometry.cut, {});
  for (const Geometry::Vertices* vertices : {&geometry.surface, &geometry.walls, &geometry.tools})
    draw_corners(*vertices);
  set_clips(flat_, {}, {});
  if (!geometry.is_hollow) draw_corners(geometry.cut_faces);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<unsigned>(frame));
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
  for (auto first = page.lines.begin(), end = first; first != page.lines.end(); first = end) {
    end = std::find_if(first, page.lines.end(), [&](const Drawing::Line& line) {
      return line.width != first->width || line.opacity != first->opacity;
    });
    glLineWidth(first->width * page.unit * static_cast<float>(density));
    glDepthMask(first->opacity < 1 ? GL_FALSE : GL_TRUE);
    glDrawArrays(GL_LINES, num_corners + 2 * static_cast<int>(first - page.lines.begin()),
                 2 * static_cast<int>(end - first));
  }
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
}

void Painter::draw_corners(const Geometry::Vertices& vertices) {
  if (vertices.empty()) return;
  glBindVertexArray(vertices_.array);
  send(vertices_.buffer, vertices.distinct);
  send(numbers_, vertices.corners, GL_ELEMENT_ARRAY_BUFFER);
  glDrawElements(GL_TRIANGLES, static_cast<int>(vertices.size()), GL_UNSIGNED_INT, nullptr);
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
