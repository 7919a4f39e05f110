// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/text.hpp"
#include "model_check.hpp"
#include "runner/command.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/simulation.hpp"
#include "runner/run/staging.hpp"
#include "runner/subcommand.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

constexpr long kMaxMoments = 200;  // of a run, at which loads are looked at

/// What the report says of the scene around the body.
struct Findings {
  int num_nodes = 0;
  long num_held = 0;         // nodes whose three directions are held
  long num_partly_held = 0;  // nodes of which some directions are
  double loads_time = 0;     // [s] at which the loads are largest
  long num_loaded = 0;       // nodes on which forces act then
  Vec3 load = Vec3::Zero();  // [N] their sum
  double load_size = 0;      // [N] the sum of their sizes
  double dt = 0;             // [s]
  Vec3 gravity;              // [m/s^2]
  std::optional<int> steps;  // of the scene's RunSettings
  double memory = 0;         // [byte] most that the process has held
  struct Body {
    std::string name;
    ModelCheck model;
  };
  std::vector<Body> bodies;
  int num_hexahedra = 0;
  std::vector<RegionFigure> regions;
  std::vector<std::string> warnings;  // but what was remarked before: check_shapes, size_warnings
};

/// Whether something is between the state, or one that follows it, and another state: that one may hold it.
bool is_joined(const scene::Node& root, const scene::MechanicalState& state) {
  const auto is_between = [&](std::array<scene::MechanicalState*, 2> states) {
    return states[0] != states[1] && (states[0] == &state || states[1] == &state);
  };
  return std::ranges::any_of(root.all<scene::Interaction>(),
                             [&](const auto* join) { return is_between(join->states()); }) ||
         std::ranges::any_of(root.all<scene::InteractionProjectiveConstraint>(),
                             [&](const auto* join) { return is_between(join->states()); }) ||
         std::ranges::any_of(root.all<scene::Mapping>(), [&](const scene::Mapping* mapping) {
           return mapping->output() && mapping->input() == &state && is_joined(root, *mapping->output());
         });
}

/// Whether springs hold the state, or one that follows it, against a translation.
bool is_held(const scene::Node& root, scene::MechanicalState& state, const Vec3& along) {
  const PointArray dx = along.transpose().replicate(state.num_nodes(), 1);
  PointArray df = PointArray::Zero(state.num_nodes(), 3);
  for (const scene::ForceField* field : root.all<scene::ForceField>())
    if (!field->body() && !field->is_one_sided() && !dynamic_cast<const scene::Load*>(field) &&
        scene::acts_on(*field, state))
      field->add_stiffness_product(1, dx, df);
  return !df.isZero(0) || std::ranges::any_of(root.all<scene::Mapping>(), [&](const scene::Mapping* mapping) {
    return mapping->input() == &state && is_held(root, *mapping->output(), along);
  });
}

/// [kg] of the state and of those that follow it.
double moved_mass(scene::Node& root, scene::MechanicalState& state) {
  double mass = scene::total_mass(scene::masses_of(root, state), state);
  for (const scene::Mapping* mapping : root.all<scene::Mapping>())
    if (mapping->input() == &state) mass += moved_mass(root, *mapping->output());
  return mass;
}

/// Time [s] of the first step at which the loads on a state are largest, among `num_steps`, and their size [N] then.
std::pair<double, double> greatest_loads(scene::Scene& scene, scene::MechanicalState& state, long num_steps) {
  const long stride = (num_steps + kMaxMoments - 1) / kMaxMoments;
  double greatest = -1, found = 0, time = 0;
  for (long step = 0; step < num_steps; ++step, time += scene.dt()) {
    if (step % stride != 0) continue;
    const double size = loads_at(time, scene, state).rowwise().norm().sum();
    if (size <= greatest * (1 + 1e-12)) continue;  // what is held is held within rounding
    greatest = size;
    found = time;
  }
  return {found, greatest};
}

/// Rejects the scene for what step 1 would end with. Last of all: what a step begins with is done.
void try_step(scene::Scene& scene, Findings& found) {
  begin_step(scene.root());
  for (scene::OdeSolver* solver : scene::integrators_of(scene))
    if (solver->try_step(found.loads_time, found.dt).at_threshold)
      found.warnings.push_back(
          fmt::format("the linear solver of {} '{}' stops at its threshold above its tolerance: {}",
                      solver->class_name(), solver->name(), kThresholdRemedy));
}

