// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/type/types.h>

#include <utility>

namespace sofa::core::topology {

enum TopologyChangeType {
  ENDING_EVENT,
  POINTSADDED,
  POINTSREMOVED,
  POINTSRENUMBERING,
  HEXAHEDRAADDED,
  HEXAHEDRAREMOVED
};

class TopologyChange {
 public:
  explicit TopologyChange(TopologyChangeType type) : type_(type) {}
  virtual ~TopologyChange() = default;
  TopologyChangeType getChangeType() const { return type_; }

 private:
  TopologyChangeType type_;
};

class HexahedraRemoved : public TopologyChange {
 public:
  explicit HexahedraRemoved(type::vector<Index> hexahedra)
      : TopologyChange(HEXAHEDRAREMOVED), hexahedra_(std::move(hexahedra)) {}
  const type::vector<Index>& getArray() const { return hexahedra_; }

 private:
  type::vector<Index> hexahedra_;
};

}  // namespace sofa::core::topology
