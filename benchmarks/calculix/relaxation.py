#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Lets viscoelastic bodies relax and creep with CalculiX.

    benchmarks/calculix/relaxation.py > tests/data/calculix/relaxation.json

Small strain. E = 5000 Pa and nu_P = .3 of slow deformation; branches of g times the shear modulus that relax with the
time t [s]. ccx has no Prony series, but linear creep: each branch is an element of its own at the same place.

held bar: one cube stretched along x, free to contract; stress over that of slow deformation at each time.
held shear: one cube in simple shear; likewise.
loaded bar: one cube in uniaxial stress; strain over that of slow deformation.
loaded beam: the cubes of locking.json under a force at the tip; deflection over that of Timoshenko's beam of slow
deformation. loaded thin beam: the one of locking_meshes.json that is one cell thick.
"""
import numpy as np

import deck
from hyperelastic import simple_shear, symmetric_pull
from locking import FORCE, YOUNG, beam, timoshenko, tip_load

POISSON_RATIO, BRANCHES = 0.3, {"BRANCH1": (1, 0.5), "BRANCH2": (0.5, 5)}  # g, t
SHEAR, BULK = YOUNG / 2 / (1 + POISSON_RATIO), YOUNG / 3 / (1 - 2 * POISSON_RATIO)
TIMES, INCREMENTS = [0, 0.1, 0.5, 2, 10], 50
STRAIN = 1e-3
CUBE = deck.Mesh("cube", (1, 1, 1), (1, 1, 1))


def body(element, mesh):
    return deck.body(element, mesh, ["SLOW", *BRANCHES])


def relax(lines, displacements, forces):
    """What ccx prints at each time. lines: of body()."""
    bulk = BULK - sum(2 / 3 * g * SHEAR for g, _ in BRANCHES.values())  # each branch has nu = 0, and resists volume, too
    young = 9 * bulk * SHEAR / (3 * bulk + SHEAR)
    lines += deck.solid(["*ELASTIC", f"{young:.12g}, {young / 2 / SHEAR - 1:.12g}"], "SLOW")
    for branch, (g, t) in BRANCHES.items():
        lines += deck.solid(["*ELASTIC", f"{2 * g * SHEAR:.12g}, 0", "*CREEP", f"{1 / (3 * g * SHEAR * t):.12g}, 1, 0"],
                            branch)
    printed = ["*NODE PRINT, NSET=ALL, FREQUENCY=100000", "U, RF", "*END STEP"]
    lines += ["*BOUNDARY", *deck.held(displacements), "*STEP", "*STATIC", "*CLOAD", *deck.loads(forces), *printed]
    for before, time in zip(TIMES, TIMES[1:]):
        lines += ["*STEP, INC=100000", "*VISCO, DIRECT, CETOL=1", f"{(time - before) / INCREMENTS}, {time - before}",
                  *printed]
    return deck.solve(lines)


def held_cube(prescribe, modulus):
    lines, _ = body("C3D8I", CUBE)
    displacements = prescribe(CUBE.positions)
    forces = relax(lines, displacements, 0 * CUBE.positions)["forces"]
    return forces[:, displacements[:, 0] > 0, 0].sum(axis=1) / modulus / STRAIN


def loaded_bar():
    lines, places = body("C3D8I", CUBE)
    found = relax(lines, np.where(places == 0, 0, np.nan), STRAIN * YOUNG / 4 * (places // 2 * (1, 0, 0)))
    return found["displacements"][:, -1, 0] / STRAIN


def loaded_beam(element, cells):
    mesh = beam("beam", cells)
    lines, places = body(element, mesh)
    load = tip_load(mesh, places, element.startswith("C3D20"))
    found = relax(lines, np.where(places[:, [0, 0, 0]] == 0, 0, np.nan), np.outer(load, (0, 0, FORCE)))
    return found["displacements"][..., 2] @ load / timoshenko(POISSON_RATIO)


if __name__ == "__main__":
    cases = [("held bar", "C3D8I", held_cube(symmetric_pull(1 + STRAIN), YOUNG)),
             ("held shear", "C3D8I", held_cube(simple_shear(STRAIN), SHEAR)), ("loaded bar", "C3D8I", loaded_bar()),
             *((name, element, loaded_beam(element, cells)) for element in ("C3D8I", "C3D20R")
               for name, cells in [("loaded beam", (20, 2, 2)), ("loaded thin beam", (10, 1, 1))])]
    deck.print_tables({"time": TIMES, "cases": [{"case": case, "element": element, "value": values.round(5).tolist()}
                                                for case, element, values in cases]})
