# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fig. 5: stretched bars of high, medium and low plasticity, side and end views of the final rest shape."""
import numpy as np

from bar import bar, elongation, run, slice_elongations
from picture import END, SIDE, Page
from report import RESULTS, write_table

LEVELS = ("high", "medium", "low")


def make():
    grid = bar()
    faces, owner = grid.boundary_faces()
    runs = {level: run(f"fig5/{level}", f"bar_stretch_{level}") for level in LEVELS}
    slices = {level: slice_elongations(grid, runs[level].material) for level in LEVELS}
    greatest = max(values.max() for values in slices.values())

    page = Page(13, 100 * greatest)
    for row, level in enumerate(LEVELS):
        y = -0.45 * row
        x, values = runs[level].material, 100 * slices[level][owner // 9]
        page.panel((-0.95, y + 0.18), f"{level}: {100 * elongation(grid, x):+.1f} %", weight="bold")
        page.draw(x, faces, values, SIDE, (0, y))
        page.draw(x, faces, values, END, (1.2, y))
    page.save(RESULTS / "fig5.png", "elongation of the slice [%]")

    rows = []
    for level in LEVELS:
        history = runs[level].history
        volume = history["plastic_rest_volume_ratio"] - 1
        halves = np.abs(slices[level] - slices[level][::-1]).max()
        rows.append([level, f"{100 * elongation(grid, runs[level].material):.2f}",
                     *(f"{100 * value:.2f}" for value in slices[level][5:]), f"{halves:.0e}",
                     f"{100 * volume[-1]:+.4f}", f"{100 * np.abs(volume).max():.3f}"])
    write_table("fig5", ["plasticity", "elongation %", *(f"slice {k} %" for k in range(6, 11)),
                                 "difference of the halves", "volume error at the end %", "largest at any time %"],
                        rows)
