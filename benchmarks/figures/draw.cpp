// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_draw PICTURE.json FILE.png: renders a drawing that the scripts of this folder made, with the renderer and
// the colour scale of `hexaplast run`.
//
//   width, height   [pixels]
//   triangles       rows of 11: three corners (x, y, depth), value in [0, 1] on the colour scale, brightness
//   lines           rows of 8: two ends (x, y, depth), width [pixels], grey in [0, 1]
//   texts           objects: x, y, size, align (left, centre, right), bold, words
//
// x runs to the right and y downwards from the upper left corner [pixels]; the smaller depth in [0, 1] is nearer.
#include <array>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "picture/colour_map.hpp"
#include "picture/png_file.hpp"
#include "picture/renderer.hpp"

namespace {

using hexaplast::output::Colour;
using hexaplast::output::Drawing;

constexpr Colour kInk{0.13f, 0.13f, 0.15f};

Drawing::Vertex vertex(const float* at, const Colour& colour) { return {at[0], at[1], at[2], colour}; }

Drawing::Align align_of(const std::string& word) {
  if (word == "left") return Drawing::Align::kLeft;
  if (word == "right") return Drawing::Align::kRight;
  if (word == "centre") return Drawing::Align::kCentre;
  throw std::invalid_argument("align is '" + word + "': must be left, centre or right");
}

Drawing read_drawing(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  const nlohmann::json picture = nlohmann::json::parse(in);

  Drawing drawing;
  drawing.width = picture.at("width");
  drawing.height = picture.at("height");
  for (const std::array<float, 11> row : picture.at("triangles")) {
    const Colour full = hexaplast::output::colour_of(row[9]);
    const Colour colour{row[10] * full.red, row[10] * full.green, row[10] * full.blue};
    drawing.triangles.push_back({{vertex(&row[0], colour), vertex(&row[3], colour), vertex(&row[6], colour)}});
  }
  for (const std::array<float, 8> row : picture.at("lines")) {
    const Colour grey{row[7], row[7], row[7]};
    drawing.lines.push_back({vertex(&row[0], grey), vertex(&row[3], grey), row[6]});
  }
  for (const nlohmann::json& text : picture.at("texts"))
    drawing.texts.push_back({.x = text.at("x"),
                             .y = text.at("y"),
                             .size = text.at("size"),
                             .align = align_of(text.at("align")),
                             .bold = text.at("bold"),
                             .colour = kInk,
                             .words = text.at("words")});
  return drawing;
}

}  // namespace

int main(int num_arguments, char** arguments) {
  if (num_arguments != 3) {
    std::cerr << "usage: hexaplast_draw PICTURE.json FILE.png\n";
    return 2;
  }
  try {
    const Drawing drawing = read_drawing(arguments[1]);
    hexaplast::output::write_png(arguments[2], hexaplast::output::load_renderer()->render(drawing));
  } catch (const std::exception& error) {
    std::cerr << "hexaplast_draw: error: " << error.what() << '\n';
    return 5;
  }
  return 0;
}
