// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <concepts>

namespace hexaplast {

/// Nodal fields of two bodies, or of one body twice.
template <class Field>
struct OfTwo {
  template <class Same>
  requires std::convertible_to<Same&&, Field> OfTwo(Same&& both) : first(both), second(both) {}
  template <class First, class Second>
  OfTwo(First&& of_first, Second&& of_second) : first(of_first), second(of_second) {}

  Field first, second;
};

}  // namespace hexaplast
