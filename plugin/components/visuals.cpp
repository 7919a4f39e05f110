// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/visuals.hpp"

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"

namespace hexaplast::components {
namespace {

class OglModel final : public scene::VisualModel {
 public:
  OglModel() : VisualModel(attributes::kOglModel) {}

  void init() override {
    points_ = vectors3("position");
    const int num_points = static_cast<int>(points_.rows());
    triangles_ = cells_of<3>(*this, "triangles", num_points);
    quads_ = cells_of<4>(*this, "quads", num_points);
  }
  void refresh() override {}  // its points follow the hexahedra from where they are in the beginning

  const PointArray& points() const override { return points_; }
  const std::vector<Triangle>& triangles() const override { return triangles_; }
  const std::vector<Quad>& quads() const override { return quads_; }

 private:
  PointArray points_;
  std::vector<Triangle> triangles_;
  std::vector<Quad> quads_;
};

class VisualStyle final : public scene::VisualStyle {
 public:
  VisualStyle() : scene::VisualStyle(attributes::kVisualStyle) {}

  void init() override {
    for (const std::string_view flag : scene::split_words(text("displayFlags"))) {
      if (flag == "showVisualModels" || flag == "showVisual" || flag == "showAll") visual_models_ = true;
      if (flag == "hideVisualModels" || flag == "hideVisual" || flag == "hideAll") visual_models_ = false;
      if (flag == "showBehaviorModels" || flag == "showBehavior" || flag == "showAll") behaviour_models_ = true;
      if (flag == "hideBehaviorModels" || flag == "hideBehavior" || flag == "hideAll") behaviour_models_ = false;
    }
  }
  void refresh() override { init(); }

  std::optional<bool> shows_visual_models() const override { return visual_models_; }
  std::optional<bool> shows_behaviour_models() const override { return behaviour_models_; }

 private:
  std::optional<bool> visual_models_, behaviour_models_;
};

class InteractiveCamera final : public scene::Camera {
 public:
  InteractiveCamera() : Camera(attributes::kInteractiveCamera) {}

  void init() override {
    if (!is_given("position") || !is_given("lookAt")) return;
    for (const char* name : {"position", "lookAt"})
      if (vectors3(name).rows() != 1) reject(name, "must be one point");
    const Vec3 towards = vectors3("position").row(0) - vectors3("lookAt").row(0);
    if (!(towards.norm() > 0)) reject("lookAt", "is the camera's own position: must be another point");
    towards_ = towards;
  }
  void refresh() override { init(); }

  std::optional<Vec3> towards() const override { return towards_; }

 private:
  std::optional<Vec3> towards_;
};

}  // namespace

void add_visuals(scene::Factory& factory) {
  factory.add<OglModel>(attributes::kOglModel);
  factory.add<VisualStyle>(attributes::kVisualStyle);
  factory.add<InteractiveCamera>(attributes::kInteractiveCamera);
}

}  // namespace hexaplast::components
