// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "hexaplast/base/rows.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// The values of a member that a component has an attribute for; none where it has none, or no value for it.
template <class Options>
std::optional<std::vector<double>> values_of(scene::Object& owner, const Row<Options>& row) {
  const scene::Data* data = owner.find_data(row.name);
  if (!data || (!data->is_given() && data->attribute().initial.empty())) return std::nullopt;
  if (row.may_vary || row.at.list) return owner.reals(row.name);
  switch (row.at.type) {
    case MemberType::kWord:
      return {{static_cast<double>(place_of_word(row, owner.text(row.name)))}};
    case MemberType::kInteger:
      return {{static_cast<double>(owner.integer(row.name))}};
    case MemberType::kReal:
    case MemberType::kReals:
      break;
  }
  return {{owner.real(row.name)}};
}

/// A body as a force field, for what refers to it by the attribute `body`.
class BodyField : public scene::ForceField, public scene::Changeable {
 public:
  using ForceField::ForceField;

  /// The hexahedra; null: not known yet.
  virtual const std::vector<Hexahedron>* hexahedra() const = 0;
};

/// The body that the attribute `body` of a component leads to, or its node; where it is not given, the nearest one.
/// Null: there is none.
inline BodyField* find_body(scene::Component& component) {
  scene::Object* target = component.find_data("body")->target();
  if (!target) return component.node().nearest<BodyField>();
  const scene::Node* holder = dynamic_cast<scene::Node*>(target);
  return holder ? holder->local<BodyField>() : dynamic_cast<BodyField*>(target);
}

/// The same; rejects the scene where there is none.
inline BodyField& needed_body(scene::Component& component) {
  if (BodyField* field = find_body(component)) return *field;
  if (const scene::Object* target = component.find_data("body")->target())
    component.reject("body", fmt::format("the link leads to {} '{}', must lead to a body of hexahedra",
                                         target->class_name(), target->name()));
  component.reject("needs a body of hexahedra in its node or above, or a link to one");
}

}  // namespace hexaplast::components
