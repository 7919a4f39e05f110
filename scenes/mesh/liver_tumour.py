#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the segmentation of a liver with a tumour and a vessel: `./liver_tumour.py liver_tumour.seg.nrrd`. The ending of the
file's name chooses the format: .nrrd (with the names of segments, as 3D Slicer writes them), .nii.gz or .mha.

48 x 40 x 32 voxels of 5 x 4.5 x 4 mm in a frame that is turned by 20 degrees about the axis from foot to head. Label 1 is the
liver: a thick right lobe and a thin left one, domed towards the head. Label 2 is a tumour, a ball in the right lobe. Label 3 is a
vessel, a bent tube in both lobes. A crumb of label 1 lies apart, as segmentations by threshold have them.

`hexaplast mesh voxels liver_tumour.seg.nrrd --coarsen 2 --largest-part --ascii -o liver_tumour.vtu` makes the mesh.
"""
import gzip
import struct
import sys
import zlib

import numpy as np

SIZE = (48, 40, 32)
SPACING = np.array([5.0, 4.5, 4.0])                   # [mm]
ANGLE = np.radians(20)
DIRECTIONS = np.array([[np.cos(ANGLE), -np.sin(ANGLE), 0],
                       [np.sin(ANGLE), np.cos(ANGLE), 0],
                       [0, 0, 1]])                    # columns: the axes, in LPS
ORIGIN = np.array([-90.0, -60.0, 1200.0])             # [mm] centre of voxel (0, 0, 0), in LPS
NAMES = {1: "liver", 2: "tumour", 3: "vessel"}
COLOURS = {1: "0.87 0.72 0.55", 2: "0.57 0.23 0.35", 3: "0.85 0.40 0.31"}


def draw():
    """Labels as an array [i, j, k], the i-th voxel from right to left, the j-th to the back, the k-th to the head."""
    place = np.stack(np.meshgrid(*(np.arange(n) for n in SIZE), indexing="ij"), axis=-1) * SPACING
    x, y, z = np.moveaxis(place, -1, 0)               # [mm] from the first voxel
    left = np.clip((x - 20) / 200, 0, 1)              # 0 at the right end of the liver, 1 at the left one
    middle_z = 58 + 12 * left                         # the left lobe lies higher
    half_height = 50 * (1 - 0.65 * left ** 1.2)
    half_depth = 72 * (1 - 0.45 * left ** 2)
    dome = np.where(z > middle_z, 1.0, 1.35)          # flat below
    liver = (((x - 118) / 104) ** 2 + ((y - 88) / half_depth) ** 2 + (dome * (z - middle_z) / half_height) ** 2) <= 1
    tumour = (x - 78) ** 2 + (y - 70) ** 2 + (z - 58) ** 2 <= 21 ** 2
    course_y, course_z = 96 - 18 * np.sin(left * np.pi), 56 + 14 * left
    vessel = ((y - course_y) ** 2 + (z - course_z) ** 2 <= 8 ** 2) & (x > 40) & (x < 190)
    labels = np.zeros(SIZE, np.uint8)
    labels[liver] = 1
    labels[liver & vessel] = 3
    labels[liver & tumour] = 2
    labels[2:5, 2:5, 27:30] = 1
    return labels


def written(vector):
    return "({})".format(",".join("{:.17g}".format(c) for c in vector))


def nrrd(labels):
    lines = ["NRRD0004", "# A synthetic liver, made by liver_tumour.py", "type: unsigned char", "dimension: 3",
             "space: left-posterior-superior", "sizes: {} {} {}".format(*labels.shape),
             "space directions: " + " ".join(written(DIRECTIONS[:, d] * SPACING[d]) for d in range(3)),
             "kinds: domain domain domain", "encoding: gzip", "space origin: " + written(ORIGIN)]
    for i, (label, name) in enumerate(NAMES.items()):
        for key, value in (("Color", COLOURS[label]), ("ID", name), ("LabelValue", label), ("Layer", 0), ("Name", name)):
            lines.append("Segment{}_{}:={}".format(i, key, value))
    lines += ["Segmentation_MasterRepresentation:=Binary labelmap", "", ""]
    return "\n".join(lines).encode() + gzip.compress(labels.tobytes(order="F"), 9, mtime=0)


def nifti(labels):
    rows = np.hstack([DIRECTIONS * SPACING, ORIGIN[:, None]])
    rows[:2] *= -1                                    # NIfTI counts to the right, to the front and to the head
    header = struct.pack("<i36x8h14x3h", 348, 3, *labels.shape, 1, 1, 1, 1, 2, 8, 0)
    header += struct.pack("<8f f 2f 3b b", 1, *SPACING, 0, 0, 0, 0, 352, 1, 0, 0, 0, 0, 2)
    header = header.ljust(252, b"\0") + struct.pack("<2h6f", 0, 1, 0, 0, 0, 0, 0, 0)
    header += struct.pack("<12f", *rows.flatten())
    header = header.ljust(344, b"\0") + b"n+1\0" + bytes(4)
    return gzip.compress(header + labels.tobytes(order="F"), 9, mtime=0)


def metaimage(labels):
    data = zlib.compress(labels.tobytes(order="F"), 9)
    numbers = lambda values: " ".join("{:.17g}".format(v) for v in values)
    return "\n".join([
        "ObjectType = Image", "NDims = 3", "BinaryData = True", "BinaryDataByteOrderMSB = False", "CompressedData = True",
        "CompressedDataSize = {}".format(len(data)), "TransformMatrix = " + numbers(DIRECTIONS.T.flatten()),
        "Offset = " + numbers(ORIGIN), "CenterOfRotation = 0 0 0", "ElementSpacing = " + numbers(SPACING),
        "DimSize = {} {} {}".format(*labels.shape), "ElementType = MET_UCHAR", "ElementDataFile = LOCAL", ""]).encode() + data


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: liver_tumour.py FILE.nrrd|FILE.nii.gz|FILE.mha")
    for ending, made in ((".nrrd", nrrd), (".nii.gz", nifti), (".mha", metaimage)):
        if sys.argv[1].endswith(ending):
            with open(sys.argv[1], "wb") as file:
                file.write(made(draw()))
            return
    sys.exit("{}: the name must end in .nrrd, .nii.gz or .mha".format(sys.argv[1]))


if __name__ == "__main__":
    main()
