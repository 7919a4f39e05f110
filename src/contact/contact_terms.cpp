// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/contact_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

constexpr double kWrongFriction = 0.01;     // of mu N, from which the friction of a contact is corrected
constexpr double kAllWrongFriction = 0.05;  // of all mu N, from which the step is solved again for it

void add(const ContactTerm& term, const Vec3& force, OfTwo<Points>& f) {
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

void ContactTerm::set_friction(double tangential_stiffness, double coefficient, double N, const Vec3& expected) {
  stick = tangential = tangential_stiffness;
  friction = coefficient;
  is_new = N == 0;
  limit = friction * (is_new ? std::max(-stiffness * gap(expected), 0.0) : N);
  const double size = displacement(expected).norm();
  slips = stick * size > limit || limit == 0;  // where u is 0 too, rounding must not decide
  if (slips) tangential = limit > 0 ? limit / size : 0;
}

// With the expected displacement in place of u, what begins to slip would feel mu N |u| / |u_p|: far too much where it
// accelerates.
double ContactTerm::correct_friction(const Vec3& r, const Vec3& change) {
  if (limit == 0) return 0;
  const double limit_before = limit;
  const Vec3 before = tangential_force(r);
  // the depth at which it would arrive freely is no measure of what holds it up
  if (is_new) limit = friction * normal_force(r, change);
  const Vec3 u = displacement(r);
  const double size = u.norm();
  const bool is_beyond = stick * size > limit;
  // as it is where it is right: at the limit itself, rounding must not decide
  const bool is_right = slip.isZero(0)
                            ? std::abs(tangential * size - std::min(stick * size, limit)) <= kWrongFriction * limit
                            : is_beyond && slip.dot(u) > 0;
  if (is_right) return std::abs(limit - limit_before);
  slips = is_beyond && slip.dot(u) >= 0;  // what would turn back sticks
  tangential = slips ? limit / size : stick;
  slip = slips ? Vec3(u / size) : Vec3::Zero();
  return (tangential_force(r) - before).norm();
}

int ContactTerms::num_slipping() const { return static_cast<int>(std::ranges::count_if(terms, &ContactTerm::slips)); }

void ContactTerms::add_force(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) const {
  for (const ContactTerm& term : terms) add(term, term.force(term.at(x), term.at(v)), f);
}

void ContactTerms::add_stiffness_product(double factor, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const {
  for (const ContactTerm& term : terms) add(term, -factor * term.stiffness_times(term.at(dx)), df);
}

void ContactTerms::add_damping_product(double factor, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const {
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

bool ContactTerms::release(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v) {
  const std::size_t before = terms.size();
  std::erase_if(terms, [&](const ContactTerm& term) { return term.normal_force(term.at(x), term.at(v)) < 0; });
  const bool has_released = terms.size() < before;
  double wrong = 0, all = 0;
  corrected_ = terms;
  for (ContactTerm& term : corrected_) {
    if (term.friction == 0) continue;
    wrong += term.correct_friction(term.at(x), term.at(v));
    all += term.limit;
  }
  if (!has_released && wrong <= kAllWrongFriction * all) return false;
  std::swap(terms, corrected_);
  return true;
}

}  // namespace hexaplast
