// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/BladeController.h>
#include <Hexaplast/Followers.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <sofa/simulation/AnimateBeginEvent.h>

namespace hexaplast::sofa_plugin
{

BladeController::BladeController() : TableComponent(attributes::kBladeInSofa) { f_listening.setValue(true); }

// Bodies may be declared later.
void BladeController::bwdInit()
{
    m_dataAreAccepted = acceptDataOf(
        *this, [&] { m_frame.check(); }, [&] { make(); });
}

parts::BladeOptions BladeController::options() const
{
    auto options = readOptions<parts::BladeOptions>();
    options.is_prescribed = m_frame.isGiven();
    return options;
}

BladeController::Field* BladeController::field() const { return l_body ? l_body.get() : getContext()->get<Field>(); }

void BladeController::make()
{
    m_part.reset();
    m_hasAsked = false;
    m_inputs.haveChanged();
    checkLink(l_body, "body");
    m_field = field();
    if (!m_field)
        throw InputError("needs a HexahedronElastoplasticFEMForceField in its node or above, or a link to one");
    if (!m_field->works()) throw InputError("its body '" + m_field->getName() + "' is invalid (see its error above)");
    m_body = m_field->part();
    m_part.emplace(options(), m_body->body());
}

void BladeController::reset()
{
    m_hasAsked = false;
    if (m_dataAreAccepted) d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
}

void BladeController::handleEvent(sofa::core::objectmodel::Event* event)
{
    if (!sofa::simulation::AnimateBeginEvent::checkEventType(event)) return;
    const bool isOther = field() != m_field.get() || (m_field && m_field->works() && m_field->part() != m_body);
    if (m_inputs.haveChanged() || isOther || (!m_part && !isInvalid(*this))) bwdInit();
    if (!mayStep(*this) || !m_field->works()) return;
    const SReal dt = static_cast<sofa::simulation::AnimateBeginEvent*>(event)->getDt();
    attempt(*this, [&] { beginStep(dt); });
}

void BladeController::beginStep(SReal dt)
{
    m_field->takeGivenState();  // with nodes that split there
    if (!m_hasAsked)
    {
        Followers{*m_field};
        m_hasAsked = true;
    }
    m_frame.check();
    if (m_frame.isGiven()) m_part->prescribe(m_frame.after(0), m_frame.after(dt));
    m_part->begin_step({.time = getContext()->getTime(), .dt = dt, .rayleigh_stiffness = 0},
                       view(m_field->getMState()->readPositions().ref()));
    m_field->expect(*this);
}

void BladeController::addOpened(std::vector<int>& joints, std::vector<double>& crossings)
{
    if (!m_part || isInvalid(*this) || m_field->part() != m_body) return;
    attempt(*this,
            [&]
            {
                const auto& opened = m_part->end_step(view(m_field->getMState()->readPositions().ref()));
                joints.insert(joints.end(), opened.begin(), opened.end());
                crossings.insert(crossings.end(), m_part->crossings().begin(), m_part->crossings().end());
            });
}

void BladeController::draw(const sofa::core::visual::VisualParams* vparams)
{
    const auto& flags = vparams->displayFlags();
    if (!m_part || isInvalid(*this) || !data<bool>("active").getValue()) return;
    if (!flags.getShowForceFields() && !flags.getShowVisualModels()) return;
    auto* tool = vparams->drawTool();
    const auto lifeCycle = tool->makeStateLifeCycle();
    tool->enableLighting();
    drawShape(*tool, parts::edge_of(m_part->options()),
              m_frame.isGiven() ? m_frame.after(0) : m_part->pose_at(getContext()->getTime()));
}

[[maybe_unused]] const bool kBladeControllerIsRegistered = registerComponent<BladeController>(attributes::kBladeInSofa);

}  // namespace hexaplast::sofa_plugin
