# SPDX-License-Identifier: LGPL-2.1-or-later
"""docs/results: tables as CSV and in its page, plots as SVG."""
import csv
import re

import matplotlib
from matplotlib import pyplot

from bar import ROOT

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "hexaplast"})  # the same file each time

RESULTS = ROOT / "docs/results"
PAGE = RESULTS / "README.md"


def write_table(name, header, rows):
    """Writes <name>.csv, and the table of the page that has this header, where there is one. Numbers arrive as text,
    formatted."""
    with open(RESULTS / f"{name}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])
    head, *lines = ("| " + " | ".join(line) + " |\n" for line in (header, ["---"] * len(header), *rows))
    PAGE.write_text(re.sub(re.escape(head) + r"(\|.*\n)*", lambda _: head + "".join(lines), PAGE.read_text()))


def write_plot(name, title, x_label, y_label, curves):
    """Writes <name>.svg: curves (label, x, y, style of matplotlib) over common axes that begin at 0."""
    figure, axes = pyplot.subplots(figsize=(10, 4.6), layout="constrained")
    for label, x, y, style in curves:
        axes.plot(x, y, style, label=label)
    axes.set(title=title, xlabel=x_label, ylabel=y_label)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.grid(color="0.9")
    if len(curves) > 1:
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    figure.savefig(RESULTS / f"{name}.svg", metadata={"Date": None})
    pyplot.close(figure)
