// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/material/rows.hpp"
#include "inspect.hpp"
#include "runner/run/common_options.hpp"
#include "runner/subcommand.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

// ---- input ----------------------------------------------------------------------------------------------------------

[[noreturn]] void reject(const std::string& key, const Json& value, const std::string& allowed) {
  std::string shown = value.dump();
  if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
  throw InputError(fmt::format("{}: {}: must be {}", key, shown, allowed));
}

double number(const std::string& key, const Json& value, bool null_is_infinite = false) {
  if (null_is_infinite && value.is_null()) return std::numeric_limits<double>::infinity();
  if (!value.is_number() || !std::isfinite(value.get<double>())) reject(key, value, "a finite number");
  return value.get<double>();
}

/// shape: "three rows of three numbers", which the value must be.
template <class Rows>
Rows rows_of(const std::string& key, const Json& value, const char* shape) {
  const auto is_row = [](const Json& row) { return row.is_array() && row.size() == 3; };
  Rows rows;
  if (!value.is_array() || std::ssize(value) != rows.rows() || !std::all_of(value.begin(), value.end(), is_row))
    reject(key, value, shape);
  for (int i = 0; i < rows.rows(); ++i)
    for (int j = 0; j < 3; ++j) rows(i, j) = number(key, value[i][j]);
  return rows;
}

ElementPoints points(const std::string& key, const Json& value) {
  return rows_of<ElementPoints>(key, value, "eight rows of three numbers");
}

Mat3 matrix(const std::string& key, const Json& value) {
  return rows_of<Mat3>(key, value, "three rows of three numbers");
}

CornerValues corner_values(const std::string& key, const Json& value) {
  CornerValues values;
  if (!value.is_array()) {
    values.fill(number(key, value, true));
    return values;
  }
  if (value.size() != kCorners) reject(key, value, "one number, or one per corner (8)");
  for (int i = 0; i < kCorners; ++i) values[i] = number(key, value[i], true);
  return values;
}

/// One, or one per corner.
CornerTensors tensors(const std::string& key, const Json& value) {
  CornerTensors found;
  if (value.is_array() && value.size() == kCorners) {
    for (int i = 0; i < kCorners; ++i) found[i] = matrix(key, value[i]);
  } else {
    found.fill(matrix(key, value));
  }
  return found;
}

CornerTensors rotation_maps(const Json& value) {
  const CornerTensors maps = tensors("rotationMap", value);
  for (const Mat3& map : maps)
    if ((map.transpose() * map - Mat3::Identity()).norm() > 1e-6 || map.determinant() < 0)
      reject("rotationMap", value, "a rotation matrix, or eight");
  return maps;
}

CornerTensors plastic_inverses(const Json& value) {
  const CornerTensors G = tensors("plasticInverse", value);
  for (const Mat3& one : G)
    if (!(one.determinant() > 0)) reject("plasticInverse", value, "a matrix of positive determinant, or eight");
  return G;
}

/// What the input describes.
struct Element {
  HexahedronState state;
  Material constants;
  Settings settings;
  double dt = 0.01;
};

/// The value of a member, as numbers.
template <class Options>
std::vector<double> member(const Row<Options>& row, const std::string& key, const Json& value) {
  if (row.at.list) {
    if (!value.is_array()) reject(key, value, "a list of numbers");
    std::vector<double> list;
    for (const Json& one : value) list.push_back(number(key, one));
    return list;
  }
  if (row.at.type == MemberType::kReal) return {number(key, value, row.may_be_infinite())};
  if (row.at.type == MemberType::kInteger) {
    if (!value.is_number_integer()) reject(key, value, "a whole number");
    return {value.get<double>()};
  }
  const int place = place_of_word(row, value.is_string() ? value.get<std::string>() : "");
  if (place < 0) reject(key, value, fmt::format("one of {}", fmt::join(row.words, ", ")));
  return {static_cast<double>(place)};
}

/// Whether the parameter is a member of these.
template <class Options>
bool read_member(std::span<const Row<Options>> rows, const std::string& name, const Json& value, Options& options) {
  const Row<Options>* row = find_row(rows, name, Names::kScenes);
  if (!row) return false;
  row->set_values(options, member(*row, "parameters." + name, value));
  return true;
}

void read_parameter(const std::string& key, const Json& value, Element& element) {
  if (key == "dt")
    element.dt = number("parameters.dt", value);
  else if (!read_member(material_rows(), key, value, element.constants) &&
           !read_member(settings_rows(), key, value, element.settings))
    throw InputError(fmt::format("parameters: no parameter is called {}", key));
}

