// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <sofa/core/ObjectFactory.h>

#include <vector>

#include "attributes/attribute.hpp"

namespace hexaplast::sofa_plugin
{

/// A class, and the table that has its name and help.
struct Registered
{
    const attributes::Description* description;
    void (*add)(sofa::core::ObjectRegistrationData&);
};

/// All of the plugin. A static of a function: the files that fill it are initialised in any order.
inline std::vector<Registered>& registered()
{
    static std::vector<Registered> all;
    return all;
}

/// For a constant of the file that has the class: const bool kProbeIsRegistered = registerComponent<Probe>(kProbe).
template <class T>
bool registerComponent(const attributes::Description& description)
{
    registered().push_back({&description, [](sofa::core::ObjectRegistrationData& data) { data.add<T>(); }});
    return true;
}

}  // namespace hexaplast::sofa_plugin
