#!/usr/bin/env python3
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
import math
import pathlib

from hyperelastic import volume
from locking import Mesh

CELL = 0.01  # [m] of the unrefined mesh
SLICES = 5
DATA = pathlib.Path(__file__).parents[2] / "tests" / "data" / "calculix" / "bar.json"


def grid(refine):
    """Numbers along x, y, z; node number and place of every node."""
    count = (3 * refine + 1, 3 * refine + 1, SLICES * refine + 1)
    h = CELL / refine
    nodes = {}
    for k in range(count[2]):
        for j in range(count[1]):
            for i in range(count[0]):
                number = 1 + i + count[0] * (j + count[1] * k)
                nodes[number] = (i * h - 1.5 * CELL, j * h - 1.5 * CELL, k * h)
    return count, nodes


def shares(nodes, end, reach, refine):
    """Share of each node of the end face in a force that is even over |x|, |y| <= reach."""
    inside = [n for n in end if max(abs(nodes[n][0]), abs(nodes[n][1])) < reach + 1e-9]
    weight = {}
    for n in inside:
        at_border = sum(abs(abs(nodes[n][axis]) - reach) < 1e-9 for axis in (0, 1))
        weight[n] = 0.5**at_border
    total = sum(weight.values())
    return {n: w / total for n, w in weight.items()}


def deck(case, refine, element, load, force, increment):
    count, nodes = grid(refine)
    lines = ["*NODE, NSET=ALL"] + [f"{n}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in nodes.items()]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=BODY")
    number = 0
    for k in range(count[2] - 1):
        for j in range(count[1] - 1):
            for i in range(count[0] - 1):
                number += 1
                a = 1 + i + count[0] * (j + count[1] * k)
                b, up = a + count[0], count[0] * count[1]
                corners = [a, a + 1, b + 1, b]
                lines.append(", ".join(map(str, [number] + corners + [c + up for c in corners])))
    fixed = [n for n, x in nodes.items() if x[2] < 1e-9]
    end = [n for n, x in nodes.items() if x[2] > SLICES * CELL - 1e-9]
    lines += ["*NSET, NSET=FIXED"] + [f"{n}," for n in fixed]
    lines += ["*BOUNDARY", "FIXED, 1, 3", "*MATERIAL, NAME=SOLID"] + case["material"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"]
    last = case["residual"]["time"]
    lines += ["*TIME POINTS, NAME=PRINTED, GENERATE", f"0.25, {last:g}, 0.25"]
    lines += ["*AMPLITUDE, NAME=LOAD"] + case["amplitude"] + ["*STEP, NLGEOM, INC=10000"]
    lines += ["*VISCO, CETOL=1e-3" if any("CREEP" in line for line in case["material"]) else "*STATIC"]
    lines += [f"{increment:g}, {last:g}, 1e-6, {increment:g}", "*CLOAD, AMPLITUDE=LOAD"]
    if load == "twistface":
        share = shares(nodes, end, 1.5 * CELL, refine)
        moment = sum(s * (nodes[n][0] ** 2 + nodes[n][1] ** 2) for n, s in share.items())
        scale = 2 * force * CELL / moment
        for n, s in share.items():
            lines += [f"{n}, 1, {-scale * s * nodes[n][1]:.9g}", f"{n}, 2, {scale * s * nodes[n][0]:.9g}"]
    else:
        reach = CELL / 2 if load == "stretch" else 1.5 * CELL
        lines += [f"{n}, 3, {force * s:.9g}" for n, s in shares(nodes, end, reach, refine).items()]
    return lines + ["*NODE PRINT, NSET=ALL, TIME POINTS=PRINTED", "U", "*END STEP"]


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def turn(x, world):
    """Angle [deg] about the axis."""
    return math.degrees(math.remainder(math.atan2(world[1], world[0]) - math.atan2(x[1], x[0]), math.tau))


def state(time, nodes, moved, refine):
    """What bar.json tells of one moment, of the half that is modelled: layers from the middle plane on. The twist is
    that of the corners of the central ninth and of the section."""
    world = {n: [a + u for a, u in zip(x, moved[n])] for n, x in nodes.items()}
    layers = [[n for n, x in nodes.items() if abs(x[2] - k * CELL) < 1e-9] for k in range(SLICES + 1)]
    heights = [mean(world[n][2] for n in layer) for layer in layers]
    central = [n for n in layers[-1] if max(abs(nodes[n][0]), abs(nodes[n][1])) < CELL / 2 + 1e-9]
    length, width = SLICES * CELL, 3 * CELL
    mesh = Mesh("bar", (3 * refine, 3 * refine, SLICES * refine), size=(width, width, length))  # the same order
    row = {"time": time, "central_elongation": mean(world[n][2] for n in central) / length - 1,
           "mean_elongation": heights[-1] / length - 1,
           "volume_ratio": volume(mesh, dict(zip(mesh.positions, moved.values()))) / (width**2 * length)}
    for name, reach in [("twist_central_deg", CELL / 2), ("twist_corner_deg", width / 2)]:
        row[name] = [mean(turn(nodes[n], world[n]) for n in layer
                          if all(abs(abs(nodes[n][axis]) - reach) < 1e-9 for axis in (0, 1))) for layer in layers]
    row["slice_stretch"] = [(high - low) / CELL for low, high in zip(heights, heights[1:])]
    return row


def read(path, refine):
    """State at every printed time, from the displacements of all nodes."""
    _, nodes = grid(refine)
    rows, time, moved = [], None, {}
    for line in pathlib.Path(path).read_text().splitlines():
        words = line.split()
        if "time" in words:
            time, moved = float(words[-1]), {}
        elif len(words) == 4 and words[0].isdigit():
            moved[int(words[0])] = [float(word) for word in words[1:]]
            if len(moved) == len(nodes):
                rows.append(state(time, nodes, moved, refine))
    return rows


def rounded(value, digits):
    return [rounded(entry, digits) for entry in value] if isinstance(value, list) else round(value, digits) + 0.0


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
        for row in read(options.read, options.refine or 1):
            print(json.dumps({key: rounded(value, 4 if key.endswith("deg") else 9) for key, value in row.items()}))
        return
    case = json.loads(DATA.read_text())[options.case]
    print("\n".join(deck(case, options.refine or case["refine"], options.element or case["element"],
                         options.load or case["load"], options.force or case["force"],
                         options.increment)))


if __name__ == "__main__":
    main()
