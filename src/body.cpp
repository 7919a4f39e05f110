// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/require.hpp"
#include "body_state.hpp"
#include "device/device_body.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/saved_stream.hpp"
#include "hexaplast/material/rows.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"

namespace hexaplast {

namespace {

template <class T>
void add_array(StateHash& hash, const std::vector<T>& array) {
  hash.add(array.data(), array.size() * sizeof(T));
}

/// A threshold that has hardened, when the material's own one changes.
double moved(double threshold, double before, double now) {
  if (before == now) return threshold;
  return std::isfinite(threshold) && std::isfinite(now) ? std::max(0.0, threshold + now - before) : now;
}

// To be raised with each change of History::serialize. Members of Material and Settings are part of the identity.
constexpr std::uint32_t kSavedVersion = 10;
constexpr SavedKind kSavedBody{{'H', 'X', 'P', 'B', 'O', 'D', 'Y', '\0'}, kSavedVersion, "body"};

/// What saved members are: their names, in their order, and the words that enumerators stand for.
template <class Options>
void add_names(StateHash& hash, std::span<const Row<Options>> rows) {
  const auto add = [&](std::string_view name) { hash.add(name.data(), name.size()); };
  for (const Row<Options>& row : rows) {
    add(row.member);
    for (const std::string_view word : row.words) add(word);
  }
}

/// XXH64 of what a saved history belongs to.
std::uint64_t identity_of(const Model& model) {
  StateHash hash;
  add_names(hash, material_rows());
  add_names(hash, settings_rows());
  Archive archive([&](const void* data, std::size_t size) { hash.add(data, size); });
  PointArray positions = model.initial_mesh().positions();
  std::vector<Hexahedron> hexahedra = model.initial_mesh().hexahedra();
  archive(positions, hexahedra);
  return hash.value();
}

/// Throws InputError that names the setting which differs.
void require_settings(Archive& saved, const Settings& own) {
  Settings settings;
  serialize(saved, settings_rows(), settings);
  for (const Row<Settings>& row : settings_rows()) {
    const std::vector<double> values = row.values(own);
    if (row.values(settings) != values)
      throw InputError(fmt::format("the saved body has another {}, must be {}", row.member,
                                   row.words.empty() ? fmt::format("{}", fmt::join(values, " "))
                                                     : row.words[static_cast<std::size_t>(values[0])]));
  }
}

void serialize_materials(Archive& archive, std::vector<Material>& materials) {
  std::uint64_t count = materials.size();
  archive(count);
  if (archive.reads()) {
    if (count > archive.rest()) throw InputError(fmt::format("{} materials are announced", count));
    materials.resize(count);
  }
  for (Material& material : materials) serialize(archive, material_rows(), material);
}

/// More than the saved materials and history of a model can take.
std::size_t greatest_saved_size(const Model& model, const History& history) {
  const auto present = serialized_size([&](Archive& archive) { const_cast<History&>(history).serialize(archive); });
  const auto num_elements = static_cast<std::size_t>(model.mesh.num_elements());
  const std::size_t num_nodes = model.initial_mesh().num_nodes() + kCorners * num_elements;
  constexpr std::size_t kJoints = 6 + kCorners;  // per element, each in a call of its own
  return present + 1024 + 2 * num_nodes * sizeof(Vec3) +
         num_elements *
             (sizeof(Material) + sizeof(CornerValues) + sizeof(CornerTensors) + sizeof(int) + sizeof(ElementPoints) +
              model.maps_per_element() * sizeof(Mat3) + kJoints * (2 * sizeof(int) + sizeof(double)));
}

}  // namespace

Body::State::State(HexMesh mesh, std::vector<Material> materials, Settings settings)
    : model(std::move(mesh), std::move(materials), settings), history(model), backend(make_backend("cpu")) {}

Body::State::State(const State& other)
    : model(other.model),
      history(other.history),
      time_step(other.time_step),
      branches(other.branches),
      checked_dt(other.checked_dt),
      revision(other.revision),
      released(other.released),
      backend(make_backend(other.backend->device())),
      not_linearized_since("the body was copied") {}

std::unique_ptr<Backend> Body::State::make_backend(const std::string& device) {
  if (device != "cpu") return std::make_unique<DeviceBody>(model, history, branches, device);
  if (model.is_plain) return plain::make_backend(model, history, branches);
  return std::make_unique<KernelBackend>(model, history, branches);
}

Body::Body(HexMesh mesh, std::vector<Material> materials, Settings settings)
    : state_(std::make_unique<State>(std::move(mesh), std::move(materials), settings)) {}
Body::Body(const Body& other) : state_(std::make_unique<State>(other.state())) {}
Body::Body(Body&& other) noexcept = default;
Body& Body::operator=(Body other) noexcept {
  state_.swap(other.state_);
  return *this;
}
Body::~Body() = default;

Body::State& Body::state() {
  if (state_->is_on_device()) state_->begin_change("the history on the device was taken");
  return *state_;
}
const Body::State& Body::state() const {
  state_->backend->download();
  return *state_;
}

void Body::use_device(const std::string& name) {
  if (name == device()) return;
  if (name != "cpu")
    if (const std::string why = not_on_device(state_->model); !why.empty())
      throw InputError(fmt::format("device {}: {}", name, why));
  state_->backend->download();
  std::unique_ptr<Backend> made = state_->make_backend(name);
  if (name != "cpu") made->linearize(state_->model.mesh.positions());  // throws where there is no room
  state_->backend = std::move(made);
  ++state_->revision;
  state_->not_linearized_since = "use_device";
}
std::string Body::device() const { return state_->backend->device(); }

const HexMesh& Body::mesh() const { return state_->model.mesh; }
const std::vector<Material>& Body::materials() const { return state_->model.materials; }
const Material& Body::material(int hexahedron) const {
  state_->require_hexahedron(hexahedron);
  return state_->model.material(hexahedron);
}
const Settings& Body::settings() const { return state_->model.settings; }
bool Body::can_flow() const { return state_->model.can_flow(); }

const PointArray& Body::plastic_rest_positions() const {
  const History& history = state().history;
  return history.has_isolated_flow() ? state_->released.positions(state_->model, history)
                                     : history.plastic_rest_positions;
}
bool Body::plastic_rest_has_converged() const {
  plastic_rest_positions();
  return !state_->history.has_isolated_flow() || state_->released.report().converged;
}
std::span<const unsigned char> Body::alive() const { return state_->history.alive; }
std::span<const int> Body::removed() const { return state_->history.removed; }
std::span<const CornerValues> Body::yield_stress() const { return state().history.yield_stress; }
std::span<const CornerValues> Body::plastic_strain() const { return state().history.plastic_strain; }
const HexMesh& Body::initial_mesh() const { return state_->model.initial_mesh(); }
const Joints& Body::joints() const { return state_->model.joints(); }
const NodeCopies& Body::copies() const { return state_->model.copies; }
std::span<const int> Body::opened() const { return state_->history.opened; }
std::span<const double> Body::crossings() const { return state_->history.crossings; }
long Body::revision() const { return state_->revision; }
double Body::dissipated_energy() const { return state_->history.dissipated_energy; }

ElementPoints Body::element_rest_shape(int hexahedron) const {
  state().require_hexahedron(hexahedron);
  const ElementHistory element = state_->history.element(state_->model, hexahedron);
  ElementPoints shape;
  for (int a = 0; a < kCorners; ++a)
    shape.row(a) = (element.rotation_map[a] * element.rest_shape.row(a).transpose()).transpose();
  return about_mean(shape);
}

void Body::State::require_field(const char* call, const char* name, ConstPoints field) const {
  require_rows(call, name, field, model.mesh.num_nodes());
}

void Body::State::require_hexahedron(int hexahedron) const {
  if (hexahedron < 0 || hexahedron >= model.mesh.num_elements())
    throw InputError(fmt::format("hexahedron {} must lie in [0, {})", hexahedron, model.mesh.num_elements()));
}

void Body::State::require_linearized(const char* call) const {
  if (not_linearized_since)
    throw InputError(
        fmt::format("{}: linearize must be called first, which it was not since {}", call, not_linearized_since));
}

void Body::State::require_relaxing_step(const char* call) const {
  if (model.settings.num_branches() > 0 && std::isnan(time_step))
    throw InputError(fmt::format("{}: the body relaxes: set_time_step must be called first", call));
}

void Body::set_time_step(double dt) {
  if (!(dt >= 0)) throw InputError(fmt::format("set_time_step: dt = {} s: must lie in [0, inf]", dt));
  if (dt == state_->time_step) return;
  state_->time_step = dt;
  if (settings().num_branches() == 0) return;
  state_->branches = branch_steps(settings(), dt);
  state_->backend->forget();
  state_->not_linearized_since = "set_time_step";
}

void Body::linearize(ConstPoints x) {
  state_->require_field("linearize", "x", x);
  state_->require_relaxing_step("linearize");
  state_->backend->linearize(x);
  state_->not_linearized_since = nullptr;
}

void Body::add_force(Points f) const {
  state_->require_linearized("add_force");
  state_->require_field("add_force", "f", f);
  state_->backend->add_force(f);
}

void Body::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  state_->require_linearized("add_stiffness_product");
  state_->require_field("add_stiffness_product", "dx", dx);
  state_->require_field("add_stiffness_product", "df", df);
  state_->backend->add_product(factor, dx, df);
}

