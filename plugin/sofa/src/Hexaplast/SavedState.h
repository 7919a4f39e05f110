// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/dependencies.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/DataCallback.h>

#include <functional>
#include <iosfwd>
#include <string>

#include "hexaplast/base/archive.hpp"

namespace hexaplast::sofa_plugin
{

/// The Data `state` of a component: what it keeps from one step to the next, as text. It is computed when it is read.
/// One that is given takes the place of what the component has, so that scripts, files and undo can bring it back to
/// the last bit.
class HEXAPLAST_SOFA_API SavedState
{
public:
    using Save = std::function<void(std::ostream&)>;
    using Load = std::function<void(std::istream&)>;

    SavedState(SofaComponent& owner, Save save);

    void hasChanged() { m_output.setDirtyValue(); }  ///< what the component keeps

    bool isGiven() const { return m_isGiven; }

    /// Loads what was given. Throws InputError, and then nothing has changed.
    void take(const Load& load);

    /// At init and reset, after the component has none: the one that the scene gives, where it gives one. keepsGiven:
    /// one that was given since is taken in its place.
    void takeFirst(const Load& load, bool keepsGiven = false);

    /// Contents for `save`, and back from it: checked by a sum, and for what they belong to.
    using Contents = std::function<void(Archive&)>;
    static void write(std::ostream& out, const std::string& owner, const Contents& contents);
    static void read(std::istream& in, const std::string& owner, const Contents& contents);

private:
    Data<std::string> d_state;
    Save m_save;
    Outputs m_output;
    sofa::core::objectmodel::DataCallback m_edits;
    bool m_isGiven = false;
    bool m_isComputed = false;  ///< just now
    bool m_isInitialised = false;
    std::string m_first;  ///< that the scene gives
};

}  // namespace hexaplast::sofa_plugin
