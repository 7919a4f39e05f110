// SPDX-License-Identifier: LGPL-2.1-or-later
// A body's history through a stream, as host applications keep it.
#include <array>
#include <sstream>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/motion.hpp"
#include "support/rows.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

using support::hash_of;
using support::kEdge;
using support::kStep;

std::string saved(const Body& body) {
  std::ostringstream out;
  body.save(out);
  return out.str();
}

/// What follows stays in the stream.
void load(Body& body, const std::string& bytes) {
  std::istringstream in(bytes + "next");
  body.load(in);
  std::string rest;
  in >> rest;
  EXPECT_EQ(rest, "next");
}

Material breaking(RestShape rest_shape = RestShape::kJoined) {
  Material material = rest_shape == RestShape::kJoined ? support::yielding(100, 0.01) : support::stretching(100);
  material.fracture_stretch = 1.02;
  return material;
}

Body make_body(Precision precision = Precision::kDouble, std::array<int, 3> cells = {2, 2, 3}) {
  const RestShape rest_shape = precision == Precision::kDouble ? RestShape::kJoined : RestShape::kIsolated;
  return Body(support::distorted_block(cells, kEdge, 0.15, 162), {breaking(rest_shape)},
              {.rest_shape = rest_shape, .precision = precision});
}

/// Several plastic steps at positions that wander away from the initial ones.
void flow(Body& body, int first, int last) {
  for (int step = first; step < last; ++step) {
    support::Random random(100 + step);
    const PointArray& X = body.mesh().positions();
    const PointArray stretched = X * Vec3(1.0 + 0.02 * step, 1, 1).asDiagonal();
    body.flow(stretched + random.field(static_cast<int>(X.rows()), 0.1 * kEdge), kStep);
  }
}

TEST(SavedBody, GoesOnBitForBit) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    Body straight = make_body(precision), first = make_body(precision), second = make_body(precision);
    for (Body* body : {&straight, &first}) {
      flow(*body, 0, 7);
      body->remove(std::vector<int>{5});
    }
    load(second, saved(first));
    EXPECT_EQ(hash_of(second), hash_of(first));
    EXPECT_EQ(saved(second), saved(first));
    EXPECT_EQ(second.state().history.removed, first.state().history.removed);

    flow(straight, 7, 12);
    flow(second, 7, 12);
    EXPECT_EQ(hash_of(second), hash_of(straight));
    EXPECT_GT(straight.state().history.removed.size(), 1u) << "the case is to tear";
  }
}

TEST(SavedBody, DamageIsFoundAndNothingChanges) {
  Body body = make_body(Precision::kDouble, {1, 1, 2});
  flow(body, 0, 2);
  const std::string bytes = saved(body);
  flow(body, 2, 3);
  const std::string before = hash_of(body);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    EXPECT_THROW(load(body, damaged), InputError) << "byte " << i;
  }
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    EXPECT_THROW(load(body, bytes.substr(0, size)), InputError) << size;
  EXPECT_EQ(hash_of(body), before);
}

testing::AssertionResult refuses(Body& body, const std::string& bytes, const char* message) {
  return support::refuses<InputError>([&] { load(body, bytes); }, {message});
}

TEST(SavedBody, OfAnotherBodyIsRefused) {
  Body body = make_body();
  const std::string bytes = saved(body);
  Body other_mesh(support::distorted_block({2, 2, 3}, kEdge, 0.15, 163), {breaking()}, support::kJoined);
  Body other_settings = make_body(Precision::kMixed);
  for (Body* other : {&other_mesh, &other_settings})
    EXPECT_TRUE(refuses(*other, bytes, "another mesh or other settings"));
  std::string later = bytes;
  later[8] = 99;
  EXPECT_TRUE(refuses(body, later, "format version 99, must be 5"));
  EXPECT_TRUE(refuses(body, "mesh.pvd and other things that are no body", "no saved body"));
}

/// A value other than the default one for every member.
template <class Options>
Options all_others(std::span<const Row<Options>> rows) {
  Options options;
  for (const Row<Options>& row : rows) support::change(row, options);
  return options;
}

