// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "attributes/stock.hpp"
#include "attributes/texts.hpp"
#include "formats/readable_file.hpp"
#include "hexaplast/base/error.hpp"
#include "scene/document.hpp"
#include "scene/links.hpp"

namespace hexaplast::scene {
namespace {

using attributes::Access;
using attributes::Description;

/// What RequiredPlugin leaves in the graph; the reader itself loads what it names.
class RequiredPlugin final : public Component {
 public:
  RequiredPlugin() : Component(attributes::kRequiredPlugin) {}

  std::vector<std::string> plugins() {
    const std::string& names = is_given("pluginName") ? text("pluginName") : name();
    std::vector<std::string> result;
    for (const std::string_view word : split_words(names)) result.emplace_back(word);
    return result;
  }
};

/// Stands for an unknown component, which is an error by itself: links to it are none.
struct ForeignClass {
  std::string class_name;
  Description description;
};
class Placeholder final : private ForeignClass, public Component {
 public:
  explicit Placeholder(std::string_view name)
      : ForeignClass{std::string(name), {}}, Component(ForeignClass::description) {
    ForeignClass::description.class_name = ForeignClass::class_name;
    ForeignClass::description.category = kUnknown;
    ForeignClass::description.takes_anything = true;
  }
};

void visit_elements(Node& node, Element& element, const std::function<void(Object&, Element&)>& visit) {
  std::size_t num_components = 0, num_children = 0;
  for (Element& child : element.children)
    if (child.tag != "Node")
      visit(*node.components().at(num_components++), child);
    else
      visit_elements(*node.children().at(num_children++), child, visit);
  visit(node, element);
}

/// Makes the graph of a scene from its elements.
class Reader {
 public:
  Reader(Scene& scene, const Factory& factory, PluginLoader& plugins)
      : scene_(scene), diagnostics_(scene.diagnostics()), factory_(factory), plugins_(plugins) {}

  void read(const Element& root) {
    if (root.tag != "Node") {
      diagnostics_.error(root.place, fmt::format("the root element is <{}>, must be <Node>", root.tag));
      return;
    }
    read_node(root, scene_.root());
    add_animation_loop(scene_.root());
  }

 private:
  void read_node(const Element& element, Node& node) {
    const ElementAttribute* given_name = element.find("name");
    node.introduce(given_name ? given_name->value : default_name(node.parent(), "Node"), element.place, diagnostics_);
    read_attributes(element, node, {"name"});
    warn_of_clock(node);
    warn_of_twin(node.parent(), node);
    if (element.text)
      diagnostics_.error(*element.text,
                         fmt::format("Node '{}': holds text, must hold nodes and components", node.name()));
    for (const Element& child : element.children) read_member(child, node);
  }

  void read_member(const Element& element, Node& node) {
    if (element.tag == "Node") {
      read_node(element, node.add_child());
    } else if (element.tag != "Object") {
      read_component(element, element.tag, node);
    } else if (const ElementAttribute* type = element.find("type")) {
      read_component(element, type->value, node);
    } else {
      diagnostics_.error(element.place, "Object.type: is not given, must be the class of a component");
    }
  }

  void read_component(const Element& element, std::string_view class_name, Node& node) {
    std::unique_ptr<Component> made = class_name == attributes::kRequiredPlugin.class_name
                                          ? std::make_unique<RequiredPlugin>()
                                          : factory_.make(class_name);
    if (!made) {
      refuse_class(element.place, class_name);
      made = std::make_unique<Placeholder>(class_name);
    }

    Component& component = node.add(std::move(made));
    const ElementAttribute* given_name = element.find("name");
    component.introduce(given_name ? given_name->value : default_name(&node, class_name), element.place, diagnostics_);
    warn_of_twin(&node, component);
    if (component.description().takes_anything) return;

    read_template(element, component);
    read_attributes(element, component, {"name", "template", element.tag == "Object" ? "type" : "name"});
    const auto refuse_content = [&](const Place& place) {
      diagnostics_.error(place, fmt::format("{}: components hold neither elements nor text", class_name));
    };
    for (const Element& child : element.children) refuse_content(child.place);
    if (element.text) refuse_content(*element.text);
    if (auto* required = dynamic_cast<RequiredPlugin*>(&component)) {
      if (given_name || required->is_given("pluginName")) {
        load_plugins(*required);
      } else {
        diagnostics_.error(element.place, "RequiredPlugin: names no plugin: needs name or pluginName");
      }
    }
  }

