// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/state_mapping.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::components {
namespace {

using Quaternions = std::vector<Eigen::Quaterniond>;

/// MechanicalObject of rigid frames.
class RigidObject final : public scene::RigidState {
 public:
  RigidObject() : RigidState(attributes::kRigidObject) {}

  void init() override {
    take_frames();
    if (first_orientations_.empty()) reject("has no frames: needs position or a topology");
    const Vec3 angles = vector3("rotation") * (std::numbers::pi / 180), translation = vector3("translation");
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(angles[2], Vec3::UnitZ()) *
                                    Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
                                    Eigen::AngleAxisd(angles[0], Vec3::UnitX());
    const bool is_turned = !angles.isZero(0);
    for (std::size_t i = 0; i < first_orientations_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      if (is_turned) {
        first_positions_.row(row) = (turn * Vec3(first_positions_.row(row).transpose())).transpose();
        first_orientations_[i] = turn * first_orientations_[i];
      }
      first_positions_.row(row) += translation.transpose();
    }
    first_velocities_ = two_rows_per_frame("velocity");
    external_force_ = two_rows_per_frame("externalForce");
    RigidObject::reset();
  }

  // A link gives the first positions and velocities, and what becomes of its source later does not matter.
  void refresh() override {
    if (find_data("externalForce")->source()) RigidState::refresh();
  }

  void reset() override {
    positions_ = first_positions_;
    velocities_ = first_velocities_;
    orientations_ = first_orientations_;
  }

  void serialize(Archive& archive) override {
    PointArray rows(2 * static_cast<Eigen::Index>(orientations_.size()), 3);
    for (std::size_t i = 0; i < orientations_.size(); ++i) {
      rows.row(static_cast<Eigen::Index>(2 * i)) = orientations_[i].vec().transpose();
      rows.row(static_cast<Eigen::Index>(2 * i + 1)) << orientations_[i].w(), 0, 0;
    }
    archive(positions_, velocities_, rows);
    const Eigen::Index count = first_positions_.rows();
    if (positions_.rows() != count || velocities_.rows() != count || rows.rows() != count || !rows.allFinite())
      throw InputError(fmt::format("the motion of {} frames is saved, there are {}", rows.rows() / 2, count / 2));
    for (std::size_t i = 0; i < orientations_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      orientations_[i].vec() = rows.row(row).transpose();
      orientations_[i].w() = rows(row + 1, 0);
    }
  }

  PointArray& positions() override { return positions_; }
  PointArray& velocities() override { return velocities_; }
  std::span<Eigen::Quaterniond> orientations() override { return orientations_; }
  void add_external_force(Points f) const override { f += external_force_; }

  void provide(scene::Data& output) override {
    if (stage() != Stage::kReady) return;  // until then they hold what the scene gives
    if (output.attribute().name == "velocity")
      return output.set(std::vector<double>(velocities_.data(), velocities_.data() + velocities_.size()));
    std::vector<double> numbers;
    for (int i = 0; i < num_frames(); ++i) {
      const Eigen::Quaterniond& q = orientations_[i];
      for (int d = 0; d < 3; ++d) numbers.push_back(positions_(2 * i, d));
      numbers.insert(numbers.end(), {q.x(), q.y(), q.z(), q.w()});
    }
    output.set(std::move(numbers));
  }

 private:
  void take_frames() {
    const scene::Data& data = *find_data("position");
    const scene::Data* source = data.source();
    const bool are_points = source && source->attribute().type == attributes::Type::kVectors3;
    const std::vector<double>& numbers = reals("position");
    const bool has_topology = is_given("topology") || node().nearest<scene::Topology>();
    if (are_points)
      return take_points(
          Eigen::Map<const PointArray>(numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3));
    // one frame that is given counts unless the topology stands beside it, as in SOFA
    const bool asks_above = numbers.empty() || is_given("topology");
    if (numbers.size() <= 7 && has_topology && (asks_above || node().local<scene::Topology>()))
      if (const PointArray& points = linked<scene::Topology>("topology").positions(); points.rows() > 0)
        return take_points(points);
    if (numbers.size() % 7 != 0)
      reject("position", fmt::format("{} numbers given, must be groups of 7", numbers.size()));
    const auto count = static_cast<Eigen::Index>(numbers.size() / 7);
    first_positions_ = PointArray::Zero(2 * count, 3);
    first_orientations_.clear();
    for (Eigen::Index i = 0; i < count; ++i) {
      const double* p = &numbers[7 * i];
      first_positions_.row(2 * i) << p[0], p[1], p[2];
      const Eigen::Quaterniond q(p[6], p[3], p[4], p[5]);
      if (!(std::abs(q.norm() - 1) < 1e-3))
        reject("position", fmt::format("the quaternion of frame {} has length {:.4g}, must have 1", i, q.norm()));
      first_orientations_.push_back(q.normalized());
    }
  }

  void take_points(const PointArray& points) {
    first_positions_ = PointArray::Zero(2 * points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) first_positions_.row(2 * i) = points.row(i);
    first_orientations_.assign(static_cast<std::size_t>(points.rows()), Eigen::Quaterniond::Identity());
  }

