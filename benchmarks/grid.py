# SPDX-License-Identifier: LGPL-2.1-or-later
"""Boxes of hexahedra, and what is measured on their shapes.

Shapes are arrays (num_nodes, 3) in metres in the order of RegularGridTopology, x fastest.
"""
import numpy as np

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


def _places(counts):
    """(i, j, k) of every node or cell, i fastest."""
    return np.indices(counts[::-1]).reshape(3, -1)[::-1].T


class Grid:
    """A box of cells[0] x cells[1] x cells[2] equal hexahedra between two corners."""

    def __init__(self, cells, low, high):
        self.cells = np.array(cells)
        self.size = (np.array(high) - low) / self.cells  # [m] edges
        nodes = self.cells + 1
        self.place = _places(nodes)
        self.positions = low + self.place * self.size
        self.hexahedra = (_places(self.cells)[:, None] + CORNERS) @ [1, nodes[0], nodes[0] * nodes[1]]

    def boundary_faces(self):
        """Faces (n, 4) that one hexahedron alone has, and that hexahedron."""
        faces = self.hexahedra[:, FACES].reshape(-1, 4)
        owner = np.repeat(np.arange(len(self.hexahedra)), 6)
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        outer = first[count == 1]
        return faces[outer], owner[outer]

    def face(self, axis, side):
        """Nodes of the layer `side` across an axis, with their shares of a load that is even over it."""
        nodes = np.flatnonzero(self.place[:, axis] == side)
        across = [a for a in range(3) if a != axis]
        place, cells = self.place[nodes][:, across], self.cells[across]
        return nodes, np.prod(np.where((place == 0) | (place == cells), 0.5, 1) / cells, axis=1)


def bar(refinement=1, along=2):
    """The paper's bar: 3r x 3r x 10r cubes over 0.3 x 0.3 x 1 m, centred at the origin."""
    cells = np.where(np.arange(3) == along, 10, 3)
    return Grid(cells * refinement, -0.05 * cells, 0.05 * cells)


def volumes(x, hexahedra):
    """[m^3] of trilinear hexahedra, exactly: two Gauss points along each axis."""
    signs = 2 * CORNERS - 1
    factors = 1 + signs[:, None] / np.sqrt(3) * signs  # (points, corners, 3)
    slopes = signs / 8 * np.roll(factors, 1, axis=2) * np.roll(factors, 2, axis=2)
    return np.linalg.det(np.einsum("pci,ecj->epij", slopes, x[hexahedra])).sum(axis=1)
