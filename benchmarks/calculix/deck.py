# SPDX-License-Identifier: LGPL-2.1-or-later
"""Decks of CalculiX: boxes of hexahedra, and runs of ccx, which must be installed."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from grid import CORNERS, Grid, volumes  # noqa: E402

# nodes of a quadratic element in the middles of its edges, in units of half an edge: below, above, and upright
EDGES = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
         (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
EXACT = ["*CONTROLS, PARAMETERS=FIELD", "1e-6, 1e-6, , , 1e-6"]  # ccx's own: half a percent of the forces


class Mesh:
    """Cells of a box with a corner at the origin; positions (nodes, 3) [m], x fastest."""

    def __init__(self, name, cells, size, move=lambda i, j, k: (0 * i, 0 * j, 0 * k)):
        """move: displaces node (i, j, k), in cells."""
        grid = Grid(cells, (0, 0, 0), size)
        self.name, self.cells, self.hexahedra = name, list(cells), grid.hexahedra
        displaced = grid.place + np.column_stack(move(*grid.place.T))
        self.positions = (displaced * grid.size).round(6) + 0.0  # no negative zero

    def at(self, place):
        """Positions of places in units of half a cell: the middle of an edge where one of them is odd."""
        count = np.add(self.cells, 1)
        low, high = (self.positions[where @ [1, count[0], count[0] * count[1]]] for where in (place // 2, (place + 1) // 2))
        return (low + high) / 2

    def volume_ratio(self, displacements):
        """displacements: of the nodes of the linear element."""
        return volumes(self.positions + displacements, self.hexahedra).sum() / volumes(self.positions, self.hexahedra).sum()


def body(element, mesh):
    """Lines of a deck that tell nodes and elements, and the place of every node in units of half a cell, x fastest."""
    offsets = np.concatenate([2 * CORNERS, EDGES] if element.startswith("C3D20") else [2 * CORNERS])
    first = Grid(mesh.cells, (0, 0, 0), mesh.cells)
    cells = 2 * first.place[first.hexahedra[:, 0]]
    reversed_places, nodes = np.unique((cells[:, None] + offsets).reshape(-1, 3)[:, ::-1], axis=0, return_inverse=True)
    places = reversed_places[:, ::-1]
    elements = np.column_stack([np.arange(len(cells)), nodes.reshape(len(cells), -1)]) + 1
    lines = ["*NODE, NSET=ALL", *(f"{n}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in enumerate(mesh.at(places), 1)),
             f"*ELEMENT, TYPE={element}, ELSET=BODY"]
    for words in elements.astype(str).tolist():  # a line of a deck holds 16 at most
        lines += [", ".join(words[i:i + 11]) + ("," if i + 11 < len(words) else "") for i in range(0, len(words), 11)]
    return lines, places


def node_set(name, chosen):
    """chosen: a mask of the nodes."""
    return [f"*NSET, NSET={name}", *(f"{n}," for n in np.flatnonzero(chosen) + 1)]


def solid(material):
    return ["*MATERIAL, NAME=SOLID", *material, "*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"]


def hyperelastic(young, poisson_ratio, mooney_fraction=0):
    """The card of neo-Hooke or Mooney-Rivlin, W = C10 (I1 J^-2/3 - 3) + C01 (I2 J^-4/3 - 3) + (J - 1)^2 / D1."""
    half_shear, D1 = young / (4 * (1 + poisson_ratio)), 6 * (1 - 2 * poisson_ratio) / young
    if not mooney_fraction:
        return ["*HYPERELASTIC, NEO HOOKE", f"{half_shear:.12g}, {D1:.12g}"]
    constants = (1 - mooney_fraction) * half_shear, mooney_fraction * half_shear, D1
    return ["*HYPERELASTIC, MOONEY-RIVLIN", ", ".join(f"{constant:.12g}" for constant in constants)]


def solve(lines, ccx="ccx"):
    """What ccx prints for a deck: displacements [m] of nodes, (prints, nodes, 3), and total forces [N], (prints, 3)."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "body.inp").write_text("\n".join(lines) + "\n")
        subprocess.run([ccx, "-i", "body"], cwd=path, check=True, stdout=subprocess.DEVNULL)
        return read(path / "body.dat")[1:]


def read(file):
    """Times, displacements and total forces of the file that ccx prints."""
    times, moved, forces = [], [], []
    for words in map(str.split, pathlib.Path(file).read_text().splitlines()):
        if "displacements" in words:
            times.append(float(words[-1]))
            moved.append([])
        elif len(words) == 4 and words[0].isdigit():
            moved[-1].append([float(word) for word in words[1:]])
        elif len(words) == 3:
            forces.append([float(word) for word in words])
    return times, np.array(moved), np.array(forces)


def rows(table):
    """JSON, a line for each entry."""
    return "[\n" + ",\n".join(" " + json.dumps(row) for row in table) + "\n]"