  PointArray two_rows_per_frame(std::string_view name) {
    const PointArray rows = vectors3(name);
    if (rows.rows() == 0) return PointArray::Zero(first_positions_.rows(), 3);
    if (rows.rows() != first_positions_.rows())
      reject(name, fmt::format("{} numbers given for {} frames, must be six for each", 3 * rows.rows(),
                               first_orientations_.size()));
    return rows;
  }

  PointArray positions_, velocities_, external_force_;
  Quaternions orientations_;
  PointArray first_positions_, first_velocities_;  // what reset returns to
  Quaternions first_orientations_;
};

/// Points p = c + r of frames, with the arm r = R p_local: dp = dc + turn x r.
class RigidMapping final : public StateMapping<scene::RigidState> {
 public:
  RigidMapping() : StateMapping(attributes::kRigidMapping) {}

  void apply_positions(ConstPoints above, Points below) override {
    std::vector<Mat3> rotations;
    for (int frame = 0; frame < input_->num_frames(); ++frame)
      rotations.emplace_back(input_->orientation_at(frame, above).toRotationMatrix());
    for (Eigen::Index i = 0; i < local_.rows(); ++i) {
      const int frame = frames_[i];
      arms_.row(i) = (rotations[frame] * local_.row(i).transpose()).transpose();
      below.row(i) = above.row(2 * frame) + arms_.row(i);
    }
  }
  void apply(ConstPoints above, Points below) const override {
    for (Eigen::Index i = 0; i < local_.rows(); ++i)
      below.row(i) = above.row(2 * frames_[i]) + cross(above.row(2 * frames_[i] + 1), arms_.row(i));
  }
  void add_transposed(ConstPoints below, Points above) const override {
    for (Eigen::Index i = 0; i < local_.rows(); ++i) {
      above.row(2 * frames_[i]) += below.row(i);
      above.row(2 * frames_[i] + 1) += cross(arms_.row(i), below.row(i));
    }
  }
  void add_transposed_blocks(const BlockMatrix& below, BlockMatrix& above) const override {
    for (int i = 0; i < below.num_nodes(); ++i)
      for (const BlockMatrix::Entry& entry : below.row(i)) {
        const int a = 2 * frames_[i], b = 2 * frames_[entry.column];
        const Mat3 left = lever(i), right = lever(entry.column).transpose();
        above.add(a, b, entry.block);
        above.add(a + 1, b, left * entry.block);
        above.add(a, b + 1, entry.block * right);
        above.add(a + 1, b + 1, left * entry.block * right);
      }
    for (const auto& [factor, u] : below.rank_ones()) {
      PointArray carried = PointArray::Zero(above.num_nodes(), 3);
      add_transposed(u, carried);
      above.add_rank_one(factor, carried);
    }
  }
  bool is_left(std::span<const int>, const scene::SurvivingCells&) const override { return true; }

 private:
  [[noreturn]] void reject_input() override {
    reject("needs rigid frames (a MechanicalObject with template Rigid3d) above");
  }

  void carry(scene::VisualModel&) override {
    remark(scene::Severity::kNote, {}, "carries a surface with a rigid frame, which pictures do not show");
  }

  void connect(scene::RigidState& above, scene::MechanicalState& below) override {
    const PointArray given = vectors3("initialPoints");
    local_ = given.rows() > 0 ? given : below.positions();
    const Eigen::Index count = local_.rows();
    if (count != below.num_nodes())
      reject("initialPoints", fmt::format("{} points given for {} of the mapped state", count, below.num_nodes()));
    take_frames(above.num_frames(), static_cast<std::size_t>(count));
    if (given.rows() == 0 && boolean("globalToLocalCoords"))
      for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 arm = (local_.row(i) - above.positions().row(2 * frames_[i])).transpose();
        local_.row(i) = (above.orientations()[frames_[i]].conjugate() * arm).transpose();
      }
    arms_ = PointArray::Zero(count, 3);
    apply_positions(above.positions(), below.positions());
  }

  void take_frames(int num_frames, std::size_t num_points) {
    const std::vector<int> each = indices("rigidIndexPerPoint", num_frames);
    if (each.size() == num_points) {
      frames_ = each;
      return;
    }
    if (!each.empty())
      remark(scene::Severity::kWarning, "rigidIndexPerPoint",
             fmt::format("{} frames given for {} points: index counts", each.size(), num_points));
    const int index = integer("index");
    if (index >= num_frames) reject("index", fmt::format("{} must lie in [0, {})", index, num_frames));
    frames_.assign(num_points, boolean("indexFromEnd") ? num_frames - 1 - index : index);
  }

  static Eigen::RowVector3d cross(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) { return a.cross(b); }

  /// r x, as a matrix.
  Mat3 lever(Eigen::Index i) const {
    const Eigen::RowVector3d r = arms_.row(i);
    return (Mat3() << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0).finished();
  }

  std::vector<int> frames_;  // of each point
  PointArray local_;         // [m] in its frame
  PointArray arms_;          // [m] from the origin of its frame, at the latest positions
};

}  // namespace

void add_rigid_states(scene::Factory& factory) {
  factory.add<RigidObject>(attributes::kRigidObject);
  factory.add<RigidMapping>(attributes::kRigidMapping);
}

}  // namespace hexaplast::components
