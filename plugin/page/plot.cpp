// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/plot.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "page/history_panels.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace {

// the page, and the four panels on it [pixels]
constexpr double kWidth = 1040, kHeight = 760;
constexpr PanelFrame kFrames[] = {{86, 104, 400, 225}, {590, 104, 400, 225}, {86, 440, 400, 225}, {590, 440, 400, 225}};
constexpr double kTitleSize = 20, kTitleWidth = 0.68;  // [pixels], and of a bold letter, in parts of the size

// the keys of a panel stand below it, to the left of what the axis means
constexpr double kKeySize = 12, kKeyLetter = 7.2, kKeyLine = 22, kKeyGap = 18, kKeyBelow = 36, kKeyRow = 18;
constexpr double kKeysWidth = 330;

void draw_keys(SvgText& svg, const PanelFrame& frame, const Panel& panel) {
  double x = frame.left, y = frame.top + frame.height + kKeyBelow;
  for (const Curve& curve : panel.series.front().curves) {
    if (curve.name.empty()) continue;
    const double width = kKeyLine + 6 + kKeyLetter * static_cast<double>(curve.name.size());
    if (x > frame.left && x + width > frame.left + kKeysWidth) {
      x = frame.left;
      y += kKeyRow;
    }
    const std::string dashes = curve.dashes.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", curve.dashes);
    svg.line(x, y - 4, x + kKeyLine, y - 4, curve.colour, R"( stroke-width="2.4")" + dashes);
    svg.words(x + kKeyLine + 6, y, "start", kKeySize, curve.name);
    x += width + kKeyGap;
  }
}

}  // namespace

void write_plot(const std::filesystem::path& file, const std::filesystem::path& history, const std::string& title,
                int num_elements) {
  HistoryView view = view_history(history, history_panels());
  // as many as fit; what shows nothing makes room for what comes behind
  for (auto panel = view.panels.begin(); panel != view.panels.end() && view.panels.size() > std::size(kFrames);)
    panel = has_nothing_to_see(*panel) ? view.panels.erase(panel) : panel + 1;
  if (view.panels.size() < std::size(kFrames)) return;  // no state was recorded
  view.panels.resize(std::size(kFrames));
  for (Panel& panel : view.panels)
    if (panel.quantity == "yielded hexahedra") panel.quantity += fmt::format(" (of {})", num_elements);

  SvgText svg;
  const double title_size =
      std::min(kTitleSize, (kWidth - 2 * kFrames[0].left) / (kTitleWidth * static_cast<double>(title.size() + 1)));
  svg.words(kFrames[0].left, 46, "start", title_size, title, R"( font-weight="bold")");
  for (std::size_t p = 0; p < std::size(kFrames); ++p) {
    svg.panel(kFrames[p], view.panels[p]);
    draw_keys(svg, kFrames[p], view.panels[p]);
  }

  WholeFile out(file);
  out.write(svg.picture(kWidth, kHeight));
  out.commit();
}

}  // namespace hexaplast::output
