# SPDX-License-Identifier: LGPL-2.1-or-later
"""docs/results: tables as CSV and Markdown, plots as SVG, and the page that shows them."""
import csv
from dataclasses import dataclass

import numpy as np

from bar import ROOT

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


@dataclass
class Curve:
    label: str
    x: np.ndarray
    y: np.ndarray
    dashed: bool = False
    colour: str = ""


PALETTE = ["#b0413e", "#1f6f8b", "#e09f3e", "#54478c", "#4f772d", "#6b705c"]
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 440, 76, 24, 48, 58
LEGEND = 270  # beside the plot, so that it covers no curve


def _ticks(low, high):
    """About six round numbers from low to high."""
    raw = (high - low) / 6
    power = 10 ** np.floor(np.log10(raw))
    step = power * next(factor for factor in (1, 2, 2.5, 5, 10) if factor * power >= raw)
    return np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step + 0.0  # no -0


def write_plot(name, title, x_label, y_label, curves, x_end=None, marks=False):
    """Writes <name>.svg: curves over common axes that begin at 0, with dots at the points if marks; a single curve is
    named by the title."""
    xs, ys = np.concatenate([c.x for c in curves]), np.concatenate([c.y for c in curves])
    x_range, y_range = (min(0, xs.min()), x_end or xs.max()), (min(0, ys.min()), ys.max() + 0.06 * np.ptp(ys))
    page = WIDTH + (LEGEND if len(curves) > 1 else 0)

    def place(x, y):
        return (LEFT + (x - x_range[0]) / (x_range[1] - x_range[0]) * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - (y - y_range[0]) / (y_range[1] - y_range[0]) * (HEIGHT - TOP - BOTTOM))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{page}" height="{HEIGHT}" viewBox="0 0 {page} {HEIGHT}" '
           'font-family="DejaVu Sans, sans-serif" font-size="13">',
           f'<rect width="{page}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{LEFT}" y="28" font-size="16" font-weight="bold">{title}</text>']
    for tick in _ticks(*x_range):
        x, y = place(tick, y_range[0])
        out.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{y:.1f}" stroke="#e4e4e4"/>'
                   f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{tick:.4g}</text>')
    for tick in _ticks(*y_range):
        x, y = place(x_range[0], tick)
        out.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#e4e4e4"/>'
                   f'<text x="{x - 6:.1f}" y="{y + 4:.1f}" text-anchor="end">{tick:.4g}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 14}" text-anchor="middle">{x_label}</text>'
               f'<text transform="translate(18 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
               f'{y_label}</text>')
    for number, curve in enumerate(curves):
        colour = curve.colour or PALETTE[number % len(PALETTE)]
        points = [place(x, y) for x, y in zip(curve.x, curve.y)]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dash = ' stroke-dasharray="6 4"' if curve.dashed else ""
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"{dash}/>')
        if marks:
            out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"/>' for x, y in points]
        if len(curves) > 1:
            x, y = WIDTH, TOP + 18 + 22 * number
            out.append(f'<line x1="{x}" y1="{y - 4}" x2="{x + 30}" y2="{y - 4}" stroke="{colour}" '
                       f'stroke-width="2"{dash}/><text x="{x + 38}" y="{y}">{curve.label}</text>')
    (RESULTS / f"{name}.svg").write_text("\n".join(out) + "\n</svg>\n")