Findings look_at(scene::Scene& scene) {
  Findings found;
  found.dt = scene.dt();
  found.gravity = scene.root().clock().gravity;
  if (scene::Component* settings = find_settings(scene); settings && settings->is_given("steps"))
    found.steps = settings->integer("steps");

  // at the moment at which the loads on some state are largest
  const std::vector<scene::MechanicalState*> states = scene::moving_states(scene);
  const long num_steps = std::max(found.steps.value_or(1), 1);
  for (scene::MechanicalState* state : states) {
    const auto [time, size] = greatest_loads(scene, *state, num_steps);
    if (size > found.load_size) {
      found.loads_time = time;
      found.load_size = size;
    }
  }
  found.load_size = 0;
  bool is_pushed = false;
  for (scene::MechanicalState* state : states) {
    const Eigen::ArrayXd directions = view::free_directions(scene, *state).rowwise().sum();
    const long num_held = (directions == 0).count(), num_free = (directions == 3).count();
    const PointArray loads = loads_at(found.loads_time, scene, *state);
    const Vec3 load = loads.colwise().sum().transpose();
    const double size = loads.rowwise().norm().sum();
    found.num_nodes += state->num_nodes();
    found.num_held += num_held;
    found.num_partly_held += state->num_nodes() - num_held - num_free;
    found.num_loaded += (loads.rowwise().norm().array() > 0).count();
    found.load += load;
    found.load_size += size;
    const bool is_out_of_balance = load.norm() > 1e-9 * size;  // more than rounding
    is_pushed = is_pushed || (is_out_of_balance && num_free == state->num_nodes() && !is_joined(scene.root(), *state) &&
                              !is_held(scene.root(), *state, load));
  }

  for (const scene::SceneBody& body : scene::bodies_of(scene)) {
    const ModelCheck& model =
        found.bodies
            .emplace_back(Findings::Body{
                body.name, check_model(*body.field->body(), moved_mass(scene.root(), *body.state), found.dt)})
            .model;
    found.num_hexahedra += body.field->body()->mesh().num_elements();
    std::ranges::copy(model_warnings(model, Names::kScenes), std::back_inserter(found.warnings));
  }
  try_step(scene, found);
  found.regions = regions_of(scene);
  if (is_pushed) found.warnings.push_back("no node is fixed, and the loads do not balance: the body moves away");

  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  found.memory = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return found;
}

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// What never happens is infinite, which is null in the text of JSON.
Json json_of(const ModelCheck& body) {
  return {{"implementation", body.is_plain ? "plain" : "kernels"},
          {"parts", body.num_parts},
          {"extent", json_of(body.extent)},
          {"volume", body.volume},
          {"least_scaled_jacobian", body.quality.min_scaled_jacobian},
          {"inside_out", body.quality.num_inverted},
          {"worst_hexahedron", body.quality.worst_element},
          {"shortest_edge", body.quality.shortest_edge},
          {"longest_edge", body.quality.longest_edge},
          {"mass", body.mass},
          {"density", body.density},
          {"young_modulus", {body.min_young_modulus, body.max_young_modulus}},
          {"poisson_ratio", {body.min_poisson_ratio, body.max_poisson_ratio}},
          {"yield_stress", body.yield_stress},
          {"yield_strain", body.yield_strain},
          {"rotation_yield", body.rotation_yield},
          {"flow_per_step", body.flow_per_step},
          {"rotation_flow_per_step", body.rotation_flow_per_step},
          {"restitution_per_step", body.restitution_per_step},
          {"wave_speed", body.wave_speed},
          {"highest_frequency", body.highest_frequency},
          {"edges_per_step", body.cfl_number},
          {"steps_across", body.steps_across}};
}

Json json_of(const std::vector<RegionFigure>& regions) {
  Json list = Json::array();
  for (const RegionFigure& region : regions) {
    Json values = Json::object();
    for (const RegionFigure::Value& value : region.values) values[std::string(value.name)] = {value.min, value.max};
    list.push_back({{"path", region.path}, {"hexahedra", region.num_hexahedra}, {"values", values}});
  }
  return list;
}

Json json_of(const Findings& found) {
  std::vector<std::string> warnings = found.warnings;
  Json bodies = Json::array();
  for (const Findings::Body& body : found.bodies) {
    std::ranges::copy(check_shapes(body.model.quality), std::back_inserter(warnings));
    std::ranges::copy(size_warnings(body.model, found.gravity), std::back_inserter(warnings));
    bodies.push_back(json_of(body.model));
    bodies.back()["name"] = body.name;
  }
  return {{"nodes", found.num_nodes},
          {"hexahedra", found.num_hexahedra},
          {"held_nodes", found.num_held},
          {"partly_held_nodes", found.num_partly_held},
          {"loaded_nodes", found.num_loaded},
          {"load", json_of(found.load)},
          {"load_time", found.loads_time},
          {"dt", found.dt},
          {"steps", found.steps ? Json(*found.steps) : Json(nullptr)},
          {"memory_bytes", found.memory},
          {"body", found.bodies.size() == 1 ? json_of(found.bodies[0].model) : Json(nullptr)},
          {"bodies", bodies},
          {"regions", json_of(found.regions)},
          {"warnings", warnings}};
}

