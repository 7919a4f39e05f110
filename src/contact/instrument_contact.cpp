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

constexpr double kFarthestPerLook = 0.5;  // of the smallest radius that a sample may move against the instrument
constexpr int kMostLooks = 64;            // within a step
constexpr double kWrongFriction = 0.01;   // of mu N, from which the step is solved again

void check(const ContactSettings& settings) {
  const auto require = [](bool is_allowed, double value, const char* what, const char* range) {
    if (!is_allowed || !std::isfinite(value))
      throw InputError(fmt::format("InstrumentContact: {} = {} must be {}", what, value, range));
  };
  require(settings.stiffness > 0, settings.stiffness, "stiffness", "positive");
  require(settings.tangential_stiffness >= 0, settings.tangential_stiffness, "tangential stiffness", "at least 0");
  require(settings.friction >= 0, settings.friction, "friction", "at least 0");
  require(settings.distance >= 0, settings.distance, "distance", "at least 0");
  require(settings.damping >= 0, settings.damping, "damping", "at least 0");
}

}  // namespace

InstrumentContact::InstrumentContact(Solid solid, ContactSettings settings, SurfaceSamples samples)
    : solid_(std::move(solid)), samples_(std::move(samples)), states_(samples_.samples.size()) {
  set_settings(settings);
}

void InstrumentContact::set_settings(ContactSettings settings) {
  check(settings);
  settings_ = settings;
}

void InstrumentContact::set_samples(SurfaceSamples samples) {
  using Key = std::array<std::pair<int, double>, kCorners>;
  // the same point may be written down by another of the faces that have it
  const auto key_of = [](const SurfaceSamples::Sample& sample) {
    Key shares;
    shares.fill({-1, 0});
    for (int a = 0; a < sample.num_nodes; ++a) shares[a] = {sample.nodes[a], sample.weights[a]};
    std::ranges::sort(shares);
    return shares;
  };
  std::map<Key, SampleState> before;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i].normal_force > 0) before.emplace(key_of(samples_.samples[i]), states_[i]);
  samples_ = std::move(samples);
  states_.assign(samples_.samples.size(), {});
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (const auto at = before.find(key_of(samples_.samples[i])); at != before.end()) states_[i] = at->second;
  contacts_.clear();
}

