// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/tissue_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "contact/tissue_surface.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {
namespace {

constexpr double kPerCheck = 0.5;        // of the thickness that bodies may move against each other between two checks
constexpr double kMaxEdges = 500;        // that they may move within a step: what moves more has blown up
constexpr double kMarginOfBoxes = 1e-6;  // of the size of boxes
constexpr double kKept = 0.5;            // of an edge that what touched may be expected in front of the surface
constexpr double kFraction = 0.5;        // of the stiffness, for each of the two sides
constexpr double kRounding = 1e-9;       // of an edge, of surfaces that lie on one another
constexpr double kOther = 0.01;          // of an edge, by which a surface is nearer than one that was touched
constexpr double kPerEdge = 0.5;         // distance of samples, in edges of the other body

/// What stays of a sample from step to step.
struct SampleState {
  double normal_force = 0;  // N [N] at the end of the latest step; 0: does not touch, and has no anchor
  int face = -1;            // of the other surface, of the side that it came through; -1: it was not within
  int hexahedron = -1;      // of the other body, that has the anchor
  CornerWeights anchor = CornerWeights::Zero();
  double distance = std::numeric_limits<double>::infinity();  // [m] at which it begins to touch, if less than d
  bool is_new = false;                                        // that distance is to be found

  bool has_parted() const { return distance < std::numeric_limits<double>::infinity(); }
  bool is_known() const { return hexahedron >= 0 || has_parted() || is_new; }
  void end_contact() { *this = {.distance = distance, .is_new = is_new}; }
};

double greatest_speed(ConstPoints v, std::span<const int> nodes, const Vec3& mean) {
  double squared = 0;
  for (const int n : nodes) squared = std::max(squared, (v.row(n).transpose() - mean).squaredNorm());
  return std::sqrt(squared);
}

/// Of x + fraction v.
Eigen::AlignedBox3d box_of(ConstPoints x, ConstPoints v, std::span<const int> nodes, double fraction,
                           double margin = 0) {
  Eigen::AlignedBox3d box;
  for (const int n : nodes) box.extend(Vec3((x.row(n) + fraction * v.row(n)).transpose()));
  box.min().array() -= margin;
  box.max().array() += margin;
  return box;
}

/// A box at the beginning of a step and at its end, and one that holds what moves straight between them.
struct MovingBox {
  Eigen::AlignedBox3d begin, end;

  Eigen::AlignedBox3d at(double fraction) const {
    return {Vec3((1 - fraction) * begin.min() + fraction * end.min()),
            Vec3((1 - fraction) * begin.max() + fraction * end.max())};
  }
};

/// Whether boxes come as near as this. Rounding must not decide it.
bool are_near(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, double distance) {
  return !(a.exteriorDistance(b) > distance + kMarginOfBoxes * (distance + a.sizes().norm() + b.sizes().norm()));
}

Vec3 point_of(ConstPoints x, const Hexahedron& corners, const CornerWeights& weights) {
  return gather(x, corners).transpose() * weights;
}

}  // namespace

/// Samples of one body, looked up in the other.
struct TissueContact::Side {
  int from = 0, to = 1;  // bodies
  SurfaceSamples samples;
  TissueSurface surface;
  std::vector<SampleState> states;

  struct Found {
    std::optional<TissueSurface::Place> place;
    Vec3 difference = Vec3::Zero();    // of the sample from the place of the other body [m], where it was found
    Vec3 displacement = Vec3::Zero();  // of the sample from its anchor [m]
  };
  std::vector<Found> found;

  double distance_of(std::size_t i, const ContactSettings& settings) const {  // [m] at which a sample begins to touch
    return std::min(states[i].distance, settings.distance);
  }
  std::span<const int> own(const SurfaceSamples::Sample& sample, bool touches_itself) const {
    return touches_itself ? std::span(sample.nodes.data(), static_cast<std::size_t>(sample.num_nodes))
                          : std::span<const int>();
  }
};

