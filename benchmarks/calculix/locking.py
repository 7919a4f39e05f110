#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bends a slender cantilever with CalculiX for Poisson's ratios up to nearly 1/2 and prints tests/data/calculix/
locking.json: the deflection of its tip over that of Timoshenko's beam, by element. ccx must be installed.

The beam: 1 x 0.1 x 0.1 m of 20 x 2 x 2 cubes, E = 5000 Pa, one end clamped, a force even over the face of the other;
linear statics. C3D20R has a node in the middle of every edge; with half the edge it is the answer to compare with.
"""
import json
import pathlib
import subprocess
import tempfile

YOUNG, LENGTH, WIDTH, FORCE = 5000.0, 1.0, 0.1, 1e-3
POISSON_RATIOS = [0.0, 0.3, 0.45, 0.49, 0.499]
# nodes of a quadratic element, in units of half an edge: corners, then the edges below, above, and upright
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
         (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
# share of a load that is even over an element's face, by whether the node is a corner or lies on an edge
FACE_SHARE = {8: {"corner": 1 / 4, "edge": 0}, 20: {"corner": -1 / 12, "edge": 1 / 3}}


def deck(element, poisson_ratio, across):
    """Lines of the deck, and the force [N] on each of the tip's nodes."""
    cells = (10 * across, across, across)
    half = WIDTH / across / 2
    pattern = CORNERS + (EDGES if element.startswith("C3D20") else [])
    number, hexahedra, load = {}, [], {}
    for k in range(cells[2]):
        for j in range(cells[1]):
            for i in range(cells[0]):
                # nodes are numbered as they come
                places = [(2 * i + a, 2 * j + b, 2 * k + c) for a, b, c in pattern]
                hexahedra.append([number.setdefault(place, len(number) + 1) for place in places])
                if i + 1 < cells[0]:
                    continue
                for place, (a, b, c) in zip(places, pattern):
                    if a == 2:
                        kind = "edge" if 1 in (b, c) else "corner"
                        load[place] = load.get(place, 0) + FACE_SHARE[len(pattern)][kind] * FORCE / across**2
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{n}, {x * half:.9g}, {y * half:.9g}, {z * half:.9g}" for (x, y, z), n in number.items()]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=BODY")
    for e, nodes in enumerate(hexahedra, 1):
        words = [str(word) for word in [e] + nodes]  # a line of a deck holds 16 at most
        lines += [", ".join(words[i:i + 11]) + ("," if i + 11 < len(words) else "") for i in range(0, len(words), 11)]
    lines += ["*NSET, NSET=WALL"] + [f"{n}," for place, n in number.items() if place[0] == 0]
    lines += ["*NSET, NSET=TIP"] + [f"{number[place]}," for place in load]
    lines += ["*BOUNDARY", "WALL, 1, 3", "*MATERIAL, NAME=SOLID", "*ELASTIC", f"{YOUNG}, {poisson_ratio}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID", "*STEP", "*STATIC", "*CLOAD"]
    lines += [f"{number[place]}, 3, {share:.12g}" for place, share in load.items()]
    lines += ["*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    return lines, {number[place]: share for place, share in load.items()}


def relative_deflection(element, poisson_ratio, across=2):
    """Mean deflection of the tip, weighted with the load, over Timoshenko's."""
    lines, load = deck(element, poisson_ratio, across)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "beam.inp").write_text("\n".join(lines) + "\n")
        subprocess.run(["ccx", "-i", "beam"], cwd=path, check=True, stdout=subprocess.DEVNULL)
        rows = [line.split() for line in (path / "beam.dat").read_text().splitlines()]
    moved = {int(row[0]): float(row[3]) for row in rows if len(row) == 4 and row[0].isdigit()}
    deflection = sum(load[n] * moved[n] for n in load) / FORCE
    area = WIDTH**2
    shear = YOUNG / (2 * (1 + poisson_ratio))
    timoshenko = FORCE * LENGTH**3 / (3 * YOUNG * area**2 / 12) + FORCE * LENGTH / (5 / 6 * shear * area)
    return deflection / timoshenko


def main():
    table = {"poisson_ratio": POISSON_RATIOS}
    for across, suffix in [(2, ""), (4, "_refined")]:
        for element in ["C3D8", "C3D8I", "C3D20R"]:
            table[element + suffix] = [round(relative_deflection(element, nu, across), 5) for nu in POISSON_RATIOS]
    rows = ",\n".join(f' "{name}": {json.dumps(values)}' for name, values in table.items())
    print("{\n" + rows + "\n}")


if __name__ == "__main__":
    main()