void print(const ModelCheck& body) {
  fmt::print("  size                {:.4g} x {:.4g} x {:.4g} m, {:.4g} m^3, {} part{}\n", body.extent.x(),
             body.extent.y(), body.extent.z(), body.volume, body.num_parts, body.num_parts == 1 ? "" : "s");
  fmt::print("  shape               min scaled Jacobian {:.3f} (hexahedron {}), edges {} m\n",
             body.quality.min_scaled_jacobian, body.quality.worst_element,
             min_to_max(body.quality.shortest_edge, body.quality.longest_edge));
  fmt::print("  material            E {} Pa, nu {}\n", min_to_max(body.min_young_modulus, body.max_young_modulus),
             min_to_max(body.min_poisson_ratio, body.max_poisson_ratio));
  const bool yields = std::isfinite(body.yield_stress), turns = std::isfinite(body.rotation_yield);
  fmt::print("  yield               {}\n",
             yields ? fmt::format("stress {:.6g} Pa, strain {:.4g}", body.yield_stress, body.yield_strain) : "never");
  fmt::print("  rotation yield      {}\n", turns ? fmt::format("{:.4g} rad", body.rotation_yield) : "never");
  if (yields || turns)
    fmt::print("  rates times dt      flow {:.4g}, rotation flow {:.4g}, volume restitution {:.4g}\n",
               body.flow_per_step, body.rotation_flow_per_step, body.restitution_per_step);
  if (body.is_plain) fmt::print("  implementation      plain, in double precision and without multigrid\n");
  if (body.wave_speed > 0) {
    fmt::print("  mass                {:.6g} kg, {:.6g} kg/m^3\n", body.mass, body.density);
    fmt::print("  waves               {:.4g} m/s, CFL number {:.3g}, across the body in {:.3g} steps\n",
               body.wave_speed, body.cfl_number, body.steps_across);
  }
}

void print(const Findings& found, const std::string& title) {
  fmt::print("{}: can run\n", printable_line(title));
  fmt::print("  nodes               {}, of which {} are fixed and {} partly fixed\n", found.num_nodes, found.num_held,
             found.num_partly_held);
  fmt::print("  hexahedra           {}\n", found.num_hexahedra);
  for (const Findings::Body& body : found.bodies) {
    if (found.bodies.size() > 1) fmt::print("  body                {}\n", printable_line(body.name));
    print(body.model);
  }
  for (const RegionFigure& region : found.regions)
    fmt::print("  region              {}: {}\n", printable_line(region.path), describe(region));
  fmt::print("  loads               on {} nodes, together ({:.4g}, {:.4g}, {:.4g}) N at t = {:.4g} s\n",
             found.num_loaded, found.load.x(), found.load.y(), found.load.z(), found.loads_time);
  fmt::print("  steps               {} of {:.6g} s\n", found.steps ? std::to_string(*found.steps) : "set by --steps",
             found.dt);
  fmt::print("  memory              {:.1f} MB\n", found.memory / 1e6);
}

struct CheckOptions {
  SceneOptions scene;
  bool json = false;
};

/// Reads, resolves and initialises a scene as a run does, and prints what it means without stepping; logs a warning for
/// what is legal but unwise.
void check(const CheckOptions& options) {
  scene::Scene scene = load_scene(options.scene);
  const Findings found = look_at(scene);
  const std::string file = options.scene.file.string();
  if (options.json) {
    fmt::print("{}\n", printable(json_of(found).dump(2)));
  } else {
    print(found, options.scene.file.stem().string());
  }
  flush_standard_output();
  log_warnings(scene);  // of the step that was tried
  for (const std::string& sentence : found.warnings)
    spdlog::warn("{}", scene::format({scene::Severity::kWarning, {file, 0}, sentence}));
}

}  // namespace

void add_check(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "check", "Read a scene as run does and print a model check, without a step", check,
                     [](const CheckOptions& given) { return given.scene.file.string(); });
  add_scene(command, options.scene);
  command.add_flag("--json", options.json, "As JSON");
}

}  // namespace hexaplast::runner
