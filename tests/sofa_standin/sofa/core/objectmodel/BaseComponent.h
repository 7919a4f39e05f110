// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/Base.h>
#include <sofa/core/objectmodel/BaseContext.h>
#include <sofa/core/objectmodel/Event.h>
#include <sofa/helper/logging/Messaging.h>

namespace sofa::core {
class ExecParams {};
namespace execparams {
inline const ExecParams* defaultInstance() {
  static const ExecParams params;
  return &params;
}
}  // namespace execparams
}  // namespace sofa::core
namespace sofa::core::topology {
class Topology;
}
namespace sofa::core::visual {
class VisualParams;
}

namespace sofa::core::objectmodel {

class BaseComponent : public Base {
 public:
  std::string getPathName() const override { return context_ ? context_->getPathName() + "/" + getName() : getName(); }

  virtual void init() {}
  virtual void bwdInit() {}
  virtual void reinit() {}
  virtual void reset() {}
  virtual void handleEvent(Event*) {}
  virtual void handleTopologyChange(topology::Topology*) {}
  virtual void draw(const visual::VisualParams*) {}
  virtual void computeBBox(const ExecParams*, bool /*only_visible*/ = false) {}

  const BaseContext* getContext() const { return context_; }
  BaseContext* getContext() { return context_; }
  void setContext(BaseContext* context) { context_ = context; }

  Data<bool> f_listening{initData(&f_listening, false, "listening", "Hears of events.")};
  Data<type::BoundingBox> f_bbox{initData(&f_bbox, "bbox", "Encloses what is drawn.")};

 private:
  BaseContext* context_ = nullptr;
};
using BaseObject = BaseComponent;

template <class T>
void BaseContext::collect(std::vector<T*>& found, SearchDirection direction) const {
  for (const auto& object : objects_)
    if (auto* match = dynamic_cast<T*>(object.get())) found.push_back(match);
  if (direction == SearchUp && parent_) parent_->collect(found, SearchUp);
  if (direction == SearchDown)
    for (const auto& child : children_) child->collect(found, SearchDown);
}

template <class T>
T& BaseContext::add(std::shared_ptr<T> object, const std::string& name) {
  object->setName(name);
  object->setContext(this);
  objects_.push_back(object);
  return *object;
}

template <class Call>
void BaseContext::for_each(const Call& call) {
  for (const auto& object : objects_) call(*object);
  for (const auto& child : children_) child->for_each(call);
}

}  // namespace sofa::core::objectmodel
