// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/Data.h>

namespace sofa::core::objectmodel {

/// Looks for no files: the full path is what was given.
class DataFileName : public Data<std::string> {
 public:
  using Data<std::string>::Data;
  const std::string& getFullPath() const { return getValue(); }
};

}  // namespace sofa::core::objectmodel
