// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/AttributeData.h>
#include <sofa/core/behavior/MechanicalState.h>
#include <sofa/core/topology/BaseMeshTopology.h>
#include <sofa/defaulttype/VecTypes.h>

#include <optional>
#include <stdexcept>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "scene/factory.hpp"
#include "scene/scene.hpp"

namespace hexaplast::sofa_plugin
{

using DataTypes = sofa::defaulttype::Vec3Types;
using MechanicalState = sofa::core::behavior::MechanicalState<DataTypes>;
using MeshTopology = sofa::core::topology::BaseMeshTopology;

/// Nodal fields of SOFA as ours, and back: the same memory.
inline Eigen::Map<const PointArray> view(const DataTypes::VecCoord& field)
{
    static_assert(sizeof(DataTypes::Coord) == 3 * sizeof(double), "SOFA must be built with double precision");
    return {field.empty() ? nullptr : field[0].ptr(), static_cast<Eigen::Index>(field.size()), 3};
}
inline Eigen::Map<PointArray> view(DataTypes::VecCoord& field)
{
    return {field.empty() ? nullptr : field[0].ptr(), static_cast<Eigen::Index>(field.size()), 3};
}

/// The components of ours that SOFA can have as guests, by class name.
const scene::Factory& guests();

/// One of our components at work inside a SOFA component. It lives in a scene of its own, of one node, beside stand-ins
/// for the mechanical state and the topology of its host: the component that the embedded host runs, unchanged.
///
/// Calls throw scene::SceneError, scene::Rejection, InputError or NumericalError where the guest refuses or gives up;
/// attempt() turns them into messages of the host.
class Guest
{
public:
    /// Makes and initialises a guest of the class in `description`. state, topology: null where the guest uses none.
    Guest(SofaComponent& host, const attributes::Description& description, AttributeData& attributes,
          MechanicalState* state, MeshTopology* topology);

    template <class T>
    T& as()
    {
        return dynamic_cast<T&>(*m_component);
    }

    /// Hands on what changed among the attributes; the guest refuses what cannot change during a run.
    void follow_attributes();

    /// At the beginning of a step, which follows the attributes first.
    void begin_step(double time, double dt);

    /// At the end of a step, positions accepted.
    void end_step(double dt);

    void reset();

    /// What the guest has warned of, as messages of the host; the calls above do that themselves.
    void pass_on_warnings();

private:
    class State;

    /// Present positions of the host's state for the stand-in.
    void copy_positions();

    SofaComponent& m_host;
    AttributeData& m_attributes;
    MechanicalState* m_sofaState;
    scene::Scene m_scene;
    State* m_state = nullptr;
    scene::Component* m_component = nullptr;
};

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

/// What a component of SOFA does with errors of its guest: it says what is wrong, becomes invalid and stops the
/// animation. True when `call` came through.
template <class Call>
bool attempt(SofaComponent& host, const Call& call)
{
    const auto fail = [&](const char* what)
    {
        msg_error(&host) << what;
        host.d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
        if (auto* root = host.getContext() ? host.getContext()->getRootContext() : nullptr) root->setAnimate(false);
        return false;
    };
    try
    {
        call();
        return true;
    }
    catch (const scene::SceneError& error)
    {
        return fail(error.what());
    }
    catch (const scene::Rejection& error)
    {
        return fail(error.what());
    }
    catch (const InputError& error)
    {
        return fail(error.what());
    }
    catch (const NumericalError& error)
    {
        return fail(error.what());
    }
}

}  // namespace hexaplast::sofa_plugin
