// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

/// The viscoelastic bodies that CalculiX has let relax and creep (tests/data/calculix/relaxation.json): small strain, E
/// = 5000 Pa, nu_P = .3, branches of g 1 and .5 that relax with 0.5 and 5 s. Stress, strain or deflection, over that of
/// slow deformation, at each time [s] after a load or a displacement that comes at the time 0.
namespace hexaplast::support {

/// name: "held bar", "held shear", "loaded bar", "loaded beam", or "loaded thin beam", which is one cell thick.
std::vector<double> relax(const std::string& name, const std::vector<double>& times);

/// The same of the exact solution; of Timoshenko's beam.
std::vector<double> relax_in_theory(const std::string& name, const std::vector<double>& times);

}  // namespace hexaplast::support
