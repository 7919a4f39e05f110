#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Finds the yield stress and the flow rate of a material from a curve of force over time.

A cube is stretched at constant speed and then held: its force rises, bends where flow begins, and relaxes. Give the curve
of an experiment (CSV rows time,force), or none: then one is generated, so that what is found can be compared.

    python3 fit.py [CURVE.csv] [--noise SHARE]
"""
import argparse

import numpy as np

import hexaplast

EDGE = 0.1  # [m] of the cube
YOUNG, POISSON = 5000.0, 0.45  # known: the slope of the curve's beginning
STRETCH, RAMP = 0.3, 0.5  # [-] of the edge, reached after this time [s]
TRUTH = (250.0, 3.0)  # [Pa], [1/s] of the generated curve
START = (100.0, 1.0)  # where the search begins


def force_curve(times, yield_stress, flow_rate):
    """Axial force [N] at the end of each time step, of a cube that keeps its volume."""
    positions, hexahedra = hexaplast.grid((1, 1, 1), (0, 0, 0), (EDGE, EDGE, EDGE))
    body = hexaplast.Body(
        positions,
        hexahedra,
        hexaplast.Material(
            young_modulus=YOUNG, poisson_ratio=POISSON, yield_stress=yield_stress, flow_rate=flow_rate
        ),
    )
    top = positions[:, 2] > EDGE / 2
    forces, before = [], 0.0
    for time in times:
        stretch = 1 + STRETCH * min(time / RAMP, 1)
        x = positions * [stretch**-0.5, stretch**-0.5, stretch]
        body.flow(x, time - before)
        forces.append(-body.force(x)[top, 2].sum())
        before = time
    return np.array(forces)


def fit(times, measured, start=START, iterations=30):
    """Gauss-Newton on the logarithms of both, so that they stay positive; a step that does not help is halved."""
    scale = abs(measured).max()

    def misfit(logs):
        return (force_curve(times, *np.exp(logs)) - measured) / scale

    logs = np.log(start)
    here = misfit(logs)
    for _ in range(iterations):
        slopes = np.column_stack([(misfit(logs + h) - misfit(logs - h)) / 2e-4 for h in 1e-4 * np.eye(2)])
        step = np.linalg.lstsq(slopes, -here, rcond=None)[0]
        step *= min(1, 1 / abs(step).max())
        while abs(step).max() > 1e-9 and not (misfit(logs + step) ** 2).sum() < (here**2).sum():
            step /= 2
        if abs(step).max() <= 1e-9:
            break
        logs = logs + step
        here = misfit(logs)
    return np.exp(logs), np.sqrt((here**2).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("curve", nargs="?", metavar="CURVE.csv")
    parser.add_argument("--noise", type=float, default=0.0, metavar="SHARE", help="of the generated curve")
    arguments = parser.parse_args()

    if arguments.curve:
        times, measured = np.loadtxt(arguments.curve, delimiter=",", unpack=True)
    else:
        times = np.arange(1, 101) * 0.01
        measured = force_curve(times, *TRUTH)
        noise = np.random.default_rng(1).normal(size=len(times))
        measured += arguments.noise * abs(measured).max() * noise
        print(f"generated with   yield stress {TRUTH[0]:.4f} Pa, flow rate {TRUTH[1]:.5f} 1/s")

    (yield_stress, flow_rate), error = fit(times, measured)
    print(f"found            yield stress {yield_stress:.4f} Pa, flow rate {flow_rate:.5f} 1/s")
    print(f"misfit           {100 * error:.2g} % of the greatest force")


if __name__ == "__main__":
    main()
