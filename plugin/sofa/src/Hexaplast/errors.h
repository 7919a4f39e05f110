// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/releases.h>
#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "parts/option.hpp"

namespace hexaplast::sofa_plugin
{

/// "liver.scn:7: error: TubeGridTopology.length: must be > 0": an attribute, or (empty) the component, where it stands
/// in the scene file, or its path in the graph where it does not come from a file.
inline std::string error_at(const SofaComponent& component, const std::string& attribute, const std::string& what)
{
    const std::string& file = component.getInstanciationSourceFileName();
    const std::string place =
        file.empty() ? component.getPathName() : fmt::format("{}:{}", file, component.getInstanciationSourceFilePos());
    return fmt::format("{}: error: {}{}{}: {}", place, component.getClassName(), attribute.empty() ? "" : ".",
                       attribute, what);
}

/// What a part says without refusing anything.
inline void pass_on(const SofaComponent& component, const std::vector<parts::Remark>& warnings)
{
    for (const parts::Remark& warning : warnings)
        msg_warning(&component) << component.getClassName() << (warning.attribute.empty() ? "" : ".")
                                << warning.attribute << ": " << warning.text;
}

/// Whether a component may take part in a step. Where it is invalid, the animation is stopped once more, for whoever
/// has started it again: `runSofa -a` after the scene's errors, or a user. One that is driven on although it is
/// stopped, as `runSofa -g batch` and programs do, ends by an exception: a run without its forces would be worthless.
inline bool may_step(const SofaComponent& component)
{
    if (!is_invalid(component)) return true;
    auto* root = component.getContext() ? component.getContext()->getRootContext() : nullptr;
    if (!root) return false;
    const char* what = " is invalid (see its error above): the animation is stopped";
    if (!root->getAnimate()) throw std::runtime_error(component.getPathName() + what);
    msg_error(&component) << component.getPathName() << what;
    root->setAnimate(false);
    return false;
}

/// What a component of SOFA does with errors of its part: it says what is wrong, becomes invalid and stops the
/// animation. True when `call` came through.
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
        for (const auto& [attribute, reason] : error.reasons()) errors.push_back(error_at(host, attribute, reason));
    }
    catch (const InputError& error)
    {
        errors.push_back(error_at(host, "", error.what()));
    }
    catch (const NumericalError& error)
    {
        errors.push_back(error.what());
    }
    for (const std::string& error : errors) msg_error(&host) << error;
    host.d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
    if (auto* root = host.getContext() ? host.getContext()->getRootContext() : nullptr) root->setAnimate(false);
    return false;
}

/// Lets `call` make or change the part of a component by its Data, beside a check. Where both come through the
/// component is valid; else what is wrong with the Data is said, all at once.
template <class Check, class Call>
bool accept_data(SofaComponent& host, const Check& check, const Call& call)
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
