# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of sweeps and fits: small plots of one quantity side by side, with the same axes, as SVG."""

import dataclasses
import math
import os
from xml.sax.saxutils import escape

from . import command

FIRST, SECOND, THIRD, PALE = "#2563a8", "#c2410c", "#3f7a1f", "#a5adb8"
GRID, FRAME = "#e3e5e8", "#8a8f98"
LEFT, RIGHT, TOP, BOTTOM = 78, 34, 84, 24  # margins of the page [pixels]
GAP_X, GAP_Y, HEAD, FOOT = 30, 38, 34, 60  # between plots, around a row of them
MIN_WIDTH = 560
MAX_PLOTS = 64  # of a quantity: more are too small to be told apart
NO_TWIST = 0.05  # [deg] a bar that is pulled turns by less
NO_SPAN = 1e-9  # rounding: not drawn as a change


@dataclasses.dataclass
class Curve:
    name: str
    colour: str
    values: list  # NaN: a gap
    has_line: bool = True
    has_dots: bool = False


@dataclasses.dataclass
class Plot:
    """Curves over common places. names: of the places, instead of numbers."""

    title: str
    x: list
    curves: list
    names: list = None


@dataclasses.dataclass
class Row:
    quantity: str
    across: str  # label of the horizontal axis
    plots: list
    is_logarithmic: bool = False


def ticks(low, high, count):
    """Round numbers that cover an interval, about `count` of them."""
    raw = (high - low) / max(count - 1, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in (1, 2, 2.5, 5, 10) if m * power >= raw * (1 - 1e-9))
    return [k * step for k in range(math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9) + 1)]


def decades(low, high):
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    return [10.0**k for k in range(first, max(last, first + 1) + 1)]


class _Axis:
    """From numbers to pixels."""

    def __init__(self, marks, begin, end, is_logarithmic=False):
        self.marks, self._begin, self._end = marks, begin, end
        self._scale = math.log10 if is_logarithmic else float

    def __call__(self, value):
        low, high = self._scale(self.marks[0]), self._scale(self.marks[-1])
        return self._begin + (self._end - self._begin) * (self._scale(value) - low) / (high - low)


