// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/hexahedral_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "base/memory.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/material/material.hpp"
#include "hexaplast/mesh/quality.hpp"
#include "mesh/lumped_mass.hpp"
#include "model_check.hpp"
#include "plastic/fracture.hpp"

namespace hexaplast::parts {
namespace {

/// The joints that have been opened, call by call: numbers of nodes depend on the calls.
struct Openings {
  explicit Openings(const Body& body)
      : joints(body.opened().begin(), body.opened().end()),
        crossings(body.crossings().begin(), body.crossings().end()),
        ends(body.state().history.end_of_opening) {}

  std::size_t begin_of(std::size_t call) const { return call == 0 ? 0 : static_cast<std::size_t>(ends[call - 1]); }

  bool begins_as(const Openings& other, std::size_t num_calls) const {
    return std::equal(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(num_calls), other.ends.begin()) &&
           std::equal(joints.begin(), joints.begin() + static_cast<std::ptrdiff_t>(begin_of(num_calls)),
                      other.joints.begin());
  }

  void open_from(std::size_t first_call, Body& body) const {
    for (std::size_t call = first_call; call < ends.size(); ++call) {
      const std::size_t begin = begin_of(call), count = begin_of(call + 1) - begin;
      body.open(std::span(joints).subspan(begin, count), std::span(crossings).subspan(begin, count));
    }
  }

  std::vector<int> joints;
  std::vector<double> crossings;
  std::vector<int> ends;
};

/// What a device refuses is an error of the attribute.
template <class Call>
void for_device(const std::string& device, const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    const std::string text = error.what(), refused = fmt::format("device {}: ", device);
    if (!text.starts_with(refused)) throw;
    throw OptionError("device", fmt::format("= '{}': {}", device, text.substr(refused.size())));
  }
}

bool are_same(const std::vector<Material>& some, const std::vector<Material>& others) {
  const auto is_same = [](const Material& one, const Material& other) {
    return std::ranges::all_of(material_rows(),
                               [&](const Row<Material>& row) { return row.at.get(one) == row.at.get(other); });
  };
  return std::ranges::equal(some, others, is_same);
}

}  // namespace

void set_values(const Row<Material>& row, std::span<const double> values, std::size_t num_hexahedra,
                std::vector<Material>& materials) {
  check_values(row, values, num_hexahedra, "hexahedron");
  if (values.size() > materials.size()) materials.resize(values.size(), Material(materials.front()));
  for (std::size_t e = 0; e < materials.size(); ++e) row.at.set(materials[e], values[values.size() == 1 ? 0 : e]);
}

void set_values(const Row<Settings>& row, std::span<const double> values, Settings& settings) {
  for (const double value : values) check_admissible(row, value);
  row.set_values(settings, values);
}

void fill_partly(std::span<const double> fill, std::vector<Material>& materials) {
  if (fill.empty()) return;
  materials.resize(fill.size(), Material(materials.front()));
  for (std::size_t e = 0; e < fill.size(); ++e) materials[e] = filled(materials[e], fill[e]);
}

bool are_of_density(double density, ConstPoints rest, std::span<const Hexahedron> hexahedra,
                    std::span<const double> masses) {
  const Eigen::Map<const Eigen::VectorXd> given(masses.data(), std::ssize(masses));
  const Eigen::VectorXd found =
      density * nodal_masses(static_cast<int>(rest.rows()), hexahedra, element_volumes(rest, hexahedra));
  return found.size() == given.size() && (found - given).cwiseAbs().maxCoeff() <= 1e-9 * given.maxCoeff();
}

HexahedralBody::HexahedralBody(ConstPoints rest, const std::vector<Hexahedron>& hexahedra,
                               HexahedralBodyOptions options, double dt)
    : dt_(dt), body_(made(rest, hexahedra, std::move(options))) {
  warn(check_shapes(quality(body_.mesh())));
  body_.set_time_step(dt);
}

Body HexahedralBody::made(ConstPoints rest, const std::vector<Hexahedron>& hexahedra, HexahedralBodyOptions options) {
  check(options, dt_);
  const auto count = static_cast<double>(hexahedra.size());
  memory_ = grant_memory(fmt::format("a body of {:.10g} hexahedra", count),
                         count * bytes_per_hexahedron(options.materials, options.settings));
  Body body(HexMesh(rest, hexahedra), std::move(options.materials), options.settings);
  for_device(options.device, [&] { body.use_device(options.device); });
  return body;
}

void HexahedralBody::check(const HexahedralBodyOptions& options, double dt) {
  validate(options.materials, Names::kScenes);
  validate(options.settings, Names::kScenes);
  validate(options.materials, options.settings, Names::kScenes);
  warn(check_time_step(options.materials, options.settings, dt, Names::kScenes));
  warn(fracture_warnings(options.materials, options.settings, Names::kScenes));
  warn(idle_option_warnings(options.settings, Names::kScenes));
  dt_ = dt;
}

void HexahedralBody::warn(const std::vector<std::string>& texts) {
  for (const std::string& text : texts) warnings_.push_back({{}, text});
}

void HexahedralBody::set_options(HexahedralBodyOptions options, double dt) {
  OptionErrors errors;
  for (const Row<Settings>& row : settings_rows())
    if (row.values(options.settings) != row.values(body_.settings()))
      errors.add({row.name, "cannot change during a run, only members of the material can"});
  if (options.device != body_.device()) errors.add({"device", "cannot change during a run"});
  errors.throw_all();
  check(options, dt);
  if (are_same(options.materials, body_.materials())) return;
  for_device(body_.device(), [&] { body_.set_materials(std::move(options.materials)); });
}

std::vector<Remark> HexahedralBody::take_warnings() { return std::exchange(warnings_, {}); }

void HexahedralBody::end_step(ConstPoints x, double dt) {
  if (dt != dt_) check_time_step(body_.materials(), body_.settings(), dt, Names::kScenes);
  dt_ = dt;
  report_ = body_.flow(x, dt);
}

void HexahedralBody::reset() {
  body_.reset();
  report_ = {};
  num_announced_ = 0;
}

void HexahedralBody::reset_but_cuts() {
  const Openings openings(body_);
  reset();
  openings.open_from(0, body_);
}

bool HexahedralBody::load_but_cuts(std::istream& in) {
  const Openings before(body_);
  std::stringstream present;
  body_.save(present);
  body_.load(in);
  const Openings loaded(body_);
  const std::size_t num_common = std::min(before.ends.size(), loaded.ends.size());
  if (!before.begins_as(loaded, num_common)) {
    body_.load(present);
    throw InputError("other joints of it are open than those that its nodes have split at, which do not join again");
  }
  before.open_from(num_common, body_);
  return before.ends.size() > num_common;
}

void HexahedralBody::serialize(Archive& archive) {
  body_.serialize(archive);
  archive(report_.yielded, report_.inverted, report_.skipped, report_.repaired, report_.rolled_back, report_.removed,
          report_.worst_volume_error, report_.averaging.skipped, report_.averaging.fell_back,
          report_.averaging.iterations, report_.averaging.residual, report_.averaging.converged);
  if (archive.reads()) report_.torn.clear();  // which have opened
  num_announced_ = body_.removed().size();
}

bool HexahedralBody::may_open() const { return may_tear(body_.materials(), body_.settings()); }

std::span<const int> HexahedralBody::take_removed() {
  const std::span<const int> gone = body_.removed().subspan(num_announced_);
  num_announced_ += gone.size();
  return gone;
}

}  // namespace hexaplast::parts
