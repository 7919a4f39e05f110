#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the CalculiX deck of a case of tests/data/calculix/bar.json: the upper half of the bar, which is the bar's
mirror image. Other refinements, elements, loads and forces than those of the case may be asked for. --read prints what
the case has for `peak` and `residual`, a line for every quarter of a second.

    benchmarks/calculix/bar_deck.py stretch_viscoCalib_tau100_nu5_F0.1_C3D8 --refine 2 > bar.inp
    ccx -i bar
    benchmarks/calculix/bar_deck.py --read bar.dat --refine 2
"""
import argparse
import json
import pathlib

import numpy as np

from deck import Mesh, body, loads, node_set, read, solid

CELL = 0.01  # [m] of the unrefined mesh
SLICES = 5
DATA = pathlib.Path(__file__).parents[2] / "tests" / "data" / "calculix" / "bar.json"


class HalfBar(Mesh):
    """With the axis z in its middle."""

    def __init__(self, refine):
        super().__init__("bar", (3 * refine, 3 * refine, SLICES * refine), (3 * CELL, 3 * CELL, SLICES * CELL))
        self.positions = self.positions - (1.5 * CELL, 1.5 * CELL, 0)
        self.reach = np.abs(self.positions[:, :2])
        self.end = np.isclose(self.positions[:, 2], SLICES * CELL)

    def shares(self, reach):
        """Share of each node in a force that is even over |x|, |y| <= reach of the end face."""
        inside = self.end & (self.reach < reach + 1e-9).all(axis=1)
        weight = inside * 0.5 ** np.isclose(self.reach, reach).sum(axis=1)
        return weight / weight.sum()


def deck(case, refine, element, load, force, increment):
    mesh = HalfBar(refine)
    lines, places = body(element, mesh)
    last = case["residual"]["time"]
    lines += [*node_set("FIXED", places[:, 2] == 0), "*BOUNDARY", "FIXED, 1, 3", *solid(case["material"]),
              "*TIME POINTS, NAME=PRINTED, GENERATE", f"0.25, {last:g}, 0.25", "*AMPLITUDE, NAME=LOAD", *case["amplitude"],
              "*STEP, NLGEOM, INC=10000",
              "*VISCO, CETOL=1e-3" if any("CREEP" in line for line in case["material"]) else "*STATIC",
              f"{increment:g}, {last:g}, 1e-6, {increment:g}", "*CLOAD, AMPLITUDE=LOAD"]
    if load == "twistface":
        across = mesh.shares(1.5 * CELL)[:, None] * mesh.positions[:, :2]
        forces = 2 * force * CELL / (across * mesh.positions[:, :2]).sum() * across[:, ::-1] * (-1, 1)
    else:
        forces = np.outer(force * mesh.shares(CELL / 2 if load == "stretch" else 1.5 * CELL), (0, 0, 1))
    return lines + [*loads(forces), "*NODE PRINT, NSET=ALL, TIME POINTS=PRINTED", "U", "*END STEP"]


def state(time, mesh, displacements):
    """What bar.json tells of one moment, of the half that is modelled: layers from the middle plane on. The twist is
    that of the corners of the central ninth and of the section."""
    world = mesh.positions + displacements
    layers = [np.isclose(mesh.positions[:, 2], k * CELL) for k in range(SLICES + 1)]
    heights = np.array([world[layer, 2].mean() for layer in layers])
    central = mesh.end & (mesh.reach < CELL / 2 + 1e-9).all(axis=1)
    length = SLICES * CELL
    row = {"time": time, "central_elongation": world[central, 2].mean() / length - 1,
           "mean_elongation": heights[-1] / length - 1, "volume_ratio": mesh.volume_ratio(displacements)}
    rest, now = (points[:, 0] + 1j * points[:, 1] for points in (mesh.positions, world))
    turns = np.degrees(np.angle(now * rest.conj()))
    for name, reach in [("twist_central_deg", CELL / 2), ("twist_corner_deg", 1.5 * CELL)]:
        corners = np.isclose(mesh.reach, reach).all(axis=1)
        row[name] = np.array([turns[layer & corners].mean() for layer in layers])
    row["slice_stretch"] = np.diff(heights) / CELL
    return {key: (np.round(value, 4 if key.endswith("deg") else 9) + 0.0).tolist() for key, value in row.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="?", help="name in tests/data/calculix/bar.json")
    parser.add_argument("--refine", type=int, help="the case's, 1 with --read")
    parser.add_argument("--element", help="C3D8 or C3D8I, the case's if none")
    parser.add_argument("--load", choices=["stretch", "stretchface", "twistface"])
    parser.add_argument("--force", type=float, help="[N] per end")
    parser.add_argument("--increment", type=float, default=0.05, help="longest, of the unit of time")
    parser.add_argument("--read", metavar="FILE.dat", help="print the states of a run")
    options = parser.parse_args()
    if options.read:
        times, tables = read(options.read)
        for time, displacements in zip(times, tables["displacements"]):
            print(json.dumps(state(time, HalfBar(options.refine or 1), displacements)))
        return
    case = json.loads(DATA.read_text())[options.case]
    print("\n".join(deck(case, options.refine or case["refine"], options.element or case["element"],
                         options.load or case["load"], options.force or case["force"],
                         options.increment)))


if __name__ == "__main__":
    main()
