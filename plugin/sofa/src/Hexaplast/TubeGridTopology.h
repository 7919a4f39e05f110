// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ShapeTopology.h>

#include "attributes/shapes.hpp"
#include "parts/grids.hpp"

namespace hexaplast::sofa_plugin
{

/// Data: plugin/attributes/shapes.hpp.
class HEXAPLAST_SOFA_API TubeGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(TubeGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells", "Shape")};
    Data<SReal> d_innerRadius{fromTable(d_innerRadius, "innerRadius", "Shape")};
    Data<SReal> d_outerRadius{fromTable(d_outerRadius, "outerRadius", "Shape")};
    Data<SReal> d_length{fromTable(d_length, "length", "Shape")};
    Data<SReal> d_bend{fromTable(d_bend, "bend", "Shape")};
    Data<sofa::type::vector<sofa::type::Vec3>> d_centreline{fromTable(d_centreline, "centreline", "Shape")};

protected:
    TubeGridTopology() : ShapeTopology(attributes::kTubeGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::TubeGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
