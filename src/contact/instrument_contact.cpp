// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/instrument_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {
namespace {

constexpr double kFarthestPerCheck = 0.5;  // of the smallest radius that a sample may move against the instrument
constexpr double kMaxChecks = 1e15;        // within a step: they are counted
constexpr int kMaxDistances = 1000;        // of them, those for which the distance is asked
constexpr double kOnTheSameSide = 0.7;     // cosine, from which a surface that turned is the one that was touched
constexpr double kMarginOfBox = 1e-6;      // of a body's size, by which its box is larger
constexpr double kUneven = 0.1;            // of a depth: an edge was passed on the way to it
constexpr double kLeastStep = 0.05;        // of the smallest radius, towards a side
constexpr int kMaxSteps = 200;             // of them
constexpr int kHalvings = 40;

/// Where a point of the solid leaves it straight towards `side`, if that is through a surface that faces there: the
/// distance of the point from it, negative, and its normal.
std::optional<SignedDistance> towards_side(const Solid& solid, const Vec3& point, const Vec3& side) {
  const double least = kLeastStep * solid.smallest_radius();
  double inside = 0, outside = 0;
  for (int step = 0;; ++step) {
    const double value = solid.distance(point + outside * side).value;
    if (value >= 0) break;
    if (step == kMaxSteps) return std::nullopt;
    inside = outside;
    outside += std::max(-value, least);
  }
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (inside + outside) / 2;
    (solid.distance(point + middle * side).value < 0 ? inside : outside) = middle;
  }
  const Vec3 normal = solid.distance(point + inside * side).normal;
  if (!(normal.dot(side) > kOnTheSameSide)) return std::nullopt;
  return SignedDistance{-outside * normal.dot(side), normal};
}

}  // namespace

InstrumentContact::InstrumentContact(Solid solid, ContactSettings settings, SurfaceSamples samples)
    : solid_(std::move(solid)) {
  take_samples(std::move(samples));
  set_settings(settings);
}

void InstrumentContact::take_samples(SurfaceSamples samples) {
  samples_ = std::move(samples);
  states_.assign(samples_.samples.size(), {});
  found_.assign(samples_.samples.size(), {});
  has_touching_ = false;
  nodes_.clear();
  spread_ = 1;
  std::vector<unsigned char> is_known;
  for (const SurfaceSamples::Sample& sample : samples_.samples) {
    double spread = 0;
    for (int a = 0; a < sample.num_nodes; ++a) {
      const auto node = static_cast<std::size_t>(sample.nodes[a]);
      spread += std::abs(sample.weights[a]);
      if (node >= is_known.size()) is_known.resize(node + 1, 0);
      if (!is_known[node]) nodes_.push_back(sample.nodes[a]);
      is_known[node] = 1;
    }
    spread_ = std::max(spread_, spread);
  }
  std::ranges::sort(nodes_);
}

void InstrumentContact::set_settings(ContactSettings settings) {
  settings.require_valid("InstrumentContact");
  settings_ = settings;
}

void InstrumentContact::set_samples(SurfaceSamples samples, const SplitNodes& split) {
  std::map<decltype(SurfaceSamples::Sample().key()), SampleState> before;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i].is_within()) before.emplace(samples_.samples[i].key(), states_[i]);
  take_samples(std::move(samples));
  has_touching_ = !before.empty();
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (const auto at = before.find(samples_.samples[i].key(split)); at != before.end()) states_[i] = at->second;
  terms_.terms.clear();
}

// By the box of the places that samples have relative to the instrument on their straight ways. As the instrument
// turns, they lie beside it by no more than a point of the body does that turns with it.
bool InstrumentContact::can_touch(ConstPoints x, ConstPoints v, double h, const Pose& begin, const Pose& end) const {
  if (!settings_.is_active) return false;
  Eigen::AlignedBox3d first, last;
  const Eigen::Index count = nodes_.empty() ? x.rows() : std::ssize(nodes_);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index node = nodes_.empty() ? k : nodes_[static_cast<std::size_t>(k)];
    const Vec3 p = x.row(node).transpose();
    first.extend(p);
    last.extend(Vec3(p + h * v.row(node).transpose()));
  }
  for (Eigen::AlignedBox3d* box : {&first, &last}) {
    const Vec3 margin = ((spread_ - 1) / 2 + kMarginOfBox) * box->sizes();
    box->min() -= margin;
    box->max() += margin;
  }
  first.translate(-begin.position);
  last.translate(-end.position);
  const double farthest = last.min().cwiseAbs().cwiseMax(last.max().cwiseAbs()).norm();
  const double turned = 2 * (begin.orientation.conjugate() * end.orientation).vec().norm() * farthest;
  const Eigen::AlignedBox3d all = first.merged(last);
  return !(all.exteriorDistance(Vec3::Zero().eval()) >
           (1 + kMarginOfBox) * (solid_.reach() + settings_.distance + turned));
}