void Body::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  state_->require_linearized("add_stiffness_blocks");
  require_count("add_stiffness_blocks", "K", K.num_nodes(), state_->model.mesh.num_nodes());
  state_->backend->add_stiffness_blocks(factor, K);
}

void Body::add_operator(double factor, MatrixFreeSystem& system) const {
  state_->require_linearized("add_operator");
  state_->backend->add_operator(factor, system);
}

double Body::recovery_work(ConstPoints x) const {
  if (settings().recovery == RecoveryMode::kNone) return 0;
  state_->require_linearized("recovery_work");
  state_->require_field("recovery_work", "x", x);
  return state_->backend->find_recovery(x).spring_energy() -
         state_->backend->recovery().spring_energy_at(state_->history.plastic_rest_positions, x);
}

double Body::energy(ConstPoints x) const {
  state_->require_field("energy", "x", x);
  state_->require_relaxing_step("energy");
  return state_->backend->energy(x);
}

FlowReport Body::flow(ConstPoints x, double dt) {
  state_->require_field("flow", "x", x);
  if (dt != state_->checked_dt) {
    require_time_step(dt);
    check_time_step(state_->model.materials, state_->model.settings, dt);
    state_->checked_dt = dt;
  }
  state_->require_relaxing_step("flow");
  if (settings().num_branches() > 0 && std::isfinite(state_->time_step) && state_->time_step != dt)
    throw InputError(
        fmt::format("flow: dt = {} s: must be the time step of set_time_step, {} s", dt, state_->time_step));
  require_finite(x, "position");
  state_->not_linearized_since = "flow";
  const FlowReport report = state_->backend->flow(x, dt);
  state_->revision += report.removed > 0;
  return report;
}

