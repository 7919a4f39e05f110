// SPDX-License-Identifier: LGPL-2.1-or-later
#include <zlib.h>

#include <cstring>

#include "formats/readable_file.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/volume_import.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"

namespace hexaplast {
namespace {

using namespace support;

const std::string kVolumes = HEXAPLAST_TEST_DATA "/volumes/";

ImportedVolume parsed(const std::string& name, const std::string& content) {
  const ReadBeside beside = [](const std::string& file) { return whole_file(kVolumes + file); };
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return parse_nrrd(content, name, beside);
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return parse_metaimage(content, name, beside);
  return parse_nifti(content, name);
}

std::size_t voxel_at(int i, int j, int k) { return static_cast<std::size_t>(i + 5 * (j + 4 * k)); }

/// The labels that make_itk.cpp and make_nibabel.py draw.
void expect_their_labels(const LabelledVolume& volume) {
  ASSERT_EQ(volume.size(), (std::array{5, 4, 3}));
  for (std::size_t v = 0; v < volume.num_voxels(); ++v) {
    const unsigned char place = volume.places()[v];
    const int label = place == 0 ? 0 : volume.labels()[place - 1u];
    const int expected = v == voxel_at(3, 1, 2) ? 7 : v == voxel_at(0, 3, 0) || v == voxel_at(1, 3, 0) ? 2 : 0;
    EXPECT_EQ(label, expected) << v;
  }
}

Vec3 centre_of_the_marked(const LabelledVolume& volume) {
  const VoxelMesh made = mesh_of_voxels(volume, {.labels = {7}, .mm_per_length = 1});
  return made.mesh.positions().colwise().mean().transpose();
}

// What ITK and nibabel print for the voxel of label 7.
const std::vector<std::pair<std::string, Vec3>> kMarked = [] {
  const Vec3 oblique(-12.6999030928, 31.2874496114, 106.58535917), left(-10.9569588229, 28.8633462956, 106.292326089);
  std::vector<std::pair<std::string, Vec3>> all;
  for (const char* file :
       {"oblique_short.nrrd", "oblique_short.nhdr", "oblique_short.nii", "oblique_short.mhd", "oblique_short_raw.mha",
        "oblique_uint.nii.gz", "oblique_qform.nii", "oblique_big_metres.nii"})
    all.emplace_back(file, oblique);
  for (const char* file : {"left_uchar_raw.nrrd", "left_uchar.nii.gz", "left_uchar.mha"}) all.emplace_back(file, left);
  all.emplace_back("left_qform.nii", Vec3(-10.51486683, 33.9919166, 97.20924724));
  return all;
}();

TEST(VolumeFile, HoldsWhatItkAndNibabelWrote) {
  for (const auto& [file, place] : kMarked) {
    SCOPED_TRACE(file);
    const ImportedVolume found = read_volume(kVolumes + file);
    expect_their_labels(found.volume);
    EXPECT_TRUE(found.has_frame);
    EXPECT_LT((centre_of_the_marked(found.volume) - place).norm(), 1e-5);  // [mm] NIfTI has single precision
    EXPECT_EQ(found.files.size(), file.ends_with("hdr") || file.ends_with("mhd") ? 2u : 1u);
    EXPECT_EQ(found.volume.axes().determinant() < 0, file.starts_with("left"));
  }
}

/// A NRRD file of 2 x 2 x 2 voxels of 1 x 2 x 4 mm, with the labels 0 to 7.
std::string small_nrrd(const std::string& space = "left-posterior-superior", const std::string& more = "") {
  return "NRRD0004\n# small\ntype: uchar\ndimension: 3\nspace: " + space +
         "\nsizes: 2 2 2\nspace directions: (1,0,0) (0,2,0) (0,0,4)\nkinds: domain domain domain\nencoding: raw\nspace "
         "origin: (10,20,30)\n" +
         more + "\n" + std::string("\0\1\2\3\4\5\6\7", 8);
}

std::string small_metaimage(const std::string& more = "") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = 1 0 0 0 "
         "1 0 "
         "0 0 1\nOffset = 10 20 30\nElementSpacing = 1 2 4\nDimSize = 2 2 2\n" +
         more + "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string("\0\1\2\3\4\5\6\7", 8);
}

template <class Number>
void put(std::string& bytes, std::size_t at, Number number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

std::string small_nifti() {
  std::string bytes(352, '\0');
  put(bytes, 0, std::int32_t{348});
  const std::int16_t dim[] = {3, 2, 2, 2, 1, 1, 1, 1};
  std::memcpy(bytes.data() + 40, dim, sizeof dim);
  put(bytes, 70, std::int16_t{2});
  put(bytes, 72, std::int16_t{8});
  const float pixdim[] = {1, 1, 2, 4}, rows[] = {-1, 0, 0, -10, 0, -2, 0, -20, 0, 0, 4, 30};
  std::memcpy(bytes.data() + 76, pixdim, sizeof pixdim);
  put(bytes, 108, 352.f);
  bytes[123] = 2;
  put(bytes, 254, std::int16_t{1});
  std::memcpy(bytes.data() + 280, rows, sizeof rows);
  std::memcpy(bytes.data() + 344, "n+1", 4);
  return bytes + std::string("\0\1\2\3\4\5\6\7", 8);
}

// Voxel (1, 0, 1) has label 5: with the axes of the file it lies at (11, 20, 34) mm in the file's own frame.
TEST(VolumeFile, CoordinatesAreToTheLeftTheBackAndTheHead) {
  const auto centre = [](const ImportedVolume& found) {
    return Vec3(mesh_of_voxels(found.volume, {.labels = {5}, .mm_per_length = 1}).mesh.positions().colwise().mean());
  };
  for (const auto& [space, place] : {std::pair("LPS", Vec3(11, 20, 34)), std::pair("RAS", Vec3(-11, -20, 34)),
                                     std::pair("right-anterior-superior", Vec3(-11, -20, 34)),
                                     std::pair("Left-Anterior-Superior", Vec3(11, -20, 34))}) {
    const ImportedVolume found = parse_nrrd(small_nrrd(space), "a.nrrd");
    EXPECT_EQ(centre(found), place) << space;
    EXPECT_TRUE(found.has_frame);
  }
  EXPECT_EQ(centre(parse_metaimage(small_metaimage(), "a.mha")), Vec3(11, 20, 34));
  EXPECT_EQ(centre(parse_nifti(small_nifti(), "a.nii")), Vec3(11, 20, 34));

  const ImportedVolume unknown = parse_nrrd(small_nrrd("3D-right-handed"), "a.nrrd");
  EXPECT_EQ(centre(unknown), Vec3(11, 20, 34));
  EXPECT_FALSE(unknown.has_frame);
  std::string plain = small_nifti();
  put(plain, 254, std::int16_t{0});
  const ImportedVolume without = parse_nifti(plain, "a.nii");
  EXPECT_EQ(centre(without), Vec3(1, 0, 4));
  EXPECT_FALSE(without.has_frame);
}

TEST(VolumeFile, LengthsMayHaveOtherUnits) {
  const auto length = [](const ImportedVolume& found) { return found.volume.axes()(2, 2); };
  EXPECT_EQ(length(parse_nrrd(small_nrrd("LPS", "space units: \"m\" \"m\" \"m\"\n"), "a")), 4000);
  EXPECT_EQ(length(parse_nrrd(small_nrrd("LPS", "space units: \"um\" \"um\" \"um\"\n"), "a")), 0.004);
  std::string nifti = small_nifti();
  nifti[123] = 3;
  EXPECT_EQ(length(parse_nifti(nifti, "a")), 0.004);
}

/// A NRRD file of two voxels above each other, without a frame.
ImportedVolume two_voxels(const std::string& type, const std::string& endian, const std::string& data) {
  return parse_nrrd("NRRD0001\ntype: " + type + "\ndimension: 3\nsizes: 1 1 2\nspacings: 1 2 3\nendian: " + endian +
                        "\nencoding: raw\n\n" + data,
                    "a.nrrd");
}

TEST(VolumeFile, ReadsEveryTypeOfLabel) {
  const auto labels = [&](const std::string& type, const std::string& endian, const std::string& data) {
    return two_voxels(type, endian, data).volume.labels();
  };
  EXPECT_EQ(labels("short", "little", std::string("\1\2\xfe\xff", 4)), (std::vector<int>{513, -2}));
  EXPECT_EQ(labels("short", "big", std::string("\1\2\xfe\xff", 4)), (std::vector<int>{258, -257}));
  EXPECT_EQ(labels("unsigned short", "big", std::string("\1\2\xfe\xff", 4)), (std::vector<int>{258, 65279}));
  EXPECT_EQ(labels("int", "little", std::string("\1\2\0\0\xfe\xff\xff\xff", 8)), (std::vector<int>{513, -2}));
  EXPECT_EQ(labels("uint32", "big", std::string("\0\0\1\2\x7f\xff\xff\xff", 8)), (std::vector<int>{258, 2147483647}));
  EXPECT_TRUE(
      refuses<InputError>([&] { labels("uint32", "big", std::string("\0\0\1\2\xff\xff\xff\xff", 8)); },
                          {"a.nrrd: voxel 1 has the label 4294967295", "whole number in [-2147483648, 2147483647]"}));
}

template <class... Numbers>
std::string bytes_of(Numbers... numbers) {
  std::string bytes;
  const auto add = [&](const auto number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof number); };
  (add(numbers), ...);
  return bytes;
}

// As numpy and nibabel store them by default.
TEST(VolumeFile, ReadsWholeLabelsThatAreStoredAsLongOrRealNumbers) {
  const auto nifti = [](int datatype, int bits, const std::string& data) {
    std::string bytes = small_nifti().substr(0, 352);
    const std::int16_t dim[] = {3, 1, 1, 2};
    std::memcpy(bytes.data() + 40, dim, sizeof dim);
    put(bytes, 70, static_cast<std::int16_t>(datatype));
    put(bytes, 72, static_cast<std::int16_t>(bits));
    put(bytes, 112, std::numeric_limits<float>::quiet_NaN());  // scl_slope and scl_inter of nibabel: none
    put(bytes, 116, std::numeric_limits<float>::quiet_NaN());
    return parse_nifti(bytes + data, "a.nii").volume.labels();
  };
  struct Stored {
    int datatype, bits;            // of NIfTI
    const char *nrrd, *metaimage;  // types
    std::string data;
    std::vector<int> labels;
  };
  for (const auto& [datatype, bits, of_nrrd, of_metaimage, data, labels] : std::vector<Stored>{
           {1024, 64, "int64", "MET_LONG_LONG", bytes_of(std::int64_t{513}, std::int64_t{-2}), {513, -2}},
           {1280, 64, "unsigned long long", "MET_ULONG_LONG", bytes_of(std::uint64_t{513}, std::uint64_t{7}), {513, 7}},
           {16, 32, "float", "MET_FLOAT", bytes_of(513.f, -2.f), {513, -2}},
           {64, 64, "double", "MET_DOUBLE", bytes_of(513., -2.), {513, -2}}}) {
    SCOPED_TRACE(of_nrrd);
    const std::string metaimage =
        "NDims = 3\nElementSpacing = 1 1 1\nDimSize = 1 1 2\nElementType = " + std::string(of_metaimage) +
        "\nElementDataFile = LOCAL\n" + data;
    EXPECT_EQ(nifti(datatype, bits, data), labels);
    EXPECT_EQ(two_voxels(of_nrrd, "little", data).volume.labels(), labels);
    EXPECT_EQ(parse_metaimage(metaimage, "a.mha").volume.labels(), labels);
  }
  EXPECT_EQ(read_volume(kVolumes + "whole_labels_int64.nii").volume.size(), (std::array{3, 4, 5}));
  // what is no label is named
  for (const auto& [label, shown] :
       {std::pair(2.5, "2.5"), std::pair(std::nan(""), "nan"), std::pair(3e9, "3000000000")})
    EXPECT_TRUE(
        refuses<InputError>([&] { nifti(64, 64, bytes_of(1., label)); },
                            {std::string("a.nii: voxel 1 has the label ") + shown + ", must be a whole number"}));
  EXPECT_TRUE(refuses<InputError>([&] { nifti(1024, 64, bytes_of(std::int64_t{1} << 40, std::int64_t{1})); },
                                  {"voxel 0 has the label 1.099511628e+12, must be a whole number"}));
}

const std::string kSegments =
    "Segment0_ID:=a\nSegment0_LabelValue:=5\nSegment0_Layer:=0\nSegment0_Name:=Left lobe\nSegment1_LabelValue:=2\n"
    "Segment1_Layer:=0\nSegment1_Name:=tumour\nSegmentation_MasterRepresentation:=Binary labelmap\n";

TEST(VolumeFile, SegmentsOfSlicerNameLabels) {
  EXPECT_EQ(parse_nrrd(small_nrrd("LPS", kSegments), "a.seg.nrrd").volume.names,
            (std::map<int, std::string>{{2, "tumour"}, {5, "Left lobe"}}));
  const auto refused = [](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    return refuses<InputError>([&] { parse_nrrd(small_nrrd("LPS", replaced(kSegments, from, to)), "a.seg.nrrd"); },
                               parts);
  };
  EXPECT_TRUE(refused("LabelValue:=2", "LabelValue:=5", {"a.seg.nrrd:15: Segment1_LabelValue '5'", "another segment"}));
  EXPECT_TRUE(refused("LabelValue:=2", "LabelValue:=two", {"Segment1_LabelValue 'two'", "whole number"}));
  EXPECT_TRUE(refused("Layer:=0\nSegment1_Name", "Layer:=1\nSegment1_Name", {"Segment1_Layer '1': must be 0"}));
}

TEST(VolumeFile, NrrdNamesFieldValueAndWhatIsAllowed) {
  const auto refused = [](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    return refuses<InputError>([&] { parse_nrrd(replaced(small_nrrd(), from, to), "a.nrrd"); }, parts);
  };
  EXPECT_TRUE(refused("NRRD0004", "NRRD0009", {"a.nrrd:1: ", "NRRD0001 to NRRD0005"}));
  EXPECT_TRUE(refused("dimension: 3", "dimension: 4", {"a.nrrd:4: dimension '4'", "must be 3", "overlap", "layers"}));
  EXPECT_TRUE(refused("dimension: 3", "dimension: 2", {"a.nrrd:4: dimension '2': must be 3"}));
  EXPECT_TRUE(refused("type: uchar", "type: block", {"a.nrrd:3: type 'block'", "one of", "uint8"}));
  EXPECT_TRUE(refused("type: uchar", "type: int128", {"a.nrrd:3: type 'int128'"}));
  EXPECT_TRUE(refused("type: uchar", "type: short", {"a.nrrd: the header has no 'endian'"}));
  EXPECT_TRUE(refused("raw", "bzip2", {"a.nrrd:9: encoding 'bzip2'", "raw"}));
  EXPECT_TRUE(refused("sizes: 2 2 2", "sizes: 2 2", {"a.nrrd:6: sizes '2 2'", "3 whole numbers"}));
  EXPECT_TRUE(refused("sizes: 2 2 2", "sizes: 2 -2 2", {"sizes '2 -2 2'", "[1, 2147483647]"}));
  EXPECT_TRUE(refused("sizes: 2 2 2", "sizes: 2 2 3", {"12 bytes of voxels cannot come from 8 bytes"}));
  EXPECT_TRUE(refused("sizes: 2 2 2", "sizes: 2 2 1", {"a.nrrd: the data go on after the last voxel, at byte 4"}));
  EXPECT_TRUE(refused("sizes: 2 2 2", "sizes: 2147483647 2147483647 2147483647", {"cannot come from 8 bytes"}));
  EXPECT_TRUE(refused("(0,2,0)", "(0,nan,0)", {"a.nrrd:7: space directions", "three finite numbers"}));
  EXPECT_TRUE(refused("(0,2,0)", "(0,2)", {"a.nrrd:7: space directions"}));
  EXPECT_TRUE(refused("(0,2,0)", "(0,0,0)", {"a.nrrd: space directions: voxels are 0 mm long in direction 1"}));
  EXPECT_TRUE(refused("(0,2,0)", "none", {"a.nrrd:7: space directions"}));
  EXPECT_TRUE(refused("(10,20,30)", "(10,20,inf)", {"a.nrrd:10: space origin", "1 vector of three"}));
  EXPECT_TRUE(refused("left-posterior-superior", "right-up", {"a.nrrd:5: space 'right-up'", "ras"}));
  EXPECT_TRUE(refused("kinds: domain", "kinds: list", {"a.nrrd:8: kinds", "domain"}));
  EXPECT_TRUE(refused("kinds:", "kind:", {"a.nrrd:8: kind ", "not known"}));
  EXPECT_TRUE(refused("kinds:", "sizes:", {"a.nrrd:8: 'sizes' is given again, the first time in line 6"}));
  EXPECT_TRUE(refused("kinds:", "kinds", {"a.nrrd:8: must be 'field: value'"}));
  EXPECT_TRUE(refused("kinds: domain domain domain", "line skip: 3", {"line skip '3': must be 0"}));
  EXPECT_TRUE(
      refused("kinds: domain domain domain", "space units: \"mm\" \"m\" \"mm\"", {"space units", "three times"}));
  for (const char* file : {"../a.raw", "/etc/passwd", "..", "LIST/a", "a%03d.raw"})
    EXPECT_TRUE(
        refused("kinds: domain domain domain", std::string("data file: ") + file, {"data file", "one file in the"}));
  EXPECT_TRUE(refused("kinds: domain domain domain", "data file: a.raw", {"a.nrrd:8: data file 'a.raw'", "not given"}));
  EXPECT_TRUE(refuses<InputError>(
      [] { parsed("a.nhdr", replaced(small_nrrd(), "kinds: domain domain domain", "data file: no.raw")); },
      {"a.nhdr:8: data file 'no.raw'", "no such file"}));
}

TEST(VolumeFile, MetaImageNamesFieldValueAndWhatIsAllowed) {
  const auto refused = [](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    return refuses<InputError>([&] { parse_metaimage(replaced(small_metaimage(), from, to), "a.mha"); }, parts);
  };
  EXPECT_TRUE(refused("NDims = 3", "NDims = 2", {"a.mha:2: NDims '2': must be 3"}));
  EXPECT_TRUE(refused("BinaryData = True", "BinaryData = False", {"a.mha:3: BinaryData 'False': must be True"}));
  EXPECT_TRUE(refused("MET_UCHAR", "MET_STRING", {"a.mha:9: ElementType 'MET_STRING'", "met_uchar"}));
  EXPECT_TRUE(refused("ElementSpacing = 1 2 4", "ElementSpacing = 1 nan 4", {"a.mha:7: ElementSpacing", "finite"}));
  EXPECT_TRUE(refused("ElementSpacing = 1 2 4", "Other = 1", {"a.mha: the header has no 'ElementSpacing'"}));
  EXPECT_TRUE(
      refused("1 0 0 0 1 0 0 0 1", "1 0 0 0 2 0 0 0 1", {"a.mha:5: TransformMatrix", "the length 2", "must be 1"}));
  EXPECT_TRUE(
      refused("ElementSpacing = 1 2 4", "ElementSpacing = 1 -2 4", {"a.mha:7: ElementSpacing", "greater than 0"}));
  EXPECT_TRUE(refused("Offset = 10 20 30", "Offset = 10 20", {"a.mha:6: Offset '10 20'", "3 finite numbers"}));
  EXPECT_TRUE(refused("Offset = 10 20 30", "Offset = 10 20 30\nPosition = 1 1 1",
                      {"a.mha:7: Position", "Offset is given, too"}));
  EXPECT_TRUE(refused("DimSize = 2 2 2", "DimSize = 2 0 2", {"a.mha:8: DimSize"}));
  EXPECT_TRUE(refused("LOCAL", "LIST", {"another file"}));
  EXPECT_TRUE(refused("LOCAL", "../a.raw", {"one file in the directory"}));
  EXPECT_TRUE(refused("NDims = 3", "NDims", {"a.mha:2: must be 'Field = value'"}));
  EXPECT_TRUE(
      refused("NDims = 3", "NDims = 3\nElementNumberOfChannels = 3", {"ElementNumberOfChannels '3': must be 1"}));
  EXPECT_TRUE(refused("NDims = 3", "NDims = 3\nCompressedData = yes", {"CompressedData 'yes'", "one of false, true"}));
  EXPECT_TRUE(refused("NDims = 3", "NDims = 3\nCompressedData = True", {"damaged"}));
}

TEST(VolumeFile, NiftiNamesFieldValueAndWhatIsAllowed) {
  const auto refused = [](std::size_t at, auto number, std::initializer_list<std::string> parts) {
    std::string bytes = small_nifti();
    put(bytes, at, number);
    return refuses<InputError>([&] { parse_nifti(bytes, "a.nii"); }, parts);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refused(0, std::int32_t{347}, {"a.nii: sizeof_hdr", "must be 348"}));
  EXPECT_TRUE(refused(0, std::int32_t{540}, {"sizeof_hdr", "NIfTI-2"}));
  EXPECT_TRUE(refused(344, std::int32_t{0x0031696e}, {"magic", "second file"}));
  EXPECT_TRUE(refused(344, std::int32_t{0}, {"a.nii: magic", "'n+1'"}));
  EXPECT_TRUE(refused(40, std::int16_t{2}, {"dim[0]", "2 dimensions"}));
  EXPECT_TRUE(refused(42, std::int16_t{-2}, {"dim[1]: -2", "[1, 32767]"}));
  EXPECT_TRUE(refused(70, std::int16_t{32}, {"datatype: 32", "whole numbers of 8 to 64 bits"}));
  EXPECT_TRUE(refused(72, std::int16_t{16}, {"bitpix: 16, must be 8"}));
  EXPECT_TRUE(refused(112, 2.f, {"scl_slope", "scaled by 2"}));
  EXPECT_TRUE(refused(108, 100.f, {"vox_offset: 100", "[352, "}));
  EXPECT_TRUE(refused(108, nan, {"vox_offset: nan", "finite"}));
  EXPECT_TRUE(refused(108, 364.f, {"the data end after 360 bytes, must be at least 364"}));
  EXPECT_TRUE(refused(280, nan, {"srow_x[0]: nan", "finite"}));
  EXPECT_TRUE(refused(284, 1.f, {"a.nii: srow_x, srow_y, srow_z: ", "axes 0 and 1", "not perpendicular"}));
  EXPECT_TRUE(refused(123, '\4', {"xyzt_units: 4"}));
  std::string series = small_nifti();
  put(series, 40, std::int16_t{4});
  put(series, 48, std::int16_t{9});
  EXPECT_TRUE(refuses<InputError>([&] { parse_nifti(series, "a.nii"); }, {"dim[4]: 9 volumes", "must be 1"}));
  std::string turned = small_nifti();
  put(turned, 254, std::int16_t{0});
  put(turned, 252, std::int16_t{1});
  put(turned, 256, 2.f);
  EXPECT_TRUE(refuses<InputError>([&] { parse_nifti(turned, "a.nii"); }, {"quatern_b", "sum of their squares is 4"}));
  put(turned, 80, 0.f);
  EXPECT_TRUE(refuses<InputError>([&] { parse_nifti(turned, "a.nii"); }, {"pixdim[1]: 0", "greater than 0"}));
}

TEST(VolumeFile, CutAnywhereIsRefused) {
  std::vector<std::pair<std::string, std::string>> files{
      {"a.nrrd", small_nrrd("LPS", kSegments)}, {"a.mha", small_metaimage()}, {"a.nii", small_nifti()}};
  for (const auto& [file, place] : kMarked) files.emplace_back(file, whole_file(kVolumes + file));
  for (const auto& file : files) {
    const std::string &name = file.first, &whole = file.second;
    for (std::size_t length = 0; length < whole.size(); ++length) {
      SCOPED_TRACE(name + " cut after " + std::to_string(length));
      if (name.ends_with("hdr") || name.ends_with("mhd")) {  // their data are beside them, and whole
        try {
          expect_their_labels(parsed(name, whole.substr(0, length)).volume);
        } catch (const InputError&) {
        }
      } else {
        EXPECT_TRUE(refuses<InputError>([&] { parsed(name, whole.substr(0, length)); }, {name + ":"}));
      }
    }
  }
}

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 9, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

// gzip files may be several in one, as bgzip writes them; the checksum at the end counts.
TEST(VolumeFile, CompressedDataAreWhole) {
  const std::string whole = small_nifti();
  const std::string two = gzipped(whole.substr(0, 355)) + gzipped(whole.substr(355));
  EXPECT_EQ(parse_nifti(two, "a.nii.gz").volume.labels().size(), 7u);
  EXPECT_TRUE(
      refuses<InputError>([&] { parse_nifti(gzipped(whole + "x"), "a.nii.gz"); }, {"go on after the last voxel"}));
  EXPECT_TRUE(
      refuses<InputError>([&] { parse_nifti(gzipped(whole) + "x", "a.nii.gz"); }, {"a.nii.gz: the compressed data"}));
  std::string wrong = gzipped(whole);
  wrong[wrong.size() - 6] ^= 1;
  EXPECT_TRUE(refuses<InputError>([&] { parse_nifti(wrong, "a.nii.gz"); }, {"damaged", "incorrect data check"}));
}

TEST(VolumeFile, TheEndingOfTheNameTellsTheFormat) {
  EXPECT_TRUE(refuses<InputError>([] { read_volume("scan.dcm"); }, {"scan.dcm", ".nrrd, .nhdr, .nii"}));
  EXPECT_TRUE(refuses<InputError>([] { read_volume(kVolumes + "none.nrrd"); }, {"none.nrrd: no such file"}));
  EXPECT_TRUE(refuses<InputError>([] { parse_nrrd("NRRD0004\n" + std::string(2'000'000, '#'), "a"); },
                                  {"the header is longer than 1048576"}));
}

}  // namespace
}  // namespace hexaplast
