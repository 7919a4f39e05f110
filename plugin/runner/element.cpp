// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/element.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/elastic/operators.hpp"
#include "hexaplast/material/corotated.hpp"
#include "hexaplast/plastic/element_flow.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

// ---- input ----------------------------------------------------------------------------------------------------------

/// Short keys of reference files and the names they stand for.
constexpr std::array<std::pair<const char*, const char*>, 18> kShortKeys{{
    {"X0", "original"},
    {"x", "material"},
    {"y", "rest"},
    {"xh", "world"},
    {"Pi", "rotationMap"},
    {"tau", "yieldStress"},
    {"tauR", "rotationYield"},
    {"params", "parameters"},
    {"E", "youngModulus"},
    {"nu", "poissonRatio"},
    {"flow", "plasticFlowRate"},
    {"norm", "yieldNorm"},
    {"flowR", "rotationFlowRate"},
    {"kappa", "hardening"},
    {"scheme", "gradient"},
    {"volrate", "volumeRestitution"},
    {"guard_F", "inversionThreshold"},
    {"gauge", "rotationFrame"},
}};

/// Words of reference files and the ones they stand for.
constexpr std::array<std::pair<const char*, const char*>, 8> kShortWords{{
    {"fro", "frobenius"},
    {"vm", "vonMises"},
    {"mises", "vonMises"},
    {"spec", "spectral"},
    {"blendfix", "blended"},
    {"none", "world"},
    {"best", "bestFit"},
    {"gn", "gaussNewton"},
}};

const char* long_key(const std::string& key) {
  for (const auto& [brief, name] : kShortKeys)
    if (key == brief) return name;
  return nullptr;
}

/// Renames the short keys of an object, so that the rest of the program knows one vocabulary.
Json with_long_keys(const Json& given) {
  Json renamed = Json::object();
  for (const auto& [key, value] : given.items()) renamed[long_key(key) ? long_key(key) : key] = value;
  return renamed;
}

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

ElementPoints points(const std::string& key, const Json& value) {
  ElementPoints x;
  const bool shape =
      value.is_array() && value.size() == kCorners &&
      std::all_of(value.begin(), value.end(), [](const Json& row) { return row.is_array() && row.size() == 3; });
  if (!shape) reject(key, value, "eight rows of three numbers");
  for (int a = 0; a < kCorners; ++a)
    for (int d = 0; d < 3; ++d) x(a, d) = number(key, value[a][d]);
  return x;
}

