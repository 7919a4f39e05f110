// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/Link.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

/// Changes a Data of another component at AnimateBeginEvent. It stands before that component, so that the change counts
/// in the same step. Data: plugin/attributes/parts.hpp.
class HEXAPLAST_SOFA_API AttributeChange final : public TableComponent<SofaComponent>
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

}  // namespace hexaplast::sofa_plugin
