// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/look/component_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <limits>
#include <map>

#include "attributes/stock.hpp"
#include "attributes/texts.hpp"
#include "attributes/words.hpp"
#include "scene/value.hpp"

namespace hexaplast::runner {
namespace {

using attributes::Access;
using attributes::Attribute;
using attributes::Description;

constexpr std::string_view kIntroduction =
    R"(# Components

Components and attributes of scenes. `hexaplast list --markdown` prints this page from the table that also checks scenes;
`hexaplast list BoxROI` also prints templates. Names, defaults and meaning are SOFA's wherever SOFA has the component; its
attributes of drawing are accepted without effect. Units are SI.

A scene is XML: nodes hold nodes and components, `<BoxROI .../>` or `<Object type="BoxROI" .../>`. This one runs; save it
as `beam.scn` and try `hexaplast run beam.scn`, or `hexaplast check beam.scn` for a model check:

```xml
{}
```

The examples below are added at the end of its node `body`. A solver, topology, mechanical state, mass, body of hexahedra,
animation loop or RunSettings replaces the one that is there.

**Values.** Numbers are separated by blanks, with a decimal point; `nan`, `inf` and numbers out of range are refused. Among
whole numbers `3-7` stands for 3 4 5 6 7, `7-3` for 7 6 5 4 3, and `0-10-5` for 0 5 10. Numbers of nodes and cells count
from 0.

**Links.** `@path` refers to a node or component, `@path.attribute` to an attribute, whose changes are followed. The target
may be anywhere in the file. A path is a name, which is searched in the node and then in the nodes above; or it begins with
`/` (the root), `./` (this node) or `../` (the node above), followed by names. `@.dt` is an attribute of the node itself. A
name that no component has may be a class of which the node holds one component. Components without a name are named by
their class and a number: `BoxROI1`, `BoxROI2`. The *nearest* component is the first one of the node, or of the nearest node
above that has one.

**Includes.** `<include href="part.xml"/>` is replaced by the root element of another file. `name="..."` renames it. A root
named `Group` is replaced by its members. At most 16 levels.

**Files.** The name of a mesh or of an included file counts from the file that names it. If nothing is there, it is looked
for in the directories of `--mesh-path`. Names with `..` and absolute names are not searched for.

**Strictness.** Unknown components and attributes, values out of range and links without a target are errors, with file,
line and the name that was probably meant. A scene with other components of SOFA runs in SOFA, with the [plugin](sofa.md).

**Attributes of every component.**

)";

// A pipe would end the cell of a table.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string default_cell(const Attribute& attribute) {
  if (attribute.access == Access::kOutput) return "computed";
  return attribute.initial.empty() ? "" : fmt::format("`{}`", attribute.initial);
}

// "number [m], > 0". No limits that are those of whole numbers.
std::string kind_cell(const Attribute& attribute) {
  if (attribute.type == attributes::Type::kWord) return std::string(attribute.words);
  const bool is_link = attribute.type == attributes::Type::kLink;
  std::string text(is_link ? "link" : attributes::describe(attribute.type));
  if (text.starts_with("one ")) text.erase(0, 4);
  if (!attribute.unit.empty()) text += fmt::format(" [{}]", attribute.unit);
  attributes::Range range = attribute.range;
  if (range.max == attributes::kIndex.max) range.max = std::numeric_limits<double>::infinity();
  std::string limits = attributes::describe(range);
  for (const std::string_view opening : {"must be ", "must lie "})
    if (limits.starts_with(opening)) limits.erase(0, opening.size());
  const bool is_index = attribute.range.max == attributes::kIndex.max && range.min == attributes::kIndex.min;
  return limits.empty() || is_index ? text : fmt::format("{}, {}", text, limits);
}

using Rows = std::vector<const Attribute*>;

std::string attribute_table(const Rows& rows) {
  std::string table = "| attribute | holds | default | meaning |\n| --- | --- | --- | --- |\n";
  for (const Attribute* row : rows)
    table +=
        fmt::format("| `{}` | {} | {} | {} |\n", row->name, cell(kind_cell(*row)), default_cell(*row), cell(row->help));
  return table;
}

Rows rows_with_effect(std::span<const Attribute> attributes) {
  Rows rows;
  for (const Attribute& attribute : attributes)
    if (attribute.access != Access::kIgnored) rows.push_back(&attribute);
  return rows;
}

/// A component, and the rows that its table has.
struct Described {
  const Description* component;
  Rows rows;
};