Element read_element(const Json& json) {
  if (!json.is_object()) throw InputError("the input must be one JSON object");
  if (!json.contains("initial")) throw InputError("\"initial\" is missing: eight corners");

  Element element;
  static const std::set<std::string> known{"initial",     "plasticRest",   "rest",           "current",   "rotationMap",
                                           "yieldStress", "rotationYield", "plasticInverse", "parameters"};
  for (const auto& [key, value] : json.items())
    if (!known.contains(key)) throw InputError(fmt::format("no key is called {}", key));

  const auto optional_points = [&](const char* key, const ElementPoints& otherwise) {
    return json.contains(key) ? points(key, json[key]) : otherwise;
  };
  if (json.contains("parameters")) {
    if (!json["parameters"].is_object()) reject("parameters", json["parameters"], "an object");
    for (const auto& [key, value] : json["parameters"].items()) read_parameter(key, value, element);
  }
  // one hexahedron by itself is computed exactly and with every option, whatever its body is
  element.settings.precision = Precision::kDouble;
  element.settings.implementation = Implementation::kPlain;
  validate({element.constants}, Names::kScenes);
  validate(element.settings, Names::kScenes);
  validate({element.constants}, element.settings, Names::kScenes);
  const bool is_isolated = element.settings.rest_shape == RestShape::kIsolated;
  for (const char* key : {"plasticRest", "rest", "rotationMap", "rotationYield"})
    if (is_isolated && json.contains(key))
      throw InputError(
          fmt::format("{}: has no meaning with restShape isolated, which has plasticInverse; joined has it", key));
  if (!is_isolated && json.contains("plasticInverse"))
    throw InputError("plasticInverse: has a meaning with restShape isolated only");
  HexahedronState& state = element.state;
  state = initial_hexahedron(points("initial", json["initial"]), element.constants);
  state.plastic_rest = optional_points("plasticRest", state.initial);
  state.current = optional_points("current", state.plastic_rest);
  state.history.rest_shape =
      optional_points("rest", state.plastic_rest.rowwise() - state.plastic_rest.colwise().mean());
  if (json.contains("rotationMap")) state.history.rotation_map = rotation_maps(json["rotationMap"]);
  if (json.contains("plasticInverse")) state.history.plastic_inverse = plastic_inverses(json["plasticInverse"]);
  if (json.contains("yieldStress")) state.history.yield_stress = corner_values("yieldStress", json["yieldStress"]);
  if (json.contains("rotationYield"))
    state.history.rotation_yield = corner_values("rotationYield", json["rotationYield"]);
  return element;
}

// ---- output ---------------------------------------------------------------------------------------------------------

// What is not finite is null in the text of JSON.
Json to_json(double value) { return value; }

