// SPDX-License-Identifier: LGPL-2.1-or-later
#include "body.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <sstream>
#include <string_view>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "words.hpp"

namespace hexaplast::python {
namespace {

/// Copies, within the memory that is there while the sizes stay.
void copy(const PointArray& from, PointArray& to) { to = from; }
template <class T>
void copy(std::span<const T> from, std::vector<T>& to) {
  to.assign(from.begin(), from.end());
}

template <class T, class View>
const T& kept(std::optional<T>& place, const View& present) {
  if (!place) copy(present, place.emplace());
  return *place;
}

template <class T, class View>
void fill(std::optional<T>& place, const View& present) {
  if (place) copy(present, *place);
}

py::array corner_view(const std::vector<CornerValues>& values, py::handle owner) {
  return view(reinterpret_cast<const double*>(values.data()), {static_cast<py::ssize_t>(values.size()), kCorners},
              owner);
}

std::vector<Material> materials_from(const std::variant<Material, std::vector<Material>>& given) {
  if (const auto* one = std::get_if<Material>(&given)) return {*one};
  return std::get<std::vector<Material>>(given);
}

std::string repr(const Material& m) {
  return fmt::format(
      "Material(young_modulus={}, poisson_ratio={}, yield_stress={}, flow_rate={}, rotation_yield={}, "
      "rotation_flow_rate={}, hardening={}, fracture_stress={}, fracture_stretch={})",
      m.young_modulus, m.poisson_ratio, m.yield_stress, m.flow_rate, m.rotation_yield, m.rotation_flow_rate,
      m.hardening, m.fracture_stress, m.fracture_stretch);
}

std::string repr(const Settings& s) {
  return fmt::format(
      "Settings(gradient='{}', yield_norm='{}', rotation_plasticity='{}', rotation_frame='{}', averaging='{}', "
      "averaging_steps={}, averaging_tolerance={}, precision='{}', volume_restitution={}, inversion_threshold={})",
      word(kGradients, s.gradient), word(kYieldNorms, s.yield_norm), word(kRotations, s.rotation_plasticity),
      word(kFrames, s.rotation_frame), word(kAveragings, s.averaging), s.averaging_steps, s.averaging_tolerance,
      word(kPrecisions, s.precision), s.volume_restitution, s.inversion_threshold);
}

void add_material(py::module_& module) {
  constexpr Material kDefault;
  py::class_<Material>(module, "Material", "What a hexahedron is made of. The defaults make it purely elastic.")
      .def(py::init([](double young_modulus, double poisson_ratio, double yield_stress, double flow_rate,
                       double rotation_yield, double rotation_flow_rate, double hardening, double fracture_stress,
                       double fracture_stretch) {
             return Material{.young_modulus = young_modulus,
                             .poisson_ratio = poisson_ratio,
                             .yield_stress = yield_stress,
                             .flow_rate = flow_rate,
                             .rotation_yield = rotation_yield,
                             .rotation_flow_rate = rotation_flow_rate,
                             .hardening = hardening,
                             .fracture_stress = fracture_stress,
                             .fracture_stretch = fracture_stretch};
           }),
           py::kw_only(), py::arg("young_modulus") = kDefault.young_modulus,
           py::arg("poisson_ratio") = kDefault.poisson_ratio, py::arg("yield_stress") = kDefault.yield_stress,
           py::arg("flow_rate") = kDefault.flow_rate, py::arg("rotation_yield") = kDefault.rotation_yield,
           py::arg("rotation_flow_rate") = kDefault.rotation_flow_rate, py::arg("hardening") = kDefault.hardening,
           py::arg("fracture_stress") = kDefault.fracture_stress,
           py::arg("fracture_stretch") = kDefault.fracture_stretch)
      .def_readwrite("young_modulus", &Material::young_modulus, "E [Pa], > 0")
      .def_readwrite("poisson_ratio", &Material::poisson_ratio, "[-], in [0, 0.5)")
      .def_readwrite("yield_stress", &Material::yield_stress, "[Pa], >= 0; infinite: never yields")
      .def_readwrite("flow_rate", &Material::flow_rate,
                     "[1/s], >= 0: share of the excess deviatoric stretch that flows per second")
      .def_readwrite("rotation_yield", &Material::rotation_yield, "[rad], in [0, pi]")
      .def_readwrite("rotation_flow_rate", &Material::rotation_flow_rate, "[1/s], >= 0")
      .def_readwrite("hardening", &Material::hardening, "[-] growth of both thresholds with flow; < 0 softens")
      .def_readwrite("fracture_stress", &Material::fracture_stress,
                     "[Pa] a hexahedron goes when its yield stress has hardened past it")
      .def_readwrite("fracture_stretch", &Material::fracture_stretch,
                     "[-], > 1: a hexahedron goes when its plastic stretch passes it")
      .def("__repr__", [](const Material& material) { return repr(material); });
}

template <auto Member, class Enum>
void add_word(py::class_<Settings>& settings, const char* name, const Words<Enum>& words, const char* help) {
  settings.def_property(
      name, [&words](const Settings& s) { return word(words, s.*Member); },
      [&words, name](Settings& s, const std::string& text) { s.*Member = meaning(words, name, text); }, help);
}

void add_settings(py::module_& module) {
  const Settings standard;
  py::class_<Settings> settings(module, "Settings", "What holds for a whole body.");
  settings
      .def(py::init([](const std::string& gradient, const std::string& yield_norm,
                       const std::string& rotation_plasticity, const std::string& rotation_frame,
                       const std::string& averaging, int averaging_steps, double averaging_tolerance,
                       const std::string& precision, double volume_restitution, double inversion_threshold) {
             return Settings{.gradient = meaning(kGradients, "gradient", gradient),
                             .yield_norm = meaning(kYieldNorms, "yield_norm", yield_norm),
                             .rotation_plasticity = meaning(kRotations, "rotation_plasticity", rotation_plasticity),
                             .rotation_frame = meaning(kFrames, "rotation_frame", rotation_frame),
                             .averaging = meaning(kAveragings, "averaging", averaging),
                             .averaging_steps = averaging_steps,
                             .averaging_tolerance = averaging_tolerance,
                             .precision = meaning(kPrecisions, "precision", precision),
                             .volume_restitution = volume_restitution,
                             .inversion_threshold = inversion_threshold};
           }),
           py::kw_only(), py::arg("gradient") = word(kGradients, standard.gradient),
           py::arg("yield_norm") = word(kYieldNorms, standard.yield_norm),
           py::arg("rotation_plasticity") = word(kRotations, standard.rotation_plasticity),
           py::arg("rotation_frame") = word(kFrames, standard.rotation_frame),
           py::arg("averaging") = word(kAveragings, standard.averaging),
           py::arg("averaging_steps") = standard.averaging_steps,
           py::arg("averaging_tolerance") = standard.averaging_tolerance,
           py::arg("precision") = word(kPrecisions, standard.precision),
           py::arg("volume_restitution") = standard.volume_restitution,
           py::arg("inversion_threshold") = standard.inversion_threshold)
      .def_readwrite("averaging_steps", &Settings::averaging_steps, "per time step, >= 1")
      .def_readwrite("averaging_tolerance", &Settings::averaging_tolerance,
                     "relative residual; 0: 1e-6, in mixed precision 1e-2")
      .def_readwrite("volume_restitution", &Settings::volume_restitution, "c [1/s], >= 0; c dt < 2/3")
      .def_readwrite("inversion_threshold", &Settings::inversion_threshold,
                     "hexahedra flatter than this do not flow; in [0, 1)")
      .def("__repr__", [](const Settings& s) { return repr(s); })
      .def("__eq__", [](const Settings& s, const Settings& other) { return s == other; });
  add_word<&Settings::gradient>(settings, "gradient", kGradients, "blended, vertex or centre");
  add_word<&Settings::yield_norm>(settings, "yield_norm", kYieldNorms, "vonMises, frobenius or spectral");
  add_word<&Settings::rotation_plasticity>(settings, "rotation_plasticity", kRotations,
                                           "objective, vertex, centre or none");
  add_word<&Settings::rotation_frame>(settings, "rotation_frame", kFrames, "bestFit or world");
  add_word<&Settings::averaging>(settings, "averaging", kAveragings,
                                 "gaussNewton, gaussNewtonIsolated, localGlobal or jacobi");
  add_word<&Settings::precision>(settings, "precision", kPrecisions, "double or mixed");
}

void add_reports(py::module_& module) {
  py::class_<FlowReport>(module, "FlowReport", "What happened in one plastic step. Counts are hexahedra.")
      .def_readonly("yielded", &FlowReport::yielded, "with flow at some corner")
      .def_readonly("inverted", &FlowReport::inverted, "turned inside out at some corner")
      .def_readonly("guarded", &FlowReport::guarded, "kept elastic because they are inverted or nearly so")
      .def_readonly("repaired", &FlowReport::repaired, "whose material shape was led back towards the original one")
      .def_readonly("removed", &FlowReport::removed, "broken in this step: the last ones of Body.removed")
      .def_readonly("worst_volume_error", &FlowReport::worst_volume_error,
                    "[-] greatest |material volume / original volume - 1| before the step")
      .def_property_readonly(
          "averaging_converged", [](const FlowReport& r) { return r.averaging.converged; },
          "False: the averaging stopped before its tolerance");

  py::class_<ElementFields>(module, "Fields",
                            "One value per hexahedron, shape (m,). Removed ones: 0 but for the first two.")
      .def_property_readonly(
          "plastic_strain", [](py::object self) { return view(self.cast<ElementFields&>().plastic_strain, self); },
          "[-] mean over the corners of the accumulated plastic strain")
      .def_property_readonly(
          "yield_stress", [](py::object self) { return view(self.cast<ElementFields&>().yield_stress, self); },
          "[Pa] greatest of the corners; infinite where it never yields")
      .def_property_readonly(
          "volume_ratio", [](py::object self) { return view(self.cast<ElementFields&>().volume_ratio, self); },
          "[-] material volume / original volume")
      .def_property_readonly(
          "stress_norm", [](py::object self) { return view(self.cast<ElementFields&>().stress_norm, self); },
          "[Pa] greatest of the corners, in the body's yield norm")
      .def_property_readonly(
          "strain", [](py::object self) { return view(self.cast<ElementFields&>().strain, self); },
          "[-] greatest |D - 1| of the corners");
}

void add_body_state(py::module_& module) {
  py::class_<BodyState, std::shared_ptr<BodyState>>(
      module, "BodyState",
      "What can be read of a body. material_positions, corner_plastic_strain, corner_yield_stress and alive are\n"
      "read-only views that follow the body: taken once, they show its present state after every step.")
      .def_property_readonly("num_nodes", [](const BodyState& b) { return b.body().mesh().num_nodes(); })
      .def_property_readonly("num_hexahedra", [](const BodyState& b) { return b.body().mesh().num_elements(); })
      .def_property_readonly(
          "original_positions", [](const BodyState& b) { return view(b.body().mesh().positions(), b.keeper()); },
          "(n, 3) [m]")
      .def_property_readonly(
          "hexahedra",
          [](const BodyState& b) {
            const std::vector<Hexahedron>& hexahedra = b.body().mesh().hexahedra();
            return view(reinterpret_cast<const int*>(hexahedra.data()),
                        {static_cast<py::ssize_t>(hexahedra.size()), kCorners}, b.keeper());
          },
          "(m, 8) node numbers, in the corner order of VTK's hexahedron")
      .def_property_readonly(
          "material_positions",
          [](py::object self) {
            auto& state = self.cast<BodyState&>();
            const Turn turn(state.taken());
            return view(state.material(), self);
          },
          "(n, 3) [m]: the shape that the body would take when nothing pulled at it, as far as its pieces agree")
      .def_property_readonly(
          "corner_plastic_strain",
          [](py::object self) {
            auto& state = self.cast<BodyState&>();
            const Turn turn(state.taken());
            return corner_view(state.plastic_strain(), self);
          },
          "(m, 8) [-] accumulated, at the corners")
      .def_property_readonly(
          "corner_yield_stress",
          [](py::object self) {
            auto& state = self.cast<BodyState&>();
            const Turn turn(state.taken());
            return corner_view(state.yield_stress(), self);
          },
          "(m, 8) [Pa] at the corners, hardened; infinite where it never yields")
      .def_property_readonly(
          "alive",
          [](py::object self) {
            auto& state = self.cast<BodyState&>();
            const Turn turn(state.taken());
            const std::vector<unsigned char>& alive = state.alive();
            return view(reinterpret_cast<const bool*>(alive.data()), {static_cast<py::ssize_t>(alive.size())}, self);
          },
          "(m,) bool: False where a hexahedron is gone")
      .def_property_readonly(
          "removed",
          [](const BodyState& b) { return std::vector<int>(b.body().removed().begin(), b.body().removed().end()); },
          "hexahedra that are gone, in the order of their removal")
      .def_property_readonly(
          "dissipated_energy", [](const BodyState& b) { return b.body().dissipated_energy(); },
          "[J] plastic work so far")
      .def_property_readonly(
          "original_volume", [](const BodyState& b) { return b.body().original_volume(); },
          "[m^3] of the hexahedra that are left")
      .def(
          "volume",
          [](BodyState& b, py::handle positions) {
            const Turn turn(b.taken());
            return b.body().volume(as_points(points("positions", positions, b.body().mesh().num_nodes())));
          },
          py::arg("positions"), "[m^3] of the hexahedra that are left, at nodal positions (n, 3) [m]")
      .def(
          "energy",
          [](BodyState& b, py::handle positions) {
            const Turn turn(b.taken());
            return b.body().energy(as_points(points("positions", positions, b.body().mesh().num_nodes())));
          },
          py::arg("positions"), "Elastic energy [J] at nodal positions (n, 3) [m]")
      .def(
          "fields",
          [](BodyState& b, py::handle positions) {
            const Turn turn(b.taken());
            return b.body().fields(as_points(points("positions", positions, b.body().mesh().num_nodes())));
          },
          py::arg("positions"), "One value per hexahedron of several quantities, at nodal positions (n, 3) [m]")
      .def(
          "history_hash",
          [](BodyState& b) {
            const Turn turn(b.taken());
            StateHash hash;
            b.body().add_to(hash);
            return hash.text();
          },
          "16 hexadecimal digits: equal where the plastic histories are equal to the last bit");
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
      .def(
          "force",
          [](Body& b, py::handle positions) {
            const RealArray x = points("positions", positions, b.body().mesh().num_nodes());
            const Turn turn(b.taken());
            PointArray f = PointArray::Zero(x.shape(0), 3);
            b.body().linearize(as_points(x));
            b.body().add_force(f);
            return taken(std::move(f));
          },
          py::arg("positions"), "Elastic nodal forces (n, 3) [N] at nodal positions (n, 3) [m]")
      .def(
          "stiffness_product",
          [](Body& b, py::handle positions, py::handle dx) {
            const Eigen::Index n = b.body().mesh().num_nodes();
            const RealArray x = points("positions", positions, n), direction = points("dx", dx, n);
            const Turn turn(b.taken());
            PointArray df = PointArray::Zero(n, 3);
            b.body().linearize(as_points(x));
            b.body().add_stiffness_product(1, as_points(direction), df);
            return taken(std::move(df));
          },
          py::arg("positions"), py::arg("dx"),
          "(df/dx) dx (n, 3) [N] at nodal positions [m], rotations held fixed: negative semi-definite")
      .def(
          "flow",
          [](Body& b, py::handle positions, double dt) {
            const RealArray x = points("positions", positions, b.body().mesh().num_nodes());
            const Turn turn(b.taken());
            const py::gil_scoped_release others_may_run;
            const FlowReport report = b.body().flow(as_points(x), dt);
            b.refresh();
            return report;
          },
          py::arg("positions"), py::arg("dt"),
          "Plastic flow over dt [s] at accepted positions (n, 3) [m]: once per time step")
      .def(
          "remove",
          [](Body& b, py::handle numbers) {
            const std::vector<int> elements = indices("hexahedra", numbers, b.body().mesh().num_elements());
            const Turn turn(b.taken());
            b.body().remove(elements);
            b.refresh();
          },
          py::arg("hexahedra"), "Takes hexahedra out, as if they had broken: their numbers, or a mask")
      .def(
          "reset",
          [](Body& b) {
            const Turn turn(b.taken());
            b.body().reset();
            b.refresh();
          },
          "Back to the virgin state")
      .def(
          "save",
          [](Body& b) {
            const Turn turn(b.taken());
            std::ostringstream out(std::ios::binary);
            b.body().save(out);
            return py::bytes(out.str());
          },
          "Plastic history and materials, with a checksum: what load() of a body of the same mesh and settings goes on "
          "from, bit for bit. Positions and velocities are not among it")
      .def(
          "load",
          [](Body& b, const py::bytes& data) {
            const Turn turn(b.taken());
            std::istringstream in(data, std::ios::binary);
            b.body().load(in);
            b.refresh();
          },
          py::arg("data"), "Takes over what save() returned. What is damaged or another body's is a ValueError")
      .def(
          "set_material",
          [](Body& b, const std::variant<Material, std::vector<Material>>& material) {
            const Turn turn(b.taken());
            b.body().set_materials(materials_from(material));
            b.refresh();
          },
          py::arg("material"),
          "Makes the body of something else, one Material or one per hexahedron: what has flowed stays, thresholds "
          "move "
          "by as much as those of the material");
}

}  // namespace

py::capsule BodyState::keeper() const {
  using Kept = std::shared_ptr<const hexaplast::Body>;
  return py::capsule(new Kept(body_), [](void* memory) { delete static_cast<Kept*>(memory); });
}

const PointArray& BodyState::material() { return kept(material_, body_->plastic_rest_positions()); }
const std::vector<CornerValues>& BodyState::plastic_strain() { return kept(plastic_strain_, body_->plastic_strain()); }
const std::vector<CornerValues>& BodyState::yield_stress() { return kept(yield_stress_, body_->yield_stress()); }
const std::vector<unsigned char>& BodyState::alive() { return kept(alive_, body_->alive()); }

void BodyState::refresh() {
  fill(material_, body_->plastic_rest_positions());
  fill(plastic_strain_, body_->plastic_strain());
  fill(yield_stress_, body_->yield_stress());
  fill(alive_, body_->alive());
}

void add_body(py::module_& module) {
  add_material(module);
  add_settings(module);
  add_reports(module);
  add_body_state(module);
  add_owned_body(module);
}

}  // namespace hexaplast::python
