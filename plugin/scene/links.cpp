// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/links.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "attributes/texts.hpp"
#include "scene/interfaces.hpp"

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

// The only component of a class in a node.
PathResult member_of_class(const Node& node, std::string_view class_name) {
  PathResult result;
  int count = 0;
  for (const auto& component : node.components()) {
    if (component->class_name() != class_name) continue;
    result.target = component.get();
    ++count;
  }
  if (count <= 1) return result;
  return {.problem = fmt::format("stops at node '{}', which holds {} components of class {}: give them names",
                                 node.path(), count, class_name)};
}

PathResult not_found(const Node& in, std::string_view name) {
  return {.problem = fmt::format("stops at node '{}', which holds no '{}'", in.path(), name),
          .hint = did_you_mean(name, member_names(in))};
}

// By name or, where nothing has the name, the only component of that class; in the node or, if `upwards`, in the
// nearest one above that has it.
PathResult find_member(const Node& from, std::string_view name, bool upwards) {
  const auto above = [&](const Node* node) { return upwards ? node->parent() : nullptr; };
  for (const Node* node = &from; node; node = above(node))
    if (Object* found = member(*node, name)) return {.target = found};
  for (const Node* node = &from; node; node = above(node)) {
    const PathResult found = member_of_class(*node, name);
    if (found.target || !found.problem.empty()) return found;
  }
  return not_found(from, name);
}

std::string describe(const Object& object) { return fmt::format("{} '{}'", object.class_name(), object.name()); }

std::string describe(const Data& data) {
  return fmt::format("{} '{}'.{}", data.owner().class_name(), data.owner().name(), data.attribute().name);
}

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

void refuse_link(Diagnostics& diagnostics, const Data& data, const std::string& link, const std::string& problem,
                 std::string hint = {}) {
  const bool is_by_src = data.place().file.empty();  // that of another attribute says where
  diagnostics.error(is_by_src ? data.owner().place() : data.place(),
                    fmt::format("{}.{}: link '{}' {}", data.owner().class_name(), data.attribute().name, link, problem),
                    std::move(hint));
}

