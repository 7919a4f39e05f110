// SPDX-License-Identifier: LGPL-2.1-or-later
// The text of a scene: what is read, written down again and read once more, is the same tree.
#include "scene/document.hpp"

#include <string>

#include "scene/diagnostics.hpp"
#include "target.hpp"

using namespace hexaplast;
using scene::Element;

namespace {

bool same(const Element& a, const Element& b) {
  if (a.tag != b.tag || a.attributes.size() != b.attributes.size() || a.children.size() != b.children.size())
    return false;
  for (std::size_t i = 0; i < a.attributes.size(); ++i)
    if (a.attributes[i].name != b.attributes[i].name || a.attributes[i].value != b.attributes[i].value) return false;
  for (std::size_t i = 0; i < a.children.size(); ++i)
    if (!same(a.children[i], b.children[i])) return false;
  return true;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  scene::Diagnostics diagnostics;
  try {
    const Element once = scene::read_document(fuzz::text_of(data, size), "/no/such/folder/any.scn", diagnostics);
    const std::string text = scene::write_document(once, "");
    fuzz::require(same(once, scene::read_document(text, "/no/such/folder/any.scn", diagnostics)), "read as written");
  } catch (const scene::SceneError&) {
  }
  return 0;
}
