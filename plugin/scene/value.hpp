// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "attributes/attribute.hpp"
#include "attributes/words.hpp"

namespace hexaplast::scene {

/// What an attribute holds. By attributes::Type: kBool bool; kInteger int64; kReal double; kText and kWord string;
/// kIntegers and kHexahedra int64s (eight per hexahedron); kReals, kVector3, kVectors3 and kBoxes doubles (3, 3 n, 6 n
/// of them); kLink the path as written. monostate: not given and without default.
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
                           std::vector<double>>;

/// Reads the text of an attribute, whatever the locale. Numbers are separated by blanks; they may begin with one sign,
/// + or -; "nan", "inf" and numbers too large for a double are refused. Text without content is an empty list.
/// Throws InputError saying what is wrong, the value, and what is allowed.
Value read_value(const attributes::Attribute& attribute, std::string_view text);

/// A value as a scene writes it; numbers come back with all their bits. Empty where there is none.
std::string write_value(const Value& value);

/// Checks a value that does not come from text against an attribute's range, words and group size.
/// Throws InputError like read_value.
void check_value(const attributes::Attribute& attribute, const Value& value);

using attributes::split_words;

/// Whether a name is of letters, digits, _, - and . alone: it can be that of a file, or of a column.
bool is_plain_name(std::string_view name);

}  // namespace hexaplast::scene
