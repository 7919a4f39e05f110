// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/simulation/AnimateEndEvent.h>

#include "attributes/parts.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast::sofa_plugin
{

/// Pauses the animation of a window when the scene has run its steps, and sets the threads of the kernels.
class RunSettings final : public TableComponent<SofaComponent>
{
public:
    SOFA_CLASS(RunSettings, SOFA_TEMPLATE(TableComponent, SofaComponent));

    Data<int>& d_steps = data<int>("steps");
    Data<int> d_threads{initData(&d_threads, 0, "threads",
                                 "Threads of Hexaplast's kernels in this process. 0: as many as OMP_NUM_THREADS says, "
                                 "or one. Results do not depend on it.")};

    void init() override
    {
        const bool isAccepted =
            attempt(*this,
                    [&]
                    {
                        if (d_threads.getValue() < 0)
                            throw parts::OptionError("threads", std::to_string(d_threads.getValue()) + " must be >= 0");
                        if (d_threads.getValue() > 0) set_num_threads(d_threads.getValue());
                    });
        if (isAccepted) d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
    }
    void reinit() override { init(); }
    void reset() override { m_numSteps = 0; }

    void handleEvent(sofa::core::objectmodel::Event* event) override
    {
        if (!sofa::simulation::AnimateEndEvent::checkEventType(event)) return;
        if (!mayStep(*this) || !d_steps.isSet() || ++m_numSteps != d_steps.getValue()) return;
        msg_info() << "the scene has run its " << m_numSteps << " steps";
        getContext()->getRootContext()->setAnimate(false);
    }

protected:
    RunSettings() : TableComponent(attributes::kRunSettings) { f_listening.setValue(true); }

private:
    int m_numSteps = 0;
};

[[maybe_unused]] const bool kRunSettingsIsRegistered = registerComponent<RunSettings>(attributes::kRunSettings);

}  // namespace hexaplast::sofa_plugin