/// As a number lies in memory: 8 bytes of a real one, 4 of integers and words. Lists are preceded by their length.
template <class Options>
void append_bytes(std::span<const Row<Options>> rows, const Options& options, std::string& bytes) {
  const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const Row<Options>& row : rows) {
    if (row.at.list) {
      append(static_cast<std::uint64_t>(row.values(options).size()));
      for (const double number : row.values(options)) append(number);
      continue;
    }
    const double number = row.at.get(options);
    row.at.type == MemberType::kReal ? append(number) : append(static_cast<std::int32_t>(number));
  }
}

/// The names of members, and of the words that they take.
template <class Options>
std::string names_of(std::span<const Row<Options>> rows) {
  std::string names;
  for (const Row<Options>& row : rows) {
    names += row.member;
    for (const std::string_view word : row.words) names += word;
  }
  return names;
}

// Files that were saved stay readable as long as no member or word is added: then the body is another one.
TEST(SavedBody, KeepsTheBytesOfItsFormat) {
  auto settings = all_others(settings_rows());
  settings.precision = Precision::kDouble;  // all that the plain implementation has with joined rest shapes
  settings.rest_shape = RestShape::kJoined;
  settings.yield_stress_measure = YieldStressMeasure::kBiot;
  settings.relaxation = {};
  const auto material = all_others(material_rows());
  const Body body(support::distorted_block({1, 1, 1}, kEdge, 0.15, 162), {material}, settings);
  const std::string bytes = saved(body);

  std::string members, identified = names_of(material_rows()) + names_of(settings_rows());
  append_bytes(material_rows(), material, members);
  StateHash identity;
  Archive archive([&](const void* data, std::size_t size) { identified.append(static_cast<const char*>(data), size); });
  PointArray positions = body.mesh().positions();
  std::vector<Hexahedron> hexahedra = body.mesh().hexahedra();
  archive(positions, hexahedra);
  append_bytes(settings_rows(), settings, identified);
  identity.add(identified.data(), identified.size());

  std::string expected("HXPBODY\0", 8);
  const auto add = [&](const auto& value) { expected.append(reinterpret_cast<const char*>(&value), sizeof value); };
  add(std::uint32_t{5});
  add(identity.value());
  add(static_cast<std::uint64_t>(bytes.size() - 8 - 4 - 3 * 8));
  add(std::uint64_t{1});  // material
  expected += members;
  EXPECT_EQ(bytes.substr(0, expected.size()), expected);
}

TEST(SavedBody, KnowsEveryMember) {
  const HexMesh mesh = support::distorted_block({1, 1, 1}, kEdge, 0.15, 162);
  for (const Row<Settings>& row : settings_rows()) {
    Settings settings, others;
    support::change(row, others);
    try {
      validate(others);
    } catch (const InputError&) {
      settings.implementation = others.implementation = Implementation::kPlain;
    }
    Body other(mesh, {{}}, others);
    EXPECT_TRUE(refuses(other, saved(Body(mesh, {{}}, settings)), "another mesh or other settings")) << row.member;
  }
  for (const Row<Material>& row : material_rows()) {
    Material material;
    row.at.set(material, support::another(row, row.at.get(material)));
    Body first(mesh, {material}, support::kJoined), second(mesh, {{}}, support::kJoined);
    load(second, saved(first));
    EXPECT_EQ(row.at.get(second.material(0)), row.at.get(material)) << row.member;
    EXPECT_EQ(saved(second), saved(first)) << row.member;
  }
}

TEST(SavedBody, AStreamThatTakesNothingIsAnError) {
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_THROW(make_body().save(closed), InputError);
}

TEST(Archive, ListsAreCheckedBeforeTheyAreAllocated) {
  const std::uint64_t bomb = std::uint64_t{1} << 60;
  for (const bool is_text : {false, true}) {
    Archive archive{std::as_bytes(std::span(&bomb, 1))};
    std::vector<double> numbers;
    std::string text;
    EXPECT_THROW(is_text ? archive(text) : archive(numbers), InputError);
  }
}

}  // namespace
}  // namespace hexaplast