Mat3 matrix(const std::string& key, const Json& value) {
  Mat3 m;
  const bool shape =
      value.is_array() && value.size() == 3 &&
      std::all_of(value.begin(), value.end(), [](const Json& row) { return row.is_array() && row.size() == 3; });
  if (!shape) reject(key, value, "three rows of three numbers");
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = number(key, value[i][j]);
  return m;
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

CornerTensors rotation_maps(const Json& value) {
  CornerTensors maps;
  if (value.is_array() && value.size() == kCorners) {
    for (int i = 0; i < kCorners; ++i) maps[i] = matrix("rotationMap", value[i]);
  } else {
    maps.fill(matrix("rotationMap", value));
  }
  for (const Mat3& map : maps)
    if ((map.transpose() * map - Mat3::Identity()).norm() > 1e-6 || map.determinant() < 0)
      reject("rotationMap", value, "a rotation matrix, or eight");
  return maps;
}

/// One hexahedron with its state, before a model exists for it.
struct Element {
  ElementPoints original, material, rest, world;
  CornerTensors rotation_map;
  CornerValues yield_stress, rotation_yield;
  Material constants;
  Settings settings;
  double dt = 0.01;
  bool names_modes = false;  // a reference file: its own mode is answered with a block for each of three
};

template <class Enum>
Enum word(const std::string& key, const Json& value, std::initializer_list<std::pair<const char*, Enum>> words) {
  std::string allowed, given = value.is_string() ? value.get<std::string>() : "";
  for (const auto& [brief, name] : kShortWords)
    if (given == brief && std::none_of(words.begin(), words.end(), [&](const auto& w) { return given == w.first; }))
      given = name;
  for (const auto& [name, enumerator] : words) {
    if (given == name) return enumerator;
    allowed += (allowed.empty() ? "" : ", ") + std::string(name);
  }
  reject(key, value, "one of " + allowed);
}

void read_parameter(const std::string& key, const Json& value, Element& element) {
  Material& m = element.constants;
  Settings& s = element.settings;
  const std::string name = "parameters." + key;
  if (key == "youngModulus")
    m.young_modulus = number(name, value);
  else if (key == "poissonRatio")
    m.poisson_ratio = number(name, value);
  else if (key == "yieldStress")
    m.yield_stress = number(name, value, true);
  else if (key == "plasticFlowRate")
    m.flow_rate = number(name, value);
  else if (key == "rotationYield")
    m.rotation_yield = number(name, value);
  else if (key == "rotationFlowRate")
    m.rotation_flow_rate = number(name, value);
  else if (key == "hardening")
    m.hardening = number(name, value);
  else if (key == "volumeRestitution")
    s.volume_restitution = number(name, value);
  else if (key == "inversionThreshold")
    s.inversion_threshold = number(name, value);
  else if (key == "fractureStress")
    m.fracture_stress = number(name, value, true);
  else if (key == "fractureStretch")
    m.fracture_stretch = number(name, value, true);
  else if (key == "averagingSteps") {
    if (!value.is_number_integer()) reject(name, value, "a whole number");
    s.averaging_steps = value.get<int>();
  } else if (key == "dt")
    element.dt = number(name, value);
  else if (key == "yieldNorm")
    s.yield_norm = word<YieldNorm>(
        name, value,
        {{"vonMises", YieldNorm::kVonMises}, {"frobenius", YieldNorm::kFrobenius}, {"spectral", YieldNorm::kSpectral}});
  else if (key == "gradient")
    s.gradient = word<GradientScheme>(name, value,
                                      {{"blended", GradientScheme::kBlended},
                                       {"vertex", GradientScheme::kVertex},
                                       {"centre", GradientScheme::kCentre}});
  else if (key == "rotationPlasticity")
    s.rotation = word<RotationPlasticity>(name, value,
                                          {{"objective", RotationPlasticity::kObjective},
                                           {"vertex", RotationPlasticity::kVertex},
                                           {"centre", RotationPlasticity::kCentre},
                                           {"none", RotationPlasticity::kNone}});
  else if (key == "averaging")
    s.averaging = word<AveragingMethod>(name, value,
                                        {{"gaussNewton", AveragingMethod::kGaussNewton},
                                         {"localGlobal", AveragingMethod::kLocalGlobal},
                                         {"jacobi", AveragingMethod::kJacobi}});
  else if (key == "rotationFrame")
    s.rotation_frame =
        word<RotationFrame>(name, value, {{"bestFit", RotationFrame::kBestFit}, {"world", RotationFrame::kWorld}});
  else if (!element.names_modes)
    throw InputError(fmt::format("parameters: no parameter is called {}", key));
}

Element read_element(const Json& given) {
  if (!given.is_object()) throw InputError("the input must be one JSON object");
  const Json json = with_long_keys(given);
  if (!json.contains("original")) throw InputError("\"original\" (or X0) is missing: eight corners");

  Element element;
  element.names_modes = given.contains("X0");
  static const std::set<std::string> known{"original",    "material",    "rest",          "world",
                                           "rotationMap", "yieldStress", "rotationYield", "parameters"};
  if (!element.names_modes)
    for (const auto& [key, value] : json.items())
      if (!known.contains(key)) throw InputError(fmt::format("no key is called {}", key));

  const auto optional_points = [&](const char* key, const ElementPoints& otherwise) {
    return json.contains(key) ? points(key, json[key]) : otherwise;
  };
  element.original = points("original", json["original"]);
  element.material = optional_points("material", element.original);
  element.rest = optional_points("rest", element.material.rowwise() - element.material.colwise().mean());
  element.world = optional_points("world", element.material);
  if (json.contains("parameters")) {
    if (!json["parameters"].is_object()) reject("parameters", json["parameters"], "an object");
    const Json parameters = with_long_keys(json["parameters"]);
    for (const auto& [key, value] : parameters.items()) read_parameter(key, value, element);
  }
  element.rotation_map.fill(Mat3::Identity());
  if (json.contains("rotationMap")) element.rotation_map = rotation_maps(json["rotationMap"]);
  element.yield_stress.fill(element.constants.yield_stress);
  if (json.contains("yieldStress")) element.yield_stress = corner_values("yieldStress", json["yieldStress"]);
  element.rotation_yield.fill(element.constants.rotation_yield);
  if (json.contains("rotationYield")) element.rotation_yield = corner_values("rotationYield", json["rotationYield"]);
  return element;
}

// ---- output ---------------------------------------------------------------------------------------------------------

Json to_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <class Derived>
Json to_json(const Eigen::MatrixBase<Derived>& m) {
  Json rows = Json::array();
  for (int i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (int j = 0; j < m.cols(); ++j) row.push_back(to_json(m(i, j)));
    rows.push_back(row);
  }
  return rows;
}

/// One entry per corner of what `of(i)` gives.
template <class Of>
Json per_corner(const Of& of) {
  Json list = Json::array();
  for (int i = 0; i < kCorners; ++i) list.push_back(to_json(of(i)));
  return list;
}

HexMesh mesh_of(const Element& element) { return HexMesh(element.original, {Hexahedron{0, 1, 2, 3, 4, 5, 6, 7}}); }

Json elastic_block(const Element& element) {
  const Model model(mesh_of(element), {element.constants}, element.settings);
  History history(model);
  history.material = element.material;
  Linearization at;
  linearize(model, history, element.world, at);
  PointArray force = PointArray::Zero(kCorners, 3);
  add_force(model, at, force);
  BlockMatrix blocks(kCorners);
  add_stiffness_blocks(model, at, -1, blocks);
  Eigen::Matrix<double, 24, 24> stiffness = Eigen::Matrix<double, 24, 24>::Zero();
  for (int a = 0; a < kCorners; ++a)
    for (const auto& entry : blocks.row(a)) stiffness.block<3, 3>(3 * a, 3 * entry.column) = entry.block;

  const RestOperator& rest = at.rest[0];
  return {{"volume_x", rest.volume},
          {"J_i", per_corner([&](int i) { return corner_jacobian(element.material, i); })},
          {"J_o", to_json(centre_jacobian(element.material))},
          {"G_mean", to_json(mean_gradient(element.material))},
          {"G_quadrature", per_corner([&](int i) { return sample_gradient(rest, i); })},
          {"w", per_corner([&](int) { return rest.volume / kCorners; })},
          {"energy", energy(model, history, element.world)},
          {"force", to_json(force)},
          {"stiffness", to_json(stiffness)}};
}

Json step_block(const Element& element, RotationPlasticity mode, RotationFrame frame) {
  Settings settings = element.settings;
  settings.rotation = mode;
  settings.rotation_frame = frame;
  const Model model(mesh_of(element), {element.constants}, settings);
  check_time_step(model.materials, settings, element.dt);
  ElementHistory before = History(model).element(0);
  before.rest_shape = element.rest;
  before.rotation_map = element.rotation_map;
  before.yield_stress = element.yield_stress;
  before.rotation_yield = element.rotation_yield;
  History history(model);
  history.material = element.material;
  history.set_element(0, before);

  // the step as the body takes it, averaging included
  Linearization at;
  update_rest_operators(model, history, at);
  FlowWorkspace work(model);
  PreconditionedConjugateGradients solver(kAveragingTolerance, kAveragingIterations);  // as the body has
  History after = history;
  flow(model, at, element.world, element.dt, solver, after, work);

  // and once more for its intermediates
  const Mat3 B = mode == RotationPlasticity::kObjective || frame == RotationFrame::kWorld || work.frames.empty()
                     ? Mat3(Mat3::Identity())
                     : work.frames[0].rotation;
  const ElementStep step = flow_element({.material = model.material(0),
                                         .lame = model.lame[0],
                                         .settings = settings,
                                         .original_shape = model.original_shape[0],
                                         .corner_jacobian = model.corner_jacobian[0],
                                         .original_volume = model.volume[0],
                                         .x = element.material,
                                         .rest = at.rest[0],
                                         .world = element.world,
                                         .frame = B},
                                        before, element.dt);

  const auto F_corner = [&](int i) -> Mat3 {
    return corner_jacobian(element.world, i) * corner_jacobian(element.material, i).inverse();
  };
  const Mat3 F_centre = centre_jacobian(element.world) * centre_jacobian(element.material).inverse();
  const Mat3 R_centre = polar(F_centre).R;
  std::array<Polar, kCorners> at_corner;
  for (int i = 0; i < kCorners; ++i) at_corner[i] = polar(step.F[i]);
  const auto sigma = [&](int i) { return stress(at_corner[i].S, model.lame[0]); };
  const auto Q = [&](int i) -> Mat3 { return R_centre.transpose() * at_corner[i].R; };
  const ElementHistory end = after.element(0);

  return {{"F_i", per_corner(F_corner)},
          {"F_o", to_json(F_centre)},
          {"Fbar_plain", per_corner([&](int i) -> Mat3 { return (F_corner(i) + F_centre) / 2; })},
          {"Fbar", per_corner([&](int i) { return step.F[i]; })},
          {"R", per_corner([&](int i) { return at_corner[i].R; })},
          {"S", per_corner([&](int i) { return at_corner[i].S; })},
          {"R_o", to_json(R_centre)},
          {"Q", per_corner(Q)},
          {"phi", per_corner([&](int i) {
             return mode == RotationPlasticity::kCentre ? step.rotation[i].angle : rotation_log(Q(i)).norm();
           })},
          {"eps", per_corner([&](int i) -> Mat3 { return at_corner[i].S - Mat3::Identity(); })},
          {"sigma", per_corner(sigma)},
          {"sigma_norm", per_corner([&](int i) { return stress_norm(sigma(i), settings.yield_norm); })},
          {"gamma", per_corner([&](int i) { return step.stretch[i].share; })},
          {"Sp", per_corner([&](int i) { return step.stretch[i].increment; })},
          {"eta", per_corner([&](int i) { return step.rotation[i].share; })},
          {"Rp", per_corner([&](int i) { return step.rotation[i].increment; })},
          {"beta", step.volume_ratio},
          {"plasticity_off", step.guarded},
          {"y_new", to_json(end.rest_shape)},
          {"volume_y_new", volume(end.rest_shape)},
          {"tau_new", per_corner([&](int i) { return end.yield_stress[i]; })},
          {"tauR_new", per_corner([&](int i) { return end.rotation_yield[i]; })},
          {"Pi_new", per_corner([&](int i) { return end.rotation_map[i]; })},
          {"x_new", to_json(after.material)},
          {"volume_x_new", volume(gather(after.material, model.mesh.hexahedra()[0]))}};
}

Json all_blocks(const Element& element) {
  Json out{{"elastic", elastic_block(element)}};
  const RotationFrame frame = element.settings.rotation_frame;
  const auto add = [&](const char* name, RotationPlasticity mode) { out[name] = step_block(element, mode, frame); };
  const RotationPlasticity mode = element.settings.rotation;
  if (element.names_modes || mode == RotationPlasticity::kObjective) add("objective", RotationPlasticity::kObjective);
  if (element.names_modes || mode == RotationPlasticity::kVertex) add("paper_vertex", RotationPlasticity::kVertex);
  if (element.names_modes || mode == RotationPlasticity::kCentre) add("paper_centre", RotationPlasticity::kCentre);
  if (!element.names_modes && mode == RotationPlasticity::kNone) add("none", RotationPlasticity::kNone);
  return out;
}

// ---- path -----------------------------------------------------------------------------------------------------------

struct PathRow {
  double time;
  Mat3 F;
};

std::vector<PathRow> read_path(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw scene::FileError(fmt::format("{}: error: cannot be read", file.string()));
  std::vector<PathRow> rows;
  std::string line;
  for (int line_number = 1; std::getline(in, line); ++line_number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#' || (line_number == 1 && line.starts_with("time"))) continue;
    std::array<double, 10> values;
    const char *at = line.data(), *end = line.data() + line.size();
    for (int k = 0; k < 10; ++k) {
      while (at != end && *at == ' ') ++at;
      const auto [next, error] = std::from_chars(at, end, values[k]);
      const bool separated = k == 9 ? next == end : next != end && *next == ',';
      if (error != std::errc() || !separated || !std::isfinite(values[k]))
        throw InputError(
            fmt::format("{}:{}: \"{}\": must be ten numbers time,F11,F12,F13,F21,...,F33 separated by commas",
                        file.string(), line_number, line));
      at = k == 9 ? next : next + 1;
    }
    if (!rows.empty() && values[0] <= rows.back().time)
      throw InputError(fmt::format("{}:{}: time {} does not come after {}", file.string(), line_number, values[0],
                                   rows.back().time));
    Mat3 F;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) F(i, j) = values[1 + 3 * i + j];
    rows.push_back({values[0], F});
  }
  if (rows.size() < 2) throw InputError(fmt::format("{}: at least two rows needed", file.string()));
  return rows;
}

