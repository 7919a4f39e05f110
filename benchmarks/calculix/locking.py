#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bends a slender cantilever with CalculiX for Poisson's ratios up to nearly 1/2 and prints the deflection of its tip
over that of Timoshenko's beam, by element. ccx must be installed.

    benchmarks/calculix/locking.py > tests/data/calculix/locking.json
    benchmarks/calculix/locking.py --meshes > tests/data/calculix/locking_meshes.json

The beam: 1 x 0.1 x 0.1 m, E = 5000 Pa, one end clamped, a force in z even over the face of the other; linear statics.
locking.json: 20 x 2 x 2 and 40 x 4 x 4 cubes. locking_meshes.json: cells that are longer or distorted.
C3D20R has a node in the middle of every edge; with half the edge it is the answer to compare with.
"""
import argparse
import itertools
import json
import math
import pathlib
import subprocess
import tempfile

YOUNG, LENGTH, WIDTH, FORCE = 5000.0, 1.0, 0.1, 1e-3
POISSON_RATIOS = [0.0, 0.3, 0.45, 0.49, 0.499]
ELEMENTS = ["C3D8", "C3D8I", "C3D20R"]
# nodes of a quadratic element, in units of half an edge: corners, then the edges below, above, and upright
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
         (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
GAUSS = [(-math.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (math.sqrt(0.6), 5 / 9)]


class Mesh:
    """nx x ny x nz cells of a box with a corner at the origin; `move` displaces node (i, j, k), in cells."""

    def __init__(self, name, cells, move=lambda i, j, k: (0, 0, 0), size=(LENGTH, WIDTH, WIDTH)):
        self.name, self.cells = name, cells
        edge = [length / count for length, count in zip(size, cells)]
        self.positions = {}
        for k, j, i in itertools.product(*(range(n + 1) for n in reversed(cells))):  # x fastest, then y, then z
            # + 0.0: no negative zero
            self.positions[i, j, k] = [round((n + d) * h, 6) + 0.0
                                       for n, d, h in zip((i, j, k), move(i, j, k), edge)]

    def position(self, place):
        """Of a place in units of half a cell: the middle of an edge where one of them is odd."""
        low = self.positions[tuple(n // 2 for n in place)]
        high = self.positions[tuple((n + 1) // 2 for n in place)]
        return [(a + b) / 2 for a, b in zip(low, high)]


def shape(a, b, u, v, quadratic):
    """At (u, v) the shape function of the node (a, b), each -1, 0 or 1, of a face."""
    if a == 0:
        return (1 - u * u) * (1 + b * v) / 2
    if b == 0:
        return (1 + a * u) * (1 - v * v) / 2
    return (1 + a * u) * (1 + b * v) / 4 * (a * u + b * v - 1 if quadratic else 1)


def face_load(nodes, corners):
    """Integral of the shape function of each of the nodes (a, b) over a face with the given corners (y, z)."""
    load = {node: 0.0 for node in nodes}
    for (u, wu), (v, wv) in itertools.product(GAUSS, GAUSS):
        du = [sum(a * (1 + b * v) / 4 * p[n] for (a, b), p in corners.items()) for n in (0, 1)]
        dv = [sum(b * (1 + a * u) / 4 * p[n] for (a, b), p in corners.items()) for n in (0, 1)]
        area = wu * wv * (du[0] * dv[1] - du[1] * dv[0])
        for a, b in nodes:
            load[a, b] += area * shape(a, b, u, v, len(nodes) == 8)
    return load


def tip_load(mesh, quadratic=False):
    """Share of each place of the tip in a force that is even over its face."""
    load = {}
    nodes = [(b - 1, c - 1) for a, b, c in CORNERS + (EDGES if quadratic else []) if a == 2]
    for j, k in itertools.product(range(mesh.cells[1]), range(mesh.cells[2])):
        at = {(a, b): (2 * mesh.cells[0], 2 * j + 1 + a, 2 * k + 1 + b) for a, b in nodes}
        corners = {node: mesh.position(place)[1:] for node, place in at.items() if 0 not in node}
        for node, share in face_load(nodes, corners).items():
            load[at[node]] = load.get(at[node], 0) + share
    area = sum(load.values())
    return {place: share / area for place, share in load.items()}


def body(element, mesh):
    """Lines of a deck that tell nodes and elements, and the number of the node at each place."""
    number, hexahedra = {}, []
    for k, j, i in itertools.product(*(range(n) for n in reversed(mesh.cells))):
        # nodes are numbered as they come
        places = [(2 * i + a, 2 * j + b, 2 * k + c)
                  for a, b, c in CORNERS + (EDGES if element.startswith("C3D20") else [])]
        hexahedra.append([number.setdefault(place, len(number) + 1) for place in places])
    lines = ["*NODE, NSET=ALL"]
    for place, n in number.items():
        lines.append(f"{n}, " + ", ".join(f"{x:.9g}" for x in mesh.position(place)))
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=BODY")
    for e, nodes in enumerate(hexahedra, 1):
        words = [str(word) for word in [e] + nodes]  # a line of a deck holds 16 at most
        lines += [", ".join(words[i:i + 11]) + ("," if i + 11 < len(words) else "") for i in range(0, len(words), 11)]
    return lines, number


def solve(lines):
    """Words of every line that ccx prints for a deck."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "beam.inp").write_text("\n".join(lines) + "\n")
        subprocess.run(["ccx", "-i", "beam"], cwd=path, check=True, stdout=subprocess.DEVNULL)
        return [line.split() for line in (path / "beam.dat").read_text().splitlines()]


