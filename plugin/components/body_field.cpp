// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/body_field.hpp"

#include <fmt/format.h>

namespace hexaplast::components {

BodyField* find_body(scene::Component& component) {
  scene::Object* target = component.find_data("body")->target();
  if (!target) return component.node().nearest<BodyField>();
  const scene::Node* holder = dynamic_cast<scene::Node*>(target);
  return holder ? holder->local<BodyField>() : dynamic_cast<BodyField*>(target);
}

BodyField& needed_body(scene::Component& component) {
  if (BodyField* field = find_body(component)) return *field;
  if (const scene::Object* target = component.find_data("body")->target())
    component.reject("body", fmt::format("the link leads to {} '{}', must lead to a body of hexahedra",
                                         target->class_name(), target->name()));
  component.reject("needs a body of hexahedra in its node or above, or a link to one");
}

}  // namespace hexaplast::components
