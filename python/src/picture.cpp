// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"
#include "instrument.hpp"
#include "picture/quantity.hpp"

namespace hexaplast::python {
namespace {

constexpr int kSmallestPicture = 64, kLargestPicture = 4096;  // [pixels]
constexpr double kShortest = 1e-100;                          // of a direction
constexpr const char* kViews = "front, back, left, right, top, bottom, or a direction (3,) that is not 0";
constexpr const char* kCameras = "(place, target, angle): (3,), another (3,) [m], and a number between 0 and 180 [deg]";

output::Viewpoint viewpoint_in(const py::object& view, const Vec3& up) {
  if (py::isinstance<py::str>(view)) {
    const std::string word = view.cast<std::string>();
    if (const std::optional<Vec3> side = output::side_named(word, up)) return {*side, {}, {}};
    throw InputError(fmt::format("view = '{}': must be {}", word, kViews));
  }
  const Vec3 towards = vector_from("view", view);
  if (!(towards.stableNorm() > kShortest && std::isfinite(towards.norm())))
    throw InputError(fmt::format("view: must be {}", kViews));
  return {towards, {}, {}};
}

output::Viewpoint viewpoint_of_camera(const py::object& camera) {
  if (!py::isinstance<py::sequence>(camera) || py::len(camera) != 3)
    throw py::type_error(fmt::format("camera: must be {}", kCameras));
  const py::sequence parts = camera;
  const Vec3 place = vector_from("camera[0]", parts[0]), target = vector_from("camera[1]", parts[1]);
  const py::object of_view = parts[2];
  const double angle = PyNumber_Check(of_view.ptr()) ? py::float_(of_view).cast<double>() : 0;
  if (!((place - target).stableNorm() > kShortest) || !(angle > 0 && angle < 180))
    throw InputError(fmt::format("camera: must be {}", kCameras));
  return {place - target, {}, output::Viewpoint::Eye{place, target, angle, true}};
}

output::Quantity quantity_called(const std::string& word, const output::Regions& regions) {
  const std::optional<output::Quantity> quantity = output::quantity_of(word);
  if (!quantity) {
    std::vector<std::string_view> words;
    for (const output::QuantityEntry& entry : output::kQuantities) words.push_back(entry.word);
    throw InputError(fmt::format("field = '{}': must be one of {}", word, fmt::join(words, ", ")));
  }
  if (*quantity == output::Quantity::kRegion && regions.names.empty())
    throw InputError("field = 'region': there are no regions");
  return *quantity;
}

std::pair<double, double> range_in(const py::object& given) {
  const RealArray range = RealArray::ensure(given);
  if (!range || range.ndim() != 1 || range.size() != 2 || !(range.at(0) < range.at(1)) ||
      !std::isfinite(range.at(1) - range.at(0)))
    throw InputError(
        fmt::format("range = {}: must be (min, max), finite, the lesser first", py::repr(given).cast<std::string>()));
  return {range.at(0), range.at(1)};
}

}  // namespace

py::array picture_of(const Moment& moment, output::Staging staging, const PictureOptions& options) {
  for (const auto& [name, size] : {std::pair{"width", options.width}, std::pair{"height", options.height}})
    if (size < kSmallestPicture || size > kLargestPicture)
      throw InputError(fmt::format("{} = {} must lie in [{}, {}]", name, size, kSmallestPicture, kLargestPicture));
  staging.width = options.width;
  staging.height = options.height;
  if (!options.view.is_none() && !options.camera.is_none()) throw InputError("view and camera are both given");
  if (!options.view.is_none()) staging.viewpoint = viewpoint_in(options.view, staging.upright());
  if (!options.camera.is_none()) staging.viewpoint = viewpoint_of_camera(options.camera);
  staging.quantity = quantity_called(options.field, staging.regions);
  if (!options.range.is_none()) {
    if (staging.shows_numbers()) throw InputError("range: regions have no scale");
    staging.range = range_in(options.range);
  }

  static output::Renderer* const renderer = output::load_renderer().release();  // as long as the process
  const std::vector<double> values =
      output::values_of(staging.quantity, moment.bodies, moment.positions, moment.velocities, staging.regions);
  output::Gallery gallery(moment.bodies.mesh(), moment.title, output::time_decimals(moment.dt), std::move(staging));
  gallery.add(moment.step, moment.time, moment.positions, values, moment.bodies.alive(), moment.conditions, nullptr,
              moment.bodies.open_faces());
  output::Image image;
  gallery.for_each_drawing([&](int, const output::Drawing& drawing) { image = renderer->render(drawing); });
  py::array_t<std::uint8_t> pixels({options.height, options.width, 3});
  std::ranges::copy(image.pixels, pixels.mutable_data());
  return pixels;
}

}  // namespace hexaplast::python
