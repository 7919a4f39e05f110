// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <istream>
#include <ostream>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/finite.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/base/require.hpp"
#include "hexaplast/kinematics/gradients.hpp"
#include "hexaplast/kinematics/polar.hpp"
#include "hexaplast/material/corotated.hpp"
#include "hexaplast/plastic/point_flow.hpp"

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

constexpr std::array<char, 8> kSavedMagic = {'H', 'X', 'P', 'B', 'O', 'D', 'Y', '\0'};
constexpr std::uint32_t kSavedVersion = 1;

/// XXH64 of what a saved history belongs to.
std::uint64_t identity_of(const Model& model) {
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) { hash.add(data, size); });
  PointArray positions = model.mesh.positions();
  std::vector<Hexahedron> hexahedra = model.mesh.hexahedra();
  Settings settings = model.settings;
  archive(positions, hexahedra, settings.gradient, settings.yield_norm, settings.rotation, settings.rotation_frame,
          settings.averaging, settings.averaging_steps, settings.averaging_tolerance, settings.precision,
          settings.volume_restitution, settings.inversion_threshold);
  return hash.value();
}

void serialize_materials(Archive& archive, std::vector<Material>& materials) {
  std::uint64_t count = materials.size();
  archive(count);
  if (archive.reads()) {
    if (count > archive.rest()) throw InputError(fmt::format("{} materials are announced", count));
    materials.resize(count);
  }
  for (Material& m : materials)
    archive(m.young_modulus, m.poisson_ratio, m.yield_stress, m.flow_rate, m.rotation_yield, m.rotation_flow_rate,
            m.hardening, m.fracture_stress, m.fracture_stretch);
}

/// More than the saved materials and history of a model can take.
std::size_t greatest_saved_size(const Model& model, const History& history) {
  const auto present = serialized_size([&](Archive& archive) { const_cast<History&>(history).serialize(archive); });
  const auto num_elements = static_cast<std::size_t>(model.mesh.num_elements());
  return present + 1024 +
         num_elements * (sizeof(Material) + sizeof(CornerValues) + sizeof(CornerTensors) + sizeof(int));
}

void read_exactly(std::istream& in, void* data, std::size_t size) {
  in.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
  if (static_cast<std::size_t>(in.gcount()) != size)
    throw InputError(fmt::format("a saved body ends {} bytes too early", size - static_cast<std::size_t>(in.gcount())));
}

}  // namespace

PreconditionedConjugateGradients averaging_solver(const Model& model) {
  return {model.settings.averaging_residual(), kAveragingIterations, Preconditioner::kMultigrid};
}

Body::Body(HexMesh mesh, std::vector<Material> materials, Settings settings)
    : model_(std::move(mesh), std::move(materials), settings),
      history_(model_),
      at_(model_),
      averaging_solver_(averaging_solver(model_)) {
  if (model_.can_flow()) flow_.emplace(model_, history_);
}

void Body::require_field(const char* call, const char* name, ConstPoints field) const {
  require_rows(call, name, field, model_.mesh.num_nodes());
}

void Body::require_linearized(const char* call) const {
  if (not_linearized_since_)
    throw InputError(
        fmt::format("{}: linearize must be called first, which it was not since {}", call, not_linearized_since_));
}

void Body::linearize(ConstPoints x) {
  require_field("linearize", "x", x);
  hexaplast::linearize(model_, history_, x, at_);
  not_linearized_since_ = nullptr;
}

void Body::add_force(Points f) const {
  require_linearized("add_force");
  require_field("add_force", "f", f);
  hexaplast::add_force(model_, at_, f);
}

void Body::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  require_linearized("add_stiffness_product");
  require_field("add_stiffness_product", "dx", dx);
  require_field("add_stiffness_product", "df", df);
  hexaplast::add_stiffness_product(model_, at_, factor, dx, product_, df);
}

void Body::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  require_linearized("add_stiffness_blocks");
  require_count("add_stiffness_blocks", "K", K.num_nodes(), model_.mesh.num_nodes());
  hexaplast::add_stiffness_blocks(model_, at_, factor, K);
}

void Body::to_kernels(double factor, KernelSystem& system) const {
  require_linearized("to_kernels");
  KernelBody& body = system.bodies.emplace_back();
  body.factor = -factor;  // L = - df/dx
  body.double_operator = std::get_if<ElementOperator<double, double>>(&at_.op);
  if (const auto* half = std::get_if<ElementOperator<float, Half>>(&at_.op)) body.single_operator = half;
  if (const auto* single = std::get_if<ElementOperator<float, float>>(&at_.op)) body.single_operator = single;
  if (body.single_operator) {
    exact_.refer_to(model_, at_);
    body.exact_operator = &exact_;
  }
  if (!system.wants_coarse) return;
  if (!hierarchy_) hierarchy_.emplace(model_);
  body.coarse = hierarchy_->update(model_, at_);
}

