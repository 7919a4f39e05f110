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

protected:
    TubeGridTopology() : ShapeTopology(attributes::kTubeGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::TubeGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
