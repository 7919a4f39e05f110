# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of studies, as SVG, by the points of their curves."""
import math
import re

import matplotlib

from hexaplast_study.picture import Curve, Plot, Row, picture

RED, BLUE = "#ff0000", "#0000ff"


def lines_of(*plots, **row):
    """The curves, by their colours: what is drawn in the axes, unlike lines of the legend."""
    svg = picture("a < b", [Row("y", "x", list(plots), **row)])
    lines = {}
    for path, colour in re.findall(r'<path d="([^"]*)" clip-path[^>]*style="fill: none; stroke: (#\w+);', svg):
        parts = [[tuple(map(float, place.split())) for place in part.split("L")] for part in path.split("M") if part.strip()]
        lines[colour] = parts
    return lines


def plot(colour, x, values):
    return Plot("", x, [Curve("a", colour, values)])


def test_logarithmic_axes_show_equal_factors_as_equal_distances():
    ((a, b, c),) = lines_of(plot(RED, [1, 10, 100], [0, 1, 2]), is_logarithmic=True)[RED]
    assert abs((b[0] - a[0]) - (c[0] - b[0])) < 0.02 and a[1] > c[1]


def test_values_that_are_missing_leave_a_gap():
    assert [len(part) for part in lines_of(plot(RED, [1, 2, 3, 4, 5], [0, 1, math.nan, 3, 4]))[RED]] == [2, 2]


def test_small_plots_have_the_same_axes():
    lines = lines_of(plot(RED, [0, 1], [0, 1]), plot(BLUE, [0, 1], [0, 4]))
    (red,), (blue,) = lines[RED], lines[BLUE]
    assert abs((blue[0][1] - blue[1][1]) - 4 * (red[0][1] - red[1][1])) < 0.05 and red[0][1] == blue[0][1]


def test_words_are_places_and_a_constant_is_drawn_the_same_each_time():
    assert RED not in lines_of(Plot("", [0, 1], [Curve("a", RED, [1, 2], False, True)])), "dots alone"

    def drawn():
        return picture("$t$", [Row("y", "x", [Plot("", [0, 1], [Curve("a", RED, [2, 2 + 1e-15], False, True)],
                                                   ["first", "$second$"])])])

    svg = drawn()
    assert re.search(r">first</text>.*>\$second\$</text>.*>1.6</text>.*>2.4</text>", svg, re.DOTALL) and ">$t$</text>" in svg
    assert len(re.findall(f"<use [^>]*fill: {RED}", svg)) == 2 + 1
    with matplotlib.rc_context({"font.size": 30}):  # the user's own
        assert drawn() == svg
