// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/registration.h>
#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/core/objectmodel/DataFileName.h>
#include <sofa/simulation/AnimateEndEvent.h>

#include "hexaplast/body.hpp"
#include "record/recorder.hpp"

namespace hexaplast::sofa_plugin
{

constexpr attributes::Description kFinalStateExporter{
    .class_name = "FinalStateExporter",
    .category = "Exporter",
    .help =
        "Writes positions, velocities, plastic rest positions and the plastic state after a step in full precision, as "
        "hexaplast run --final does. Stands behind the force field in its node.",
    .templates = ""};

/// Writes the state after a step in full precision.
class FinalStateExporter final : public sofa::core::objectmodel::BaseObject
{
public:
    SOFA_CLASS(FinalStateExporter, sofa::core::objectmodel::BaseObject);

    void init() override
    {
        if (d_filename.getValue().empty() || d_step.getValue() < 1)
        {
            msg_error() << "needs filename, and exportAtStep of at least 1";
            d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
        }
    }
    void reset() override { m_numSteps = 0; }

    void handleEvent(sofa::core::objectmodel::Event* event) override
    {
        if (!sofa::simulation::AnimateEndEvent::checkEventType(event) || is_invalid(*this)) return;
        if (++m_numSteps != d_step.getValue()) return;
        HexahedronElastoplasticFEMForceField<Vec3Types>* field = nullptr;
        getContext()->get(field, sofa::core::objectmodel::BaseContext::SearchUp);
        const Body* body = field ? field->body() : nullptr;
        if (!body)
        {
            msg_error() << "finds no body in its node or above";
            return;
        }
        const auto* state = field->getMState();
        try
        {
            output::write_final(d_filename.getFullPath(), m_numSteps, getContext()->getTime(),
                                view(state->readPositions().ref()), view(state->readVelocities().ref()), *body);
        }
        catch (const std::runtime_error& error)
        {
            msg_error() << error.what();
        }
    }

protected:
    FinalStateExporter()
        : d_filename(initData(&d_filename, "filename", "The JSON file.")),
          d_step(initData(&d_step, 0, "exportAtStep", "The step after which the state is written."))
    {
        f_listening.setValue(true);
    }

private:
    sofa::core::objectmodel::DataFileName d_filename;  ///< the JSON file
    sofa::core::objectmodel::Data<int> d_step;         ///< after which the state is written
    int m_numSteps = 0;
};

void registerFinalStateExporter(sofa::core::ObjectFactory* factory)
{
    register_component<FinalStateExporter>(factory, kFinalStateExporter);
}

}  // namespace hexaplast::sofa_plugin
