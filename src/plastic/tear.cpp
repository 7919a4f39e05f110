// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/tear.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "element/samples.hpp"
#include "hexaplast/base/parallel.hpp"
#include "plastic/fracture.hpp"
#include "plastic/isolated_flow.hpp"

namespace hexaplast {

namespace {

constexpr double kEqual = 1e-6;       // relative: a mirrored load tears the mirrored way
constexpr double kLeastStress = 0.5;  // of the fracture stress, that pulls at a face which tears by stress
constexpr double kBehind = 0.3;       // cosine between the ways ahead of a front and behind it: a crack may turn

int number_in(const Hexahedron& corners, int node) {
  return static_cast<int>(std::ranges::find(corners, node) - corners.begin());
}

/// Present node of a hexahedron at an initial one.
int corner_of(const Model& model, int e, int initial_node) {
  return model.mesh.hexahedra()[e][number_in(model.initial_mesh().hexahedra()[e], initial_node)];
}

int side_of(const Joints& joints, int joint, int e) {
  return static_cast<int>(std::ranges::find(joints.across(e), joint) - joints.across(e).begin());
}

Vec3 place_of(ConstPoints x, int node) { return x.row(node).transpose(); }

/// Corners of a face, half the cross product of its diagonals [m^2].
Vec3 area_of(ConstPoints x, const Quad& face) {
  return 0.5 * (place_of(x, face[2]) - place_of(x, face[0])).cross(place_of(x, face[3]) - place_of(x, face[1]));
}

/// tau over its limit. Where it has not grown, and lies beyond, the corner is no nearer to breaking than others.
double stress_ratio(const Material& material, const History& history, int e, int corner) {
  if (!std::isfinite(material.fracture_stress)) return 0;
  const double ratio = history.yield_stress[e][corner] / material.fracture_stress;
  return history.plastic_strain[e][corner] > 0 ? ratio : std::min(ratio, 1.0);
}

double stretch_ratio(const Material& material, const History& history, int e, int corner) {
  return std::isfinite(material.fracture_stretch)
             ? largest_plastic_stretch(history, e, corner) / material.fracture_stretch
             : 0;
}

}  // namespace

Tear::Tear(const Model& model)
    : joints_(model.joints().count(), kClosed),
      is_listed_(model.mesh.num_elements(), 0),
      sides_(model.mesh.num_elements()) {
  broken.reserve(model.mesh.num_elements());
  hexahedra_.reserve(model.mesh.num_elements());
  for (std::vector<int>* list : {&faces_, &staying_}) list->reserve(model.joints().num_faces());
}

std::vector<int> Tear::faces(const Model& model, const History& history, ConstPoints x,
                             std::span<const BranchStep> steps, const CornerForces& forces) {
  if (broken.empty()) return {};
  std::ranges::fill(joints_, kClosed);
  for (const int joint : history.opened) joints_[joint] = kOpen;
  find_candidates(model, history);
  find_sides(model, history, x, steps);
  std::erase_if(faces_,
                [&](int joint) { return !passes(model, history, joint) || !is_greatest(model, history, joint); });
  keep_advancing(model, x, forces);
  return faces_;
}

/// Whether a face still carries load between all of its corners: closed, or opened where no node has split.
bool Tear::holds(const Model& model, int joint) const {
  if (joint < 0) return false;
  if (joints_[joint] != kOpen) return true;
  const std::span<const int> held = model.joints().hexahedra(joint);
  return std::ranges::all_of(model.joints().nodes(joint), [&](int node) {
    return std::ranges::all_of(
        held, [&](int e) { return corner_of(model, e, node) == corner_of(model, held.front(), node); });
  });
}

void Tear::list(const History& history, int element) {
  if (history.alive[element] && !std::exchange(is_listed_[element], 1)) hexahedra_.push_back(element);
}

/// Closed faces of what is broken, to living neighbours; and the hexahedra at all faces that these are compared with.
void Tear::find_candidates(const Model& model, const History& history) {
  const Joints& joints = model.joints();
  const auto is_alive = [&](int e) { return history.alive[e] != 0; };
  faces_.clear();
  hexahedra_.clear();
  for (const int e : broken) list(history, e);
  for (int round = 0; round < 2; ++round) {
    const std::size_t end = hexahedra_.size();
    for (std::size_t k = 0; k < end; ++k)
      for (const int joint : joints.across(hexahedra_[k])) {
        if (!holds(model, joint)) continue;
        for (const int e : joints.hexahedra(joint)) list(history, e);
        if (round > 0 || joints_[joint] != kClosed || std::ranges::count_if(joints.hexahedra(joint), is_alive) < 2)
          continue;
        joints_[joint] = kListed;
        faces_.push_back(joint);
      }
  }
  std::ranges::sort(faces_);
  for (const int joint : faces_) joints_[joint] = kClosed;
  for (const int e : hexahedra_) is_listed_[e] = 0;
}

/// Stress and nearness to the limits on all sides of these hexahedra: means of corner values.
void Tear::find_sides(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps) {
  const Branches branches = history.branches(steps);
  parallel_for(static_cast<int>(hexahedra_.size()), [&](int k) {
    const int e = hexahedra_[k];
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const Material& material = model.material(e);
    const ElementPoints rest = gather(history.plastic_rest_positions, corners);
    const CornerTensors& G = history.plastic_inverse[e];
    const ElementSamples samples =
        element_samples(rest, gather(x, corners), model.lame[e], model.settings, &G, branches.of(e));
    const IsolatedStress stress = isolated_stress(rest, G, samples, YieldStressMeasure::kCauchy);
    CornerValues by_stress, by_stretch;
    for (int i = 0; i < kCorners; ++i) {
      by_stress[i] = stress_ratio(material, history, e, i);
      by_stretch[i] = stretch_ratio(material, history, e, i);
    }
    for (int s = 0; s < 6; ++s) {
      const Vec3 normal = area_of(x, face_of(corners, kFaces[s])).normalized();
      Side& side = sides_[e][s] = {};
      for (const int i : kFaces[s]) {
        const Vec3 turned = samples.polar[i].R.transpose() * normal;
        side.stress += turned.dot(stress.relieved[i] * turned) / 4;
        side.by_stress += by_stress[i] / 4;
        side.by_stretch += by_stretch[i] / 4;
      }
    }
  });
}

/// [Pa] Mean of both sides.
double Tear::normal_stress(const Model& model, const History& history, int joint) const {
  double sum = 0;
  int count = 0;
  for (const int e : model.joints().hexahedra(joint))
    if (history.alive[e]) sum += sides_[e][side_of(model.joints(), joint, e)].stress, ++count;
  return sum / count;
}

/// Whether a face is pulled, and has passed a limit.
bool Tear::passes(const Model& model, const History& history, int joint) const {
  int count = 0;
  double by_stress = 0, by_stretch = 0, stress = 0;  // [-] over the limits
  for (const int e : model.joints().hexahedra(joint)) {
    if (!history.alive[e]) continue;
    const Side& side = sides_[e][side_of(model.joints(), joint, e)];
    ++count;
    by_stress += side.by_stress;
    by_stretch += side.by_stretch;
    stress += side.stress / model.material(e).fracture_stress;
  }
  return normal_stress(model, history, joint) > 0 &&
         ((by_stress >= count && stress >= kLeastStress * count) || by_stretch >= count);
}

/// Whether no other face of its hexahedra is pulled more, be it near its limits or not.
bool Tear::is_greatest(const Model& model, const History& history, int joint) const {
  const double stress = normal_stress(model, history, joint);
  return std::ranges::all_of(model.joints().hexahedra(joint), [&](int e) {
    return !history.alive[e] || std::ranges::all_of(model.joints().across(e), [&](int other) {
      return !holds(model, other) || stress >= (1 - kEqual) * normal_stress(model, history, other);
    });
  });
}

/// Of these, the ones that begin a crack or lead it on. A face counts on those beside it that open too.
void Tear::keep_advancing(const Model& model, ConstPoints x, const CornerForces& forces) {
  for (const int joint : faces_) joints_[joint] = kOpening;
  for (bool has_changed = true; has_changed;) {
    staying_.clear();
    for (const int joint : faces_)
      if (!advances(model, x, forces, joint)) staying_.push_back(joint);
    has_changed = !staying_.empty();
    for (const int joint : staying_) joints_[joint] = kClosed;
    std::erase_if(faces_, [&](int joint) { return joints_[joint] == kClosed; });
  }
}

/// Within two hexahedra of a crack only its front tears, and sets free what that takes.
bool Tear::advances(const Model& model, ConstPoints x, const CornerForces& forces, int joint) {
  const std::span<const int> held = model.joints().hexahedra(joint);
  const auto has_split = [&](int e) {
    return std::ranges::any_of(model.mesh.hexahedra()[e],
                               [&](int node) { return model.copies.of(model.copies.initial()[node]).size() > 1; });
  };
  const bool is_at_crack =
      model.copies.is_split() && std::ranges::any_of(held, [&](int e) {
        return std::ranges::any_of(model.mesh.hexahedra()[e], [&](int node) {
          return std::ranges::any_of(model.mesh.incident(node), has_split, &HexMesh::Incidence::element);
        });
      });
  double needed = 0;  // [J/m^2]
  for (const int e : held) needed += model.material(e).fracture_energy / static_cast<double>(held.size());
  if (!is_at_crack && needed == 0) return true;
  const Release free = release(model, x, forces, joint);
  if (is_at_crack && !free.splits) return false;
  if (!free.is_at_front || needed == 0) return true;
  const Joints::Face& face = model.joints().faces()[joint];
  const Quad nodes = face_of(model.initial_mesh().hexahedra()[face.hexahedron], kFaces[face.side]);
  return free.energy >= needed * area_of(model.initial_mesh().positions(), nodes).norm();
}

/// The hexahedra at a present node that would still be together there.
void Tear::group(const Model& model, int node) {
  const Joints& joints = model.joints();
  around_.all = model.mesh.incident(node);
  around_.groups.assign(static_cast<int>(around_.all.size()));
  const auto join_at = [&](int joint) {
    if (joint < 0 || joints_[joint] != kClosed) return;
    const std::span<const int> held = joints.hexahedra(joint);
    for (const int e : held) around_.groups.join(around_.root(held.front()), around_.root(e));
  };
  for (const auto& [element, corner] : around_.all)
    for (int side = 0; side < 6; ++side)
      if (std::ranges::find(kFaces[side], corner) != kFaces[side].end()) join_at(joints.across(element)[side]);
  for (const int hinge : joints.hinges_at(model.copies.initial()[node]))
    if (around_.has(joints.hexahedra(hinge).front())) join_at(hinge);
}

/// Virtual crack closure: half the force across the face at the nodes that would split, times how far the crack gapes
/// just behind them. A node is shared by the faces that it lies ahead of. Of three hexahedra or more the lowest parts
/// from the others.
Tear::Release Tear::release(const Model& model, ConstPoints x, const CornerForces& forces, int joint) {
  const Joints& joints = model.joints();
  const HexMesh& initial = model.initial_mesh();
  const std::span<const int> held = joints.hexahedra(joint);
  Release found;
  for (const int node : joints.nodes(joint)) {
    group(model, corner_of(model, held.front(), node));
    const bool splits = !around_.are_together(held);
    int num_ahead = 0;
    Vec3 forward = Vec3::Zero(), force = forward, opening = forward;
    for (const auto& [element, corner] : around_.all) {
      for (int side = 0; side < 6; ++side) {
        const int ahead = joints.across(element)[side];
        if (ahead < 0 || joints_[ahead] != kOpening || joints.hexahedra(ahead).front() != element) continue;
        const Quad nodes = face_of(initial.hexahedra()[element], kFaces[side]);
        if (std::ranges::find(nodes, node) == nodes.end()) continue;
        if (splits && around_.are_together(joints.hexahedra(ahead))) continue;
        ++num_ahead;
        for (const int n : nodes) forward += place_of(initial.positions(), n) - place_of(initial.positions(), node);
      }
      if (const int side = splits ? around_.side(held, element) : 0; side != 0)
        force += 0.5 * side * Vec3(forces(element).row(corner).transpose());
    }
    if (!find_opening(model, x, node, forward, held, opening)) continue;
    found.is_at_front = true;
    if (!splits) continue;
    found.splits = true;
    found.energy += 0.5 * force.dot(opening) / num_ahead;
  }
  return found;
}

/// How far the two sides of a crack have parted one edge behind a node at its front, the upper one from the lower one.
/// False where no crack ends at the node.
bool Tear::find_opening(const Model& model, ConstPoints x, int initial_node, const Vec3& forward,
                        std::span<const int> held, Vec3& opening) {
  const Joints& joints = model.joints();
  const std::vector<Hexahedron>& initial = model.initial_mesh().hexahedra();
  const PointArray& X = model.initial_mesh().positions();
  const bool splits = !around_.are_together(held);
  double least = kBehind;
  int count = 0;
  const auto see = [&](int element, int behind, int other) {
    const int one = corner_of(model, element, behind), two = corner_of(model, other, behind);
    const double cosine = forward.normalized().dot((place_of(X, behind) - place_of(X, initial_node)).normalized());
    if (one == two || !(cosine < least + kEqual)) return;
    const double sign = splits ? around_.side(held, element) : 1;
    if (splits && (sign == 0 || around_.side(held, other) != -sign)) return;
    if (cosine < least - kEqual) {
      least = cosine;
      count = 0;
      opening.setZero();
    }
    opening += sign * (place_of(x, one) - place_of(x, two));
    ++count;
  };
  for (const auto& [element, corner] : around_.all)
    for (int side = 0; side < 6; ++side) {
      const Quad& face = kFaces[side];
      const int joint = joints.across(element)[side];
      const auto at = std::ranges::find(face, corner) - face.begin();
      if (joint < 0 || joints_[joint] != kOpen || at == 4) continue;
      for (const int other : joints.hexahedra(joint))
        if (other > element && around_.has(other))
          for (const auto next : {(at + 1) % 4, (at + 3) % 4}) see(element, initial[element][face[next]], other);
    }
  if (count > 0) opening /= count;
  return count > 0;
}

}  // namespace hexaplast
