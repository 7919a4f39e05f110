// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <initializer_list>
#include <string>

namespace hexaplast::sofa_plugin::test
{

inline const std::string kGrid = R"xml(<RegularGridTopology name="grid" n="3 3 4" min="0 0 0" max="0.2 0.2 0.3"/>)xml";
inline const std::string kPlastic = R"(yieldStress="100" plasticFlowRate="5" hardening="0.3")";

inline std::string required(std::initializer_list<const char*> modules)
{
    std::string all;
    for (const char* module : modules)
        all += std::string("<RequiredPlugin pluginName='Sofa.Component.") + module + "'/>";
    return all + "<RequiredPlugin pluginName='Hexaplast'/>";
}

/// 2 x 2 x 3 cubes of 0.1 m in a node of their own, with the attributes of their material and what stands behind it.
inline std::string block(const std::string& attributes, const std::string& topology = kGrid,
                         const std::string& before = "", const std::string& behind = "")
{
    return "<Node name='root' dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/>" +
           required({"StateContainer", "Topology.Container.Grid", "Topology.Container.Dynamic", "AnimationLoop"}) +
           before + "<Node name='tissue'>" + topology +
           "<MechanicalObject name='nodes' template='Vec3d'/><HexahedronElastoplasticFEMForceField name='body' "
           "template='Vec3d' youngModulus='5000' poissonRatio='0.3' " +
           attributes + "/>" + behind + "</Node></Node>";
}

}  // namespace hexaplast::sofa_plugin::test