// Regions have no defaults, and say nothing of bodies without a value.
bool says_nothing_new(const Attribute& row, const Attribute& earlier) {
  return row.name == earlier.name && kind_cell(row) == kind_cell(earlier) && row.access == earlier.access &&
         (row.initial == earlier.initial || row.initial.empty()) && earlier.help.starts_with(row.help);
}

// Rows that an earlier component has too are not repeated where they are worth a link.
std::string links(const std::vector<Described>& earlier, Rows& rows) {
  constexpr std::size_t kWorthALink = 240;  // characters of a table
  std::string text;
  for (const Described& other : earlier) {
    const auto is_there = [&](const Attribute* row) {
      return std::ranges::any_of(other.rows, [&](const Attribute* each) { return says_nothing_new(*row, *each); });
    };
    Rows rest = rows, there;
    std::erase_if(rest, is_there);
    std::ranges::copy_if(rows, std::back_inserter(there), is_there);
    if (attribute_table(there).size() < kWorthALink) continue;

    std::string names, anchor(other.component->class_name);
    for (const Attribute* row : there) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", row->name);
    std::ranges::transform(anchor, anchor.begin(), [](unsigned char c) { return std::tolower(c); });
    text += fmt::format("\nAs for [{}](#{}): {}.\n", other.component->class_name, anchor, names);
    rows = std::move(rest);
  }
  return text;
}

std::string section(const Description& component, std::vector<Described>& earlier) {
  std::string text = fmt::format("\n### {}\n\n{}\n", component.class_name, component.help);
  Rows rows = rows_with_effect(component.attributes);
  const std::string as_earlier = links(earlier, rows);
  if (!rows.empty()) text += "\n" + attribute_table(rows);
  text += as_earlier;
  earlier.push_back({&component, rows});

  const auto example =
      std::ranges::find(attributes::examples(), component.class_name, &attributes::Example::class_name);
  text += fmt::format("\n```xml\n{}\n```\n", example == attributes::examples().end()
                                                 ? fmt::format("<{}/>", component.class_name)
                                                 : std::string(example->lines));
  return text;
}

std::string ignored_components(const Descriptions& components) {
  std::map<std::string_view, std::string> names_of;  // by what is said about them
  for (const Description* component : components) {
    if (!component->takes_anything) continue;
    std::string& names = names_of[component->help];
    names += fmt::format("{}`{}`", names.empty() ? "" : ", ", component->class_name);
  }
  std::string text =
      "\n## Components without effect\n\nThey are accepted, and their attributes are not read.\n\n| components | here "
      "|\n| --- | --- |\n";
  for (const auto& [reason, names] : names_of) text += fmt::format("| {} | {} |\n", names, reason);
  return text;
}

}  // namespace

Descriptions known_components(const SceneOptions& options) {
  scene::Factory factory;
  load_components(factory, options);
  Descriptions components = {&attributes::kNode, &attributes::kRequiredPlugin};
  std::ranges::copy(factory.descriptions(), std::back_inserter(components));
  return components;
}

std::vector<ComponentGroup> grouped(const Descriptions& components) {
  std::vector<ComponentGroup> groups;
  for (const std::string_view category :
       {"Node", "Settings", "AnimationLoop", "OdeSolver", "NewtonRaphsonSolver", "LinearSolver", "MeshLoader",
        "Topology", "MechanicalState", "Mass", "ForceField", "InteractionForceField", "MaterialRegion", "Controller",
        "ProjectiveConstraint", "InteractionProjectiveConstraint", "Engine", "Mapping", "Probe"})
    groups.push_back({category, {}});
  for (const Description* component : components) {
    if (component->takes_anything) continue;
    auto group = std::ranges::find(groups, component->category, &ComponentGroup::category);
    if (group == groups.end()) group = groups.insert(groups.end(), {component->category, {}});
    group->components.push_back(component);
  }
  std::erase_if(groups, [](const ComponentGroup& group) { return group.components.empty(); });
  for (ComponentGroup& group : groups) std::ranges::sort(group.components, {}, &Description::class_name);
  return groups;
}

std::string component_page(const Descriptions& components) {
  std::string page = fmt::format(fmt::runtime(kIntroduction), attributes::example_scene());
  page += attribute_table(rows_with_effect(attributes::kCommon));
  std::vector<Described> described;
  for (const ComponentGroup& group : grouped(components)) {
    page += fmt::format("\n## {}\n", group.category);
    for (const Description* component : group.components) page += section(*component, described);
  }
  return page + ignored_components(components);
}

}  // namespace hexaplast::runner
