// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/MechanicalState.h>
#include <sofa/core/topology/BaseMeshTopology.h>
#include <sofa/defaulttype/VecTypes.h>

#include <algorithm>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast::sofa_plugin
{

using sofa::defaulttype::Vec3Types;
using MechanicalState = sofa::core::behavior::MechanicalState<Vec3Types>;
using MeshTopology = sofa::core::topology::BaseMeshTopology;

/// Nodal fields of SOFA as ours, and back: the same memory.
inline Eigen::Map<const PointArray> view(const Vec3Types::VecCoord& field)
{
    static_assert(sizeof(Vec3Types::Coord) == 3 * sizeof(double), "SOFA must be built with double precision");
    return {field.empty() ? nullptr : field[0].ptr(), static_cast<Eigen::Index>(field.size()), 3};
}
inline Eigen::Map<PointArray> view(Vec3Types::VecCoord& field)
{
    return {field.empty() ? nullptr : field[0].ptr(), static_cast<Eigen::Index>(field.size()), 3};
}

inline Vec3 vec3(const sofa::type::Vec3& v) { return {v[0], v[1], v[2]}; }
inline sofa::type::Vec3 vec3(const Vec3& v) { return {v[0], v[1], v[2]}; }

inline std::vector<int> wholeNumbers(const sofa::type::vector<sofa::Index>& from) { return {from.begin(), from.end()}; }
inline std::vector<Triangle> triangles(const MeshTopology::SeqTriangles& from)
{
    std::vector<Triangle> to;
    for (const auto& triangle : from)
        to.push_back({static_cast<int>(triangle[0]), static_cast<int>(triangle[1]), static_cast<int>(triangle[2])});
    return to;
}
inline std::vector<Hexahedron> hexahedraOf(MeshTopology& topology)
{
    std::vector<Hexahedron> to;
    for (const auto& hexahedron : topology.getHexahedra())
    {
        Hexahedron& corners = to.emplace_back();
        for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(hexahedron[a]);
    }
    return to;
}
inline MeshTopology::Hexahedron hexahedronOf(const Hexahedron& corners)
{
    MeshTopology::Hexahedron to;
    for (std::size_t a = 0; a < corners.size(); ++a) to[a] = static_cast<sofa::Index>(corners[a]);
    return to;
}
inline std::vector<double> reals(const sofa::type::vector<SReal>& from) { return {from.begin(), from.end()}; }

/// Whether a state follows another one: a mechanical mapping leads to it. One that is for the eye alone, from it to a
/// visual model, may stand beside it.
inline bool followsAnother(const sofa::core::behavior::BaseMechanicalState& state)
{
    std::vector<sofa::core::BaseMapping*> mappings;
    state.getContext()->get<sofa::core::BaseMapping>(&mappings, sofa::core::objectmodel::BaseContext::Local);
    return std::any_of(mappings.begin(), mappings.end(),
                       [&](sofa::core::BaseMapping* mapping)
                       {
                           const auto& to = mapping->getMechTo();
                           return mapping->isMechanical() && std::find(to.begin(), to.end(), &state) != to.end();
                       });
}

}  // namespace hexaplast::sofa_plugin