def tip_deflection(element, mesh, force, material, step):
    """Mean deflection [m] of the tip, weighted with the load."""
    lines, number = body(element, mesh)
    load = {number[place]: share for place, share in tip_load(mesh, element.startswith("C3D20")).items()}
    lines += ["*NSET, NSET=WALL"] + [f"{n}," for place, n in number.items() if place[0] == 0]
    lines += ["*NSET, NSET=TIP"] + [f"{n}," for n in load]
    lines += ["*BOUNDARY", "WALL, 1, 3", "*MATERIAL, NAME=SOLID"] + material
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"] + step + ["*CLOAD"]
    lines += [f"{n}, 3, {share * force:.12g}" for n, share in load.items()]
    lines += ["*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    # of the last increment
    moved = {int(row[0]): float(row[3]) for row in solve(lines) if len(row) == 4 and row[0].isdigit()}
    return sum(load[n] * moved[n] for n in load)


def relative_deflection(element, poisson_ratio, mesh):
    """Deflection of the tip over Timoshenko's."""
    area = WIDTH**2
    shear = YOUNG / (2 * (1 + poisson_ratio))
    timoshenko = FORCE * LENGTH**3 / (3 * YOUNG * area**2 / 12) + FORCE * LENGTH / (5 / 6 * shear * area)
    material = ["*ELASTIC", f"{YOUNG}, {poisson_ratio}"]
    return tip_deflection(element, mesh, FORCE, material, ["*STEP", "*STATIC"]) / timoshenko


def slanted(tangent):
    """Layers of nodes are shifted against each other, towards the plane ends by no more than half a cell per cell."""
    return lambda i, j, k: (min(tangent, i / 2, (20 - i) / 2) * (k - 1), 0, 0)


def trapezoids(share):
    """Every other cell is wider at the bottom by twice the share of a cell, the others at the top."""
    return lambda i, j, k: (share * (-1)**i * (k - 1) if 0 < i < 20 else 0, 0, 0)


def moved(share):
    """Every node by up to the share of a cell along every axis, but not off the beam's surface. The sequences n sqrt 2,
    n sqrt 5, n sqrt 7 without their whole parts spread evenly over 0 to 1 and repeat nothing."""
    def move(i, j, k):
        n = 1 + i + 21 * (j + 3 * k)
        return [share * (2 * math.modf(n * math.sqrt(root))[0] - 1) if 0 < at < count else 0
                for root, at, count in zip((2, 5, 7), (i, j, k), (20, 2, 2))]
    return move


MESHES = [Mesh("one cell thick", (10, 1, 1)),
          Mesh("twice as long", (10, 2, 2)),
          Mesh("five times as long", (4, 2, 2)),
          Mesh("slanted by 27 degrees", (20, 2, 2), slanted(0.5)),
          Mesh("slanted by 45 degrees", (20, 2, 2), slanted(1.0)),
          Mesh("trapezoids", (20, 2, 2), trapezoids(0.4)),
          Mesh("moved by 0.15", (20, 2, 2), moved(0.15)),
          Mesh("moved by 0.3", (20, 2, 2), moved(0.3))]


def row(element, mesh):
    return [round(relative_deflection(element, nu, mesh), 5) for nu in POISSON_RATIOS]


def cubes_table():
    table = {"poisson_ratio": POISSON_RATIOS}
    for across, suffix in [(2, ""), (4, "_refined")]:
        for element in ELEMENTS:
            table[element + suffix] = row(element, Mesh("cubes", (10 * across, across, across)))
    return "{\n" + ",\n".join(f' "{name}": {json.dumps(values)}' for name, values in table.items()) + "\n}"


def meshes_table():
    blocks = []
    for mesh in MESHES:
        load = tip_load(mesh)
        table = {"name": mesh.name, "cells": mesh.cells, "positions": list(mesh.positions.values()),
                 "tip_load": [round(load[2 * mesh.cells[0], 2 * j, 2 * k], 6)
                              for k in range(mesh.cells[2] + 1) for j in range(mesh.cells[1] + 1)]}
        table.update({element: row(element, mesh) for element in ELEMENTS})
        blocks.append(",\n".join(f'  "{name}": {json.dumps(values)}' for name, values in table.items()))
    meshes = ",\n".join(" {\n" + block + "\n }" for block in blocks)
    return f'{{\n"poisson_ratio": {json.dumps(POISSON_RATIOS)},\n"meshes": [\n{meshes}\n]\n}}'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--meshes", action="store_true", help="the longer and distorted cells")
    print(meshes_table() if parser.parse_args().meshes else cubes_table())


if __name__ == "__main__":
    main()
