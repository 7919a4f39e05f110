#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the CalculiX deck of a case of tests/data/calculix/bar.json: the upper half of the bar, which is the bar's
mirror image. Other refinements, elements, loads and forces than those of the case may be asked for.

    benchmarks/calculix/bar_deck.py stretch_viscoCalib_tau100_nu5_F0.1_C3D8 --refine 2 > bar.inp
    ccx -i bar
    benchmarks/calculix/bar_deck.py --read bar.dat --refine 2
"""
import argparse
import json
import pathlib

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


def deck(case, refine, element, load, force):
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
    lines += ["*NSET, NSET=FIXED"] + [f"{n}," for n in fixed] + ["*NSET, NSET=END"] + [f"{n}," for n in end]
    lines += ["*BOUNDARY", "FIXED, 1, 3", "*MATERIAL, NAME=SOLID"] + case["material"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"]
    lines += ["*AMPLITUDE, NAME=LOAD"] + case["amplitude"] + ["*STEP, NLGEOM, INC=10000"]
    last = case["residual"]["time"]
    # long increments would let a ramp end within one
    lines += ["*VISCO, CETOL=1e-3" if any("CREEP" in line for line in case["material"]) else "*STATIC"]
    lines += [f"0.02, {last:g}, 1e-6, 0.05", "*CLOAD, AMPLITUDE=LOAD"]
    if load == "twistface":
        share = shares(nodes, end, 1.5 * CELL, refine)
        moment = sum(s * (nodes[n][0] ** 2 + nodes[n][1] ** 2) for n, s in share.items())
        scale = 2 * force * CELL / moment
        for n, s in share.items():
            lines += [f"{n}, 1, {-scale * s * nodes[n][1]:.9g}", f"{n}, 2, {scale * s * nodes[n][0]:.9g}"]
    else:
        reach = CELL / 2 if load == "stretch" else 1.5 * CELL
        lines += [f"{n}, 3, {force * s:.9g}" for n, s in shares(nodes, end, reach, refine).items()]
    return lines + ["*NODE PRINT, NSET=END, FREQUENCY=1", "U", "*END STEP"]


def read(path, refine):
    """Elongations over time from the displacements of the end face."""
    _, nodes = grid(refine)
    rows, time, heights = [], None, {}

    def finish():
        if heights:
            central = [u for n, u in heights.items() if max(abs(nodes[n][0]), abs(nodes[n][1])) < CELL / 2 + 1e-9]
            length = SLICES * CELL
            rows.append((time, sum(central) / len(central) / length, sum(heights.values()) / len(heights) / length))

    for line in pathlib.Path(path).read_text().splitlines():
        words = line.split()
        if "time" in words:
            finish()
            time, heights = float(words[-1]), {}
        elif len(words) == 4 and words[0].isdigit():
            heights[int(words[0])] = float(words[3])
    finish()
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="?", help="name in tests/data/calculix/bar.json")
    parser.add_argument("--refine", type=int, default=1)
    parser.add_argument("--element", default="C3D8", help="C3D8 or C3D8I")
    parser.add_argument("--load", choices=["stretch", "stretchface", "twistface"])
    parser.add_argument("--force", type=float, help="[N] per end")
    parser.add_argument("--read", metavar="FILE.dat", help="print time,central_elongation,mean_elongation of a run")
    options = parser.parse_args()
    if options.read:
        print("time,central_elongation,mean_elongation")
        for row in read(options.read, options.refine):
            print(",".join(f"{value:.7g}" for value in row))
        return
    case = json.loads(DATA.read_text())[options.case]
    print("\n".join(deck(case, options.refine, options.element, options.load or case["load"],
                         options.force or case["force"])))


if __name__ == "__main__":
    main()
