# SPDX-License-Identifier: LGPL-2.1-or-later
"""A baseline for comparison: the bar of the shipped scenes bar_stretch_high and bar_twist_high, each cube split into linear
tetrahedra, with the corotated law, and the library's flow law, hardening, time integration, masses and loads. A linear
tetrahedron has one deformation gradient: nothing turns within it, so that only stretch can flow.

SPLITTINGS  five      five tetrahedra, mirrored from cube to cube as conforming needs
            six       six around the same space diagonal in every cube
            mirrored  six, the upper half of the bar being the mirror image of the lower one
LOADS       stretch, twist
"""
import json
import subprocess

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import spsolve

from bar import BIN, bar, elongation, slice_twists

YOUNG, POISSON_RATIO, DENSITY, RAYLEIGH = 5000, 0.45, 1000, 0.1
YIELD, HARDENING = 300, 0.2
FLOW_RATE = {"stretch": 4, "twist": 2}
MU = YOUNG / (2 * (1 + POISSON_RATIO))
LAMBDA = YOUNG * POISSON_RATIO / ((1 + POISSON_RATIO) * (1 - 2 * POISSON_RATIO))
DT, STEPS, RAMP_STEPS, LAST_LOADED_STEP = 0.01, 500, 50, 200
AVERAGING_SWEEPS = 20  # local/global sweeps lag behind a twist unless there are several per step
INVERSION_THRESHOLD = 0.1
SMALL = 1e-4  # fraction of the load
SPLITTINGS, LOADS = ("five", "six", "mirrored"), ("stretch", "twist")

GRID = bar()
FREE = np.repeat(GRID.place[:, 2] != 5, 3)
EDGES = np.array([[5, 6], [6, 10], [10, 9], [9, 5]])  # of the central face of the lower end; 160 more: of the upper end


def split(splitting):
    """Nodes of the tetrahedra, (n, 4)."""
    i, j, k = GRID.place[GRID.hexahedra[:, 0]].T
    six = [(0, second, third, 6) for second, third in ((1, 2), (1, 5), (3, 2), (3, 7), (4, 5), (4, 7))]
    five = [(1, 3, 4, 6), (0, 1, 3, 4), (2, 1, 3, 6), (5, 1, 4, 6), (7, 3, 4, 6)]
    corners = np.array(five if splitting == "five" else six)
    is_mirrored = {"five": (i + j + k) % 2 == 1, "six": k < 0, "mirrored": k >= 5}[splitting]  # in z
    parts = np.where(is_mirrored[:, None, None], (corners + 4) % 8, corners)
    tetrahedra = np.take_along_axis(GRID.hexahedra, parts.reshape(len(k), -1), axis=1).reshape(-1, 4)
    is_inverted = volumes(GRID.positions[tetrahedra]) < 0
    tetrahedra[is_inverted] = tetrahedra[is_inverted][:, [0, 1, 3, 2]]
    return tetrahedra


def volumes(at):
    return np.linalg.det(at[:, 1:] - at[:, :1]) / 6


def centred(at):
    return at - at.mean(axis=1, keepdims=True)


def transposed(matrices):
    return matrices.swapaxes(1, 2)


def polar(F):
    """R, and the stretches and directions of S, for F = R S; a reflection is carried on the smallest stretch."""
    U, stretch, directions = np.linalg.svd(F)
    sign = np.sign(np.linalg.det(U @ directions))
    U[..., 2] *= sign[:, None]
    stretch[:, 2] *= sign
    return U @ directions, stretch, directions


def symmetric(values, directions):
    return transposed(directions) @ (values[:, :, None] * directions)


def load_at(load, x):
    """[N] of the full load, which turns with the bar."""
    f = np.zeros_like(x)
    for nodes, sign in ((EDGES, -1), (EDGES + 160, 1)):
        if load == "stretch":
            f[nodes, 2] = sign * 22.5
            continue
        direction = np.cross((0, 0, sign), x[nodes].mean(axis=1))
        np.add.at(f, nodes, (10 * direction / np.linalg.norm(direction, axis=1, keepdims=True))[:, None])
    return f


def assembled(blocks, nodes):
    """blocks: (elements, corners, 3, corners, 3)."""
    dofs = (3 * nodes[..., None] + np.arange(3)).reshape(len(nodes), -1)
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None])
    return coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(len(FREE), len(FREE))).tocsc()


def solved(A, b):
    u = np.zeros(len(FREE))
    u[FREE] = spsolve(A[FREE][:, FREE], b.ravel()[FREE])
    return u.reshape(-1, 3)


