// SPDX-License-Identifier: LGPL-2.1-or-later
#include "body.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <sstream>
#include <string_view>
#include <utility>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "rows.hpp"

namespace hexaplast::python {
namespace {

/// Copies, within the memory that is there while the sizes stay.
template <class T>
void copy(std::span<const T> from, std::vector<T>& to) {
  to.assign(from.begin(), from.end());
}

// `present` is a function of the body: plastic rest positions take linear systems, and are asked for only where
// somebody looks at them.
template <class T, class Present>
const T& kept(BodyState& state, std::optional<T>& place, const Present& present) {
  const Turn turn(state.taken());
  if (!place) copy(std::invoke(present, state.body()), place.emplace());
  return *place;
}

template <class T, class Present>
void fill(const hexaplast::Body& body, std::optional<T>& place, const Present& present) {
  if (place) copy(std::invoke(present, body), *place);
}

/// Nodal positions [m] of a body, from Python.
RealArray positions_of(const BodyState& b, py::handle given) {
  return points("positions", given, b.body().mesh().num_nodes());
}

std::vector<Material> materials_from(const std::variant<Material, std::vector<Material>>& given) {
  if (const auto* one = std::get_if<Material>(&given)) return {*one};
  return std::get<std::vector<Material>>(given);
}

/// A member in Python's type.
template <class Options>
py::object value_of(const Row<Options>& row, const Options& options) {
  if (row.at.list) return py::cast(row.values(options));
  const double value = row.at.get(options);
  switch (row.at.type) {
    case MemberType::kWord:
      return py::str(std::string(row.words[static_cast<std::size_t>(value)]));
    case MemberType::kInteger:
      return py::int_(static_cast<int>(value));
    case MemberType::kReal:
    case MemberType::kReals:
      break;
  }
  return py::float_(value);
}

template <class Options>
void convert(const Row<Options>& row, py::handle value, Options& options) {
  try {
    if (row.at.type == MemberType::kReal) return row.at.set(options, value.cast<double>());
    if (row.at.type == MemberType::kInteger) return row.at.set(options, value.cast<int>());
    if (row.at.list) return row.set_values(options, value.cast<std::vector<double>>());
    const auto word = value.cast<std::string>();
    const int place = place_of_word(row, word);
    if (place < 0)
      throw InputError(fmt::format("{} = '{}' must be one of {}", row.member, word, fmt::join(row.words, ", ")));
    row.at.set(options, place);
  } catch (const py::cast_error&) {
    throw py::type_error(fmt::format("{}: {} is no {}", row.member, std::string(py::repr(value)), python_type(row)));
  }
}

/// Throws InputError for a value out of the row's range; the options are then as before.
template <class Options>
void assign(const Row<Options>& row, py::handle value, Options& options) {
  Options changed = options;
  convert(row, value, changed);
  for (const double number : row.values(changed))
    if (!row.admits(number)) throw InputError(fmt::format("{} = {}: must {}", row.member, number, row.condition()));
  options = std::move(changed);
}

/// "Material(young_modulus=5000, ...)"
template <class Options>
std::string repr(const char* name, std::span<const Row<Options>> rows, const Options& options) {
  std::vector<std::string> members;
  for (const Row<Options>& row : rows) members.push_back(fmt::format("{}={}", row.member, python_text(row, options)));
  return fmt::format("{}({})", name, fmt::join(members, ", "));
}

/// The help of a member, with those that it mentions by their names in Python.
template <class Options>
std::string help_of(const Row<Options>& row) {
  std::string help = fmt::format("[{}] {} Must {}.", row.unit.empty() ? "-" : row.unit, row.help, row.condition());
  const auto rename = [&](const auto& other) {
    if (other.name == other.member) return;
    for (std::size_t at = help.find(other.name); at != help.npos; at = help.find(other.name, at))
      help.replace(at, other.name.size(), other.member);
  };
  std::ranges::for_each(material_rows(), rename);
  std::ranges::for_each(settings_rows(), rename);
  return help;
}

/// A struct as a class of Python: its members are attributes, and keywords of the constructor.
template <class Options>
void add_options(py::module_& module, const char* name, const char* help, std::span<const Row<Options>> rows) {
  py::options without_signatures;
  without_signatures.disable_function_signatures();
  py::class_<Options> type(module, name, help);
  const auto from_members = [name, rows](const py::dict& given) {
    Options options;
    for (const auto& [key, value] : given) {
      const auto* row = find_row(rows, std::string(py::str(key)), Names::kMembers);
      if (!row) throw py::type_error(fmt::format("{}() has no argument {}", name, std::string(py::str(key))));
      assign(*row, value, options);
    }
    return options;
  };
  type.def(py::init([from_members](const py::kwargs& given) { return from_members(given); }),
           fmt::format("__init__(self: {}, *, {}) -> None", name, fmt::join(keywords(rows), ", ")).c_str());
  for (const Row<Options>& row : rows) {
    type.def_property(
        row.member.data(), [&row](const Options& options) { return value_of(row, options); },
        [&row](Options& options, py::handle value) { assign(row, value, options); }, help_of(row).c_str());
  }
  type.def("__repr__", [name, rows](const Options& options) { return repr(name, rows, options); });
  type.def(py::pickle(
      [rows](const Options& options) {
        py::dict members;
        for (const Row<Options>& row : rows) members[std::string(row.member).c_str()] = value_of(row, options);
        return members;
      },
      from_members));
  if constexpr (std::equality_comparable<Options>)
    type.def("__eq__", [](const Options& options, const Options& other) { return options == other; });
}

void add_reports(py::module_& module) {
  py::class_<FlowReport> report(module, "FlowReport", "What happened in one plastic step. Counts are hexahedra.");
  report.def_readonly("yielded", &FlowReport::yielded, "with flow at some corner")
      .def_readonly("inverted", &FlowReport::inverted, "inverted at some corner")
      .def_readonly("skipped", &FlowReport::skipped, "without flow, because inverted or nearly so")
      .def_readonly("repaired", &FlowReport::repaired, "whose plastic rest shape was moved towards the initial one")
      .def_readonly("rolled_back", &FlowReport::rolled_back,
                    "that keep the shape they had, because averaging would have flattened a hexahedron")
      .def_readonly("removed", &FlowReport::removed, "broken in this step: the last ones of Body.removed")
      .def_readonly("torn", &FlowReport::torn, "numbers of the joints that open by it; in a Simulation they are open")
      .def_readonly("worst_volume_error", &FlowReport::worst_volume_error,
                    "[-] max |volume without load / initial volume - 1| before the step")
      .def_property_readonly(
          "averaging_converged", [](const FlowReport& r) { return r.averaging.converged; },
          "False: the averaging stopped before its tolerance");

  py::class_<ElementFields>(module, "Fields",
                            "One value per hexahedron, shape (m,). Removed ones: 0 but for the first two.")
      .def_property_readonly("plastic_strain", view_of<ElementFields>(&ElementFields::plastic_strain),
                             "[-] mean over the corners of the accumulated plastic strain")
      .def_property_readonly("yield_stress", view_of<ElementFields>(&ElementFields::yield_stress),
                             "[Pa] maximum of the corners; infinite if it never yields")
      .def_property_readonly("volume_ratio", view_of<ElementFields>(&ElementFields::volume_ratio),
                             "[-] volume without load / initial volume")
      .def_property_readonly("stress_norm", view_of<ElementFields>(&ElementFields::stress_norm),
                             "[Pa] maximum of the corners, in the body's yield norm")
      .def_property_readonly("strain", view_of<ElementFields>(&ElementFields::strain),
                             "[-] max |D - 1| of the corners");
}

/// Whole numbers in two columns.
template <class Entry>
py::array_t<int> two_columns(int count, const Entry& entry) {
  py::array_t<int> rows({static_cast<py::ssize_t>(count), py::ssize_t{2}});
  int* to = rows.mutable_data();
  for (int k = 0; k < count; ++k) {
    const auto [first, second] = entry(k);
    *to++ = first;
    *to++ = second;
  }
  return rows;
}

void add_joints(py::module_& module) {
  py::class_<Joints>(
      module, "Joints",
      "What holds the hexahedra of a mesh together: faces that two or more of them have, and hinges, which\n"
      "are pairs that meet at nodes where no chain of faces joins them. Numbered: faces, then hinges")
      .def("__len__", &Joints::count)
      .def_property_readonly(
          "faces",
          [](const Joints& j) {
            return two_columns(j.num_faces(),
                               [&](int k) { return std::pair(j.faces()[k].hexahedron, j.faces()[k].side); });
          },
          "(f, 2): the lowest hexahedron that has the face, and its side (of six)")
      .def_property_readonly(
          "hinges",
          [](const Joints& j) {
            return two_columns(j.num_hinges(),
                               [&](int k) { return std::pair(j.hinges()[k].first, j.hinges()[k].second); });
          },
          "(h, 2): hexahedra")
      .def_property_readonly(
          "pairs",
          [](const Joints& j) {
            return two_columns(j.count(),
                               [&](int k) { return std::pair(j.hexahedra(k).front(), j.hexahedra(k).back()); });
          },
          "(f + h, 2) of every joint: the lowest and the highest hexahedron that it holds");
}

void add_body_state(py::module_& module) {
  py::class_<BodyState, std::shared_ptr<BodyState>> type(
      module, "BodyState",
      "What can be read of a body. plastic_rest_positions, corner_plastic_strain, corner_yield_stress and alive are\n"
      "read-only views that follow the body: taken once, they show its present state after every step.");
  type.def_property_readonly("num_nodes", [](const BodyState& b) { return b.body().mesh().num_nodes(); })
      .def_property_readonly("num_hexahedra", [](const BodyState& b) { return b.body().mesh().num_elements(); })
      .def_property_readonly("initial_positions",
                             in_turn([](BodyState& b) { return taken(b.body().mesh().positions()); }), "(n, 3) [m]")
      .def_property_readonly("hexahedra", in_turn([](BodyState& b) {
                               py::array cells = cells_of(b.body().mesh().hexahedra());
                               cells.attr("setflags")(py::arg("write") = false);
                               return cells;
                             }),
                             "(m, 8) node numbers, in the corner order of VTK's hexahedron")
      .def_property_readonly("joints", in_turn([](BodyState& b) { return b.body().joints(); }),
                             "Joints that hold the hexahedra of the initial mesh together, open or not")
      .def_property_readonly("opened", in_turn([](BodyState& b) {
                               return std::vector<int>(b.body().opened().begin(), b.body().opened().end());
                             }),
                             "numbers of the joints that are open, in the order of the calls that opened them")
      .def_property_readonly("crossings", in_turn([](BodyState& b) {
                               return std::vector<double>(b.body().crossings().begin(), b.body().crossings().end());
                             }),
                             "[-] where each of these was crossed: from the centre of its lower hexahedron (0) to the "
                             "other (1)")
      .def_property_readonly("initial_nodes", in_turn([](BodyState& b) {
                               return py::array_t<int>(std::ssize(b.body().copies().initial()),
                                                       b.body().copies().initial().data());
                             }),
                             "(n,) of each node the one of the initial mesh that it is, or was split from")
      .def_property_readonly(
          "revision", in_turn([](BodyState& b) { return b.body().revision(); }),
          "grows where hexahedra are removed or joints opened, and with reset, load and set_material")
      .def_property_readonly(
          "plastic_rest_positions", &BodyState::plastic_rest_positions,
          "(n, 3) [m]: the shape that the body would take when nothing pulled at it, as far as its pieces agree")
      .def_property_readonly("corner_plastic_strain", view_of<BodyState>(&BodyState::plastic_strain),
                             "(m, 8) [-] accumulated, at the corners")
      .def_property_readonly("corner_yield_stress", view_of<BodyState>(&BodyState::yield_stress),
                             "(m, 8) [Pa] at the corners, hardened; infinite where it never yields")
      .def_property_readonly(
          "alive",
          [](py::object self) {
            const std::vector<unsigned char>& alive = self.cast<BodyState&>().alive();
            return view(reinterpret_cast<const bool*>(alive.data()), {static_cast<py::ssize_t>(alive.size())}, self);
          },
          "(m,) bool: False where a hexahedron is gone")
      .def_property_readonly("removed", in_turn([](BodyState& b) {
                               return std::vector<int>(b.body().removed().begin(), b.body().removed().end());
                             }),
                             "hexahedra that are gone, in the order of their removal")
      .def_property_readonly("dissipated_energy", in_turn([](BodyState& b) { return b.body().dissipated_energy(); }),
                             "[J] plastic work and loss by relaxation so far")
      .def_property_readonly("initial_volume", in_turn([](BodyState& b) { return b.body().initial_volume(); }),
                             "[m^3] of the hexahedra that are left")
      .def("volume", in_turn([](BodyState& b, py::handle positions) {
             return b.body().volume(as_points(positions_of(b, positions)));
           }),
           py::arg("positions"), "[m^3] of the hexahedra that are left, at nodal positions (n, 3) [m]")
      .def("energy", in_turn([](BodyState& b, py::handle positions) {
             return b.body().energy(as_points(positions_of(b, positions)));
           }),
           py::arg("positions"), "Elastic energy [J] at nodal positions (n, 3) [m]")
      .def("fields", in_turn([](BodyState& b, py::handle positions) {
             return b.body().fields(as_points(positions_of(b, positions)));
           }),
           py::arg("positions"), "One value per hexahedron of several quantities, at nodal positions (n, 3) [m]")
      .def("history_hash", in_turn([](BodyState& b) {
             StateHash hash;
             b.body().add_to(hash);
             return hash.text();
           }),
           "16 hexadecimal digits: equal where the plastic histories are equal to the last bit");
}

py::bytes saved(const hexaplast::Body& body) {
  std::ostringstream out(std::ios::binary);
  body.save(out);
  return out.str();
}

void load(hexaplast::Body& body, const py::bytes& data) {
  std::istringstream in(data, std::ios::binary);
  body.load(in);
}

void add_owned_body(py::module_& module) {
  py::class_<Body, BodyState, std::shared_ptr<Body>>(
      module, "Body", "A deformable, plastically flowing body of hexahedra. Evaluating it never changes its history.")
      .def(py::init([](py::handle positions, py::handle cells,
                       const std::variant<Material, std::vector<Material>>& material, const Settings& settings) {
             const RealArray x = points("positions", positions);
             return std::make_shared<Body>(std::make_shared<hexaplast::Body>(
                 HexMesh(as_points(x), hexahedra("hexahedra", cells)), materials_from(material), settings));
           }),
           py::arg("positions"), py::arg("hexahedra"), py::arg("material") = Material(),
           py::arg("settings") = Settings(),
           "positions (n, 3) [m]; hexahedra (m, 8), in the corner order of VTK; one Material, or one per hexahedron")
      .def_property("device", in_turn([](Body& b) { return b.body().device(); }),
                    in_turn([](Body& b, const std::string& name) { b.body().use_device(name); }),
                    "What computes the body: \"cpu\", \"cuda\" or \"emulation\" (docs/gpu.md). ValueError names what a "
                    "device cannot")
      .def("set_time_step", in_turn([](Body& b, double dt) { b.body().set_time_step(dt); }), py::arg("dt"),
           "What follows is of a step of dt [s]; inf: of an equilibrium; 0: of a sudden change. A body whose settings "
           "have\n"
           "`relaxation` needs it before `force`, `energy` and `flow`; to others it does nothing")
      .def("force", in_turn([](Body& b, py::handle positions) {
             const RealArray x = positions_of(b, positions);
             PointArray f = PointArray::Zero(x.shape(0), 3);
             b.body().linearize(as_points(x));
             b.body().add_force(f);
             return taken(std::move(f));
           }),
           py::arg("positions"), "Elastic nodal forces (n, 3) [N] at nodal positions (n, 3) [m]")
      .def("stiffness_product", in_turn([](Body& b, py::handle positions, py::handle dx) {
             const Eigen::Index n = b.body().mesh().num_nodes();
             const RealArray x = points("positions", positions, n), direction = points("dx", dx, n);
             PointArray df = PointArray::Zero(n, 3);
             b.body().linearize(as_points(x));
             b.body().add_stiffness_product(1, as_points(direction), df);
             return taken(std::move(df));
           }),
           py::arg("positions"), py::arg("dx"),
           "(df/dx) dx (n, 3) [N] at nodal positions [m], rotations held fixed: negative semi-definite")
      .def("flow", in_turn([](Body& b, py::handle positions, double dt) {
             const RealArray x = positions_of(b, positions);
             const py::gil_scoped_release others_may_run;
             const FlowReport report = b.body().flow(as_points(x), dt);
             b.refresh();
             return report;
           }),
           py::arg("positions"), py::arg("dt"),
           "Plastic flow over dt [s] at accepted positions (n, 3) [m]: once per time step")
      .def("remove", in_turn([](Body& b, py::handle numbers) {
             const std::vector<int> elements = indices("hexahedra", numbers, b.body().mesh().num_elements());
             b.body().remove(elements);
             b.refresh();
           }),
           py::arg("hexahedra"), "Takes hexahedra out, as if they had broken: their numbers, or a mask")
      .def("open", in_turn([](Body& b, py::handle joints) {
             if (b.is_in_simulation()) throw InputError("the body is in a simulation: open its joints there");
             const std::vector<int> parents = b.body().open(indices("joints", joints, b.body().joints().count()));
             b.refresh();
             return py::array_t<int>(std::ssize(parents), parents.data());
           }),
           py::arg("joints"),
           "Opens joints between hexahedra (numbers, or a mask): nodes that no closed joint holds together any more "
           "are\n"
           "split. Returns (k,) of each new node, behind the present ones, the one that it was split from")
      .def("reset", in_turn([](Body& b) {
             if (b.is_in_simulation() && b.body().copies().is_split())
               throw InputError("the body is in a simulation, and has open joints: reset the simulation");
             b.body().reset();
             b.refresh();
           }),
           "Returns to the initial state")
      .def("save", in_turn([](Body& b) { return saved(b.body()); }),
           "Plastic history and materials, with a checksum: load() of a body with the same mesh and settings continues "
           "from them, bit for bit. Positions and velocities are not included")
      .def("load", in_turn([](Body& b, const py::bytes& data) {
             const std::vector<Hexahedron> corners = b.body().mesh().hexahedra();
             const py::bytes before = b.is_in_simulation() ? saved(b.body()) : py::bytes();
             load(b.body(), data);
             if (b.is_in_simulation() && b.body().mesh().hexahedra() != corners) {
               load(b.body(), before);
               throw InputError(
                   "the body is in a simulation, and that one has other open joints: load the simulation's");
             }
             b.refresh();
           }),
           py::arg("data"), "Takes over what save() returned. What is damaged or another body's is a ValueError")
      .def(py::pickle(in_turn([](Body& b) {
                        const HexMesh& mesh = b.body().initial_mesh();
                        return py::make_tuple(taken(mesh.positions()), cells_of(mesh.hexahedra()), b.body().materials(),
                                              b.body().settings(), saved(b.body()), b.body().device(),
                                              std::as_const(b.body()).state().time_step);
                      }),
                      [](const py::tuple& state) {
                        const RealArray x = points("positions", state[0]);
                        auto body = std::make_shared<hexaplast::Body>(
                            HexMesh(as_points(x), hexahedra("hexahedra", state[1])),
                            state[2].cast<std::vector<Material>>(), state[3].cast<Settings>());
                        load(*body, state[4].cast<py::bytes>());
                        body->use_device(state[5].cast<std::string>());
                        if (const double dt = state[6].cast<double>(); !std::isnan(dt)) body->set_time_step(dt);
                        return std::make_shared<Body>(std::move(body));
                      }))
      .def("set_material", in_turn([](Body& b, const std::variant<Material, std::vector<Material>>& material) {
             b.body().set_materials(materials_from(material));
             b.refresh();
           }),
           py::arg("material"),
           "Makes the body of something else, one Material or one per hexahedron: what has flowed stays, thresholds "
           "move by as much as those of the material");
}

}  // namespace

py::array BodyState::plastic_rest_positions() {
  const Turn turn(taken());
  return plastic_rest_positions_.view(body_->plastic_rest_positions());
}
const std::vector<CornerValues>& BodyState::plastic_strain() {
  return kept(*this, plastic_strain_, &hexaplast::Body::plastic_strain);
}
const std::vector<CornerValues>& BodyState::yield_stress() {
  return kept(*this, yield_stress_, &hexaplast::Body::yield_stress);
}
const std::vector<unsigned char>& BodyState::alive() { return kept(*this, alive_, &hexaplast::Body::alive); }

void BodyState::refresh() {
  if (plastic_rest_positions_.is_shown()) plastic_rest_positions_.refresh(body_->plastic_rest_positions());
  fill(*body_, plastic_strain_, &hexaplast::Body::plastic_strain);
  fill(*body_, yield_stress_, &hexaplast::Body::yield_stress);
  fill(*body_, alive_, &hexaplast::Body::alive);
}

void add_body(py::module_& module) {
  add_options(module, "Material", "What a hexahedron is made of. The defaults make it purely elastic.",
              material_rows());
  add_options(module, "Settings", "What holds for a whole body.", settings_rows());
  add_reports(module);
  add_joints(module);
  add_body_state(module);
  add_owned_body(module);
}

}  // namespace hexaplast::python
