// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/links.hpp"

#include <fmt/format.h>

#include <charconv>

namespace hexaplast::scene {
namespace {

using attributes::Type;

Object* member(const Node& node, std::string_view name) {
  for (const auto& child : node.children()) {
    if (child->name() == name) return child.get();
  }
  for (const auto& component : node.components()) {
    if (component->name() == name) return component.get();
  }
  return nullptr;
}

std::vector<std::string_view> member_names(const Node& node) {
  std::vector<std::string_view> names;
  for (const auto& child : node.children()) names.push_back(child->name());
  for (const auto& component : node.components()) names.push_back(component->name());
  return names;
}

// `[-1]`: the component one place before `self` in its node; `[2]` two places after.
PathResult relative_component(const Component* self, std::string_view step) {
  int offset = 0;
  const char* const last = step.data() + step.size() - 1;
  const auto [end, error] = std::from_chars(step.data() + 1, last, offset);
  if (error != std::errc() || end != last) return {.problem = fmt::format("'{}' is not a relative index", step)};
  if (!self) return {.problem = "a relative index has no meaning here"};

  const auto& siblings = self->node().components();
  for (std::size_t i = 0; i < siblings.size(); ++i) {
    if (siblings[i].get() != self) continue;
    const long wanted = static_cast<long>(i) + offset;
    if (wanted < 0 || wanted >= static_cast<long>(siblings.size())) break;
    return {.target = siblings[wanted].get()};
  }
  return {.problem = fmt::format("no component at '{}'", step)};
}

// Components have one name, nodes none of their own kind above: the first name is searched upwards.
Object* first_member_upwards(const Node& from, std::string_view name) {
  for (const Node* node = &from; node; node = node->parent()) {
    if (Object* found = member(*node, name)) return found;
  }
  return nullptr;
}

PathResult not_found(const Node& in, std::string_view name) {
  return {.problem = fmt::format("stops at node '{}', which holds no '{}'", in.path(), name),
          .hint = did_you_mean(name, member_names(in))};
}

std::string describe(const Object& object) { return fmt::format("{} '{}'", object.class_name(), object.name()); }

// Data of different type can follow one another where they hold the same kind of numbers.
bool are_compatible(const attributes::Attribute& from, const attributes::Attribute& to) {
  const auto kind = [](Type type) {
    if (type == Type::kVector3 || type == Type::kVectors3 || type == Type::kBoxes) return Type::kReals;
    if (type == Type::kWord) return Type::kText;
    return type == Type::kHexahedra ? Type::kIntegers : type;
  };
  const bool same_groups = to.type != Type::kVectors3 || from.type == Type::kVectors3 || from.type == Type::kVector3;
  return kind(from.type) == kind(to.type) && same_groups;
}

void resolve(Data& data, Node& node, const Component* self, Diagnostics& diagnostics) {
  const std::string where = fmt::format("{}.{}", data.owner().class_name(), data.attribute().name);
  const std::string_view path = std::string_view(data.link()).substr(1);
  const auto refuse = [&](const std::string& problem, std::string hint = {}) {
    diagnostics.error(data.place(), fmt::format("{}: link '{}' {}", where, data.link(), problem), std::move(hint));
  };

  if (data.attribute().type == Type::kLink) {
    const PathResult found = resolve_path(node, self, path);
    if (found.target) {
      data.point_to(*found.target);
    } else {
      refuse(found.problem, found.hint);
    }
    return;
  }

  // @path.data: what follows the last dot, unless that dot belongs to the path (`..`, `./`).
  const std::size_t dot = path.rfind('.');
  const bool names_data = dot != path.npos && dot > 0 && dot + 1 < path.size() && path.find('/', dot) == path.npos;
  if (!names_data) return refuse("names no attribute: must be @path.attribute");

  const PathResult found = resolve_path(node, self, path.substr(0, dot));
  if (!found.target) return refuse(found.problem, found.hint);

  const std::string_view name = path.substr(dot + 1);
  Data* source = found.target->find_data(name);
  if (!source) {
    std::vector<std::string_view> names;
    for (const auto& other : found.target->all_data()) names.push_back(other->attribute().name);
    return refuse(fmt::format("stops at {}, which has no attribute '{}'", describe(*found.target), name),
                  did_you_mean(name, names));
  }
  if (!are_compatible(source->attribute(), data.attribute())) {
    return refuse(fmt::format("leads to {}.{}, which is of another type", describe(*found.target), name));
  }
  data.follow(*source);
}

bool runs_in_a_circle(const Data& data) {
  // Two pointers, one twice as fast: they meet only in a circle.
  const Data* slow = &data;
  const Data* fast = data.source();
  while (fast && fast->source()) {
    if (slow == fast) return true;
    slow = slow->source();
    fast = fast->source()->source();
  }
  return false;
}

template <class Visit>
void for_each_data(Node& node, const Visit& visit) {
  for (const auto& data : node.all_data()) visit(*data, node, nullptr);
  for (const auto& component : node.components()) {
    for (const auto& data : component->all_data()) visit(*data, node, component.get());
  }
  for (const auto& child : node.children()) for_each_data(*child, visit);
}

}  // namespace

PathResult resolve_path(Node& from, const Component* self, std::string_view path) {
  Node* node = &from;
  bool may_search_upwards = true;
  if (path.starts_with('/')) {
    node = &from.root();
    may_search_upwards = false;
    path.remove_prefix(1);
    if (path.empty()) return {.target = node};
  }
  if (path.empty()) return {.problem = "is empty"};

  Object* at = node;
  while (!path.empty()) {
    const std::size_t slash = path.find('/');
    const std::string_view step = path.substr(0, slash);
    path = slash == path.npos ? std::string_view() : path.substr(slash + 1);

    node = dynamic_cast<Node*>(at);
    if (!node) return {.problem = fmt::format("stops at {}, which holds nothing", describe(*at))};
    if (step == "..") {
      if (!node->parent()) return {.problem = fmt::format("stops at node '{}', which has no parent", node->path())};
      at = node->parent();
    } else if (step.size() > 2 && step.front() == '[' && step.back() == ']') {
      const PathResult sibling = relative_component(self, step);
      if (!sibling.target) return sibling;
      at = sibling.target;
    } else if (step != "." && !step.empty()) {
      at = may_search_upwards ? first_member_upwards(*node, step) : member(*node, step);
      if (!at) return not_found(*node, step);
    }
    may_search_upwards = false;
  }
  return {.target = at};
}

void resolve_links(Node& root, Diagnostics& diagnostics) {
  for_each_data(root, [&](Data& data, Node& node, const Component* self) {
    if (!data.link().empty()) resolve(data, node, self, diagnostics);
  });
  for_each_data(root, [&](Data& data, Node&, const Component*) {
    if (!runs_in_a_circle(data)) return;
    diagnostics.error(data.place(), fmt::format("{}.{}: link '{}' leads back to itself", data.owner().class_name(),
                                                data.attribute().name, data.link()));
  });
}

}  // namespace hexaplast::scene
