// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/reader.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <unordered_map>
#include <unordered_set>

#include "attributes/stock.hpp"
#include "hexaplast/base/error.hpp"
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

[[noreturn]] void refuse_file(const std::string& file, int line, const std::string& what) {
  throw SceneError(format_error({file, line}, what));
}

// Bytes of the UTF-8 sequence that begins at `at`; 0 when it is not well-formed (overlong, surrogate, beyond U+10FFFF,
// cut off).
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u; };
  const auto continues = [&](std::size_t i) { return (byte(i) & 0xC0) == 0x80; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned least = first == 0xE0 ? 0xA0 : 0x80, most = first == 0xED ? 0x9F : 0xBF;
    return byte(1) >= least && byte(1) <= most && continues(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned least = first == 0xF0 ? 0x90 : 0x80, most = first == 0xF4 ? 0x8F : 0xBF;
    return byte(1) >= least && byte(1) <= most && continues(2) && continues(3) ? 4 : 0;
  }
  return 0;
}

// A reference must be one of XML's five entities or a character number: the parser would leave others in the text as
// they are.
bool is_known_reference(std::string_view from_ampersand) {
  const std::size_t end = from_ampersand.substr(0, 16).find(';');
  if (end == from_ampersand.npos) return false;
  const std::string_view name = from_ampersand.substr(1, end - 1);
  static constexpr std::array<std::string_view, 5> kEntities = {"amp", "lt", "gt", "quot", "apos"};
  if (std::ranges::count(kEntities, name) > 0) return true;
  if (name.size() < 2 || name[0] != '#') return false;
  const bool is_hexadecimal = name[1] == 'x';
  const std::string_view digits = name.substr(is_hexadecimal ? 2 : 1);
  const std::string_view allowed = is_hexadecimal ? "0123456789abcdefABCDEF" : "0123456789";
  return !digits.empty() && digits.find_first_not_of(allowed) == digits.npos;
}

// Refuses what the XML parser would let pass.
void screen(std::string_view text, const std::string& file) {
  int line = 1;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--") || rest.starts_with("<![CDATA[")) {
      const std::string_view closing = rest[2] == '-' ? "-->" : "]]>";
      const std::size_t end = std::min(text.find(closing, at + 4), text.size());
      for (; at < end; ++at) {
        const std::size_t length = utf8_length(text, at);
        if (text[at] == '\0' || length == 0) break;  // reported below
        if (text[at] == '\n') ++line;
        at += length - 1;
      }
      if (at >= end) continue;
    }

    const std::size_t length = utf8_length(text, at);
    if (text[at] == '\0') refuse_file(file, line, "the file contains a NUL byte: must be text");
    if (length == 0) refuse_file(file, line, "the file is not valid UTF-8");
    if (rest.starts_with("<!DOCTYPE") || rest.starts_with("<!ENTITY")) {
      refuse_file(file, line, "document types and entities are not allowed in a scene");
    }
    if (text[at] == '&' && !is_known_reference(rest)) {
      refuse_file(file, line, "unknown entity: only &amp; &lt; &gt; &quot; &apos; and character numbers are allowed");
    }
    if (text[at] == '\n') ++line;
    at += length;
  }
}

bool is_switched_off(std::string_view attribute) { return attribute.starts_with("_") || attribute.starts_with("NO"); }

class Reader {
 public:
  Reader(Scene& scene, std::string file, const Factory& factory, PluginLoader& plugins)
      : scene_(scene),
        diagnostics_(scene.diagnostics()),
        file_(std::move(file)),
        factory_(factory),
        plugins_(plugins) {}

  void read(const tinyxml2::XMLElement& root) {
    if (std::string_view(root.Name()) != "Node") {
      diagnostics_.error(place(root), fmt::format("the root element is <{}>, must be <Node>", root.Name()));
      return;
    }
    read_node(root, scene_.root());
    add_animation_loop(scene_.root());
  }

 private:
  Place place(const tinyxml2::XMLNode& node) const { return {file_, node.GetLineNum()}; }
  Place place(const tinyxml2::XMLAttribute& attribute) const { return {file_, attribute.GetLineNum()}; }

