// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/geometry/voxels.hpp"

namespace hexaplast {

/// A segmentation as a file has it: its labels, and where they are [mm]. Coordinates are those of DICOM, ITK, and the
/// files of 3D Slicer (LPS): x points to the left of the patient, y to the back, z to the head.
struct ImportedVolume {
  LabelledVolume volume;
  bool has_frame =
      true;  ///< whether the file says where left, back and head are; otherwise its axes are taken for x, y, z
  std::vector<std::filesystem::path> files = {};  ///< that were read
};

/// Gives the content of a file that a header names, which lies in the same directory.
using ReadBeside = std::function<std::string(const std::string& name)>;

/// What is to be made of a volume where that is not known.
inline const VoxelCells kAnyCells{.coarsening = kMaxCoarsening};

/// NRRD, attached (.nrrd) or detached (.nhdr), raw or gzip; also segmentations of 3D Slicer (.seg.nrrd), whose segments
/// do not overlap: they give labels their names.
ImportedVolume parse_nrrd(std::string_view content, const std::string& name, const ReadBeside& beside = {},
                          const VoxelCells& planned = kAnyCells);

/// NIfTI-1 in one file, plain or compressed by gzip (.nii, .nii.gz).
ImportedVolume parse_nifti(std::string_view content, const std::string& name, const VoxelCells& planned = kAnyCells);

/// MetaImage, with its data (.mha) or beside them (.mhd), raw or compressed by zlib.
ImportedVolume parse_metaimage(std::string_view content, const std::string& name, const ReadBeside& beside = {},
                               const VoxelCells& planned = kAnyCells);

/// Whichever of these the ending of the file's name stands for: .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd.
ImportedVolume read_volume(const std::filesystem::path& file, const VoxelCells& planned = kAnyCells);

/// All of these take three directions, and labels stored as whole numbers of 8 to 64 bits or as real ones with whole
/// values in the range of int. They throw InputError: "FILE:LINE: field:
/// what" in a text header, "FILE: field: what" otherwise. Nothing is allocated by a number in a file before it has been
/// compared with the size of the data, and reading stops where the planned hexahedra would be too many.

}  // namespace hexaplast