void InstrumentContact::begin_step(ConstPoints x, ConstPoints v, double h, const Pose& begin, const Pose& end) {
  pose_before_ = begin;
  pose_ = end;
  terms_.terms.clear();
  totals_.touching = totals_.slipping = 0;
  num_examined_ = 0;
  if (samples_.samples.empty() || !can_touch(x, v, h, begin, end)) {
    if (has_touching_) states_.assign(states_.size(), {});
    has_touching_ = false;
    return;
  }

  const auto num_samples = static_cast<int>(samples_.samples.size());
  num_examined_ = num_samples;
  found_.assign(samples_.samples.size(), {});
  const double distance = settings_.distance, near = solid_.reach() + distance,
               turned = begin.orientation.angularDistance(end.orientation);  // [rad]

  parallel_for(num_samples, [&](int i) {
    const SurfaceSamples::Sample& sample = samples_.samples[i];
    const Vec3 p = sample.at(x), expected = p + h * sample.at(v);
    // against the instrument, in its own frame
    const Vec3 from = begin.to_own(p), to = end.to_own(expected);
    // at most: as it turns, no place on the way is farther from its origin than one of the ends
    const double way =
        turned > 0 ? (expected - p - end.position + begin.position).norm() + turned * std::max(from.norm(), to.norm())
                   : (to - from).norm();
    if (!(std::min(from.norm(), to.norm()) <= near + way) || !std::isfinite(way)) return;

    // the first check that finds it within: it cannot be past the middle of the instrument yet
    const double num_checks =
        std::clamp(std::ceil(way / (kFarthestPerCheck * solid_.smallest_radius())), 1.0, kMaxChecks);
    const bool bends = turned > 0 && num_checks > 1;
    const auto place_at = [&](double check) -> Vec3 {
      const double fraction = check / num_checks;
      if (bends) return Pose::between(begin, end, fraction).to_own(p + fraction * (expected - p));
      return from + fraction * (to - from);
    };
    const SignedDistance at_begin = solid_.distance(from);
    double before = at_begin.value, check_before = 0;
    bool touched = before < distance;
    // the one that it came through, as long as it stays within
    if (touched) found_[i].side = states_[i].is_within() ? states_[i].normal : at_begin.normal;
    Vec3 side = found_[i].side;
    int num_looks = 0;
    for (double check = 1;;) {
      if (++num_looks > kMaxDistances)
        throw NumericalError(fmt::format(
            "contact of an instrument: along its surface it moves by more than {:.3g} m in a step, {:g} times its "
            "smallest radius: the time step must be shorter, or the instrument thicker",
            kMaxDistances * kFarthestPerCheck * solid_.smallest_radius(), kMaxDistances * kFarthestPerCheck));
      Vec3 at = place_at(check);
      SignedDistance now = solid_.distance(at);
      // what touched stays a contact until it would pull, unless it slid over an edge
      if (now.value >= distance && !(touched && now.normal.dot(side) > kOnTheSameSide)) {
        if (check == num_checks) return;
        touched = false;
        before = now.value;
        check_before = check;
        // the surface is no nearer: what lies between finds nothing
        check = std::min(check + std::max(std::floor((now.value - distance) / way * num_checks), 1.0), num_checks);
        continue;
      }
      if (check_before < check - 1) before = solid_.distance(place_at(check - 1)).value;
      const double since = !touched ? (distance - now.value) / (before - now.value) : 0;
      Vec3 first = at - since * (bends ? Vec3(at - place_at(check - 1)) : Vec3((to - from) / num_checks));
      if (!touched) {
        SignedDistance at_first = solid_.distance(first);
        if (std::abs(at_first.value - distance) > kUneven * (distance - now.value)) {
          Vec3 within = at, without = place_at(check - 1);
          for (int k = 0; k < kHalvings; ++k) {
            first = (within + without) / 2;
            at_first = solid_.distance(first);
            (at_first.value < distance ? within : without) = first;
          }
        }
        side = at_first.normal;
      }
      if (check < num_checks) {  // what stays at its side, and not past the middle, is held where it ends
        const SignedDistance last = solid_.distance(to);
        if ((touched || last.value < distance) && last.normal.dot(side) > kOnTheSameSide &&
            -last.value < kFarthestPerCheck * solid_.smallest_radius()) {
          at = to;
          now = last;
          if (touched) first = at;
        }
      }
      SignedDistance touching = now;
      const auto is_of_nearest = [&] {
        return now.normal.dot(side) > kOnTheSameSide ||
               faces_more(now.normal, side, end.orientation.conjugate() * samples_.outwards(i, x));
      };
      if (now.value < 0 && !is_of_nearest())
        if (const auto of_side = towards_side(solid_, at, side)) touching = *of_side;
      found_[i] = {
          .touches = true, .place = at - touching.value * touching.normal, .side = touching.normal, .first = first};
      return;
    }
  });

  has_touching_ = false;
  for (int i = 0; i < num_samples; ++i) {
    const Found& found = found_[i];
    SampleState& state = states_[i];
    has_touching_ = has_touching_ || found.touches || !found.side.isZero(0);
    state.normal = found.side;
    if (!found.touches) {
      state.normal_force = 0;
      continue;
    }
    const SurfaceSamples::Sample& sample = samples_.samples[i];
    ContactTerm& term = terms_.terms.emplace_back();
    term.sample = i;
    for (int a = 0; a < sample.num_nodes; ++a) term.add_node(sample.nodes[a], sample.weights[a]);
    term.num_first = term.num_nodes;
    term.normal = end.orientation * found.side;
    const Vec3 place = end.to_world(found.place);
    term.place = place + distance * term.normal;
    term.velocity = (place - begin.to_world(found.place)) / h;
    term.stiffness = settings_.stiffness * sample.area;
    term.damping = settings_.damping * sample.area;
    if (state.normal_force == 0) state.anchor = found.first;
    term.anchor = end.to_world(state.anchor);
    term.stick = settings_.tangential_stiffness * sample.area;
    term.friction = settings_.friction;
    term.normal_before = state.normal_force;
  }
  if (terms_.empty()) return;
  expected_ = x + h * v;
  terms_.begin_step({x, x}, {expected_, expected_}, h);
}

