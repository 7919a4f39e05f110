// SPDX-License-Identifier: LGPL-2.1-or-later
#include "simulation.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <sstream>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/saved_stream.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "mesh/lumped_mass.hpp"
#include "model_check.hpp"

namespace hexaplast::python {
namespace {

constexpr std::array<std::string_view, 3> kPreconditioners{"auto", "multigrid", "diagonal"};  // as Preconditioner
constexpr SavedKind kSavedSimulation{{'H', 'X', 'P', 'T', 'O', 'O', 'L', '\0'}, 2, "simulation"};

/// Of a saved state, and of the simulation that loads it.
void require_same_tools(const std::vector<std::vector<std::string>>& saved,
                        const std::vector<std::vector<std::string>>& here) {
  if (saved.size() != here.size())
    throw InputError(
        fmt::format("the state has {} instruments and grips, the simulation {}", saved.size(), here.size()));
  for (std::size_t k = 0; k < here.size(); ++k) {
    if (saved[k].size() != here[k].size() && (saved[k].empty() || saved[k].front() == here[k].front()))
      throw InputError(fmt::format("{}: the state is of another version of it", here[k].front()));
    const auto [of_state, own] = std::ranges::mismatch(saved[k], here[k]);
    if (own == here[k].begin())
      throw InputError(fmt::format("the state has {} where the simulation has {}", saved[k].front(), *own));
    if (own != here[k].end())
      throw InputError(
          fmt::format("{}: the state is of one with {}, this one has {}", here[k].front(), *of_state, *own));
  }
}

}  // namespace

Motion Arguments::motion() const {
  return {.density = density,
          .dt = dt,
          .gravity = Vec3(gravity[0], gravity[1], gravity[2]),
          .euler = {.rayleigh_mass = rayleigh_mass, .rayleigh_stiffness = rayleigh_stiffness}};
}

std::unique_ptr<LinearSolver> Arguments::linear_solver() const {
  if (solver == "direct") return nullptr;
  if (solver != "cg") throw InputError(fmt::format("solver = '{}' must be one of cg, direct", solver));
  if (!(tolerance > 0 && tolerance < 1))
    throw InputError(fmt::format("tolerance = {} must lie between 0 and 1", tolerance));
  if (iterations < 1) throw InputError(fmt::format("iterations = {} must be at least 1", iterations));
  const auto found = std::ranges::find(kPreconditioners, preconditioner);
  if (found == kPreconditioners.end())
    throw InputError(
        fmt::format("preconditioner = '{}' must be one of {}", preconditioner, fmt::join(kPreconditioners, ", ")));
  return std::make_unique<PreconditionedConjugateGradients>(
      tolerance, iterations, static_cast<Preconditioner>(found - kPreconditioners.begin()));
}

py::tuple Arguments::state() const {
  return py::make_tuple(density, dt, gravity, rayleigh_mass, rayleigh_stiffness, solver, tolerance, iterations,
                        preconditioner, reactions);
}

Arguments Arguments::from(const py::tuple& state) {
  Arguments all;
  std::size_t k = 0;
  const auto read = [&](auto&... members) {
    (..., (members = state[k++].cast<std::remove_reference_t<decltype(members)>>()));
  };
  read(all.density, all.dt, all.gravity, all.rayleigh_mass, all.rayleigh_stiffness, all.solver, all.tolerance,
       all.iterations, all.preconditioner, all.reactions);
  return all;
}

Simulation::Simulation(std::shared_ptr<Body> body, Arguments arguments)
    : arguments_(std::move(arguments)),
      body_(std::move(body)),
      forces_(std::make_shared<PointArray>(PointArray::Zero(body_->body().mesh().num_nodes(), 3))) {
  if (body_->is_in_simulation()) throw InputError("the body is in a simulation already");
  std::unique_ptr<LinearSolver> solver = arguments_.linear_solver();
  Motion motion = arguments_.motion();
  motion.load = [forces = forces_](double, ConstPoints, Points f) { f += *forces; };
  // a copy, so that the body is as before where the motion is refused
  moving_ = std::make_shared<MovingBody>(hexaplast::Body(body_->body()), std::move(motion), std::move(solver));
  body_->enter_simulation(std::shared_ptr<hexaplast::Body>(moving_, &moving_->body));
  if (!arguments_.reactions) return;
  moving_->measure_supports();
  reactions_.setZero(num_nodes(), 3);
}

double Simulation::kinetic_energy() const {
  const Eigen::Map<const Eigen::VectorXd> mass(moving_->mass().data(), std::ssize(moving_->mass()));
  return hexaplast::kinetic_energy(mass, velocities());
}

py::array Simulation::shown_reactions() {
  if (!arguments_.reactions) throw InputError("reactions are not measured: Simulation(..., reactions=True)");
  return shown_reactions_.view(reactions_);
}

void Simulation::refresh() {
  if (reactions_.rows() != num_nodes() && arguments_.reactions) reactions_.setZero(num_nodes(), 3);
  shown_positions_.refresh(positions());
  shown_velocities_.refresh(velocities());
  shown_reactions_.refresh(reactions_);
  body_->refresh();
}

template <class Make>
auto Simulation::add(const Make& make, const py::dict& arguments) {
  const Turn turn(taken());
  auto tool = make(body_, arguments);
  moving_->add(tool->acting());
  tools_.push_back(tool);
  return tool;
}

std::shared_ptr<SolidTool> Simulation::add_instrument(const py::dict& arguments) {
  return add(make_solid_tool, arguments);
}
std::shared_ptr<Grip> Simulation::add_grip(const py::dict& arguments) { return add(make_grip, arguments); }

std::vector<std::vector<std::string>> Simulation::names_of_tools() const {
  std::vector<std::vector<std::string>> all;
  const std::vector<std::string> names = names_of(tools_);
  for (std::size_t k = 0; k < tools_.size(); ++k) all.emplace_back(tools_[k]->made_with()).front() = names[k];
  return all;
}

PointArray Simulation::forces_from(const char* name, const py::object& given) const {
  if (given.is_none()) return PointArray::Zero(num_nodes(), 3);
  return as_points(points(name, given, num_nodes()));
}

void Simulation::advance(const PointArray& forces, RunReport& report) {
  if (forces.rows() != num_nodes())
    throw InputError(fmt::format("forces: of {} nodes, the simulation has {} now", forces.rows(), num_nodes()));
  // on fixed nodes too, where no step would notice
  if (!forces.allFinite()) throw NumericalError("the nodal forces are not finite");
  *forces_ = forces;
  for (const std::shared_ptr<Tool>& tool : tools_) tool->begin_step(moving_->dt());
  const FlowReport flowed = moving_->step();
  for (const std::shared_ptr<Tool>& tool : tools_) tool->end_step();
  if (arguments_.reactions) reactions_ = moving_->support_forces();
  report.add(moving_->latest, flowed);
  refresh();
  if (record_ && record_->wants(moving_->steps()))
    record_->add(moving_->steps(), moving_->positions, moving_->velocities, conditions());
}

RunReport Simulation::run(long steps, const py::object& forces) {
  const PointArray external = forces_from("forces", forces);
  const Turn turn(taken());
  RunReport report;
  for (long k = 0; k < steps; ++k) {
    {
      const py::gil_scoped_release others_may_run;
      advance(forces.is_none() ? PointArray::Zero(num_nodes(), 3) : external, report);
    }
    warn(take_warnings());
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return report;
}

std::vector<int> Simulation::open(const std::vector<int>& joints) {
  const Turn turn(taken());
  std::vector<int> parents = moving_->open(joints);
  if (parents.empty()) return parents;
  forces_->setZero(num_nodes(), 3);
  refresh();
  return parents;
}

void Simulation::reset() {
  const Turn turn(taken());
  moving_->reset();
  for (const std::shared_ptr<Tool>& tool : tools_) tool->reset();
  reactions_.setZero();
  refresh();
  forces_->setZero(num_nodes(), 3);
  if (record_) begin_record();
}

void Simulation::record() {
  const Turn turn(taken());
  begin_record();
}

std::string Simulation::page() {
  const Turn turn(taken());
  const std::shared_ptr<const MotionRecord> shown = record_ ? record_ : new_record();
  return shown->page(moving_->steps(), moving_->positions, moving_->velocities, conditions());
}

py::array Simulation::picture(const PictureOptions& options) {
  const Turn turn(taken());
  output::Staging staging;
  staging.gravity = arguments_.motion().gravity;
  output::BoundaryConditions shown = conditions();
  for (const std::shared_ptr<Tool>& tool : tools_) {
    shown.instruments.push_back(tool->shown());
    shown.instruments.back().id = static_cast<int>(shown.instruments.size());
  }
  return picture_of({moving_->body, "Simulation", moving_->dt(), moving_->steps(), moving_->time(), moving_->positions,
                     moving_->velocities, shown},
                    std::move(staging), options);
}

py::bytes Simulation::save() const {
  std::ostringstream out(std::ios::binary);
  write_saved(out, kSavedSimulation, 0, [this](Archive& archive) {
    std::vector<std::vector<std::string>> names = names_of_tools();
    PointArray reactions = reactions_;
    archive(names, reactions);
    for (const std::shared_ptr<Tool>& tool : tools_) tool->serialize(archive);
  });
  moving_->save(out);
  return out.str();
}

void Simulation::load(const py::bytes& data) {
  const std::string bytes = data, before = save();
  const auto read = [this](const std::string& from) {
    std::istringstream in(from, std::ios::binary);
    const std::vector<std::byte> of_tools = read_saved(in, kSavedSimulation, 0, from.size());
    Archive archive{std::span<const std::byte>(of_tools)};
    std::vector<std::vector<std::string>> names;
    PointArray reactions;
    archive(names, reactions);
    require_same_tools(names, names_of_tools());
    moving_->load(in);
    for (const std::shared_ptr<Tool>& tool : tools_) tool->serialize(archive);
    if (arguments_.reactions && reactions.rows() == num_nodes())
      reactions_ = std::move(reactions);
    else
      reactions_.setZero();  // not measured there
  };
  try {
    read(bytes);
  } catch (const InputError&) {
    read(before);
    throw;
  }
  refresh();
  forces_->setZero(num_nodes(), 3);
  if (record_) begin_record();
}

void Simulation::set_state(py::handle positions, py::handle velocities) {
  const RealArray x = points("positions", positions), v = points("velocities", velocities);
  const Turn turn(taken());
  for (const auto& [name, field] : {std::pair{"positions", x}, std::pair{"velocities", v}})
    points(name, field, num_nodes());
  if (!as_points(x).allFinite() || !as_points(v).allFinite())
    throw InputError("positions and velocities must be finite");
  moving_->positions = as_points(x);
  moving_->velocities = as_points(v);
  moving_->solver_memory().reset();
  refresh();
  if (record_) begin_record();
}

output::BoundaryConditions Simulation::conditions() const {
  return {.fixed = moving_->fixed(), .loads = *forces_, .instruments = {}};
}

std::shared_ptr<MotionRecord> Simulation::new_record() const {
  return std::make_shared<MotionRecord>(std::vector<output::Bodies::Entry>{{.name = "body", .body = &moving_->body}},
                                        moving_, "Simulation", moving_->dt(), moving_->steps());
}

void Simulation::begin_record() {
  record_ = new_record();
  record_->add(moving_->steps(), moving_->positions, moving_->velocities, conditions());
}

void add_simulation(py::module_& module) {
  py::class_<RunReport>(module, "StepReport", "What happened in one time step, or in several: the worst of each.")
      .def_readonly("steps", &RunReport::steps, "that are reported of")
      .def_readonly("stalled", &RunReport::stalled,
                    "steps in which the linear solver, or that of the averaging, stopped before its tolerance")
      .def_property_readonly(
          "iterations", [](const RunReport& r) { return r.solve.iterations; },
          "of the linear solver, maximum of a step; 1 for a direct one")
      .def_property_readonly(
          "residual", [](const RunReport& r) { return r.solve.residual; },
          "[-] relative, the greatest that the linear solver left; 0 for a direct one")
      .def_property_readonly(
          "converged", [](const RunReport& r) { return r.solve.converged; },
          "False: the linear solver stopped before its tolerance in some step")
      .def_property_readonly(
          "preconditioner", [](const RunReport& r) { return std::string(name_of(r.solve.preconditioner)); },
          "that the linear solver used, in the last step that had something to solve: multigrid, diagonal,\n"
          "factorisation of the whole matrix, or none")
      .def_readonly("flow", &RunReport::flow,
                    "FlowReport of the plastic steps: the greatest counts of a step, but all that were removed");

  py::class_<Simulation> simulation(
      module, "Simulation",
      "A body in motion: lumped masses, gravity, nodal forces, fixed nodes and prescribed displacements. One step is "
      "one implicit\n"
      "Euler step of the positions and one plastic flow. positions and velocities are read-only views that follow it.");
  def_motion(simulation)
      .def_property_readonly("positions", in_turn([](Simulation& s) { return s.shown_positions(); }), "(n, 3) [m]")
      .def_property_readonly("velocities", in_turn([](Simulation& s) { return s.shown_velocities(); }), "(n, 3) [m/s]")
      .def(py::init([](std::shared_ptr<Body> body, double density, double dt, std::array<double, 3> gravity,
                       double rayleigh_mass, double rayleigh_stiffness, const std::string& solver, double tolerance,
                       int iterations, const std::string& preconditioner, bool reactions) {
             if (density > 0 && dt > 0)  // before the body is taken
               warn(size_warnings(check_model(body->body(), density * body->body().initial_volume(), dt),
                                  Vec3(gravity.data())));
             return std::make_unique<Simulation>(
                 std::move(body), Arguments{density, dt, gravity, rayleigh_mass, rayleigh_stiffness, solver, tolerance,
                                            iterations, preconditioner, reactions});
           }),
           py::arg("body").none(false), py::kw_only(), py::arg("density") = 1000.0, py::arg("dt") = 0.01,
           py::arg("gravity") = std::array<double, 3>{0, 0, 0}, py::arg("rayleigh_mass") = 0.0,
           py::arg("rayleigh_stiffness") = 0.0, py::arg("solver") = "cg", py::arg("tolerance") = 1e-6,
           py::arg("iterations") = 1000, py::arg("preconditioner") = "auto", py::arg("reactions") = false,
           "density [kg/m^3], dt [s], gravity [m/s^2], rayleigh_mass [1/s], rayleigh_stiffness [s]; solver: cg\n"
           "(conjugate gradients to a relative residual of tolerance), with a preconditioner: multigrid, diagonal, or "
           "auto,\n"
           "which takes what suits the system; or direct (sparse Cholesky). reactions: whether they are measured")
      .def_property_readonly("body", &Simulation::body)
      .def_property_readonly("masses", in_turn([](Simulation& s) {
                               return py::array_t<double>(std::ssize(s.get().mass()), s.get().mass().data());
                             }),
                             "(n,) [kg] of the nodes")
      .def(
          "step", [](Simulation& s, const py::object& forces) { return s.run(1, forces); },
          py::arg("forces") = py::none(), "One time step under nodal forces (n, 3) [N]; without, under none")
      .def(
          "run",
          [](Simulation& s, long steps, const py::object& forces) {
            if (steps < 1) throw InputError(fmt::format("steps = {} must be at least 1", steps));
            return s.run(steps, forces);
          },
          py::arg("steps"), py::arg("forces") = py::none(),
          "Several steps under constant nodal forces (n, 3) [N]; reports the worst of them")
      .def("fix", in_turn([](Simulation& s, py::handle nodes) {
             const std::vector<int> numbers = indices("nodes", nodes, s.num_nodes());
             if (numbers.empty()) warn({"fix: no node is chosen"});
             s.get().fix(numbers);
             s.refresh();
           }),
           py::arg("nodes"), "Nodes (numbers, or a mask) keep their positions from now on")
      .def(
          "prescribe", in_turn([](Simulation& s, py::handle nodes, py::handle positions) {
            const std::vector<int> numbers = indices("nodes", nodes, s.num_nodes());
            const RealArray to = points("positions", positions, static_cast<Eigen::Index>(numbers.size()));
            s.get().prescribe(numbers, as_points(to));
            s.refresh();
          }),
          py::arg("nodes"), py::arg("positions"),
          "Nodes (numbers, or a mask) move to positions (one row [m] per node) in the next step, and stand still after "
          "it")
      .def("release", in_turn([](Simulation& s, py::handle nodes) {
             s.get().release(indices("nodes", nodes, s.num_nodes()));
             s.refresh();
           }),
           py::arg("nodes"), "Nodes (numbers, or a mask) move freely again")
      .def(
          "open",
          [](Simulation& s, py::handle joints) {
            const std::vector<int> parents = s.open(indices("joints", joints, s.get().body.joints().count()));
            return py::array_t<int>(std::ssize(parents), parents.data());
          },
          py::arg("joints"),
          "Opens joints of the body (numbers, or a mask): nodes that no closed joint holds together any more are "
          "split,\n"
          "with the positions and velocities that they have. Returns (k,) of each new node, behind the present ones, "
          "the\n"
          "one that it was split from. Arrays that were taken before keep their nodes")
      .def(
          "add_instrument",
          [](Simulation& s, const std::string& shape, const py::object& radius, const py::object& length,
             const py::object& size, const py::object& surface, const py::object& pose, double friction,
             const py::object& contact_stiffness, const py::object& tangential_stiffness, double contact_distance,
             double damping, int max_subdivision) {
            using namespace py::literals;
            return s.add_instrument(py::dict(
                "shape"_a = shape, "radius"_a = radius, "length"_a = length, "size"_a = size, "surface"_a = surface,
                "pose"_a = pose, "friction"_a = friction, "contact_stiffness"_a = contact_stiffness,
                "tangential_stiffness"_a = tangential_stiffness, "contact_distance"_a = contact_distance,
                "damping"_a = damping, "max_subdivision"_a = max_subdivision));
          },
          py::arg("shape") = "sphere", py::kw_only(), py::arg("radius") = py::none(), py::arg("length") = py::none(),
          py::arg("size") = py::none(), py::arg("surface") = py::none(), py::arg("pose") = py::make_tuple(0, 0, 0),
          py::arg("friction") = 0.0, py::arg("contact_stiffness") = py::none(),
          py::arg("tangential_stiffness") = py::none(), py::arg("contact_distance") = 0.0, py::arg("damping") = 0.0,
          py::arg("max_subdivision") = 8,
          "A solid that touches from now on: sphere, capsule and cylinder have a radius, the latter two a length along "
          "z, a box\n"
          "has a size (3,) [m], a surface (positions, triangles). The rest is that of InstrumentContactForceField")
      .def(
          "add_grip",
          [](Simulation& s, const py::object& position, const py::object& radius, const py::object& nodes,
             double stiffness, const py::object& max_force, double damping) {
            using namespace py::literals;
            return s.add_grip(py::dict("position"_a = position, "radius"_a = radius, "nodes"_a = nodes,
                                       "stiffness"_a = stiffness, "max_force"_a = max_force, "damping"_a = damping));
          },
          py::arg("position"), py::kw_only(), py::arg("radius") = py::none(), py::arg("nodes") = py::none(),
          py::arg("stiffness") = 1000.0, py::arg("max_force") = py::none(), py::arg("damping") = 0.0,
          "Open forceps at a position (3,) [m]. Closed, they hold the nodes within radius [m], of `nodes` with all "
          "their copies\n"
          "where these are given, by springs of stiffness [N/m] and dashpots [N s/m] together, with max_force [N] at "
          "most")
      .def_property_readonly(
          "instruments", [](const Simulation& s) { return py::tuple(py::cast(s.all<SolidTool>())); },
          "of add_instrument, in their order")
      .def_property_readonly(
          "grips", [](const Simulation& s) { return py::tuple(py::cast(s.all<Grip>())); },
          "of add_grip, in their order")
      .def_property_readonly("reactions", in_turn([](Simulation& s) { return s.shown_reactions(); }),
                             "(n, 3) [N] by which nodes were fixed or prescribed in the latest step; of reactions=True")
      .def("set_state", &Simulation::set_state, py::arg("positions"), py::arg("velocities"),
           "Replaces positions (n, 3) [m] and velocities (n, 3) [m/s]")
      .def("reset", &Simulation::reset, "Back to the beginning, instruments and grips too; fixed nodes stay fixed")
      .def(
          "save", in_turn([](Simulation& s) { return s.save(); }),
          "Positions, velocities, number of steps, fixed nodes, reactions, solver memory, body, instruments and grips, "
          "with\n"
          "checksums: what comes after load() has the same bits")
      .def("load", in_turn([](Simulation& s, const py::bytes& data) { s.load(data); }), py::arg("data"),
           "Takes over what save() of a simulation with the same mesh, settings, density, dt, gravity, damping,\n"
           "instruments and grips returned; its solver may be another. What is damaged or another one's is a "
           "ValueError, which\n"
           "names what differs, and changes nothing")
      .def(py::pickle(in_turn([](Simulation& s) {
                        py::list tools;
                        for (const auto& tool : s.all<Tool>())
                          tools.append(py::make_tuple(dynamic_cast<Grip*>(tool.get()) != nullptr, tool->arguments()));
                        return py::make_tuple(s.body(), s.arguments().state(), tools, s.save());
                      }),
                      [](const py::tuple& state) {
                        auto made = std::make_unique<Simulation>(state[0].cast<std::shared_ptr<Body>>(),
                                                                 Arguments::from(state[1]));
                        for (const py::handle tool : state[2]) {
                          const auto [is_grip, arguments] = tool.cast<std::pair<bool, py::dict>>();
                          is_grip ? void(made->add_grip(arguments)) : void(made->add_instrument(arguments));
                        }
                        made->load(state[3].cast<py::bytes>());
                        return made;
                      }))
      .def("fields", in_turn([](Simulation& s) { return s.get().body.fields(s.get().positions); }),
           "Fields at the present positions")
      .def("state_hash", in_turn([](Simulation& s) { return s.get().state_hash(); }),
           "16 hexadecimal digits over positions, velocities and everything plastic");
}

}  // namespace hexaplast::python
