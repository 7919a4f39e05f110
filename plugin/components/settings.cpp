// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/hexaplast.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"

namespace hexaplast::components {
namespace {

/// Read by whoever runs the scene.
class RunSettings final : public scene::Component {
 public:
  RunSettings() : Component(attributes::kRunSettings) {}
};

class VisualStyle final : public scene::Component {
 public:
  VisualStyle() : Component(attributes::kVisualStyle) {}
  void init() override { remark(scene::Severity::kNote, {}, "visual: ignored here"); }
  void refresh() override {}
};

}  // namespace

void add_settings(scene::Factory& factory) {
  factory.add<RunSettings>(attributes::kRunSettings);
  factory.add<VisualStyle>(attributes::kVisualStyle);
}

}  // namespace hexaplast::components
