# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fig. 5: stretched bars of high, medium and low plasticity, side and end views of the final rest shape."""
import numpy as np

from bar import Grid, elongation, run, slice_elongations
from picture import END, SIDE, Page
from report import RESULTS, write_section, write_table

LEVELS = ("high", "medium", "low")


def make():
    grid = Grid()
    faces, owner = grid.boundary_faces()
    runs = {level: run(f"fig5/{level}", f"bar_stretch_{level}") for level in LEVELS}
    slices = {level: slice_elongations(grid, runs[level].material) for level in LEVELS}
    greatest = max(values.max() for values in slices.values())

    scale = 500
    page = Page(1280, 820)
    for row, level in enumerate(LEVELS):
        y = 150 + 230 * row
        x = runs[level].material
        values = slices[level][owner // 9] / greatest
        page.text((40, y - 110), f"{level}: {100 * elongation(grid, x):+.1f} %", 20, bold=True)
        page.draw(x, faces, values, SIDE, (520, y), scale)
        page.draw(x, faces, values, END, (1130, y), scale)
    page.colour_bar((460, 770), 360, 100 * greatest, "elongation of the slice [%]")
    page.save(RESULTS / "fig5.png")

    rows = []
    for level in LEVELS:
        history = runs[level].history
        volume = history["plastic_rest_volume_ratio"] - 1
        halves = np.abs(slices[level] - slices[level][::-1]).max()
        rows.append([level, f"{100 * elongation(grid, runs[level].material):.2f}",
                     *(f"{100 * value:.2f}" for value in slices[level][5:]), f"{halves:.0e}",
                     f"{100 * volume[-1]:+.4f}", f"{100 * np.abs(volume).max():.3f}"])
    table = write_table("fig5", ["plasticity", "elongation %", *(f"slice {k} %" for k in range(6, 11)),
                                 "difference of the halves", "volume error at the end %", "largest at any time %"],
                        rows)
    write_section("Figure 5: stretch", f"""
![final rest shapes, side and end views](fig5.png)

The figure shows the final shapes of `scenes/bar_stretch_{{high,medium,low}}.scn` without load, from the side and from
the end. As in the paper, more plasticity gives a longer bar that is thinner towards the loaded ends, and the
cross-sections remain symmetric. Slice 6 is next to the fixed middle, slice 10 at the loaded end. The volume error is
always below 1 %, the value in the paper.

{table}
""")
