// SPDX-License-Identifier: LGPL-2.1-or-later
// Segmented images: the first byte chooses the format. Whatever is read has places of its own labels, and makes a mesh
// or says why not.
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/volume_import.hpp"
#include "target.hpp"

using namespace hexaplast;
using fuzz::require;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view content = fuzz::text_of(data + 1, size - 1);
  const ReadBeside beside = [](const std::string&) { return std::string(60, '\1'); };
  try {
    const ImportedVolume found = data[0] % 3 == 0   ? parse_nrrd(content, "any", beside)
                                 : data[0] % 3 == 1 ? parse_nifti(content, "any")
                                                    : parse_metaimage(content, "any", beside);
    const LabelledVolume& volume = found.volume;
    for (const unsigned char place : volume.places()) require(place <= volume.labels().size(), "places are of labels");
    const VoxelMesh made = mesh_of_voxels(volume, {.coarsening = 2, .largest_part = true});
    require(made.num_parts == 1, "the largest part is one");
    require(made.mesh.positions().allFinite(), "finite positions");
  } catch (const InputError&) {
  }
  return 0;
}
