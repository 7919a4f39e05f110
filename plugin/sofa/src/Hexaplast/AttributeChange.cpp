// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/Link.h>
#include <sofa/simulation/AnimateBeginEvent.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "attributes/parts.hpp"
#include "parts/attribute_change.hpp"
#include "parts/key_times.hpp"

namespace hexaplast::sofa_plugin
{

namespace
{

/// Its default in the tables; none: it has none, or the component is not one of ours.
std::string_view defaultOf(const std::string& class_name, const std::string& name)
{
    for (const Registered& each : registered())
        if (each.description->class_name == class_name)
            for (const Attribute& attribute : each.description->attributes)
                if (attribute.name == name) return attribute.initial;
    return {};
}

/// Gives a Data the value again that it has now. SOFA writes real numbers with six digits: they are kept as they are.
template <class... Reals>
std::function<void()> keep(sofa::core::BaseData& data)
{
    std::function<void()> putBack = [&data, text = data.getValueString()] { data.read(text); };
    const auto keepAs = [&]<class T>(Data<T>* typed)
    {
        if (typed) putBack = [typed, value = typed->getValue()] { typed->setValue(value); };
    };
    (keepAs(dynamic_cast<Data<Reals>*>(&data)), ...);
    return putBack;
}

}  // namespace

/// Changes a Data of another component at AnimateBeginEvent. It stands before that component, so that the change counts
/// in the same step. Data: plugin/attributes/parts.hpp.
class AttributeChange final : public TableComponent<SofaComponent>
{
public:
    SOFA_CLASS(AttributeChange, SOFA_TEMPLATE(TableComponent, SofaComponent));

    Data<std::string>& d_attribute = data<std::string>("attribute");
    Data<sofa::type::vector<SReal>>& d_keyTimes = data<sofa::type::vector<SReal>>("keyTimes");
    Data<std::string>& d_values = data<std::string>("values");
    sofa::core::objectmodel::SingleLink<AttributeChange, SofaComponent,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_component{initLink("component", helpOf("component"))};  ///< that has the Data

    void bwdInit() override;
    void reset() override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;

protected:
    AttributeChange() : TableComponent(attributes::kAttributeChange) { f_listening.setValue(true); }

private:
    void put(const std::optional<std::string>& value);
    void putDefault();

    sofa::core::sptr<SofaComponent> m_component;                    ///< that l_component led to
    sofa::core::BaseData* m_data = nullptr;                         ///< of that
    std::vector<std::optional<std::string>> m_values;               ///< none: not given
    std::vector<double> m_times;                                    ///< [s]
    sofa::core::BaseData* m_parent = nullptr;                       ///< that it followed before; null: none
    sofa::core::sptr<sofa::core::objectmodel::Base> m_parentOwner;  ///< which lives as long as that is needed
    std::function<void()> m_putBack;                                // the value that it had before, to the last bit
    bool m_wasSet = false;
    std::ptrdiff_t m_numDone = 0;
};

void AttributeChange::bwdInit()
{
    attempt(*this,
            [&]
            {
                m_component = nullptr;
                m_numDone = 0;
                checkLink(l_component, "component");
                if (!l_component) throw parts::OptionError("component", "is not given, must lead to a component");
                m_data = l_component->findData(d_attribute.getValue());
                // SOFA makes what follows another Data read-only
                if (!m_data || (m_data->isReadOnly() && !m_data->getParent()))
                    throw parts::OptionError("attribute", l_component->getClassName() + " '" + l_component->getName() +
                                                              "' has no attribute '" + d_attribute.getValue() +
                                                              "' that a scene gives");
                m_values.clear();
                for (const auto& value : parts::values_of_changes(d_values.getValue()))
                    m_values.push_back(value ? std::optional<std::string>(*value) : std::nullopt);
                const auto& times = d_keyTimes.getValue();
                m_times.assign(times.begin(), times.end());
                parts::check_key_times("key_times", m_times, "values", m_values.size());
                if (!d_values.isSet()) throw parts::OptionError("values", "is not given");
                using sofa::type::Vec3, sofa::type::vector;
                m_parent = m_data->getParent();
                m_parentOwner = m_parent ? m_parent->getOwner() : nullptr;
                m_putBack = keep<SReal, vector<SReal>, Vec3, vector<Vec3>>(*m_data);
                m_wasSet = m_data->isSet();
                m_component = l_component.get();
            });
}

void AttributeChange::reset()
{
    if (m_numDone == 0) return;
    m_numDone = 0;
    m_putBack();
    if (m_parent) m_data->setParent(m_parent);
    if (!m_wasSet) m_data->unset();
}

void AttributeChange::handleEvent(sofa::core::objectmodel::Event* event)
{
    if (!sofa::simulation::AnimateBeginEvent::checkEventType(event) || !mayStep(*this)) return;
    if (m_component.get() != l_component.get()) bwdInit();  // it was added during the run, or leads elsewhere now
    if (!mayStep(*this)) return;
    const auto due = parts::num_come(m_times, getContext()->getTime());
    if (due == m_numDone) return;
    if (due == 0) return reset();  // time went back
    m_numDone = due;
    put(m_values[static_cast<std::size_t>(due - 1)]);
}

// Its counter tells those who look at the Data that it has changed, also where it is not given any more. If it went on
// following another Data, it would take the value of that one again.
void AttributeChange::put(const std::optional<std::string>& value)
{
    attempt(*this,
            [&]
            {
                m_data->setParent(nullptr);
                if (!value) return putDefault();
                const auto* words = dynamic_cast<const Data<OptionsGroup>*>(m_data);
                if (!m_data->read(*value) || (words && words->getValue().getSelectedItem() != *value))
                    throw parts::OptionError("values", "'" + *value + "' is no value of " + d_attribute.getValue());
            });
}

void AttributeChange::putDefault()
{
    const std::string_view text = defaultOf(l_component->getClassName(), d_attribute.getValue());
    if (text.empty() || !m_data->read(std::string(text))) m_putBack();
    m_data->unset();
}

[[maybe_unused]] const bool kAttributeChangeIsRegistered =
    registerComponent<AttributeChange>(attributes::kAttributeChange);

}  // namespace hexaplast::sofa_plugin
