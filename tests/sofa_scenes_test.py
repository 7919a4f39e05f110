#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Holds scripts/sofa_scenes against a small tree that is made for it: sofa_scenes_test.py BUILD"""
import pathlib
import re
import stat
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BODY = """<EulerImplicitSolver/><SparseLDLSolver/>
<RegularGridTopology n="3 2 2"/><MechanicalObject/><UniformMass totalMass="1"/>
<HexahedronFEMForceField youngModulus="3000" poissonRatio=".3"/>"""
FILES = {
    "share/mesh/triangle.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "examples/Objects/part.xml": f'<Node name="Group">{BODY}</Node>',
    "examples/plain.scn": f'<Node dt="0.01"><DefaultAnimationLoop/>{BODY}</Node>',
    "examples/with include.scn": '<Node><DefaultAnimationLoop/><include href="Objects/part.xml"/>'
                                 '<MeshOBJLoader filename="mesh/triangle.obj"/><LineAxis/></Node>',
    "examples/contact.scn": f'<Node><DefaultAnimationLoop/><CollisionPipeline/><!-- <Hidden/> -->{BODY}'
                            '<Object type="OddEngine"/></Node>',
    "examples/foreign.scn": f'<Node><DefaultAnimationLoop/>{BODY}<BeamFEMForceField/></Node>',
    "examples/broken.scn": '<Node><RegularGridTopology n="2 2 2"max="1 1 1"/></Node>',
}
LIST = "# as the real one\n" + "".join(f"{name}\n" for name in FILES if name.endswith(".scn"))
# a runSofa whose positions are those of hexaplast, and in the first coordinate more by SHIFT
RUNSOFA = """#!/usr/bin/env python3
import pathlib, re, subprocess, sys, tempfile
import xml.etree.ElementTree as ET
root = ET.parse(sys.argv[-1]).getroot()
steps = int(sys.argv[sys.argv.index("-n") + 1])
for node in list(root.iter("Node")):
    for child in list(node):
        if child.tag in ("DifferenceEngine", "VTKExporter", "RequiredPlugin"):
            node.remove(child)
        if child.tag == "DifferenceEngine":
            subtracted = [float(word) for word in child.get("substractor").split()]
            ET.SubElement(node, "WriteState", filename="state.txt", writeX="1", time=repr(steps * 0.01))
        if child.tag == "VTKExporter":
            out = child.get("filename") + "0.vtu"
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "scene.scn").write_text(ET.tostring(root, encoding="unicode"))
    subprocess.run(["COMMAND", "run", folder / "scene.scn", "--quiet", "--steps", str(steps + 1),
                    "--write-below", folder], check=True)
    x = [line for line in (folder / "state.txt").read_text().splitlines() if line.strip().startswith("X=")][-1]
values = [float(word) - other for word, other in zip(x.split("=")[1].split(), subtracted)]
values[0] += SHIFT
pathlib.Path(out).write_text('<DataArray Name="output">' + " ".join(map(repr, values)) + "</DataArray>")
"""

def run(tree, *options):
    done = subprocess.run([ROOT / "scripts" / "sofa_scenes", tree, "--build", sys.argv[1], "--list", tree / "list.txt",
                           "--steps", "3", *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def row(table, first):
    lines = [line for line in table.splitlines() if line.startswith(f"| {first} |")]
    assert len(lines) == 1, f"{first}: {lines}\n{table}"
    return [cell.strip() for cell in lines[0].strip("|").split("|")]


def main():
    with tempfile.TemporaryDirectory() as name:
        tree = pathlib.Path(name)
        for file, text in {**FILES, "list.txt": LIST}.items():
            (tree / file).parent.mkdir(parents=True, exist_ok=True)
            (tree / file).write_text(text)

        table = run(tree)
        assert "Of 5 scenes, 2 load strictly and 3 with `--sofa-compat`. 3 of these run 3 steps." in table, table
        assert row(table, "examples/plain.scn")[1:4] == ["yes", "yes", "yes"], table
        assert row(table, "examples/with include.scn")[1:4] == ["yes", "yes", "yes"], table
        assert row(table, "examples/contact.scn")[1:4] == ["no", "yes", "yes"], table
        assert row(table, "examples/foreign.scn")[1:3] == ["no", "no"], table
        assert "BeamFEMForceField: changes the motion" in row(table, "examples/foreign.scn")[4], table
        assert "no blank follows" in row(table, "examples/broken.scn")[4], table

        assert row(table, "`HexahedronFEMForceField`")[1:] == ["4", "4", "ours"], table
        assert row(table, "`RegularGridTopology`")[1:3] == ["5", "5"], table
        assert row(table, "`LineAxis`")[3] == "accepted, only seen", table
        assert row(table, "`CollisionPipeline`")[3] == "skipped with --sofa-compat: contact", table
        assert row(table, "`OddEngine`")[3].startswith("skipped with --sofa-compat: unknown"), table
        assert row(table, "`BeamFEMForceField`")[3].startswith("refused: changes the motion"), table
        assert "Hidden" not in table and "`Object`" not in table, table

        markdown = run(tree, "--markdown")
        assert "Of 5 scenes" in markdown and "`LineAxis`" in markdown and "plain.scn" not in markdown, markdown

        sofa = tree / "runSofa"
        command = str(pathlib.Path(sys.argv[1]).absolute() / "bin" / "hexaplast")
        for shift, difference in (("0", r"0\.0e\+00"), ("1e-6", r"5\.8e-07")):  # of a diagonal of sqrt(3)
            sofa.write_text(RUNSOFA.replace("COMMAND", command).replace("SHIFT", shift))
            sofa.chmod(sofa.stat().st_mode | stat.S_IXUSR)
            against = run(tree, "--runsofa", sofa)
            for scene in ("plain", "with include"):
                assert re.fullmatch(difference, row(against, f"examples/{scene}.scn")[5]), against
    assert row(against, "examples/contact.scn")[5] == "not compared: OddEngine: unknown component, ignored", against


if __name__ == "__main__":
    main()
