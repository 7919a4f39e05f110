#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Presses a rigid ball into an elastic block with CalculiX, without friction.

    benchmarks/calculix/indentation.py > tests/data/calculix/indentation.json

A quarter of a block of 120 x 120 x 30 mm, E = 10 kPa, Poisson's ratio .3: the planes x = 0 and y = 0 are of symmetry, the
bottom is held, the sides are free. A ball with a radius of 20 mm comes down on the middle of the top. Cells grow away
from it: `across` and `up` are the places of the nodes along x or y and along z [mm], of a coarse mesh and of one with
half the edge where the ball touches. The ball is a grid of elements whose nodes lie on the sphere and are all prescribed;
contact is face to face, hard but for a penalty of `penalty` Pa/m. `law`: linear elasticity and small displacements, or
one of two laws of large strain with the same constants. `force`: on the whole ball, four times that of the quarter.
"""
import itertools

import numpy as np

from deck import Mesh, body, held, hyperelastic, print_tables, solid, solve

YOUNG, POISSON_RATIO, RADIUS, PENALTY = 1e4, 0.3, 20e-3, 1e9
FAR_ACROSS, FAR_UP = [6, 7.5, 9.5, 12.5, 17, 23.5, 33, 45, 60], [0, 10, 15.5, 19.5, 22.5, 24.5, 26]
MESHES = {"coarse": ([n for n in range(6)] + FAR_ACROSS, FAR_UP + [n for n in range(27, 31)]),
          "fine": ([n / 2 for n in range(11)] + FAR_ACROSS, FAR_UP + [n / 2 for n in range(54, 61)])}
TOOL_CELLS, TOOL_WIDTH = 40, 8e-3
CASES = [("coarse", "linear"), ("coarse", "neoHooke"), ("coarse", "stVenantKirchhoff"), ("fine", "linear"),
         ("fine", "stVenantKirchhoff")]
DEPTHS = [0.25, 0.5, 1.0]  # mm


def block(across, up):
    mesh = Mesh("block", (len(across) - 1, len(across) - 1, len(up) - 1), (1, 1, 1))
    mesh.positions = 1e-3 * np.array([(x, y, z) for z in up for y in across for x in across])
    return mesh


def force(element, across, up, law, depths):
    mesh = block(across, up)
    lines, places = body(element, mesh)
    tool = {}  # (i, j, layer): number
    lines.append("*NODE, NSET=TOOL")
    for layer, j, i in itertools.product((0, 1), range(TOOL_CELLS + 1), range(TOOL_CELLS + 1)):
        n = tool[i, j, layer] = len(places) + len(tool) + 1
        x, y = (TOOL_WIDTH * k / TOOL_CELLS for k in (i, j))
        z = 30e-3 + RADIUS - (RADIUS**2 - x**2 - y**2)**0.5 + layer * 1e-3
        lines.append(f"{n}, {x:.12g}, {y:.12g}, {z:.12g}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=BALL")
    element_number = itertools.count(len(mesh.hexahedra) + 1)
    for j, i in itertools.product(range(TOOL_CELLS), range(TOOL_CELLS)):
        corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        lines.append(", ".join(str(n) for n in [next(element_number)] +
                               [tool[a, b, layer] for layer in (0, 1) for a, b in corners]))
    # cells are numbered x fastest, then y, then z: the upper layer comes last
    per_layer = mesh.cells[0] * mesh.cells[1]
    lines += ["*SURFACE, NAME=TOP, TYPE=ELEMENT"]
    near = sum(place < 8 for place in across)
    for j, i in itertools.product(range(near), range(near)):
        lines.append(f"{per_layer * (mesh.cells[2] - 1) + mesh.cells[0] * j + i + 1}, S2")
    lines += ["*SURFACE, NAME=UNDER, TYPE=ELEMENT", "BALL, S1"]
    elastic = ["*ELASTIC", f"{YOUNG}, {POISSON_RATIO}"]
    lines += [*solid(hyperelastic(YOUNG, POISSON_RATIO) if law == "neoHooke" else elastic), *solid(elastic, "BALL"),
              "*SURFACE INTERACTION, NAME=HARD", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY:.9g}",
              "*CONTACT PAIR, INTERACTION=HARD, TYPE=SURFACE TO SURFACE", "TOP, UNDER", "*BOUNDARY"]
    is_held = (places * (1, 1, 0) == (0, 0, 1)) | (places[:, 2:] == 0)  # by the planes of symmetry, by the bottom
    lines += [*held(np.where(is_held, 0, np.nan)), "TOOL, 1, 2, 0"]
    for depth in depths:
        lines += ["*STEP, INC=200" if law == "linear" else "*STEP, NLGEOM, INC=200", "*STATIC", "0.25, 1, 1e-5, 0.5", "*BOUNDARY",
                  f"TOOL, 3, 3, {-1e-3 * depth:.9g}", "*NODE PRINT, NSET=TOOL, TOTALS=ONLY, FREQUENCY=1000", "RF",
                  "*END STEP"]
    return (-4 * solve(lines)["total"][-len(depths):, 0, 2]).round(7).tolist()


if __name__ == "__main__":
    cases = [{"element": "C3D8I", "mesh": name, "law": law, "depth": [round(1e-3 * depth, 9) for depth in DEPTHS],
              "force": force("C3D8I", *MESHES[name], law, DEPTHS)} for name, law in CASES]
    meshes = {name: {"across": across, "up": up} for name, (across, up) in MESHES.items()}
    head = {"young_modulus": YOUNG, "poisson_ratio": POISSON_RATIO, "radius": RADIUS, "penalty": PENALTY, "meshes": meshes}
    print_tables({**head, "cases": cases})
