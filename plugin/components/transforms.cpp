// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "attributes/stock.hpp"
#include "attributes/words.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "formats/readable_file.hpp"
#include "geometry/placement.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::components {
namespace {

using Affine = Eigen::Affine3d;

/// The same turn as that of hexaplast::place.
Mat3 rotation_by(const Vec3& degrees) {
  PointArray axes = Mat3::Identity();
  hexaplast::place(axes, Vec3::Ones(), degrees, Vec3::Zero());
  return axes.transpose();
}

PointArray moved(scene::Component& by, const Affine& transform, const PointArray& points) {
  PointArray result = (points * transform.linear().transpose()).rowwise() + transform.translation().transpose();
  if (!result.allFinite()) by.reject("input_position", "leads to points that are not finite");
  return result;
}

class TransformEngine final : public scene::Engine {
 public:
  TransformEngine() : Engine(attributes::kTransformEngine) {}

  void bwd_init() override { reals("output_position"); }  // mistakes are found, whoever uses the output

 private:
  void compute(std::string_view) override {
    const Vec3 scale = vector3("scale");
    Affine transform = Affine::Identity();
    transform.linear() = turn() * scale.asDiagonal();
    transform.translation() = vector3("translation");
    if (boolean("inverse")) {
      if ((scale.array() == 0).any()) reject("scale", "has a 0, which has no inverse");
      transform = transform.inverse();
    }
    found("output_position", flattened(moved(*this, transform, vectors3("input_position"))));
  }

  Mat3 turn() {
    const std::vector<double>& q = reals("quaternion");
    if (q.empty()) return rotation_by(vector3("rotation"));
    if (q.size() != 4) reject("quaternion", fmt::format("{} numbers given, must be four: x y z w", q.size()));
    const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
    if (!(quaternion.norm() > 0)) reject("quaternion", "is 0 0 0 0, the zero quaternion");
    return quaternion.normalized().toRotationMatrix();
  }
};

/// The numbers of a line of text that begins with a word; empty: there is no such line.
std::vector<double> numbers_after(std::string_view content, std::string_view word) {
  std::vector<double> numbers;
  while (!content.empty()) {
    const std::size_t end = content.find('\n');
    const std::string_view line = content.substr(0, end);
    content = end == content.npos ? std::string_view() : content.substr(end + 1);
    if (!line.starts_with(word)) continue;
    for (const std::string_view text : attributes::split_words(line.substr(word.size()))) {
      double number = 0;
      const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(number))
        throw InputError(fmt::format("'{}' behind '{}' is not a number", text.substr(0, 40), word));
      numbers.push_back(number);
    }
    break;
  }
  return numbers;
}

class TransformPosition final : public scene::Engine {
 public:
  TransformPosition() : Engine(attributes::kTransformPosition) {}

  void bwd_init() override { reals("output_position"); }  // mistakes are found, whoever uses the output

 private:
  void compute(std::string_view) override {
    const PointArray points = vectors3("input_position");
    PointArray result = moved(*this, transform(), points);
    for (const int index : indices("fixedIndices", static_cast<int>(points.rows())))
      result.row(index) = points.row(index);
    found("output_position", flattened(result));
  }

  Affine transform() {
    const std::string& method = text("method");
    Affine result = Affine::Identity();
    if (method == "projectOnPlane") {
      const Vec3 normal = vector3("normal"), origin = vector3("origin");
      if (!(normal.norm() > 0)) reject("normal", "is not given, must be that of a plane");
      const Vec3 n = normal.normalized();
      result.linear() -= n * n.transpose();
      result.translation() = n * n.dot(origin);
    } else if (method == "affine" || method == "fromFile") {
      result.matrix() = method == "affine" ? given_matrix() : matrix_from_file();
    } else {
      const bool is_all = method == "scaleRotationTranslation";
      if (is_all || method.starts_with("scale")) result.linear() = vector3("scale").asDiagonal();
      if (is_all || method == "rotation") result.linear() = rotation_by(vector3("rotation")) * result.linear();
      if (is_all || method == "translation" || method == "scaleTranslation")
        result.translation() = vector3("translation");
    }
    return result;
  }

