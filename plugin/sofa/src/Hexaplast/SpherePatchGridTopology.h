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

protected:
    SpherePatchGridTopology() : ShapeTopology(attributes::kSpherePatchGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::SpherePatchGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
