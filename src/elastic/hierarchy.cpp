// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/hierarchy.hpp"

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
  parallel_for(static_cast<int>(children.size()), [&](int cell) {
    for (int i = 0; i < kCorners; ++i)
      for (int which = 0; which < 2; ++which) {
        const int child = children[cell][i];
        float sum = 0;
        for (int s = 0; child >= 0 && s < samples; ++s) {
          const std::size_t at = (static_cast<std::size_t>(fine_place[child] / kBlock) * samples + s) * 2 + which;
          sum += each * static_cast<float>(finer.weight[at * kBlock + fine_place[child] % kBlock]);
        }
        const std::size_t at = (static_cast<std::size_t>(place[cell] / kBlock) * kCorners + i) * 2 + which;
        op.weight[at * kBlock + place[cell] % kBlock] = sum;
      }
  });
}

/// Cells know no assumed strain: what bends freely on a fine mesh bends so on a coarse one by its samples.
Sampling cell_sampling(const Settings& settings) {
  Sampling sampling = sampling_of(settings);
  if (sampling.assumed != Assumed::kNothing) sampling = {};
  return sampling;
}

}  // namespace

ElementHierarchy::Level::Level(const CoarseMesh& mesh)
    : plastic_rest(slot_vector<double>(*mesh.partition)),
      current(slot_vector<double>(*mesh.partition)),
      op(mesh.partition) {
  op.per_sample = true;
  op.resize(std::vector<unsigned char>(mesh.partition->num_blocks, 1));
  std::fill(op.weight.begin(), op.weight.end(), 0.0f);  // of cells that are not there
}

ElementHierarchy::ElementHierarchy(const Model& model) {
  for (const CoarseMesh& mesh : model.coarse_meshes()) levels_.emplace_back(mesh);
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
    level.op.kind.sampling = cell_sampling(model.settings);
    parallel_for(mesh.partition->num_chunks, [&](int chunk) {
      linearize_cells(*mesh.partition, level.plastic_rest.data(), level.current.data(), model.length, chunk, level.op);
    });
    plastic_rest = &level.plastic_rest;
    current = &level.current;
    finer = &level.op;
  }
  return operators_;
}

}  // namespace hexaplast
