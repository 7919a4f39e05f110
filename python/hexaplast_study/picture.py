# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of sweeps and fits: small plots of one quantity side by side, with the same axes, as SVG."""

import dataclasses
import io
import math
import os
import warnings

from .command import printable, write_whole

FIRST, SECOND, THIRD, PALE = "#2563a8", "#c2410c", "#3f7a1f", "#a5adb8"
# whatever the user's own style is; the same file each time
STYLE = ["default", {
    "svg.fonttype": "none", "svg.hashsalt": "hexaplast", "text.parse_math": False, "text.color": "#22222a", "font.size": 9,
    "axes.titlesize": 9, "figure.titlesize": 10, "legend.fontsize": 10,
    "axes.formatter.useoffset": False, "axes.grid": True, "axes.axisbelow": True, "axes.edgecolor": "#8a8f98",
    "grid.color": "#e3e5e8", "xtick.color": "#8a8f98", "ytick.color": "#8a8f98", "xtick.labelcolor": "#22222a",
    "ytick.labelcolor": "#22222a", "xtick.minor.size": 0, "lines.linewidth": 1.4, "lines.markersize": 4}]
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


def _layout(count):
    """Columns, and width and height of a plot [inches]: one alone is large, many are small."""
    return (1, 6.5, 3.6) if count == 1 else (count, 3.1, 2.6) if count <= 3 else (4, 2.6, 2)


def _draw_row(part, row, width, height):
    """Returns the lines by their names. width, height: of the part [inches]"""
    count, lines = len(row.plots), {}
    columns, *_ = _layout(count)
    place = {"left": 0.75 / width, "right": 1 - 0.15 / width, "bottom": 0.55 / height, "top": 1 - 0.25 / height,
             "wspace": 0.1, "hspace": 0.3}
    all_axes = part.subplots(-(-count // columns), columns, sharex=True, sharey=True, squeeze=False, gridspec_kw=place).ravel()
    for axes, plot in zip(all_axes, row.plots):
        axes.set_title(printable(plot.title))
        for curve in plot.curves:
            lines[curve.name], = axes.plot(plot.x, curve.values, linestyle="-" if curve.has_line else "none",
                                           marker="o" if curve.has_dots else "none", color=curve.colour)
    for axes in all_axes[count:]:
        axes.remove()
    for axes in all_axes[count - columns:count]:
        axes.tick_params(labelbottom=True)

    axes = all_axes[0]  # whose scales are those of all
    if row.plots[0].names:
        axes.set_xticks(row.plots[0].x, [printable(name) for name in row.plots[0].names])
        axes.set_xlim(-0.5, len(row.plots[0].x) - 0.5)
    elif row.is_logarithmic:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:.6g}")
    values = [value for plot in row.plots for curve in plot.curves for value in curve.values if math.isfinite(value)] or [0]
    low, high = min(values), max(values)
    if high - low < NO_SPAN:
        axes.set_ylim(low - 0.5, high + 0.5)
    elif 0 < low < high / 2:
        axes.set_ylim(bottom=0)
    part.supylabel(printable(row.quantity), x=0.1 / width, ha="left")
    part.supxlabel(printable(row.across), y=0.05 / height)
    return lines


def picture(title, rows):
    """The rows, one below the other. Curves of the same name are in the legend once."""
    import matplotlib.style
    from matplotlib.figure import Figure

    layouts = [_layout(len(row.plots)) for row in rows]
    width = max(columns * width for columns, width, _ in layouts)
    heights = [-(-len(row.plots) // columns) * height + 0.4 for row, (columns, _, height) in zip(rows, layouts)]
    with matplotlib.style.context(STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # text stays text: the reader's fonts have it
        page = Figure((width, 0.8 + sum(heights)))
        top, *parts = page.subfigures(1 + len(rows), 1, height_ratios=[0.8, *heights])
        lines = {}
        for part, row, height in zip(parts, rows, heights):
            lines |= _draw_row(part, row, width, height)
        top.suptitle(printable(title), x=0.1 / width, y=0.85, ha="left", size=14, weight="bold")
        top.legend(lines.values(), lines, loc="lower left", ncol=len(lines), frameon=False)
        svg = io.StringIO()
        page.savefig(svg, format="svg", metadata={"Creator": None, "Date": None})
    return svg.getvalue()


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
    write_whole(file, picture(directory.plan["title"], rows))
    return None
