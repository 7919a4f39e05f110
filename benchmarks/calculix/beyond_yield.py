#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bends and stretches ideal plastic bodies beyond yield with CalculiX.

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

import numpy as np

from deck import EXACT, Mesh, body, node_set, rows, solid, solve

LENGTH, WIDTH, HEIGHT, YOUNG, YIELD = 0.2, 0.01, 0.02, 2.1e6, 2350
BEAMS = [((20, 1, 8), 0.95, 0), ((20, 1, 8), 1.1, 0), ((20, 1, 8), 1.2, 0), ((20, 1, 8), 1.413, 0),
         ((40, 1, 8), 1.413, 0), ((8, 1, 6), 1.4004, 0), ((40, 2, 10), 1.413, 0.3)]
STRETCHES = [1.1, 1.2, 1.3]
BLOCK = (0.06, 0.06, 0.03)
HEIGHTS = [0.002, 0.004, 0.006, 0.008, 0.01, 0.012]
PATCHES = [("C3D20R", 0.01), ("C3D8I", 0.01), ("C3D8I", 0.005)]


def material(young, poisson_ratio, yield_stress):
    return solid(["*ELASTIC", f"{young}, {poisson_ratio}", "*PLASTIC", f"{yield_stress}, 0"])


def cantilever(cells, load, poisson_ratio):
    lines, places = body("C3D8I", Mesh("beam", cells, (LENGTH, WIDTH, HEIGHT)))
    tip = places[:, 0] == 2 * cells[0]
    force = load * YIELD * WIDTH * HEIGHT**2 / 6 / LENGTH
    lines += [*node_set("WALL", places[:, 0] == 0), *node_set("TIP", tip), "*BOUNDARY", "WALL, 1, 3",
              *material(YOUNG, poisson_ratio, YIELD)]
    for factor in (-1, 0):
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.1, 1, 1e-5, 0.1", *EXACT, "*CLOAD",
                  f"TIP, 3, {factor * force / tip.sum():.12g}", "*NODE PRINT, NSET=TIP, FREQUENCY=1000", "U", "*END STEP"]
    loaded, released = -solve(lines)[0][..., 2].mean(axis=1)
    return {"cells": cells, "load": load, "poisson_ratio": poisson_ratio, "loaded": round(loaded, 8),
            "released": round(released, 8)}


def pulled(element, mesh, is_high, card, heights, increment):
    """Forces [N] on the upper nodes at each height, of a body that is held below."""
    lines, places = body(element, mesh)
    lines += [*node_set("LOW", places[:, 2] == 0), *node_set("HIGH", is_high(places)), *card]
    for height in heights:
        lines += ["*STEP, NLGEOM, INC=10000", "*STATIC", f"{increment}, 1, 1e-6, {increment}", *EXACT,
                  "*BOUNDARY", "LOW, 1, 3", "HIGH, 1, 2", f"HIGH, 3, 3, {height:.9g}",
                  "*NODE PRINT, NSET=HIGH, TOTALS=ONLY, FREQUENCY=10000", "RF", "*END STEP"]
    return solve(lines)[1][:, 2]


def block(young, poisson_ratio, yield_stress):
    force = pulled("C3D8I", Mesh("block", (3, 3, 4), (3, 3, 4)), lambda places: places[:, 2] == 8,
                   material(young, poisson_ratio, yield_stress), [4 * (stretch - 1) for stretch in STRETCHES], 0.01)
    return {"young_modulus": young, "poisson_ratio": poisson_ratio, "yield_stress": yield_stress,
            "stretch": STRETCHES, "force": (force / (9 * yield_stress)).round(5).tolist()}


def patch(element, edge):
    cells = [round(side / edge) for side in BLOCK]
    near = np.array([2 * round(0.01 / edge)] * 2 + [0])
    force = pulled(element, Mesh("block", cells, BLOCK),
                   lambda places: (np.abs(places - (cells[0], cells[1], 2 * cells[2])) <= near).all(axis=1),
                   material(2000, 0.45, 160), HEIGHTS, 0.02)
    return {"element": element, "edge": edge, "height": HEIGHTS, "force": force.round(5).tolist()}


if __name__ == "__main__":
    print(f'{{\n"cantilever": {rows(cantilever(*beam) for beam in BEAMS)},\n"block": {json.dumps(block(5000, 0.45, 50))},\n'
          f'"patch": {rows(patch(*mesh) for mesh in PATCHES)}\n}}')
