// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/viewer_states.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "formats/readable_file.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/sections.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "picture/colour_map.hpp"
#include "record/files.hpp"
#include "record/packed_numbers.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

using Eigen::Vector3f;
using Json = nlohmann::ordered_json;

constexpr double kMaxBytes = 2e6;  // of all states before they are deflated
constexpr int kColours = 65;       // samples of the colour map
constexpr std::uint8_t kNoValue8 = 255;
constexpr std::uintmax_t kMaxFile = 64u << 20;  // [bytes] of a file that goes into a page

/// Maps an interval to whole numbers from 0 to `levels`.
struct Quantiser {
  double min, max;
  double levels;
  template <class Number>
  Number operator()(double value) const {
    if (!(max > min)) return 0;
    return static_cast<Number>(std::lround(levels * std::clamp((value - min) / (max - min), 0.0, 1.0)));
  }
};

constexpr double kLevels16 = 65535, kLevels8 = 254;

std::vector<std::uint16_t> in_box(const std::vector<Vector3f>& points, const Eigen::AlignedBox3f& box) {
  std::vector<std::uint16_t> numbers;
  numbers.reserve(3 * points.size());
  for (const Vector3f& point : points)
    for (int axis = 0; axis < 3; ++axis)
      numbers.push_back(Quantiser{box.min()[axis], box.max()[axis], kLevels16}.operator()<std::uint16_t>(point[axis]));
  return numbers;
}

Json json_of(const Eigen::AlignedBox3f& box) {
  if (box.isEmpty()) return {0, 0, 0, 1, 1, 1};
  return {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()};
}

template <class Vector>
Json json_of_vector(const Vector& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

std::string hexadecimal(const Colour& colour) {
  const auto byte = [](float part) { return static_cast<int>(std::lround(255 * part)); };
  return fmt::format("{:02x}{:02x}{:02x}", byte(colour.red), byte(colour.green), byte(colour.blue));
}

template <std::size_t N>
std::vector<std::uint32_t> flat(std::span<const std::array<int, N>> cells) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(N * cells.size());
  for (const std::array<int, N>& cell : cells) numbers.insert(numbers.end(), cell.begin(), cell.end());
  return numbers;
}

}  // namespace

ViewerStates::ViewerStates(const Bodies& bodies, std::string title, long num_steps, double dt, const Staging& staging)
    : bodies_(bodies), title_(std::move(title)), num_steps_(num_steps), dt_(dt), staging_(staging) {
  const HexMesh& mesh = bodies.mesh();
  if (mesh.num_nodes() > kMaxNodes) return;
  for (const QuantityEntry& entry : kQuantities)
    if (entry.quantity != Quantity::kRegion) quantities_.push_back(entry.quantity);
  for (const EmbeddedSurface& surface : staging_.embedded_surfaces) embeddings_.push_back(surface.embedding(mesh));
  alive_.assign(static_cast<std::size_t>(mesh.num_elements()), 1);

  const int count = max_states();
  for (int i = 0; i < count; ++i) wanted_.push_back(std::lround(static_cast<double>(num_steps) * i / (count - 1)));
  wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
}

double ViewerStates::bytes_of_state() const {
  return static_cast<double>(bodies_.mesh().num_nodes()) * static_cast<double>(6 + quantities_.size());
}

int ViewerStates::max_states() const {
  return std::clamp(static_cast<int>(kMaxBytes / bytes_of_state()), kFewestStates, kMaxStates);
}

void ViewerStates::halve() {
  std::vector<State> kept;
  std::vector<int> gone;  // in the states that are dropped
  for (std::size_t s = 0; s < states_.size(); ++s) {
    State& state = states_[s];
    gone.insert(gone.end(), state.gone.begin(), state.gone.end());
    if (s % 2 == 1) continue;
    state.gone = std::exchange(gone, {});
    kept.push_back(std::move(state));
  }
  for (const int e : gone) alive_[static_cast<std::size_t>(e)] = 1;  // so that the next state says that they are gone
  states_ = std::move(kept);
}

bool ViewerStates::wants(long step) const { return std::ranges::binary_search(wanted_, step); }

std::vector<float> ViewerStates::nodal_values(Quantity quantity, const ElementFields& fields,
                                              ConstPoints velocities) const {
  const std::vector<double> numbers = quantity == Quantity::kSpeed
                                          ? speeds(velocities)
                                          : nodal_means(bodies_.mesh(), values_in(fields, quantity), bodies_.alive());
  return {numbers.begin(), numbers.end()};
}