  void refuse_class(const Place& place, std::string_view class_name) {
    std::vector<std::string_view> known = {"Node", attributes::kRequiredPlugin.class_name};
    for (const Description* description : factory_.descriptions()) known.push_back(description->class_name);
    std::string hint(attributes::instead_of(class_name));
    if (hint.empty()) {
      hint = did_you_mean(class_name, known);
      hint += fmt::format("{} scene with other components of SOFA runs in SOFA, with the plugin Hexaplast",
                          hint.empty() ? "a" : " A");
    }
    diagnostics_.error(place, fmt::format("{}: unknown component", class_name), std::move(hint));
  }

  void load_plugins(RequiredPlugin& required) {
    for (const std::string& plugin : required.plugins()) {
      try {
        plugins_.load(plugin);
      } catch (const PluginError& error) {
        throw PluginError(format_error(required.place(), fmt::format("RequiredPlugin: {}", error.what())));
      }
    }
  }

  void read_attributes(const Element& element, Object& object, std::array<std::string_view, 3> taken) {
    for (const ElementAttribute& attribute : element.attributes)
      if (std::ranges::count(taken, attribute.name) == 0) read_attribute(attribute, object);
  }

  void read_attribute(const ElementAttribute& attribute, Object& object) {
    const std::string where = fmt::format("{}.{}", object.class_name(), attribute.name);
    Data* data = object.find_data(attribute.name);
    if (!data && std::ranges::count(split_words(attributes::kPassedOver), attribute.name) > 0) return;
    if (!data) {
      std::vector<std::string_view> known;
      for (const auto& other : object.all_data())
        if (other->attribute().access != Access::kOutput) known.push_back(other->attribute().name);
      const std::string similar = hint_of(object, attribute.name, known);
      diagnostics_.error(
          attribute.place, where + ": unknown attribute",
          similar.empty() ? fmt::format("'hexaplast list {}' shows its attributes", object.class_name()) : similar);
      return;
    }
    try {
      data->read(attribute.value, attribute.place);
    } catch (const InputError& error) {
      diagnostics_.error(attribute.place, fmt::format("{}: {}", where, error.what()));
    }
  }

  // Everything here is in three dimensions and double precision: other templates would mean something else.
  void read_template(const Element& element, const Component& component) {
    const ElementAttribute* given = element.find("template");
    if (!given) return;
    const std::vector<std::string_view> accepted = split_words(component.description().templates);
    if (std::ranges::count(accepted, std::string_view(given->value)) > 0) return;
    const std::string allowed = accepted.empty() ? "there is none for this component"
                                                 : fmt::format("must be one of: {}", component.description().templates);
    diagnostics_.error(given->place,
                       fmt::format("{}.template: '{}', {}", component.class_name(), given->value, allowed));
  }

  std::string default_name(const Node* node, std::string_view class_name) {
    if (!node) return "root";
    Names& names = names_[node];
    std::string name;
    do {
      name = fmt::format("{}{}", class_name, ++names.counter[std::string(class_name)]);
    } while (names.taken.count(name) > 0);
    return name;
  }

  void warn_of_twin(const Node* node, Object& object) {
    if (!node || names_[node].taken.insert(object.name()).second) return;
    object.remark(
        Severity::kWarning, "name",
        fmt::format("'{}' is the name of another member of this node: links find the first one", object.name()));
  }

  // SOFA gives a root without animation loop the default one.
  void add_animation_loop(Node& root) {
    const std::string_view class_name = attributes::kDefaultAnimationLoop.class_name;
    std::unique_ptr<Component> loop = root.local<AnimationLoop>() ? nullptr : factory_.make(class_name);
    if (!loop) return;
    root.add(std::move(loop)).introduce(default_name(&root, class_name), root.place(), diagnostics_);
    root.remark(Severity::kNote, {}, "has no animation loop: a DefaultAnimationLoop is added");
  }

