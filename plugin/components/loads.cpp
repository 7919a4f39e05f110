// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/corners.hpp"
#include "parts/spread_nodes.hpp"
#include "scene/interfaces.hpp"
#include "solve/contact_loads.hpp"

namespace hexaplast::components {
namespace {

/// Prescribed forces: they do not depend on velocity and have no stiffness.
class PrescribedLoad : public scene::ForceField,
                       public scene::Changeable,
                       public scene::Load,
                       public scene::FollowsNodes {
 public:
  using ForceField::ForceField;

  void add_force(double time, ConstPoints x, ConstPoints v, Points f) final { add_load(time, x, v, f); }
  std::span<const int> loaded_nodes() const override { return loaded_; }
  bool is_in_matrix() const override { return false; }
  void refresh(std::span<const std::string_view>) override { init(); }
  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (acts_on(*this, state)) spread_load(state);
  }

 protected:
  virtual void spread_load(const scene::MechanicalState& state) = 0;  ///< to the copies of its nodes

  void note_loaded(std::vector<int> nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    loaded_ = std::move(nodes);
  }

  scene::MechanicalState& state() { return needed_ready<scene::MechanicalState>(); }
  int num_nodes() { return state().num_initial_nodes(); }

 private:
  std::vector<int> loaded_;
};

class ConstantForceField final : public PrescribedLoad {
 public:
  ConstantForceField() : PrescribedLoad(attributes::kConstantForceField) {}

  void init() override {
    const int count = num_nodes();
    given_ = indices("indices", count);
    if (given_.empty()) {
      given_.resize(static_cast<std::size_t>(count));
      std::iota(given_.begin(), given_.end(), 0);
    }
    forces_ = forces_of_nodes();
    spread_load(state());
  }

  void add_load(double, ConstPoints, ConstPoints, Points f) const override {
    for (std::size_t i = 0; i < spread_.nodes.size(); ++i)
      f.row(spread_.nodes[i]) += spread_.shares[i] * forces_.row(spread_.entries[i]);
  }

 private:
  void spread_load(const scene::MechanicalState& state) override {
    spread_ = parts::spread(given_, state.copies());
    note_loaded(spread_.nodes);
  }

  PointArray forces_of_nodes() {
    const auto count = static_cast<Eigen::Index>(given_.size());
    if (is_given("forces")) {
      if (is_given("totalForce")) remark(scene::Severity::kWarning, "totalForce", "is ignored: forces counts");
      const PointArray given = vectors3("forces");
      if (given.rows() == 1) return given.replicate(count, 1);
      if (given.rows() != count)
        reject("forces", fmt::format("{} forces given for {} nodes, must be one or as many", given.rows(), count));
      return given;
    }
    if (!is_given("totalForce")) reject("forces", "is not given, and totalForce neither: one of them is needed");
    return (vector3("totalForce") / static_cast<double>(count)).transpose().replicate(count, 1);
  }

  std::vector<int> given_;  // initial nodes
  parts::SpreadNodes spread_;
  PointArray forces_;  // [N] one row per initial node
};

class LinearForceField final : public PrescribedLoad {
 public:
  LinearForceField() : PrescribedLoad(attributes::kLinearForceField) {}

  void init() override {
    given_ = indices("points", num_nodes());
    forces_ = vectors3("forces");
    times_ = key_times(*this, "times", "forces", static_cast<std::size_t>(forces_.rows()));
    factor_ = real("force");
    spread_load(state());
  }

  void add_load(double time, ConstPoints, ConstPoints, Points f) const override {
    const KeyPhase phase = phase_at(times_, time);
    if (phase.key < 0) return;
    const bool is_over = phase.key + 1 == forces_.rows();  // then SOFA leaves the factor out
    const Eigen::RowVector3d force = (is_over ? 1 : factor_) * interpolate(phase, forces_);
    for (std::size_t i = 0; i < spread_.nodes.size(); ++i) f.row(spread_.nodes[i]) += spread_.shares[i] * force;
  }