template <class Derived>
Json to_json(const Eigen::MatrixBase<Derived>& m) {
  Json rows = Json::array();
  for (const auto& row : m.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

/// One entry per corner.
template <class Value>
Json to_json(const std::array<Value, kCorners>& values) {
  Json list = Json::array();
  for (const Value& value : values) list.push_back(to_json(value));
  return list;
}

Json elastic_block(const Element& element) {
  const HexahedronElasticity found = inspect_elasticity(element.state, element.constants, element.settings);
  CornerValues sample_volumes;
  sample_volumes.fill(found.sample_volume);
  return {{"volume_x", found.volume},
          {"J_i", to_json(found.corner_jacobian)},
          {"J_o", to_json(found.centre_jacobian)},
          {"G_mean", to_json(found.mean_gradient)},
          {"G_quadrature", to_json(found.sample_gradient)},
          {"w", to_json(sample_volumes)},
          {"energy", found.energy},
          {"force", to_json(found.force)},
          {"stiffness", to_json(found.stiffness)}};
}

Json step_block(const Element& element) {
  const HexahedronStep found =
      inspect_step(element.state, element.constants, element.settings, element.dt, Names::kScenes);
  Json block{{"F_i", to_json(found.F_corner)},
             {"F_o", to_json(found.F_centre)},
             {"Fbar_plain", to_json(found.F_blended)},
             {"Fbar", to_json(found.F)},
             {"R", to_json(found.R)},
             {"S", to_json(found.S)},
             {"R_o", to_json(found.R_centre)},
             {"Q", to_json(found.Q)},
             {"phi", to_json(found.phi)},
             {"eps", to_json(found.strain)},
             {"sigma", to_json(found.stress)},
             {"sigma_norm", to_json(found.stress_norm)},
             {"gamma", to_json(found.stretch_flow_fraction)},
             {"Sp", to_json(found.stretch_increment)},
             {"eta", to_json(found.rotation_flow_fraction)},
             {"Rp", to_json(found.rotation_increment)},
             {"beta", found.volume_ratio},
             {"plasticity_off", found.skipped},
             {"y_new", to_json(found.history.rest_shape)},
             {"volume_y_new", found.rest_volume},
             {"tau_new", to_json(found.history.yield_stress)},
             {"tauR_new", to_json(found.history.rotation_yield)},
             {"Pi_new", to_json(found.history.rotation_map)},
             {"x_new", to_json(found.plastic_rest)},
             {"volume_x_new", found.plastic_volume}};
  if (element.settings.rest_shape == RestShape::kIsolated) block["G_new"] = to_json(found.history.plastic_inverse);
  return block;
}

Json all_blocks(const Element& element) {
  constexpr const char* kStepNames[] = {"objective", "paper_vertex", "paper_centre", "none"};
  const char* name = kStepNames[static_cast<std::size_t>(element.settings.rotation_plasticity)];
  return {{"elastic", elastic_block(element)}, {name, step_block(element)}};
}

// ---- path -----------------------------------------------------------------------------------------------------------

std::vector<PathPoint> read_path(const std::filesystem::path& file) {
  scene::require_readable(file);
  std::ifstream in(file);
  std::vector<PathPoint> rows;
  std::string line;
  for (int line_number = 1; std::getline(in, line); ++line_number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#' || (line_number == 1 && line.starts_with("time"))) continue;
    const std::vector<double> values = numbers_in(line, ',');
    if (values.size() != 10)
      throw InputError(
          fmt::format("{}:{}: \"{}\": must be ten numbers time,F11,F12,F13,F21,...,F33 separated by commas",
                      file.string(), line_number, line));
    if (!rows.empty() && values[0] <= rows.back().time)
      throw InputError(fmt::format("{}:{}: time {} does not come after {}", file.string(), line_number, values[0],
                                   rows.back().time));
    rows.push_back({values[0], Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&values[1])});
  }
  if (rows.size() < 2) throw InputError(fmt::format("{}: at least two rows needed", file.string()));
  return rows;
}

/// One CSV line per moment of the path.
void write_path(const Element& element, const std::vector<PathPoint>& path, std::ostream& out) {
  out << "time,F11,F22,F33,P11,P12,P13,P21,P22,P23,P31,P32,P33,stress_norm,plastic_strain,yield_stress,volume_ratio,"
         "energy,dissipated_energy\n";
  follow_path(
      element.state.initial, element.constants, element.settings, element.dt, path,
      [&](const PathResponse& at) {
        out << fmt::format("{},{},{},{}", at.time, at.F(0, 0), at.F(1, 1), at.F(2, 2));
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) out << fmt::format(",{}", at.P(i, j));
        out << fmt::format(",{},{},{},{},{},{}\n", at.stress_norm, at.plastic_strain, at.yield_stress, at.volume_ratio,
                           at.energy, at.dissipated_energy);
      },
      Names::kScenes);
}

struct ElementOptions {
  std::string file = "-";                     ///< JSON that describes the hexahedron; "-": standard input
  std::optional<std::filesystem::path> path;  ///< CSV of deformation gradients over time to drive it through
};

/// One hexahedron, every intermediate of its elasticity and of one plastic step as JSON on standard output, or with a
/// path its response over time as CSV. The format is docs/element.md. Throws InputError naming the key and value that
/// is wrong, scene::FileError for a file that cannot be read.
void run_element(const ElementOptions& options) {
  Json json;
  try {
    if (options.file == "-") {
      json = Json::parse(std::cin);
    } else {
      scene::require_readable(options.file);
      std::ifstream in(options.file);
      json = Json::parse(in);
    }
  } catch (const Json::exception& error) {
    const std::string text = error.what();  // "[json.exception.parse_error.101] parse error at line ..."
    throw InputError(text.substr(text.find("] ") + 2));
  }
  const Element element = read_element(json);
  if (!options.path && element.settings.num_branches() > 0)
    throw InputError("parameters.relaxation: the answer depends on what was before: needs --path");
  if (options.path)
    write_path(element, read_path(*options.path), std::cout);
  else
    std::cout << all_blocks(element).dump(1) << '\n';
}

}  // namespace

void add_element(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "element", "Print all intermediate results of one hexahedron as JSON", run_element,
                     [](const ElementOptions& given) { return given.file; });
  add_option(command, "file", options.file, "FILE.json|-",
             "JSON that describes the hexahedron (docs/element.md); - for standard input");
  add_option(command, "--path", options.path, "FILE.csv",
             "CSV rows time,F11,F12,...,F33: deform the hexahedron along them and print its response as CSV");
}

}  // namespace hexaplast::runner
