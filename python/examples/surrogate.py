# SPDX-License-Identifier: LGPL-2.1-or-later
"""A surrogate of a surgery: where forceps take a liver and how far they pull it, to the shape in which it stays.

It learns from many runs of scenes/liver_cage.scn with another grip each: proper orthogonal decomposition of the permanent
displacements, and for the coefficients of the modes a ridge regression with a Gaussian kernel, in numpy alone. A fifth of
the runs is held back and tells its error.

surrogate.py [--runs 1000] [--workers N] [--out study]      The same call goes on with what is there in --out.
"""
import argparse
import concurrent.futures
import itertools
import pathlib

import h5py
import numpy as np

import hexaplast
from hexaplast import study

SCENE = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "liver_cage.scn"
STEPS = 200  # two seconds: pulled for half of one, held as long, and let go
CAGE = {"liver/cage.n": "12 6 8",
        # the probe stays away; the forceps take hold at once
        "liver/probe.graspTime": 100, "liver/probe.releaseTime": 200,
        "liver/forceps.graspTime": 0, "liver/forceps.keyTimes": "0 0.5", "liver/forceps.releaseTime": 1}


def grips(count, positions):
    """Places (count x 3) [m]: random nodes at the tip of the left lobe; and pulls [m]: 10 to 45 mm, outwards within 60°."""
    numbers = np.random.default_rng(1)
    tip = positions[positions[:, 0] > 0.06]
    places = tip[numbers.integers(len(tip), size=count)]
    outwards = places - [0.02, 0.01, 0]
    outwards /= np.linalg.norm(outwards, axis=1)[:, None]
    pulls = np.empty((count, 3))
    for pull, outward in zip(pulls, outwards):
        while True:
            direction = numbers.normal(size=3)
            direction /= np.linalg.norm(direction)
            if direction @ outward > 0.5:
                break
        pull[:] = numbers.uniform(0.010, 0.045) * direction
    return places.round(6), pulls.round(6)


class Surrogate:
    """Modes of the outputs, and a regression of their coefficients on the inputs."""

    def __init__(self, inputs, outputs, energy=0.999):
        self.inputs, self.scale = inputs, inputs.std(axis=0)
        self.mean = outputs.mean(axis=0)
        left, size, modes = np.linalg.svd(outputs - self.mean, full_matrices=False)
        kept = 1 + np.searchsorted(np.cumsum(size**2) / np.sum(size**2), energy)
        self.modes = modes[:kept]
        coefficients = left[:, :kept] * size[:kept]

        # what leaves the smallest error where each run is predicted by all others
        best = np.inf
        for width in itertools.product((0.2, 0.5, 1.0, 2.0), (1.0, 2.0, 4.0)):  # of places, of pulls
            kernel = self._kernel(inputs, width)
            for ridge in 10.0 ** np.arange(-6, 0):
                inverse = np.linalg.inv(kernel + ridge * np.eye(len(inputs)))
                weights = inverse @ coefficients
                error = np.sum((weights / np.diag(inverse)[:, None]) ** 2)
                if error < best:
                    best, self.width, self.ridge, self.weights = error, width, ridge, weights

    def _kernel(self, inputs, width):
        differences = (inputs[:, None, :] - self.inputs[None, :, :]) / (np.repeat(width, 3) * self.scale)
        return np.exp(-0.5 * np.sum(differences**2, axis=2))

    def __call__(self, inputs):
        return self.mean + self._kernel(inputs, self.width) @ self.weights @ self.modes


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("study"))
    options = parser.parse_args()

    places, pulls = grips(options.runs, hexaplast.Scene(SCENE, CAGE).positions)
    paths = np.hstack([places, places + pulls])
    with concurrent.futures.ProcessPoolExecutor(options.workers) as executor:
        swept = study.sweep(SCENE, {"liver/forceps.positions": paths}, executor, out=options.out, steps=STEPS, overrides=CAGE,
                            fields=["plasticDisplacement"], every=STEPS)
    good = ~swept.failed
    with h5py.File(swept.data) as data:
        shapes = data["fields/plasticDisplacement"][:, -1]
    print(f"runs             {good.sum()} of {len(swept)}, {shapes.shape[1]} nodes each")

    inputs, outputs = np.hstack([places, pulls])[good], shapes[good].reshape(good.sum(), -1)
    count = 4 * len(inputs) // 5
    surrogate = Surrogate(inputs[:count], outputs[:count])
    print(f"learned from     {count} runs: {len(surrogate.modes)} modes; kernel of {surrogate.width[0]:g} and {surrogate.width[1]:g} "
          f"deviations, ridge {surrogate.ridge:g}")

    truth = outputs[count:].reshape(-1, shapes.shape[1], 3)
    found = surrogate(inputs[count:]).reshape(truth.shape)
    of_nodes = np.linalg.norm(found - truth, axis=2)
    size = np.linalg.norm(truth, axis=2)
    relative = np.linalg.norm(found - truth, axis=(1, 2)) / np.linalg.norm(truth, axis=(1, 2))
    without = np.linalg.norm(surrogate.mean.reshape(1, -1, 3) - truth, axis=(1, 2)) / np.linalg.norm(truth, axis=(1, 2))
    print(f"permanent shift  {1e3 * np.median(size.max(axis=1)):.1f} mm at its largest, in the median of {len(truth)} unseen runs")
    print(f"error            {100 * np.linalg.norm(found - truth) / np.linalg.norm(truth):.1f} % of all shapes together, "
          f"{100 * np.median(relative):.1f} % of a shape in the median")
    print(f"                 {1e3 * np.median(of_nodes.max(axis=1)):.2f} mm at the worst node in the median, "
          f"{1e3 * np.quantile(of_nodes.max(axis=1), 0.9):.2f} mm in nine of ten")
    print(f"mean shape alone {100 * np.median(without):.1f} %")


if __name__ == "__main__":
    main()
