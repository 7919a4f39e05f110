// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/AttributeData.h>
#include <Hexaplast/fields.h>

#include <optional>
#include <stdexcept>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "scene/factory.hpp"
#include "scene/scene.hpp"

namespace hexaplast::sofa_plugin
{

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

}  // namespace hexaplast::sofa_plugin
