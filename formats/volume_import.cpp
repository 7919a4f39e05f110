// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/formats/volume_import.hpp"

#include <fmt/format.h>

#include "formats/readable_file.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

ImportedVolume read_volume(const std::filesystem::path& file, const VoxelCells& planned) {
  std::vector<std::filesystem::path> files{file};
  const ReadBeside beside = [&](const std::string& name) {
    files.push_back(file.parent_path() / name);
    return whole_file(files.back());
  };
  const std::string name = file.filename().string();
  const auto ends = [&](const char* ending) { return name.ends_with(ending); };
  const auto parsed = [&]() -> ImportedVolume {
    if (ends(".nrrd") || ends(".nhdr")) return parse_nrrd(whole_file(file), file.string(), beside, planned);
    if (ends(".nii") || ends(".nii.gz")) return parse_nifti(whole_file(file), file.string(), planned);
    if (ends(".mha") || ends(".mhd")) return parse_metaimage(whole_file(file), file.string(), beside, planned);
    throw InputError(
        fmt::format("{}: a segmentation's name must end in .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd", file.string()));
  };
  ImportedVolume found = parsed();
  found.files = std::move(files);
  return found;
}

}  // namespace hexaplast
