// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string_view>

#include "hexaplast/base/rows.hpp"

/// The attribute table: what every component is called, what it takes, and within which limits. Plain data, written
/// once; reading scenes, range checks, listings, documentation and every host use it, and nothing repeats it.
namespace hexaplast::attributes {

/// What the text of an attribute is read as.
enum class Type {
  kBool,       ///< true, false, 1, 0
  kInteger,    ///< one whole number
  kReal,       ///< one number
  kVector3,    ///< three numbers
  kIntegers,   ///< whole numbers; `a-b` and `a-b-step` stand for a range, downwards where b < a
  kReals,      ///< numbers
  kVectors3,   ///< groups of three numbers
  kBoxes,      ///< groups of six numbers: two opposite corners
  kHexahedra,  ///< groups of eight whole numbers
  kText,       ///< any text
  kWord,       ///< one of `words`
  kLink        ///< `@path` of a node or component
};

/// "groups of three numbers": what an attribute of a type holds, in words.
constexpr std::string_view describe(Type type) {
  constexpr std::string_view kWords[] = {"true or false",
                                         "one whole number",
                                         "one number",
                                         "three numbers",
                                         "whole numbers",
                                         "numbers",
                                         "groups of three numbers",
                                         "groups of six numbers",
                                         "groups of eight whole numbers",
                                         "text",
                                         "one word",
                                         "a link to a component"};
  return kWords[static_cast<int>(type)];
}

/// Who writes an attribute.
enum class Access {
  kInput,   ///< the scene
  kOutput,  ///< the component: other attributes may link to it
  kState,   ///< the scene gives the first value, the component the later ones
  kIgnored  ///< accepted because scenes have it (visual or bookkeeping), without effect here
};

using hexaplast::Range;

inline constexpr Range kPositive{.min = 0, .exclusive_min = true};
inline constexpr Range kNotNegative{.min = 0};
inline constexpr Range kIndex{.min = 0, .max = 2147483646};  // node and element numbers are ints

struct Attribute {
  std::string_view name = {};
  Type type = Type::kText;
  std::string_view initial = {};  ///< default, as text; empty: none (numbers) or empty (lists, text)
  std::string_view unit = {};
  Range range = {};
  std::string_view words = {};  ///< of a kWord, separated by blanks
  Access access = Access::kInput;
  std::string_view help = {};
  std::string_view group = {};  ///< under which SOFA's windows show it; empty: none
};

/// One component.
struct Description {
  std::string_view class_name = {};
  std::string_view category = {};
  std::string_view help = {};
  std::string_view templates = {};  ///< accepted values of `template`, separated by blanks
  std::span<const Attribute> attributes = {};
  bool takes_anything = false;  ///< an ignored component: every attribute and template is accepted unread
};

/// The attribute of that name. Throws, or where it is a constant does not compile, when there is none.
constexpr const Attribute& attribute_of(const Description& description, std::string_view name) {
  for (const Attribute& attribute : description.attributes)
    if (attribute.name == name) return attribute;
  throw std::logic_error("no such attribute");
}

/// A row of a table: `reals("times", {.unit = "s"}, "Key times, ascending.")`. In braces stands what is not the
/// default.
template <Type kType>
struct RowOf {
  constexpr Attribute operator()(std::string_view name, Attribute rest, std::string_view help) const {
    rest.name = name;
    rest.type = kType;
    rest.help = help;
    return rest;
  }
  constexpr Attribute operator()(std::string_view name, std::string_view help) const { return (*this)(name, {}, help); }
};
inline constexpr RowOf<Type::kBool> boolean;
inline constexpr RowOf<Type::kInteger> integer;
inline constexpr RowOf<Type::kReal> real;
inline constexpr RowOf<Type::kVector3> vector3;
inline constexpr RowOf<Type::kIntegers> integers;
inline constexpr RowOf<Type::kReals> reals;
inline constexpr RowOf<Type::kVectors3> vectors3;
inline constexpr RowOf<Type::kBoxes> boxes;
inline constexpr RowOf<Type::kHexahedra> hexahedra;
inline constexpr RowOf<Type::kText> free_text;
inline constexpr RowOf<Type::kWord> one_of;
inline constexpr RowOf<Type::kLink> link;

/// Numbers of nodes or elements.
constexpr Attribute indices(std::string_view name, Attribute rest, std::string_view help) {
  rest.range = kIndex;
  return integers(name, rest, help);
}
constexpr Attribute indices(std::string_view name, std::string_view help) { return indices(name, {}, help); }

constexpr Attribute output(Attribute row) {
  row.access = Access::kOutput;
  return row;
}

/// A component with its rows, of which some may come as arrays:
/// `constexpr Table kMesh{topology("Mesh", "Cells."), integers("cells", "..."), kOutputs};`
template <std::size_t kSize>
struct Table : Description {
  template <class... Rows>
  constexpr Table(const Description& component, const Rows&... some) : Description(component) {
    auto at = rows.begin();
    (put(some, at), ...);
    attributes = rows;
  }
  Table(const Table&) = delete;

  std::array<Attribute, kSize> rows;

 private:
  static constexpr void put(const Attribute& row, auto& at) { *at++ = row; }
  static constexpr void put(const auto& some, auto& at) { at = std::ranges::copy(some, at).out; }
};

template <class Rows>
inline constexpr std::size_t kNumRows = 1;
template <std::size_t kSize>
inline constexpr std::size_t kNumRows<std::array<Attribute, kSize>> = kSize;
template <class... Rows>
Table(const Description&, const Rows&...) -> Table<(kNumRows<Rows> + ...)>;

/// What every node and component takes besides its own attributes.
inline constexpr std::array kCommon = {
    free_text("name", "Name in links; default: ClassName1, ClassName2, ..."),
    link("src",
         "A component, mostly a loader: every attribute that it is given or computes, and that is not given here, "
         "follows its."),
};

/// Of force fields that have a stiffness.
inline constexpr Attribute kForceRayleigh =
    real("rayleighStiffness", {.initial = "0", .unit = "s", .range = kNotNegative},
         "Stiffness-proportional damping in the system matrix alone, besides the solver's own.");

inline constexpr std::string_view kVec3Templates = "Vec3 Vec3d";
inline constexpr std::string_view kMatrixTemplates =
    "CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
    "CompressedRowSparseMatrixMat3x3d";

/// Describes components of a category that accept the same templates: `topology("MeshTopology", "Nodes ...")`.
struct Category {
  std::string_view name = {};
  std::string_view templates = {};

  constexpr Description operator()(std::string_view class_name, std::string_view help,
                                   std::span<const Attribute> attributes = {}) const {
    return {.class_name = class_name, .category = name, .help = help, .templates = templates, .attributes = attributes};
  }
};
inline constexpr Category force_field{"ForceField", kVec3Templates};
inline constexpr Category engine{"Engine", kVec3Templates};
inline constexpr Category topology{"Topology"};
inline constexpr Category mesh_loader{"MeshLoader"};
inline constexpr Category mass{"Mass", "Vec3 Vec3d Vec3,double Vec3d,double Vec3,Vec3"};
inline constexpr Category projective_constraint{"ProjectiveConstraint", kVec3Templates};
inline constexpr Category ode_solver{"OdeSolver"};
inline constexpr Category mapping{"Mapping", "Vec3,Vec3 Vec3d,Vec3d"};

}  // namespace hexaplast::attributes
