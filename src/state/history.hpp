// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/types.hpp"
#include "material/relaxation.hpp"
#include "state/model.hpp"

namespace hexaplast {

/// The plastic history of one element, by value.
struct ElementHistory {
  ElementPoints rest_shape;       ///< [m] y: isolated rest shape, about the element's own mean
  CornerTensors rotation_map;     ///< Pi: rest frame -> material frame; eight equal ones where the mode has one
  CornerValues yield_stress;      ///< [Pa] tau; infinite if it never yields
  CornerValues rotation_yield;    ///< [rad] tau^R
  CornerValues plastic_strain;    ///< [-] accumulated sqrt(2/3) gamma |dev log D|_F
  CornerTensors plastic_stretch;  ///< product of the S^p, in the rest frame; identity unless the model tracks it
  CornerTensors plastic_inverse;  ///< G = (F^p)^-1 of isolated rest shapes; identity elsewhere
};

/// Everything plastic; changes once per accepted time step, by flow(), and between two steps when the host takes
/// elements out or changes the material (Body). A checkpoint saves exactly this.
struct History {
  std::vector<ElementPoints> rest_shape;     ///< y per element; empty, as Pi, where it stays (Model::has_rest_shapes)
  std::vector<Mat3> rotation_map;            ///< Pi per element, or per element and corner (Model::maps_per_element)
  std::vector<CornerValues> yield_stress;    ///< [Pa] tau per element
  std::vector<CornerValues> rotation_yield;  ///< [rad] tau^R per element; empty until the model can rotate
  PointArray plastic_rest_positions;  ///< [m] x: joined rest shape, num_nodes x 3; the initial one of isolated ones
  std::vector<CornerValues> plastic_strain;    ///< [-] per element
  std::vector<CornerTensors> plastic_stretch;  ///< per element; empty unless the model tracks it
  std::vector<CornerTensors> plastic_inverse;  ///< G = (F^p)^-1 per element, of isolated rest shapes: in place of y, Pi
                                               ///< and x, which stay as they are; empty until the model can flow
  std::vector<unsigned char> has_flowed;       ///< per element, of these: some G is not 1; set where G is set
  double dissipated_energy = 0;                ///< [J] accumulated plastic work
  std::vector<unsigned char> alive;            ///< per element: 0 once it is removed
  std::vector<int> removed;                    ///< removed elements in the order of their removal
  PointArray averaging_increment;  ///< [m] latest step of the averaging, from which the next one starts; num_nodes x
                                   ///< 3, without rows where there is no y
  std::vector<CornerSymmetric> branch_strain;   ///< b = q / (2 g mu) per element and viscoelastic branch
  std::vector<CornerSymmetric> branch_stretch;  ///< B at the latest step, per element; empty without branches
  std::vector<int> opened;                      ///< joints that are open, call by call, ascending within a call
  std::vector<double> crossings;                ///< [-] of these (Body::open)
  std::vector<int> end_of_opening;              ///< per call: where it ends in `opened`
  long version = 0;  ///< grows whenever something changes, so that derived data know they are old

  /// The initial state of a model: plastic rest positions = initial positions.
  explicit History(const Model& model);

  ElementHistory element(const Model& model, int e) const;
  void set_element(int e, const ElementHistory& element);
  /// Makes room for joined or isolated rest shapes, which all are the initial ones, unless it is there.
  void add_rest_shapes(const Model& model);
  void add_plastic_inverse();
  /// Nodal arrays grow by copies of the rows `parents`.
  void add_nodes(std::span<const int> parents);
  /// Of each viscoelastic branch of an element.
  std::span<CornerSymmetric> branch_strains_of(int e) {
    const std::size_t branches = branch_strain.size() / std::max<std::size_t>(branch_stretch.size(), 1);
    return std::span(branch_strain).subspan(e * branches, branches);
  }
  std::span<const CornerSymmetric> branch_strains_of(int e) const {
    return const_cast<History*>(this)->branch_strains_of(e);
  }
  /// All of them, which take a step like this.
  Branches branches(std::span<const BranchStep> steps) const {
    return {steps, branch_strain.data(), branch_stretch.data()};
  }
  const CornerTensors* plastic_inverse_of(int e) const {  ///< null where there is none
    return plastic_inverse.empty() ? nullptr : &plastic_inverse[e];
  }

  /// Whether some element that is there has flowed, of isolated rest shapes.
  bool has_isolated_flow() const;

  /// Whether every number of one element is finite, of the arrays that are there; its thresholds may be infinite, but
  /// must be numbers.
  bool is_finite(int e) const;

  /// Every array, in the order above; `version` belongs to the process alone.
  void serialize(Archive& archive);
};

/// Whether some G of an element is not 1.
bool is_flowed(const CornerTensors& plastic_inverse);

/// Whether a joint can have been crossed there.
inline bool is_crossing(double place) { return place >= 0 && place <= 1; }

/// Throws InputError where joints are not there, or opened twice, or not in calls.
void validate_opened(const Model& model, const History& history);

/// Throws InputError where a history cannot be one of this model, its joints being open: arrays of other sizes, numbers
/// that are not finite, removed elements that are alive.
void validate(const Model& model, const History& history);

}  // namespace hexaplast
