// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "output/axis.hpp"
#include "output/files.hpp"

namespace hexaplast::output {
namespace {

constexpr std::size_t kMostSamples = 2000;  // more than a curve has pixels

// the page, and the four panels on it [pixels]
constexpr double kWidth = 1040, kHeight = 700;
constexpr double kPanelWidth = 400, kPanelHeight = 225;
constexpr double kLeft[] = {86, 590}, kTop[] = {104, 410};

constexpr std::string_view kPlastic = "#c2410c", kWorld = "#2563a8", kInk = "#22222a", kGrid = "#e3e5e8",
                           kFrame = "#8a8f98";

/// One curve of a panel: values over the common times.
struct Curve {
  std::string_view name;  ///< empty: not in the legend
  std::string_view colour;
  std::vector<double> values;
};

struct Panel {
  std::string_view label;  ///< quantity and unit of the vertical axis
  double least_span;       ///< smaller ranges are shown this large, so that rounding does not look like a result
  std::vector<Curve> curves;
};

std::string escaped(std::string_view words) {
  std::string text;
  for (const char c : words) {
    if (c == '&')
      text += "&amp;";
    else if (c == '<')
      text += "&lt;";
    else if (c == '>')
      text += "&gt;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      text += c;  // control characters have no place in XML
  }
  return text;
}

Ticks vertical_axis(const Panel& panel) {
  constexpr double kNoise = 1e-6;  // of the span: rounding does not turn a scale upside down
  double least = 0, most = 0;      // zero, the original shape, is always in sight
  for (const Curve& curve : panel.curves)
    for (const double value : curve.values) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
  if (most - least < panel.least_span) {
    const bool falls = -least > most + kNoise * panel.least_span;
    most = falls ? std::max(most, 0.0) : least + panel.least_span;
    least = falls ? most - panel.least_span : least;
  }
  return ticks_around(least, most, 6);
}

class Page {
 public:
  template <class... Parts>
  void add(fmt::format_string<Parts...> form, Parts&&... parts) {
    text_ += fmt::format(form, std::forward<Parts>(parts)...);
    text_ += '\n';
  }

  void words(double x, double y, std::string_view anchor, double size, std::string_view words,
             std::string_view more = "") {
    add(R"(<text x="{:.2f}" y="{:.2f}" text-anchor="{}" font-size="{}"{}>{}</text>)", x, y, anchor, size, more,
        escaped(words));
  }

  void panel(double left, double top, const Panel& panel, const std::vector<double>& times) {
    const Ticks across = ticks_within(times.front(), std::max(times.back(), times.front() + 1e-9), 5);
    const Ticks upwards = vertical_axis(panel);
    const double bottom = top + kPanelHeight;
    const auto x_of = [&](double time) {
      return left + kPanelWidth * (time - across.least) / (across.most - across.least);
    };
    const auto y_of = [&](double value) {
      return bottom - kPanelHeight * (value - upwards.least) / (upwards.most - upwards.least);
    };

    for (const double time : across.values) {
      add(R"(<line x1="{0:.2f}" y1="{1:.2f}" x2="{0:.2f}" y2="{2:.2f}" stroke="{3}"/>)", x_of(time), top, bottom,
          kGrid);
      words(x_of(time), bottom + 18, "middle", 13, across.label(time));
    }
    for (const double value : upwards.values) {
      add(R"(<line x1="{0:.2f}" y1="{1:.2f}" x2="{2:.2f}" y2="{1:.2f}" stroke="{3}"/>)", left, y_of(value),
          left + kPanelWidth, value == 0 ? kFrame : kGrid);
      words(left - 8, y_of(value) + 4.5, "end", 13, upwards.label(value));
    }
    add(R"(<rect x="{:.2f}" y="{:.2f}" width="{}" height="{}" fill="none" stroke="{}"/>)", left, top, kPanelWidth,
        kPanelHeight, kFrame);
    words(left, top - 10, "start", 14, panel.label);
    words(left + kPanelWidth, bottom + 36, "end", 13, "time [s]");

    for (const Curve& curve : panel.curves) {
      std::string points;
      for (std::size_t s = 0; s < times.size(); ++s)
        points += fmt::format("{:.2f},{:.2f} ", x_of(times[s]), y_of(curve.values[s]));
      add(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8" stroke-linejoin="round"/>)", points,
          curve.colour);
    }
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

void Plot::add(double time, const Measures& measures, int yielded) {
  last_ = {.time = time, .measures = measures, .yielded = yielded};
  if (num_added_++ % stride_ == 0) samples_.push_back(last_);
  if (samples_.size() <= kMostSamples) return;

  // keep every second one
  for (std::size_t s = 0; 2 * s < samples_.size(); ++s) samples_[s] = samples_[2 * s];
  samples_.resize((samples_.size() + 1) / 2);
  stride_ *= 2;
}

void Plot::write_svg(const std::filesystem::path& file) const {
  if (samples_.empty()) return;
  std::vector<Sample> shown = samples_;
  if (shown.back().time < last_.time) shown.push_back(last_);

  const auto values = [&](auto&& of) {
    std::vector<double> found;
    for (const Sample& sample : shown) found.push_back(of(sample));
    return found;
  };
  const std::vector<double> times = values([](const Sample& s) { return s.time; });
  const Curve stretch[] = {{"world", kWorld, values([](const Sample& s) { return 100 * s.measures.world_elongation; })},
                           {"plastic (material mesh)", kPlastic,
                            values([](const Sample& s) { return 100 * s.measures.plastic_elongation; })}};
  const Curve turn[] = {{"", kWorld, values([](const Sample& s) { return s.measures.world_twist_deg; })},
                        {"", kPlastic, values([](const Sample& s) { return s.measures.plastic_twist_deg; })}};
  const Curve volume[] = {
      {"", kWorld, values([](const Sample& s) { return 100 * (s.measures.world_volume_ratio - 1); })},
      {"", kPlastic, values([](const Sample& s) { return 100 * (s.measures.material_volume_ratio - 1); })}};
  const Curve yielded{"", kPlastic, values([](const Sample& s) { return s.yielded; })};

  Page page;
  page.add(R"(<?xml version="1.0" encoding="UTF-8"?>)");
  page.add(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}")", kWidth,
           kHeight);
  page.add(R"(     font-family="DejaVu Sans, Helvetica, Arial, sans-serif" fill="{}">)", kInk);
  page.add(R"(<rect width="{}" height="{}" fill="#ffffff"/>)", kWidth, kHeight);
  page.words(kLeft[0], 46, "start", 20, title_, R"( font-weight="bold")");

  double x = kLeft[1] + 78;
  for (const Curve& curve : stretch) {
    page.add(R"(<line x1="{:.2f}" y1="40" x2="{:.2f}" y2="40" stroke="{}" stroke-width="2.4"/>)", x, x + 30,
             curve.colour);
    page.words(x + 38, 45, "start", 14, curve.name);
    x += 122;
  }

  page.panel(kLeft[0], kTop[0], {"elongation [%]", 1, {stretch[0], stretch[1]}}, times);
  page.panel(kLeft[1], kTop[0], {"twist [°]", 1, {turn[0], turn[1]}}, times);
  page.panel(kLeft[0], kTop[1], {"volume error [%]", 0.01, {volume[0], volume[1]}}, times);
  page.panel(kLeft[1], kTop[1], {fmt::format("yielded hexahedra (of {})", num_elements_), 5, {yielded}}, times);
  page.add("</svg>");

  WholeFile out(file);
  out.write(page.text());
  out.commit();
}

}  // namespace hexaplast::output
