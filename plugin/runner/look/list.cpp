// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>

#include "attributes/words.hpp"
#include "runner/command.hpp"
#include "runner/look/component_page.hpp"
#include "runner/run/common_options.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

using attributes::Attribute;
using attributes::Description;

std::string_view first_sentence(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at)
    if ((text[at] == '.' || text[at] == ':') && (at + 1 == text.size() || text[at + 1] == ' '))
      return text.substr(0, at);
  return text;
}

void print(const Description& component) {
  fmt::print("{}: {}\n", component.class_name, component.help);
  if (!component.templates.empty()) fmt::print("templates: {}\n", component.templates);
  for (const Attribute& attribute : component.attributes) {
    fmt::print("\n  {}: {}", attribute.name, attributes::describe(attribute.type));
    if (!attribute.words.empty()) fmt::print(" of {}", attribute.words);
    if (!attribute.unit.empty()) fmt::print(" [{}]", attribute.unit);
    if (const std::string range = attributes::describe(attribute.range); !range.empty()) fmt::print(", {}", range);
    if (!attribute.initial.empty()) fmt::print("; default {}", attribute.initial);
    if (attribute.access == attributes::Access::kOutput) fmt::print("; computed");
    if (attribute.access == attributes::Access::kIgnored) fmt::print("; without effect");
    fmt::print("\n    {}\n", attribute.help);
  }
}

void print(const Descriptions& components) {
  for (const ComponentGroup& group : grouped(components)) {
    fmt::print("{}\n", group.category);
    for (const Description* component : group.components)
      fmt::print("  {:<42} {}\n", component->class_name, first_sentence(component->help));
  }
  fmt::print("Without effect\n");
  for (const Description* component : components)
    if (component->takes_anything) fmt::print("  {:<42} {}\n", component->class_name, component->help);
}

/// What was probably meant: a misspelt name, or those that a part of a name belongs to.
std::string hint_of(const std::string& name, const std::vector<std::string_view>& names) {
  const std::string hint = scene::did_you_mean(name, names);
  if (!hint.empty()) return hint;
  std::vector<std::string_view> longer;
  std::ranges::copy_if(names, std::back_inserter(longer), [&](std::string_view other) {
    const auto same = [](unsigned char a, unsigned char b) { return ::tolower(a) == ::tolower(b); };
    return std::search(other.begin(), other.end(), name.begin(), name.end(), same) != other.end();
  });
  constexpr std::size_t kMaxNamed = 8;
  return longer.empty() || longer.size() > kMaxNamed ? std::string()
                                                     : fmt::format("there are {}", fmt::join(longer, ", "));
}

const Description& named(const Descriptions& components, const std::string& name) {
  std::vector<std::string_view> names;
  for (const Description* component : components) {
    if (component->class_name == name) return *component;
    names.push_back(component->class_name);
  }
  throw UsageError(fmt::format("no component '{}'", name), hint_of(name, names));
}

struct ListOptions {
  std::optional<std::string> component;  ///< all of them where it is not given
  bool markdown = false;                 ///< the page docs/components.md
  SceneOptions plugins;
};

void list(const ListOptions& options) {
  const Descriptions components = known_components(options.plugins);
  const Description* one = options.component ? &named(components, *options.component) : nullptr;
  if (options.markdown) {
    fmt::print("{}", component_page(components));
  } else if (one) {
    print(*one);
  } else {
    print(components);
  }
}

}  // namespace

void add_list(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "list", "Print the components that scenes may name, and what they take", list,
                     [](const ListOptions&) { return "hexaplast"; });
  CLI::Option* component =
      add_option(command, "component", options.component, "COMPONENT", "One component with its attributes");
  command.add_flag("--markdown", options.markdown, "As the page docs/components.md")->excludes(component);
  add_plugins(command, options.plugins);
}

}  // namespace hexaplast::runner
