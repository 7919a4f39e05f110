// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/table.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::sofa_plugin
{

/// A topology of SOFA whose nodes and hexahedra are those of a grid that is bent into shape.
class HEXAPLAST_SOFA_API ShapeTopology : public sofa::component::topology::container::constant::MeshTopology
{
public:
    using Inherit = sofa::component::topology::container::constant::MeshTopology;
    SOFA_ABSTRACT_CLASS(ShapeTopology, Inherit);

    void init() override;

protected:
    virtual HexMesh makeGrid() const = 0;
};

class HEXAPLAST_SOFA_API TubeGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(TubeGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells;            ///< outward, around and along
    Data<SReal> d_innerRadius;                                ///< [m]
    Data<SReal> d_outerRadius;                                ///< [m]
    Data<SReal> d_length;                                     ///< [m]
    Data<SReal> d_bend;                                       ///< [deg]
    Data<sofa::type::vector<sofa::type::Vec3>> d_centreline;  ///< [m] points of the curve that it follows

protected:
    TubeGridTopology();
    HexMesh makeGrid() const override;
};

class HEXAPLAST_SOFA_API SheetGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SheetGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells;  ///< along x, along y and across
    Data<sofa::type::vector<SReal>> d_size;         ///< [m] along x and y
    Data<SReal> d_thickness;                        ///< [m] along z
    Data<SReal> d_curvature;                        ///< [1/m] about an axis along y

protected:
    SheetGridTopology();
    HexMesh makeGrid() const override;
};

class HEXAPLAST_SOFA_API SpherePatchGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SpherePatchGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells;  ///< along x, along y and outward
    Data<SReal> d_innerRadius;                      ///< [m]
    Data<SReal> d_outerRadius;                      ///< [m]
    Data<SReal> d_angle;                            ///< [deg] from side to side

protected:
    SpherePatchGridTopology();
    HexMesh makeGrid() const override;
};

}  // namespace hexaplast::sofa_plugin
