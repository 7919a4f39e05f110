// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "picture/axis.hpp"

namespace hexaplast::output {
namespace {

constexpr float kPageWidth = 1280, kPageHeight = 720;  // the smallest size of a page
constexpr float kMargin = 56, kTop = 92, kBottom = 128;
constexpr float kTitleLine = 52, kTitleSize = 25;
constexpr float kTitleWidth = 0.68f, kRemarkWidth = 0.62f;  // of a letter, in parts of its size
constexpr float kBarWidth = 460, kBarHeight = 14;
constexpr float kBarFromBottom = 72;  // of its upper edge
constexpr float kBarWords = 36;       // height of what is written above it
constexpr float kKeyLine = 25;
constexpr float kKeyArrow = 24, kKeyHead = 10;  // lengths of an arrow among the keys and of its head
constexpr float kArrow = 11;                    // length of the end of a scale that is passed

constexpr float kAxisLength = 26;

constexpr int kCircle = 28;  // corners of a round mark

Drawing::Vertex on_circle(Drawing::Vertex centre, float radius, int corner) {
  const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(corner) / kCircle;
  centre.x += radius * std::cos(angle);
  centre.y += radius * std::sin(angle);
  return centre;
}

}  // namespace

Scale::Scale(Quantity quantity, std::optional<std::pair<double, double>> range, std::vector<std::string> regions)
    : quantity_(entry_of(quantity)), is_given_(range.has_value()) {
  if (quantity == Quantity::kRegion) regions_ = std::move(regions);
  if (!regions_.empty()) range = std::pair(-0.5, static_cast<double>(regions_.size()) + 0.5);
  if (range) std::tie(min_, max_) = *range;
}

void Scale::see(std::span<const float> values) {
  if (!regions_.empty()) {
    seen_.insert(values.begin(), values.end());
    return;
  }
  for (const float value : values) {
    if (!std::isfinite(value)) {
      has_gaps_ = true;
      continue;
    }
    lowest_ = has_seen_ ? std::min<double>(lowest_, value) : value;
    highest_ = has_seen_ ? std::max<double>(highest_, value) : value;
    has_seen_ = true;
  }
  if (is_given_ || !has_seen_) return;
  min_ = quantity_.from_zero ? 0 : lowest_;
  max_ = highest_;
  // values that differ by rounding alone are one value
  if (max_ - min_ <= 1e-6 * std::max(std::abs(min_), std::abs(max_))) min_ = max_;
}

Colour Scale::colour(float value) const {
  if (!std::isfinite(value)) return kNoValue;
  if (!regions_.empty()) return colour_of_region(static_cast<int>(value));
  return colour_of(is_flat() ? 0 : (value - min_) / (max_ - min_));
}

std::vector<Colour> Scale::palette() const {
  std::vector<Colour> colours;
  for (std::size_t k = 0; !regions_.empty() && k <= regions_.size(); ++k)
    colours.push_back(colour_of_region(static_cast<int>(k)));
  return colours;
}

std::vector<Scale::Name> Scale::legend() const {
  std::vector<Name> names;
  for (const int number : seen_) names.push_back({Regions::name_of(number, regions_), colour_of_region(number)});
  return names;
}

std::string Scale::words() const {
  if (!regions_.empty()) return "";
  if (!is_flat()) return fmt::format("{} [{}]", quantity_.label, quantity_.unit);
  if (is_empty()) return fmt::format("{}: none", quantity_.label);
  if (max() == 0 && quantity_.from_zero) return fmt::format("no {} in this run", quantity_.label);
  return fmt::format("{} [{}]: {:.4g} {}", quantity_.label, quantity_.unit, max(),
                     has_gaps() ? "where there is one" : "everywhere");
}

std::array<AxisMark, 3> axis_marks(const Mat3& right_up_towards, bool is_anatomical) {
  std::array<AxisMark, 3> marks;
  std::array order{0, 1, 2};
  std::ranges::sort(order, {}, [&](int axis) { return right_up_towards(2, axis); });
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = order[k];
    const auto number = static_cast<std::size_t>(axis);
    marks[k] = {
        Eigen::Vector2f(static_cast<float>(right_up_towards(0, axis)), -static_cast<float>(right_up_towards(1, axis))),
        std::string_view(is_anatomical ? "LPS" : "xyz").substr(number, 1), kAxes[number]};
  }
  return marks;
}

Page::Page(int width, int height)
    : unit_(std::min(static_cast<float>(width) / kPageWidth, static_cast<float>(height) / kPageHeight)),
      width_(static_cast<float>(width) / unit_),
      height_(static_cast<float>(height) / unit_),
      drawing_{.width = width, .height = height, .unit = unit_, .triangles = {}, .lines = {}, .texts = {}} {}

