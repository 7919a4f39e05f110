// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/core/objectmodel/BaseData.h>
#include <sofa/core/objectmodel/DDGNode.h>

#include <functional>
#include <initializer_list>
#include <utility>

namespace hexaplast::sofa_plugin
{

/// Stands before outputs in SOFA's graph of dependencies, so that they are computed when somebody reads one of them.
class Outputs final : public sofa::core::objectmodel::DDGNode
{
public:
    Outputs(std::initializer_list<sofa::core::objectmodel::BaseData*> outputs, std::function<void()> compute)
        : m_compute(std::move(compute))
    {
        for (sofa::core::objectmodel::BaseData* output : outputs) addOutput(output);
    }

    void update() override
    {
        cleanDirty();
        m_compute();
    }

private:
    std::function<void()> m_compute;
};

}  // namespace hexaplast::sofa_plugin