  static void warn_of_clock(Node& node) {
    if (!node.parent()) return;
    for (const std::string_view attribute : {"dt", "gravity"}) {
      if (node.is_given(attribute)) node.remark(Severity::kWarning, attribute, "is ignored: only the root's counts");
    }
  }

  struct Names {
    std::unordered_set<std::string> taken;
    std::unordered_map<std::string, int> counter;  // per class, of default names
  };

  Scene& scene_;
  Diagnostics& diagnostics_;
  std::unordered_map<const Node*, Names> names_;
  const Factory& factory_;
  PluginLoader& plugins_;
};

}  // namespace

Scene read_scene_text(std::string_view text, const std::string& name, const Factory& factory, PluginLoader& plugins,
                      const SearchPath& search) {
  Scene scene;
  SceneFiles& files = scene.root().files();
  files.inputs.add(name);
  files.search = search;
  const Element root = read_document(text, name, scene.diagnostics(), &files.inputs, search);
  Reader(scene, factory, plugins).read(root);
  return scene;
}

void require_readable(const std::filesystem::path& file) {
  if (const std::string reason = why_unreadable(file); !reason.empty())
    throw FileError(format_error({file.string(), 0}, reason));
}

Scene read_scene(const std::filesystem::path& file, const Factory& factory, PluginLoader& plugins,
                 const SearchPath& search) {
  std::string text;
  try {
    text = read_scene_file(file);
  } catch (const InputError& error) {
    throw FileError(format_error({file.string(), 0}, error.what()));
  }
  return read_scene_text(text, file.string(), factory, plugins, search);
}

void for_each_element(Scene& scene, Element& document, const std::function<void(Object&, Element&)>& visit) {
  visit_elements(scene.root(), document, visit);
}

Data& named_attribute(Scene& scene, std::string_view name, std::string_view words) {
  const auto refuse = [&](const std::string& what, const std::string& hint = {}) {
    throw OverrideError(format_error({std::string(words), 0}, what, hint));
  };
  const std::size_t dot = name.rfind('.');
  if (dot == name.npos) refuse("must be PATH.attribute=VALUE; the root's own attributes are .attribute=VALUE");
  std::string_view path = name.substr(0, dot);
  const std::string_view attribute = name.substr(dot + 1);

  Object* target = &scene.root();
  // the root may be named or left out
  if (path == scene.root().name()) path = {};
  if (const std::string prefix = scene.root().name() + "/"; path.starts_with(prefix)) path.remove_prefix(prefix.size());
  if (!path.empty()) {
    const PathResult found = resolve_path(scene.root(), path);
    if (!found.target) refuse(found.problem, found.hint);
    target = found.target;
  }

  Data* data = target->find_data(attribute);
  if (data && data->attribute().name == "name")
    refuse(fmt::format("the name of {} '{}' cannot be replaced: paths and links find it by that", target->class_name(),
                       target->name()));
  if (!data) {
    std::vector<std::string_view> known;
    for (const auto& other : target->all_data()) known.push_back(other->attribute().name);
    refuse(fmt::format("{} '{}' has no attribute '{}'", target->class_name(), target->name(), attribute),
           hint_of(*target, attribute, known));
  }
  return *data;
}

void override_attribute(Scene& scene, std::string_view assignment, std::string_view option) {
  const std::string words = fmt::format("{} {}", option, assignment);
  const std::size_t equals = assignment.find('=');
  // without one there is no value, and the name is not looked for
  Data& data = named_attribute(scene, equals == assignment.npos ? "" : assignment.substr(0, equals), words);
  try {
    data.read(assignment.substr(equals + 1), {words, 0});
  } catch (const InputError& error) {
    throw OverrideError(format_error(
        {words, 0}, fmt::format("{}.{}: {}", data.owner().class_name(), data.attribute().name, error.what())));
  }
  if (data.link().empty()) return;
  Diagnostics found;
  resolve_link(data, found);
  try {
    found.throw_errors();
  } catch (const SceneError& error) {
    throw OverrideError(error.what());
  }
}

}  // namespace hexaplast::scene
