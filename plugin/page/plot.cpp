// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/plot.hpp"

#include <fmt/format.h>

#include "page/history_panels.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace {

// the page, and the four panels on it [pixels]
constexpr double kWidth = 1040, kHeight = 700;
constexpr PanelFrame kFrames[] = {{86, 104, 400, 225}, {590, 104, 400, 225}, {86, 410, 400, 225}, {590, 410, 400, 225}};

}  // namespace

void write_plot(const std::filesystem::path& file, const std::filesystem::path& history, const std::string& title,
                int num_elements) {
  HistoryView view = view_history(history, history_panels());
  if (view.panels.size() < std::size(kFrames)) return;  // no state was recorded
  view.panels.resize(std::size(kFrames));
  for (Panel& panel : view.panels)
    if (panel.quantity == "yielded hexahedra") panel.quantity += fmt::format(" (of {})", num_elements);

  SvgText svg;
  svg.words(kFrames[0].left, 46, "start", 20, title, R"( font-weight="bold")");

  double x = kFrames[1].left + 78;
  for (const Curve& curve : view.panels.front().series.front().curves) {
    svg.line(x, 40, x + 30, 40, curve.colour, R"( stroke-width="2.4")");
    svg.words(x + 38, 45, "start", 14, curve.name == "plastic" ? "plastic (material mesh)" : curve.name);
    x += 122;
  }
  for (std::size_t p = 0; p < std::size(kFrames); ++p) svg.panel(kFrames[p], view.panels[p]);

  WholeFile out(file);
  out.write(svg.picture(kWidth, kHeight));
  out.commit();
}

}  // namespace hexaplast::output