 private:
  void spread_load(const scene::MechanicalState& state) override {
    spread_ = parts::spread(given_, state.copies());
    note_loaded(spread_.nodes);
  }

  std::vector<int> given_;  // initial nodes
  parts::SpreadNodes spread_;
  std::vector<double> times_;  // [s]
  PointArray forces_;          // [N] one row per time
  double factor_ = 1;
};

/// Faces of a topology with a load on them, until they go with torn hexahedra: a load on nothing would drive off the
/// nodes that are left of it.
class FaceLoad : public PrescribedLoad, public scene::Stateful {
 public:
  using PrescribedLoad::PrescribedLoad;

  void hexahedra_removed(const scene::ForceField&, std::span<const int>) override {
    has_lost_faces_ = true;
    find_faces();
  }
  void refresh(std::span<const std::string_view>) override {
    init();
    if (has_lost_faces_ || state().copies()) find_faces();
  }
  void reset() override {
    if (has_lost_faces_) init();
    has_lost_faces_ = false;
  }
  void serialize(Archive& archive) override {
    if (archive.reads()) reset();
    archive(has_lost_faces_);
    if (archive.reads() && (has_lost_faces_ || state().copies())) find_faces();
  }

 protected:
  /// Of the faces that it was given: those that are left, with their present nodes.
  virtual void take_faces(const scene::PresentCells& present, const scene::SurvivingCells& surviving) = 0;
  void find_faces() { take_faces(scene::PresentCells(state()), scene::SurvivingCells(state())); }
  void spread_load(const scene::MechanicalState&) override { find_faces(); }

  scene::Topology& fitting_topology() {
    scene::Topology& topology = linked<scene::Topology>("topology");
    require_same_nodes(*this, topology, num_nodes());
    return topology;
  }

  template <std::size_t N>
  void require_nodes(const std::vector<std::array<int, N>>& faces) {
    const int count = num_nodes();
    for (const std::array<int, N>& face : faces)
      for (const int node : face)
        if (node >= count) reject(fmt::format("a face has node {}, the mechanical state has {} nodes", node, count));
  }

 private:
  bool has_lost_faces_ = false;
};

/// How many of the faces lie between two of the hexahedra.
long num_between(std::span<const Quad> faces, std::span<const Hexahedron> hexahedra) {
  std::vector<Quad> sides;
  sides.reserve(kFaces.size() * hexahedra.size());
  for (const Hexahedron& hexahedron : hexahedra)
    for (const auto& side : kFaces) sides.push_back(sorted(face_of(hexahedron, side)));
  std::ranges::sort(sides);
  return std::ranges::count_if(faces, [&](const Quad& face) {
    const auto [first, last] = std::equal_range(sides.begin(), sides.end(), sorted(face));
    return last - first > 1;
  });
}

class SurfacePressureForceField final : public FaceLoad {
 public:
  SurfacePressureForceField() : FaceLoad(attributes::kSurfacePressureForceField) {}

  void bwd_init() override {
    std::vector<Quad> loaded = quads_;
    std::erase_if(loaded, [&](const Quad& face) { return !lies_in_box(face, state().positions()); });
    if (const long inside = num_between(loaded, fitting_topology().hexahedra()); inside > 0)
      remark(scene::Severity::kWarning, {},
             fmt::format("{} of {} quads lie between two hexahedra, and load the inside of the body", inside,
                         loaded.size()));
  }

  void init() override {
    scene::Topology& topology = fitting_topology();
    given_quads_ = topology.quads();
    given_triangles_ = topology.triangles();
    require_nodes<4>(given_quads_);
    require_nodes<3>(given_triangles_);
    quads_ = given_quads_;
    triangles_ = given_triangles_;

    const Vec3 min = vector3("min"), max = vector3("max");
    const bool is_everywhere = min.isZero(0) && max.isZero(0);
    box_.reset();
    if (!is_everywhere) box_.emplace(min, max);
    pressure_ = real("pressure");
    note_faces();
  }

