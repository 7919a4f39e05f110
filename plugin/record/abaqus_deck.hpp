// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>

#include "picture/bodies.hpp"

namespace hexaplast::output {

/// What a static analysis of bodies needs besides them.
struct AbaqusDeck {
  std::string title;
  double time = 0;     ///< [s] to which the loads belong; told in a comment
  PointArray is_free;  ///< num_nodes x 3: 0 where a degree of freedom is held
  PointArray loads;    ///< num_nodes x 3 [N], dead
};

/// Writes the undeformed bodies as an Abaqus input deck, which CalculiX's ccx runs as it is: nodes, C3D8 elements (in
/// our order), of several bodies an element set BODY_name of each, one *ELASTIC per pair of Young's modulus and
/// Poisson's ratio, the node set FIXED and its *BOUNDARY, the loads as *CLOAD, one *STATIC step with NLGEOM that prints
/// all displacements. Node and element numbers are ours plus one. Throws OutputError.
void write_abaqus_deck(const std::filesystem::path& file, const Bodies& bodies, const AbaqusDeck& deck);

}  // namespace hexaplast::output