class _Svg:
    def __init__(self):
        self._parts = []

    def add(self, text):
        self._parts.append(text)

    def words(self, x, y, anchor, size, words, more=""):
        self.add(f'<text x="{x:.2f}" y="{y:.2f}" text-anchor="{anchor}" font-size="{size}"{more}>{escape(words)}</text>')

    def line(self, x1, y1, x2, y2, colour, more=""):
        self.add(f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="{colour}"{more}/>')

    def curve(self, curve, points):
        parts = [[]]
        for x, y in points:
            if math.isfinite(y):
                parts[-1].append((x, y))
            elif parts[-1]:
                parts.append([])
        for part in parts:
            if curve.has_line and len(part) > 1:
                places = " ".join(f"{x:.2f},{y:.2f}" for x, y in part)
                self.add(f'<polyline points="{places}" fill="none" stroke="{curve.colour}" stroke-width="1.8" '
                         'stroke-linejoin="round"/>')
            if curve.has_dots:
                for x, y in part:
                    self.add(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="2.6" fill="{curve.colour}"/>')

    def picture(self, width, height):
        return (f'<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" '
                f'height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}"\n'
                '     font-family="DejaVu Sans, Helvetica, Arial, sans-serif" fill="#22222a">\n'
                f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>\n' + "\n".join(self._parts) + "\n</svg>\n")


def _layout(num_plots):
    """Columns, width, height, ticks across and upwards: one plot alone is large, many are small."""
    if num_plots == 1:
        return 1, 560, 300, 6, 6
    return (num_plots, 270, 190, 4, 5) if num_plots <= 3 else (4, 210, 150, 3, 4)


def _draw_row(svg, row, top):
    """Returns the lower end."""
    columns, width, height, across, upwards = _layout(len(row.plots))
    values = [value for plot in row.plots for curve in plot.curves for value in curve.values if math.isfinite(value)] or [0]
    low, high = min(values), max(values)
    if high - low < NO_SPAN:
        low, high = low - 0.5, high + 0.5
    vertical = ticks(min(low, 0) if low > 0 and low < high / 2 else low, high, upwards)
    places = [x for plot in row.plots for x in plot.x]
    named = row.plots[0].names
    if named:
        horizontal = [-0.5, *range(len(named)), len(named) - 0.5]
    elif row.is_logarithmic:
        horizontal = decades(min(places), max(places))
    else:
        low, high = min(places), max(places)
        horizontal = ticks(low, high if high > low else low + 1, across)
    svg.words(LEFT, top, "start", 15, row.quantity)
    for number, plot in enumerate(row.plots):
        left = LEFT + number % columns * (width + GAP_X)
        upper = top + HEAD + number // columns * (height + GAP_Y)
        x = _Axis(horizontal, left, left + width, row.is_logarithmic)
        y = _Axis(vertical, upper + height, upper)
        for mark in horizontal[1:-1] if named else horizontal:
            svg.line(x(mark), upper, x(mark), upper + height, GRID)
            if number + columns >= len(row.plots):
                svg.words(x(mark), upper + height + 17, "middle", 12, named[mark] if named else f"{mark:.6g}")
        for mark in vertical:
            svg.line(left, y(mark), left + width, y(mark), GRID)
            if number % columns == 0:
                svg.words(left - 8, y(mark) + 4, "end", 12, f"{mark + 0.0:.6g}")
        svg.add(f'<rect x="{left:.2f}" y="{upper:.2f}" width="{width}" height="{height}" fill="none" stroke="{FRAME}"/>')
        for curve in plot.curves:
            svg.curve(curve, [(x(a), y(b) if math.isfinite(b) else math.nan) for a, b in zip(plot.x, curve.values)])
        svg.words(left + width / 2, upper - 8, "middle", 12, plot.title)
    rows = -(-len(row.plots) // columns)
    bottom = top + HEAD + rows * (height + GAP_Y) - GAP_Y
    svg.words(LEFT + columns * (width + GAP_X) - GAP_X, bottom + 37, "end", 13, row.across)
    return bottom


def picture(title, rows):
    """The rows, one below the other. Curves of the same name and colour are in the legend once."""
    svg, width, bottom = _Svg(), MIN_WIDTH, TOP
    for row in rows:
        bottom = _draw_row(svg, row, bottom + HEAD) + FOOT
        columns, plot_width, *_ = _layout(len(row.plots))
        width = max(width, columns * (plot_width + GAP_X) - GAP_X)
    svg.words(LEFT, 42, "start", 19, title, ' font-weight="bold"')
    x, shown = LEFT, []
    for curve in (curve for row in rows for plot in row.plots for curve in plot.curves):
        if (curve.name, curve.colour) in shown:
            continue
        shown.append((curve.name, curve.colour))
        if curve.has_line:
            svg.line(x, 67, x + 26, 67, curve.colour, ' stroke-width="2.4"')
        if curve.has_dots:
            svg.add(f'<circle cx="{x + 13:.2f}" cy="67.00" r="3.2" fill="{curve.colour}"/>')
        svg.words(x + 33, 72, "start", 13, curve.name)
        x += 54 + 7.4 * len(curve.name)
    return svg.picture(LEFT + width + RIGHT, bottom + BOTTOM)


def draw_sweep(directory):
    """sweep.svg: elongation, twist if there is any, and probes with their extremes over the first factor, in a small plot
    for every combination of the others' values. Returns a warning, or None."""
    grid = directory.grid
    along, *others = grid.factors
    file = directory.path / "sweep.svg"
    num_plots = grid.num_runs // len(along.values)
    names = directory.columns()
    quantities = [("elongation [%]", 100, {"current": "current_elongation", "plastic": "plastic_elongation"})]
    quantities.append(("twist [°]", 1, {"current": "current_twist_deg", "plastic": "plastic_twist_deg"}))
    quantities = [one for one in quantities if one[2]["current"] in names]
    if quantities and not any(abs(directory.result(run, name)) > NO_TWIST for run in directory.cases
                              for name in quantities[1][2].values()):
        quantities.pop()
    quantities += [(name.removeprefix("probe_"), 1, {"end": name, "maximum": f"max_{name}", "minimum": f"min_{name}"})
                   for name in names if name.startswith("probe_")]
    if num_plots > MAX_PLOTS or not quantities:
        if file.exists():
            os.unlink(file)
        return (f"no picture: it would have {num_plots} plots of a quantity, at most {MAX_PLOTS} are drawn" if quantities else
                "no picture: the scene measures no elongation and has no probes")
    numbers = along.numbers
    order = sorted(range(len(along.values)), key=numbers.__getitem__) if numbers else range(len(along.values))
    unit = directory.plan["units"][0]
    rows = []
    for quantity, scale, results in quantities:
        plots = []
        for first in range(1, num_plots + 1):  # the first factor changes slowest: these runs have all combinations of others
            values = grid.values(first)
            title = ", ".join(f"{one.attribute.rpartition('.')[2]} = {values[one.attribute]}" for one in others)
            curves = [Curve(name, colour, [scale * directory.result(first + k * num_plots, result) for k in order],
                            numbers is not None, True)
                      for (name, result), colour in zip(results.items(), (FIRST, SECOND, THIRD))]
            plots.append(Plot(title, [numbers[k] for k in order] if numbers else list(order), curves,
                              None if numbers else along.values))
        rows.append(Row(quantity, along.attribute + (f" [{unit}]" if unit else ""), plots,
                        along.is_logarithmic and numbers is not None))
    command.write_whole(file, picture(directory.plan["title"], rows))
    return None
