# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads a .vtu file with meshio and writes its arrays as raw bytes: dump_vtu.py FILE OUT NAME...

NAME is `points`, `kinds` (of the blocks of cells, one after the other), `cells` (of the first block), or the name of a
point or cell array; each is written as a line `NAME bytes` and then the bytes."""
import sys

import meshio
import numpy

mesh = meshio.read(sys.argv[1])
with open(sys.argv[2], "wb") as out:
    for name in sys.argv[3:]:
        if name == "points":
            array = mesh.points
        elif name == "kinds":
            array = numpy.frombuffer(" ".join(block.type for block in mesh.cells).encode(), numpy.uint8)
        elif name == "cells":
            array = mesh.cells[0].data.astype(numpy.int32)
        elif name in mesh.point_data:
            array = mesh.point_data[name]
        else:
            array = mesh.cell_data[name][0]
        data = numpy.ascontiguousarray(array).tobytes()
        out.write(f"{name} {len(data)}\n".encode() + data)