TissueContact::TissueContact(const HexMesh& first, const HexMesh& second, ContactSettings settings, int max_parts)
    : meshes_{&first, &second}, max_parts_(max_parts) {
  set_settings(settings);
  set_alive({}, {});
}

TissueContact::TissueContact(const HexMesh& body, ContactSettings settings, int max_parts)
    : TissueContact(body, body, settings, max_parts) {}

TissueContact::~TissueContact() = default;
TissueContact::TissueContact(TissueContact&&) noexcept = default;
TissueContact& TissueContact::operator=(TissueContact&&) noexcept = default;

void TissueContact::set_settings(ContactSettings settings) {
  settings.require_valid("TissueContact");
  settings_ = settings;
}

void TissueContact::set_alive(std::span<const unsigned char> first, std::span<const unsigned char> second,
                              const std::array<SplitNodes, 2>& split) {
  const bool with_itself = meshes_[0] == meshes_[1];
  const std::array alive = {first, with_itself ? first : second};
  std::vector<std::unique_ptr<Side>> sides;
  for (int from = 0; from < (with_itself ? 1 : 2); ++from) {
    const int to = 1 - from;
    TissueSurface surface(*meshes_[to], alive[to], with_itself);
    // as at first, so that samples stay the same when hexahedra go; without hexahedra nothing touches
    if (sides_.empty()) wanted_[from] = surface.mean_edge() > 0 ? kPerEdge * surface.mean_edge() : 1;
    SurfaceSamples samples = SurfaceSamples::on(*meshes_[from], alive[from], wanted_[from], max_parts_);
    nodes_[to] = surface.nodes();
    if (with_itself) nodes_[from] = nodes_[to];
    auto side = std::make_unique<Side>(Side{from, to, std::move(samples), std::move(surface), {}, {}});
    side->states.resize(side->samples.samples.size());
    side->found.resize(side->samples.samples.size());
    if (!sides_.empty()) {
      std::map<decltype(SurfaceSamples::Sample().key()), SampleState> before;
      const Side& old = *sides_[from];
      const std::vector<int> faces = side->surface.faces_since(old.surface, split[to]);
      for (std::size_t i = 0; i < old.states.size(); ++i)
        if (old.states[i].is_known()) before.emplace(old.samples.samples[i].key(), old.states[i]);
      for (std::size_t i = 0; i < side->states.size(); ++i) {
        SampleState& state = side->states[i];
        const SurfaceSamples::Sample& sample = side->samples.samples[i];
        if (const auto at = before.find(sample.key(split[from])); at != before.end()) {
          state = at->second;
          if (state.face >= 0) state.face = faces[state.face];
          if (!alive[to].empty() && state.hexahedron >= 0 && !alive[to][state.hexahedron]) state.end_contact();
        }
        state.is_new = state.is_new || std::ranges::any_of(side->own(sample, with_itself), [&](int node) {
                         return side->surface.has_changed_at(node, old.surface, split[to]);
                       });
        has_opened_ = has_opened_ || state.is_new;
      }
    }
    sides.push_back(std::move(side));
  }
  has_touching_ = !sides_.empty();
  sides_ = std::move(sides);
  terms_.terms.clear();
}

/// As many that bodies move by half of their thickness against each other from one to the next.
double TissueContact::num_checks(const Pair<ConstPoints>& v, double h) const {
  Vec3 mean = Vec3::Zero();
  for (const int n : nodes_[0]) mean += v.first.row(n).transpose();
  for (const int n : nodes_[1]) mean += v.second.row(n).transpose();
  mean /= std::max(static_cast<double>(nodes_[0].size() + nodes_[1].size()), 1.0);
  const double way = h * (greatest_speed(v.first, nodes_[0], mean) + greatest_speed(v.second, nodes_[1], mean)),
               edge = this->edge();
  if (!(edge > 0 && way > 0 && std::isfinite(way))) return 1;
  if (way > kMaxEdges * edge)
    throw NumericalError(
        fmt::format("contact of bodies: they move by {:.3g} m against each other in a step, which may be at most {:g} "
                    "edges ({:.3g} m): the time step must be shorter",
                    way, kMaxEdges, kMaxEdges * edge));
  double thickness = edge;
  for (const auto& side : sides_) thickness = std::min(thickness, side->surface.thickness());
  return std::max(std::ceil(way / (kPerCheck * thickness)), 1.0);
}

