// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/instrument_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {
namespace {

constexpr double kFarthestPerCheck = 0.5;  // of the smallest radius that a sample may move against the instrument
constexpr int kMaxChecks = 64;             // within a step
constexpr double kOnTheSameSide = 0.7;     // cosine, from which a surface that turned is the one that was touched

}  // namespace

InstrumentContact::InstrumentContact(Solid solid, ContactSettings settings, SurfaceSamples samples)
    : solid_(std::move(solid)), samples_(std::move(samples)), states_(samples_.samples.size()) {
  set_settings(settings);
}

void InstrumentContact::set_settings(ContactSettings settings) {
  settings.require_valid("InstrumentContact");
  settings_ = settings;
}

void InstrumentContact::set_samples(SurfaceSamples samples) {
  std::map<decltype(SurfaceSamples::Sample().key()), SampleState> before;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i].normal_force > 0) before.emplace(samples_.samples[i].key(), states_[i]);
  samples_ = std::move(samples);
  states_.assign(samples_.samples.size(), {});
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (const auto at = before.find(samples_.samples[i].key()); at != before.end()) states_[i] = at->second;
  terms_.terms.clear();
}

void InstrumentContact::begin_step(ConstPoints x, ConstPoints v, double h, const Pose& begin, const Pose& end) {
  pose_before_ = begin;
  pose_ = end;
  terms_.terms.clear();
  loaded_ = {};
  const auto num_samples = static_cast<int>(samples_.samples.size());
  found_.assign(samples_.samples.size(), {});
  const double distance = settings_.distance, near = solid_.reach() + distance;

  parallel_for(settings_.is_active ? num_samples : 0, [&](int i) {
    const SurfaceSamples::Sample& sample = samples_.samples[i];
    const Vec3 p = sample.at(x), expected = p + h * sample.at(v);
    // against the instrument, in its own frame
    const Vec3 from = begin.to_own(p), to = end.to_own(expected);
    const double way = (to - from).norm();
    if (!(std::min(from.norm(), to.norm()) <= near + way)) return;

    // the first check that finds it within: it cannot be past the middle of the instrument yet
    const int num_checks = static_cast<int>(
        std::clamp(std::ceil(way / (kFarthestPerCheck * solid_.smallest_radius())), 1.0, double{kMaxChecks}));
    const SignedDistance at_begin = solid_.distance(from);
    double before = at_begin.value;
    const bool touched = before < distance;
    for (int k = 1; k <= num_checks; ++k) {
      const Vec3 at = from + static_cast<double>(k) / num_checks * (to - from);
      const SignedDistance now = solid_.distance(at);
      // what touched stays a contact until it would pull, unless it slid over an edge
      if (now.value >= distance && !(touched && now.normal.dot(at_begin.normal) > kOnTheSameSide)) {
        before = now.value;
        continue;
      }
      const double since = !touched ? (distance - now.value) / (before - now.value) / num_checks : 0;
      found_[i] = {.touches = true,
                   .place = at - now.value * now.normal,
                   .normal = now.normal,
                   .first = at - since * (to - from)};
      return;
    }
  });

  for (int i = 0; i < num_samples; ++i) {
    const Found& found = found_[i];
    SampleState& state = states_[i];
    if (!found.touches) {
      state.normal_force = 0;
      continue;
    }
    const SurfaceSamples::Sample& sample = samples_.samples[i];
    ContactTerm& term = terms_.terms.emplace_back();
    term.sample = i;
    for (int a = 0; a < sample.num_nodes; ++a) term.add_node(sample.nodes[a], sample.weights[a]);
    term.num_first = term.num_nodes;
    term.normal = end.orientation * found.normal;
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
  expected_ = x + h * v;
  terms_.set_friction({expected_, expected_});
}

void InstrumentContact::end_step(ConstPoints x, ConstPoints v) {
  force_.setZero();
  torque_.setZero();
  depth_ = energy_ = 0;
  for (SampleState& state : states_) state.normal_force = 0;
  for (const ContactTerm& term : terms_.terms) {
    const Vec3 p = term.at(x), u = term.displacement(p);
    const double N = term.normal_force(p, term.at(v)), g = term.gap(p);
    const Vec3 tangential = term.tangential_force(p), f = N * term.normal + tangential;
    force_ -= f;
    torque_ -= (p - pose_.position).cross(f);
    depth_ = std::max(depth_, -(g + settings_.distance));
    work_ += f.dot(p - pose_before_.to_world(pose_.to_own(p)));
    if (N <= 0) continue;

    SampleState& state = states_[term.sample];
    state.normal_force = N;
    const double stiffness = settings_.tangential_stiffness * samples_.samples[term.sample].area,
                 limit = settings_.friction * N, size = u.norm(),
                 kept = stiffness * size > limit ? limit / (stiffness * size) : 1;
    // also what it is moved along the normal: the anchor stays on the sample's own level
    state.anchor = pose_.to_own(p - kept * u);
    friction_loss_ += tangential.norm() * (1 - kept) * size;
    energy_ += term.stiffness * g * g / 2 + stiffness * kept * kept * size * size / 2;
  }
}

void InstrumentContact::reset() {
  states_.assign(states_.size(), {});
  terms_.terms.clear();
  loaded_ = {};
  force_.setZero();
  torque_.setZero();
  depth_ = energy_ = work_ = friction_loss_ = 0;
}

void InstrumentContact::serialize(Archive& archive) {
  std::vector<double> numbers;
  for (const SampleState& state : states_)
    numbers.insert(numbers.end(), {state.anchor.x(), state.anchor.y(), state.anchor.z(), state.normal_force});
  Vec3 force = force_, torque = torque_;
  double depth = depth_, energy = energy_, work = work_, friction_loss = friction_loss_;
  ContactCounts counts{num_touching(), num_slipping()};
  archive(numbers, force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z(), depth, energy, work,
          friction_loss, counts.touching, counts.slipping);
  if (!archive.reads()) return;
  if (numbers.size() != 4 * states_.size())
    throw InputError(fmt::format("contact is saved of {} samples, there are {}", numbers.size() / 4, states_.size()));
  const bool is_finite = std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }) &&
                         force.allFinite() && torque.allFinite() && std::isfinite(depth) && std::isfinite(energy) &&
                         std::isfinite(work) && std::isfinite(friction_loss);
  if (!is_finite) throw InputError("contact is saved with numbers that are not finite");
  counts.require_of(states_.size());
  for (std::size_t i = 0; i < states_.size(); ++i)
    states_[i] = {{numbers[4 * i], numbers[4 * i + 1], numbers[4 * i + 2]}, std::max(numbers[4 * i + 3], 0.0)};
  terms_.terms.clear();
  loaded_ = counts;
  force_ = force;
  torque_ = torque;
  depth_ = depth;
  energy_ = energy;
  work_ = work;
  friction_loss_ = friction_loss;
}

}  // namespace hexaplast
