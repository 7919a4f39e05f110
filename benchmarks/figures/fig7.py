# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fig. 7: elongation over time of the stretched bar against CalculiX on the same mesh."""
import json

import numpy as np

from bar import ROOT, bar, elongation, run
from picture import SIDE, Page
from report import RESULTS, write_plot, write_table

REFERENCE = ROOT / "tests/data/calculix/bar_histories.json"
# Results depend on loads and stresses over E h^2 and E only: forces grow with h^2 from the reference's h = 0.01 m.
CASES = {"stretch_viscoCalib_tau50_nu5_F0.05_C3D8": (50, 5.0), "stretch_viscoCalib_tau100_nu5_F0.1_C3D8": (100, 10.0)}
PEAK = 5  # [s] end of the hold; the load then falls for a second
STEPS, EVERY = 800, 10  # of 0.01 s; a state every 0.1 s, as in the reference


def _settings(yield_stress, force):
    """Slow loading of a light body without viscosity: inertia is negligible and the bar passes through equilibria."""
    settings = ["bar/DiagonalMass1.massDensity=1", "bar/EulerImplicitSolver1.rayleighMass=1",
                "bar/EulerImplicitSolver1.rayleighStiffness=0", "RunSettings1.steps=" + str(STEPS),
                "RunSettings1.outputEvery=" + str(EVERY), "bar/material.yieldNorm=vonMises",
                f"bar/material.yieldStress={yield_stress}", "bar/material.plasticFlowRate=5"]
    for side, sign in (("Up", 1), ("Down", -1)):
        load = f"0 0 {sign * force / 4}"
        # a step reads the load at its beginning: shifted by a step, it is that of the step's end
        settings += [f"bar/pull{side}.times=-0.01 0.99 4.99 5.99",
                     f"bar/pull{side}.forces=0 0 0  {load}  {load}  0 0 0"]
    return settings


def make():
    grid = bar()
    with open(REFERENCE) as file:
        reference = json.load(file)["cases"]
    curves, rows, timing, shapes = [], [], [], []
    num_hexahedra = len(grid.hexahedra)
    for name, (yield_stress, force) in CASES.items():
        theirs = reference[name]
        ours = run(f"fig7/tau{yield_stress}", "bar_stretch_low", _settings(yield_stress, force))
        time = np.arange(EVERY, STEPS + 1, EVERY) / 100
        elongations = np.array([elongation(grid, ours.world_at(step)) for step in range(EVERY, STEPS + 1, EVERY)])
        ccx_time = np.array([point["time"] for point in theirs["time_history"]])
        ccx = np.array([point["stretch_total_mean"] - 1 for point in theirs["time_history"]])
        curves.append((f"Hexaplast, τ / E = {yield_stress / 5000:g}", time, 100 * elongations, f"C{len(rows)}"))
        curves.append((f"CalculiX C3D8, τ / E = {yield_stress / 5000:g}", ccx_time, 100 * ccx, f"C{len(rows)}--"))

        at_theirs = np.interp(ccx_time, time, elongations)
        peak = np.interp(PEAK, time, elongations), np.interp(PEAK, ccx_time, ccx)
        rows.append([f"{yield_stress / 5000:g}", *(f"{100 * value:.3f}" for value in peak),
                     f"{100 * (peak[0] / peak[1] - 1):+.1f}", f"{100 * elongations[-1]:.3f}", f"{100 * ccx[-1]:.3f}",
                     f"{100 * (elongations[-1] / ccx[-1] - 1):+.1f}", f"{100 * np.abs(at_theirs - ccx).max():.3f}",
                     f"{100 * np.abs((1 + at_theirs) / (1 + ccx) - 1).max():.3f}"])
        timing.append([f"{yield_stress / 5000:g}", f"{1000 * ours.step_ms / num_hexahedra:.0f}",
                       f"{1000 * theirs['cpu_ms_per_hex_per_increment']:.0f}",
                       f"{1000 * ours.cpu_s / num_hexahedra:.1f}",
                       f"{theirs['cpu_ms_per_hex_total']:.1f}"])
        shapes += [(f"yield stress / E = {yield_stress / 5000:g}, under load", ours.world_at(100 * PEAK)),
                   (f"yield stress / E = {yield_stress / 5000:g}, after release", ours.material)]

    write_plot("fig7", "Elongation of the bar on the same mesh", "time [s]", "elongation, mean of the end faces [%]",
               curves)
    _draw(grid, shapes)
    write_table("fig7", ["yield stress / E", "peak %", "CalculiX peak %", "difference %", "permanent %",
                                 "CalculiX permanent %", "difference permanent %",
                                 "largest difference, percentage points", "largest difference of length ratios %"],
                        rows)
    write_table("fig7_time", ["yield stress / E", "us per hexahedron and step",
                              "CalculiX: us per hexahedron and increment", "ms per hexahedron, all steps",
                              "CalculiX: ms per hexahedron, all increments"], timing)


def _draw(grid, shapes):
    """Coloured like the paper's: by deformation, here the elongation of each column of hexahedra along the axis."""
    faces, owner = grid.boundary_faces()
    values = []
    for _, x in shapes:
        at = x[grid.hexahedra][..., 2]
        values.append(100 * ((at[:, 4:].mean(axis=1) - at[:, :4].mean(axis=1)) / grid.size[2] - 1))
    page = Page(14, max(value.max() for value in values))
    for k, (title, x) in enumerate(shapes):
        place = 1.3 * (k % 2), -0.5 * (k // 2)
        page.panel((place[0] - 0.5, place[1] + 0.2), title)
        page.draw(x, faces, values[k][owner], SIDE, place)
    page.save(RESULTS / "fig7.png", "elongation of the hexahedron [%]")