double TissueContact::depth_at(const Pair<ConstPoints>& x) {
  const bool with_itself = meshes_[0] == meshes_[1];
  double depth = 0;
  for (const auto& side : sides_) {
    const auto& [own, others] = side->from == 0 ? std::tie(x.first, x.second) : std::tie(x.second, x.first);
    side->surface.look_at(others, box_of(own, own, nodes_[side->from], 0), 0);
    for (const SurfaceSamples::Sample& sample : side->samples.samples)
      if (const auto place = side->surface.find(sample.at(own), {}, 0, side->own(sample, with_itself)))
        depth = std::max(depth, -place->distance);
  }
  return depth;
}

/// Where samples begin to touch. With others around them than before: where they are, so that the force stays as it is.
/// Those that do not press: at the largest distance since, or where they are if they have come upon another surface.
void TissueContact::find_distances(ConstPoints x) {
  Side& side = *sides_[0];
  const double D = settings_.distance, edge = this->edge();
  const auto is_looked_at = [](const SampleState& state) {
    return state.is_new || (state.normal_force == 0 && state.has_parted());
  };
  Eigen::AlignedBox3d region;
  for (std::size_t i = 0; i < side.states.size(); ++i)
    if (is_looked_at(side.states[i])) region.extend(side.samples.samples[i].at(x));
  if (region.isEmpty()) return;
  side.surface.look_at(x, {region.min().array() - D, region.max().array() + D}, D);
  parallel_for(static_cast<int>(side.states.size()), [&](int i) {
    SampleState& state = side.states[i];
    if (!is_looked_at(state)) return;
    const SurfaceSamples::Sample& sample = side.samples.samples[i];
    const Vec3 p = sample.at(x);
    const std::span<const int> nodes = side.own(sample, true);
    const bool touches = state.normal_force > 0;
    TissueSurface::Side before;
    if (touches) before = {state.face, side.samples.outwards(i, x)};
    const auto place = side.surface.find(p, before, touches ? std::max(kKept * edge, D) : D, nodes);
    if (place && touches)
      state.distance = std::min(state.distance,
                                place->distance + state.normal_force / (kFraction * settings_.stiffness * sample.area));
    else if (place)
      state.distance = state.is_new || place->distance < state.distance - kOther * edge
                           ? place->distance
                           : std::max(state.distance, place->distance);
    else if (side.surface.is_clear(p, D, nodes))
      state.distance = std::numeric_limits<double>::infinity();
    else
      return;  // something is near that it does not touch: it is looked at again
    if (state.distance > D + kRounding * edge) state.distance = std::numeric_limits<double>::infinity();
    state.is_new = false;
  });
}