  Eigen::Matrix4d given_matrix() {
    const std::vector<double>& rows = reals("matrix");
    if (rows.size() != 16) reject("matrix", fmt::format("{} numbers given, must be sixteen", rows.size()));
    return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.data());
  }

  Eigen::Matrix4d matrix_from_file() {
    const std::string& name = text("filename");
    if (name.empty()) reject("filename", "is not given, must name a .tfm file");
    if (!name.ends_with(".tfm")) reject("filename", fmt::format("'{}', must end in .tfm", name));
    std::vector<double> p;
    try {
      p = numbers_after(whole_file(node().files().input(name, place())), "Parameters:");
    } catch (const InputError& error) {
      reject("filename", error.what());
    }
    if (p.size() != 12) reject("filename", fmt::format("{} numbers behind 'Parameters:', must be twelve", p.size()));
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) matrix(i, j) = p[static_cast<std::size_t>(3 * i + j)];
      matrix(i, 3) = p[static_cast<std::size_t>(11 - i)];
    }
    return matrix;
  }
};

class SphereLoader final : public scene::Component {
 public:
  SphereLoader() : Component(attributes::kSphereLoader) {}

  void init() override { load(); }

  void provide(scene::Data& output) override {
    const std::string_view name = output.attribute().name;
    if (name == "position") output.set_once([this] { return (load(), flattened(centres_)); });
    if (name == "listRadius") output.set_once([this] { return (load(), radii_); });
  }

 private:
  void load() {
    if (stage() == Stage::kFailed) throw scene::DependencyFailure();
    if (is_loaded_) return;
    const std::string& name = text("filename");
    if (name.empty()) reject("filename", "is not given, must name a .sph file");
    try {
      read(whole_file(node().files().input(name, place())));
    } catch (const InputError& error) {
      reject("filename", error.what(), node().files().search.places_of(name));
    }
    hexaplast::place(centres_, vector3("scale"), vector3("rotation"), vector3("translation"));
    if (!centres_.allFinite()) reject("scale", "leads to points that are not finite");
    is_loaded_ = true;
  }

  void read(std::string_view content) {
    std::vector<double> centres;
    for (int line_number = 1; !content.empty(); ++line_number) {
      const std::size_t end = content.find('\n');
      const std::string_view line = content.substr(0, end);
      content = end == content.npos ? std::string_view() : content.substr(end + 1);
      const auto refuse = [&](const std::string& what) {
        throw InputError(fmt::format("{}: line {}: {}", text("filename"), line_number, what));
      };
      if (line_number == 1 && !line.starts_with("sph")) refuse("must begin with 'sph', as .sph files do");
      if (!line.starts_with("sphe")) continue;  // head, comments, number of spheres
      const std::vector<double> numbers = numbers_after(line, "sphe");
      if (numbers.size() != 5) refuse(fmt::format("{} numbers behind 'sphe', must be five", numbers.size()));
      centres.insert(centres.end(), numbers.begin() + 1, numbers.begin() + 4);
      radii_.push_back(numbers[4]);
    }
    centres_ = Eigen::Map<const PointArray>(centres.data(), static_cast<Eigen::Index>(radii_.size()), 3);
  }

  bool is_loaded_ = false;
  PointArray centres_;         // [m]
  std::vector<double> radii_;  // [m]
};

}  // namespace

void add_transforms(scene::Factory& factory) {
  factory.add<TransformEngine>(attributes::kTransformEngine);
  factory.add<TransformPosition>(attributes::kTransformPosition);
  factory.add<SphereLoader>(attributes::kSphereLoader);
}

}  // namespace hexaplast::components
