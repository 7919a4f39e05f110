// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "picture/camera.hpp"
#include "picture/ink.hpp"
#include "picture/quantity.hpp"
#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Which values the colours stand for.
class Scale {
 public:
  /// range: smallest and largest value; none: those that are shown, from 0 where the quantity begins there. regions:
  /// their names.
  explicit Scale(Quantity quantity, std::optional<std::pair<double, double>> range = {},
                 std::vector<std::string> regions = {});

  /// Takes in values that are going to be shown. Those that are not finite have no colour of the scale.
  void see(std::span<const float> values);

  const QuantityEntry& quantity() const { return quantity_; }
  double min() const { return min_; }
  double max() const { return max_; }
  bool is_flat() const { return !(max_ > min_); }                  ///< there is but one value, or none
  bool passes_min() const { return has_seen_ && lowest_ < min_; }  ///< something shown lies below the range
  bool passes_max() const { return has_seen_ && highest_ > max_; }
  bool is_empty() const { return !has_seen_; }  ///< nothing shown has a value
  bool has_gaps() const { return has_gaps_; }   ///< something shown has none

  Colour colour(float value) const;
  std::vector<Colour> palette() const;  ///< of regions; of all else: empty

  /// A name and its colour.
  struct Name {
    std::string words;
    Colour colour;
  };
  std::vector<Name> legend() const;  ///< of the regions that were seen; of all else: empty

  /// What is written over the colours, and where there is but one value in place of them.
  std::string words() const;

 private:
  QuantityEntry quantity_;
  bool is_given_;
  double min_ = 0, max_ = 0;
  double lowest_ = 0, highest_ = 0;  // of what was seen
  bool has_seen_ = false, has_gaps_ = false;
  std::vector<std::string> regions_;
  std::set<int> seen_;  // of them, 0: what is in none
};

/// A mark and what it means.
struct Key {
  enum class Mark { kNone, kLine, kDot, kRing, kGap, kArrow, kShape };
  Mark mark;
  std::string words;
  Colour colour = kInk;                ///< of an arrow, a line or a shape
  Eigen::Vector2f direction = {1, 0};  ///< of an arrow, y downwards; not 0
};

/// An axis on the page, from the origin of the three: to where its unit vector is seen, y downwards, and its name.
struct AxisMark {
  Eigen::Vector2f tip;
  std::string_view name;
  Colour colour;
};

/// The farthest first. is_anatomical: x, y and z are named by what they run to, L(eft), P(osterior) and S(uperior).
std::array<AxisMark, 3> axis_marks(const Mat3& right_up_towards, bool is_anatomical);

/// A picture in the making, in units that make it 1280 x 720 or, where its shape is another, wider or higher: what is
/// drawn grows with the picture.
class Page {
 public:
  /// width, height: of the picture [pixels]
  Page(int width, int height);

  float width() const { return width_; }
  float height() const { return height_; }

  /// The part between title and colour bar.
  Window window() const;

  /// Height of the colour bar and what belongs to it, at the lower border.
  static float strip();

  Drawing& drawing() { return drawing_; }

  void write(float x, float y, float size, Drawing::Align align, Colour colour, std::string words);
  void add_title(std::string title, std::string remark);  ///< at the upper left and at the upper right
  void add_colour_bar(const Scale& scale);
  void add_axes(const Camera& camera, bool is_anatomical);  ///< below the remark: how x, y and z run

  /// One below the other, to the left and to the right of the colour bar.
  void add_keys(const std::vector<Key>& left, const std::vector<Key>& right = {});
  void add_ring(Drawing::Vertex centre);  ///< with a rim that sets it off from any colour

 private:
  void add_keys(const std::vector<Key>& keys, float left);
  void add_legend(const std::vector<Scale::Name>& names);
  void add_rectangle(float left, float top, float right, float bottom, Colour colour);
  void add_arrow(float x, float y, const Key& key);
  void add_dot(float x, float y);

  float unit_;  // [pixels]
  float width_, height_;
  Drawing drawing_;
};

}  // namespace hexaplast::output
