// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast::output {

/// An sRGB colour, components in [0, 1].
struct Colour {
  float red = 0, green = 0, blue = 0;

  bool operator==(const Colour&) const = default;
};

/// The colour of a fraction t of the scale's largest value (clamped to [0, 1]): from pale sand at 0 through orange and
/// red to violet at 1. Equal differences of t look equally different: the way through CIELAB is walked at constant
/// speed, and lightness falls all along it, so that the order also survives a grey print and the common colour
/// blindnesses.
Colour colour_of(double t);

/// The colour of a region by its number; 0: what is in none. Hues of neighbours are a golden angle apart.
Colour colour_of_region(int number);

}  // namespace hexaplast::output
