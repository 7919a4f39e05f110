# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fig. 8: three refinements of the stretched bar, loaded over its whole end faces."""
import numpy as np

from bar import bar, elongation, run, slice_elongations
from picture import SIDE, Page
from report import RESULTS, write_plot, write_table

REFINEMENTS = (1, 2, 3)
PEAK_STEP = 200  # the last one under load
PUBLISHED = ("bending=blended", "volumetric=sample", "recovery=none")  # the element of the paper
NODE_FORCES = {"corners": 1.75, "borders": 3.5, "inner": 7.0}  # [N] of the scene, r = 1


def _settings(r):
    settings = [f"bar/material.{word}" for word in PUBLISHED] + [f"bar/grid.n={3 * r + 1} {3 * r + 1} {10 * r + 1}"]
    for side, sign in (("Up", 1), ("Down", -1)):
        for kind, force in NODE_FORCES.items():
            load = f"0 0 {sign * force / r**2:.17g}"
            settings.append(f"bar/{kind}{side}.forces=0 0 0  {load}  {load}  0 0 0")
    return settings


def make():
    grids = {r: bar(r) for r in REFINEMENTS}
    ends = {r: run(f"fig8/refinement_{r}", "bar_stretch_face", _settings(r)) for r in REFINEMENTS}
    peaks = {r: ends[r].world_at(PEAK_STEP) for r in REFINEMENTS}
    at_peak = {r: slice_elongations(grids[r], peaks[r]) for r in REFINEMENTS}
    at_end = {r: slice_elongations(grids[r], ends[r].material) for r in REFINEMENTS}

    page = Page(15, 100 * max(values.max() for values in at_peak.values()))
    for column, title in enumerate(("original", "maximal stretch", "final plastic deformation")):
        page.text((1.55 * column, 0.25), title, ha="center", weight="bold")
    for row, r in enumerate(REFINEMENTS):
        faces, owner = grids[r].boundary_faces()
        num = len(grids[r].hexahedra)
        for column, (x, values) in enumerate([(grids[r].positions, np.zeros(10 * r)), (peaks[r], at_peak[r]),
                                              (ends[r].material, at_end[r])]):
            page.panel((1.55 * column - 0.6, 0.17 - 0.45 * row), f"{num} hexahedra" if column == 0 else "")
            page.draw(x, faces, 100 * values[owner // (9 * r * r)], SIDE, (1.55 * column, -0.45 * row))
    page.save(RESULTS / "fig8.png", "elongation of the slice [%]")

    curves = []
    for colour, r in enumerate(REFINEMENTS):
        middle = (np.arange(10 * r) + 0.5) / (10 * r)
        name = f"{len(grids[r].hexahedra)} hexahedra"
        curves.append((f"{name}, under load", middle, 100 * at_peak[r], f"C{colour}"))
        curves.append((f"{name}, after release", middle, 100 * at_end[r], f"C{colour}--"))
    write_plot("fig8_profile", "Stretch along the bar at three refinements", "place in the original bar / length [–]",
               "elongation of the slice [%]", curves)

    hexahedra = np.array([len(grids[r].hexahedra) for r in REFINEMENTS])
    step_ms = np.array([ends[r].step_ms for r in REFINEMENTS])
    iterations = np.array([ends[r].history["solver_iterations"][1:].mean() for r in REFINEMENTS])
    write_plot("fig8_time", "Time of a step on one processor", "hexahedra", "time [ms]",
               [("", hexahedra, step_ms, "C0o-")])
    print(f"fig8: time of a step grows with the power {np.polyfit(np.log(hexahedra), np.log(step_ms), 1)[0]:.2f}")

    rows = []
    for k, r in enumerate(REFINEMENTS):
        volume = np.abs(ends[r].history["plastic_rest_volume_ratio"] - 1)
        rows.append([f"{hexahedra[k]}", f"{100 * elongation(grids[r], peaks[r]):.2f}",
                     f"{100 * elongation(grids[r], ends[r].material):.2f}", f"{100 * at_end[r][-r:].mean():.2f}",
                     f"{100 * volume.max():.3f}", f"{step_ms[k]:.2f}", f"{iterations[k]:.1f}",
                     f"{1000 * step_ms[k] / hexahedra[k]:.1f}"])
    write_table("fig8", ["hexahedra", "elongation at the peak %", "permanent %",
                                 "permanent, last tenth of the bar %", "largest volume error %", "step ms",
                                 "solver iterations", "us per hexahedron"], rows)