class Body:
    """In the three spaces of the hexahedra: isolated rest shapes, a joined plastic rest shape, the world."""

    def __init__(self, tetrahedra, flow_rate):
        self.nodes, self.flow_rate = tetrahedra, flow_rate
        self.material = GRID.positions.copy()
        self.rest_shape = centred(self.material[tetrahedra])
        self.original_volume = volumes(self.material[tetrahedra])
        self.yield_stress = np.full(len(tetrahedra), float(YIELD))
        P = np.zeros((len(self.material), len(self.material)))
        P[0, 0] = 1  # the node mean is restored anyway
        np.add.at(P, (tetrahedra[:, :, None], tetrahedra[:, None]), np.eye(4) - 0.25)
        self.averaging = np.linalg.inv(P)

    def linearize(self, x):
        rest = self.material[self.nodes]
        inverse = transposed(np.linalg.inv(rest[:, 1:] - rest[:, :1]))
        self.gradient = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        self.volume = volumes(rest)
        self.F = transposed(x[self.nodes]) @ self.gradient
        self.R, self.stretch, self.directions = polar(self.F)
        strain = self.stretch - 1
        self.stress = 2 * MU * strain + LAMBDA * strain.sum(axis=1, keepdims=True)  # [Pa] in the turning frame, eq. 12

    def force(self):
        P = self.R @ symmetric(self.stress, self.directions)
        f = np.zeros_like(self.material)
        np.add.at(f, self.nodes, -self.volume[:, None, None] * self.gradient @ transposed(P))
        return f

    def stiffness(self):
        turned = self.gradient @ transposed(self.R)
        outer = np.einsum("eai,ebj->eaibj", turned, turned)
        product = np.einsum("eab,ij->eaibj", self.gradient @ transposed(self.gradient), np.eye(3))
        blocks = MU * (product + outer.swapaxes(2, 4)) + LAMBDA * outer
        return assembled(self.volume[:, None, None, None, None] * blocks, self.nodes)

    def flow(self, x):
        self.linearize(x)
        ratio = self.volume / self.original_volume
        norm = np.linalg.norm(self.stress, axis=1)
        fraction = np.clip(self.flow_rate * DT * (norm - self.yield_stress) / norm, 0, 1)  # eq. 21
        fraction[(np.linalg.det(self.F) < INVERSION_THRESHOLD) | (ratio < INVERSION_THRESHOLD)] = 0
        stretch = np.where(fraction[:, None] > 0, self.stretch, 1)
        increment = symmetric((stretch / stretch.prod(axis=1, keepdims=True) ** (1 / 3)) ** fraction[:, None],
                              self.directions)  # eq. 22
        turn = self.rotation_from_rest()
        self.rest_shape = self.rest_shape @ transposed(turn) @ increment @ turn * (1 + DT * (1 - ratio))[:, None, None]
        self.yield_stress += HARDENING * fraction * norm  # eq. 23
        for _ in range(AVERAGING_SWEEPS):
            self.average()

    def rotation_from_rest(self):
        return polar(transposed(centred(self.material[self.nodes])) @ self.rest_shape)[0]

    def average(self):
        """One local/global sweep towards the joined shape that fits the isolated ones best."""
        misfit = np.zeros_like(self.material)
        np.add.at(misfit, self.nodes,
                  self.rest_shape @ transposed(self.rotation_from_rest()) - centred(self.material[self.nodes]))
        increment = self.averaging @ misfit
        self.material += increment - increment.mean(axis=0)


def response(load, x):
    """Elongation [-] or twist [degrees] between the end sections."""
    return elongation(GRID, x) if load == "stretch" else slice_twists(GRID, x).sum()


def small_response(load, K):
    return response(load, GRID.positions + solved(K, SMALL * load_at(load, GRID.positions)))


def stiffness_of_hexahedra():
    """Of the published element: that of one cube, at all of them."""
    cube = {"initial": GRID.positions[GRID.hexahedra[0]].tolist(),
            "parameters": {"youngModulus": YOUNG, "poissonRatio": POISSON_RATIO, "dt": DT, "bending": "blended",
                           "volumetric": "sample"}}
    run = subprocess.run([BIN / "hexaplast", "element", "-"], input=json.dumps(cube), check=True, stdout=subprocess.PIPE,
                         text=True)
    K = np.array(json.loads(run.stdout)["elastic"]["stiffness"])
    return assembled(np.broadcast_to(K, (len(GRID.hexahedra), 24, 24)), GRID.hexahedra)


def simulate(splitting, load):
    """Tetrahedra, positions at the end of the load, plastic rest positions at the end, elastic response over that of
    hexahedra, and volume without load over the initial one."""
    body = Body(split(splitting), FLOW_RATE[load])
    x, v = GRID.positions, np.zeros_like(GRID.positions)
    M = np.repeat(np.bincount(GRID.hexahedra.ravel()) * DENSITY * GRID.size.prod() / 8, 3)
    body.linearize(x)
    softness = small_response(load, body.stiffness()) / small_response(load, stiffness_of_hexahedra())
    for step in range(1, STEPS + 1):
        body.linearize(x)
        f = body.force() + (step <= LAST_LOADED_STEP) * min(1, step / RAMP_STEPS) * load_at(load, x)
        K = (DT + RAYLEIGH) * body.stiffness()
        b = DT * (f.ravel() - RAYLEIGH * M * v.ravel() - K @ v.ravel())  # eq. 41
        v = v + solved(diags((1 + DT * RAYLEIGH) * M) + DT * K, b)  # eq. 40
        x = x + DT * v
        body.flow(x)
        if step == LAST_LOADED_STEP:
            peak = x
    left = volumes(body.material[body.nodes]).sum() / body.original_volume.sum()
    return body.nodes, peak, body.material, softness, left
