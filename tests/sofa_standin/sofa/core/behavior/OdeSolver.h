// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/BaseComponent.h>

namespace sofa::core::behavior {

class OdeSolver : public objectmodel::BaseComponent {};

}  // namespace sofa::core::behavior
