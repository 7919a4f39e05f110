// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/page_picture.hpp"

namespace hexaplast::view {

output::Drawing page_picture(const Source& source, const Snapshot& snapshot, const output::Staging& staging,
                             const Look& look, const Camera& camera, const output::Scale& scale) {
  output::Staging page = staging;
  stage(look, page);
  page.quantity = snapshot.quantity;
  if (!scale.is_flat()) page.range = std::pair(scale.min(), scale.max());
  page.viewpoint = camera.viewpoint();
  output::Gallery gallery(source.mesh(), source.title(), output::time_decimals(source.dt() > 0 ? source.dt() : 1),
                          std::move(page));
  gallery.add(snapshot.step, snapshot.sample.time, snapshot.positions,
              snapshot.of_hexahedra.empty() ? snapshot.values : snapshot.of_hexahedra, snapshot.alive,
              look.conditions(snapshot), look.ghost_nodes(snapshot), snapshot.open);
  output::Drawing picture;
  gallery.for_each_drawing([&](int, const output::Drawing& drawing) { picture = drawing; });
  return picture;
}

}  // namespace hexaplast::view
