# SPDX-License-Identifier: LGPL-2.1-or-later
"""The paper's bar: its grid, runs of it, and what is measured on its shapes.

Positions are arrays (num_nodes, 3) in metres in the order of RegularGridTopology, x fastest; z is the long axis.
"""
import csv
import json
import resource
import subprocess
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
BIN = ROOT / "build/bin"
WORK = ROOT / "build/reproduce"
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


@dataclass
class Grid:
    """3r x 3r x 10r cubes over 0.3 x 0.3 x 1 m, centred at the origin."""
    refinement: int = 1

    def __post_init__(self):
        self.cells = np.array([3, 3, 10]) * self.refinement
        self.size = 0.1 / self.refinement
        nodes = self.cells + 1
        k, j, i = np.meshgrid(*(np.arange(n) for n in nodes[::-1]), indexing="ij")
        place = np.stack([i, j, k], axis=-1).reshape(-1, 3)
        self.positions = (place - self.cells / 2) * self.size
        self.layer = place[:, 2]
        k, j, i = np.meshgrid(*(np.arange(n) for n in self.cells[::-1]), indexing="ij")
        first = np.stack([i, j, k], axis=-1).reshape(-1, 1, 3) + CORNERS
        self.hexahedra = first[..., 0] + nodes[0] * (first[..., 1] + nodes[1] * first[..., 2])

    @property
    def num_hexahedra(self):
        return len(self.hexahedra)

    def boundary_faces(self):
        """Faces (n, 4) that one hexahedron alone has, and that hexahedron."""
        faces = self.hexahedra[:, FACES].reshape(-1, 4)
        owner = np.repeat(np.arange(self.num_hexahedra), 6)
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        outer = first[count == 1]
        return faces[outer], owner[outer]


@dataclass
class Run:
    """What a run left: its last state, and history.csv as columns."""
    world: np.ndarray
    material: np.ndarray
    isolated: np.ndarray  # (num_hexahedra, 8, 3), about their means
    history: dict
    folder: Path
    cpu_s: float  # [s] of one processor

    def world_at(self, step):
        """Positions at a step whose state was saved."""
        return meshio.read(self.folder / f"mesh_{step:06d}.vtu").points

    @property
    def step_ms(self):
        """Time of a step [ms], output included."""
        return 1000 * self.cpu_s / (len(self.history["step"]) - 1)


def run(name, scene, settings=()):
    """Runs scenes/<scene>.scn with `--set` assignments; the files go to build/reproduce/<name>."""
    out = WORK / name
    out.parent.mkdir(parents=True, exist_ok=True)
    final = out.with_suffix(".json")
    command = [BIN / "hexaplast", "run", ROOT / f"scenes/{scene}.scn", "--out", out, "--final", final,
               "--frames", "0", "--force", "--quiet", "--threads", "1"]
    for setting in settings:
        command += ["--set", setting]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([str(word) for word in command], check=True)
    cpu_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    with open(final) as file:
        state = json.load(file)
    with open(out / "history.csv") as file:
        rows = list(csv.DictReader(file))
    history = {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}
    return Run(np.array(state["positions"]), np.array(state["plastic_rest_positions"]),
               np.array(state["isolated_shapes"]), history, out, cpu_s)


def layer_means(grid, x):
    """Mean position of every layer of nodes, (layers, 3)."""
    return np.array([x[grid.layer == layer].mean(axis=0) for layer in range(grid.cells[2] + 1)])


def slice_elongations(grid, x):
    """Elongation of each slice along the axis [-]."""
    return np.diff(layer_means(grid, x)[:, 2]) / grid.size - 1


def elongation(grid, x):
    """Elongation between the end sections [-]."""
    ends = layer_means(grid, x)[[0, -1], 2]
    return (ends[1] - ends[0]) / (grid.size * grid.cells[2]) - 1


def slice_twists(grid, x):
    """Turn of each slice's upper layer against its lower one about the axis [degrees]: best fits of the layers."""
    angles = []
    for layer in range(grid.cells[2] + 1):
        at = grid.layer == layer
        rest = grid.positions[at, :2] - grid.positions[at, :2].mean(axis=0)
        now = x[at, :2] - x[at, :2].mean(axis=0)
        sine = (rest[:, 0] * now[:, 1] - rest[:, 1] * now[:, 0]).sum()
        angles.append(np.arctan2(sine, (rest * now).sum()))
    turns = np.diff(angles)
    return np.degrees((turns + np.pi) % (2 * np.pi) - np.pi)


def corner_jacobians(grid, x):
    """Determinant and scaled determinant (by edge lengths) at the corners of all hexahedra, (n, 8) each."""
    at = x[grid.hexahedra]
    signs = 2 * CORNERS - 1
    determinant, scaled = np.empty((2, len(at), 8))
    for a, corner in enumerate(CORNERS):
        edges = []
        for axis in range(3):
            other = corner.copy()
            other[axis] = 1 - corner[axis]
            b = int(np.flatnonzero((CORNERS == other).all(axis=1))[0])
            edges.append(-signs[a][axis] * (at[:, b] - at[:, a]))
        edges = np.stack(edges, axis=-1)
        determinant[:, a] = np.linalg.det(edges)
        scaled[:, a] = determinant[:, a] / np.linalg.norm(edges, axis=1).prod(axis=1)
    return determinant, scaled


def jaggedness(grid, shape):
    """Gap that the isolated shapes leave at the nodes, as a share of the element size.

    Every isolated shape is put at the mean of its element's material nodes. The result is the root mean square distance
    of the corners that share a node from their common mean.
    """
    placed = shape.isolated + shape.material[grid.hexahedra].mean(axis=1, keepdims=True)
    nodes = grid.hexahedra.ravel()
    count = np.bincount(nodes)
    mean = np.stack([np.bincount(nodes, placed[..., d].ravel()) for d in range(3)], axis=-1) / count[:, None]
    gap = placed.reshape(-1, 3) - mean[nodes]
    return float(np.sqrt((gap[count[nodes] > 1] ** 2).sum(axis=1).mean()) / grid.size)
