// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/core/objectmodel/Link.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hexaplast::sofa_plugin
{

/// Changes a Data of another component at AnimateBeginEvent. It stands before that component, so that the change counts
/// in the same step. Data: plugin/attributes/parts.hpp.
class HEXAPLAST_SOFA_API AttributeChange final : public sofa::core::objectmodel::BaseObject
{
public:
    SOFA_CLASS(AttributeChange, sofa::core::objectmodel::BaseObject);

    Data<std::string> d_attribute;               ///< name of the Data
    Data<sofa::type::vector<SReal>> d_keyTimes;  ///< [s] of the changes
    Data<std::string> d_values;                  ///< separated by semicolons
    sofa::core::objectmodel::SingleLink<AttributeChange, sofa::core::objectmodel::BaseObject,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_component;  ///< that has the Data

    void bwdInit() override;
    void reset() override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;

protected:
    AttributeChange();

private:
    void put(const std::optional<std::string>& value);
    void put_default();

    sofa::core::BaseData* m_data = nullptr;
    std::vector<std::optional<std::string>> m_values;  // none: not given
    std::vector<double> m_times;                       // [s]
    std::function<void()> m_putBack;                   // the value that it had before, to the last bit
    bool m_wasSet = false;
    std::ptrdiff_t m_numDone = 0;
};

}  // namespace hexaplast::sofa_plugin
