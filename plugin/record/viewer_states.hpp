// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "picture/bodies.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/gallery.hpp"

namespace hexaplast::output {

inline constexpr std::string_view kViewerName = "viewer.json";

/// Collects states of a run for the viewer in its report. They are kept in single precision until the run is over,
/// since the ranges are known only then. The file is a JSON object:
///
///  - states: step, time, loads (node, force), instruments (`tools`), `springs` (their two ends each, from entry
///    `first` of the array of that name on, within `springBox`; which are `slack`), hexahedra that are `gone` since
///    the state before, and `fixed` nodes where they change
///  - data: base64 of a zlib stream with the `arrays` one after the other. Each has `count` unsigned integers of
///    `bits` bits: first the lowest bytes of all entries, then the next ones. An entry is the difference d to the
///    entry `stride` before it (to 0 at first), as 2 d if d is not negative, otherwise as -2 d - 1; sums are modulo
///    2^bits
///
/// Nodes are those of the last state; in a state before they split, copies lie where their node was. `hexahedra` has
/// eight nodes each, `positions` three numbers per node and state, 0 to 65535 from end to end of `box` [m], and
/// `values_...` one, 0 to 254 from `least` to `most` of the field, 255 for no value. `regions` has the number of each
/// hexahedron's region, an entry of the list of that name, which has names and colours; `shownRegions` are those that
/// are shown within the body.
class ViewerStates {
 public:
  static constexpr int kMaxStates = 60, kFewestStates = 6;
  static constexpr int kMaxNodes = 100'000;  ///< of a mesh that a page still opens fast with

  /// num_steps: of the whole run. The bodies must outlive this object. Throws what Embedding throws.
  ViewerStates(const Bodies& bodies, std::string title, long num_steps, double dt, const Staging& staging);

  bool wants(long step) const;

  /// The present state of the bodies, which wants() or the end of the run asks for; steps ascend.
  void add(long step, double time, ConstPoints positions, ConstPoints velocities, const BoundaryConditions& conditions);
  int num_states() const { return static_cast<int>(states_.size()); }
  int max_states() const;  ///< that one page should have of this mesh

  /// Drops every second state: the second, the fourth, and so on.
  void halve();

  bool has(long step) const { return !states_.empty() && states_.back().step == step; }

  /// The file's content: JSON in one line.
  std::string json() const;

 private:
  /// A force at a node, or a tool with its force.
  struct Load {
    int node;
    Eigen::Vector3f force;  // [N]
  };
  struct Tool {
    int id;
    std::size_t shape;                    // in shapes_
    Eigen::Vector3f place, force;         // [m], [N]
    std::vector<Eigen::Vector3f> points;  // [m]
  };
  struct State {
    long step = 0;
    double time = 0;                                           // [s]
    std::shared_ptr<const std::vector<Hexahedron>> hexahedra;  // as they were, of states until nodes split
    std::vector<float> positions;                              // [m] three per node
    std::vector<std::vector<float>> values;                    // of each quantity, one per node
    std::vector<int> gone;                                     // hexahedra that have gone since the state before
    std::vector<int> fixed;                                    // nodes
    std::vector<Load> loads;
    std::vector<Tool> tools;
    std::vector<Eigen::Vector3f> spring_ends;  // [m] two of each spring
    std::vector<int> slack;                    // springs that are
  };

  std::vector<float> nodal_values(Quantity quantity, const ElementFields& fields, ConstPoints velocities) const;
  std::vector<Load> loads_of(const BoundaryConditions& conditions) const;
  Tool tool_of(const Instrument& instrument, ConstPoints positions);
  bool is_shown(std::size_t quantity) const;
  double bytes_of_state() const;                       // before it is deflated
  std::vector<int> rows_in(const State& state) const;  // of the present nodes

  const Bodies& bodies_;
  std::string title_;
  long num_steps_;
  double dt_;
  Staging staging_;
  std::vector<Quantity> quantities_;
  std::vector<Embedding> embeddings_;  // of the embedded surfaces
  std::vector<long> wanted_;           // steps, ascending
  std::vector<unsigned char> alive_;   // in the latest state
  std::vector<std::vector<Triangle>> shapes_;
  std::vector<State> states_;
};

/// What the viewer of a run's report needs.
struct ViewerData {
  std::string markup;      ///< viewer.json as it may stand in an element of HTML: with no mark of HTML in it
  bool has_states = true;  ///< else the run had more than kMaxNodes nodes
};

/// json: what ViewerStates::json() returns. Throws InputError, which names the source, for anything else.
ViewerData viewer_markup(std::string_view json, std::string_view source = kViewerName);

/// JSON as it may stand in an element of HTML: what would be a mark there is written by its number.
std::string without_marks(std::string_view json);

/// None: the directory holds no viewer.json. Throws OutputError or InputError.
std::optional<ViewerData> read_viewer_data(const std::filesystem::path& directory);

}  // namespace hexaplast::output