std::vector<ViewerStates::Load> ViewerStates::loads_of(const BoundaryConditions& conditions) const {
  std::vector<Load> loads;
  if (!staging_.shows_loads) return loads;
  for (const auto& [node, force] : shown_loads(bodies_.mesh(), bodies_.alive(), conditions))
    loads.push_back({node, force.cast<float>()});
  return loads;
}

ViewerStates::Tool ViewerStates::tool_of(const Instrument& instrument, ConstPoints positions) {
  const auto known = std::ranges::find(shapes_, instrument.shape_triangles);
  Tool tool{instrument.id, static_cast<std::size_t>(known - shapes_.begin()),
            instrument.acts_at(positions).cast<float>(), instrument.force().cast<float>(),
            single(instrument.shape_points)};
  if (known == shapes_.end()) shapes_.push_back(instrument.shape_triangles);
  return tool;
}

void ViewerStates::add(long step, double time, ConstPoints positions, ConstPoints velocities,
                       const BoundaryConditions& conditions) {
  if (bodies_.mesh().num_nodes() > kMaxNodes) return;
  State state;
  state.step = step;
  state.time = time;
  for (Eigen::Index node = 0; node < positions.rows(); ++node)
    for (int axis = 0; axis < 3; ++axis) state.positions.push_back(static_cast<float>(positions(node, axis)));
  const std::vector<Hexahedron>& hexahedra = bodies_.mesh().hexahedra();
  if (!states_.empty() && *states_.back().hexahedra == hexahedra)
    state.hexahedra = states_.back().hexahedra;
  else
    state.hexahedra = std::make_shared<const std::vector<Hexahedron>>(hexahedra);
  const ElementFields fields = bodies_.fields(positions);
  for (const Quantity quantity : quantities_) state.values.push_back(nodal_values(quantity, fields, velocities));
  const std::span<const unsigned char> alive = bodies_.alive();
  for (std::size_t e = 0; e < alive_.size(); ++e)
    if (alive_[e] && !alive[e]) {
      state.gone.push_back(static_cast<int>(e));
      alive_[e] = 0;
    }
  for (std::size_t node = 0; node < conditions.fixed.size(); ++node)
    if (conditions.fixed[node]) state.fixed.push_back(static_cast<int>(node));
  state.loads = loads_of(conditions);
  for (const Instrument& instrument : conditions.instruments) state.tools.push_back(tool_of(instrument, positions));
  for (const auto& [from, to, is_slack] : conditions.springs) {
    if (is_slack) state.slack.push_back(static_cast<int>(state.spring_ends.size()) / 2);
    state.spring_ends.insert(state.spring_ends.end(), {from.cast<float>(), to.cast<float>()});
  }
  states_.push_back(std::move(state));
}

// What has one value everywhere and always says nothing, unless the pictures are to show it.
bool ViewerStates::is_shown(std::size_t quantity) const {
  if (quantities_[quantity] == staging_.quantity) return true;
  float min = std::numeric_limits<float>::infinity(), max = -min;
  for (const State& state : states_)
    for (const float value : state.values[quantity])
      if (std::isfinite(value)) {
        min = std::min(min, value);
        max = std::max(max, value);
      }
  return max - min > 1e-6f * std::max(std::abs(min), std::abs(max));
}

// Corners of hexahedra tell which node another one was before it was split.
std::vector<int> ViewerStates::rows_in(const State& state) const {
  const std::vector<Hexahedron>& present = bodies_.mesh().hexahedra();
  std::vector<int> rows(static_cast<std::size_t>(bodies_.mesh().num_nodes()));
  std::iota(rows.begin(), rows.end(), 0);
  for (std::size_t e = 0; e < present.size(); ++e)
    for (int a = 0; a < kCorners; ++a) rows[present[e][a]] = (*state.hexahedra)[e][a];
  return rows;
}

