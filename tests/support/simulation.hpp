// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hexaplast/base/hash.hpp"
#include "loaded_body.hpp"

namespace hexaplast::support {

/// A body some of whose nodes are held along some axes.
class GuidedBody final : public LoadedBody {
 public:
  struct Held {
    int node, axis;
  };
  GuidedBody(Body& body, std::vector<Held> held, NodalLoad load)
      : LoadedBody(body, std::vector<double>(body.mesh().num_nodes(), 0.0), {}, std::move(load)),
        held_(std::move(held)) {}

  void constrain(Constraints& constraints) const override {
    for (const Held& held : held_) constraints.free(held.node, held.axis) = 0;
  }

 private:
  std::vector<Held> held_;
};

/// Of its history.
inline std::string hash_of(const Body& body) {
  StateHash hash;
  body.add_to(hash);
  return hash.text();
}

}  // namespace hexaplast::support
