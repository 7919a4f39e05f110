// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/page_picture.hpp"

#include <array>

namespace hexaplast::view {

output::Quantity picture_quantity(Quantity quantity) {
  constexpr std::array kOfPictures{output::Quantity::kPlasticStrain, output::Quantity::kStress,
                                   output::Quantity::kYield, output::Quantity::kVolumeRatio, output::Quantity::kSpeed};
  return kOfPictures[static_cast<std::size_t>(quantity)];
}

output::Drawing page_picture(const Source& source, const Snapshot& snapshot, const output::Staging& staging,
                             const Look& look, const Camera& camera, std::optional<std::pair<double, double>> range) {
  output::Staging page = staging;
  page.quantity = picture_quantity(snapshot.quantity);
  if (range && range->first < range->second) page.range = range;
  page.viewpoint =
      output::Viewpoint{camera.eye() - camera.target(), camera.up(),
                        output::Viewpoint::Eye{camera.eye(), camera.target(), Camera::field_of_view(), true}};
  page.cut = look.cut;
  if (look.cut || !look.shows_embedded_surfaces) page.embedded_surfaces.clear();
  page.shows_hexahedra = look.shows_edges || page.embedded_surfaces.empty();
  page.shows_edges = look.shows_edges;
  page.shows_loads = look.shows_instruments;
  page.ghost = look.ghost == Ghost::kNone ? "" : look.ghost == Ghost::kInitial ? "initial shape" : "rest shape";

  output::BoundaryConditions shown;
  if (look.shows_instruments) shown = snapshot.conditions;
  shown.springs = snapshot.conditions.springs;
  output::Gallery gallery(source.mesh(), source.title(), output::time_decimals(source.dt() > 0 ? source.dt() : 1),
                          std::move(page));
  gallery.add(snapshot.step, snapshot.sample.time, snapshot.positions,
              snapshot.of_hexahedra.empty() ? snapshot.values : snapshot.of_hexahedra, snapshot.alive, shown,
              look.ghost == Ghost::kPlasticRest ? &snapshot.plastic_rest : nullptr);
  output::Drawing picture;
  gallery.for_each_drawing([&](int, const output::Drawing& drawing) { picture = drawing; });
  return picture;
}

}  // namespace hexaplast::view
