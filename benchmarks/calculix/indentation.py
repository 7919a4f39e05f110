#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Presses a rigid ball into an elastic block with CalculiX, without friction. ccx must be installed.

    benchmarks/calculix/indentation.py > tests/data/calculix/indentation.json

A quarter of a block of 120 x 120 x 30 mm, E = 10 kPa: the planes x = 0 and y = 0 are of symmetry, the bottom is held, the
sides are free. A ball with a radius of 20 mm comes down on the middle of the top. Cells grow away from it; `refinement`
is the number of parts that each edge of the coarse mesh has. The ball is a grid of stiff elements whose nodes lie on
the sphere and are all prescribed; contact is face to face, hard but for a penalty of `penalty` Pa/m. Geometry is
nonlinear. `force`: on the whole ball, four times that of the quarter. The lists `across` and `up` are the coarse mesh
[mm].
"""
import itertools
import json
import sys

from locking import Mesh, body, solve

YOUNG, RADIUS, PENALTY = 1e4, 20e-3, 1e9
ACROSS = [0, 1, 2, 3, 4, 5, 6, 7.5, 9.5, 12.5, 17, 23.5, 33, 45, 60]
UP = [0, 10, 15.5, 19.5, 22.5, 24.5, 26, 27, 28, 29, 30]
TOOL_CELLS, TOOL_WIDTH = 40, 8e-3
CASES = [("C3D8I", 2, 0.3)]
DEPTHS = [0.25, 0.5, 1.0]  # mm


def refined(places, parts):
    """In metres."""
    between = [low + (high - low) * n / parts for low, high in itertools.pairwise(places) for n in range(parts)]
    return [1e-3 * place for place in between + [places[-1]]]


def block(parts):
    axes = [refined(ACROSS, parts), refined(ACROSS, parts), refined(UP, parts)]
    mesh = Mesh("block", tuple(len(axis) - 1 for axis in axes))
    for place in mesh.positions:
        mesh.positions[place] = [axis[n] for axis, n in zip(axes, place)]
    return mesh


def force(element, parts, poisson_ratio, depths):
    mesh = block(parts)
    lines, number = body(element, mesh)
    top = 2 * mesh.cells[2]
    first = len(number) + 1
    tool = {}  # (i, j, layer): number
    lines.append("*NODE, NSET=TOOL")
    for layer, j, i in itertools.product((0, 1), range(TOOL_CELLS + 1), range(TOOL_CELLS + 1)):
        n = tool[i, j, layer] = first + len(tool)
        x, y = (TOOL_WIDTH * k / TOOL_CELLS for k in (i, j))
        z = 30e-3 + RADIUS - (RADIUS**2 - x**2 - y**2)**0.5 + layer * 1e-3
        lines.append(f"{n}, {x:.12g}, {y:.12g}, {z:.12g}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=BALL")
    element_number = itertools.count(mesh.cells[0] * mesh.cells[1] * mesh.cells[2] + 1)
    for j, i in itertools.product(range(TOOL_CELLS), range(TOOL_CELLS)):
        corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        lines.append(", ".join(str(n) for n in [next(element_number)] +
                               [tool[a, b, layer] for layer in (0, 1) for a, b in corners]))
    # cells are numbered x fastest, then y, then z: the upper layer comes last
    per_layer = mesh.cells[0] * mesh.cells[1]
    lines += ["*SURFACE, NAME=TOP, TYPE=ELEMENT"]
    near = sum(place < 8e-3 for place in refined(ACROSS, parts))
    for j, i in itertools.product(range(near), range(near)):
        lines.append(f"{per_layer * (mesh.cells[2] - 1) + mesh.cells[0] * j + i + 1}, S2")
    lines += ["*SURFACE, NAME=UNDER, TYPE=ELEMENT", "BALL, S1"]
    lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", f"{YOUNG}, {poisson_ratio}", "*SOLID SECTION, ELSET=BODY, MATERIAL=SOFT",
              "*MATERIAL, NAME=STIFF", "*ELASTIC", f"{YOUNG}, 0.3", "*SOLID SECTION, ELSET=BALL, MATERIAL=STIFF",
              "*SURFACE INTERACTION, NAME=HARD", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY:.9g}",
              "*CONTACT PAIR, INTERACTION=HARD, TYPE=SURFACE TO SURFACE", "TOP, UNDER", "*BOUNDARY"]
    for place, n in number.items():
        lines += [f"{n}, {axis + 1}, {axis + 1}, 0" for axis in (0, 1) if place[axis] == 0 or place[2] == 0]
        if place[2] == 0:
            lines.append(f"{n}, 3, 3, 0")
    lines.append("TOOL, 1, 2, 0")
    for depth in depths:
        lines += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.25, 1, 1e-5, 0.5", "*BOUNDARY",
                  f"TOOL, 3, 3, {-1e-3 * depth:.9g}", "*NODE PRINT, NSET=TOOL, TOTALS=ONLY, FREQUENCY=1000", "RF",
                  "*END STEP"]
    rows = [row for row in solve(lines) if len(row) == 3]
    return [round(-4 * float(row[2]), 7) for row in rows][-len(depths):]


def main():
    cases = []
    for element, parts, poisson_ratio in CASES:
        forces = force(element, parts, poisson_ratio, DEPTHS)
        cases.append({"element": element, "refinement": parts, "poisson_ratio": poisson_ratio,
                      "depth": [round(1e-3 * depth, 9) for depth in DEPTHS], "force": forces})
        print(cases[-1], file=sys.stderr, flush=True)
    head = {"young_modulus": YOUNG, "radius": RADIUS, "penalty": PENALTY, "across": ACROSS, "up": UP}
    print("{\n" + ",\n".join(f'"{name}": {json.dumps(value)}' for name, value in head.items()) +
          ',\n"cases": [\n' + ",\n".join(" " + json.dumps(case) for case in cases) + "\n]\n}")


if __name__ == "__main__":
    main()