Window Page::window() const {
  return {.left = kMargin, .top = kTop, .width = width_ - 2 * kMargin, .height = height_ - kTop - kBottom};
}

float Page::strip() { return kBarFromBottom + kBarWords; }

void Page::write(float x, float y, float size, Drawing::Align align, Colour colour, std::string words) {
  drawing_.texts.push_back(
      {.x = x, .y = y, .size = size, .align = align, .bold = false, .colour = colour, .words = std::move(words)});
}

void Page::add_title(std::string title, std::string remark) {
  // as large as there is room for beside the remark
  const auto letters = [](const std::string& words) { return static_cast<float>(words.size()); };
  const float room = width_ - 3 * kMargin - kRemarkWidth * kTitleSize * letters(remark);
  const float size = std::min(kTitleSize, room / (kTitleWidth * std::max(letters(title), 1.0f)));
  write(kMargin, kTitleLine, size, Drawing::Align::kLeft, kInk, std::move(title));
  drawing_.texts.back().bold = true;
  write(width_ - kMargin, kTitleLine, kTitleSize, Drawing::Align::kRight, kInk, std::move(remark));
}

void Page::add_colour_bar(const Scale& scale) {
  const float top = height_ - kBarFromBottom, bottom = top + kBarHeight, left = (width_ - kBarWidth) / 2;
  if (!scale.palette().empty()) return add_legend(scale.legend());
  if (scale.is_flat()) {
    write(width_ / 2, (top + bottom) / 2 + 5, 17, Drawing::Align::kCentre, kInk, scale.words());
    return;
  }

  // every column has its own colour
  for (int column = 0; column < static_cast<int>(kBarWidth); ++column) {
    const Colour colour = colour_of((column + 0.5) / kBarWidth);
    const float x = left + static_cast<float>(column);
    add_rectangle(x, top, x + 1, bottom, colour);
  }
  const auto add_arrow = [&](float x, float tip, Colour colour) {
    drawing_.triangles.push_back({{{x, top, 0, colour}, {tip, (top + bottom) / 2, 0, colour}, {x, bottom, 0, colour}}});
  };
  if (scale.passes_min()) add_arrow(left - 2, left - 2 - kArrow, colour_of(0));
  if (scale.passes_max()) add_arrow(left + kBarWidth + 2, left + kBarWidth + 2 + kArrow, colour_of(1));

  write(width_ / 2, top - 12, 17, Drawing::Align::kCentre, kInk, scale.words());
  for (const auto& [value, label] : labels_of_scale(scale.min(), scale.max(), 6)) {
    const double fraction = (value - scale.min()) / (scale.max() - scale.min());
    const float x = left + kBarWidth * static_cast<float>(fraction);
    drawing_.lines.push_back({{x, bottom, 0, kInk}, {x, bottom + 6, 0, kInk}, 1.3f});
    write(x, bottom + 24, 16, Drawing::Align::kCentre, kInk, label);
  }
}

// In lines as long as a bar, which stand in the middle.
void Page::add_legend(const std::vector<Scale::Name>& names) {
  constexpr float kSize = 16, kSwatch = 22, kGap = 8, kBetween = 26, kLetter = 0.56f;
  const auto width = [&](const Scale::Name& name) {
    return kSwatch + kGap + kLetter * kSize * static_cast<float>(name.words.size());
  };
  std::vector<std::vector<Scale::Name>> lines;
  float room = 0;
  for (const Scale::Name& name : names) {
    room -= width(name) + kBetween;
    if (lines.empty() || room < 0) {
      lines.emplace_back();
      room = kBarWidth - width(name);
    }
    lines.back().push_back(name);
  }
  const float line_height = std::min(kKeyLine, (kBarFromBottom + kBarWords) / static_cast<float>(lines.size() + 1));
  float y = height_ - kBarFromBottom + kBarHeight / 2 - line_height * (static_cast<float>(lines.size()) - 1) / 2;
  for (const std::vector<Scale::Name>& line : lines) {
    float x = width_ / 2 + kBetween / 2;
    for (const Scale::Name& name : line) x -= (width(name) + kBetween) / 2;
    for (const Scale::Name& name : line) {
      add_rectangle(x, y - 6, x + kSwatch, y + 6, name.colour);
      write(x + kSwatch + kGap, y + 5, kSize, Drawing::Align::kLeft, kInk, name.words);
      x += width(name) + kBetween;
    }
    y += line_height;
  }
}

