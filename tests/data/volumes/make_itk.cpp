// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes the volumes that volume_file_test.cpp reads, by ITK 5.2, and prints where ITK has the voxels of label 7 [mm]:
// link with ITKCommon, ITKIOMeta, ITKIONRRD and ITKIONIFTI. It is not part of the build.
#include <cmath>
#include <cstdio>
#include <string>

#include "itkImage.h"
#include "itkImageFileWriter.h"
#include "itkMetaImageIO.h"
#include "itkNiftiImageIO.h"
#include "itkNrrdImageIO.h"

namespace {

/// 5 x 4 x 3 voxels, of which three have labels, in a frame that is turned by 0.7 about an oblique axis.
template <class Voxel>
void make(const std::string& name, bool is_left_handed) {
  using Image = itk::Image<Voxel, 3>;
  const auto image = Image::New();
  const typename Image::SizeType size{{5, 4, 3}};
  image->SetRegions(typename Image::RegionType(size));
  image->Allocate();
  image->FillBuffer(0);
  image->SetSpacing(std::array{0.75, 1.5, 2.5}.data());
  image->SetOrigin(std::array{-12.5, 30.25, 101.}.data());

  const double axis[3] = {2. / 7, -3. / 7, 6. / 7}, cosine = std::cos(0.7), sine = std::sin(0.7);
  const double cross[3][3] = {{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}};
  typename Image::DirectionType direction;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      direction[i][j] = (i == j) * cosine + (1 - cosine) * axis[i] * axis[j] + sine * cross[i][j];
      if (is_left_handed && j == 1) direction[i][j] *= -1;
    }
  image->SetDirection(direction);

  image->SetPixel({{0, 3, 0}}, 2);
  image->SetPixel({{1, 3, 0}}, 2);
  const typename Image::IndexType marked{{3, 1, 2}};
  image->SetPixel(marked, 7);
  typename Image::PointType place;
  image->TransformIndexToPhysicalPoint(marked, place);
  std::printf("%s: %.12g %.12g %.12g\n", name.c_str(), place[0], place[1], place[2]);

  const auto write = [&](itk::ImageIOBase* format, const std::string& file, bool is_compressed) {
    const auto writer = itk::ImageFileWriter<Image>::New();
    writer->SetImageIO(format);
    writer->SetFileName(file);
    writer->SetInput(image);
    writer->SetUseCompression(is_compressed);
    writer->Update();
  };
  write(itk::NrrdImageIO::New(), name + ".nrrd", true);
  write(itk::NrrdImageIO::New(), name + "_raw.nrrd", false);
  write(itk::NrrdImageIO::New(), name + ".nhdr", false);
  write(itk::NiftiImageIO::New(), name + ".nii.gz", false);
  write(itk::NiftiImageIO::New(), name + ".nii", false);
  write(itk::MetaImageIO::New(), name + ".mha", true);
  write(itk::MetaImageIO::New(), name + "_raw.mha", false);
  write(itk::MetaImageIO::New(), name + ".mhd", true);
}

}  // namespace

int main() {
  make<short>("oblique_short", false);
  make<unsigned char>("left_uchar", true);
  make<unsigned>("oblique_uint", false);
}
