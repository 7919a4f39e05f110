# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of studies, as SVG, by the points of their curves."""
import math
import re
import xml.etree.ElementTree as ET

from hexaplast_study.picture import Curve, Plot, Row, picture


def lines_of(*plots, **row):
    """The polylines, by their colours."""
    root = ET.fromstring(picture("a < b", [Row("y", "x", list(plots), **row)]).encode())
    lines = {}
    for line in root.iter("{http://www.w3.org/2000/svg}polyline"):
        points = [tuple(map(float, point.split(","))) for point in line.get("points").split()]
        lines.setdefault(line.get("stroke"), []).append(points)
    return lines


def plot(colour, x, values):
    return Plot("", x, [Curve("a", colour, values)])


def test_logarithmic_axes_show_equal_factors_as_equal_distances():
    ((a, b, c),) = lines_of(plot("red", [1, 10, 100], [0, 1, 2]), is_logarithmic=True)["red"]
    assert abs((b[0] - a[0]) - (c[0] - b[0])) < 0.02 and a[1] > c[1]


def test_values_that_are_missing_leave_a_gap():
    lines = lines_of(plot("red", [1, 2, 3, 4, 5], [0, 1, math.nan, 3, 4]))["red"]
    assert [len(line) for line in lines] == [2, 2]


def test_small_plots_have_the_same_axes():
    lines = lines_of(plot("red", [0, 1], [0, 1]), plot("blue", [0, 1], [0, 4]))
    (red,), (blue,) = lines["red"], lines["blue"]
    assert abs((blue[0][1] - blue[1][1]) - 4 * (red[0][1] - red[1][1])) < 0.05 and red[0][1] == blue[0][1]


def test_words_are_places_and_a_constant_is_drawn():
    text = picture("t", [Row("y", "x", [Plot("", [0, 1], [Curve("a", "red", [2, 2], False, True)], ["first", "second"])])])
    assert re.search(">first</text>.*>second</text>", text, re.DOTALL) and text.count("<circle") == 2 + 1
