// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <sofa/core/ObjectFactory.h>

#include <string>

#include "attributes/attribute.hpp"

namespace hexaplast::sofa_plugin
{

/// Adds a class under the name and with the help of the attribute table.
template <class T>
void register_component(sofa::core::ObjectFactory* factory, const attributes::Description& description)
{
    factory->registerObjects(sofa::core::ObjectRegistrationData(std::string(description.help)).add<T>());
}

void register_bodies(sofa::core::ObjectFactory* factory);
void register_loads(sofa::core::ObjectFactory* factory);
void register_topologies(sofa::core::ObjectFactory* factory);
void register_exporter(sofa::core::ObjectFactory* factory);
void register_solver(sofa::core::ObjectFactory* factory);
void register_settings(sofa::core::ObjectFactory* factory);

}  // namespace hexaplast::sofa_plugin
