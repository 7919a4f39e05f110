// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_ONE_NUMBER
#include "element/samples.hpp"

#include "base/tensors-inl.hpp"
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

namespace {

scalar::CornerLanes<double> corners_of(const ElementPoints& x) {
  scalar::CornerLanes<double> corners;
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) corners.at[a][i] = x(a, i);
  return corners;
}

}  // namespace

void add_branch_stress(const Branches& branches, const Lame& lame, ElementSamples& samples) {
  if (!branches.any()) return;
  samples.branch_moduli = branches.moduli();
  const scalar::BranchLanes<double> held = scalar::branches_of(branches, lame);
  scalar::Sym<double> D[kCorners];
  held.changes([&](int i) { return scalar::symmetric_entries(samples.polar[i].S); }, D);
  for (int i = 0; i < kCorners; ++i) {
    samples.branch_stress[i] = to_eigen(matrix(held.stress(i, D[i])));
    samples.stress[i] += samples.branch_stress[i];
  }
}

ElementSamples element_samples(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame,
                               const Settings& settings, const CornerTensors* plastic_inverse,
                               const Branches& branches) {
  scalar::PlasticLanes<double> plastic;
  if (plastic_inverse) {
    for (int i = 0; i < kCorners; ++i) plastic.inverse[i] = scalar::entries((*plastic_inverse)[i]);
    plastic.mean = scalar::mean_plastic_inverse(plastic.inverse);
  }
  scalar::ElementLanes<true, double> element;
  const scalar::CornerLanes<double> u = corners_of(current);
  place_element(corners_of(plastic_rest), u, sampling_of(settings), plastic_inverse ? &plastic : nullptr, element);
  decompose(element);
  const scalar::MaterialLanes<double> of(settings, lame.mu, lame.lambda);
  scalar::ModeLanes<double> volume_gradient;
  const scalar::PressureLanes<double> pressure = pressures(of, element, u, volume_gradient);

  ElementSamples found;
  found.volume = element.rest.volume;
  found.pressure = pressure.in_stress - pressure.shared;
  found.volume_ratio = pressure.excess + 1;
  for (int i = 0; i < kCorners; ++i) {
    const scalar::PolarLanes<double>& at = element.polar[i];
    found.F[i] = to_eigen(element.F[i]);
    found.polar[i] = {to_eigen(at.R), to_eigen(matrix(at.S))};
    found.stress[i] = to_eigen(
        matrix(stress(of.law, of.mooney_fraction, at.S, of.mu, pressure.in_stress_at(dilatation(of.law, at.S)))));
  }
  add_branch_stress(branches, lame, found);
  return found;
}

}  // namespace hexaplast
