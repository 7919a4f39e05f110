// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/table.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::sofa_plugin
{

/// A topology of SOFA whose nodes and hexahedra are those of a grid that is bent into shape. Data:
/// plugin/attributes/shapes.hpp.
class HEXAPLAST_SOFA_API ShapeTopology
    : public TableComponent<sofa::component::topology::container::constant::MeshTopology>
{
public:
    using Inherit = sofa::component::topology::container::constant::MeshTopology;
    SOFA_ABSTRACT_CLASS(ShapeTopology, SOFA_TEMPLATE(TableComponent, Inherit));

    void init() override;

protected:
    explicit ShapeTopology(const Description& description) : TableComponent(description, "Shape") {}

    virtual HexMesh makeGrid() const = 0;
};

}  // namespace hexaplast::sofa_plugin
