// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/lamps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "picture/ink.hpp"

namespace hexaplast::output {

using Eigen::Matrix3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

namespace {

constexpr int kNumLamps = 72;
constexpr float kEvenStrength = 0.45f;  // of those far from the main lamp; the rest gathers around it
constexpr float kMainWidth = 0.45f;     // [rad] of what gathers there
constexpr float kMainStrength = 6;      // in its middle
constexpr float kRim = 3;               // [texels] free around the bodies

using Rows = Eigen::MatrixX3f;

/// What a lamp sees: how far towards it things reach, over a square of texels. All lengths are texels.
class HeightMap {
 public:
  static constexpr int kSize = 256;

  void clear() { heights_.assign(static_cast<std::size_t>(kSize) * kSize, -std::numeric_limits<float>::infinity()); }

  /// A triangle, as far as it lies below a plane: normal and offset.
  void draw(Vector3f low, Vector3f middle, Vector3f high, const Vector4f& cut) {
    if (middle.y() < low.y()) low.swap(middle);
    if (high.y() < middle.y()) middle.swap(high);
    if (middle.y() < low.y()) low.swap(middle);
    const Vector3f first = middle - low, last = high - middle, all = high - low;
    const float area = first.x() * all.y() - all.x() * first.y();
    if (area == 0) return;
    // texels whose middles lie within, as two triangles share none along their common edge
    const float right = (first.z() * all.y() - all.z() * first.y()) / area,
                up = (all.z() * first.x() - first.z() * all.x()) / area;
    const float slope = all.x() / all.y(), first_slope = first.x() / first.y(), last_slope = last.x() / last.y();
    for (int y = texel(low.y()); y < texel(high.y()); ++y) {
      const float level = static_cast<float>(y) + 0.5f;
      const float along = low.x() + (level - low.y()) * slope;
      const float bent = level < middle.y() ? low.x() + (level - low.y()) * first_slope
                                            : middle.x() + (level - middle.y()) * last_slope;
      float* row = &heights_[static_cast<std::size_t>(y * kSize)];
      const float at_left = low.z() + up * (level - low.y()) + right * (0.5f - low.x());
      for (int x = texel(std::min(along, bent)), end = texel(std::max(along, bent)); x < end; ++x) {
        const float height = at_left + right * static_cast<float>(x);
        if (cut.x() * static_cast<float>(x) + cut.y() * level + cut.z() * height <= cut.w())
          row[x] = std::max(row[x], height);
      }
    }
  }

  /// Fraction of the light that arrives at a place, blended between the middles of texels.
  float arriving(float x, float y, float height) const {
    if (std::min(x, y) < 1 || std::max(x, y) > kSize - 1) return 1;  // what keeps light off does not reach the rim
    const int left = static_cast<int>(x - 0.5f), low = static_cast<int>(y - 0.5f);
    const float right = x - 0.5f - static_cast<float>(left), up = y - 0.5f - static_cast<float>(low);
    const float* at = &heights_[static_cast<std::size_t>(low * kSize + left)];
    const auto is_free = [&](int offset) { return at[offset] <= height + kSlack ? 1.0f : 0.0f; };
    return (1 - up) * ((1 - right) * is_free(0) + right * is_free(1)) +
           up * ((1 - right) * is_free(kSize) + right * is_free(kSize + 1));
  }

 private:
  /// The first one whose middle lies behind a place.
  static int texel(float place) { return std::clamp(static_cast<int>(place + 0.5f), 0, kSize); }

  std::vector<float> heights_;
};

/// Directions of the lamps, seen from the viewer, as long as they are strong: all together make the brightest normal 1.
std::vector<Vector3f> lamps() {
  const auto from_viewer = [](const Direction& direction) {
    return direction.of(Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ());
  };
  const Vector3f zenith = from_viewer(kZenith), main = from_viewer(kMainLamp);
  const Vector3f first = zenith.unitOrthogonal(), second = zenith.cross(first);
  // equal fractions of the hemisphere: equal steps of height, the golden angle from one to the next
  const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
  std::vector<Vector3f> towards;
  for (int k = 0; k < kNumLamps; ++k) {
    const float height = (static_cast<float>(k) + 0.5f) / kNumLamps;
    const float radius = std::sqrt(1 - height * height), angle = golden * static_cast<float>(k);
    const Vector3f lamp = height * zenith + radius * (std::cos(angle) * first + std::sin(angle) * second);
    const float from_main = std::acos(std::clamp(lamp.dot(main), -1.0f, 1.0f)) / kMainWidth;
    towards.push_back(lamp * (kEvenStrength + kMainStrength * (1 - kEvenStrength) * std::exp(-from_main * from_main)));
  }
  float brightest = 0;
  for (const Vector3f& normal : towards) {
    float sum = 0;
    for (const Vector3f& lamp : towards) sum += std::max(0.0f, lamp.dot(normal.normalized()));
    brightest = std::max(brightest, sum);
  }
  for (Vector3f& lamp : towards) lamp /= brightest;
  return towards;
}

/// Vertices turned to the viewer.
struct Seen {
  Seen(const Geometry::Vertices& vertices, const Matrix4f& seen, const Vector4f& eye)
      : places(std::ssize(vertices.distinct), 3),
        normals(places.rows(), 3),
        light(Eigen::VectorXf::Zero(places.rows())) {
    Eigen::Index n = 0;
    for (const Geometry::Vertex& vertex : vertices) {
      const Vector3f place = (seen * vertex.place.homogeneous()).head<3>(),
                     normal = (seen.topLeftCorner<3, 3>() * vertex.normal).normalized();
      places.row(n) = HeightMap::kSize / 2 * place.transpose();
      normals.row(n++) = (normal.dot(eye.head<3>() - eye.w() * place) < 0 ? -1 : 1) * normal.transpose();
    }
  }

