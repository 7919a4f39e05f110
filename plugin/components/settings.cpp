// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/attribute_change.hpp"
#include "scene/changes.hpp"

namespace hexaplast::components {
namespace {

/// Read by whoever runs the scene.
class RunSettings final : public scene::Component {
 public:
  RunSettings() : Component(attributes::kRunSettings) {}

  void bwd_init() override {
    if (const RunSettings* first = node().root().all<RunSettings>().front(); first != this)
      remark(scene::Severity::kWarning, {}, fmt::format("has no effect: '{}' stands before it", first->name()));
  }
};

/// Changes an attribute of another component between two steps. The component stands behind it, and so looks at all its
/// inputs together, when it begins the step itself.
class AttributeChange final : public scene::Component, public scene::Stateful {
 public:
  AttributeChange() : Component(attributes::kAttributeChange) {}

  void bwd_init() override {
    scene::Object* target = find_data("component")->target();
    if (!target) reject("component", "is not given, must lead to a component");
    component_ = dynamic_cast<scene::Component*>(target);
    if (!component_)
      reject("component",
             fmt::format("leads to {} '{}', must lead to a component", target->class_name(), target->name()));
    require_order();
    const std::vector<std::string_view> known = scene::attributes_that_may_change(*component_);
    if (known.empty())
      reject("component", fmt::format("leads to {} '{}', which reads its attributes once, when the scene begins",
                                      component_->class_name(), component_->name()));
    if (std::ranges::count(known, text("attribute")) == 0)
      reject("attribute",
             fmt::format("{} '{}' has no attribute '{}' that may change", component_->class_name(), component_->name(),
                         text("attribute")),
             scene::did_you_mean(text("attribute"), known));
    data_ = component_->find_data(text("attribute"));
    values_ = values();
    times_ = key_times(*this, "keyTimes", "values", values_.size());
    if (!is_given("values")) reject("values", "is not given");
    before_ = data_->given();
  }

  void begin_step() override {
    const auto due = parts::num_come(times_, node().clock().time);
    if (due <= num_done_) return;
    num_done_ = due;
    put();
  }

  void reset() override {
    if (num_done_ == 0) return;
    num_done_ = 0;
    put();
  }

  void serialize(Archive& archive) override {
    std::int64_t num_done = num_done_;
    Present present = data_->source() ? Present::kFollows : data_->is_given() ? Present::kGiven : Present::kNotGiven;
    std::string value = present == Present::kGiven ? scene::write_value(data_->value()) : std::string();
    archive(num_done, present, value);
    if (!archive.reads()) return;
    if (num_done < 0 || num_done > std::ssize(times_))
      throw InputError(fmt::format("{} changes are saved of {}", num_done, times_.size()));
    num_done_ = num_done;
    // the host makes the component follow
    if (present == Present::kGiven)
      data_->set(scene::read_value(data_->attribute(), value), place());
    else if (present == Present::kNotGiven)
      data_->unset();
    else if (before_.source)
      data_->put_back(before_);
    else
      throw InputError("the attribute followed another one when it was saved");
  }

 private:
  /// What the attribute is at present: others may have changed it too.
  enum class Present : std::uint8_t { kNotGiven, kGiven, kFollows };

  using Change = std::optional<scene::Value>;  // none: not given

  std::vector<Change> values() {
    std::vector<Change> all;
    for (const std::optional<std::string_view> one : parts::values_of_changes(text("values"))) try {
        all.push_back(one ? Change(scene::read_value(data_->attribute(), *one)) : Change());
      } catch (const InputError& error) {
        reject("values", fmt::format("{}.{}: {}", component_->class_name(), data_->attribute().name, error.what()));
      }
    return all;
  }

  void require_order() {
    const scene::Component* first = nullptr;
    node().root().for_each<scene::Component>([&](const scene::Component& component) {
      if (!first && (&component == this || &component == component_)) first = &component;
    });
    if (first != this)
      reject("component", fmt::format("leads to {} '{}' before it, must lead to a component behind it in the scene",
                                      component_->class_name(), component_->name()));
  }

  void put() {
    if (num_done_ > 0) {
      if (const Change& change = values_[static_cast<std::size_t>(num_done_ - 1)])
        data_->set(*change, place());
      else
        data_->unset();
    } else {
      data_->put_back(before_);
    }
  }

  scene::Component* component_ = nullptr;
  scene::Data* data_ = nullptr;
  std::vector<Change> values_;
  std::vector<double> times_;  // [s]
  scene::Data::Given before_;
  std::int64_t num_done_ = 0;
};

/// Accepted so that scenes can be read, and without effect.
class Ignored final : public scene::Component, public scene::Changeable {
 public:
  using Component::Component;

  void init() override {
    if (description().category == "Visual") remark(scene::Severity::kNote, {}, std::string(description().help));
  }
  void refresh(std::span<const std::string_view>) override {}
};

}  // namespace

void add_settings(scene::Factory& factory) {
  factory.add<RunSettings>(attributes::kRunSettings);
  factory.add<AttributeChange>(attributes::kAttributeChange);
  for (const attributes::Description& description : attributes::kIgnoredComponents)
    factory.add(description, [&description] { return std::make_unique<Ignored>(description); });
}

}  // namespace hexaplast::components
