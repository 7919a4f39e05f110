#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bends a slender cantilever with CalculiX for Poisson's ratios up to nearly 1/2 and prints the deflection of its tip
over that of Timoshenko's beam, by element.

    benchmarks/calculix/locking.py > tests/data/calculix/locking.json
    benchmarks/calculix/locking.py --meshes > tests/data/calculix/locking_meshes.json

The beam: 1 x 0.1 x 0.1 m, E = 5000 Pa, one end clamped, a force in z even over the face of the other; linear statics.
locking.json: 20 x 2 x 2 and 40 x 4 x 4 cubes. locking_meshes.json: cells that are longer or distorted.
C3D20R has a node in the middle of every edge; with half the edge it is the answer to compare with.
"""
import argparse
import itertools
import json

import numpy as np

from deck import EDGES, Mesh, body, loads, node_set, solid, solve
from grid import CORNERS

YOUNG, LENGTH, WIDTH, FORCE = 5000.0, 1.0, 0.1, 1e-3
POISSON_RATIOS = [0.0, 0.3, 0.45, 0.49, 0.499]
ELEMENTS = ["C3D8", "C3D8I", "C3D20R"]
GAUSS = [(-0.6**0.5, 5 / 9), (0.0, 8 / 9), (0.6**0.5, 5 / 9)]


def beam(name, cells, *move):
    return Mesh(name, cells, (LENGTH, WIDTH, WIDTH), *move)


def shape(a, b, u, v, quadratic):
    """At (u, v) the shape function of the node (a, b), each -1, 0 or 1, of a face."""
    if a == 0:
        return (1 - u * u) * (1 + b * v) / 2
    if b == 0:
        return (1 + a * u) * (1 - v * v) / 2
    return (1 + a * u) * (1 + b * v) / 4 * (a * u + b * v - 1 if quadratic else 1)


def tip_load(mesh, places, quadratic=False):
    """Share of each node in a force that is even over the face of the tip."""
    number = {tuple(place): n for n, place in enumerate(places.tolist())}
    nodes = [(b - 1, c - 1) for a, b, c in [*(2 * CORNERS).tolist(), *(EDGES if quadratic else [])] if a == 2]
    load = np.zeros(len(places))
    for j, k in itertools.product(range(mesh.cells[1]), range(mesh.cells[2])):
        at = {(a, b): number[2 * mesh.cells[0], 2 * j + 1 + a, 2 * k + 1 + b] for a, b in nodes}
        corners = {(a, b): mesh.at(places[n])[1:] for (a, b), n in at.items() if a and b}
        for (u, wu), (v, wv) in itertools.product(GAUSS, GAUSS):
            du = sum(a * (1 + b * v) / 4 * p for (a, b), p in corners.items())
            dv = sum(b * (1 + a * u) / 4 * p for (a, b), p in corners.items())
            for (a, b), n in at.items():
                load[n] += wu * wv * (du[0] * dv[1] - du[1] * dv[0]) * shape(a, b, u, v, quadratic)
    return load / load.sum()


def tip_deflection(element, mesh, force, material, step):
    """Mean deflection [m] of the tip, weighted with the load."""
    lines, places = body(element, mesh)
    load = tip_load(mesh, places, element.startswith("C3D20"))
    lines += [*node_set("WALL", places[:, 0] == 0), *node_set("TIP", places[:, 0] == 2 * mesh.cells[0]),
              "*BOUNDARY", "WALL, 1, 3", *solid(material), *step, "*CLOAD", *loads(np.outer(load, (0, 0, force))),
              "*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    return load @ solve(lines)["displacements"][-1, :, 2]  # of the last increment


def timoshenko(poisson_ratio):
    """Deflection [m] of the tip."""
    area = WIDTH**2
    shear = YOUNG / (2 * (1 + poisson_ratio))
    return FORCE * LENGTH**3 / (3 * YOUNG * area**2 / 12) + FORCE * LENGTH / (5 / 6 * shear * area)


def relative_deflection(element, poisson_ratio, mesh):
    """Deflection of the tip over Timoshenko's."""
    material = ["*ELASTIC", f"{YOUNG}, {poisson_ratio}"]
    return tip_deflection(element, mesh, FORCE, material, ["*STEP", "*STATIC"]) / timoshenko(poisson_ratio)


def slanted(tangent):
    """Layers of nodes are shifted against each other, towards the plane ends by no more than half a cell per cell."""
    return lambda i, j, k: (np.minimum(tangent, np.minimum(i, 20 - i) / 2) * (k - 1), 0 * j, 0 * k)


def trapezoids(share):
    """Every other cell is wider at the bottom by twice the share of a cell, the others at the top."""
    return lambda i, j, k: (np.where((0 < i) & (i < 20), share * (-1.0)**i * (k - 1), 0), 0 * j, 0 * k)


def moved(share):
    """Every node by up to the share of a cell along every axis, but not off the beam's surface. The sequences n sqrt 2,
    n sqrt 5, n sqrt 7 without their whole parts spread evenly over 0 to 1 and repeat nothing."""
    def move(i, j, k):
        n = 1 + i + 21 * (j + 3 * k)
        return [np.where((0 < at) & (at < count), share * (2 * (n * root**0.5 % 1) - 1), 0)
                for root, at, count in zip((2, 5, 7), (i, j, k), (20, 2, 2))]
    return move


MESHES = [beam("one cell thick", (10, 1, 1)),
          beam("twice as long", (10, 2, 2)),
          beam("five times as long", (4, 2, 2)),
          beam("slanted by 27 degrees", (20, 2, 2), slanted(0.5)),
          beam("slanted by 45 degrees", (20, 2, 2), slanted(1.0)),
          beam("trapezoids", (20, 2, 2), trapezoids(0.4)),
          beam("moved by 0.15", (20, 2, 2), moved(0.15)),
          beam("moved by 0.3", (20, 2, 2), moved(0.3))]


def row(element, mesh):
    return [round(relative_deflection(element, nu, mesh), 5) for nu in POISSON_RATIOS]


def cubes_table():
    table = {"poisson_ratio": POISSON_RATIOS}
    for across, suffix in [(2, ""), (4, "_refined")]:
        for element in ELEMENTS:
            table[element + suffix] = row(element, beam("cubes", (10 * across, across, across)))
    return "{\n" + ",\n".join(f' "{name}": {json.dumps(values)}' for name, values in table.items()) + "\n}"


def meshes_table():
    blocks = []
    for mesh in MESHES:
        count = np.add(mesh.cells, 1)
        places = 2 * np.indices(count[::-1]).reshape(3, -1)[::-1].T
        load = tip_load(mesh, places).reshape(count[::-1])[..., -1]
        table = {"name": mesh.name, "cells": mesh.cells, "positions": mesh.positions.tolist(),
                 "tip_load": load.round(6).ravel().tolist()}
        table.update({element: row(element, mesh) for element in ELEMENTS})
        blocks.append(",\n".join(f'  "{name}": {json.dumps(values)}' for name, values in table.items()))
    meshes = ",\n".join(" {\n" + block + "\n }" for block in blocks)
    return f'{{\n"poisson_ratio": {json.dumps(POISSON_RATIOS)},\n"meshes": [\n{meshes}\n]\n}}'


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--meshes", action="store_true", help="the longer and distorted cells")
    print(meshes_table() if parser.parse_args().meshes else cubes_table())
