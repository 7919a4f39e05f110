// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "parts/material_region.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// In scenes: HexahedronElastoplasticFEMForceField, whose attributes are the rows of Material and Settings.
struct HexahedralBodyOptions {
  std::vector<Material> materials = {Material()};  ///< one, or one per hexahedron
  Settings settings = {};
  std::string device = "cpu";  ///< Body::use_device
};

/// Gives all materials the values of one member, one or one per hexahedron. Throws OptionError for another number of
/// them, and for values that the row does not admit.
void set_values(const Row<Material>& row, std::span<const double> values, std::size_t num_hexahedra,
                std::vector<Material>& materials);
void set_values(const Row<Settings>& row, std::span<const double> values, Settings& settings);

/// Leaves of each hexahedron the fraction that is full.
void fill_partly(std::span<const double> fill, std::vector<Material>& materials);

/// Options from what a host has for attributes. given(row): the values of a member, none where it has its default; of a
/// word its place among those of the row. fill: fraction of each hexahedron that is full; empty: all are. regions:
/// later ones over earlier ones. Throws OptionError with all that is wrong, including what
/// `given` throws.
template <class Given>
HexahedralBodyOptions body_options(const Given& given, std::string device, std::size_t num_hexahedra,
                                   std::span<const double> fill, std::span<const MaterialRegion> regions = {}) {
  HexahedralBodyOptions options{.device = std::move(device)};
  OptionErrors errors;
  for (const Row<Settings>& row : settings_rows())
    errors.collect([&] {
      if (const std::optional<std::vector<double>> values = given(row)) set_values(row, *values, options.settings);
    });
  for (const Row<Material>& row : material_rows())
    errors.collect([&] {
      if (const std::optional<std::vector<double>> values = given(row))
        set_values(row, *values, num_hexahedra, options.materials);
    });
  errors.throw_all();
  for (const MaterialRegion& region : regions) apply(region, num_hexahedra, options.materials);
  fill_partly(fill, options.materials);
  return options;
}

/// Whether nodal masses are, to rounding, those of a density [kg/m^3] in hexahedra: each has its mass then, and keeps
/// it where nodes split.
bool are_of_density(double density, ConstPoints rest, std::span<const Hexahedron> hexahedra,
                    std::span<const double> masses);

/// A body and what hosts need around it: checks before it is made, warnings, what its latest step did, which hexahedra
/// have gone.
class HexahedralBody {
 public:
  /// rest: num_nodes x 3 [m]; dt [s]. Refuses a body that does not fit into the machine's memory, before it is made.
  /// Throws InputError.
  HexahedralBody(ConstPoints rest, const std::vector<Hexahedron>& hexahedra, HexahedralBodyOptions options, double dt);

  /// Other materials for the same body; what flowed stays. Throws InputError; OptionError for other settings.
  void set_options(HexahedralBodyOptions options, double dt);

  /// What the calls above warned of since the last call of this.
  std::vector<Remark> take_warnings();

  /// Plastic flow at accepted positions.
  void end_step(ConstPoints x, double dt);

  void remove(std::span<const int> elements) { body_.remove(elements); }
  std::vector<int> open(std::span<const int> joints, std::span<const double> crossings) {  ///< Body::open
    return body_.open(joints, crossings);
  }
  void reset();

  /// For hosts whose nodes do not join again: the same, but that joints which are open stay open. load_but_cuts takes
  /// what Body::save wrote, and returns whether such joints were closed in it. Throws InputError where neither has all
  /// that the other has opened, in the same calls; nothing has changed then.
  void reset_but_cuts();
  bool load_but_cuts(std::istream& in);

  void serialize(Archive& archive);

  /// visit(name, of) for each output attribute, which is of(body, x) at positions x: numbers per hexahedron, positions
  /// of nodes, or a list of hexahedra.
  static void outputs(const auto& visit) {
    visit("plasticStrain", [](const Body& body, ConstPoints) { return plastic_strains(body); });
    visit("presentYieldStress", [](const Body& body, ConstPoints) { return present_yield_stresses(body); });
    visit("stressNorm", [](const Body& body, ConstPoints x) { return body.fields(x).stress_norm; });
    visit("volumeRatio", [](const Body& body, ConstPoints) { return plastic_volume_ratios(body); });
    visit("volume", [](const Body& body, ConstPoints x) { return element_volumes(body, x); });
    visit("plasticVolume",
          [](const Body& body, ConstPoints) { return element_volumes(body, body.plastic_rest_positions()); });
    visit("plasticRestPositions", [](const Body& body, ConstPoints) { return body.plastic_rest_positions(); });
    visit("removed", [](const Body& body, ConstPoints) { return std::span<const int>(body.removed()); });
  }

  /// Hexahedra that have gone since the last call of this; valid until the next step.
  std::span<const int> take_removed();

  Body& body() { return body_; }
  const Body& body() const { return body_; }
  bool may_open() const;                                ///< joints, where tissue tears along faces
  const FlowReport& report() const { return report_; }  ///< of the latest step

 private:
  Body made(ConstPoints rest, const std::vector<Hexahedron>& hexahedra, HexahedralBodyOptions options);
  void check(const HexahedralBodyOptions& options, double dt);
  void warn(const std::vector<std::string>& texts);

  double dt_;  // [s] that the rates were checked with
  std::vector<Remark> warnings_;
  std::shared_ptr<const void> memory_;  // granted for the body
  Body body_;
  FlowReport report_;
  std::size_t num_announced_ = 0;  // of the hexahedra that have gone
};

}  // namespace hexaplast::parts
