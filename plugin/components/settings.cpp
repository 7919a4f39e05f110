// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"

namespace hexaplast::components {
namespace {

/// Read by whoever runs the scene.
class RunSettings final : public scene::Component {
 public:
  RunSettings() : Component(attributes::kRunSettings) {}
};

/// Accepted so that scenes can be read, and without effect.
class Ignored final : public scene::Component {
 public:
  using Component::Component;

  void init() override {
    const std::string_view category = description().category;
    if (category == "Visual" || category == "Interaction")
      remark(scene::Severity::kNote, {}, std::string(description().help));
  }
  void refresh() override {}
};

}  // namespace

void add_settings(scene::Factory& factory) {
  factory.add<RunSettings>(attributes::kRunSettings);
  for (const attributes::Description& description : attributes::kIgnoredComponents)
    factory.add(description, [&description] { return std::make_unique<Ignored>(description); });
}

}  // namespace hexaplast::components
