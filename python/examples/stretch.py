#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Stretches a bar, lets it go, and prints how much of the stretch stays.

The bar of scenes/bar_stretch_high.scn, built from arrays: 3 x 3 x 10 cubes, held in the middle, pulled at both ends with
90 N for two seconds, then free for three.

    python3 stretch.py [--yield-stress PA] [--flow-rate PER_S] [--plot FILE]
"""
import argparse
import sys

import numpy as np

import hexaplast

LENGTH, STEPS, RAMP, RELEASE = 1.0, 500, 50, 200  # [m], and numbers of steps
PULL = 90.0  # [N]


def bar(yield_stress, flow_rate):
    positions, hexahedra = hexaplast.grid((3, 3, 10), (-0.15, -0.15, -0.5), (0.15, 0.15, 0.5))
    material = hexaplast.Material(
        young_modulus=5000, poisson_ratio=0.45, yield_stress=yield_stress, flow_rate=flow_rate, hardening=0.2
    )
    settings = hexaplast.Settings(bending="blended", volumetric="sample", recovery="none",  # as the paper's
                                  yield_norm="frobenius", rest_shape="joined")
    return hexaplast.Body(positions, hexahedra, material, settings)


def stretch(yield_stress, flow_rate):
    """Rows of time [s], elongation of the bar and its permanent part [-]."""
    body = bar(yield_stress, flow_rate)
    x, y, z = body.initial_positions.T
    low, high = z < -0.49, z > 0.49
    centre = (abs(x) < 0.06) & (abs(y) < 0.06)  # the four nodes of an end's central face

    simulation = hexaplast.Simulation(body, rayleigh_mass=0.1, rayleigh_stiffness=0.1)
    simulation.fix(abs(z) < 0.01)
    forces = np.zeros_like(simulation.positions)

    def elongation(positions):
        return (positions[high, 2].mean() - positions[low, 2].mean()) / LENGTH - 1

    curve = []
    for step in range(1, STEPS + 1):
        fraction = min(step / RAMP, 1) if step <= RELEASE else 0
        forces[high & centre, 2] = fraction * PULL / 4
        forces[low & centre, 2] = -fraction * PULL / 4
        simulation.step(forces)
        curve.append((simulation.time, elongation(simulation.positions), elongation(body.plastic_rest_positions)))
    return np.array(curve)


def plot(curve, file):
    try:
        import matplotlib
    except ImportError:
        sys.exit("stretch.py: --plot needs matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.plot(curve[:, 0], 100 * curve[:, 1], label="elongation")
    pyplot.plot(curve[:, 0], 100 * curve[:, 2], label="of which permanent")
    pyplot.xlabel("time [s]")
    pyplot.ylabel("[%]")
    pyplot.legend()
    pyplot.savefig(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--yield-stress", type=float, default=300, metavar="PA")
    parser.add_argument("--flow-rate", type=float, default=4, metavar="PER_S")
    parser.add_argument("--plot", metavar="FILE", help="draw the curves into a .png, .svg or .pdf file (matplotlib)")
    arguments = parser.parse_args()

    curve = stretch(arguments.yield_stress, arguments.flow_rate)
    print("time [s]  elongation [%]  permanent [%]")
    for time, elongation, permanent in curve[49::50]:
        print(f"{time:8.2f}  {100 * elongation:14.3f}  {100 * permanent:13.3f}")
    print(f"permanent elongation: {100 * curve[-1, 2]:.3f} %")
    if arguments.plot:
        plot(curve, arguments.plot)


if __name__ == "__main__":
    main()
