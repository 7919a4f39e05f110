// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"

/// Reads the data of tests/data; the READMEs there state conventions and tolerances.
namespace hexaplast::support {

using Json = nlohmann::json;

/// tests/data/FOLDER/NAME.json
inline Json test_data(const std::string& folder, const std::string& name) {
  const std::string path = std::string(HEXAPLAST_TEST_DATA) + "/" + folder + "/" + name + ".json";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path);
  return Json::parse(file);
}

inline Json golden(const std::string& name) { return test_data("golden", name); }
inline Json calculix(const std::string& name) { return test_data("calculix", name); }

/// A number; null stands for infinity (no limit).
inline double number(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

inline Eigen::VectorXd vector(const Json& rows) {
  Eigen::VectorXd values(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) values[i] = number(rows[i]);
  return values;
}

inline Eigen::MatrixXd matrix(const Json& rows) {
  Eigen::MatrixXd values(rows.size(), rows.at(0).size());
  for (std::size_t i = 0; i < rows.size(); ++i) values.row(i) = vector(rows[i]).transpose();
  return values;
}

inline std::vector<Hexahedron> hexahedra(const Json& rows) { return rows.get<std::vector<Hexahedron>>(); }

inline Material material(const Json& params) {
  Material m;
  m.young_modulus = params.at("youngModulus");
  m.poisson_ratio = params.at("poissonRatio");
  m.yield_stress = number(params.at("yieldStress"));
  m.flow_rate = params.at("plasticFlowRate");
  m.rotation_yield = number(params.at("rotationYield"));
  m.rotation_flow_rate = params.at("rotationFlowRate");
  m.hardening = params.at("hardening");
  return m;
}

/// Settings of a rotation mode: "objective", "paper_vertex" or "paper_centre". The numbers were computed with
/// Model::turns_isolated_shapes, and one step of it does not reach what every method ends at.
inline Settings settings(const Json& params, const std::string& mode, RotationFrame frame) {
  if (params.at("yieldNorm") != "frobenius") throw std::runtime_error("golden data know the Frobenius norm only");
  Settings s = published_element();
  s.implementation = Implementation::kPlain;
  s.yield_norm = YieldNorm::kFrobenius;
  s.rotation_plasticity = mode == "paper_vertex"   ? RotationPlasticity::kVertex
                          : mode == "paper_centre" ? RotationPlasticity::kCentre
                                                   : RotationPlasticity::kObjective;
  s.rotation_frame = frame;
  s.averaging_tolerance = 1e-12;
  s.volume_restitution = params.at("volumeRestitution");
  s.inversion_threshold = params.at("inversionThreshold");
  return s;
}

}  // namespace hexaplast::support
