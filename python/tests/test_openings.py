# SPDX-License-Identifier: LGPL-2.1-or-later
"""Random openings of random blocks and cages. HEXAPLAST_SEEDS=10000 are those of docs/validation.md."""
import os

import numpy as np

import hexaplast

COUNT = int(os.environ.get("HEXAPLAST_SEEDS", 300))
SIDES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


def random_body(random, has_holes):
    counts = random.integers(2, 5, 3)
    positions, hexahedra = hexaplast.grid(tuple(map(int, counts)), (0, 0, 0), tuple(.01 * counts))
    kept = random.random(len(hexahedra)) > (.35 if has_holes else 0)
    used, corners = np.unique(hexahedra[kept] if kept.any() else hexahedra[:1], return_inverse=True)
    positions = positions[used] + random.uniform(-.001, .001, (len(used), 3))
    material = hexaplast.Material(young_modulus=5000, poisson_ratio=.4)
    return hexaplast.Body(positions, corners.reshape(-1, 8), material)


def surface_is_closed(hexahedra):
    faces = hexahedra[:, SIDES].reshape(-1, 4)
    _, which, counts = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    boundary = faces[counts[which.ravel()] == 1]
    edges = np.stack([boundary, np.roll(boundary, -1, axis=1)], axis=2).reshape(-1, 2)
    return (np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1] % 2 == 0).all()


def conserved(simulation):
    impulses = simulation.masses[:, None] * simulation.velocities
    return np.concatenate([[simulation.masses.sum(), simulation.kinetic_energy, simulation.elastic_energy,
                            simulation.body.volume(simulation.positions)],
                           impulses.sum(axis=0), np.cross(simulation.positions, impulses).sum(axis=0)])


def test_openings_keep_what_bodies_have_and_leave_closed_surfaces():
    random = np.random.default_rng(5)
    done = bodies = 0
    while done < COUNT:
        bodies += 1
        body = random_body(random, has_holes=bodies % 2 == 0)
        simulation = hexaplast.Simulation(body, dt=.01)
        n = len(simulation.positions)
        simulation.set_state(simulation.positions + random.uniform(-.0005, .0005, (n, 3)), random.normal(0, .1, (n, 3)))
        joints = len(body.joints)
        before = conserved(simulation)
        for _ in range(5 if joints else 0):
            simulation.open(random.choice(joints, random.integers(1, max(2, joints // 3)), replace=False))
            done += 1
            assert surface_is_closed(body.hexahedra)
            impulse = (simulation.masses[:, None] * np.abs(simulation.velocities)).sum()
            scales = np.concatenate([before[:4], [impulse] * 3, [impulse * .04] * 3])
            assert (np.abs(conserved(simulation) - before) < 1e-12 * scales).all()
        if bodies % 10 == 0:
            simulation.step()
            assert np.isfinite(simulation.positions).all()