void InstrumentContact::begin_step(ConstPoints x, ConstPoints v, double h, const Pose& begin, const Pose& end) {
  pose_before_ = begin;
  pose_ = end;
  contacts_.clear();
  const auto num_samples = static_cast<int>(samples_.samples.size());
  found_.assign(samples_.samples.size(), {});
  const double distance = settings_.distance, near = solid_.reach() + distance;

  parallel_for(num_samples, [&](int i) {
    const SurfaceSamples::Sample& sample = samples_.samples[i];
    const Vec3 p = sample.at(x), expected = p + h * sample.at(v);
    // against the instrument, in its own frame
    const Vec3 from = begin.to_own(p), to = end.to_own(expected);
    const double way = (to - from).norm();
    if (std::min(from.norm(), to.norm()) > near + way) return;

    // the first look that finds it within: it cannot be past the middle of the instrument yet
    const int looks = static_cast<int>(
        std::clamp(std::ceil(way / (kFarthestPerLook * solid_.smallest_radius())), 1.0, double{kMostLooks}));
    double before = solid_.distance(from).value;
    const bool touched = before < distance;  // it stays a contact until it would pull
    for (int k = 1; k <= looks; ++k) {
      const Vec3 at = from + static_cast<double>(k) / looks * (to - from);
      const SignedDistance now = solid_.distance(at);
      if (now.value >= distance && !touched) {
        before = now.value;
        continue;
      }
      const double since = !touched ? (distance - now.value) / (before - now.value) / looks : 0;
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
    const Vec3 expected = sample.at(x) + h * sample.at(v);
    Contact contact{.sample = i,
                    .place = end.to_world(found.place),
                    .velocity = (end.to_world(found.place) - begin.to_world(found.place)) / h,
                    .normal = end.orientation * found.normal,
                    .stiffness = settings_.stiffness * sample.area,
                    .damping = settings_.damping * sample.area};
    contact.is_new = state.normal_force == 0;
    if (contact.is_new) state.anchor = found.first;
    contact.anchor = end.to_world(state.anchor);
    if (settings_.friction > 0) {
      const double N =
          state.normal_force > 0 ? state.normal_force : std::max(-contact.stiffness * gap(contact, expected), 0.0);
      const double limit = contact.limit = settings_.friction * N, size = displacement(contact, expected).norm();
      contact.tangential = settings_.tangential_stiffness * sample.area;
      if (contact.tangential * size > limit) {
        contact.tangential = limit / size;
        contact.slips = true;
      }
    }
    contacts_.push_back(contact);
  }
}

double InstrumentContact::normal_force(const Contact& contact, const Vec3& p, const Vec3& velocity) const {
  return -contact.stiffness * gap(contact, p) - contact.damping * contact.normal.dot(velocity - contact.velocity);
}

Vec3 InstrumentContact::tangential_force(const Contact& contact, const Vec3& p) const {
  const Vec3 u = displacement(contact, p);
  return -contact.tangential * (u - contact.slip.dot(u) * contact.slip) - contact.limit * contact.slip;
}

Mat3 InstrumentContact::stiffness_of(const Contact& contact) const {
  const Mat3 along = contact.normal * contact.normal.transpose(), slip = contact.slip * contact.slip.transpose();
  return -contact.stiffness * along - contact.tangential * (Mat3::Identity() - along - slip);
}

void InstrumentContact::add_force(ConstPoints x, ConstPoints v, Points f) const {
  for (const Contact& contact : contacts_) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    const Vec3 p = sample.at(x);
    sample.add(normal_force(contact, p, sample.at(v)) * contact.normal + tangential_force(contact, p), f);
  }
}

void InstrumentContact::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  for (const Contact& contact : contacts_) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    const Vec3 dp = sample.at(dx);
    const double along = contact.normal.dot(dp);
    const Vec3 across = dp - along * contact.normal - contact.slip.dot(dp) * contact.slip;
    sample.add(-factor * (contact.stiffness * along * contact.normal + contact.tangential * across), df);
  }
}

void InstrumentContact::add_stiffness_blocks(double factor, BlockMatrix& A) const {
  for (const Contact& contact : contacts_) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    const Mat3 K = factor * stiffness_of(contact);
    for (int a = 0; a < sample.num_nodes; ++a)
      for (int b = 0; b < sample.num_nodes; ++b)
        A.add(sample.nodes[a], sample.nodes[b], sample.weights[a] * sample.weights[b] * K);
  }
}

void InstrumentContact::add_damping_product(double factor, ConstPoints dx, Points df) const {
  if (settings_.damping == 0) return;
  for (const Contact& contact : contacts_) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    sample.add(-factor * contact.damping * contact.normal.dot(sample.at(dx)) * contact.normal, df);
  }
}

void InstrumentContact::add_damping_blocks(double factor, BlockMatrix& A) const {
  if (settings_.damping == 0) return;
  for (const Contact& contact : contacts_) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    const Mat3 B = -factor * contact.damping * contact.normal * contact.normal.transpose();
    for (int a = 0; a < sample.num_nodes; ++a)
      for (int b = 0; b < sample.num_nodes; ++b)
        A.add(sample.nodes[a], sample.nodes[b], sample.weights[a] * sample.weights[b] * B);
  }
}

// With u_p in place of u, what begins to slip would feel mu N |u| / |u_p|: far too much where it accelerates.
bool InstrumentContact::correct_friction(Contact& contact, const Vec3& p, const Vec3& velocity) const {
  if (contact.limit == 0) return false;
  const double before = contact.limit;
  // the depth at which it would arrive freely is no measure of what holds it up
  if (contact.is_new) contact.limit = settings_.friction * normal_force(contact, p, velocity);
  const Vec3 u = displacement(contact, p);
  const double stiffness = settings_.tangential_stiffness * samples_.samples[contact.sample].area, size = u.norm();
  const bool slips = stiffness * size > contact.limit;
  if (contact.slip.isZero(0)) {
    const double wanted = std::min(stiffness * size, contact.limit);
    if (std::abs(contact.tangential * size - wanted) <= kWrongFriction * contact.limit) return false;
  } else if (slips && contact.slip.dot(u) > 0) {
    return std::abs(contact.limit - before) > kWrongFriction * before;
  }
  const bool goes_on = slips && contact.slip.dot(u) >= 0;  // what would turn back sticks
  contact.slips = goes_on;
  contact.tangential = goes_on ? contact.limit / size : stiffness;
  contact.slip = goes_on ? Vec3(u / size) : Vec3::Zero();
  return true;
}

