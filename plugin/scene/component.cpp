// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/component.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "attributes/stock.hpp"
#include "scene/node.hpp"

namespace hexaplast::scene {

void Component::follow_inputs() {
  if (looks_by_itself()) return;
  const std::span<const std::string_view> changed = new_inputs();
  if (changed.empty()) return;
  auto* changeable = dynamic_cast<Changeable*>(this);
  if (!changeable)
    reject(changed.front(), "follows a link to something that changes during the run, which it cannot do");
  changeable->refresh(changed);
  accept_inputs();
}

void Component::reject_missing(std::string_view category) {
  reject(fmt::format("needs a {} in its node or above", category));
}

void Component::reject_late(std::string_view category, const Component& other) {
  const bool is_before = other.place().file == place().file && other.place().line < place().line;
  reject(is_before ? fmt::format("is asked for by a component of a node above, which comes before its {} ('{}') is "
                                 "initialised: put that component into a node behind this one",
                                 category, other.name())
                   : fmt::format("needs its {} ('{}') before it in the scene", category, other.name()));
}

void Component::require_sound(const Component& other) const {
  if (other.stage() == Stage::kFailed) throw DependencyFailure();
}

Node::Node(Node* parent) : Object(attributes::kNode), parent_(parent) {}

std::string Node::path() const {
  if (!parent_) return "/";
  const std::string above = parent_->path();
  return above == "/" ? above + name() : above + "/" + name();
}

Component& Node::add(std::unique_ptr<Component> component) {
  component->node_ = this;
  components_.push_back(std::move(component));
  return *components_.back();
}

Node& Node::add_child() {
  children_.push_back(std::make_unique<Node>(this));
  return *children_.back();
}

}  // namespace hexaplast::scene
