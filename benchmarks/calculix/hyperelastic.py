#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Strains hyperelastic bodies far with CalculiX. ccx must be installed.

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
import json
import math

from locking import LENGTH, YOUNG, Mesh, body, solve, tip_deflection

STRETCHES = [0.5, 0.8, 0.95, 1.05, 1.2, 1.5, 2.0]
SHEARS = [0.3, 1.0]


def material(law, poisson_ratio):
    shear = YOUNG / (2 * (1 + poisson_ratio))
    compressibility = 6 * (1 - 2 * poisson_ratio) / YOUNG  # D1
    if law == "neoHooke":
        return ["*HYPERELASTIC, NEO HOOKE", f"{shear / 2:.12g}, {compressibility:.12g}"]
    if law == "mooneyRivlin":
        return ["*HYPERELASTIC, MOONEY-RIVLIN", f"{0.4 * shear:.12g}, {0.1 * shear:.12g}, {compressibility:.12g}"]
    return ["*ELASTIC", f"{YOUNG}, {poisson_ratio}"]


def step(increment):
    """Far tighter than ccx's own tolerances of half a percent of the forces and one of the displacements."""
    return ["*STEP, NLGEOM, INC=1000", "*STATIC", f"{increment}, 1, 1e-5, {increment}",
            "*CONTROLS, PARAMETERS=FIELD", "1e-6, 1e-6, , , 1e-6"]


def cell_volume(corners):
    """Exact, by 2 x 2 x 2 Gauss points. `corners` gives the world position of corner (a, b, c), each -1 or 1."""
    total = 0
    for point in itertools.product((-3**-0.5, 3**-0.5), repeat=3):
        jacobian = []  # rows: slopes along the cell's axes
        for axis in range(3):
            slope = [0.0, 0.0, 0.0]
            for sign, x in corners.items():
                weight = math.prod(sign[n] if n == axis else 1 + sign[n] * point[n] for n in range(3)) / 8
                slope = [s + weight * value for s, value in zip(slope, x)]
            jacobian.append(slope)
        a, b, c = jacobian
        total += sum(a[n] * (b[n - 2] * c[n - 1] - b[n - 1] * c[n - 2]) for n in range(3))
    return total


def volume(mesh, displacements):
    total = 0
    for at in itertools.product(*(range(n) for n in mesh.cells)):
        corners = {}
        for sign in itertools.product((-1, 1), repeat=3):
            node = tuple(n + (s + 1) // 2 for n, s in zip(at, sign))
            corners[sign] = [x + u for x, u in zip(mesh.positions[node], displacements[node])]
        total += cell_volume(corners)
    return total


def unit_cube(element, count, law, poisson_ratio, prescribe):
    """Force on the nodes that are moved, and volume ratio, of a cube of 1 m of count^3 cells. `prescribe` gives for a
    node's position its prescribed displacements [m] by axis."""
    mesh = Mesh("cube", (count, count, count), size=(1, 1, 1))
    lines, number = body(element, mesh)
    prescribed = {n: prescribe(mesh.position(place)) for place, n in number.items()}
    lines += ["*NSET, NSET=MOVED"] + [f"{n}," for n, values in prescribed.items() if any(values.values())]
    lines += ["*MATERIAL, NAME=SOLID"] + material(law, poisson_ratio)
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"] + step(0.05) + ["*BOUNDARY"]
    lines += [f"{n}, {axis + 1}, {axis + 1}, {value:.9g}"
              for n, values in prescribed.items() for axis, value in values.items()]
    lines += ["*NODE PRINT, NSET=ALL", "U", "*NODE PRINT, NSET=MOVED, TOTALS=ONLY", "RF", "*END STEP"]
    displacements, force = {}, None
    for row in solve(lines):  # the last increment comes last
        if len(row) == 4 and row[0].isdigit():
            displacements[int(row[0])] = [float(word) for word in row[1:]]
        elif len(row) == 3:
            force = [float(word) for word in row]
    return force, volume(mesh, {tuple(n // 2 for n in place): displacements[n] for place, n in number.items()})


def ends_moved_apart(stretch):
    return lambda x: {0: (stretch - 1) * x[0], 1: 0.0, 2: 0.0} if x[0] in (0, 1) else {}


def symmetric_pull(stretch):
    """The planes through the origin are glided along."""
    def prescribe(x):
        along = {0: (stretch - 1) * x[0]} if x[0] in (0, 1) else {}
        return along | {axis: 0.0 for axis in (1, 2) if x[axis] == 0}
    return prescribe


def simple_shear(shear):
    return lambda x: {0: shear * x[2], 1: 0.0, 2: 0.0}


def uniaxial(law, poisson_ratio):
    runs = [unit_cube("C3D8I", 1, law, poisson_ratio, symmetric_pull(stretch)) for stretch in STRETCHES]
    return {"stretch": STRETCHES, "stress": [round(run[0][0] / YOUNG, 6) for run in runs],
            "volume_ratio": [round(run[1], 6) for run in runs]}


def sheared(law, poisson_ratio):
    modulus = YOUNG / (2 * (1 + poisson_ratio))
    runs = [unit_cube("C3D8I", 1, law, poisson_ratio, simple_shear(shear)) for shear in SHEARS]
    return {"shear": SHEARS, "stress": [round(run[0][0] / modulus, 6) for run in runs]}


def block(element, law, poisson_ratio, stretch):
    run = unit_cube(element, 4, law, poisson_ratio, ends_moved_apart(stretch))
    return {"stretch": stretch, "force": round(run[0][0] / YOUNG, 6), "volume_ratio": round(run[1], 6)}


def cantilever(element, law, poisson_ratio, across, force):
    mesh = Mesh("beam", (10 * across, across, across))
    deflection = tip_deflection(element, mesh, force, material(law, poisson_ratio), step(0.05))
    return {"cells": mesh.cells, "force": force, "deflection": round(deflection / LENGTH, 6)}


def main():
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
    sections = []
    for name, rows in table.items():
        sections.append(f'"{name}": [\n' + ",\n".join(" " + json.dumps(row) for row in rows) + "\n]")
    print("{\n" + ",\n".join(sections) + "\n}")


if __name__ == "__main__":
    main()