bool InstrumentContact::release(ConstPoints x, ConstPoints v) {
  const std::size_t before = contacts_.size();
  std::erase_if(contacts_, [&](const Contact& contact) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    return normal_force(contact, sample.at(x), sample.at(v)) < 0;
  });
  bool is_corrected = false;
  if (settings_.friction > 0)
    for (Contact& contact : contacts_) {
      const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
      is_corrected = correct_friction(contact, sample.at(x), sample.at(v)) || is_corrected;
    }
  return is_corrected || contacts_.size() < before;
}

void InstrumentContact::end_step(ConstPoints x, ConstPoints v) {
  force_.setZero();
  torque_.setZero();
  depth_ = energy_ = 0;
  for (SampleState& state : states_) state.normal_force = 0;
  for (const Contact& contact : contacts_) {
    const SurfaceSamples::Sample& sample = samples_.samples[contact.sample];
    const Vec3 p = sample.at(x), u = displacement(contact, p);
    const double N = normal_force(contact, p, sample.at(v)), g = gap(contact, p);
    const Vec3 f = N * contact.normal + tangential_force(contact, p);
    force_ -= f;
    torque_ -= (p - pose_.position).cross(f);
    depth_ = std::max(depth_, -(g + settings_.distance));
    work_ += f.dot(p - pose_before_.to_world(pose_.to_own(p)));
    if (N <= 0) continue;

    SampleState& state = states_[contact.sample];
    state.normal_force = N;
    const double stiffness = settings_.tangential_stiffness * sample.area, limit = settings_.friction * N,
                 size = u.norm(), kept = stiffness * size > limit ? limit / (stiffness * size) : 1;
    // also what it is moved along the normal: the anchor stays on the sample's own level
    state.anchor = pose_.to_own(p - kept * u);
    friction_loss_ += tangential_force(contact, p).norm() * (1 - kept) * size;
    energy_ += contact.stiffness * g * g / 2 + stiffness * kept * kept * size * size / 2;
  }
}

void InstrumentContact::reset() {
  states_.assign(states_.size(), {});
  contacts_.clear();
  force_.setZero();
  torque_.setZero();
  depth_ = energy_ = work_ = friction_loss_ = 0;
}

int InstrumentContact::num_slipping() const {
  return static_cast<int>(std::ranges::count_if(contacts_, &Contact::slips));
}

void InstrumentContact::serialize(Archive& archive) {
  std::vector<double> numbers;
  for (const SampleState& state : states_)
    numbers.insert(numbers.end(), {state.anchor.x(), state.anchor.y(), state.anchor.z(), state.normal_force});
  Vec3 force = force_, torque = torque_;
  double depth = depth_, energy = energy_, work = work_, friction_loss = friction_loss_;
  archive(numbers, force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z(), depth, energy, work,
          friction_loss);
  if (!archive.reads()) return;
  if (numbers.size() != 4 * states_.size())
    throw InputError(fmt::format("contact is saved of {} samples, there are {}", numbers.size() / 4, states_.size()));
  const bool is_finite = std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }) &&
                         force.allFinite() && torque.allFinite() && std::isfinite(depth) && std::isfinite(energy) &&
                         std::isfinite(work) && std::isfinite(friction_loss);
  if (!is_finite) throw InputError("contact is saved with numbers that are not finite");
  for (std::size_t i = 0; i < states_.size(); ++i)
    states_[i] = {{numbers[4 * i], numbers[4 * i + 1], numbers[4 * i + 2]}, std::max(numbers[4 * i + 3], 0.0)};
  contacts_.clear();
  force_ = force;
  torque_ = torque;
  depth_ = depth;
  energy_ = energy;
  work_ = work;
  friction_loss_ = friction_loss;
}

}  // namespace hexaplast
