// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <vector>

namespace sofa::core::objectmodel {

/// What others depend on, or what depends on others: out of date once one of its inputs is.
class DDGNode {
 public:
  DDGNode() = default;
  DDGNode(const DDGNode&) = delete;
  virtual ~DDGNode() = default;

  virtual void update() = 0;

  void addOutput(DDGNode* output) {
    outputs_.push_back(output);
    output->inputs_.push_back(this);
    output->setDirtyValue();
  }
  void delInput(DDGNode* input) {
    std::erase(input->outputs_, this);
    std::erase(inputs_, input);
  }
  void setDirtyValue() {
    if (is_dirty_) return;
    is_dirty_ = true;
    set_outputs_dirty();
  }
  void cleanDirty() { is_dirty_ = false; }
  void updateIfDirty() const {
    if (is_dirty_) const_cast<DDGNode*>(this)->update();
  }

 protected:
  void set_outputs_dirty() {
    for (DDGNode* output : outputs_) output->setDirtyValue();
  }
  void update_inputs() const {
    for (const DDGNode* input : inputs_) input->updateIfDirty();
  }

 private:
  std::vector<DDGNode*> inputs_, outputs_;
  bool is_dirty_ = false;
};

}  // namespace sofa::core::objectmodel
