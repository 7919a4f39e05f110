// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/recording.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>

#include "attributes/parts.hpp"
#include "scene/reader.hpp"

namespace hexaplast::view {
namespace {

namespace fs = std::filesystem;
using scene::Element;

constexpr const char* kComment = R"(
  What was done to a scene in the live window

  The instruments at the ends of the nodes are those that the hand had, with the paths that they went. An AttributeChange
  is what was set on a slider.
)";

void set(Element& element, std::string_view attribute, std::string value) {
  const auto found = std::ranges::find(element.attributes, attribute, &scene::ElementAttribute::name);
  if (found == element.attributes.end())
    element.attributes.push_back({std::string(attribute), std::move(value), element.place});
  else
    found->value = std::move(value);
}

/// The attributes by which components name files that they read.
constexpr std::array<std::string_view, 2> kFileNames{"filename", "fileTopology"};

/// Names from another folder what an element names from its own place.
void rename_files(scene::Scene& scene, const scene::Object& object, Element& element, const fs::path& folder) {
  for (scene::ElementAttribute& attribute : element.attributes) {
    if (std::ranges::find(kFileNames, attribute.name) == kFileNames.end()) continue;
    const fs::path name = attribute.value;
    const fs::path file = scene.root().files().search.find(name, fs::path(object.place().file).parent_path());
    if (name.is_relative() && fs::exists(file))
      attribute.value = fs::relative(file, folder.empty() ? "." : folder).string();
  }
}

Element element_of(const InstrumentMotion& motion, int number, const scene::Place& place) {
  Element element{.tag = motion.class_name, .place = place, .attributes = {}, .children = {}};
  set(element, "name", fmt::format("hand_{}", number));
  for (const auto& [name, value] : motion.attributes) set(element, name, value);
  set(element, "keyTimes", fmt::format("{}", fmt::join(motion.key_times, " ")));
  set(element, "positions", fmt::format("{}", fmt::join(motion.positions, " ")));
  if (!motion.orientations.empty())
    set(element, "orientations", fmt::format("{}", fmt::join(motion.orientations, " ")));
  return element;
}

/// One for each attribute, with all of its changes.
std::vector<Element> elements_of(std::span<const Change> changes, const scene::Place& place) {
  std::vector<Element> elements;
  std::set<std::pair<const scene::Component*, std::string>> seen;
  for (const Change& first : changes) {
    if (!seen.emplace(first.component, first.attribute).second) continue;
    std::vector<double> times;
    std::vector<std::string> values;
    for (const Change& change : changes)
      if (change.component == first.component && change.attribute == first.attribute) {
        times.push_back(change.time);
        values.push_back(change.value.value_or(""));
      }
    const std::string path = first.component->node().path();
    Element& element = elements.emplace_back(Element{
        .tag = std::string(attributes::kAttributeChange.class_name), .place = place, .attributes = {}, .children = {}});
    set(element, "name", fmt::format("change_{}", elements.size()));
    set(element, "component", fmt::format("@{}{}{}", path, path == "/" ? "" : "/", first.component->name()));
    set(element, "attribute", first.attribute);
    set(element, "keyTimes", fmt::format("{}", fmt::join(times, " ")));
    const std::string text = fmt::format("{}", fmt::join(values, "; "));
    set(element, "values", text.empty() ? " " : text);  // one that is empty, and not none
  }
  return elements;
}

}  // namespace

std::string recorded_scene(scene::Scene& scene, Element document, std::span<const std::string> overrides,
                           const UserActions& actions, const fs::path& folder) {
  bool has_settings = false;
  scene::for_each_element(scene, document, [&](scene::Object& object, Element& element) {
    for (const std::string& assignment : overrides) {
      const std::size_t equals = assignment.find('=');
      const scene::Data& data = scene::named_attribute(scene, assignment.substr(0, equals), "--set");
      if (&data.owner() != &object) continue;
      std::erase_if(element.attributes,
                    [&](const scene::ElementAttribute& given) { return object.find_data(given.name) == &data; });
      set(element, data.attribute().name, assignment.substr(equals + 1));
    }
    rename_files(scene, object, element, folder);
    if (object.class_name() == attributes::kRunSettings.class_name) {
      has_settings = true;
      set(element, "steps", fmt::format("{}", actions.num_steps));
    }

    int number = 0;
    for (const InstrumentMotion& motion : actions.motions) {
      ++number;
      if (motion.node == &object) element.children.push_back(element_of(motion, number, element.place));
    }
    if (&object != &scene.root()) return;

    // before everything else: what changes is there when the others begin a step
    std::vector<Element> first = elements_of(actions.changes, element.place);
    if (!has_settings) {
      first.push_back({.tag = std::string(attributes::kRunSettings.class_name),
                       .place = element.place,
                       .attributes = {},
                       .children = {}});
      set(first.back(), "steps", fmt::format("{}", actions.num_steps));
    }
    element.children.insert(element.children.begin(), first.begin(), first.end());
  });
  return scene::write_document(document, kComment);
}

}  // namespace hexaplast::view
