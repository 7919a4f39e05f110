# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs of the paper's bar, and what is measured on its shapes; z is the long axis."""
import csv
import json
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
from grid import CORNERS, bar  # noqa: E402, F401

BIN = ROOT / "build/bin"
WORK = ROOT / "build/reproduce"


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
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([BIN / "hexaplast", "run", ROOT / f"scenes/{scene}.scn", "--out", out, "--final", final, "--frames", "0",
                    "--force", "--quiet", "--threads", "1", *(word for setting in settings for word in ("--set", setting))],
                   check=True)
    cpu_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    state = json.loads(final.read_text())
    with open(out / "history.csv") as file:
        rows = list(csv.DictReader(file))
    history = {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}
    return Run(*(np.array(state[name]) for name in ("positions", "plastic_rest_positions", "isolated_shapes")), history, out,
               cpu_s)


def layers(grid, x):
    """Positions of every layer of nodes, (layers, nodes, 3)."""
    return x.reshape(grid.cells[2] + 1, -1, 3)


def slice_elongations(grid, x):
    """Elongation of each slice along the axis [-]."""
    return np.diff(layers(grid, x)[..., 2].mean(axis=1)) / grid.size[2] - 1


def elongation(grid, x):
    """Elongation between the end sections [-]."""
    return slice_elongations(grid, x).mean()


def slice_twists(grid, x):
    """Turn of each slice's upper layer against its lower one about the axis [degrees]: best fits of the layers."""
    rest, now = (layers(grid, points)[..., :2] for points in (grid.positions, x))
    now = now - now.mean(axis=1, keepdims=True)
    angles = np.arctan2((rest[..., 0] * now[..., 1] - rest[..., 1] * now[..., 0]).sum(axis=1), (rest * now).sum(axis=(1, 2)))
    return np.degrees((np.diff(angles) + np.pi) % (2 * np.pi) - np.pi)


def corner_jacobians(grid, x):
    """Determinant and scaled determinant (by edge lengths) at the corners of all hexahedra, (n, 8) each."""
    at = x[grid.hexahedra]
    distance = np.abs(CORNERS[:, None] - CORNERS)  # of two corners, along each axis
    neighbour = [[np.flatnonzero((distance[a] == axis).all(axis=1))[0] for axis in np.eye(3)] for a in range(8)]
    edges = (at[:, neighbour] - at[:, :, None]) * (1 - 2 * CORNERS)[:, :, None]  # (n, corner, axis, 3)
    determinant = np.linalg.det(edges)
    return determinant, determinant / np.linalg.norm(edges, axis=3).prod(axis=2)


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
    return float(np.sqrt((gap[count[nodes] > 1] ** 2).sum(axis=1).mean()) / grid.size[0])