void TissueContact::begin_step(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, double h) {
  terms_.terms.clear();
  totals_.touching = totals_.slipping = 0;
  first_sample_.clear();
  num_examined_ = 0;
  const bool with_itself = meshes_[0] == meshes_[1];
  const std::array<const ConstPoints*, 2> xs = {&x.first, &x.second}, vs = {&v.first, &v.second};

  // boxes first: bodies that are far from each other cost nothing else
  const double edge = this->edge(),
               nearest = has_touching_ ? std::max(kKept * edge, settings_.distance) : settings_.distance;
  std::array<MovingBox, 2> boxes;
  if (settings_.is_active && !with_itself)
    for (int body = 0; body < 2; ++body)
      boxes[body] = {box_of(*xs[body], *vs[body], nodes_[body], 0), box_of(*xs[body], *vs[body], nodes_[body], h)};
  const auto may_meet = [&](const Eigen::AlignedBox3d& first, const Eigen::AlignedBox3d& second) {
    return with_itself || are_near(first, second, nearest);
  };
  if (!settings_.is_active || !may_meet(boxes[0].begin.merged(boxes[0].end), boxes[1].begin.merged(boxes[1].end))) {
    if (has_touching_)
      for (const auto& side : sides_) std::ranges::for_each(side->states, &SampleState::end_contact);
    has_touching_ = false;
    return;
  }
  if (with_itself) find_distances(x.first);
  const double num_checks = this->num_checks(v, h);
  for (const auto& side : sides_) side->found.assign(side->states.size(), {});

  for (double check = 1; check <= num_checks; ++check) {
    const double fraction = check / num_checks;
    if (!may_meet(boxes[0].at(fraction), boxes[1].at(fraction))) continue;
    for (int body = 0; body < (with_itself ? 1 : 2); ++body) expected_[body] = *xs[body] + fraction * h * *vs[body];
    for (const auto& of : sides_) {
      Side& side = *of;
      const PointArray &own = expected_[side.from], &others = expected_[with_itself ? 0 : side.to];
      num_examined_ += static_cast<long>(side.states.size());
      side.surface.look_at(others, box_of(own, own, nodes_[side.from], 0, settings_.distance), settings_.distance);
      parallel_for(static_cast<int>(side.states.size()), [&](int i) {
        Side::Found& found = side.found[i];
        if (found.place) return;
        const SurfaceSamples::Sample& sample = side.samples.samples[i];
        const SampleState& state = side.states[i];
        const Vec3 p = sample.at(own);
        const bool touched = state.normal_force > 0;
        // lips lie on one another but for rounding
        const double distance = side.distance_of(i, settings_), slack = state.has_parted() ? kRounding * edge : 0;
        if (!touched && !side.surface.box().contains(p)) return;
        // what touched stays a contact until it would pull
        const double reach = touched ? std::max(kKept * edge, settings_.distance) : std::max(distance, 0.0) + slack;
        TissueSurface::Side before;
        if (touched) before = {state.face, side.samples.outwards(i, own)};
        found.place = side.surface.find(p, before, reach, side.own(sample, with_itself));
        if (found.place && !touched && distance < 0 && found.place->distance > distance + slack) found.place.reset();
        if (!found.place) return;
        const HexMesh& mesh = *meshes_[side.to];
        found.difference = p - point_of(others, mesh.hexahedra()[found.place->hexahedron], found.place->weights);
        if (touched) {
          found.displacement = p - point_of(others, mesh.hexahedra()[state.hexahedron], state.anchor);
          return;
        }
        // it stuck from when it touched, in this check at the earliest
        const Vec3 change = h / num_checks *
                            (sample.at(*vs[side.from]) -
                             point_of(*vs[side.to], mesh.hexahedra()[found.place->hexahedron], found.place->weights));
        before = {state.face, side.samples.outwards(i, own)};
        side.surface.turn_to_facing(*found.place, p, before.outwards, side.own(sample, with_itself));
        side.surface.turn_to_entry(*found.place, p, change, before, side.own(sample, with_itself));
        const double depth = std::max(distance - found.place->distance, 0.0),
                     approach = -found.place->normal.dot(change);
        found.displacement = (approach > depth ? depth / approach : 1) * change;
      });
    }
  }

  int first = 0;
  for (const auto& of : sides_) {
    Side& side = *of;
    for (std::size_t i = 0; i < side.states.size(); ++i) {
      SampleState& state = side.states[i];
      const Side::Found& found = side.found[i];
      if (!found.place) {
        if (has_opened_ && state.normal_force > 0) state.distance = side.distance_of(i, settings_);
        state.end_contact();
        continue;
      }
      const SurfaceSamples::Sample& sample = side.samples.samples[i];
      const Hexahedron& corners = meshes_[side.to]->hexahedra()[found.place->hexahedron];
      // r of a term is of the first body less the second
      const double sign = side.from == 0 ? 1 : -1;
      ContactTerm& term = terms_.terms.emplace_back();
      term.sample = first + static_cast<int>(i);
      const auto add_sample = [&] {
        for (int a = 0; a < sample.num_nodes; ++a) term.add_node(sample.nodes[a], sign * sample.weights[a]);
      };
      const auto add_corners = [&] {
        for (int a = 0; a < kCorners; ++a) term.add_node(corners[a], -sign * found.place->weights[a]);
      };
      if (side.from == 0)
        add_sample();
      else
        add_corners();
      term.num_first = term.num_nodes;
      if (side.from == 0)
        add_corners();
      else
        add_sample();

      term.normal = sign * found.place->normal;
      const Vec3 r = sign * found.difference;
      term.place = r - (found.place->distance - side.distance_of(i, settings_)) * term.normal;
      term.stiffness = kFraction * settings_.stiffness * sample.area;
      term.damping = kFraction * settings_.damping * sample.area;
      if (state.has_parted()) term.negligible = kRounding * edge * term.stiffness;
      if (state.normal_force == 0) {
        state.hexahedron = found.place->hexahedron;
        state.anchor = found.place->weights;
      }
      state.face = found.place->face;
      term.anchor = r - sign * found.displacement;
      term.stick = kFraction * settings_.tangential_stiffness * sample.area;
      term.friction = settings_.friction;
      term.normal_before = state.normal_force;
    }
    first_sample_.push_back(first);
    first += static_cast<int>(side.states.size());
  }
  has_touching_ = !terms_.empty();
  if (terms_.empty()) return;
  for (int body = 0; body < (with_itself ? 1 : 2); ++body) expected_[body] = *xs[body] + h * *vs[body];
  terms_.begin_step(x, {expected_[0], expected_[with_itself ? 0 : 1]}, h);
}

