// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/changes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/base/error.hpp"
#include "scene/reader.hpp"

namespace hexaplast::scene {
namespace {

Data& changeable_attribute(Scene& scene, const std::string& name, const std::string& words) {
  Data& data = named_attribute(scene, name, words);
  const std::string_view attribute = data.attribute().name;
  auto* component = dynamic_cast<Component*>(&data.owner());
  const std::vector<std::string_view> known =
      component ? attributes_that_may_change(*component) : std::vector<std::string_view>();
  if (std::ranges::count(known, attribute) > 0) return data;
  const std::string owner = fmt::format("{} '{}'", data.owner().class_name(), data.owner().name());
  throw OverrideError(format_error({words, 0},
                                   known.empty()
                                       ? fmt::format("{} reads its attributes once, when the scene begins", owner)
                                       : fmt::format("{} has no attribute '{}' that may change", owner, attribute),
                                   did_you_mean(attribute, known)));
}

}  // namespace

std::vector<std::string_view> attributes_that_may_change(Component& component) {
  const auto* changeable = dynamic_cast<const Changeable*>(&component);
  std::vector<std::string_view> names;
  for (const auto& data : component.all_data()) {
    const attributes::Attribute& attribute = data->attribute();
    if (attribute.access == attributes::Access::kInput && attribute.type != attributes::Type::kLink &&
        attribute.name != "name" && (changeable ? changeable->may_change(attribute.name) : component.looks_by_itself()))
      names.push_back(attribute.name);
  }
  return names;
}

void Changes::set(const std::string& name, const std::optional<std::string>& text) {
  const std::string words = "set " + name;
  Data& data = changeable_attribute(scene_, name, words);
  std::optional<Value> value;
  try {
    if (text) value = read_value(data.attribute(), *text);
  } catch (const InputError& error) {
    throw OverrideError(format_error(
        {words, 0}, fmt::format("{}.{}: {}", data.owner().class_name(), data.attribute().name, error.what())));
  }
  if (std::ranges::find(all_, &data, [](const Change& change) { return &change.data; }) == all_.end())
    all_.push_back({name, data, data.given()});
  if (value)
    data.set(std::move(*value), {words, 0});
  else
    data.unset();
}

void Changes::put_back() {
  for (const Change& change : all_) change.data.put_back(change.before);
  all_.clear();
}

void Changes::serialize(Archive& archive) {
  std::uint64_t count = all_.size();
  archive(count);
  for (std::uint64_t k = 0; k < count; ++k) {
    std::string name, text;
    bool is_given = false;
    if (!archive.reads()) {
      Change& change = all_[k];
      name = change.name;
      is_given = change.data.is_given();
      if (is_given) text = write_value(change.data.value());
    }
    archive(name, is_given, text);
    if (archive.reads()) set(name, is_given ? std::optional(text) : std::nullopt);
  }
}

}  // namespace hexaplast::scene