  Rows places, normals;
  Eigen::VectorXf light;
};

}  // namespace

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

Matrix3f turned_to(const Vector3f& lamp) {
  const Vector3f towards = lamp.normalized(), right = towards.unitOrthogonal();
  Matrix3f rows;
  rows << right.transpose(), towards.cross(right).transpose(), towards.transpose();
  return rows;
}

void light_up(Geometry& geometry, const Camera& camera) {
  constexpr float kHalf = HeightMap::kSize / 2;
  const Matrix4f seen = seen_by(camera, geometry, HeightMap::kSize);
  const Vector4f eye = seen * camera.eye().cast<float>();
  // what lies above the cut casts no shadow: a plane in texels
  Vector4f cut(0, 0, 0, 1);
  if (geometry.cut) {
    const float reach = 1 / seen.topLeftCorner<1, 3>().norm();
    const Vector3f normal = reach * seen.topLeftCorner<3, 3>() * geometry.cut->normal.cast<float>();
    const Vector4f on_it = seen * (geometry.cut->offset * geometry.cut->normal).cast<float>().homogeneous();
    cut = Vector4f(normal.x(), normal.y(), normal.z(), kHalf * normal.dot(on_it.head<3>()));
  }
  std::vector<std::pair<Geometry::Vertices*, Seen>> lit;
  for (Geometry::Vertices* vertices : {&geometry.surface, &geometry.walls, &geometry.veil, &geometry.cut_faces})
    lit.emplace_back(vertices, Seen(*vertices, seen, eye));

  HeightMap map;
  for (const Vector3f& lamp : lamps()) {
    const Matrix3f turn = turned_to(lamp);
    const auto from_lamp = [&](const Rows& places) -> Rows {
      return (places * turn.transpose()).rowwise() + Eigen::RowVector3f(kHalf, kHalf, 0);
    };
    const Vector3f normal = turn * cut.head<3>();
    const Vector4f level(normal.x(), normal.y(), normal.z(),
                         cut.w() + kHalf * (normal.x() + normal.y()) - 0.5f * normal.x());
    map.clear();
    for (const auto& [vertices, own] : lit) {
      const bool is_cut_face = vertices == &geometry.cut_faces;
      if (vertices == &geometry.veil || (is_cut_face && geometry.is_hollow)) continue;
      const Vector4f above = is_cut_face ? Vector4f(0, 0, 0, 1) : level;
      const Rows at = from_lamp(own.places);
      for (auto corner = vertices->corners.begin(); corner != vertices->corners.end(); corner += 3) {
        const Vector3f a = at.row(corner[0]), b = at.row(corner[1]), c = at.row(corner[2]);
        // hexahedra are closed: what of them faces away lies behind the rest
        if (geometry.is_hollow || is_cut_face || (b - a).cross(c - a).z() > 0) map.draw(a, b, c, above);
      }
    }
    for (auto& [vertices, own] : lit) {
      const Eigen::VectorXf slant = own.normals * lamp;
      const Rows at = from_lamp(own.places + kLift * own.normals);
      for (Eigen::Index n = 0; n < slant.size(); ++n)
        if (slant[n] > 0) own.light[n] += slant[n] * map.arriving(at(n, 0), at(n, 1), at(n, 2));
    }
  }
  for (auto& [vertices, own] : lit)
    for (std::size_t n = 0; n < vertices->distinct.size(); ++n)
      vertices->distinct[n].light = own.light[static_cast<Eigen::Index>(n)];
}

}  // namespace hexaplast::output