  void add_load(double, ConstPoints x, ConstPoints, Points f) const override {
    for (const Quad& face : quads_)
      if (lies_in_box(face, x)) add_pressure(face, pressure_, x, f);
    for (const Triangle& face : triangles_)
      if (lies_in_box(face, x)) add_pressure(face, pressure_, x, f);
  }

 private:
  void take_faces(const scene::PresentCells& present, const scene::SurvivingCells& surviving) override {
    const auto take = [&](auto& faces, const auto& given) {
      faces.clear();
      for (const auto& face : given)
        if (const auto now = present(face); surviving.has(now)) faces.push_back(now);
    };
    take(quads_, given_quads_);
    take(triangles_, given_triangles_);
  }

  template <std::size_t N>
  bool lies_in_box(const std::array<int, N>& face, ConstPoints x) const {
    return !box_ || std::ranges::all_of(face, [&](int node) { return box_->contains(Vec3(x.row(node).transpose())); });
  }

  // Those of the beginning, where the box decides.
  void note_faces() {
    const PointArray& x = needed_ready<scene::MechanicalState>().positions();
    std::vector<int> nodes;
    for (const Quad& face : quads_)
      if (lies_in_box(face, x)) nodes.insert(nodes.end(), face.begin(), face.end());
    for (const Triangle& face : triangles_)
      if (lies_in_box(face, x)) nodes.insert(nodes.end(), face.begin(), face.end());
    if (nodes.empty()) remark(scene::Severity::kWarning, {}, "acts on no face");
    note_loaded(std::move(nodes));
  }

  std::vector<Quad> given_quads_, quads_;  // by their initial nodes, and by their present ones
  std::vector<Triangle> given_triangles_, triangles_;
  std::optional<Eigen::AlignedBox3d> box_;  // none: faces count everywhere
  double pressure_ = 0;                     // [Pa]
};

class PlaneForceField final : public scene::ForceField,
                              public scene::Changeable,
                              public scene::Load,
                              public scene::FollowsNodes {
 public:
  PlaneForceField() : ForceField(attributes::kPlaneForceField) {}

  void init() override {
    const auto& state = needed_ready<scene::MechanicalState>();
    obstacle_ = {.normal = vector3("normal"),
                 .distance = real("d"),
                 .stiffness = real("stiffness"),
                 .damping = real("damping"),
                 .max_force = real("maxForce"),
                 .share = state.copies() ? state.copies()->share() : std::vector<double>()};
    rayleigh_stiffness_ = real("rayleighStiffness");
    if (obstacle_.normal.isZero(0)) reject("normal", "is zero, must have a direction");
    if (std::abs(obstacle_.normal.norm() - 1) > 1e-6)
      remark(
          scene::Severity::kWarning, "normal",
          fmt::format("has length {:.6g}: it is taken as it is, and scales depth and force", obstacle_.normal.norm()));
  }
  void refresh(std::span<const std::string_view>) override { init(); }
  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (acts_on(*this, state)) obstacle_.share = state.copies()->share();
  }

  void add_force(double, ConstPoints x, ConstPoints v, Points f) override {
    obstacle_.stiff_at(x, v, stiff_);
    obstacle_.add_force(x, v, f);
  }
  void add_load(double, ConstPoints x, ConstPoints v, Points f) const override { obstacle_.add_force(x, v, f); }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    obstacle_.add_stiffness_product(stiff_, factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    obstacle_.add_stiffness_blocks(stiff_, factor, A);
  }
  bool is_in_matrix() const override { return !stiff_.empty(); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

 private:
  Obstacle obstacle_;
  std::vector<int> stiff_;  // nodes, at the positions of the latest forces
  double rayleigh_stiffness_ = 0;
};

}  // namespace

void add_loads(scene::Factory& factory) {
  factory.add<ConstantForceField>(attributes::kConstantForceField);
  factory.add<LinearForceField>(attributes::kLinearForceField);
  factory.add<SurfacePressureForceField>(attributes::kSurfacePressureForceField);
  factory.add<PlaneForceField>(attributes::kPlaneForceField);
}

}  // namespace hexaplast::components
