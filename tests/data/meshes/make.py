#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the mesh files that mesh_file_test.cpp reads, by meshio: two hexahedra without symmetry, a quad and two
triangles on them, a line, and a tetrahedron, which the readers skip; and a cube."""
import meshio
import numpy as np

points = np.array([
    [0, 0, 0], [1.25, 0, 0.1], [2, 0.1, 0], [0, 1, 0], [1, 1.1, 0], [2.1, 1, 0],
    [0, 0, 1], [1, 0, 1.3], [2, 0, 1], [0.1, 1, 1.1], [1, 1, 1], [2, 1, 0.9], [3, 3, 3]], dtype=float)
cells = [
    ("hexahedron", np.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]])),
    ("quad", np.array([[6, 7, 10, 9]])),
    ("triangle", np.array([[7, 8, 11], [7, 11, 10]])),
    ("line", np.array([[0, 3]])),
    ("tetra", np.array([[5, 11, 10, 12]])),
]
mesh = meshio.Mesh(points, cells)
meshio.gmsh.write("two_22_ascii.msh", mesh, "2.2", binary=False)
meshio.gmsh.write("two_22_binary.msh", mesh, "2.2", binary=True)
tags = [np.full(len(block), tag) for (_, block), tag in zip(cells, (1, 1, 2, 1, 2))]
in_volume = meshio.Mesh(points, cells, point_data={"gmsh:dim_tags": np.array([[3, 1]] * len(points))},
                        cell_data={"gmsh:geometrical": tags, "gmsh:physical": tags})
meshio.gmsh.write("two_41_ascii.msh", in_volume, "4.1", binary=False)
meshio.gmsh.write("two_41_binary.msh", in_volume, "4.1", binary=True)
meshio.vtk.write("two_42_ascii.vtk", mesh, "4.2", binary=False)
meshio.vtk.write("two_42_binary.vtk", mesh, "4.2", binary=True)
meshio.vtk.write("two_51_ascii.vtk", mesh, "5.1", binary=False)
meshio.vtk.write("two_51_binary.vtk", mesh, "5.1", binary=True)
meshio.vtu.write("two_ascii.vtu", mesh, binary=False)
meshio.vtu.write("two_base64.vtu", mesh, binary=True, compression=None)
meshio.vtu.write("two_zlib.vtu", mesh, binary=True, compression="zlib", header_type="UInt64")

# a cube of 0.1 m, for the examples of the component page
corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]) * 0.1
cube = meshio.Mesh(corners, [("hexahedron", np.arange(8).reshape(1, 8))])
meshio.gmsh.write("block.msh", cube, "4.1", binary=False)
meshio.vtk.write("block.vtk", cube, "4.2", binary=False)

surface = meshio.Mesh(points, cells[1:3])
meshio.obj.write("surface.obj", surface)

# the box of organ.obj
box = np.array([[(a & 1) * 0.1, (a >> 1 & 1) * 0.1, (a >> 2) * 0.4] for a in range(8)])
faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
organ = meshio.Mesh(box, [("triangle", np.array([t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])]))])
meshio.stl.write("organ_ascii.stl", organ)
meshio.stl.write("organ_binary.stl", organ, binary=True)
