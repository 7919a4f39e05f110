// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/visuals.hpp"

#include <algorithm>
#include <initializer_list>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"

namespace hexaplast::components {
namespace {

class OglModel final : public scene::VisualModel, public scene::Changeable {
 public:
  OglModel() : VisualModel(attributes::kOglModel) {}

  void init() override {
    points_ = vectors3("position");
    if (points_.rows() == 0)
      if (auto* mapping = node().local<scene::GivesPoints>())
        if (const PointArray* lent = mapping->points_for(*this)) points_ = *lent;
    const int num_points = static_cast<int>(points_.rows());
    triangles_ = cells_of<3>(*this, "triangles", num_points);
    quads_ = cells_of<4>(*this, "quads", num_points);
  }
  void refresh(std::span<const std::string_view>) override {
  }  // its points follow the hexahedra from where they are in the beginning

  const PointArray& points() const override { return points_; }
  const std::vector<Triangle>& triangles() const override { return triangles_; }
  const std::vector<Quad>& quads() const override { return quads_; }

 private:
  PointArray points_;
  std::vector<Triangle> triangles_;
  std::vector<Quad> quads_;
};

class VisualStyle final : public scene::VisualStyle, public scene::Changeable {
 public:
  VisualStyle() : scene::VisualStyle(attributes::kVisualStyle) {}

  void init() override {
    visual_models_ = said({"VisualModels", "Visual", "All"});
    behaviour_models_ = said({"BehaviorModels", "Behavior", "All"});
    loads_ = said({"ForceFields", "Behavior", "All"}).value_or(true);
  }
  void refresh(std::span<const std::string_view>) override { init(); }

  std::optional<bool> shows_visual_models() const override { return visual_models_; }
  std::optional<bool> shows_behaviour_models() const override { return behaviour_models_; }
  bool shows_loads() const override { return loads_; }

 private:
  /// Of the words about one thing the last one counts.
  std::optional<bool> said(std::initializer_list<std::string_view> names) {
    std::optional<bool> shown;
    for (const std::string_view flag : scene::split_words(text("displayFlags"))) {
      const bool is_meant = flag.size() > 4 && std::ranges::count(names, flag.substr(4)) > 0;
      if (is_meant && flag.starts_with("show")) shown = true;
      if (is_meant && flag.starts_with("hide")) shown = false;
    }
    return shown;
  }

  std::optional<bool> visual_models_, behaviour_models_;
  bool loads_ = true;
};

class InteractiveCamera final : public scene::Camera, public scene::Changeable {
 public:
  InteractiveCamera() : Camera(attributes::kInteractiveCamera) {}

  void init() override {
    viewpoint_.reset();
    const Vec3 position = point("position"), target = point("lookAt");
    const bool has_position = is_given("position"), has_orientation = is_given("orientation");
    if (has_position && is_given("lookAt")) {
      if (!((position - target).norm() > 0)) reject("lookAt", "is the camera's own position: must be another point");
      viewpoint_ = scene::Viewpoint{position - target, {}, eye(position, target)};
    } else if (has_orientation) {
      const Eigen::Quaterniond turn = orientation();
      const Vec3 towards = turn * Vec3::UnitZ();
      viewpoint_ = scene::Viewpoint{towards, turn * Vec3::UnitY(), {}};
      if (has_position) viewpoint_->eye = eye(position, position - real("distance") * towards);
    }
  }
  void refresh(std::span<const std::string_view>) override { init(); }

  const std::optional<scene::Viewpoint>& viewpoint() const override { return viewpoint_; }

 private:
  Vec3 point(const char* name) {
    if (!is_given(name)) return Vec3::Zero();
    const PointArray points = vectors3(name);
    if (points.rows() != 1) reject(name, "must be one point");
    return points.row(0).transpose();
  }

  Eigen::Quaterniond orientation() {
    const std::vector<double>& turn = reals("orientation");
    if (turn.size() != 4) reject("orientation", "must be four numbers, a quaternion x y z w");
    const Eigen::Quaterniond quaternion(turn[3], turn[0], turn[1], turn[2]);
    if (!(quaternion.norm() > 0)) reject("orientation", "is 0 0 0 0, the zero quaternion");
    return quaternion.normalized();
  }

  std::optional<scene::Viewpoint::Eye> eye(const Vec3& position, const Vec3& looks_at) {
    if (!is_given("fieldOfView")) return std::nullopt;
    const std::string& projection = text("projectionType");
    return scene::Viewpoint::Eye{position, looks_at, real("fieldOfView"),
                                 projection == "Perspective" || projection == "0"};
  }

  std::optional<scene::Viewpoint> viewpoint_;
};

}  // namespace

void add_visuals(scene::Factory& factory) {
  factory.add<OglModel>(attributes::kOglModel);
  factory.add<VisualStyle>(attributes::kVisualStyle);
  factory.add<InteractiveCamera>(attributes::kInteractiveCamera);
}

}  // namespace hexaplast::components