  void read_node(const tinyxml2::XMLElement& element, Node& node) {
    const char* given_name = element.Attribute("name");
    node.introduce(given_name ? given_name : default_name(node.parent(), "Node"), place(element), diagnostics_);
    read_attributes(element, node, {"name"});
    warn_of_clock(node);
    warn_of_twin(node.parent(), node);

    for (const tinyxml2::XMLNode* child = element.FirstChild(); child; child = child->NextSibling()) {
      if (const tinyxml2::XMLElement* inner = child->ToElement()) {
        read_member(*inner, node);
      } else if (child->ToText() || child->ToUnknown()) {
        diagnostics_.error(place(*child),
                           fmt::format("Node '{}': holds text, must hold nodes and components", node.name()));
      }
    }
  }

  void read_member(const tinyxml2::XMLElement& element, Node& node) {
    const std::string_view tag = element.Name();
    if (tag == "Node") {
      read_node(element, node.add_child());
      return;
    }

    const bool is_generic = tag == "Object";
    const char* type = is_generic ? element.Attribute("type") : element.Name();
    if (!type) {
      diagnostics_.error(place(element), "Object.type: is not given, must be the class of a component");
      return;
    }
    read_component(element, type, is_generic, node);
  }

  void read_component(const tinyxml2::XMLElement& element, std::string_view class_name, bool is_generic, Node& node) {
    std::unique_ptr<Component> made = class_name == attributes::kRequiredPlugin.class_name
                                          ? std::make_unique<RequiredPlugin>()
                                          : factory_.make(class_name);
    if (!made) {
      std::vector<std::string_view> known = {"Node", attributes::kRequiredPlugin.class_name};
      for (const Description* description : factory_.descriptions()) known.push_back(description->class_name);
      diagnostics_.error(place(element), fmt::format("{}: unknown component", class_name),
                         did_you_mean(class_name, known));
      return;
    }

    Component& component = node.add(std::move(made));
    const char* given_name = element.Attribute("name");
    component.introduce(given_name ? given_name : default_name(&node, class_name), place(element), diagnostics_);
    read_template(element, component);
    read_attributes(element, component, {"name", "template", is_generic ? "type" : "name"});
    warn_of_twin(&node, component);

    for (const tinyxml2::XMLNode* child = element.FirstChild(); child; child = child->NextSibling()) {
      if (child->ToComment()) continue;
      diagnostics_.error(place(*child), fmt::format("{}: components hold neither elements nor text", class_name));
    }
    if (auto* required = dynamic_cast<RequiredPlugin*>(&component)) {
      for (const std::string& plugin : required->plugins()) load_plugin(plugin, component.place());
    }
  }

  void load_plugin(const std::string& name, const Place& required_at) {
    try {
      plugins_.load(name);
    } catch (const PluginError& error) {
      throw PluginError(format_error(required_at, fmt::format("RequiredPlugin: {}", error.what())));
    }
  }

  void read_attributes(const tinyxml2::XMLElement& element, Object& object, std::array<std::string_view, 3> taken) {
    for (const tinyxml2::XMLAttribute* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
      const std::string_view name = attribute->Name();
      if (std::ranges::count(taken, name) > 0 || is_switched_off(name)) continue;
      read_attribute(*attribute, object);
    }
  }

  void read_attribute(const tinyxml2::XMLAttribute& attribute, Object& object) {
    const std::string where = fmt::format("{}.{}", object.class_name(), attribute.Name());
    Data* data = object.find_data(attribute.Name());
    if (!data) {
      if (object.description().takes_anything) return;
      std::vector<std::string_view> known;
      for (const auto& other : object.all_data()) {
        if (other->attribute().access != Access::kOutput) known.push_back(other->attribute().name);
      }
      diagnostics_.error(place(attribute), where + ": unknown attribute", did_you_mean(attribute.Name(), known));
      return;
    }
    if (data->is_given()) {
      diagnostics_.error(place(attribute), where + ": is given twice, the other time under another name");
      return;
    }
    try {
      data->read(attribute.Value(), place(attribute));
    } catch (const InputError& error) {
      diagnostics_.error(place(attribute), fmt::format("{}: {}", where, error.what()));
    }
  }

