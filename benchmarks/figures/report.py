# SPDX-License-Identifier: LGPL-2.1-or-later
"""docs/results: tables as CSV and Markdown, plots as SVG, and the page that shows them."""
import csv

import matplotlib
from matplotlib import pyplot

from bar import ROOT

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "hexaplast"})  # the same file each time

RESULTS = ROOT / "docs/results"
PAGE = RESULTS / "README.md"
HEAD = """# The paper's figures

`scripts/reproduce` writes this page; `scripts/reproduce fig5 fig6` makes only the named figures. "The paper" is that of
R. Gao and J. Peters ([theory](../theory.md)). Unless stated otherwise, shapes are those without load: the plastic rest
positions. The bar has 3 x 3 x 10 cubes with edge h = 0.1 m, E = 5000 Pa and Poisson's ratio 0.45. It is fixed in the
middle.
"""


def write_table(name, header, rows):
    """Writes <name>.csv and returns the same table as Markdown. Numbers arrive as text, formatted."""
    with open(RESULTS / f"{name}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def write_section(title, body):
    """Puts a section into the page, in place of the one with the same title; sections stay sorted."""
    sections = {}
    if PAGE.exists():
        for part in PAGE.read_text().split("\n## ")[1:]:
            name, _, text = part.partition("\n")
            sections[name] = text.strip()
    sections[title] = body.strip()
    PAGE.write_text(HEAD + "".join(f"\n## {name}\n\n{sections[name]}\n" for name in sorted(sections)))


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
