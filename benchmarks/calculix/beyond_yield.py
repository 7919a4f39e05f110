#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bends and stretches ideal plastic bodies beyond yield with CalculiX. ccx must be installed.

    benchmarks/calculix/beyond_yield.py > tests/data/calculix/beyond_yield.json

cantilever: 0.2 x 0.01 x 0.02 m, clamped, E = 2.1 MPa, yield stress 2350 Pa; a dead force in -z, equal at all nodes of
the tip, `load` times that of first yield in beam theory, and released: mean deflection [m] of the tip under it and after.
block: 3 x 3 x 4 cubes of 1 m, E and yield stress as given, the faces z = 0 and z = 4 held along x and y and moved apart:
force over yield stress and original area at each stretch.
C3D8I.
patch: 20 x 20 mm of the upper face of a block of 60 x 60 x 30 mm, moved up with all they hold, the lower face held: force
[N] at each height [m]. edge [m]: distance of corner nodes.
"""
import json

from locking import Mesh, body, solve

LENGTH, WIDTH, HEIGHT, YOUNG, YIELD = 0.2, 0.01, 0.02, 2.1e6, 2350
BEAMS = [((20, 1, 8), 0.95, 0), ((20, 1, 8), 1.1, 0), ((20, 1, 8), 1.2, 0), ((20, 1, 8), 1.413, 0),
         ((40, 1, 8), 1.413, 0), ((8, 1, 6), 1.4004, 0), ((40, 2, 10), 1.413, 0.3)]
STRETCHES = [1.1, 1.2, 1.3]
BLOCK = (0.06, 0.06, 0.03)
HEIGHTS = [0.002, 0.004, 0.006, 0.008, 0.01, 0.012]
PATCHES = [("C3D20R", 0.01), ("C3D8I", 0.01), ("C3D8I", 0.005)]
EXACT = ["*CONTROLS, PARAMETERS=FIELD", "1e-6, 1e-6, , , 1e-6"]  # ccx's own: half a percent of the forces


def material(young, poisson_ratio, yield_stress):
    return ["*MATERIAL, NAME=SOLID", "*ELASTIC", f"{young}, {poisson_ratio}", "*PLASTIC", f"{yield_stress}, 0",
            "*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"]


def cantilever(cells, load, poisson_ratio):
    lines, number = body("C3D8I", Mesh("beam", cells, size=(LENGTH, WIDTH, HEIGHT)))
    tip = [n for place, n in number.items() if place[0] == 2 * cells[0]]
    force = load * YIELD * WIDTH * HEIGHT**2 / 6 / LENGTH
    lines += ["*NSET, NSET=WALL"] + [f"{n}," for place, n in number.items() if place[0] == 0]
    lines += ["*NSET, NSET=TIP"] + [f"{n}," for n in tip]
    lines += ["*BOUNDARY", "WALL, 1, 3"] + material(YOUNG, poisson_ratio, YIELD)
    for factor in (-1, 0):
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.1, 1, 1e-5, 0.1"] + EXACT + ["*CLOAD"]
        lines += [f"TIP, 3, {factor * force / len(tip):.12g}", "*NODE PRINT, NSET=TIP, FREQUENCY=1000", "U", "*END STEP"]
    moved = [-float(row[3]) for row in solve(lines) if len(row) == 4 and row[0].isdigit()]
    under, after = moved[:len(tip)], moved[-len(tip):]
    return {"cells": cells, "load": load, "poisson_ratio": poisson_ratio,
            "loaded": round(sum(under) / len(tip), 8), "released": round(sum(after) / len(tip), 8)}


def block(young, poisson_ratio, yield_stress, increment=0.01):
    lines, number = body("C3D8I", Mesh("block", (3, 3, 4), size=(3, 3, 4)))
    lines += ["*NSET, NSET=LOW"] + [f"{n}," for place, n in number.items() if place[2] == 0]
    lines += ["*NSET, NSET=HIGH"] + [f"{n}," for place, n in number.items() if place[2] == 8]
    lines += material(young, poisson_ratio, yield_stress)
    for stretch in STRETCHES:
        lines += ["*STEP, NLGEOM, INC=10000", "*STATIC", f"{increment}, 1, 1e-6, {increment}"] + EXACT
        lines += ["*BOUNDARY", "LOW, 1, 3", "HIGH, 1, 2", f"HIGH, 3, 3, {4 * (stretch - 1):.9g}"]
        lines += ["*NODE PRINT, NSET=HIGH, TOTALS=ONLY, FREQUENCY=10000", "RF", "*END STEP"]
    forces = [float(row[2]) for row in solve(lines) if len(row) == 3]
    return {"young_modulus": young, "poisson_ratio": poisson_ratio, "yield_stress": yield_stress,
            "stretch": STRETCHES, "force": [round(force / (9 * yield_stress), 5) for force in forces]}


def patch(element, edge):
    cells = [round(side / edge) for side in BLOCK]
    lines, number = body(element, Mesh("block", cells, size=BLOCK))
    near = 2 * round(0.01 / edge)
    lines += ["*NSET, NSET=LOW"] + [f"{n}," for place, n in number.items() if place[2] == 0]
    lines += ["*NSET, NSET=HIGH"] + [f"{n}," for place, n in number.items() if place[2] == 2 * cells[2]
                                     and abs(place[0] - cells[0]) <= near and abs(place[1] - cells[1]) <= near]
    lines += material(2000, 0.45, 160)
    for height in HEIGHTS:
        lines += ["*STEP, NLGEOM, INC=10000", "*STATIC", "0.02, 1, 1e-6, 0.02"] + EXACT
        lines += ["*BOUNDARY", "LOW, 1, 3", "HIGH, 1, 2", f"HIGH, 3, 3, {height:.9g}"]
        lines += ["*NODE PRINT, NSET=HIGH, TOTALS=ONLY, FREQUENCY=10000", "RF", "*END STEP"]
    forces = [float(row[2]) for row in solve(lines) if len(row) == 3]
    return {"element": element, "edge": edge, "height": HEIGHTS, "force": [round(force, 5) for force in forces]}


def main():
    patches = ",\n".join(" " + json.dumps(patch(*mesh)) for mesh in PATCHES)
    beams = ",\n".join(" " + json.dumps(cantilever(*beam)) for beam in BEAMS)
    print(f'{{\n"cantilever": [\n{beams}\n],\n"block": {json.dumps(block(5000, 0.45, 50))},\n"patch": [\n{patches}\n]\n}}')


if __name__ == "__main__":
    main()
