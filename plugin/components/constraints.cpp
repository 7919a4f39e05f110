// SPDX-License-Identifier: LGPL-2.1-or-later
#include <numeric>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

class FixedProjectiveConstraint final : public scene::ProjectiveConstraint {
 public:
  FixedProjectiveConstraint() : ProjectiveConstraint(attributes::kFixedProjectiveConstraint) {}

  void init() override {
    const int num_nodes = needed_ready<scene::MechanicalState>().num_nodes();
    if (boolean("fixAll")) {
      nodes_.resize(num_nodes);
      std::iota(nodes_.begin(), nodes_.end(), 0);
    } else {
      nodes_ = indices("indices", num_nodes);
    }
  }
  void refresh() override { init(); }

  void project(Points field) const override {
    for (const int node : nodes_) field.row(node).setZero();
  }
  void pin(BlockMatrix& A) const override {
    for (const int node : nodes_)
      for (int axis = 0; axis < 3; ++axis) A.pin(node, axis);
  }

 private:
  std::vector<int> nodes_;
};

}  // namespace

void add_constraints(scene::Factory& factory) {
  factory.add<FixedProjectiveConstraint>(attributes::kFixedProjectiveConstraint);
}

}  // namespace hexaplast::components
