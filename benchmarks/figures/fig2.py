# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fig. 2: the bar of linear tetrahedra against that of hexahedra, stretched and twisted."""
import numpy as np

from bar import bar, run
from picture import END, SIDE, Page
from report import RESULTS, write_table
from tetrahedra import LOADS, SPLITTINGS, response, simulate

TITLES = {"hexahedra": "hexahedra", "five": "5 tetrahedra per cube", "six": "6 tetrahedra per cube",
          "mirrored": "6 tetrahedra, halves mirrored"}
QUARTER_TURN = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])  # about the axis
HALF_TURN = np.diag([1, -1, -1])  # exchanges the ends
MIRRORS = [np.diag([-1, 1, 1]), np.diag([1, 1, -1])]


def _surface(tetrahedra):
    """Triangles that one tetrahedron alone has."""
    faces = tetrahedra[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def _asymmetry(grid, x, load):
    """Greatest distance between the shape and its images under the symmetries of bar and load, by element size."""
    worst = 0
    for image in [QUARTER_TURN, HALF_TURN] + (MIRRORS if load == "stretch" else []):
        moved = np.round((grid.positions @ image.T - grid.positions[0]) / grid.size).astype(int)
        nodes = moved @ [1, 4, 16]
        worst = max(worst, np.linalg.norm(x[nodes] - x @ image.T, axis=1).max())
    return worst / grid.size[0]


def _measure(x, load):
    return response(load, x) * (100 if load == "stretch" else 1)


def make():
    grid = bar()
    page = Page(14, 1)
    rows = []
    for column, load in enumerate(LOADS):
        hexahedra = run(f"fig2/hexahedra_{load}", f"bar_{load}_high")
        cases = [("hexahedra", grid.boundary_faces()[0], hexahedra.world_at(200), hexahedra.material, 1.0,
                  hexahedra.history["plastic_rest_volume_ratio"][-1])]
        for splitting in SPLITTINGS:
            nodes, *state = simulate(splitting, load)
            cases.append((splitting, _surface(nodes), *state))

        for row, (name, faces, peak, material, softness, volume) in enumerate(cases):
            left, y = 2.7 * column, -0.75 * row
            unit = "%" if load == "stretch" else "°"
            page.panel((left - 1, y + 0.33), f"{TITLES[name]}, {load}: {_measure(material, load):.1f} {unit}")
            page.draw(material, faces, 0.12, SIDE, (left, y))
            page.draw(material, faces, 0.12, END, (left + 1.2, y))
            rows.append([load, name, f"{softness:.3f}", f"{_measure(peak, load):.1f}",
                         f"{_measure(material, load):.2f}", f"{100 * _asymmetry(grid, material, load):.3g}",
                         f"{100 * (volume - 1):+.3f}"])
    page.save(RESULTS / "fig2.png")

    write_table("fig2", ["load", "elements", "elastic response / that of hexahedra", "under load (%, deg)",
                         "permanent (%, deg)", "asymmetry of the permanent shape, % of h", "volume error %"],
                rows)
