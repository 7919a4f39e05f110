// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/components.hpp"
#include "scene/plugin.hpp"

HEXAPLAST_PLUGIN(factory) {
  using namespace hexaplast::components;
  for (const auto add :
       {add_settings, add_solvers, add_loaders, add_topologies, add_states, add_masses, add_engines, add_constraints,
        add_attachments, add_loads, add_springs, add_part_forces, add_bodies, add_mappings, add_visuals, add_probes})
    add(factory);
}