void Body::remove(std::span<const int> elements) {
  for (const int e : elements) state_->require_hexahedron(e);
  state_->begin_change("remove");
  for (const int e : elements) {
    if (!state_->history.alive[e]) continue;
    state_->history.alive[e] = 0;
    state_->history.removed.push_back(e);
  }
  ++state_->revision;
}

std::vector<int> Body::open(std::span<const int> joints, std::span<const double> crossings) {
  const int count = state_->model.joints().count();
  for (const int joint : joints)
    if (joint < 0 || joint >= count) throw InputError(fmt::format("joint {} must lie in [0, {})", joint, count));
  if (!crossings.empty() && crossings.size() != joints.size())
    throw InputError(
        fmt::format("{} crossings for {} joints, must be as many, or none", crossings.size(), joints.size()));
  for (const double place : crossings)
    if (!is_crossing(place)) throw InputError(fmt::format("crossing {} must lie in [0, 1]", place));
  std::vector<int>& opened = state_->history.opened;
  std::vector<unsigned char> is_open(count, 0);
  for (const int joint : opened) is_open[joint] = 1;
  std::vector<std::pair<int, double>> added;  // and where each is crossed
  for (std::size_t k = 0; k < joints.size(); ++k)
    if (!std::exchange(is_open[joints[k]], 1)) added.emplace_back(joints[k], crossings.empty() ? 0.5 : crossings[k]);
  if (added.empty()) return {};
  state_->begin_change("open");
  std::ranges::sort(added);
  for (const auto& [joint, place] : added) {
    opened.push_back(joint);
    state_->history.crossings.push_back(place);
  }
  std::vector<int>& ends = state_->history.end_of_opening;
  ends.push_back(static_cast<int>(opened.size()));
  std::vector<int> parents = state_->model.open(state_->history, static_cast<int>(ends.size()) - 1);
  state_->history.add_nodes(parents);
  state_->renew("open");
  return parents;
}