void Page::add_axes(const Camera& camera, bool is_anatomical) {
  Mat3 turned;
  turned << camera.right().cast<double>().transpose(), camera.up().cast<double>().transpose(),
      camera.towards().cast<double>().transpose();
  const Eigen::Vector2f origin(width_ - kMargin - kAxisLength, kTitleLine + kAxisLength + 30);
  for (const AxisMark& axis : axis_marks(turned, is_anatomical)) {
    const Eigen::Vector2f tip = origin + kAxisLength * axis.tip, name = origin + (kAxisLength + 11) * axis.tip;
    drawing_.lines.push_back({{origin.x(), origin.y(), 0, axis.colour}, {tip.x(), tip.y(), 0, axis.colour}, 2});
    write(name.x(), name.y() + 5, 14, Drawing::Align::kCentre, axis.colour, std::string(axis.name));
  }
}

void Page::add_keys(const std::vector<Key>& left, const std::vector<Key>& right) {
  add_keys(left, kMargin);
  add_keys(right, (width_ + kBarWidth) / 2 + kMargin);
}

void Page::add_keys(const std::vector<Key>& keys, float left) {
  float y = height_ - kBarFromBottom + kBarHeight / 2 - kKeyLine * (static_cast<float>(keys.size()) - 1) / 2;
  for (const Key& key : keys) {
    const float x = left + 16;
    switch (key.mark) {
      case Key::Mark::kNone:
        break;
      case Key::Mark::kArrow:
        add_arrow(x, y, key);
        break;
      case Key::Mark::kLine:
        drawing_.lines.push_back({{x - 16, y, 0, key.colour}, {x + 16, y, 0, key.colour}, 1.5f});
        break;
      case Key::Mark::kDot:
        add_dot(x, y);
        break;
      case Key::Mark::kRing:
        add_ring({x, y, 0, {}});
        break;
      case Key::Mark::kGap:
      case Key::Mark::kShape:
        add_rectangle(x - 16, y - 6, x + 16, y + 6, key.mark == Key::Mark::kGap ? kNoValue : key.colour);
        break;
    }
    write(left + 42, y + 5, 15, Drawing::Align::kLeft, kFaint, key.words);
    y += kKeyLine;
  }
}

void Page::add_rectangle(float left, float top, float right, float bottom, Colour colour) {
  const Drawing::Vertex a{left, top, 0, colour}, b{right, top, 0, colour}, c{right, bottom, 0, colour},
      d{left, bottom, 0, colour};
  drawing_.triangles.push_back({{a, b, c}});
  drawing_.triangles.push_back({{a, c, d}});
}

// About a place.
void Page::add_arrow(float x, float y, const Key& key) {
  const Eigen::Vector2f along = key.direction.normalized(), across(-along.y(), along.x()), middle(x, y);
  const auto vertex = [&](const Eigen::Vector2f& place) {
    return Drawing::Vertex{place.x(), place.y(), 0, key.colour};
  };
  const Eigen::Vector2f foot = middle - kKeyArrow / 2 * along, tip = middle + kKeyArrow / 2 * along,
                        neck = tip - kKeyHead * along;
  drawing_.lines.push_back({vertex(foot), vertex(neck), 2.2f});
  drawing_.triangles.push_back(
      {{vertex(tip), vertex(neck + kKeyHead / 2.6f * across), vertex(neck - kKeyHead / 2.6f * across)}});
}

void Page::add_dot(float x, float y) {
  const Drawing::Vertex centre{x, y, 0, kInk};
  for (int k = 0; k < kCircle; ++k)
    drawing_.triangles.push_back({{centre, on_circle(centre, kDotRadius, k), on_circle(centre, kDotRadius, k + 1)}});
}

void Page::add_ring(Drawing::Vertex centre) {
  // as triangles: wide lines would gape where they meet
  for (const auto& [colour, width] : {std::pair{kPaper, kRingWidth + kRimWidth}, std::pair{kSteel, kRingWidth}}) {
    centre.colour = colour;
    for (int k = 0; k < kCircle; ++k) {
      const auto inner = [&, width = width](int corner) { return on_circle(centre, kRingRadius - width / 2, corner); };
      const auto outer = [&, width = width](int corner) { return on_circle(centre, kRingRadius + width / 2, corner); };
      drawing_.triangles.push_back({{inner(k), outer(k), outer(k + 1)}});
      drawing_.triangles.push_back({{inner(k), outer(k + 1), inner(k + 1)}});
    }
  }
}

}  // namespace hexaplast::output
