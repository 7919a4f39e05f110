// SPDX-License-Identifier: LGPL-2.1-or-later
// What first_kernels is compared with: the formulas of the library, an element at a time, in double precision.
#define HEXAPLAST_ONE_NUMBER
#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "elastic/element_kernels-inl.hpp"
#include "element/isolated-inl.hpp"
#include "material/law-inl.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast::gpu {

using namespace one_number;
using D = double;

namespace {

constexpr StiffnessKind kKind{.sampling = {.assumes_strain = true, .corner_weight = 0.57735026918962576451}};

void load(const double (&from)[8][3], CornerLanes<D>& to) {
  for (int k = 0; k < 24; ++k) to.at[k / 3][k % 3] = D(from[k / 3][k % 3]);
}
void store(const CornerLanes<D>& from, double (&to)[8][3]) {
  for (int k = 0; k < 24; ++k) to[k / 3][k % 3] = from.at[k / 3][k % 3];
}

}  // namespace

Answers answers(const Hexahedron& hexahedron, const FlowNumbers& rule) {
  Answers out;
  CornerLanes<D> X, x, f;
  load(hexahedron.X, X);
  load(hexahedron.x, x);
  PlasticLanes<D> plastic;
  for (int k = 0; k < 72; ++k) plastic.inverse[k / 9].m[k % 9 / 3][k % 3] = D(hexahedron.G[k / 9][k % 9]);
  plastic.mean = mean_plastic_inverse(plastic.inverse);
  ElementLanes<false, D> element;
  place_element(X, x, kKind.sampling, &plastic, element);
  decompose(element);
  const Settings settings;
  const MaterialLanes<D> of(settings, D(hexahedron.mu), D(hexahedron.lambda));
  ModeLanes<D> of_volume;
  const PressureLanes<D> p = pressures(of, element, x, of_volume);

  // linearize_lanes and finish_force (elastic/linearize_pass.cpp)
  CoefficientWriter<1, false, D, double> writer(element, kKind, D(1.0), out.coef);
  ColumnsTranspose<false, D> acting;
  Sym<D> corotated[8], whole[8], relieved[8], M[8];
  Mat<D> normals[8];
  for (int i = 0; i < 8; ++i) {
    const Sym<D>& S = element.polar[i].S;
    corotated[i] = stress(of.law, of.mooney_fraction, S, of.mu, p.at(dilatation(of.law, S)));
    acting.add_columns(i, product_transposed(inverse_at(element, i), element.polar[i].R * matrix(corotated[i])));
    writer.add_sample(i, of, p);
  }
  writer.finish(of_volume);
  const D volume = element.rest.volume;
  out.weight[0] = of.mu * volume / 8;
  out.weight[1] = of.lambda * volume / 8;
  acting.take_assumed(element.rest, AssumedLanes<D>(element.j, element.rest.corner_weight));
  D moment[3] = {D(0.0), D(0.0), D(0.0)};
  add_moment(1, element.columns.a, acting.a, moment);
  add_moment(-1, element.columns.Q, acting.Q, moment);
  const Mat<D> turns = turning(element.mean, element.j, moment);
  acting.finish(element.rest, &turns, D(-0.125) * volume, f);
  CornerLanes<D> gradient;
  modes_transpose(of_volume, gradient);
  for (int k = 0; k < 24; ++k) f.at[k / 3][k % 3] -= of.of_volume() * p.excess * gradient.at[k / 3][k % 3];
  store(f, out.force);

  // flow_isolated_samples (plastic/flow_pass.cpp)
  const D pressure = p.in_stress - p.shared;
  std::uint32_t fails = 0;
  double norm[8], fraction[8];
  for (int i = 0; i < 8; ++i) {
    normals[i] = face_normals(plastic.inverse[i], dual_of(element.rest));
    relieved[i] = whole[i] = cauchy_stress(element.polar[i].S, corotated[i], pressure, D(1.0) + p.excess);
  }
  relieve(normals, relieved);
  out.fraction = 0;
  for (int i = 0; i < 8; ++i) {
    const D size = stress_norm_bound(relieved[i], YieldNorm::kVonMises);
    const D gamma = isolated_flow_fraction(size, D(hexahedron.tau[i]), D(rule.rate_dt));
    norm[i] = size, fraction[i] = gamma;
    out.fraction = std::max(out.fraction, fraction[i]);
    M[i] =
        flow_direction(symmetric_part(deviatoric_log(element.polar[i].S, fails)), relieved[i], whole[i], of.mu, gamma);
  }
  relieve(normals, M);
  for (int i = 0; i < 8; ++i) {
    const Mat<D> G = flowed_plastic_inverse(plastic.inverse[i], M[i]);
    for (int k = 0; k < 9; ++k) out.G[i][k] = G.m[k / 3][k % 3];
    out.tau[i] = std::max(0.0, hexahedron.tau[i] + rule.hardening * fraction[i] * norm[i]);
    const D mean = D(1.0 / 3) * trace(M[i]);
    out.strain[i] = std::sqrt(
        2.0 / 3 * squared_norm(Sym<D>{M[i].xx - mean, M[i].yy - mean, M[i].zz - mean, M[i].yz, M[i].zx, M[i].xy}));
  }
  if (fails) std::abort();
  return out;
}

void Answers::multiply(double (&u)[8][3]) const {
  CornerLanes<D> at;
  load(u, at);
  const StoredNumbers<2, 1, const double> weights{weight};
  apply_stiffness<false>(StoredElement<false, const double, 1>(coef), kKind, weights, D(1.0), at);
  store(at, u);
}

}  // namespace hexaplast::gpu
