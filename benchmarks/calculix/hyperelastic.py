#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Strains hyperelastic bodies far with CalculiX.

    benchmarks/calculix/hyperelastic.py > tests/data/calculix/hyperelastic.json

E = 5000 Pa. neo-Hooke: C10 = mu / 2, Mooney-Rivlin: C10 = .8 mu / 2, C01 = .2 mu / 2, both D1 = 2 / K; ccx splits
volume from shape: W = C10 (I1 J^-2/3 - 3) + C01 (I2 J^-4/3 - 3) + (J - 1)^2 / D1. St. Venant-Kirchhoff: *ELASTIC with
NLGEOM. C3D8I unless the element is given.

uniaxial: one cube stretched along x, free to contract; stress: nominal, over E; volume over original volume.
shear: one cube, x += shear z; stress: nominal, over mu.
block: 4 x 4 x 4 cubes, the faces x = 0 and x = 1 held along y and z and moved apart; force over E and original area.
cantilever: 1 x 0.1 x 0.1 m, clamped, a dead force in z even over the tip's face; deflection over length.
"""
import itertools

import numpy as np

import deck
from locking import LENGTH, YOUNG, beam, tip_deflection

STRETCHES = [0.5, 0.8, 0.95, 1.05, 1.2, 1.5, 2.0]
SHEARS = [0.3, 1.0]


def material(law, poisson_ratio):
    if law == "stVenantKirchhoff":
        return ["*ELASTIC", f"{YOUNG}, {poisson_ratio}"]
    return deck.hyperelastic(YOUNG, poisson_ratio, 0.2 if law == "mooneyRivlin" else 0)


def step(increment):
    return ["*STEP, NLGEOM, INC=1000", "*STATIC", f"{increment}, 1, 1e-5, {increment}", *deck.EXACT]


def unit_cube(element, count, law, poisson_ratio, prescribe):
    """Force on the nodes that are moved, and volume ratio, of a cube of 1 m of count^3 cells. `prescribe` gives for
    positions (nodes, 3) their displacements [m]; NaN: free."""
    mesh = deck.Mesh("cube", (count, count, count), (1, 1, 1))
    lines, _ = deck.body(element, mesh)
    prescribed = prescribe(mesh.positions)
    lines += [*deck.node_set("MOVED", np.nan_to_num(prescribed).any(axis=1)), *deck.solid(material(law, poisson_ratio)),
              *step(0.05), "*BOUNDARY", *deck.held(prescribed),
              "*NODE PRINT, NSET=ALL", "U", "*NODE PRINT, NSET=MOVED, TOTALS=ONLY", "RF", "*END STEP"]
    found = deck.solve(lines)
    return found["total"][-1, 0], mesh.volume_ratio(found["displacements"][-1])


def ends_moved_apart(stretch):
    return lambda x: np.where(np.isin(x[:, :1], (0, 1)), (stretch - 1) * x * (1, 0, 0), np.nan)


def symmetric_pull(stretch):
    """The planes through the origin are glided along."""
    def prescribe(x):
        held = np.where(x == 0, 0, np.nan)
        held[x[:, 0] == 1, 0] = stretch - 1
        return held
    return prescribe


def simple_shear(shear):
    return lambda x: shear * x[:, 2:] * (1, 0, 0)


def uniaxial(law, poisson_ratio):
    runs = [unit_cube("C3D8I", 1, law, poisson_ratio, symmetric_pull(stretch)) for stretch in STRETCHES]
    return {"stretch": STRETCHES, "stress": [round(force[0] / YOUNG, 6) for force, _ in runs],
            "volume_ratio": [round(ratio, 6) for _, ratio in runs]}


def sheared(law, poisson_ratio):
    modulus = YOUNG / (2 * (1 + poisson_ratio))
    runs = [unit_cube("C3D8I", 1, law, poisson_ratio, simple_shear(shear)) for shear in SHEARS]
    return {"shear": SHEARS, "stress": [round(force[0] / modulus, 6) for force, _ in runs]}


def block(element, law, poisson_ratio, stretch):
    force, ratio = unit_cube(element, 4, law, poisson_ratio, ends_moved_apart(stretch))
    return {"stretch": stretch, "force": round(force[0] / YOUNG, 6), "volume_ratio": round(ratio, 6)}


def cantilever(element, law, poisson_ratio, across, force):
    mesh = beam("beam", (10 * across, across, across))
    deflection = tip_deflection(element, mesh, force, material(law, poisson_ratio), step(0.05))
    return {"cells": mesh.cells, "force": force, "deflection": round(deflection / LENGTH, 6)}


if __name__ == "__main__":
    table = {"uniaxial": [], "shear": [], "block": [], "cantilever": []}
    for law, nu in itertools.product(["neoHooke", "mooneyRivlin"], [0.45, 0.49]):
        case = {"law": law, "poisson_ratio": nu}
        table["uniaxial"].append({**case, **uniaxial(law, nu)})
        table["shear"].append({**case, **sheared(law, nu)})
        for element, stretch in itertools.product(["C3D8", "C3D8I"], [1.5, 0.6]):
            table["block"].append({**case, "element": element, **block(element, law, nu, stretch)})
    for (across, force), law, element, nu in itertools.product(
            [(2, 0.0875), (1, 0.35)], ["stVenantKirchhoff", "neoHooke"], ["C3D8", "C3D8I"], [0.3, 0.45, 0.49]):
        table["cantilever"].append({"law": law, "poisson_ratio": nu, "element": element,
                                    **cantilever(element, law, nu, across, force)})
    deck.print_tables(table)