double Body::energy(ConstPoints x) const {
  require_field("energy", "x", x);
  return hexaplast::energy(model_, history_, x, product_);
}

FlowReport Body::flow(ConstPoints x, double dt) {
  require_field("flow", "x", x);
  if (dt != checked_dt_) {
    if (!(dt > 0) || !std::isfinite(dt)) throw InputError(fmt::format("dt = {} s: must be in (0, inf)", dt));
    // a body without yield is at rest in its original shape for ever: no limit of the plastic step concerns it
    if (model_.can_flow()) check_time_step(model_.materials, model_.settings, dt);
    checked_dt_ = dt;
  }
  require_finite(x, "position");
  not_linearized_since_ = "flow";
  if (mostly_flows_)
    set_positions(model_, history_, x, at_);
  else
    hexaplast::linearize(model_, history_, x, at_);
  if (!flow_) return count_inverted(model_, at_);
  const FlowReport report = hexaplast::flow(model_, at_, dt, averaging_solver_, history_, *flow_);
  mostly_flows_ = 2 * report.yielded > model_.mesh.num_elements();
  return report;
}

void Body::remove(std::span<const int> elements) {
  for (const int e : elements)
    if (e < 0 || e >= model_.mesh.num_elements())
      throw InputError(fmt::format("hexahedron {} must lie in [0, {})", e, model_.mesh.num_elements()));
  not_linearized_since_ = "remove";
  for (const int e : elements) {
    if (!history_.alive[e]) continue;
    history_.alive[e] = 0;
    history_.removed.push_back(e);
  }
  ++history_.version;
}

void Body::set_materials(std::vector<Material> materials) {
  Model changed(model_, std::move(materials));
  History history = history_;
  if (changed.tracks_plastic_stretch && history.plastic_stretch.empty())
    history.plastic_stretch = History(changed).plastic_stretch;
  else if (!changed.tracks_plastic_stretch)
    history.plastic_stretch.clear();
  const bool could_rotate = !history.rotation_yield.empty();
  if (changed.can_rotate && !could_rotate) history.rotation_yield = History(changed).rotation_yield;
  for (int e = 0; e < changed.mesh.num_elements(); ++e) {
    const Material &before = model_.material(e), &now = changed.material(e);
    for (int i = 0; i < kCorners; ++i) {
      history.yield_stress[e][i] = moved(history.yield_stress[e][i], before.yield_stress, now.yield_stress);
      if (could_rotate)
        history.rotation_yield[e][i] = moved(history.rotation_yield[e][i], before.rotation_yield, now.rotation_yield);
    }
  }
  take(std::move(changed), std::move(history), "set_materials");
}

void Body::take(Model model, History history, const char* call) {
  const long version = history_.version;
  model_ = std::move(model);
  history_ = std::move(history);
  history_.version = version + 1;  // what was derived from the old history is old
  at_ = Linearization(model_);
  not_linearized_since_ = call;
  flow_.reset();
  if (model_.can_flow()) flow_.emplace(model_, history_);
  mostly_flows_ = false;
  checked_dt_ = 0;
  hierarchy_.reset();
}

void Body::write(Archive& archive) const {
  std::vector<Material> materials = model_.materials;
  serialize_materials(archive, materials);
  const_cast<History&>(history_).serialize(archive);  // which writes, and changes nothing
}

std::pair<Model, History> Body::read(Archive& archive) const {
  std::vector<Material> materials;
  serialize_materials(archive, materials);
  Model model(model_, std::move(materials));
  History history(model);
  history.serialize(archive);
  validate(model, history);
  return {std::move(model), std::move(history)};
}

void Body::serialize(Archive& archive) {
  if (!archive.reads()) return write(archive);
  auto [model, history] = read(archive);
  take(std::move(model), std::move(history), "serialize");
}

void Body::save(std::ostream& out) const {
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) {
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    hash.add(data, size);
  });
  std::array<char, 8> magic = kSavedMagic;
  std::uint32_t version = kSavedVersion;
  std::uint64_t identity = identity_of(model_), size = serialized_size([&](Archive&counting) { write(counting); });
  archive(magic, version, identity, size);
  write(archive);
  std::uint64_t checksum = hash.value();
  archive(checksum);
  if (!out) throw InputError("the stream does not take a saved body");
}

