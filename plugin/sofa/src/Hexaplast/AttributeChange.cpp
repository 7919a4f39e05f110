// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/AttributeChange.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <sofa/simulation/AnimateBeginEvent.h>

#include "parts/attribute_change.hpp"
#include "parts/key_times.hpp"

namespace hexaplast::sofa_plugin
{

namespace
{

/// Its default in the tables; none: it has none, or the component is not one of ours.
std::string_view default_of(const std::string& class_name, const std::string& name)
{
    for (const attributes::Description* description : registered())
        if (description->class_name == class_name)
            for (const Attribute& attribute : description->attributes)
                if (attribute.name == name) return attribute.initial;
    return {};
}

/// Gives a Data the value again that it has now. SOFA writes real numbers with six digits: they are kept as they are.
template <class... Reals>
std::function<void()> keep(sofa::core::BaseData& data)
{
    std::function<void()> put_back = [&data, text = data.getValueString()] { data.read(text); };
    const auto keep_as = [&]<class T>(Data<T>* typed)
    {
        if (typed) put_back = [typed, value = typed->getValue()] { typed->setValue(value); };
    };
    (keep_as(dynamic_cast<Data<Reals>*>(&data)), ...);
    return put_back;
}

}  // namespace

void AttributeChange::bwdInit()
{
    attempt(*this,
            [&]
            {
                if (!l_component) throw parts::OptionError("component", "is not given, must lead to a component");
                m_data = l_component->findData(d_attribute.getValue());
                // SOFA makes what follows another Data read-only
                if (!m_data || (m_data->isReadOnly() && !m_data->getParent()))
                    throw parts::OptionError(
                        "attribute",
                        fmt::format("{} '{}' has no attribute '{}' that a scene gives", l_component->getClassName(),
                                    l_component->getName(), d_attribute.getValue()));
                m_values.clear();
                for (const auto& value : parts::values_of_changes(d_values.getValue()))
                    m_values.push_back(value ? std::optional<std::string>(*value) : std::nullopt);
                const auto& times = d_keyTimes.getValue();
                m_times.assign(times.begin(), times.end());
                parts::check_key_times("key_times", m_times, "values", m_values.size());
                using sofa::type::Vec3, sofa::type::vector;
                m_parent = m_data->getParent();
                m_putBack = keep<SReal, vector<SReal>, Vec3, vector<Vec3>>(*m_data);
                m_wasSet = m_data->isSet();
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
    if (!sofa::simulation::AnimateBeginEvent::checkEventType(event) || !may_step(*this)) return;
    const auto due = parts::num_come(m_times, getContext()->getTime());
    if (due <= m_numDone) return;
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
                if (!value) return put_default();
                if (!m_data->read(*value))
                    throw parts::OptionError("values",
                                             fmt::format("'{}' is no value of {}", *value, d_attribute.getValue()));
            });
}

void AttributeChange::put_default()
{
    const std::string_view text = default_of(l_component->getClassName(), d_attribute.getValue());
    if (text.empty() || !m_data->read(std::string(text))) m_putBack();
    m_data->unset();
}

void registerAttributeChange(sofa::core::ObjectFactory* factory)
{
    register_component<AttributeChange>(factory, attributes::kAttributeChange);
}

}  // namespace hexaplast::sofa_plugin
