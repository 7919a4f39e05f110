// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/hierarchy.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <type_traits>

#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

namespace {

using Moduli = std::array<float, 2>;  // mu, lambda times volume

/// Of an element or a cell of the finer mesh, all samples together.
template <class T, class Coef>
Moduli moduli_of(const ElementOperator<T, Coef>& op, int place) {
  const auto weights = op.weights(place / kBlock, place % kBlock);
  const float mu = kCorners * static_cast<float>(*weights[0]), lambda = kCorners * static_cast<float>(*weights[1]);
  const float of_branches = static_cast<float>(op.kind.branches.in_step) * mu;  //                            eq. P14
  return {mu + of_branches, lambda - of_branches * (2.0f / 3)};
}
Moduli moduli_of(const CellOperator& op, int place) {
  Moduli sum = {0, 0};
  for (int child = 0; child < kCorners; ++child) {
    sum[0] += op.modulus(place, child, CellOperator::kMu);
    sum[1] += op.modulus(place, child, CellOperator::kLambda);
  }
  return sum;
}

template <class Finer>
void gather_moduli(const std::vector<std::array<int, kCorners>>& children, const Finer& finer, CellOperator& op) {
  const std::vector<int>&fine_place = finer.partition().place_of_element, &place = op.partition().place_of_element;
  parallel_for(static_cast<int>(children.size()), [&](int cell) {
    for (int i = 0; i < kCorners; ++i) {
      const int child = children[cell][i];
      const auto [mu, lambda] = child < 0 ? Moduli{0, 0} : moduli_of(finer, fine_place[child]);
      op.modulus(place[cell], i, CellOperator::kMu) = mu;
      op.modulus(place[cell], i, CellOperator::kLambda) = lambda;
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
Mat3 mean_of_children(int place, const AlignedVector<float>& mean_plastic, const CellOperator& op) {
  Mat3 B = Mat3::Zero();
  double sum = 0;
  for (int i = 0; i < kCorners; ++i) {
    const auto w = static_cast<double>(op.modulus(place, i, CellOperator::kMu));
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
      op(mesh.partition),
      diagonal(slot_vector<float>(*mesh.partition)) {
  if (rest_shape == RestShape::kJoined) return;
  mean_plastic.resize(static_cast<std::size_t>(mesh.partition->num_blocks) * kCorners * kMeanPlastic * kBlock);
  for (int place = 0; place < mesh.partition->num_blocks * kBlock; ++place)
    for (int i = 0; i < kCorners; ++i)
      store_mean_plastic(Mat3::Identity(), mean_plastic.data() + of_child(place, i, kMeanPlastic));
}

ElementHierarchy::ElementHierarchy(const Model& model) {
  for (const CoarseMesh& mesh : model.coarse_meshes()) levels_.emplace_back(mesh, model.settings.rest_shape);
  if (levels_.empty()) return;
  cycle_.emplace(model);
  diagonal_ = slot_vector<float>(*model.partition);
}

std::span<const LevelOperator> ElementHierarchy::update(const Model& model, const Linearization& at) {
  if (!cycle_) return {};
  const std::vector<CoarseMesh>& meshes = model.coarse_meshes();
  operators_.assign(1, {&*cycle_, diagonal_, nullptr});
  for (std::size_t k = 0; k < levels_.size(); ++k)
    operators_.push_back({&levels_[k].op, levels_[k].diagonal, &meshes[k]});
  cycle_->set_linearization(at);
  if (revision_ == at.revision) return operators_;
  revision_ = at.revision;
  cycle_->update(model, at);
  find_diagonal(*cycle_, 1.0f, diagonal_);

  const bool has_flowed = std::ranges::any_of(at.has_flowed, [](unsigned char flowed) { return flowed != 0; });
  const AlignedVector<double>*plastic_rest = &at.plastic_rest, *current = &at.current;
  const CellOperator* finer = nullptr;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const CoarseMesh& mesh = meshes[k];
    Level& level = levels_[k];
    mesh.place(*plastic_rest, level.plastic_rest);
    mesh.place(*current, level.current);
    if (finer)
      gather_moduli(mesh.children, *finer, level.op);
    else
      std::visit([&](const auto& op) { gather_moduli(mesh.children, op, level.op); }, at.op);
    if (has_flowed && finer) {
      const std::vector<int>& place = meshes[k - 1].partition->place_of_element;
      const AlignedVector<float>& of_finer = levels_[k - 1].mean_plastic;
      gather_mean_plastic(
          mesh, [&](int cell) { return mean_of_children(place[cell], of_finer, *finer); }, level.mean_plastic);
    } else if (has_flowed) {
      const auto of_element = [&](int e) -> Mat3 {
        const int place = model.partition->place_of_element[e];
        const float* Gm = at.mean_plastic_of(place / kBlock);
        return Gm ? load_mean_plastic(Gm + place % kBlock) : Mat3(Mat3::Identity());
      };
      gather_mean_plastic(mesh, of_element, level.mean_plastic);
    }
    level.op.update(level.plastic_rest.data(), level.current.data(), has_flowed ? level.mean_plastic.data() : nullptr,
                    model.length);
    find_diagonal(level.op, 1.0f, level.diagonal);
    plastic_rest = &level.plastic_rest;
    current = &level.current;
    finer = &level.op;
  }
  return operators_;
}

}  // namespace hexaplast
