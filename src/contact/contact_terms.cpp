// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/contact_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

constexpr double kWrongFriction = 0.01;     // of mu N, from which the friction of a contact is corrected
constexpr double kMaxGrowth = 2;            // of normal forces in a step
constexpr double kSteady = 0.05;            // growth that is none: what is expected is no better than what was
constexpr double kAllWrongFriction = 0.1;   // of all mu N, from which the step is solved again for it
constexpr int kMaxFrictionCorrections = 4;  // of friction in a step: it may turn to and fro, what pulls goes once

void add(const ContactTerm& term, const Vec3& force, Pair<Points>& f) {
  for (int a = 0; a < term.num_first; ++a) f.first.row(term.nodes[a]) += term.weights[a] * force.transpose();
  for (int a = term.num_first; a < term.num_nodes; ++a)
    f.second.row(term.nodes[a]) += term.weights[a] * force.transpose();
}

}  // namespace

void ContactSettings::require_valid(const char* whose) const {
  const auto require = [&](bool is_allowed, double value, const char* what, const char* range) {
    if (!is_allowed || !std::isfinite(value))
      throw InputError(fmt::format("{}: {} = {} must be {}", whose, what, value, range));
  };
  require(stiffness > 0, stiffness, "stiffness", "positive");
  require(tangential_stiffness >= 0, tangential_stiffness, "tangential stiffness", "at least 0");
  require(friction >= 0, friction, "friction", "at least 0");
  require(distance >= 0, distance, "distance", "at least 0");
  require(damping >= 0, damping, "damping", "at least 0");
}

void ContactTotals::require_of(std::size_t num_samples) const {
  if (!std::isfinite(force.sum() + torque.sum() + depth + energy + work + friction_loss))
    throw InputError("contact is saved with numbers that are not finite");
  if (slipping < 0 || slipping > touching || touching > static_cast<int>(num_samples))
    throw InputError(fmt::format("contact is saved with {} of {} samples that touch, {} of which slip", touching,
                                 num_samples, slipping));
}

void ContactTerm::set_friction(double N, const Vec3& expected) {
  tangential = stick;
  limit = N > negligible ? friction * N : 0;
  const Vec3 u = displacement(expected);
  const double size = u.norm();
  slips = stick * size > limit || limit == 0;  // where u is 0 too, rounding must not decide
  if (!slips) return;
  tangential = limit > 0 ? limit / size : 0;
  if (limit > 0) slip = u / size;
}

double ContactTerm::correct_friction(const Vec3& r, const Vec3& change) {
  const Vec3 u = displacement(r), before = tangential_force(r);
  const double N = normal_force(r, change);
  limit = N > negligible ? friction * N : 0;
  const double size = u.norm();
  const bool is_beyond = stick * size > limit;
  const double wrong = (before + (is_beyond ? limit / size : stick) * u).norm();
  if (wrong <= kWrongFriction * limit) return wrong;  // at the limit itself, rounding must not decide
  slips = is_beyond && slip.dot(u) >= 0;              // what would turn back sticks
  tangential = slips ? limit / size : stick;
  slip = slips ? Vec3(u / size) : Vec3::Zero();
  return wrong;
}

int ContactTerms::num_slipping() const { return static_cast<int>(std::ranges::count_if(terms, &ContactTerm::slips)); }

void ContactTerms::add_force(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) const {
  for (const ContactTerm& term : terms) add(term, term.force(term.at(x), term.at(v)), f);
}

void ContactTerms::add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const {
  for (const ContactTerm& term : terms) add(term, -factor * term.stiffness_times(term.at(dx)), df);
}

void ContactTerms::add_damping_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const {
  for (const ContactTerm& term : terms)
    if (term.damping != 0) add(term, -factor * term.damping * term.normal.dot(term.at(dx)) * term.normal, df);
}

template <class Block>
void ContactTerms::add_blocks(BlockMatrix& A, std::array<int, 2> first_nodes, const Block& block_of) const {
  for (const ContactTerm& term : terms) {
    const Mat3 block = block_of(term);
    const auto node = [&](int a) { return term.nodes[a] + first_nodes[a < term.num_first ? 0 : 1]; };
    for (int a = 0; a < term.num_nodes; ++a)
      for (int b = 0; b < term.num_nodes; ++b) A.add(node(a), node(b), term.weights[a] * term.weights[b] * block);
  }
}

void ContactTerms::add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const {
  add_blocks(A, first_nodes, [&](const ContactTerm& term) -> Mat3 { return -factor * term.stiffness_matrix(); });
}

void ContactTerms::add_damping_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const {
  if (std::ranges::all_of(terms, [](const ContactTerm& term) { return term.damping == 0; })) return;
  add_blocks(A, first_nodes, [&](const ContactTerm& term) -> Mat3 {
    return -factor * term.damping * term.normal * term.normal.transpose();
  });
}

void ContactTerms::begin_step(const Pair<ConstPoints>& x, const Pair<ConstPoints>& expected, double h) {
  h_ = h;
  is_solved_ = false;
  num_corrections_ = 0;
  for (ContactTerm& term : terms) term.begin = term.at(x);
  set_friction(expected);
}

ContactTerms::End ContactTerms::end_of(const ContactTerm& term, const Pair<ConstPoints>& x) const {
  const Vec3 r = is_solved_ ? term.end : term.at(x);
  return {r, (r - term.begin) / h_};
}

// Each contact has about its part of the normal force that it had, and all together about the one that is expected:
// bodies that land press more from step to step.
void ContactTerms::set_friction(const Pair<ConstPoints>& expected) {
  const auto pressing = [&](const ContactTerm& term) {
    return std::max(-term.stiffness * term.gap(term.at(expected)), 0.0);
  };
  double before = 0, now = 0;
  for (const ContactTerm& term : terms) {
    if (term.normal_before == 0) continue;
    before += term.normal_before;
    now += pressing(term);
  }
  double growth = before > 0 ? std::clamp(now / before, 1 / kMaxGrowth, kMaxGrowth) : 1;
  if (std::abs(growth - 1) < kSteady) growth = 1;
  for (ContactTerm& term : terms)
    if (term.friction > 0)
      term.set_friction(term.normal_before > 0 ? growth * term.normal_before : pressing(term), term.at(expected));
}

bool ContactTerms::release(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) {
  const std::size_t before = terms.size();
  is_solved_ = true;
  for (ContactTerm& term : terms) term.end = term.at(x);
  std::erase_if(terms,
                [&](const ContactTerm& term) { return term.normal_force(term.at(x), term.at(v)) < -term.negligible; });
  if (terms.size() < before) return true;  // where some pulled, the others do not feel what they will
  if (num_corrections_ == kMaxFrictionCorrections) return false;
  double wrong = 0, all = 0;
  corrected_ = terms;
  for (ContactTerm& term : corrected_) {
    if (term.friction == 0) continue;
    wrong += term.correct_friction(term.at(x), term.at(v));
    all += term.limit;
  }
  if (wrong <= kAllWrongFriction * all) return false;
  ++num_corrections_;
  std::swap(terms, corrected_);
  return true;
}

}  // namespace hexaplast
