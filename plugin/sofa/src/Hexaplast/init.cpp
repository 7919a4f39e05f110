// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/config.h>
#include <Hexaplast/registration.h>
#include <sofa/helper/system/PluginManager.h>

#include <cstdlib>
#include <string>
#include <utility>

#include "hexaplast/base/parallel.hpp"

// What SOFA looks for in a plugin.
extern "C"
{
    // OMP_NUM_THREADS says how many threads the kernels have, unless RunSettings does; one where neither is set.
    // Results do not depend on it.
    SOFA_EXPORT_DYNAMIC_LIBRARY void initExternalModule()
    {
        static bool isFirst = true;
        if (!std::exchange(isFirst, false)) return;
        // a program that links the plugin has not loaded it by its name
        auto& plugins = sofa::helper::system::PluginManager::getInstance();
        if (!plugins.pluginIsLoaded(hexaplast::sofa_plugin::MODULE_NAME))
            plugins.registerPlugin(hexaplast::sofa_plugin::MODULE_NAME);
        const char* asked = std::getenv("OMP_NUM_THREADS");
        const int count = asked ? std::atoi(asked) : 0;
        if (count > 0) hexaplast::set_num_threads(count);
    }
    SOFA_EXPORT_DYNAMIC_LIBRARY const char* getModuleName() { return hexaplast::sofa_plugin::MODULE_NAME; }
    SOFA_EXPORT_DYNAMIC_LIBRARY const char* getModuleVersion() { return hexaplast::sofa_plugin::MODULE_VERSION; }
    SOFA_EXPORT_DYNAMIC_LIBRARY const char* getModuleLicense() { return "LGPL"; }
    SOFA_EXPORT_DYNAMIC_LIBRARY const char* getModuleDescription()
    {
        return "Real-time hexahedral corotational elastoplastic FEM for surgery simulation";
    }
    SOFA_EXPORT_DYNAMIC_LIBRARY void registerObjects(sofa::core::ObjectFactory* factory)
    {
        for (const auto& [description, add] : hexaplast::sofa_plugin::registered())
        {
            sofa::core::ObjectRegistrationData data{std::string(description->help)};
            add(data);
            factory->registerObjects(data);
        }
    }
}
