#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the NIfTI files with a qform that volume_file_test.cpp reads, by nibabel: the volume of make_itk.cpp, in mm; the same,
big-endian and in m; and one whose third axis is turned round. Prints where the voxel of label 7 is [mm], in LPS."""
import nibabel
import numpy as np

labels = np.zeros((5, 4, 3), np.int16)
labels[3, 1, 2], labels[0, 3, 0], labels[1, 3, 0] = 7, 2, 2
axis, angle = np.array([2, -3, 6]) / 7, 0.7
cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
rotation = np.eye(3) * np.cos(angle) + (1 - np.cos(angle)) * np.outer(axis, axis) + np.sin(angle) * cross
to_lps = np.eye(4)
to_lps[:3, :3], to_lps[:3, 3] = rotation * [0.75, 1.5, 2.5], [-12.5, 30.25, 101]
to_ras = np.diag([-1, -1, 1, 1]) @ to_lps


def write(name, matrix, order="<", unit="mm"):
    image = nibabel.Nifti1Image(labels, None, nibabel.Nifti1Header(endianness=order))
    image.header.set_data_dtype(order + "i2")
    image.header.set_xyzt_units(unit)
    image.set_qform(matrix, code=1)
    image.set_sform(None, code=0)
    nibabel.save(image, name)


metres = to_ras.copy()
metres[:3] *= 1e-3
turned = to_ras.copy()
turned[:3, 2] *= -1
write("oblique_qform.nii", to_ras)
write("oblique_big_metres.nii", metres, ">", "meter")
write("left_qform.nii", turned)
for matrix in (to_ras, turned):
    print(np.diag([-1, -1, 1]) @ (matrix @ [3, 1, 2, 1])[:3])
