// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/Base.h>

#include <vector>

namespace sofa::core::topology {
class BaseMeshTopology;
}

namespace sofa::core::objectmodel {

class BaseComponent;

/// A node of the graph, which SOFA keeps in a class of its own.
class BaseContext : public Base {
 public:
  enum SearchDirection { SearchUp = -1, Local = 0, SearchDown = 1 };

  std::string getClassName() const override { return "Node"; }
  std::string getPathName() const override { return parent_ ? parent_->getPathName() + "/" + getName() : ""; }

  SReal getDt() const { return parent_ ? parent_->getDt() : dt_; }
  SReal getTime() const { return parent_ ? parent_->getTime() : time_; }
  bool getAnimate() const { return animate_; }
  void setDt(SReal dt) { dt_ = dt; }
  void setTime(SReal time) { time_ = time; }
  void setAnimate(bool animate) { animate_ = animate; }
  BaseContext* getRootContext() const { return parent_ ? parent_->getRootContext() : const_cast<BaseContext*>(this); }
  topology::BaseMeshTopology* getMeshTopologyLink() const;

  template <class T>
  T* get(SearchDirection direction = SearchUp) const {
    std::vector<T*> found;
    collect(found, direction);
    return found.empty() ? nullptr : found.front();
  }
  template <class T>
  void get(T*& found, SearchDirection direction = SearchUp) const {
    found = get<T>(direction);
  }
  template <class T>
  void get(std::vector<T*>* found, SearchDirection direction = SearchUp) const {
    collect(*found, direction);
  }

  // What a test builds and drives a graph with.
  BaseContext& add_child(const std::string& name) {
    children_.push_back(std::make_unique<BaseContext>());
    children_.back()->parent_ = this;
    children_.back()->setName(name);
    return *children_.back();
  }
  template <class T>
  T& add(std::shared_ptr<T> object, const std::string& name);
  template <class Call>
  void for_each(const Call& call);

 private:
  template <class T>
  void collect(std::vector<T*>& found, SearchDirection direction) const;

  BaseContext* parent_ = nullptr;
  std::vector<std::unique_ptr<BaseContext>> children_;
  std::vector<std::shared_ptr<BaseComponent>> objects_;
  SReal dt_ = 0.01, time_ = 0;
  bool animate_ = true;
};

}  // namespace sofa::core::objectmodel
