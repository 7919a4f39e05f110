// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/recovery.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/polar.hpp"

namespace hexaplast {

namespace {

// [-] d_1 of isolated rest shapes that have flowed: the springs pull to the initial shape, which is no longer theirs.
constexpr double kFromFlowed = -0.5;

/// s_e of an element by itself.                                                                          eq. E22, E27
double pull_of(double corner_ratio, double from, double full) {
  if (from <= full) return corner_ratio < from ? 1 : 0;
  return std::clamp((from - corner_ratio) / (from - full), 0.0, 1.0);
}

// Nodes up to which what is rigid in a cluster is assembled, as blocks of all its nodes with one another. What is left
// out costs the direct solver about six solutions for each cluster: of many small ones, the most of a step.
constexpr int kMaxDenseNodes = 200;

/// The inverse of a symmetric positive semi-definite matrix, zero along axes of (nearly) no value: springs that lie on
/// a line do not feel turns about it.
Mat3 pseudo_inverse(const Mat3& A) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  const double min = 1e-9 * eigen.eigenvalues()[2];
  const auto inverse = [&](double value) { return value > min ? 1 / value : 0; };
  const Vec3 values = eigen.eigenvalues().unaryExpr(inverse);
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

double Recovery::from(const Settings& settings) {
  if (settings.recovery == RecoveryMode::kNone) return -std::numeric_limits<double>::infinity();
  return settings.rest_shape == RestShape::kIsolated ? std::max(CornerEnergy::kFrom, settings.recovery_from)
                                                     : settings.recovery_from;
}

void Recovery::find(const Model& model, const History& history, std::span<const std::uint16_t> thin,
                    ConstPoints current) {
  const Settings& settings = model.settings;
  const ConstPoints plastic_rest = history.plastic_rest_positions;
  corners_.clear();
  springs_.clear();
  clusters_.clear();
  energy_ = 0;
  const std::vector<Hexahedron>& hexahedra = model.mesh.hexahedra();
  const int num_elements = model.mesh.num_elements(), num_nodes = model.mesh.num_nodes();
  bool has_folded = false;
  for (int block = 0; block < model.partition->num_blocks; ++block)
    for (int place = 0; thin[block] >> place != 0; ++place) {
      const int e = model.partition->element(block, place);
      if (!(thin[block] >> place & 1) || e < 0 || !history.alive[e]) continue;
      const ElementPoints x = gather(plastic_rest, hexahedra[e]), at = gather(current, hexahedra[e]);
      if (settings.rest_shape == RestShape::kIsolated)
        corners_.add(hexahedra[e], model.lame[e].mu, model.volume[e], x, at);
      const CornerValues ratio = corner_ratios(x, at);
      const double least = *std::min_element(ratio.begin(), ratio.end());
      const bool flowed = !history.has_flowed.empty() && history.has_flowed[e];
      const double s = pull_of(least, flowed ? kFromFlowed : settings.recovery_from, settings.recovery_full);
      if (!(s > 0)) continue;
      if (!has_folded) pull_.assign(num_nodes, 0);
      has_folded = true;
      for (const int n : hexahedra[e]) pull_[n] = std::max(pull_[n], s);
    }
  if (!has_folded) return;

  weight_.assign(num_nodes, 0);
  sets_.assign(num_nodes);
  for (int e = 0; e < num_elements; ++e) {
    if (!history.alive[e]) continue;
    double s = 0;
    for (const int n : hexahedra[e]) s = std::max(s, pull_[n]);
    if (!(s > 0)) continue;
    const double k = s * settings.recovery_strength * model.lame[e].mu * std::cbrt(model.volume[e]) / 2;
    for (const int n : hexahedra[e]) {
      weight_[n] += k;
      sets_.join(hexahedra[e][0], n);
    }
  }

  // nodes of a cluster side by side, clusters by their first node
  cluster_.assign(num_nodes, -1);
  count_.clear();
  for (int n = 0; n < num_nodes; ++n) {
    if (!(weight_[n] > 0)) continue;
    int& cluster = cluster_[sets_.root(n)];
    if (cluster < 0) {
      cluster = static_cast<int>(count_.size());
      count_.push_back(0);
    }
    ++count_[cluster];
  }
  clusters_.resize(count_.size());
  int place = 0;
  for (std::size_t c = 0; c < count_.size(); ++c) {
    clusters_[c].first = clusters_[c].last = place;
    place += count_[c];
  }
  springs_.resize(place);
  for (int n = 0; n < num_nodes; ++n)
    if (weight_[n] > 0)
      springs_[clusters_[cluster_[sets_.root(n)]].last++] = {
          .node = n, .weight = weight_[n], .arm = Vec3::Zero(), .residual = Vec3::Zero()};

  for (Cluster& cluster : clusters_) {
    for (const Spring& spring : springs_of(cluster)) cluster.weight += spring.weight;
    const auto [rest_centre, centre, R] = placement(cluster, plastic_rest, current);
    Mat3 inertia = Mat3::Zero();
    for (int k = cluster.first; k < cluster.last; ++k) {
      Spring& spring = springs_[k];
      spring.arm = current.row(spring.node).transpose() - centre;
      spring.residual = spring.arm - R * (plastic_rest.row(spring.node).transpose() - rest_centre);
      energy_ += spring.weight / 2 * spring.residual.squaredNorm();
      inertia += spring.weight * (spring.arm.squaredNorm() * Mat3::Identity() - spring.arm * spring.arm.transpose());
    }
    cluster.inverse_inertia = pseudo_inverse(inertia);
  }
}

Recovery::Placement Recovery::placement(const Cluster& cluster, ConstPoints plastic_rest, ConstPoints current) const {
  Placement found{.rest_centre = Vec3::Zero(), .centre = Vec3::Zero(), .R = Mat3::Identity()};
  for (const Spring& spring : springs_of(cluster)) {
    found.rest_centre += spring.weight / cluster.weight * plastic_rest.row(spring.node).transpose();
    found.centre += spring.weight / cluster.weight * current.row(spring.node).transpose();
  }
  Mat3 moments = Mat3::Zero();
  for (const Spring& spring : springs_of(cluster))
    moments += spring.weight * (current.row(spring.node).transpose() - found.centre) *
               (plastic_rest.row(spring.node) - found.rest_centre.transpose());
  found.R = polar(moments).R;
  return found;
}

double Recovery::spring_energy_at(ConstPoints plastic_rest, ConstPoints current) const {
  double energy = 0;
  for (const Cluster& cluster : clusters_) {
    const Placement at = placement(cluster, plastic_rest, current);
    for (const Spring& spring : springs_of(cluster))
      energy += spring.weight / 2 *
                (current.row(spring.node).transpose() - at.centre -
                 at.R * (plastic_rest.row(spring.node).transpose() - at.rest_centre))
                    .squaredNorm();
  }
  return energy;
}

void Recovery::add_force(Points f) const {
  corners_.add_force(f);
  for (const Spring& spring : springs_) f.row(spring.node) -= spring.weight * spring.residual.transpose();
}

void Recovery::add_product(double factor, ConstPoints p, Points Fp) const {
  corners_.add_product(factor, p, Fp);
  for (const Cluster& cluster : clusters_) {
    const std::span<const Spring> springs = springs_of(cluster);
    Vec3 shift = Vec3::Zero(), moment = Vec3::Zero();
    for (const Spring& spring : springs) {
      const Vec3 along = p.row(spring.node).transpose();
      shift += spring.weight / cluster.weight * along;
      moment += spring.weight * spring.arm.cross(along);
    }
    const Vec3 turn = cluster.inverse_inertia * moment;
    for (const Spring& spring : springs)
      Fp.row(spring.node) +=
          factor * spring.weight * (p.row(spring.node).transpose() - shift - turn.cross(spring.arm)).transpose();
  }
}

void Recovery::add_diagonal(double factor, Points diagonal) const {
  corners_.add_diagonal(factor, diagonal);
  for (const Spring& spring : springs_) diagonal.row(spring.node).array() += factor * spring.weight;
}

void Recovery::add_blocks(double factor, BlockMatrix& K) const {
  corners_.add_blocks(factor, K);
  for (const Spring& spring : springs_) K.add(spring.node, spring.node, factor * spring.weight * Mat3::Identity());
  const auto cross = [](const Vec3& r) { return Mat3{{0, -r.z(), r.y()}, {r.z(), 0, -r.x()}, {-r.y(), r.x(), 0}}; };
  for (const Cluster& cluster : clusters_) {
    const std::span<const Spring> springs = springs_of(cluster);
    if (std::ssize(springs) > kMaxDenseNodes) {
      K.leave_out();
      continue;
    }
    // minus W (mean + turn) of add_product, for the displacement of one node b at another a
    for (const Spring& a : springs) {
      const Mat3 turned = cross(a.arm).transpose() * cluster.inverse_inertia;
      for (const Spring& b : springs)
        K.add(a.node, b.node,
              -factor * a.weight * b.weight * (Mat3::Identity() / cluster.weight + turned * cross(b.arm)));
    }
  }
}

}  // namespace hexaplast
