// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>

namespace hexaplast::sofa_plugin
{

/// What SOFA has done when it has loaded the plugin: for programs that link it instead.
HEXAPLAST_SOFA_API void init();

}  // namespace hexaplast::sofa_plugin
