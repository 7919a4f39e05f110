#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Retraction of tissue as an environment of Gymnasium, and a policy that learns it.

A flap of 60 x 40 x 5 mm is attached along x = 0 and covers what lies below it. Forceps hold its free edge and move; what
they uncover counts as reward, plastic deformation against it. Stiffness and the place of the grip differ from episode to
episode. `Retraction` is one flap, `Retractions` are many that are stepped together. Neither needs gymnasium.

    python3 retraction.py [--iterations N] [--threads N] [--picture FILE]

finds a linear policy by the cross-entropy method, and prints its return before and after.
"""
import argparse

import numpy as np

import hexaplast

try:
    from gymnasium import Env
    from gymnasium.spaces import Box
except ImportError:

    class Env:
        def reset(self, *, seed=None, options=None):
            if seed is not None or not hasattr(self, "np_random"):
                self.np_random = np.random.default_rng(seed)

        def close(self):
            pass

    class Box:
        def __init__(self, low, high, shape, dtype):
            self.low, self.high, self.shape, self.dtype = low, high, shape, np.dtype(dtype)

        def contains(self, x):
            return x.shape == self.shape and x.dtype == self.dtype and bool(((x >= self.low) & (x <= self.high)).all())

        def sample(self):
            return np.random.default_rng().uniform(self.low, self.high, self.shape).astype(self.dtype)


CELLS, SIZE = (9, 6, 1), np.array([0.06, 0.04, 0.005])  # [m]
GRID = tuple(count + 1 for count in reversed(CELLS))  # of nodes, x fastest
STEPS, DT, FASTEST = 50, 0.02, 0.1  # of an episode, [s], [m/s]
HURTS = 20  # reward that an increase of the mean plastic strain by 1 takes
POINTS = GRID[1] * GRID[2]  # of the upper side, which are observed


class Retractions:
    """`count` flaps. Arrays have one row for each."""

    def __init__(self, count):
        positions, hexahedra = hexaplast.grid(CELLS, (0, 0, 0), SIZE)
        self.initial = positions
        self.batch = hexaplast.Batch(self._flap(positions, hexahedra) for _ in range(count))
        self.held = [None] * count  # nodes in the forceps
        self.damage = np.zeros(count)
        self.num_steps = np.zeros(count, int)

    @staticmethod
    def _flap(positions, hexahedra):
        simulation = hexaplast.Simulation(hexaplast.Body(positions, hexahedra), dt=DT, gravity=(0, 0, -9.81),
                                          rayleigh_mass=2, rayleigh_stiffness=0.01)
        simulation.fix(positions[:, 0] == 0)
        return simulation

    def reset(self, k, random):
        """Begins a new episode of flap k."""
        simulation = self.batch.simulations[k]
        simulation.body.set_material(hexaplast.Material(young_modulus=random.uniform(4000, 8000), poisson_ratio=0.4,
                                                        yield_stress=800, flow_rate=4))
        if self.held[k] is not None:
            simulation.release(self.held[k])
        simulation.reset()
        place = random.uniform(0.3, 0.7) * SIZE[1]
        at_edge = (self.initial[:, 0] == SIZE[0]) & (abs(self.initial[:, 1] - place) < 0.006)
        self.held[k] = np.flatnonzero(at_edge)
        simulation.fix(self.held[k])
        self.damage[k] = self.num_steps[k] = 0

    def observations(self):
        """(count, POINTS + 1, 3) float32 [m]: the upper side, and the middle of the forceps."""
        x = self.batch.positions
        tools = [x[k, held].mean(axis=0) for k, held in enumerate(self.held)]
        return np.concatenate([x[:, -POINTS:], np.array(tools)[:, None]], axis=1).astype(np.float32)

    def uncovered(self):
        """(count,) [-] of what lies under the flap at the beginning: up to where it reaches in each of its rows along x."""
        x = self.batch.positions.reshape(-1, *GRID, 3)[..., 0]
        return 1 - x.max(axis=(1, 3)).mean(axis=1) / SIZE[0]

    def step(self, actions):
        """actions: (count, 3) [m/s] of the forceps. Returns rewards (count,) and whether the episodes are over."""
        actions = np.clip(np.asarray(actions, float), -FASTEST, FASTEST)
        x = self.batch.positions
        targets = [x[k, held] + DT * velocity for k, (held, velocity) in enumerate(zip(self.held, actions))]
        self.batch.step(zip(self.held, targets), lambda simulation, action: simulation.prescribe(*action))
        self.num_steps += 1
        before = self.damage
        self.damage = np.array([s.body.corner_plastic_strain.mean() for s in self.batch.simulations])
        return self.uncovered() - HURTS * (self.damage - before), self.num_steps >= STEPS


class Retraction(Env):
    """One flap. Action: (3,) velocity of the forceps [m/s]. Observation: (POINTS + 1, 3) [m]."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / DT)}
    action_space = Box(-FASTEST, FASTEST, (3,), np.float32)
    observation_space = Box(-10, 10, (POINTS + 1, 3), np.float32)

    def __init__(self, render_mode=None):
        self.render_mode = render_mode
        self.flap = Retractions(1)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.flap.reset(0, self.np_random)
        return self.flap.observations()[0], {}

    def step(self, action):
        rewards, over = self.flap.step([action])
        info = {"uncovered": float(self.flap.uncovered()[0]), "plastic_strain": float(self.flap.damage[0])}
        return self.flap.observations()[0], float(rewards[0]), False, bool(over[0]), info

    def render(self, mode="rgb_array"):
        return self.flap.batch.simulations[0].picture()


def velocities(policies, flaps, start):
    """Linear in how far the forceps have come: policies (count, 3, 4)."""
    moved = (flaps.observations()[:, -1] - start) / SIZE[0]
    return np.einsum("kij,kj->ki", policies, np.concatenate([moved, np.ones((len(moved), 1))], axis=1))


def returns(policies, flaps, seed):
    """Of an episode of each flap with its policy; all have the same flap."""
    for k in range(len(policies)):
        flaps.reset(k, np.random.default_rng(seed))
    start, total = flaps.observations()[:, -1], 0
    for _ in range(STEPS):
        rewards, _ = flaps.step(velocities(policies, flaps, start))
        total = total + rewards
    return total


def train(iterations, count=16, seed=1):
    """The mean of the policies that the cross-entropy method ends with."""
    random, flaps = np.random.default_rng(seed), Retractions(count)
    mean, spread = np.zeros((3, 4)), np.full((3, 4), 0.04)
    for iteration in range(iterations):
        policies = random.normal(mean, spread, (count, 3, 4))
        best = policies[np.argsort(returns(policies, flaps, seed=100 + iteration))[-count // 4:]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.005
    return mean


def evaluate(policy, seeds=range(4)):
    """Its mean return in episodes that training has not seen."""
    flaps = Retractions(1)
    return float(np.mean([returns(policy[None], flaps, seed) for seed in seeds]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--iterations", type=int, default=20)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--picture", help="PNG of the flap at the end of an episode")
    options = parser.parse_args()
    hexaplast.set_num_threads(options.threads)
    policy = train(options.iterations)
    print(f"mean return: untrained {evaluate(np.zeros((3, 4))):.2f}, trained {evaluate(policy):.2f}")
    if options.picture:
        from matplotlib import image

        flaps = Retractions(1)
        returns(policy[None], flaps, 0)
        image.imsave(options.picture, flaps.batch.simulations[0].picture(1280, 720))


if __name__ == "__main__":
    main()
