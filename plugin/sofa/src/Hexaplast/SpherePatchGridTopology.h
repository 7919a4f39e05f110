// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ShapeTopology.h>

#include "attributes/shapes.hpp"
#include "parts/grids.hpp"

namespace hexaplast::sofa_plugin
{

/// Data: plugin/attributes/shapes.hpp.
class HEXAPLAST_SOFA_API SpherePatchGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SpherePatchGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells", "Shape")};
    Data<SReal> d_innerRadius{fromTable(d_innerRadius, "innerRadius", "Shape")};
    Data<SReal> d_outerRadius{fromTable(d_outerRadius, "outerRadius", "Shape")};
    Data<SReal> d_angle{fromTable(d_angle, "angle", "Shape")};

protected:
    SpherePatchGridTopology() : ShapeTopology(attributes::kSpherePatchGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::SpherePatchGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
