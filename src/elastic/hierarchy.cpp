// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/hierarchy.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <type_traits>

#include "elastic/element_pass.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

namespace {

/// Weights of the samples: what the children weigh in all.
template <class Finer>
void gather_weights(const std::vector<std::array<int, kCorners>>& children, const Finer& finer,
                    ElementOperator<float, float>& op) {
  const std::vector<int>&fine_place = finer.partition().place_of_element, &place = op.partition().place_of_element;
  const int samples = finer.per_sample ? kCorners : 1;
  const float each = finer.per_sample ? 1.0f : static_cast<float>(kCorners);
  const auto branch_modulus = finer.per_sample ? 0.0f : static_cast<float>(finer.kind.branch_modulus);
  parallel_for(static_cast<int>(children.size()), [&](int cell) {
    for (int i = 0; i < kCorners; ++i) {
      const int child = children[cell][i];
      float sum[2] = {0, 0};
      for (int which = 0; which < 2; ++which)
        for (int s = 0; child >= 0 && s < samples; ++s) {
          const std::size_t at = (static_cast<std::size_t>(fine_place[child] / kBlock) * samples + s) * 2 + which;
          sum[which] += each * static_cast<float>(finer.weight[at * kBlock + fine_place[child] % kBlock]);
        }
      const float of_branches = branch_modulus * sum[0];  //                                                  eq. P14
      sum[0] += of_branches;
      sum[1] -= of_branches * (2.0f / 3);
      for (int which = 0; which < 2; ++which) {
        const std::size_t at = (static_cast<std::size_t>(place[cell] / kBlock) * kCorners + i) * 2 + which;
        op.weight[at * kBlock + place[cell] % kBlock] = sum[which];
      }
    }
  });
}

/// A Gm among those of a block.
Mat3 load_mean_plastic(const float* from) {
  Mat3 Gm = Mat3::Zero();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) Gm(r, c) = static_cast<double>(from[of_mean_plastic(r, c) * kBlock]);
  return Gm;
}
void store_mean_plastic(const Mat3& Gm, float* to) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) to[of_mean_plastic(r, c) * kBlock] = static_cast<float>(Gm(r, c));
}

/// Where [block][child][count][cell] begins for a cell.
std::size_t of_child(int place, int child, int count) {
  return (static_cast<std::size_t>(place / kBlock) * kCorners + child) * count * kBlock + place % kBlock;
}

/// Of a cell: the Gm that its children have in the mean, by their weights.                                     eq. P2
Mat3 mean_of_children(int place, const AlignedVector<float>& mean_plastic, const AlignedVector<float>& weight) {
  Mat3 B = Mat3::Zero();
  double sum = 0;
  for (int i = 0; i < kCorners; ++i) {
    const double w = static_cast<double>(weight[of_child(place, i, 2)]);
    if (!(w > 0)) continue;
    const Mat3 Gm = load_mean_plastic(mean_plastic.data() + of_child(place, i, kMeanPlastic));
    B += w * Gm * Gm.transpose();
    sum += w;
  }
  if (!(sum > 0)) return Mat3::Identity();
  return Mat3(B / sum).llt().matrixL();
}

/// Sets the Gm of all children; of(child): that of an element or cell of the finer mesh.
template <class Of>
void gather_mean_plastic(const CoarseMesh& mesh, const Of& of, AlignedVector<float>& mean_plastic) {
  parallel_for(static_cast<int>(mesh.children.size()), [&](int cell) {
    for (int i = 0; i < kCorners; ++i) {
      const int child = mesh.children[cell][i];
      store_mean_plastic(child < 0 ? Mat3(Mat3::Identity()) : of(child),
                         mean_plastic.data() + of_child(mesh.partition->place_of_element[cell], i, kMeanPlastic));
    }
  });
}

}  // namespace

ElementHierarchy::Level::Level(const CoarseMesh& mesh, RestShape rest_shape)
    : plastic_rest(slot_vector<double>(*mesh.partition)),
      current(slot_vector<double>(*mesh.partition)),
      op(mesh.partition) {
  op.per_sample = true;
  op.resize(std::vector<unsigned char>(mesh.partition->num_blocks, 1));
  std::fill(op.weight.begin(), op.weight.end(), 0.0f);  // of cells that are not there
  if (rest_shape == RestShape::kJoined) return;
  mean_plastic.resize(static_cast<std::size_t>(mesh.partition->num_blocks) * kCorners * kMeanPlastic * kBlock);
  for (int place = 0; place < mesh.partition->num_blocks * kBlock; ++place)
    for (int i = 0; i < kCorners; ++i)
      store_mean_plastic(Mat3::Identity(), mean_plastic.data() + of_child(place, i, kMeanPlastic));
}

ElementHierarchy::ElementHierarchy(const Model& model) {
  for (const CoarseMesh& mesh : model.coarse_meshes()) levels_.emplace_back(mesh, model.settings.rest_shape);
  if (!levels_.empty()) cycle_.emplace(model);
}

std::span<const CoarseOperator> ElementHierarchy::update(const Model& model, const Linearization& at) {
  const std::vector<CoarseMesh>& meshes = model.coarse_meshes();
  operators_.clear();
  for (std::size_t k = 0; k < levels_.size(); ++k) operators_.push_back({&levels_[k].op, &meshes[k]});
  if (cycle_) cycle_->set_linearization(at);
  if (revision_ == at.revision) return operators_;
  revision_ = at.revision;
  if (cycle_) cycle_->update(model, at);

  const bool has_flowed = std::ranges::any_of(at.has_flowed, [](unsigned char flowed) { return flowed != 0; });
  const AlignedVector<double>*plastic_rest = &at.plastic_rest, *current = &at.current;
  const ElementOperator<float, float>* finer = nullptr;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const CoarseMesh& mesh = meshes[k];
    Level& level = levels_[k];
    mesh.place(*plastic_rest, level.plastic_rest);
    mesh.place(*current, level.current);
    if (finer)
      gather_weights(mesh.children, *finer, level.op);
    else
      std::visit([&](const auto& op) { gather_weights(mesh.children, op, level.op); }, at.op);
    if (has_flowed && finer) {
      const std::vector<int>& place = meshes[k - 1].partition->place_of_element;
      const AlignedVector<float>& of_finer = levels_[k - 1].mean_plastic;
      gather_mean_plastic(
          mesh, [&](int cell) { return mean_of_children(place[cell], of_finer, finer->weight); }, level.mean_plastic);
    } else if (has_flowed) {
      const auto of_element = [&](int e) -> Mat3 {
        const int place = model.partition->place_of_element[e];
        const float* Gm = at.mean_plastic_of(place / kBlock);
        return Gm ? load_mean_plastic(Gm + place % kBlock) : Mat3(Mat3::Identity());
      };
      gather_mean_plastic(mesh, of_element, level.mean_plastic);
    }
    parallel_for(mesh.partition->num_chunks, [&](int chunk) {
      linearize_cells(*mesh.partition, level.plastic_rest.data(), level.current.data(),
                      has_flowed ? level.mean_plastic.data() : nullptr, model.length, chunk, level.op);
    });
    plastic_rest = &level.plastic_rest;
    current = &level.current;
    finer = &level.op;
  }
  return operators_;
}

}  // namespace hexaplast
