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


def body(element, mesh, sets=("BODY",)):
    """Lines of a deck that tell nodes and elements, and the place of every node in units of half a cell, x fastest. More
    than one set: as many elements in every cell."""
    offsets = np.concatenate([2 * CORNERS, EDGES] if element.startswith("C3D20") else [2 * CORNERS])
    first = Grid(mesh.cells, (0, 0, 0), mesh.cells)
    cells = 2 * first.place[first.hexahedra[:, 0]]
    reversed_places, nodes = np.unique((cells[:, None] + offsets).reshape(-1, 3)[:, ::-1], axis=0, return_inverse=True)
    places = reversed_places[:, ::-1]
    lines = ["*NODE, NSET=ALL", *(f"{n}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in enumerate(mesh.at(places), 1))]
    for n, name in enumerate(sets):
        lines.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
        elements = np.column_stack([np.arange(len(cells)) + n * len(cells), nodes.reshape(len(cells), -1)]) + 1
        for words in elements.astype(str).tolist():  # a line of a deck holds 16 at most
            lines += [", ".join(words[i:i + 11]) + ("," if i + 11 < len(words) else "") for i in range(0, len(words), 11)]
    return lines, places


def node_set(name, chosen):
    """chosen: a mask of the nodes."""
    return [f"*NSET, NSET={name}", *(f"{n}," for n in np.flatnonzero(chosen) + 1)]


def held(displacements):
    """Lines of *BOUNDARY for displacements [m], (nodes, 3); NaN: free."""
    return [f"{n + 1}, {axis + 1}, {axis + 1}, {displacements[n, axis]:.9g}"
            for n, axis in np.argwhere(np.isfinite(displacements))]


def loads(forces, factor=1):
    """Lines of *CLOAD for forces [N], (nodes, 3), times a factor."""
    return [f"{n + 1}, {axis + 1}, {factor * forces[n, axis]:.12g}" for n, axis in np.argwhere(forces)]


def solid(material, elements="BODY"):
    return [f"*MATERIAL, NAME={elements}", *material, f"*SOLID SECTION, ELSET={elements}, MATERIAL={elements}"]


def hyperelastic(young, poisson_ratio, mooney_fraction=0):
    """The card of neo-Hooke or Mooney-Rivlin, W = C10 (I1 J^-2/3 - 3) + C01 (I2 J^-4/3 - 3) + (J - 1)^2 / D1."""
    half_shear, D1 = young / (4 * (1 + poisson_ratio)), 6 * (1 - 2 * poisson_ratio) / young
    if not mooney_fraction:
        return ["*HYPERELASTIC, NEO HOOKE", f"{half_shear:.12g}, {D1:.12g}"]
    constants = (1 - mooney_fraction) * half_shear, mooney_fraction * half_shear, D1
    return ["*HYPERELASTIC, MOONEY-RIVLIN", ", ".join(f"{constant:.12g}" for constant in constants)]


def solve(lines, ccx="ccx"):
    """What ccx prints for a deck, by the first word of its heading: "displacements" [m] and "forces" [N] of nodes, (prints,
    nodes, 3), their "total" (prints, 1, 3), "stresses" [Pa] xx yy zz xy xz yz (prints, integration points, 6)."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "body.inp").write_text("\n".join(lines) + "\n")
        subprocess.run([ccx, "-i", "body"], cwd=path, check=True, stdout=subprocess.DEVNULL)
        return read(path / "body.dat")[1]


def read(file):
    """Times, and what was printed at them, of the file that ccx prints."""
    times, tables = [], {}
    for words in map(str.split, pathlib.Path(file).read_text().splitlines()):
        if "time" in words:
            times.append(float(words[-1]))
            rows = []
            tables.setdefault(words[0], []).append(rows)
        elif words:
            rows.append([float(word) for word in words if not word.isdigit()])  # not numbers of nodes and points
    return times, {name: np.array(prints) for name, prints in tables.items()}


def print_tables(tables):
    """JSON, a line for each value, and for each row of a table."""
    def text(value):
        if isinstance(value, list) and isinstance(value[0], dict):
            return "[\n" + ",\n".join(" " + json.dumps(row) for row in value) + "\n]"
        return json.dumps(value)
    print("{\n" + ",\n".join(f'"{name}": {text(value)}' for name, value in tables.items()) + "\n}")