void Body::set_materials(std::vector<Material> materials) {
  Model changed(state_->model, std::move(materials));
  state_->require_device(changed);
  History history = state().history;
  if (changed.tracks_plastic_stretch && history.plastic_stretch.empty())
    history.plastic_stretch = History(changed).plastic_stretch;
  else if (!changed.tracks_plastic_stretch)
    history.plastic_stretch.clear();
  if (changed.has_rest_shapes()) history.add_rest_shapes(changed);
  if (changed.can_flow_isolated()) history.add_plastic_inverse();
  const bool could_rotate = !history.rotation_yield.empty();
  if (changed.can_rotate && !could_rotate) history.rotation_yield = History(changed).rotation_yield;
  for (int e = 0; e < changed.mesh.num_elements(); ++e) {
    const Material &before = state_->model.material(e), &now = changed.material(e);
    for (int i = 0; i < kCorners; ++i) {
      history.yield_stress[e][i] = moved(history.yield_stress[e][i], before.yield_stress, now.yield_stress);
      if (could_rotate)
        history.rotation_yield[e][i] = moved(history.rotation_yield[e][i], before.rotation_yield, now.rotation_yield);
    }
  }
  state_->take(std::move(changed), std::move(history), "set_materials");
}

void Body::State::take(Model changed, History changed_history, const char* call) {
  const long version = history.version;
  if (model.mesh.hexahedra() == changed.mesh.hexahedra())
    std::swap(model.mesh, changed.mesh);  // who looks at its nodes and hexahedra goes on doing so
  model = std::move(changed);
  history = std::move(changed_history);
  history.version = version + 1;
  renew(call);
}

void Body::State::require_device(const Model& changed) const {
  if (!is_on_device()) return;
  if (const std::string why = not_on_device(changed); !why.empty())
    throw InputError(fmt::format("device {}: {}", backend->device(), why));
}

void Body::State::begin_change(const char* call) {
  backend->download();
  backend->forget();
  ++history.version;
  not_linearized_since = call;
}

void Body::State::renew(const char* call) {
  if (model.is_plain == backend->is_plain())
    backend->renew();
  else
    backend = make_backend("cpu");
  ++revision;
  not_linearized_since = call;
  checked_dt = kNone;
}

void Body::State::write(Archive& archive) {
  std::vector<Material> materials = model.materials;
  serialize_materials(archive, materials);
  history.serialize(archive);  // which writes, and changes nothing
}

std::pair<Model, History> Body::State::read(Archive& archive) const {
  std::vector<Material> materials;
  serialize_materials(archive, materials);
  Model read_model(model, std::move(materials));
  read_model.close();
  History read_history(read_model);
  read_history.serialize(archive);
  validate_opened(read_model, read_history);
  read_model.open(read_history, 0);
  validate(read_model, read_history);
  require_device(read_model);
  return {std::move(read_model), std::move(read_history)};
}

void Body::serialize(Archive& archive) {
  state_->backend->download();
  if (!archive.reads()) return state_->write(archive);
  auto [model, history] = state_->read(archive);
  state_->take(std::move(model), std::move(history), "serialize");
}

void Body::save(std::ostream& out) const {
  state_->backend->download();
  write_saved(out, kSavedBody, identity_of(state_->model), [&](Archive& archive) {
    Settings settings = state_->model.settings;
    hexaplast::serialize(archive, settings_rows(), settings);
    state_->write(archive);
  });
}

void Body::load(std::istream& in) {
  const std::vector<std::byte> bytes =
      read_saved(in, kSavedBody, identity_of(state_->model), greatest_saved_size(state_->model, state_->history));
  Archive contents{std::span<const std::byte>(bytes)};
  require_settings(contents, state_->model.settings);
  auto [model, history] = state_->read(contents);
  if (contents.rest() != 0) throw InputError(fmt::format("the saved body has {} bytes too many", contents.rest()));
  state_->take(std::move(model), std::move(history), "load");
}