void InstrumentContact::end_step(ConstPoints x) {
  totals_ = {.work = totals_.work, .friction_loss = totals_.friction_loss};
  if (has_touching_)
    for (SampleState& state : states_) state.normal_force = 0;
  for (const ContactTerm& term : terms_.terms) {
    const auto [p, change] = terms_.end_of(term, {x, x});
    const double N = term.normal_force(p, change), g = term.gap(p);
    const Vec3 tangential = term.tangential_force(p), f = N * term.normal + tangential;
    totals_.force -= f;
    totals_.torque -= (p - pose_.position).cross(f);
    totals_.depth = std::max(totals_.depth, -(g + settings_.distance));
    totals_.work += f.dot(p - pose_before_.to_world(pose_.to_own(p)));
    if (N <= 0) continue;

    SampleState& state = states_[term.sample];
    state.normal_force = N;
    const Vec3 now = term.at({x, x}), u = term.displacement(now);
    const double stiffness = settings_.tangential_stiffness * samples_.samples[term.sample].area,
                 limit = settings_.friction * N, size = u.norm(),
                 kept = stiffness * size > limit ? limit / (stiffness * size) : 1;
    // also what it is moved along the normal: the anchor stays on the sample's own level
    state.anchor = pose_.to_own(now - kept * u);
    totals_.friction_loss += tangential.norm() * (1 - kept) * size;
    totals_.energy += term.stiffness * g * g / 2 + stiffness * kept * kept * size * size / 2;
  }
}

void InstrumentContact::reset() {
  states_.assign(states_.size(), {});
  has_touching_ = false;
  terms_.terms.clear();
  totals_ = {};
}

void InstrumentContact::serialize(Archive& archive) {
  std::vector<double> numbers;
  for (const SampleState& state : states_)
    numbers.insert(numbers.end(), {state.anchor.x(), state.anchor.y(), state.anchor.z(), state.normal_force,
                                   state.normal.x(), state.normal.y(), state.normal.z()});
  ContactTotals totals = totals_;
  totals.touching = num_touching();
  totals.slipping = num_slipping();
  archive(numbers, totals.force, totals.torque, totals.depth, totals.energy, totals.work, totals.friction_loss,
          totals.touching, totals.slipping);
  if (!archive.reads()) return;
  constexpr std::size_t kNumbers = 7;  // of a sample
  if (numbers.size() != kNumbers * states_.size())
    throw InputError(
        fmt::format("contact is saved of {} samples, there are {}", numbers.size() / kNumbers, states_.size()));
  if (!std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }))
    throw InputError("contact is saved with numbers that are not finite");
  totals.require_of(states_.size());
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const double* const of = &numbers[kNumbers * i];
    states_[i] = {{of[0], of[1], of[2]}, std::max(of[3], 0.0), {of[4], of[5], of[6]}};
  }
  has_touching_ = true;
  terms_.terms.clear();
  totals_ = totals;
}

}  // namespace hexaplast
