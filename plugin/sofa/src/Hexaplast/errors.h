// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/releases.h>

#include <exception>
#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "parts/option.hpp"

namespace hexaplast::sofa_plugin
{

/// "liver.scn:7: error: TubeGridTopology.length: must be > 0": an attribute, or (empty) the component, where it stands
/// in the scene file, or its path in the graph where it does not come from a file.
inline std::string errorAt(const SofaComponent& component, const std::string& attribute, const std::string& what)
{
    const std::string& file = component.getInstanciationSourceFileName();
    const std::string place =
        file.empty() ? component.getPathName() : file + ":" + std::to_string(component.getInstanciationSourceFilePos());
    return place + ": error: " + component.getClassName() + (attribute.empty() ? "" : "." + attribute) + ": " + what;
}

/// What a part says without refusing anything.
inline void passOn(const SofaComponent& component, const std::vector<parts::Remark>& warnings)
{
    for (const parts::Remark& warning : warnings)
        msg_warning(&component) << component.getClassName() << (warning.attribute.empty() ? "" : ".")
                                << warning.attribute << ": " << warning.text;
}

/// Throws OptionError where `linked`, to which `attribute` leads, has been removed from the scene: the link keeps it.
inline void requireInScene(const SofaComponent& component, const char* attribute, const SofaComponent& linked)
{
    if (linked.getContext()->getRootContext() != component.getContext()->getRootContext())
        throw parts::OptionError(attribute, "leads to '" + linked.getName() + "', which is no longer in the scene");
}

/// Whether a component may take part in a step. One that is invalid says that it does not, in each step.
inline bool mayStep(const SofaComponent& component)
{
    if (!isInvalid(component)) return true;
    msg_error(&component) << component.getPathName()
                          << " is invalid (see its error above): it does nothing in this step";
    return false;
}

/// What a component of SOFA does with errors of its part: it says what is wrong, and becomes invalid. No exception
/// leaves it. True when `call` came through.
template <class Call>
bool attempt(SofaComponent& host, const Call& call)
{
    std::vector<std::string> errors;
    try
    {
        call();
        return true;
    }
    catch (const parts::OptionError& error)
    {
        for (const auto& [attribute, reason] : error.reasons()) errors.push_back(errorAt(host, attribute, reason));
    }
    catch (const InputError& error)
    {
        errors.push_back(errorAt(host, "", error.what()));
    }
    catch (const std::exception& error)
    {
        errors.push_back(error.what());
    }
    for (const std::string& error : errors) msg_error(&host) << error;
    host.d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
    return false;
}

/// Lets `call` make or change the part of a component by its Data, beside a check. Where both come through the
/// component is valid; else what is wrong with the Data is said, all at once.
template <class Check, class Call>
bool acceptDataOf(SofaComponent& host, const Check& check, const Call& call)
{
    const bool accepted = attempt(host,
                                  [&]
                                  {
                                      parts::OptionErrors errors;
                                      errors.collect(check);
                                      errors.collect(call);
                                      errors.throw_all();
                                  });
    if (accepted) host.d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
    return accepted;
}

}  // namespace hexaplast::sofa_plugin