void TissueContact::end_step(const Pair<ConstPoints>& x) {
  totals_ = {};
  if (has_touching_)
    for (const auto& side : sides_)
      for (SampleState& state : side->states) {
        if (has_opened_ && state.normal_force > 0) state.distance = std::min(state.distance, settings_.distance);
        state.normal_force = 0;
      }
  for (const ContactTerm& term : terms_.terms) {
    const auto [r, change] = terms_.end_of(term, x);
    const double N = term.normal_force(r, change), g = term.gap(r);
    Side& side = *sides_[sides_.size() > 1 && term.sample >= first_sample_[1] ? 1 : 0];
    const int i = term.sample - first_sample_[&side == sides_[0].get() ? 0 : 1];
    if (meshes_[0] != meshes_[1]) totals_.force += term.force(r, change);
    totals_.depth = std::max(totals_.depth, -(g + side.distance_of(i, settings_)));
    if (N <= 0) continue;

    SampleState& state = side.states[i];
    const SurfaceSamples::Sample& sample = side.samples.samples[i];
    state.normal_force = N;
    const Vec3 u = term.displacement(term.at(x));
    const double stiffness = kFraction * settings_.tangential_stiffness * sample.area, limit = settings_.friction * N,
                 size = u.norm(), kept = stiffness * size > limit ? limit / (stiffness * size) : 1;
    totals_.energy += term.stiffness * g * g / 2 + stiffness * kept * kept * size * size / 2;

    // the anchor, in the hexahedron of the other body that the sample was found in
    const bool is_first = side.from == 0;
    const ConstPoints &own = is_first ? x.first : x.second, &others = is_first ? x.second : x.first;
    const Vec3 at = sample.at(own) - (is_first ? 1 : -1) * kept * u;
    const int begin = is_first ? term.num_first : 0;
    Hexahedron corners;
    std::copy_n(term.nodes.begin() + begin, kCorners, corners.begin());
    const ElementPoints there = gather(others, corners);
    state.anchor = weights_beyond(there, nearest_place(there, at, side.surface.mean_edge()).s, at, kFarthestBeyond);
    state.hexahedron = side.found[i].place->hexahedron;
  }
}

