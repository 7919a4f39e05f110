#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Decodes what a report's viewer shows and holds it against the run's .vtu files: viewer_data.py HEXAPLAST SCENE STEPS DIRECTORY

Positions must be those of the .vtu files to half a step of their 16 bits, plastic strains within the range of the
hexahedra around a node, hexahedra that are gone those that the files lack, and embedded points where surface.pvd has
them. A report of 60 states stays below half a megabyte per thousand nodes."""
import array
import base64
import html.parser
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import xml.etree.ElementTree as ET
import zlib

HALF_A_MEGABYTE = 512 * 1024


class RunData(html.parser.HTMLParser):
    """The element that holds the data, as a browser finds it."""

    def __init__(self, page):
        super().__init__()
        self.found, self._is_in = [], False
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self._is_in = tag == "script" and ("class", "run") in attributes

    def handle_endtag(self, tag):
        self._is_in = False

    def handle_data(self, text):
        if self._is_in:
            self.found.append(text)


def unpacked(data):
    raw, at, arrays = zlib.decompress(base64.b64decode(data["data"])), 0, {}
    for entry in data["arrays"]:
        size, count, stride = entry["bits"] // 8, entry["count"], entry["stride"]
        planes = [raw[at + k * count:at + (k + 1) * count] for k in range(size)]
        values = []
        for i, parts in enumerate(zip(*planes)):
            folded = int.from_bytes(bytes(parts), "little")
            difference = -(folded + 1) // 2 if folded % 2 else folded // 2
            values.append(((values[i - stride] if i >= stride else 0) + difference) % 2 ** entry["bits"])
        arrays[entry["name"]] = values
        at += size * count
    assert at == len(raw), "bytes are left over"
    return arrays


def arrays_of(vtu):
    """Name: numbers of the arrays of a .vtu file with raw data behind its XML."""
    content = vtu.read_bytes()
    begin = content.index(b"<AppendedData")
    begin = content.index(b"_", begin) + 1
    head = content[:content.index(b"<AppendedData")].decode() + "</VTKFile>"
    types = {"Float64": "d", "Float32": "f", "Int32": "i", "Int64": "q", "UInt8": "B"}
    found = {}
    for element in ET.fromstring(head).iter("DataArray"):
        offset = begin + int(element.get("offset"))
        size, = struct.unpack_from("<Q", content, offset)
        numbers = array.array(types[element.get("type")], content[offset + 8:offset + 8 + size])
        found[element.get("Name") or "Points"] = numbers
    return found


def series(pvd):
    return {int(re.search(r"(\d+)\.vtu", name).group(1)): pvd.parent / name
            for name in re.findall(r'file="([^"]+)"', pvd.read_text())}


def places(numbers, box, axis_of=3):
    return [box[i % axis_of] + q / 65535 * (box[3 + i % 3] - box[i % 3]) for i, q in enumerate(numbers)]


def farthest(ours, theirs):
    """By axis."""
    return [max(abs(a - b) for a, b in zip(ours[axis::3], theirs[axis::3])) for axis in range(3)]


def main():
    hexaplast, scene, steps, directory = sys.argv[1], sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])
    shutil.rmtree(directory, ignore_errors=True)
    subprocess.run([hexaplast, "run", scene, "--steps", steps, "--frames", "0", "--quiet", "--out", directory], check=True)
    found = RunData((directory / "report.html").read_text()).found
    assert len(found) == 1, f"{len(found)} runs in the report"
    data = json.loads(found[0])
    arrays, box, count = unpacked(data), data["box"], data["nodes"]
    half = [0.5 * (box[3 + axis] - box[axis]) / 65535 * 1.001 + 1e-7 * max(map(abs, box)) for axis in range(3)]
    meshes, surfaces = series(directory / "mesh.pvd"), {}
    if (directory / "surface.pvd").exists():
        surfaces = series(directory / "surface.pvd")
    strain = next((field for field in data["fields"] if field["word"] == "plastic_strain"), None)

    wrong, compared, gone = [], 0, set()
    for s, state in enumerate(data["states"]):
        gone |= set(state.get("gone", []))
        if state["step"] not in meshes:
            continue
        compared += 1
        mesh = arrays_of(meshes[state["step"]])
        ours = places(arrays["positions"][3 * count * s:3 * count * (s + 1)], box)
        if any(d > limit for d, limit in zip(farthest(ours, mesh["Points"]), half)):
            wrong.append(f"step {state['step']}: positions are off by {farthest(ours, mesh['Points'])}, at most {half}")
        left = set(range(data["hexahedra"])) - gone
        if left != set(mesh["id"]):
            wrong.append(f"step {state['step']}: {len(left)} hexahedra, must be the {len(mesh['id'])} of the .vtu file")
        if strain:
            values = arrays["values_plastic_strain"][count * s:count * (s + 1)]
            quantum = (strain["most"] - strain["least"]) / 254
            around = {}
            for cell, value in enumerate(mesh["plastic_strain"]):
                for node in mesh["connectivity"][8 * cell:8 * cell + 8]:
                    around.setdefault(node, []).append(value)
            for node, near in around.items():
                value = strain["least"] + quantum * values[node]
                if not min(near) - quantum <= value <= max(near) + quantum:
                    wrong.append(f"step {state['step']}, node {node}: plastic strain {value}, around it {near}")
                    break
        if data["embedded"] and state["step"] in surfaces:
            ours = []
            for number, limits in enumerate(data["embedded"]):
                span = limits["most"] - limits["least"]
                moved = places(arrays["positions"][3 * count * s:3 * count * (s + 1)], box)
                for point, carrier in enumerate(arrays[f"carriers_{number}"]):
                    nodes = arrays["hexahedra"][8 * carrier:8 * carrier + 8]
                    weights = [limits["least"] + span * q / 65535
                               for q in arrays[f"weights_{number}"][7 * point:7 * point + 7]]
                    weights.insert(0, 1 - sum(weights))
                    ours += [sum(w * moved[3 * node + axis] for w, node in zip(weights, nodes)) for axis in range(3)]
            off = farthest(ours, arrays_of(surfaces[state["step"]])["Points"])
            if any(d > 6 * limit for d, limit in zip(off, half)):  # eight corners and eight weights are rounded
                wrong.append(f"step {state['step']}: embedded points are off by {off}")
    if compared < 3:
        wrong.append(f"{compared} states could be compared")
    size = len(found[0])
    if size * 1000 / max(count, 1000) > HALF_A_MEGABYTE:
        wrong.append(f"{size} bytes for {len(data['states'])} states of {count} nodes")
    print("\n".join(wrong) or f"{compared} states agree; {size} bytes for {len(data['states'])} states of {count} nodes, "
                             f"{len(gone)} hexahedra gone")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
