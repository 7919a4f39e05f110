// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/releases.h>
#include <sofa/core/objectmodel/BaseData.h>
#include <sofa/core/objectmodel/DDGNode.h>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

#include "attributes/attribute.hpp"

namespace hexaplast::sofa_plugin
{

/// Stands behind the inputs of a component in SOFA's graph of dependencies, which tells it of each change.
class Inputs final : public sofa::core::objectmodel::DDGNode
{
public:
    Inputs(const SofaComponent& owner, const attributes::Description& description)
    {
        for (const attributes::Attribute& attribute : description.attributes)
            if (auto* data = owner.findData(std::string(attribute.name));
                data && attribute.access != attributes::Access::kOutput)
                addInput(data);
        update();
    }

    /// One that the table does not have; once.
    void add(sofa::core::objectmodel::DDGNode& input)
    {
        if (std::find(inputs.begin(), inputs.end(), &input) == inputs.end()) addInput(&input);
        update();
    }

    void update() override
    {
        for (sofa::core::objectmodel::DDGNode* input : inputs) input->updateIfDirty();  // that follow others
        cleanDirty();
    }

    /// Whether one has changed since this was asked last.
    bool haveChanged()
    {
        const bool changed = isDirty();
        if (changed) update();
        return changed;
    }
};

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