void Body::reset() {
  if (state_->model.copies.is_split()) {
    Model initial = state_->model;
    initial.close();
    History history(initial);
    return state_->take(std::move(initial), std::move(history), "reset");
  }
  state_->begin_change("reset");
  const long version = state_->history.version;
  state_->history = History(state_->model);
  state_->history.version = version;
  ++state_->revision;
}

ElementFields Body::fields(ConstPoints x) const {
  state_->require_field("fields", "x", x);
  state_->backend->download();
  ElementFields out;
  out.plastic_strain = plastic_strains(*this);
  out.yield_stress = present_yield_stresses(*this);
  for (auto* field : {&out.volume_ratio, &out.stress_norm, &out.strain})
    field->resize(state_->model.mesh.num_elements());
  state_->backend->find_fields(x, {out.volume_ratio.data(), out.stress_norm.data(), out.strain.data()});
  return out;
}

double Body::volume(ConstPoints x) const {
  state_->require_field("volume", "x", x);
  double sum = 0;
  for (int e = 0; e < state_->model.mesh.num_elements(); ++e)
    if (state_->history.alive[e]) sum += hexaplast::volume(gather(x, state_->model.mesh.hexahedra()[e]));
  return sum;
}

double Body::initial_volume() const {
  double sum = 0;
  for (int e = 0; e < state_->model.mesh.num_elements(); ++e)
    if (state_->history.alive[e]) sum += state_->model.volume[e];
  return sum;
}

double Body::initial_volume(int hexahedron) const {
  state_->require_hexahedron(hexahedron);
  return state_->model.volume[hexahedron];
}

void Body::add_to(StateHash& hash) const {
  state_->backend->download();
  add_array(hash, state_->history.rest_shape);
  add_array(hash, state_->history.rotation_map);
  add_array(hash, state_->history.yield_stress);
  add_array(hash, state_->history.rotation_yield);
  hash.add(state_->history.plastic_rest_positions.data(),
           state_->history.plastic_rest_positions.size() * sizeof(double));
  add_array(hash, state_->history.plastic_strain);
  add_array(hash, state_->history.plastic_stretch);
  add_array(hash, state_->history.plastic_inverse);
  hash.add(&state_->history.dissipated_energy, sizeof(double));
  add_array(hash, state_->history.alive);
  add_array(hash, state_->history.removed);
  hash.add(state_->history.averaging_increment.data(), state_->history.averaging_increment.size() * sizeof(double));
  add_array(hash, state_->history.branch_strain);
  add_array(hash, state_->history.branch_stretch);
  add_array(hash, state_->history.opened);
  add_array(hash, state_->history.crossings);
  add_array(hash, state_->history.end_of_opening);
}

std::vector<double> plastic_strains(const Body& body) {
  std::vector<double> means;
  means.reserve(body.plastic_strain().size());
  for (const CornerValues& corners : body.plastic_strain()) {
    double mean = 0;
    for (const double strain : corners) mean += strain / kCorners;
    means.push_back(mean);
  }
  return means;
}

std::vector<double> present_yield_stresses(const Body& body) {
  std::vector<double> largest;
  largest.reserve(body.yield_stress().size());
  for (const CornerValues& corners : body.yield_stress())
    largest.push_back(*std::max_element(corners.begin(), corners.end()));
  return largest;
}

std::vector<double> element_volumes(const Body& body, ConstPoints x) {
  require_rows("element_volumes", "x", x, body.mesh().num_nodes());
  const std::vector<Hexahedron>& hexahedra = body.mesh().hexahedra();
  std::vector<double> volumes(hexahedra.size(), 0);
  for (std::size_t e = 0; e < volumes.size(); ++e)
    if (body.alive()[e]) volumes[e] = volume(gather(x, hexahedra[e]));
  return volumes;
}

std::vector<double> plastic_volume_ratios(const Body& body) {
  // of isolated rest shapes the mesh, whose volumes flow keeps
  std::vector<double> ratios = element_volumes(body, body.state().history.plastic_rest_positions);
  for (std::size_t e = 0; e < ratios.size(); ++e) ratios[e] /= body.initial_volume(static_cast<int>(e));
  return ratios;
}

}  // namespace hexaplast
