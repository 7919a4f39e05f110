// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/html.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "formats/base64.hpp"
#include "formats/xml.hpp"
#include "page/page_parts.hpp"
#include "picture/ink.hpp"
#include "record/viewer_states.hpp"

namespace hexaplast::output {
namespace {

// a chart [units of its own; the page scales it]
constexpr double kChartWidth = 480, kChartHeight = 270;
constexpr PanelFrame kChartFrame{64, 30, 402, 186};

/// A string of JSON that may stand within an element of HTML.
std::string json_string(const std::string& words) {
  return without_marks(nlohmann::json(words).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

/// What the script needs of a chart.
std::string json_of(const Panel& panel, const PanelAxes& axes) {
  std::vector<std::string> all_series;
  for (const Series& series : panel.series) {
    std::vector<std::string> curves;
    for (const Curve& curve : series.curves)
      curves.push_back(fmt::format(R"({{"name":{},"colour":{},"values":[{:.7g}]}})", json_string(curve.name),
                                   json_string(curve.colour), fmt::join(curve.values, ",")));
    all_series.push_back(fmt::format(R"({{"steps":[{}],"times":[{:.9g}],"curves":[{}]}})", fmt::join(series.steps, ","),
                                     fmt::join(series.x, ","), fmt::join(curves, ",")));
  }
  return fmt::format(R"({{"quantity":{},"unit":{},"frame":[{},{},{},{}],"axes":[{},{},{},{}],"series":[{}]}})",
                     json_string(panel.quantity), json_string(panel.unit), kChartFrame.left, kChartFrame.top,
                     kChartFrame.width, kChartFrame.height, axes.across.min, axes.across.max, axes.upwards.min,
                     axes.upwards.max, fmt::join(all_series, ","));
}

std::string json_of(const Colour& colour) {
  return fmt::format("[{:.4g},{:.4g},{:.4g}]", colour.red, colour.green, colour.blue);
}

/// What the viewer draws with.
std::string ink_script() {
  return fmt::format(
      R"(const ink = {{paper: {paper}, ink: {ink}, outline: {outline}, ghost: {ghost}, load: {load}, steel: {steel},
  metal: {metal}, edge: {edge}, cage: {cage}, spring: {spring}, noValue: {none}, veil: {veil}, veilOpacity: {veil_opacity:.4g}, slackOpacity: {slack:.4g}, crease: {crease:.4g},
  axes: [{x}, {y}, {z}],
  edges: {{shortest: {shortest:.4g}, longest: {longest:.4g}, widest: {widest:.4g}, strongest: {strongest:.4g},
    cageOpacity: {cage_opacity:.4g}}},
  dot: {{radius: {dot:.4g}, ofEdge: {of_edge:.4g}}}, ring: {{radius: {ring:.4g}, width: {width:.4g}, rim: {rim:.4g}}},
  arrow: {{longest: {arrow:.4g}, girth: {girth:.4g}, headLength: {head_length:.4g}, headWidth: {head_width:.4g},
    rim: {arrow_rim:.4g}, maxHead: {max_head:.4g}, sides: {sides}, presses: {presses:.4g}}}}};
const lightShader = `{light}`;)",
      fmt::arg("paper", json_of(kPaper)), fmt::arg("ink", json_of(kInk)), fmt::arg("outline", json_of(kOriginal)),
      fmt::arg("ghost", json_of(kGhost)), fmt::arg("load", json_of(kLoad)), fmt::arg("steel", json_of(kSteel)),
      fmt::arg("metal", json_of(kMetal)), fmt::arg("edge", json_of(kEdge)), fmt::arg("cage", json_of(kCage)),
      fmt::arg("spring", json_of(kSpring)), fmt::arg("slack", kSlackOpacity), fmt::arg("none", json_of(kNoValue)),
      fmt::arg("x", json_of(kAxes[0])), fmt::arg("y", json_of(kAxes[1])), fmt::arg("z", json_of(kAxes[2])),
      fmt::arg("crease", kCrease), fmt::arg("shortest", EdgeInk::kShortest), fmt::arg("longest", EdgeInk::kLongest),
      fmt::arg("widest", EdgeInk::kWidest), fmt::arg("strongest", EdgeInk::kStrongest),
      fmt::arg("veil", json_of(kVeil)), fmt::arg("veil_opacity", kVeilOpacity),
      fmt::arg("cage_opacity", EdgeInk::kCageOpacity), fmt::arg("dot", kDotRadius), fmt::arg("of_edge", kDotOfEdge),
      fmt::arg("ring", kRingRadius), fmt::arg("width", kRingWidth), fmt::arg("rim", kRimWidth),
      fmt::arg("arrow", kLongestArrow), fmt::arg("girth", kArrowGirth), fmt::arg("arrow_rim", kRimOfArrows),
      fmt::arg("head_length", kArrowHeadLength), fmt::arg("head_width", kArrowHeadWidth),
      fmt::arg("max_head", kArrowMaxHead), fmt::arg("sides", kArrowSides), fmt::arg("presses", kArrowPresses),
      fmt::arg("light", light_shader()));
}

std::string swatch(std::string_view colour, std::string_view dashes) {
  return fmt::format(
      R"(<svg viewBox="0 0 28 10" aria-hidden="true"><line x1="0" y1="5" x2="28" y2="5" stroke="{}" stroke-width="2.4" )"
      R"(stroke-dasharray="{}"/></svg>)",
      colour, dashes.empty() ? "none" : dashes);
}

std::string legend(const Panel& panel) {
  std::string text;
  for (const Series& series : panel.series)
    for (const Curve& curve : series.curves) {
      const std::string name =
          series.name.empty() || curve.name.empty() ? series.name + curve.name : series.name + ": " + curve.name;
      text += fmt::format("<span class=\"key curve\">{}{} <b></b></span> ", swatch(curve.colour, curve.dashes),
                          escaped(name));
    }
  for (const Level& level : panel.levels)
    text += fmt::format("<span class=\"key\">{}{} {:.4g} {}</span> ", swatch(level.colour, "6 4"), escaped(level.name),
                        level.value, escaped(panel.unit));
  return text;
}

}  // namespace