void TissueContact::begin_where_they_are() {
  if (meshes_[0] != meshes_[1]) return;
  for (const auto& side : sides_)
    for (SampleState& state : side->states) state.is_new = true;
  has_opened_ = true;
}

void TissueContact::reset() {
  for (const auto& side : sides_) side->states.assign(side->states.size(), {});
  has_touching_ = has_opened_ = false;
  terms_.terms.clear();
  totals_ = {};
}

double TissueContact::edge() const {
  double edge = sides_[0]->surface.mean_edge();
  for (const auto& side : sides_) edge = std::min(edge, side->surface.mean_edge());
  return edge;
}

double TissueContact::spacing() const {
  double spacing = 0;
  for (const auto& side : sides_) spacing = std::max(spacing, side->samples.spacing);
  return spacing;
}

void TissueContact::serialize(Archive& archive) {
  std::vector<double> numbers, distances;
  std::vector<int> places;
  std::size_t count = 0;
  for (const auto& side : sides_)
    for (const SampleState& state : side->states) {
      ++count;
      numbers.push_back(state.normal_force);
      numbers.insert(numbers.end(), state.anchor.begin(), state.anchor.end());
      places.insert(places.end(), {state.hexahedron, state.face, state.is_new ? 1 : 0});
      distances.push_back(state.distance);
    }
  ContactTotals totals = totals_;
  totals.touching = num_touching();
  totals.slipping = num_slipping();
  bool has_opened = has_opened_;
  archive(numbers, places, distances, has_opened, totals.force, totals.depth, totals.energy, totals.touching,
          totals.slipping);
  if (!archive.reads()) return;
  if (numbers.size() != (1 + kCorners) * count || places.size() != 3 * count || distances.size() != count)
    throw InputError(fmt::format("contact is saved of {} samples, there are {}", places.size() / 3, count));
  const auto is_number = [](double distance) { return distance > -std::numeric_limits<double>::infinity(); };
  const bool is_finite = std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }) &&
                         std::ranges::all_of(distances, is_number);
  if (!is_finite) throw InputError("contact is saved with numbers that are not finite");
  totals.require_of(count);
  std::vector<SampleState> states;
  for (const auto& side : sides_)
    for (std::size_t i = 0; i < side->states.size(); ++i) {
      const std::size_t k = states.size();
      const SampleState& state = states.emplace_back(SampleState{
          .normal_force = std::max(numbers[(1 + kCorners) * k], 0.0),
          .face = places[3 * k + 1],
          .hexahedron = places[3 * k],
          .anchor = CornerWeights::Map(&numbers[(1 + kCorners) * k + 1]),
          .distance = distances[k],
          .is_new = places[3 * k + 2] != 0,
      });
      const bool has_place =
          side->surface.has_hexahedron(state.hexahedron) && state.face >= -1 && state.face < side->surface.num_faces();
      if ((state.normal_force > 0 || state.face >= 0) && !has_place)
        throw InputError(fmt::format("contact is saved with hexahedron {} and face {}, which are not there",
                                     state.hexahedron, state.face));
    }
  auto from = states.begin();
  for (const auto& side : sides_) {
    std::copy_n(from, side->states.size(), side->states.begin());
    from += std::ssize(side->states);
  }
  has_touching_ = true;
  has_opened_ = has_opened;
  terms_.terms.clear();
  totals_ = totals;
}

}  // namespace hexaplast
