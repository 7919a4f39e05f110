// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/bodies.hpp"

#include <algorithm>
#include <numeric>

namespace hexaplast::output {
namespace {

HexMesh mesh_of_all(std::span<const Bodies::Entry> entries) {
  int num_nodes = 0;
  for (const Bodies::Entry& entry : entries) num_nodes += entry.body->mesh().num_nodes();
  PointArray positions(num_nodes, 3);
  std::vector<Hexahedron> hexahedra;
  for (const Bodies::Entry& entry : entries) {
    const HexMesh& mesh = entry.body->mesh();
    Bodies::rows(entry, positions) = mesh.positions();
    for (Hexahedron hexahedron : mesh.hexahedra()) {
      for (int& node : hexahedron) node += entry.first_node;
      hexahedra.push_back(hexahedron);
    }
  }
  return {std::move(positions), std::move(hexahedra)};
}

/// Behind one another.
void place(std::span<Bodies::Entry> entries) {
  int num_nodes = 0, num_hexahedra = 0;
  for (Bodies::Entry& entry : entries) {
    entry.first_node = num_nodes;
    entry.first_hexahedron = num_hexahedra;
    num_nodes += entry.body->mesh().num_nodes();
    num_hexahedra += entry.body->mesh().num_elements();
  }
}

bool is_joined(const Body& body) { return body.settings().rest_shape == RestShape::kJoined; }

}  // namespace

Bodies::Bodies(const Body& only) : entries_{{.name = "body", .body = &only}} {}

Bodies::Bodies(std::vector<Entry> entries) : entries_(std::move(entries)) {
  place(entries_);
  if (is_one()) return;
  mesh_ = std::make_shared<HexMesh>(mesh_of_all(entries_));
  for (const Entry& entry : entries_) revisions_.push_back(entry.body->revision());
}

void Bodies::update() const {
  if (is_one()) return;
  const auto revision_of = [](const Entry& entry) { return entry.body->revision(); };
  if (std::ranges::equal(entries_, revisions_, {}, revision_of)) return;
  std::ranges::transform(entries_, revisions_.begin(), revision_of);
  place(entries_);
  HexMesh present = mesh_of_all(entries_);
  if (present.hexahedra() != mesh_->hexahedra()) *mesh_ = std::move(present);
}

bool Bodies::are_split() const {
  return std::ranges::any_of(entries_, [](const Entry& entry) { return entry.body->copies().is_split(); });
}

std::shared_ptr<const OpenFaces> Bodies::open_faces() const {
  if (!are_split()) return nullptr;
  const auto open = std::make_shared<OpenFaces>();
  int num_initial = 0;
  for (const Entry& entry : all()) {
    const Body& body = *entry.body;
    const OpenFaces own = hexaplast::open_faces(body.joints(), body.copies(), body.opened(), body.crossings(),
                                                body.mesh().num_elements());
    for (const int node : own.initial_node) open->initial_node.push_back(num_initial + node);
    for (const int node : own.copy) open->copy.push_back(entry.first_node + node);
    open->crossing.insert(open->crossing.end(), own.crossing.begin(), own.crossing.end());
    num_initial += body.copies().num_initial();
  }
  return open;
}

std::span<const unsigned char> Bodies::alive() const {
  if (is_one()) return entries_[0].body->alive();
  alive_.clear();
  for (const Entry& entry : entries_) {
    const std::span<const unsigned char> own = entry.body->alive();
    alive_.insert(alive_.end(), own.begin(), own.end());
  }
  return alive_;
}

const PointArray& Bodies::plastic_rest_positions() const {
  if (is_one()) return entries_[0].body->plastic_rest_positions();
  plastic_rest_positions_.resize(mesh().num_nodes(), 3);
  for (const Entry& entry : all()) rows(entry, plastic_rest_positions_) = entry.body->plastic_rest_positions();
  return plastic_rest_positions_;
}

ElementFields Bodies::fields(ConstPoints positions) const {
  if (is_one()) return entries_[0].body->fields(positions);
  ElementFields fields;
  for (const Entry& entry : all()) {
    const ElementFields own = entry.body->fields(rows(entry, positions));
    for (std::vector<double> ElementFields::*member :
         {&ElementFields::plastic_strain, &ElementFields::yield_stress, &ElementFields::volume_ratio,
          &ElementFields::stress_norm, &ElementFields::strain})
      (fields.*member).insert((fields.*member).end(), (own.*member).begin(), (own.*member).end());
  }
  return fields;
}

namespace {

template <class Value>
double sum_over(std::span<const Bodies::Entry> entries, const Value& value) {
  return std::accumulate(entries.begin(), entries.end(), 0.0,
                         [&](double sum, const Bodies::Entry& entry) { return sum + value(entry); });
}

}  // namespace

double Bodies::energy(ConstPoints positions) const {
  return sum_over(all(), [&](const Entry& entry) { return entry.body->energy(rows(entry, positions)); });
}

double Bodies::dissipated_energy() const {
  return sum_over(all(), [](const Entry& entry) { return entry.body->dissipated_energy(); });
}

double Bodies::volume(ConstPoints positions) const {
  return sum_over(all(), [&](const Entry& entry) { return entry.body->volume(rows(entry, positions)); });
}

double Bodies::initial_volume() const {
  return sum_over(all(), [](const Entry& entry) { return entry.body->initial_volume(); });
}

bool Bodies::has_plastic_rest_at_hand() const {
  return std::ranges::all_of(entries_,
                             [](const Entry& entry) { return is_joined(*entry.body) || !entry.body->can_flow(); });
}

// Flow at isolated quadrature points keeps the volume of each hexahedron.
double Bodies::plastic_volume() const {
  return sum_over(all(), [](const Entry& entry) {
    const Body& body = *entry.body;
    return body.volume(is_joined(body) ? body.plastic_rest_positions() : body.mesh().positions());
  });
}

std::size_t Bodies::num_removed() const {
  std::size_t count = 0;
  for (const Entry& entry : entries_) count += entry.body->removed().size();
  return count;
}

std::size_t Bodies::num_opened() const {
  std::size_t count = 0;
  for (const Entry& entry : entries_) count += entry.body->opened().size();
  return count;
}

}  // namespace hexaplast::output
