// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tools.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <type_traits>

#include "attributes/contact.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "parts/instrument_shape.hpp"

namespace hexaplast::python {
namespace {

parts::Surroundings around(const Body& body) {
  const int num_nodes = body.BodyState::body().initial_mesh().num_nodes();
  return {.num_nodes = {num_nodes, num_nodes}, .bodies = {&body.BodyState::body(), &body.BodyState::body()}};
}

/// "max_subdivision" of "maxSubdivision".
std::string snake_case(const std::string& attribute) {
  std::string name;
  for (const char c : attribute)
    if (std::isupper(static_cast<unsigned char>(c)) != 0)
      (name += '_') += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else
      name += c;
  return name;
}

template <class T>
std::optional<T> given(const py::dict& arguments, const char* name) {
  const py::object value = arguments[name];
  try {
    return value.cast<std::optional<T>>();
  } catch (const py::cast_error&) {
    throw py::type_error(fmt::format("{} = {}: is of another type", name, py::repr(value).cast<std::string>()));
  }
}

parts::InstrumentOptions::Shape shape_named(const std::string& word) {
  const attributes::Attribute& shape = attributes::kInstrumentContactForceField.rows[0];
  return static_cast<parts::InstrumentOptions::Shape>(parts::place_of_word(shape, word));
}

/// Of an option; long lists by their hash.
template <class T>
std::string text_of(const T& value) {
  constexpr std::ptrdiff_t kMostNumbers = 8;
  if constexpr (std::is_arithmetic_v<T>) {
    return fmt::format("{}", value);
  } else if constexpr (std::is_enum_v<T>) {
    return text_of(static_cast<int>(value));
  } else if constexpr (requires { value.has_value(); }) {
    return value ? text_of(*value) : "none";
  } else {
    const std::span all(value.data(), static_cast<std::size_t>(value.size()));
    if (std::ssize(all) <= kMostNumbers) return fmt::format("{}", all);
    StateHash hash;
    hash.add(all.data(), all.size_bytes());
    return fmt::format("a list of {} with the hash {}", all.size(), hash.text());
  }
}

/// As Tool::made_with.
template <class Options>
std::vector<std::string> texts_of(const char* list, const Pose& start, const Options& options) {
  std::vector<std::string> texts = {list, "position = " + text_of(start.position),
                                    "orientation = " + text_of(start.orientation.coeffs())};
  Options::each(options, [&](const char* name, const auto& value) {
    texts.push_back(fmt::format("{} = {}", name, text_of(value)));
  });
  return texts;
}

/// (positions, triangles)
void set_surface(parts::InstrumentOptions& options, const py::object& surface) {
  if (surface.is_none()) return;
  try {
    const auto [positions, triangles] = surface.cast<std::pair<py::object, std::vector<Triangle>>>();
    options.surface_positions = as_points(points("surface[0]", positions));
    options.surface_triangles = triangles;
  } catch (const py::cast_error&) {
    throw py::type_error("surface: must be (positions, triangles)");
  }
}

}  // namespace

void Tool::go_to(const Pose& pose) {
  target_ = pose;
  velocity_.setZero();
}

void Tool::set_velocity(const Vec3& velocity) {
  velocity_ = velocity;
  target_ = now_;
}

void Tool::begin_step(double dt) {
  next_ = velocity_.isZero(0) ? target_ : Pose{now_.position + dt * velocity_, now_.orientation};
  prescribe(now_, next_);
}

void Tool::end_step() { now_ = target_ = next_; }

void Tool::reset() {
  now_ = start_;
  go_to(start_);
}

void Tool::serialize(Archive& archive) {
  for (Pose* pose : {&now_, &target_}) archive(pose->position, pose->orientation.coeffs());
  archive(velocity_);
}

SolidTool::SolidTool(std::shared_ptr<Body> body, const Pose& start, parts::InstrumentOptions options,
                     const py::dict& arguments)
    : Tool(body, start, arguments, texts_of("instruments", start, options)), part_(std::move(options), around(*body)) {}

void SolidTool::reset() {
  Tool::reset();
  set_active(true);
}

void SolidTool::set_active(bool is_active) {
  if (is_active == part_.is_active()) return;
  parts::InstrumentOptions options = part_.options();
  options.contact.active = is_active;
  part_.set_options(std::move(options));
}

void SolidTool::serialize(Archive& archive) {
  Tool::serialize(archive);
  bool is_active = part_.is_active();
  archive(is_active);
  if (archive.reads()) set_active(is_active);
}

output::Instrument SolidTool::shown() const {
  const parts::InstrumentShape shape = parts::shape_of(part_.options());
  return {.place = now().position,
          .nodes = {},
          .forces =
              part_.contact().num_touching() > 0 ? PointArray(-part_.contact().force().transpose()) : PointArray(0, 3),
          .shape_points = shape.at(now()),
          .shape_triangles = shape.triangles};
}

Grip::Grip(std::shared_ptr<Body> body, const Vec3& position, parts::GraspOptions options, const py::dict& arguments)
    : Tool(body, {.position = position}, arguments, texts_of("grips", {.position = position}, options)),
      part_(std::move(options), around(*body)) {}

void Grip::reset() {
  Tool::reset();
  is_closed_ = false;
}

void Grip::serialize(Archive& archive) {
  Tool::serialize(archive);
  archive(is_closed_);
}

output::Instrument Grip::shown() const {
  return {.place = now().position, .nodes = {}, .forces = PointArray(part_.force().transpose())};
}

std::shared_ptr<SolidTool> make_solid_tool(std::shared_ptr<Body> body, const py::dict& arguments) {
  parts::InstrumentOptions options;
  options.is_prescribed = true;
  options.shape = shape_named(arguments["shape"].cast<std::string>());
  options.radius = given<double>(arguments, "radius");
  options.length = given<double>(arguments, "length");
  if (const py::object size = arguments["size"]; !size.is_none()) options.size = vector_from("size", size);
  set_surface(options, arguments["surface"]);
  options.contact = {.contact_stiffness = given<double>(arguments, "contact_stiffness"),
                     .tangential_stiffness = given<double>(arguments, "tangential_stiffness"),
                     .friction = arguments["friction"].cast<double>(),
                     .contact_distance = arguments["contact_distance"].cast<double>(),
                     .damping = arguments["damping"].cast<double>(),
                     .max_subdivision = arguments["max_subdivision"].cast<int>()};
  return std::make_shared<SolidTool>(std::move(body), pose_from(arguments["pose"], {}), std::move(options), arguments);
}

std::shared_ptr<Grip> make_grip(std::shared_ptr<Body> body, const py::dict& arguments) {
  parts::GraspOptions options;
  options.is_prescribed = true;
  options.radius = given<double>(arguments, "radius");
  const py::dict kept = arguments.attr("copy")();
  // all copies of each: by initial nodes, which are those of every copy of the body
  if (!arguments["nodes"].is_none()) {
    const hexaplast::Body& present = body->body();
    std::set<int> initial;
    for (const int node : indices("nodes", arguments["nodes"], present.mesh().num_nodes()))
      initial.insert(present.copies().initial()[node]);
    options.indices.emplace(initial.begin(), initial.end());
    kept["nodes"] = *options.indices;
  }
  options.stiffness = arguments["stiffness"].cast<double>();
  options.max_force = given<double>(arguments, "max_force");
  options.damping = arguments["damping"].cast<double>();
  const Vec3 position = vector_from("position", arguments["position"]);
  return std::make_shared<Grip>(std::move(body), position, std::move(options), kept);
}

std::vector<std::string> names_of(const std::vector<std::shared_ptr<Tool>>& tools) {
  std::vector<std::string> names;
  std::map<std::string, int> counts;
  for (const std::shared_ptr<Tool>& tool : tools) {
    const std::string& list = tool->made_with().front();
    names.push_back(fmt::format("{}[{}]", list, counts[list]++));
  }
  return names;
}

std::vector<std::string> take_warnings(const std::vector<std::shared_ptr<Tool>>& tools) {
  std::vector<std::string> all;
  const std::vector<std::string> names = names_of(tools);
  for (std::size_t k = 0; k < tools.size(); ++k)
    for (const parts::Remark& remark : tools[k]->acting().take_warnings())
      all.push_back(fmt::format("{}: {}: {}", names[k], snake_case(remark.attribute), remark.text));
  return all;
}

void warn(const std::vector<std::string>& warnings) {
  std::optional<py::error_already_set> first;
  for (const std::string& text : warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) {
      const py::error_already_set error;  // takes it from Python, so that the next one can be said
      if (!first) first.emplace(error);
    }
  if (first) throw py::error_already_set(*first);
}

void add_tools(py::module_& module) {
  py::class_<SolidTool, Instrument, std::shared_ptr<SolidTool>>(module, "SolidInstrument",
                                                                "A rigid solid that touches the body of a Simulation")
      .def_property(
          "velocity", in_turn([](SolidTool& t) { return array_of(t.velocity()); }),
          in_turn([](SolidTool& t, py::handle velocity) { t.set_velocity(vector_from("velocity", velocity)); }),
          "(3,) [m/s] at which it goes on in every step, until it or the pose is set")
      .def_property("active", in_turn([](SolidTool& t) { return t.is_active(); }),
                    in_turn([](SolidTool& t, bool active) { t.set_active(active); }),
                    "False: it passes through the body")
      .def_property_readonly("torque", in_turn([](SolidTool& t) { return array_of(t.torque()); }),
                             "(3,) [N m] of the body on it about the origin of its frame, in the latest step")
      .def_property_readonly("num_touching", in_turn([](SolidTool& t) { return t.num_touching(); }),
                             "points of the surface that touch it in the latest step");

  py::class_<Grip, std::shared_ptr<Grip>>(module, "Grip", "Forceps that hold nodes of a Simulation's body by springs")
      .def("close", in_turn([](Grip& g) { g.set_closed(true); }),
           "Takes hold of nodes where they are, when the next step begins, unless it is closed")
      .def("open", in_turn([](Grip& g) { g.set_closed(false); }), "Lets go, when the next step begins")
      .def_property_readonly("closed", in_turn([](Grip& g) { return g.is_closed(); }))
      .def_property(
          "position", in_turn([](Grip& g) { return array_of(g.now().position); }),
          in_turn([](Grip& g, py::handle position) { g.go_to({.position = vector_from("position", position)}); }),
          "(3,) [m] where it is; set, it moves there steadily within the next step, and stays there")
      .def_property("velocity", in_turn([](Grip& g) { return array_of(g.velocity()); }),
                    in_turn([](Grip& g, py::handle velocity) { g.set_velocity(vector_from("velocity", velocity)); }),
                    "(3,) [m/s] at which it goes on in every step, until it or the position is set")
      .def_property_readonly("nodes", in_turn([](Grip& g) {
                               const std::span<const int> held = g.part().held_nodes();
                               return py::array(py::array_t<int>(static_cast<py::ssize_t>(held.size()), held.data()));
                             }),
                             "(k,) that it holds")
      .def_property_readonly("force", in_turn([](Grip& g) { return array_of(g.part().force()); }),
                             "(3,) [N] of it on the body, in the latest step")
      .def_property_readonly("torque", in_turn([](Grip& g) { return array_of(g.part().torque()); }),
                             "(3,) [N m] of that force about the grip");
}

}  // namespace hexaplast::python
