// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/component.hpp"
#include "scene/scene_files.hpp"

namespace hexaplast::scene {

/// What holds for a whole scene at a moment.
struct Clock {
  double time = 0;              ///< [s] the running sum t += dt
  double dt = 0;                ///< [s]
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
};

/// Holds components and further nodes, in the order of the scene file.
class Node final : public Object {
 public:
  explicit Node(Node* parent);

  Node* parent() const { return parent_; }
  Node& root() { return parent_ ? parent_->root() : *this; }
  std::string path() const;  ///< "/" for the root, "/bar/inner" below it

  Component& add(std::unique_ptr<Component> component);
  Node& add_child();

  const std::vector<std::unique_ptr<Component>>& components() const { return components_; }
  const std::vector<std::unique_ptr<Node>>& children() const { return children_; }

  /// The root's clock, the same for all nodes.
  Clock& clock() { return root().clock_; }

  /// What the whole scene reads.
  SceneFiles& files() { return root().files_; }

  /// First component of a category or class in this node; null: none.
  template <class T>
  T* local() const {
    for (const auto& component : components_) {
      if (T* found = dynamic_cast<T*>(component.get())) return found;
    }
    return nullptr;
  }

  /// The same in this node or in the nearest node above that has one.
  template <class T>
  T* nearest() const {
    if (T* found = local<T>()) return found;
    return parent_ ? parent_->nearest<T>() : nullptr;
  }

  /// Visits all of a category or class in this node and below, nodes before their children, in the order of the scene
  /// file.
  template <class T, class Visit>
  void for_each(const Visit& visit) const {
    for (const auto& component : components_) {
      if (T* wanted = dynamic_cast<T*>(component.get())) visit(*wanted);
    }
    for (const auto& child : children_) child->for_each<T>(visit);
  }

  template <class T>
  std::vector<T*> all() const {
    std::vector<T*> found;
    for_each<T>([&](T& wanted) { found.push_back(&wanted); });
    return found;
  }

 private:
  Node* parent_;
  Clock clock_;
  SceneFiles files_;
  std::vector<std::unique_ptr<Component>> components_;
  std::vector<std::unique_ptr<Node>> children_;
};

/// Calls visit(path, object) for a node, its components, and what is below.
template <class Visit>
void for_each_object(Node& node, const Visit& visit) {
  const std::string path = node.path();
  visit(path, static_cast<Object&>(node));
  for (const auto& component : node.components())
    visit((path == "/" ? "" : path) + "/" + component->name(), static_cast<Object&>(*component));
  for (const auto& child : node.children()) for_each_object(*child, visit);
}

template <class T>
T& Component::linked(std::string_view attribute) {
  Object* target = find_data(attribute)->target();
  if (!target) return needed<T>();

  T* found = dynamic_cast<T*>(target);
  if (const Node* holder = dynamic_cast<Node*>(target)) found = holder->local<T>();
  if (!found) {
    reject(attribute, "the link leads to " + std::string(target->class_name()) + " '" + target->name() +
                          "', must lead to a " + std::string(T::kCategory));
  }
  require_sound(*found);
  return *found;
}

template <class T>
T& Component::needed() {
  T* found = node().nearest<T>();
  if (!found) reject_missing(T::kCategory);
  require_sound(*found);
  return *found;
}

template <class T>
T& Component::needed_ready() {
  T& found = needed<T>();
  if (found.stage() != Stage::kReady) reject_late(T::kCategory, found);
  return found;
}

}  // namespace hexaplast::scene
