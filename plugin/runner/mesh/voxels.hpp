// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// `hexaplast mesh voxels`, as the command line gives it.
struct MeshVoxelsOptions {
  std::filesystem::path segmentation;
  std::vector<int> labels;  ///< empty: all but 0
  int coarsening = 1;
  bool largest_part = false;
  std::string unit = "m";  ///< of the written lengths: m, cm or mm
  bool ascii = false;      ///< numbers as text
  bool surfaces = false;   ///< besides, FILE_LABEL.obj for each label
  std::filesystem::path out;
};

/// Writes the labelled voxels of a segmentation as hexahedra (.vtu), with the cell data `label`, and prints what they
/// are; surfaces of the labels too (.obj), if they are wanted. Throws what the modules below throw.
void make_voxels(const MeshVoxelsOptions& options);

}  // namespace hexaplast::runner
