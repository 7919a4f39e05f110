# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fig. 6: twisted bars of high, medium and low plasticity under the three ways to keep a rotation."""
import numpy as np

from bar import bar, corner_jacobians, jaggedness, run, slice_twists
from fig5 import LEVELS
from picture import END, SIDE, Page
from report import RESULTS, write_table

MODES = ("objective", "vertex", "centre")
# end-to-end twist [degrees] of an independent prototype in Python
PROTOTYPE = {"objective": (110.5, 29.2, 4.5), "vertex": (18.0, 4.4, 0.93), "centre": (23.2, 5.4, 0.93)}


def make():
    grid = bar()
    faces, owner = grid.boundary_faces()
    rest = corner_jacobians(grid, grid.positions)[0]
    cases = [(level, mode) for level in LEVELS for mode in MODES]
    runs = {case: run(f"fig6/{case[0]}_{case[1]}", f"bar_twist_{case[0]}",
                      [f"bar/material.rotationPlasticity={case[1]}"]) for case in cases}
    slices = {case: slice_twists(grid, runs[case].material) for case in cases}
    greatest = max(np.abs(values).max() for values in slices.values())

    page = Page(15, greatest)
    for column, mode in enumerate(MODES):
        page.text((1.7 * column - 0.5, 0.35), mode, weight="bold")
        for row, level in enumerate(LEVELS):
            case = level, mode
            x, y = 1.7 * column, -0.6 * row
            page.panel((x - 0.5, y + 0.24), f"{level}: {slices[case].sum():.1f}°")
            values = np.abs(slices[case])[owner // 9]
            page.draw(runs[case].material, faces, values, SIDE, (x, y))
            page.draw(runs[case].material, faces, values, END, (x + 0.8, y))
    page.save(RESULTS / "fig6.png", "twist of the slice [°]")

    rows = []
    for level, mode in cases:
        this = runs[level, mode]
        determinant, scaled = corner_jacobians(grid, this.material)
        volume = this.history["plastic_rest_volume_ratio"] - 1
        rows.append([level, mode, f"{slices[level, mode].sum():.2f}",
                     f"{PROTOTYPE[mode][LEVELS.index(level)]:g}",
                     *(f"{value:.2f}" for value in slices[level, mode][5:]),
                     f"{(determinant / rest).min():.3f}", f"{scaled.min():.3f}",
                     f"{100 * jaggedness(grid, this):.3f}", f"{100 * volume[-1]:+.4f}",
                     f"{100 * np.abs(volume).max():.3f}"])
    write_table("fig6", ["plasticity", "mode", "twist deg", "prototype deg",
                         *(f"slice {k} deg" for k in range(6, 11)), "min det J ratio",
                         "min scaled Jacobian", "jaggedness % of h", "volume error at the end %",
                         "largest at any time %"], rows)