/// Drives the element through F(t), linear between the rows, with steps of at most dt; one CSV line per step.
void drive(const Element& element, const std::vector<PathRow>& path, std::ostream& out) {
  Body body(mesh_of(element), {element.constants}, element.settings);
  out << "time,F11,F22,F33,P11,P12,P13,P21,P22,P23,P31,P32,P33,stress_norm,plastic_strain,yield_stress,volume_ratio,"
         "energy,dissipated_energy\n";
  const auto report = [&](double time, const Mat3& F) {
    const PointArray x = element.original * F.transpose();
    body.linearize(x);
    PointArray f = PointArray::Zero(kCorners, 3);
    body.add_force(f);
    // mean first Piola stress with respect to the original shape: what the corners' forces do on its gradients
    const Mat3 P = -(f.transpose() * element.original) / body.original_volume();
    const ElementFields fields = body.fields(x);
    out << fmt::format("{},{},{},{}", time, F(0, 0), F(1, 1), F(2, 2));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out << fmt::format(",{}", P(i, j));
    out << fmt::format(",{},{},{},{},{},{}\n", fields.stress_norm[0], fields.plastic_strain[0], fields.yield_stress[0],
                       fields.volume_ratio[0], body.energy(x), body.history().dissipated_energy);
  };

  report(path.front().time, path.front().F);
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double span = path[k].time - path[k - 1].time;
    const int steps = std::max(1, static_cast<int>(std::ceil(span / element.dt * (1 - 1e-9))));
    for (int n = 1; n <= steps; ++n) {
      const double share = static_cast<double>(n) / steps;
      const Mat3 F = (1 - share) * path[k - 1].F + share * path[k].F;
      body.flow(element.original * F.transpose(), span / steps);
      report(path[k - 1].time + share * span, F);
    }
  }
}

}  // namespace

void run_element(const ElementOptions& options) {
  Json json;
  try {
    if (options.file == "-") {
      json = Json::parse(std::cin);
    } else {
      std::ifstream in(options.file);
      if (!in) throw scene::FileError(fmt::format("{}: error: cannot be read", options.file));
      json = Json::parse(in);
    }
  } catch (const Json::exception& error) {
    const std::string text = error.what();  // "[json.exception.parse_error.101] parse error at line ..."
    throw InputError(text.substr(text.find("] ") + 2));
  }
  const Element element = read_element(json);
  if (options.path)
    drive(element, read_path(*options.path), std::cout);
  else
    std::cout << all_blocks(element).dump(1) << '\n';
}

}  // namespace hexaplast::runner
