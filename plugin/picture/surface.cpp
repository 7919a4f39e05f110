// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "base/disjoint_sets.hpp"
#include "picture/ink.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

int corner_at(const Surface::Face& face, int point) {
  return static_cast<int>(std::ranges::find(face, point) - face.begin());
}

}  // namespace

std::vector<Vector3f> single(ConstPoints points) {
  std::vector<Vector3f> places;
  places.reserve(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index n = 0; n < points.rows(); ++n) places.push_back(points.row(n).transpose().cast<float>());
  return places;
}

Surface::Surface(std::vector<Vector3f> original, std::vector<Face> faces, std::vector<unsigned char> walls)
    : original_(std::move(original)), faces_(std::move(faces)), is_wall_(std::move(walls)) {
  const int num_faces = static_cast<int>(faces_.size());
  std::map<Edge, std::vector<int>> faces_of_edge;
  DisjointSets corners(4 * num_faces);
  for (int f = 0; f < num_faces; ++f) {
    if (is_triangle(faces_[f])) corners.join(4 * f + 2, 4 * f + 3);
    for (int k = 0; k < 4; ++k) {
      const auto [low, high] = std::minmax(faces_[f][k], faces_[f][(k + 1) % 4]);
      if (low != high) faces_of_edge[{low, high}].push_back(f);
    }
  }

  const std::vector<Vector3f> normals = face_normals(original_);
  for (const auto& [edge, around] : faces_of_edge) {
    edges_.push_back(edge);
    is_closed_ = is_closed_ && around.size() == 2;
    const Vector3f first = normals[around.front()].normalized(), last = normals[around.back()].normalized();
    const bool is_lip = is_wall(around.front()) != is_wall(around.back());
    const bool is_bent = first.dot(last) < kCrease && !first.isZero(0) && !last.isZero(0);
    if (around.size() != 2 || is_lip || is_bent) {
      creases_.push_back(edge);
      continue;
    }
    smooth_.push_back(edge);
    faces_of_smooth_.push_back({around.front(), around.back()});
    for (const int point : edge)
      corners.join(4 * around.front() + corner_at(faces_[around.front()], point),
                   4 * around.back() + corner_at(faces_[around.back()], point));
  }

  std::vector<int> group_of_root(4 * num_faces, -1);
  groups_.resize(num_faces);
  for (int f = 0; f < num_faces; ++f)
    for (int k = 0; k < 4; ++k) {
      int& group = group_of_root[corners.root(4 * f + k)];
      if (group < 0) group = num_groups_++;
      groups_[f][k] = group;
    }
}

std::vector<Vector3f> Surface::face_normals(const std::vector<Vector3f>& points) const {
  std::vector<Vector3f> normals;
  normals.reserve(faces_.size());
  for (const auto& [a, b, c, d] : faces_) normals.push_back((points[c] - points[a]).cross(points[d] - points[b]));
  return normals;
}

float Surface::mean_edge() const {
  float sum = 0;
  for (const auto& [a, b] : edges_) sum += (original_[b] - original_[a]).norm();
  return edges_.empty() ? 0 : sum / static_cast<float>(edges_.size());
}

std::vector<Vector3f> Surface::group_normals(const std::vector<Vector3f>& points) const {
  const std::vector<Vector3f> of_face = face_normals(points);
  std::vector<Vector3f> of_group(num_groups_, Vector3f::Zero());
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (int k = 0; k < (is_triangle(faces_[f]) ? 3 : 4); ++k) of_group[groups_[f][k]] += of_face[f];
  for (Vector3f& normal : of_group) normal.normalize();
  return of_group;
}

std::vector<Vector3f> Surface::point_normals(const std::vector<Vector3f>& points) const {
  const std::vector<Vector3f> of_face = face_normals(points);
  std::vector<Vector3f> normals(points.size(), Vector3f::Zero());
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (int k = 0; k < (is_triangle(faces_[f]) ? 3 : 4); ++k) normals[faces_[f][k]] += of_face[f];
  return normals;
}

std::vector<Edge> Surface::outline(const std::vector<Vector3f>& points, const Vector3f& towards) const {
  std::vector<Edge> lines = creases_;
  const std::vector<Vector3f> normals = face_normals(points);
  for (std::size_t k = 0; k < smooth_.size(); ++k) {
    const auto& [one, other] = faces_of_smooth_[k];
    if ((normals[one].dot(towards) > 0) != (normals[other].dot(towards) > 0)) lines.push_back(smooth_[k]);
  }
  return lines;
}

}  // namespace hexaplast::output
