// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/components.hpp"
#include "scene/plugin.hpp"

HEXAPLAST_PLUGIN(factory) {
  using namespace hexaplast::components;
  add_settings(factory);
  add_animation_loop(factory);
  add_solvers(factory);
  add_linear_solvers(factory);
  add_loaders(factory);
  add_topologies(factory);
  add_sparse_grids(factory);
  add_shapes(factory);
  add_states(factory);
  add_masses(factory);
  add_engines(factory);
  add_constraints(factory);
  add_attachments(factory);
  add_loads(factory);
  add_springs(factory);
  add_part_forces(factory);
  add_bodies(factory);
  add_regions(factory);
  add_blades(factory);
  add_mappings(factory);
  add_visuals(factory);
  add_probes(factory);
}