void Body::load(std::istream& in) {
  std::array<std::byte, sizeof kSavedMagic + sizeof kSavedVersion + 2 * sizeof(std::uint64_t)> header;
  read_exactly(in, header.data(), header.size());
  std::array<char, 8> magic;
  std::uint32_t version = 0;
  std::uint64_t identity = 0, size = 0, checksum = 0;
  Archive head{std::span<const std::byte>(header)};
  head(magic, version, identity, size);
  if (magic != kSavedMagic) throw InputError("this is no saved body");
  if (version != kSavedVersion)
    throw InputError(fmt::format("the saved body has format version {}, must be {}", version, kSavedVersion));
  if (identity != identity_of(model_)) throw InputError("the saved body has another mesh or other settings");
  if (size > greatest_saved_size(model_, history_))
    throw InputError(fmt::format("the saved body is damaged: {} bytes are announced", size));

  std::vector<std::byte> bytes(size);
  read_exactly(in, bytes.data(), bytes.size());
  read_exactly(in, &checksum, sizeof checksum);
  StateHash hash;
  hash.add(header.data(), header.size());
  hash.add(bytes.data(), bytes.size());
  if (hash.value() != checksum) throw InputError("the saved body is damaged: its checksum does not fit");

  Archive contents{std::span<const std::byte>(bytes)};
  auto [model, history] = read(contents);
  if (contents.rest() != 0) throw InputError(fmt::format("the saved body has {} bytes too many", contents.rest()));
  take(std::move(model), std::move(history), "load");
}

void Body::reset() {
  const long version = history_.version;
  history_ = History(model_);
  history_.version = version + 1;  // what was derived from the old history is old
  not_linearized_since_ = "reset";
  if (flow_) flow_.emplace(model_, history_);
}

ElementFields Body::fields(ConstPoints x) const {
  require_field("fields", "x", x);
  const int num_elements = model_.mesh.num_elements();
  ElementFields out;
  for (auto* field : {&out.plastic_strain, &out.yield_stress, &out.volume_ratio, &out.stress_norm, &out.strain})
    field->resize(num_elements);

  parallel_for(num_elements, [&](int e) {
    const auto& plastic_strain = history_.plastic_strain[e];
    const auto& yield_stress = history_.yield_stress[e];
    for (const double strain : plastic_strain) out.plastic_strain[e] += strain / kCorners;
    out.yield_stress[e] = *std::max_element(yield_stress.begin(), yield_stress.end());
    if (!history_.alive[e]) return;

    const Hexahedron& corners = model_.mesh.hexahedra()[e];
    const RestOperator rest = rest_operator(gather(history_.material, corners), model_.settings.gradient);
    out.volume_ratio[e] = rest.volume / model_.volume[e];
    for (const Mat3& F : deformation_gradients(rest, gather(x, corners))) {
      const SignedSvd svd = signed_svd(F);
      out.stress_norm[e] =
          std::max(out.stress_norm[e], stress_norm(stress(polar(svd).S, model_.lame[e]), model_.settings.yield_norm));
      out.strain[e] = std::max(out.strain[e], (svd.d.array() - 1).abs().maxCoeff());
    }
  });
  return out;
}

double Body::volume(ConstPoints x) const {
  require_field("volume", "x", x);
  double sum = 0;
  for (int e = 0; e < model_.mesh.num_elements(); ++e)
    if (history_.alive[e]) sum += hexaplast::volume(gather(x, model_.mesh.hexahedra()[e]));
  return sum;
}

double Body::original_volume() const {
  double sum = 0;
  for (int e = 0; e < model_.mesh.num_elements(); ++e)
    if (history_.alive[e]) sum += model_.volume[e];
  return sum;
}

void Body::add_to(StateHash& hash) const {
  add_array(hash, history_.rest_shape);
  add_array(hash, history_.rotation_map);
  add_array(hash, history_.yield_stress);
  add_array(hash, history_.rotation_yield);
  hash.add(history_.material.data(), history_.material.size() * sizeof(double));
  add_array(hash, history_.plastic_strain);
  add_array(hash, history_.plastic_stretch);
  hash.add(&history_.dissipated_energy, sizeof(double));
  add_array(hash, history_.alive);
  add_array(hash, history_.removed);
  hash.add(history_.averaging_increment.data(), history_.averaging_increment.size() * sizeof(double));
}

}  // namespace hexaplast
