// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/object.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/base/error.hpp"
#include "scene/component.hpp"

namespace hexaplast::scene {
namespace {

using attributes::Access;
using attributes::Attribute;
using attributes::Type;

// The value of an attribute that no scene has given.
Value initial_value(const Attribute& attribute) {
  const bool is_list = attribute.type == Type::kIntegers || attribute.type == Type::kReals ||
                       attribute.type == Type::kVectors3 || attribute.type == Type::kBoxes ||
                       attribute.type == Type::kHexahedra || attribute.type == Type::kText;
  if (attribute.initial.empty() && !is_list) return std::monostate();
  return read_value(attribute, attribute.initial);
}

bool is_computed(const Attribute& attribute) {
  return attribute.access == Access::kOutput || attribute.access == Access::kState;
}

bool is_input(const Data& data) { return data.source() || !is_computed(data.attribute()); }

/// Where its value comes from.
const Data& end_of(const Data& data) {
  const Data* end = &data;
  while (end->source()) end = end->source();
  return *end;
}

/// What a component that has failed would tell is not there, and why has been said.
void require_told(const Data& end) {
  if (!is_computed(end.attribute())) return;
  const auto* component = dynamic_cast<const Component*>(&end.owner());
  if (component && component->stage() == Component::Stage::kFailed) throw DependencyFailure();
}

}  // namespace

Data::Data(Object& owner, const Attribute& attribute)
    : owner_(owner), attribute_(attribute), value_(initial_value(attribute)) {}

void Data::read(std::string_view text, Place place) {
  place_ = std::move(place);
  is_given_ = true;
  if (attribute_.access == Access::kOutput) throw InputError("is computed, and cannot be set");

  drop_link();
  const bool is_link = attribute_.type != Type::kText && !text.empty() && text[0] == '@';
  if (is_link) {
    link_ = text;
  } else {
    value_ = read_value(attribute_, text);
    ++version_;
  }
}

void Data::set(Value value, Place place) {
  if (attribute_.access == Access::kOutput) throw InputError("is computed, and cannot be set");
  check_value(attribute_, value);
  place_ = std::move(place);
  is_given_ = true;
  drop_link();
  set(std::move(value));
}

void Data::unset() {
  is_given_ = false;
  drop_link();
  place_ = owner_.place();
  set(initial_value(attribute_));
}

void Data::follow(Data& source, const std::string& link) {
  source_ = &source;
  source_version_ = -1;
  link_ = link;
  is_given_ = true;
}

// The own value counts again, which may be the one of before.
void Data::drop_link() {
  if (source_) ++version_;
  source_ = nullptr;
  link_.clear();
}

Data::Given Data::given() {
  if (!is_given_) return {};
  return {.value = value(), .source = source_, .link = link_, .place = place_};
}

void Data::put_back(const Given& given) {
  if (!given.value) return unset();
  if (given.source)
    follow(*given.source, given.link);
  else
    set(*given.value, given.place);
  place_ = given.place;
}

void Data::set(Value value) {
  if (value == value_) return;
  value_ = std::move(value);
  ++version_;
}

void Data::compute() {
  if (source_) return source_->compute();
  if (is_computed(attribute_)) owner_.provide(*this);
}

const Value& Data::value() {
  compute();
  return latest();
}

// Its own count, and not that of the source, which a value in place of the link might have too.
long Data::version() {
  if (!source_) {
    compute();
  } else if (const long of_source = source_->version(); of_source != source_version_) {
    source_version_ = of_source;
    ++version_;
  }
  return version_;
}

const Value& Data::checked() {
  if (!source_) return value();
  const long present = version();
  if (present != checked_version_) check_value(attribute_, latest());
  checked_version_ = present;
  return latest();
}

Object::Object(const attributes::Description& description) : description_(description) {
  for (const Attribute& attribute : attributes::kCommon) data_.push_back(std::make_unique<Data>(*this, attribute));
  for (const Attribute& attribute : description.attributes) data_.push_back(std::make_unique<Data>(*this, attribute));
}

void Object::introduce(std::string name, Place place, Diagnostics& diagnostics) {
  name_ = std::move(name);
  place_ = std::move(place);
  diagnostics_ = &diagnostics;
}

Data* Object::find_data(std::string_view name) {
  const auto found = std::ranges::find_if(data_, [&](const auto& data) { return data->attribute().name == name; });
  return found == data_.end() ? nullptr : found->get();
}

Data& Object::data(std::string_view name) {
  Data* found = find_data(name);
  if (!found) throw std::logic_error(fmt::format("{} has no attribute {}", class_name(), name));
  return *found;
}

template <class T>
const T& Object::get(std::string_view name) {
  Data& source = data(name);
  if (source.source()) require_told(end_of(source));
  const Value* value = nullptr;
  try {
    value = &source.checked();
  } catch (const InputError& error) {
    reject(name, fmt::format("link '{}': {}", source.link(), error.what()));
  }
  if (const T* content = std::get_if<T>(value)) return *content;
  if (std::holds_alternative<std::monostate>(*value)) reject(name, "is not given");
  throw std::logic_error(fmt::format("{}.{} is of another type", class_name(), name));
}

template const bool& Object::get(std::string_view);
template const std::int64_t& Object::get(std::string_view);
template const double& Object::get(std::string_view);
template const std::string& Object::get(std::string_view);
template const std::vector<std::int64_t>& Object::get(std::string_view);
template const std::vector<double>& Object::get(std::string_view);

bool Object::has_value(std::string_view name) {
  const Data& end = end_of(data(name));
  return end.is_given() || !end.attribute().initial.empty() || is_computed(end.attribute());
}

std::optional<double> Object::real_if_given(std::string_view name) {
  if (std::holds_alternative<std::monostate>(data(name).value())) return std::nullopt;
  return real(name);
}

Vec3 Object::vector3(std::string_view name) {
  const std::vector<double>& numbers = reals(name);
  if (numbers.size() != 3) reject(name, fmt::format("{} numbers given, must be three", numbers.size()));
  return Vec3(numbers[0], numbers[1], numbers[2]);
}

Eigen::Map<const PointArray> Object::vectors3(std::string_view name) {
  const std::vector<double>& numbers = reals(name);
  return {numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3};
}

std::vector<int> Object::indices(std::string_view name, int count) {
  const std::vector<std::int64_t>& numbers = integers(name);
  for (const std::int64_t number : numbers) {
    if (number < 0 || number >= count) reject(name, fmt::format("{} must lie in [0, {})", number, count));
  }
  return {numbers.begin(), numbers.end()};
}

void Object::reject(std::string_view attribute, const std::string& what, std::string hint) {
  const Data& at = data(attribute);
  throw Rejection({.severity = Severity::kError,
                   .place = at.place().file.empty() ? place_ : at.place(),
                   .text = fmt::format("{}.{}: {}", class_name(), attribute, what),
                   .hint = std::move(hint)});
}

void Object::reject(const std::string& what) {
  throw Rejection({.severity = Severity::kError, .place = place_, .text = fmt::format("{}: {}", class_name(), what)});
}

void Object::remark(Severity severity, std::string_view attribute, const std::string& what) {
  const bool at_attribute = !attribute.empty() && data(attribute).is_given();
  diagnostics_->add(severity, at_attribute ? data(attribute).place() : place_,
                    attribute.empty() ? fmt::format("{}: {}", class_name(), what)
                                      : fmt::format("{}.{}: {}", class_name(), attribute, what));
}

std::span<const std::string_view> Object::new_inputs() {
  new_inputs_.clear();
  for (const auto& data : data_)
    if (is_input(*data) && data->is_new()) new_inputs_.push_back(data->attribute().name);
  return new_inputs_;
}

void Object::accept_inputs() {
  for (const auto& data : data_)
    if (is_input(*data)) data->accept();
}

}  // namespace hexaplast::scene
