#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bends and stretches ideal plastic bodies beyond yield with CalculiX.

    benchmarks/calculix/beyond_yield.py > tests/data/calculix/beyond_yield.json

cantilever: 0.2 x 0.01 x 0.02 m, clamped, E = 2.1 MPa, yield stress 2350 Pa; a dead force in -z, equal at all nodes of
the tip, `load` times that of first yield in beam theory, and released: mean deflection [m] of the tip under it and after.
block: 3 x 3 x 4 cubes of 1 m, E and yield stress as given, the faces z = 0 and z = 4 held along x and y and moved apart:
force over yield stress and original area at each stretch.
limit_moment, loop: 1 x `cells` hexahedra, length and height 1 m, E = 1000 times the yield stress, whose ends turn against
each other; moment over that of first yield in uniaxial stress, at 20 times its curvature, and in steps of .1 from 0 to 3
and to -3 (nu_P 0). A beam is .05 m wide, a plate 1 m and held along the axis of bending.
tube: a quarter, radii 1 and 2 m, .1 m thick in plane strain, `cells` x 2 `cells` hexahedra, E = 1000 times the yield
stress, nu_P = .49, under the pressure that makes it plastic up to 1.5 m in theory; radial displacement [m] of the outer
face, and residual hoop stress over the yield stress, mean of each ring of hexahedra.
C3D8I.
patch: 20 x 20 mm of the upper face of a block of 60 x 60 x 30 mm, moved up with all they hold, the lower face held: force
[N] at each height [m]. edge [m]: distance of corner nodes.
"""
import math

import numpy as np

from deck import EXACT, Mesh, body, held, loads, node_set, print_tables, solid, solve

LENGTH, WIDTH, HEIGHT, YOUNG, YIELD = 0.2, 0.01, 0.02, 2.1e6, 2350
BEAMS = [((20, 1, 8), 0.95, 0), ((20, 1, 8), 1.1, 0), ((20, 1, 8), 1.2, 0), ((20, 1, 8), 1.413, 0),
         ((40, 1, 8), 1.413, 0), ((8, 1, 6), 1.4004, 0), ((40, 2, 10), 1.413, 0.3)]
STRIPS = [(False, 1), (False, 4), (True, 1), (True, 2), (True, 4)]  # is_plate, cells
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
    loaded, released = -solve(lines)["displacements"][..., 2].mean(axis=1)
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
    return solve(lines)["total"][:, 0, 2]


def block(young, poisson_ratio, yield_stress):
    force = pulled("C3D8I", Mesh("block", (3, 3, 4), (3, 3, 4)), lambda places: places[:, 2] == 8,
                   material(young, poisson_ratio, yield_stress), [4 * (stretch - 1) for stretch in STRETCHES], 0.01)
    return {"young_modulus": young, "poisson_ratio": poisson_ratio, "yield_stress": yield_stress,
            "stretch": STRETCHES, "force": (force / (9 * yield_stress)).round(5).tolist()}


def strip(cells, is_plate, poisson_ratio, turns):
    """Moments in steps of .1 of the curvature, which goes evenly from one of the turns to the next; over those of first
    yield."""
    width = 1 if is_plate else 0.05
    mesh = Mesh("strip", (1, 1, cells), (1, width, 1))
    lines, places = body("C3D8I", mesh)
    x, y, z = (mesh.at(places) - (0.5, 0, 0.5)).T
    first_yield = 0.002  # curvature [1/m], 2 / E
    turned = np.column_stack([first_yield * x * z, np.where(is_plate | (y == 0), 0, np.nan),
                              np.where((y == 0) & (z == -0.5), 0, np.nan)])
    times = np.abs(np.diff(turns, prepend=turns[0])).cumsum()
    lines += [*node_set("HIGH", x > 0), *material(1000, poisson_ratio, 1),
              "*AMPLITUDE, NAME=CURVATURE", *(f"{time}, {turn}" for time, turn in zip(times, turns)),
              "*TIME POINTS, NAME=PRINTED, GENERATE", f"0.1, {times[-1]}, 0.1",
              "*STEP, NLGEOM, INC=10000", "*STATIC", f"0.1, {times[-1]}, 1e-6, 0.1", *EXACT,
              "*BOUNDARY, AMPLITUDE=CURVATURE", *held(turned),
              "*NODE PRINT, NSET=HIGH, TIME POINTS=PRINTED", "RF", "*END STEP"]
    return (solve(lines)["forces"][..., 0] @ z[x > 0] * 6 / width).round(5).tolist()


def tube(cells):
    def polar(i, j, k):
        angle, r = j / (2 * cells) * math.pi / 2, 1 + i / cells
        return r * np.cos(angle) * cells - i, r * np.sin(angle) * 2 * cells - j, 0 * k
    lines, places = body("C3D8I", Mesh("tube", (cells, 2 * cells, 1), (1, 1, 0.1), polar))
    across, around, _ = places.T // 2
    half = math.pi / 8 / cells  # angle
    middle = half * (2 * np.arange(2 * cells) + 1)
    pressure = (2 * math.log(1.5) + 1 - 1.5**2 / 4) / math.sqrt(3)
    faces = pressure * 2 * math.sin(half) * 0.1 / 4 * np.column_stack([np.cos(middle), np.sin(middle), 0 * middle])
    sums = np.pad(faces, [(1, 0), (0, 0)]) + np.pad(faces, [(0, 1), (0, 0)])  # of the two faces of a node
    forces = np.where(across[:, None] == 0, sums[around], 0)
    is_held = np.column_stack([around == 2 * cells, around == 0, around >= 0])
    lines += [*node_set("OUTER", (across == cells) & (around == 0)), "*BOUNDARY", *held(np.where(is_held, 0, np.nan)),
              *material(1000, 0.49, 1)]
    for factor in (1, 0):
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.05, 1, 1e-6, 0.05", *EXACT, "*CLOAD", *loads(forces, factor),
                  "*NODE PRINT, NSET=OUTER, FREQUENCY=1000", "U", "*EL PRINT, ELSET=BODY, FREQUENCY=1000", "S", "*END STEP"]
    found = solve(lines)
    xx, yy, _, xy, _, _ = np.moveaxis(found["stresses"][-1].reshape(2 * cells, cells, 8, 6), 3, 0)
    cos, sin = np.cos(middle)[:, None, None], np.sin(middle)[:, None, None]
    hoop = xx * sin**2 - 2 * xy * sin * cos + yy * cos**2
    # of the integration points, whose volumes are as their radii
    radius = 1 + (np.arange(cells)[:, None] + 0.5 + np.tile([-0.5, 0.5], 4) / math.sqrt(3)) / cells
    return {"cells": cells, "outer_displacement": found["displacements"][0, 0, 0],
            "hoop": ((hoop * radius).mean(axis=(0, 2)) / radius.mean(axis=1)).round(5).tolist()}


def patch(element, edge):
    cells = [round(side / edge) for side in BLOCK]
    near = np.array([2 * round(0.01 / edge)] * 2 + [0])
    force = pulled(element, Mesh("block", cells, BLOCK),
                   lambda places: (np.abs(places - (cells[0], cells[1], 2 * cells[2])) <= near).all(axis=1),
                   material(2000, 0.45, 160), HEIGHTS, 0.02)
    return {"element": element, "edge": edge, "height": HEIGHTS, "force": force.round(5).tolist()}


if __name__ == "__main__":
    limits = [{"is_plate": is_plate, "cells": cells, "poisson_ratio": nu, "moment": strip(cells, is_plate, nu, [0, 20])[-1]}
              for is_plate, cells in STRIPS for nu in (0, 0.3, 0.45)]
    print_tables({"cantilever": [cantilever(*beam) for beam in BEAMS], "limit_moment": limits,
                  "loop": [{"cells": cells, "moment": strip(cells, False, 0, [0, 3, -3])} for cells in (4, 8)],
                  "tube": [tube(cells) for cells in (4, 8)], "block": [block(5000, 0.45, 50)],
                  "patch": [patch(*mesh) for mesh in PATCHES]})