HtmlPage::HtmlPage(std::string_view title, Kind kind) {
  text_ = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n",
      escaped(title), kStyle);
  add(kind == Kind::kFrame ? "<body class=\"frame\">\n<main>"
                           : fmt::format("<body>\n<main>\n<h1>{}</h1>", escaped(title)));
}

void HtmlPage::add(std::string_view markup) {
  text_ += markup;
  text_ += '\n';
}

void HtmlPage::heading(std::string_view words) { add(fmt::format("<h2>{}</h2>", escaped(words))); }

void HtmlPage::paragraph(std::string_view words, std::string_view css_class) {
  add(css_class.empty() ? fmt::format("<p>{}</p>", escaped(words))
                        : fmt::format("<p class=\"{}\">{}</p>", css_class, escaped(words)));
}

void HtmlPage::chart(const Panel& panel, std::string_view note) {
  SvgText svg;
  svg.add(fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" fill="{}" role="img" )"
                      R"(aria-label="{} over time">)",
                      kChartWidth, kChartHeight, kTextInk, escaped(panel.label())));
  const PanelAxes axes = svg.panel(kChartFrame, panel);
  svg.add("</svg>");
  add(fmt::format(
      "<figure class=\"chart\">\n{}<figcaption>{}<span class=\"at\"></span>{}</figcaption>\n"
      "<script type=\"application/json\">{}</script>\n</figure>",
      svg.text(), legend(panel), note.empty() ? "" : fmt::format("<br>{}", escaped(note)), json_of(panel, axes)));
}

void HtmlPage::table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows,
                     std::string_view css_class) {
  add(css_class.empty() ? "<div class=\"scroll\"><table>"
                        : fmt::format("<div class=\"scroll\"><table class=\"{}\">", css_class));
  if (!columns.empty()) {
    std::string heads;
    for (const std::string& column : columns) heads += fmt::format("<th>{}</th>", escaped(column));
    add(fmt::format("<thead><tr>{}</tr></thead>", heads));
  }
  add("<tbody>");
  for (const std::vector<std::string>& row : rows) {
    std::string cells;
    for (const std::string& cell : row)
      cells += cells.empty() ? fmt::format("<th scope=\"row\">{}</th>", escaped(cell))
                             : fmt::format("<td>{}</td>", escaped(cell));
    add(fmt::format("<tr>{}</tr>", cells));
  }
  add("</tbody>\n</table></div>");
}

// The script fills what is empty here.
void HtmlPage::viewer(const std::vector<std::string>& data) {
  if (!has_viewer_) add(fmt::format("<style>{}</style>", kViewerStyle));
  has_viewer_ = true;
  add("<figure class=\"viewer\" hidden>");
  add(kViewerMarkup);
  for (const std::string& run : data)
    add(fmt::format("<script type=\"application/json\" class=\"run\">{}</script>", run));
  add("</figure>");
}

std::string HtmlPage::finish() && {
  add(fmt::format("</main>\n<script>{}</script>", kScript));
  if (has_viewer_)
    add(fmt::format("<script>{}</script>\n<script>{}</script>\n<script>{}</script>", ink_script(), kViewerModelScript,
                    kViewerScript));
  add("</body>\n</html>");
  return std::move(text_);
}

std::string viewer_page(std::string_view title, const std::string& data) {
  HtmlPage page(title, HtmlPage::Kind::kFrame);
  page.viewer({data});
  page.paragraph("The viewer needs scripts and WebGL 2.", "lead");  // the style hides it where they are there
  return std::move(page).finish();
}

std::string data_uri(std::string_view media_type, std::string_view bytes) {
  return fmt::format("data:{};base64,{}", media_type, to_base64(bytes));
}

std::string shell_line(const std::vector<std::string>& words) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == word.npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace hexaplast::output
