#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the body of a scene as a deck for a static analysis by CalculiX or Abaqus: its hexahedra as C3D8, its held nodes
and its loads in the last step, with large displacements. The scene has one body, of one elastic material and without
weight. Numbers of nodes and hexahedra are those of the scene plus one.

    benchmarks/calculix/scene_deck.py scenes/cantilever_static.scn > beam.inp
    ccx -i beam
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import meshio
import numpy as np


def rows(table):
    return [", ".join(f"{value:.13g}" for value in row) for row in table]


def deck(scene, hexaplast):
    with tempfile.TemporaryDirectory() as folder:
        run = pathlib.Path(folder) / "run"
        found = json.loads(subprocess.run([hexaplast, "check", scene, "--json"], check=True, stdout=subprocess.PIPE).stdout)
        subprocess.run([hexaplast, "run", scene, "--quiet", "--frames", "0", "--out", run], check=True)
        mesh = meshio.read(max(run.glob("mesh_*.vtu")))
    body = found["body"]
    if body is None or body["young_modulus"][0] != body["young_modulus"][1]:
        sys.exit(f"{scene}: must have one body, of one material")
    loads = mesh.point_data["load"]
    if np.linalg.norm(loads.sum(axis=0) - found["load"]) > 1e-9 * np.abs(loads).sum():
        sys.exit(f"{scene}: has weight, or loads that end before the run: must have neither")
    nodes = np.arange(1, len(mesh.points) + 1)
    cells = mesh.cells_dict["hexahedron"] + 1
    loaded = [(node, axis + 1, load[axis]) for node, load in zip(nodes, loads) for axis in range(3) if load[axis] != 0]
    return "\n".join([
        "*NODE, NSET=ALL", *rows(np.column_stack([nodes, mesh.points - mesh.point_data["displacement"]])),
        "*ELEMENT, TYPE=C3D8, ELSET=BODY", *rows(np.column_stack([np.arange(1, len(cells) + 1), cells])),
        "*MATERIAL, NAME=BODY", "*ELASTIC", f"{body['young_modulus'][0]:.13g}, {body['poisson_ratio'][0]:.13g}",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=BODY",
        "*NSET, NSET=FIXED", *rows(nodes[mesh.point_data["fixed"].ravel() != 0].reshape(-1, 1)),
        "*BOUNDARY", "FIXED, 1, 3", "*STEP, NLGEOM, INC=1000", "*STATIC", "0.1, 1", "*CLOAD", *rows(loaded),
        "*NODE PRINT, NSET=ALL", "U", "*END STEP", ""])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--hexaplast", default=pathlib.Path(__file__).parents[2] / "build/bin/hexaplast", help="the command")
    options = parser.parse_args()
    print(deck(options.scene, options.hexaplast), end="")