  // Everything here is in three dimensions and double precision: other templates would mean something else.
  void read_template(const tinyxml2::XMLElement& element, const Component& component) {
    const tinyxml2::XMLAttribute* given = element.FindAttribute("template");
    if (!given || component.description().takes_anything) return;
    const std::vector<std::string_view> accepted = split_words(component.description().templates);
    if (std::ranges::count(accepted, std::string_view(given->Value())) > 0) return;
    const std::string allowed = accepted.empty() ? "there is none for this component"
                                                 : fmt::format("must be one of: {}", component.description().templates);
    diagnostics_.error(place(*given),
                       fmt::format("{}.template: '{}', {}", component.class_name(), given->Value(), allowed));
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
  std::string file_;
  const Factory& factory_;
  PluginLoader& plugins_;
};

std::string read_whole(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& what) { throw FileError(format_error({file.string(), 0}, what)); };
  std::error_code failure;
  if (!std::filesystem::exists(file, failure)) refuse("no such file");
  if (!std::filesystem::is_regular_file(file, failure)) refuse("is not a file");
  const std::uintmax_t size = std::filesystem::file_size(file, failure);
  if (size > kLargestSceneFile) refuse(fmt::format("{} bytes, a scene has at most {}", size, kLargestSceneFile));

  std::string text(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (!stream) refuse("cannot be read");
  return text;
}

std::string explain(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file holds no element, must hold one <Node>";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return fmt::format("more than {} levels of elements", TINYXML2_MAX_ELEMENT_DEPTH);
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is closed by another one's end, or not at all";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is given twice, or is not of the form name=\"value\"";
    default:
      return fmt::format("not well-formed XML ({})", document.ErrorName());
  }
}

}  // namespace

Scene read_scene_text(std::string_view text, const std::string& name, const Factory& factory, PluginLoader& plugins) {
  screen(text, name);

  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    refuse_file(name, document.ErrorLineNum(), explain(document));
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (!root) refuse_file(name, 1, "the file holds no element, must hold one <Node>");
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling()) {
    const bool is_harmless = node == root || node->ToComment() || node->ToDeclaration();
    if (!is_harmless)
      refuse_file(name, node->GetLineNum(), "something stands beside the root element, must be one <Node> alone");
  }

  Scene scene;
  Reader(scene, name, factory, plugins).read(*root);
  return scene;
}

Scene read_scene(const std::filesystem::path& file, const Factory& factory, PluginLoader& plugins) {
  return read_scene_text(read_whole(file), file.string(), factory, plugins);
}

void override_attribute(Scene& scene, std::string_view assignment) {
  const auto refuse = [&](const std::string& what, const std::string& hint = {}) {
    throw OverrideError(format_error({"--set " + std::string(assignment), 0}, what, hint));
  };

  const std::size_t equals = assignment.find('=');
  const std::size_t dot = assignment.substr(0, equals).rfind('.');
  if (equals == assignment.npos || dot == assignment.npos)
    refuse("must be PATH.attribute=VALUE; the root's own attributes are .attribute=VALUE");
  std::string_view path = assignment.substr(0, dot);
  const std::string_view attribute = assignment.substr(dot + 1, equals - dot - 1);
  const std::string_view value = assignment.substr(equals + 1);

  Object* target = &scene.root();
  // the root may be named or left out
  if (path == scene.root().name()) path = {};
  if (const std::string prefix = scene.root().name() + "/"; path.starts_with(prefix)) path.remove_prefix(prefix.size());
  if (!path.empty()) {
    const PathResult found = resolve_path(scene.root(), nullptr, path);
    if (!found.target) refuse(found.problem, found.hint);
    target = found.target;
  }

  Data* data = target->find_data(attribute);
  if (!data || data->attribute().name == "name") {
    std::vector<std::string_view> known;
    for (const auto& other : target->all_data()) known.push_back(other->attribute().name);
    refuse(fmt::format("{} '{}' has no attribute '{}'", target->class_name(), target->name(), attribute),
           did_you_mean(attribute, known));
  }
  try {
    data->read(value, {"--set " + std::string(assignment), 0});
  } catch (const InputError& error) {
    refuse(fmt::format("{}.{}: {}", target->class_name(), attribute, error.what()));
  }
}

}  // namespace hexaplast::scene