/// Connects links with what they lead to.
class Resolver {
 public:
  explicit Resolver(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void resolve(Data& data) {
    if (!resolved_.insert(&data).second) return;
    auto* const component = dynamic_cast<Component*>(&data.owner());
    Node& node = component ? component->node() : dynamic_cast<Node&>(data.owner());
    const std::string_view path = std::string_view(data.link()).substr(1);
    if (data.attribute().type == Type::kLink) {
      const PathResult found = resolve_path(node, path);
      if (!found.target) return refuse(data, found.problem, found.hint);
      data.point_to(*found.target);
      if (data.attribute().name == kSource) follow_all(data, *found.target);
      return;
    }

    // @path.data: what follows the last dot, unless that dot belongs to the path (`..`, `./`).
    const std::size_t dot = path.rfind('.');
    const bool names_data = dot != path.npos && dot + 1 < path.size() && path.find('/', dot) == path.npos;
    if (!names_data) return refuse(data, "names no attribute: must be @path.attribute");

    const std::string_view holder = dot == 0 ? "." : path.substr(0, dot);
    const PathResult found = resolve_path(node, holder);
    if (!found.target) return refuse(data, found.problem, found.hint);

    const std::string_view name = path.substr(dot + 1);
    if (Data* source = found.target->find_data(name)) return connect(data, *source, data.link());
    auto* const arrays = dynamic_cast<ArraySource*>(found.target);
    if (Data* source = arrays ? arrays->array(name) : nullptr) return connect(data, *source, data.link());
    std::vector<std::string_view> names;
    for (const auto& other : found.target->all_data()) names.push_back(other->attribute().name);
    if (is_unknown(*found.target)) return;
    refuse(data, fmt::format("stops at {}, which has no attribute '{}'", describe(*found.target), name),
           hint_of(*found.target, name, names));
  }

 private:
  void refuse(const Data& data, const std::string& problem, std::string hint = {}) {
    refuse_link(diagnostics_, data, data.link(), problem, std::move(hint));
  }

  static bool is_unknown(const Object& target) { return target.description().category == kUnknown; }

  void connect(Data& data, Data& source, const std::string& link) {
    if (are_compatible(source.attribute(), data.attribute())) {
      data.follow(source, link);
      return;
    }
    const Place& other_end = source.owner().place();
    refuse_link(diagnostics_, data, link,
                fmt::format("leads to {} ({}:{}), which holds {}, must hold {}", describe(source), other_end.file,
                            other_end.line, attributes::describe(source.attribute().type),
                            attributes::describe(data.attribute().type)));
  }

  // src="@loader": every attribute that is not given follows the loader's, where that was given or is computed, but for
  // those that say how the loader itself goes to work.
  void follow_all(Data& src, Object& loader) {
    static constexpr std::string_view kOwnOfLoaders[] = {"filename", "triangulate", "translation",
                                                         "rotation", "scale3d",     "scale"};
    if (&loader == &src.owner()) return refuse(src, "leads back to itself");
    if (Data* its = loader.find_data(kSource); !its->link().empty()) resolve(*its);  // which gives it more
    bool has_common = false;
    for (const auto& source : loader.all_data()) {
      const attributes::Attribute& offered = source->attribute();
      const bool is_common = std::ranges::count(attributes::kCommon, offered.name, &attributes::Attribute::name) > 0;
      if (is_common || offered.access == attributes::Access::kIgnored ||
          std::ranges::count(kOwnOfLoaders, offered.name) > 0)
        continue;
      Data* data = namesake(src.owner(), offered);
      if (!data) continue;
      has_common = true;
      const bool is_computed =
          offered.access == attributes::Access::kOutput || offered.access == attributes::Access::kState;
      if (!data->is_given() && (source->is_given() || is_computed))
        connect(*data, *source, fmt::format("{}.{}", src.link(), offered.name));
    }
    if (!has_common && !is_unknown(loader))
      refuse(src, fmt::format("leads to {}, which has no attribute that belongs here", describe(loader)));
  }

  // The attribute that the scene may set and that has the name of `offered`; null: none.
  static Data* namesake(Object& object, const attributes::Attribute& offered) {
    Data* data = object.find_data(offered.name);
    const bool may_be_set = data && (data->attribute().access == attributes::Access::kInput ||
                                     data->attribute().access == attributes::Access::kState);
    return may_be_set ? data : nullptr;
  }

  static constexpr std::string_view kSource = "src";
  Diagnostics& diagnostics_;
  std::set<const Data*> resolved_;
};

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
void for_each_data(Node& root, const Visit& visit) {
  for_each_object(root, [&](const std::string&, Object& object) {
    for (const auto& data : object.all_data()) visit(*data);
  });
}

}  // namespace

PathResult resolve_path(Node& from, std::string_view path) {
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
    } else if (step != "." && !step.empty()) {
      const PathResult found = find_member(*node, step, may_search_upwards);
      if (!found.target) return found;
      at = found.target;
    }
    may_search_upwards = false;
  }
  return {.target = at};
}

std::string hint_of(const Object& object, std::string_view name, const std::vector<std::string_view>& names) {
  std::string_view instead = attributes::instead_of(fmt::format("{}.{}", object.class_name(), name));
  if (instead.empty()) instead = attributes::instead_of(fmt::format(".{}", name));
  return instead.empty() ? did_you_mean(name, names) : std::string(instead);
}

void resolve_link(Data& data, Diagnostics& diagnostics) { Resolver(diagnostics).resolve(data); }

void resolve_links(Node& root, Diagnostics& diagnostics) {
  Resolver resolver(diagnostics);
  for_each_data(root, [&](Data& data) {
    if (!data.link().empty() && !data.source()) resolver.resolve(data);
  });
  for_each_data(root, [&](Data& data) {
    if (runs_in_a_circle(data)) refuse_link(diagnostics, data, data.link(), "leads back to itself");
  });
}

}  // namespace hexaplast::scene
