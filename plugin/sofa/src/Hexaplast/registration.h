// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <sofa/core/ObjectFactory.h>

#include <string>
#include <vector>

#include "attributes/attribute.hpp"

namespace hexaplast::sofa_plugin
{

/// The tables of the components that are registered.
inline std::vector<const attributes::Description*>& registered()
{
    static std::vector<const attributes::Description*> all;
    return all;
}

/// Adds a class under the name and with the help of the attribute table.
template <class T>
void registerComponent(sofa::core::ObjectFactory* factory, const attributes::Description& description)
{
    registered().push_back(&description);
    factory->registerObjects(sofa::core::ObjectRegistrationData(std::string(description.help)).add<T>());
}

void registerHexahedronElastoplasticFEMForceField(sofa::core::ObjectFactory* factory);
void registerMaterialRegion(sofa::core::ObjectFactory* factory);
void registerForces(sofa::core::ObjectFactory* factory);
void registerShapeTopologies(sofa::core::ObjectFactory* factory);
void registerMultigridCGLinearSolver(sofa::core::ObjectFactory* factory);
void registerFinalStateExporter(sofa::core::ObjectFactory* factory);
void registerBladeController(sofa::core::ObjectFactory* factory);
void registerProbe(sofa::core::ObjectFactory* factory);
void registerRunSettings(sofa::core::ObjectFactory* factory);
void registerAttributeChange(sofa::core::ObjectFactory* factory);

}  // namespace hexaplast::sofa_plugin