std::string ViewerStates::json() const {
  const HexMesh& mesh = bodies_.mesh();
  const auto num_nodes = static_cast<std::size_t>(mesh.num_nodes());
  Json all{{"format", 1},
           {"title", title_},
           {"dt", dt_},
           {"steps", states_.empty() ? num_steps_ : std::max(num_steps_, states_.back().step)},
           {"nodes", mesh.num_nodes()},
           {"hexahedra", mesh.num_elements()}};
  if (kMaxBytes / bytes_of_state() < kMaxStates) all["thinned"] = true;
  if (states_.empty()) return all.dump();

  std::vector<Vector3f> places;
  Eigen::AlignedBox3f box, tool_box, spring_box;
  const std::vector<Vector3f> initial = single(mesh.positions());
  for (const Vector3f& place : initial) box.extend(place);
  for (const State& state : states_) {
    for (const int row : rows_in(state)) {
      const float* place = &state.positions[3 * static_cast<std::size_t>(row)];
      places.emplace_back(place[0], place[1], place[2]);
      box.extend(places.back());
    }
    for (const Tool& tool : state.tools)
      for (const Vector3f& point : tool.points) tool_box.extend(point);
    for (const Vector3f& end : state.spring_ends) spring_box.extend(end);
  }
  if (!box.min().allFinite() || !box.max().allFinite())
    throw NumericalError("a position of the states for the viewer is not finite");
  all["box"] = json_of(box);

  PackedNumbers numbers;
  numbers.add("hexahedra", flat<8>(mesh.hexahedra()), 8);
  numbers.add("original", in_box(initial, box), 3);
  numbers.add("positions", in_box(places, box), 3 * num_nodes);

  Json bodies = Json::array();
  for (const Bodies::Entry& entry : bodies_.all())
    bodies.push_back({{"name", entry.name}, {"firstHexahedron", entry.first_hexahedron}});
  all["bodies"] = bodies;

  Json fields = Json::array();
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    if (!is_shown(q)) continue;
    const QuantityEntry& entry = entry_of(quantities_[q]);
    Scale scale(quantities_[q], quantities_[q] == staging_.quantity ? staging_.range : std::nullopt);
    double min = std::numeric_limits<double>::infinity(), max = -min;
    for (const State& state : states_) {
      scale.see(state.values[q]);
      for (const float value : state.values[q])
        if (std::isfinite(value)) {
          min = std::min<double>(min, value);
          max = std::max<double>(max, value);
        }
    }
    const Quantiser quantiser{min, max, kLevels8};
    std::vector<std::uint8_t> values;
    values.reserve(states_.size() * num_nodes);
    for (const State& state : states_)
      for (const int row : rows_in(state)) {
        const float value = state.values[q][static_cast<std::size_t>(row)];
        values.push_back(std::isfinite(value) ? quantiser.operator()<std::uint8_t>(value) : kNoValue8);
      }
    numbers.add(fmt::format("values_{}", entry.word), values, num_nodes);
    fields.push_back({{"word", entry.word},
                      {"label", entry.label},
                      {"unit", entry.unit},
                      {"least", min <= max ? min : 0},
                      {"most", min <= max ? max : 0},
                      {"shown", {scale.min(), scale.max()}},
                      {"gaps", scale.has_gaps()}});
  }
  all["fields"] = fields;
  all["field"] = entry_of(staging_.quantity).word;

  const Regions& regions = staging_.regions;
  Json names = Json::array();
  for (const int number : regions.names.empty() ? std::vector<int>() : regions.numbers())
    names.push_back(
        {{"name", Regions::name_of(number, regions.names)}, {"colour", hexadecimal(colour_of_region(number))}});
  all["regions"] = names;
  all["shownRegions"] = staging_.shown_regions;
  if (!names.empty())
    numbers.add("regions", std::vector<std::uint16_t>(regions.of_hexahedra.begin(), regions.of_hexahedra.end()), 1);

  Json embedded = Json::array();
  for (std::size_t s = 0; s < embeddings_.size(); ++s) {
    const Embedding& embedding = embeddings_[s];
    const EmbeddedSurface& surface = staging_.embedded_surfaces[s];
    double min = 0, max = 1;
    for (int point = 0; point < embedding.num_points(); ++point)
      for (const double weight : embedding.weights_of(point)) {
        min = std::min(min, weight);
        max = std::max(max, weight);
      }
    const Quantiser quantiser{min, max, kLevels16};
    std::vector<std::uint32_t> carriers;
    std::vector<std::uint16_t> weights;  // of seven corners; all eight add up to 1
    for (int point = 0; point < embedding.num_points(); ++point) {
      carriers.push_back(static_cast<std::uint32_t>(surface.first_hexahedron + embedding.hexahedron_of(point)));
      for (int corner = 1; corner < kCorners; ++corner)
        weights.push_back(quantiser.operator()<std::uint16_t>(embedding.weights_of(point)[corner]));
    }
    std::vector<Quad> faces = surface.quads;
    for (const auto& [a, b, c] : surface.triangles) faces.push_back({a, b, c, c});
    numbers.add(fmt::format("carriers_{}", s), carriers, 1);
    numbers.add(fmt::format("weights_{}", s), weights, 7);
    numbers.add(fmt::format("faces_{}", s), flat<4>(faces), 4);
    embedded.push_back({{"least", min}, {"most", max}});
  }
  all["embedded"] = embedded;

  std::vector<Vector3f> tool_points, spring_ends;
  Json states = Json::array();
  std::vector<int> fixed;
  for (const State& state : states_) {
    Json entry{{"step", state.step}, {"time", state.time}};
    if (!state.gone.empty()) entry["gone"] = state.gone;
    if (state.fixed != fixed || &state == &states_.front()) entry["fixed"] = fixed = state.fixed;
    if (!state.loads.empty()) {
      Json loads = Json::array();
      for (const Load& load : state.loads) loads.push_back({load.node, load.force.x(), load.force.y(), load.force.z()});
      entry["loads"] = loads;
    }
    if (!state.tools.empty()) {
      Json tools = Json::array();
      for (const Tool& tool : state.tools) {
        tools.push_back({{"id", tool.id},
                         {"shape", tool.shape},
                         {"first", tool_points.size()},
                         {"points", tool.points.size()},
                         {"place", json_of_vector(tool.place)},
                         {"force", json_of_vector(tool.force)}});
        tool_points.insert(tool_points.end(), tool.points.begin(), tool.points.end());
      }
      entry["tools"] = tools;
    }
    if (!state.spring_ends.empty()) {
      entry["springs"] = {{"first", spring_ends.size()}, {"ends", state.spring_ends.size()}};
      if (!state.slack.empty()) entry["springs"]["slack"] = state.slack;
      spring_ends.insert(spring_ends.end(), state.spring_ends.begin(), state.spring_ends.end());
    }
    states.push_back(entry);
  }
  all["states"] = states;
  all["toolBox"] = json_of(tool_box);
  all["shapes"] = shapes_.size();
  for (std::size_t s = 0; s < shapes_.size(); ++s) numbers.add(fmt::format("shape_{}", s), flat<3>(shapes_[s]), 3);
  numbers.add("tools", in_box(tool_points, tool_box),
              3 * std::max<std::size_t>(1, tool_points.size() / states_.size()));

  if (!spring_ends.empty()) {
    all["springBox"] = json_of(spring_box);
    numbers.add("springs", in_box(spring_ends, spring_box),
                3 * std::max<std::size_t>(1, spring_ends.size() / states_.size()));
  }

  const Viewpoint view = staging_.seen_from(mesh);
  const Camera camera(view);
  all["towards"] = json_of_vector(camera.towards());
  all["up"] = json_of_vector(camera.up());
  all["upright"] = json_of_vector(*view.up);
  all["anatomical"] = staging_.is_anatomical;
  all["gravity"] = json_of_vector(staging_.gravity);
  all["showsHexahedra"] = staging_.shows_hexahedra;
  std::string colours;
  for (int k = 0; k < kColours; ++k) colours += hexadecimal(colour_of(k / (kColours - 1.0)));
  all["colours"] = colours;

  Json arrays = Json::array();
  for (const PackedNumbers::Array& array : numbers.arrays())
    arrays.push_back({{"name", array.name}, {"bits", array.bits}, {"count", array.count}, {"stride", array.stride}});
  all["arrays"] = arrays;
  all["data"] = numbers.base64();
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<ViewerData> read_viewer_data(const fs::path& directory) {
  const fs::path file = directory / kViewerName;
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  require_readable(file);
  if (fs::file_size(file, error) > kMaxFile)
    throw InputError(fmt::format("{}: has more than {} bytes", file.string(), kMaxFile));
  return viewer_markup(whole_file(file), file.string());
}

ViewerData viewer_markup(std::string_view json, std::string_view source) {
  const Json all = Json::parse(json, nullptr, false);
  if (!all.is_object() || all.value("format", Json()) != 1)
    throw InputError(fmt::format("{}: is no file that a run writes for the viewer", source));
  return {without_marks(all.dump(-1, ' ', false, Json::error_handler_t::replace)), all.contains("states")};
}

std::string without_marks(std::string_view json) {
  std::string markup;
  for (const char c : json)
    if (c == '<' || c == '>' || c == '&')
      markup += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      markup += c;
  return markup;
}

}  // namespace hexaplast::output
