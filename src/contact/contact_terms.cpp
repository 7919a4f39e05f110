// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/contact_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

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

void ContactTerm::set_friction(double tangential_stiffness, double friction, double N, const Vec3& expected) {
  const double limit = friction * N, size = displacement(expected).norm();
  slips = tangential_stiffness * size > limit;
  tangential = slips ? limit / size : tangential_stiffness;
}

int ContactTerms::num_slipping() const { return static_cast<int>(std::ranges::count_if(terms, &ContactTerm::slips)); }

void ContactTerms::add_force(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) const {
  for (const ContactTerm& term : terms) add(term, term.force(term.at(x), term.at(v)), f);
}

void ContactTerms::add_stiffness_product(double factor, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const {
  for (const ContactTerm& term : terms) {
    const Vec3 dr = term.at(dx);
    const double along = term.normal.dot(dr);
    add(term, -factor * (term.stiffness * along * term.normal + term.tangential * (dr - along * term.normal)), df);
  }
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
  add_blocks(A, first_nodes, [&](const ContactTerm& term) -> Mat3 {
    const Mat3 along = term.normal * term.normal.transpose();
    return -factor * (term.stiffness * along + term.tangential * (Mat3::Identity() - along));
  });
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
  return terms.size() < before;
}

}  // namespace hexaplast
