// SPDX-License-Identifier: LGPL-2.1-or-later
// Whole pictures against those in tests/data/pictures, pixel by pixel. A picture that differs is written into the
// working directory of the test.
#include "picture/png_file.hpp"
#include "picture/section_page.hpp"
#include "support/files.hpp"
#include "support/pictures.hpp"
#include "support/png.hpp"

/// OSMesa keeps a few bytes of every drawing context to the end; the leak checker of sanitized builds is told.
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so"; }

namespace hexaplast {
namespace {

constexpr int kWidth = 320, kHeight = 180;

/// Pixels may differ by this much, which is less than a step of the colour map; and so many may differ by more, at the
/// borders of what is drawn.
constexpr int kTolerance = 8;
constexpr int kMaxDifferent = 60;

int num_different(const Image& a, const Image& b) {
  if (a.pixels.size() != b.pixels.size() || a.width != b.width) return a.width * a.height;
  int count = 0;
  for (std::size_t k = 0; k < a.pixels.size(); k += 3) {
    int max = 0;
    for (std::size_t c = 0; c < 3; ++c) max = std::max(max, std::abs(a.pixels[k + c] - b.pixels[k + c]));
    count += max > kTolerance;
  }
  return count;
}

Image golden(const std::string& name) { return read_png(fs::path(HEXAPLAST_TEST_DATA) / "pictures" / (name + ".png")); }

void expect_golden(const std::string& name, const Drawing& drawing) {
  const Image image = rendered(drawing);
  const int count = num_different(image, golden(name));
  if (count <= kMaxDifferent) return;
  const fs::path actual = fs::current_path() / (name + "_actual.png");
  write_png(actual, image);
  ADD_FAILURE() << count << " pixels differ from tests/data/pictures/" << name << ".png; see " << actual;
}

/// A bar of 2 x 3 x 7 hexahedra, twisted by 80 degrees and bent a little.
const HexMesh& bar() {
  static const HexMesh mesh = block({2, 3, 7}, 0.1);
  return mesh;
}

PointArray bent_bar(double twist = 80) {
  PointArray x = bar().positions();
  for (Eigen::Index n = 0; n < x.rows(); ++n) {
    const double fraction = x(n, 2) / 0.7, angle = twist * fraction * std::numbers::pi / 180;
    const Vec3 across(x(n, 0) - 0.1, x(n, 1) - 0.15, 0);
    x.row(n) = Eigen::AngleAxisd(angle, Vec3::UnitZ()) * across + Vec3(0.1, 0.15 + 0.1 * fraction * fraction, x(n, 2));
  }
  return x;
}

std::vector<double> some_values() {
  std::vector<double> values(bar().num_elements());
  for (std::size_t e = 0; e < values.size(); ++e)
    values[e] = 0.02 * static_cast<double>(e % 6) + 0.004 * static_cast<double>(e);
  return values;
}

Staging small() {
  Staging staging;
  staging.width = kWidth;
  staging.height = kHeight;
  return staging;
}

/// The nodes at z = 0 are held, an instrument has taken hold of the other end.
BoundaryConditions held() {
  BoundaryConditions conditions;
  conditions.fixed.assign(bar().num_nodes(), 0);
  std::fill_n(conditions.fixed.begin(), 12, 1);
  conditions.instruments.push_back({.place = Vec3(0.1, 0.25, 0.7), .nodes = {}, .forces = PointArray(0, 3)});
  return conditions;
}

Drawing picture(const Staging& staging, const std::vector<double>& values = some_values(),
                const std::vector<unsigned char>& alive = {}, const BoundaryConditions& conditions = held()) {
  Gallery gallery(bar(), "twisted bar", 2, staging);
  gallery.add(12, 0.24, bent_bar(), values, alive, conditions);
  return drawings_of(gallery)[0];
}

TEST(GoldenPicture, OfABody) { expect_golden("body", picture(small())); }

TEST(GoldenPicture, OfABodyThatIsCut) {
  Staging staging = small();
  staging.cut = Plane{Vec3::UnitZ(), 0.42};
  staging.viewpoint =
      Viewpoint{Vec3(0.9, 0.7, 1.4), {}, Viewpoint::Eye{Vec3(1.0, 0.9, 1.6), Vec3(0.1, 0.2, 0.3), 32, true}};
  staging.quantity = Quantity::kVolumeRatio;
  staging.range = std::pair(0.05, 0.2);
  expect_golden("cut", picture(staging));
}

TEST(GoldenPicture, OfWhatHasNoValueAndWhatIsRemoved) {
  Staging staging = small();
  staging.quantity = Quantity::kYield;
  staging.viewpoint = Viewpoint{Vec3(1, 0.4, -0.3), {}};
  std::vector<double> values = some_values();
  for (std::size_t e = 0; e < 12; ++e) values[e] = std::numeric_limits<double>::infinity();
  std::vector<unsigned char> alive(values.size(), 1);
  for (const std::size_t gone : {21u, 23u, 25u, 27u}) alive[gone] = 0;
  expect_golden("holes", picture(staging, values, alive));
}

/// The bar is pressed from above, pulled and pushed at its end, and an instrument draws four of its nodes aside.
BoundaryConditions loaded() {
  BoundaryConditions conditions = held();
  conditions.loads = PointArray::Zero(bar().num_nodes(), 3);
  for (const int node : {84, 86}) conditions.loads.row(node) << 0, 0, 0.3;
  for (const int node : {93, 95}) conditions.loads.row(node) << 0, 0, -0.15;
  for (const int node : {33, 45, 57}) conditions.loads.row(node) << 0, -0.2, 0;
  Instrument& instrument = conditions.instruments.front();
  instrument.nodes = {87, 88, 90, 91};
  instrument.forces = PointArray::Constant(4, 3, 1);
  for (std::size_t k = 0; k < instrument.nodes.size(); ++k)
    conditions.loads.row(instrument.nodes[k]) += instrument.forces.row(static_cast<Eigen::Index>(k));
  return conditions;
}

TEST(GoldenPicture, OfLoads) {
  Staging staging = small();
  staging.gravity = Vec3(0, -9.81, 0);
  expect_golden("loads", picture(staging, some_values(), {}, loaded()));
}

/// Two taut springs and a slack one from the bar to places beside it, of which one is far off.
BoundaryConditions tied() {
  BoundaryConditions conditions = held();
  const PointArray x = bent_bar();
  const auto at = [&](int node) { return Vec3(x.row(node).transpose()); };
  conditions.springs = {{at(24), Vec3(.1, -.3, .3)}, {at(50), Vec3(.1, .6, .2), true}, {at(86), Vec3(.2, 4, .9)}};
  return conditions;
}

TEST(GoldenPicture, OfSprings) { expect_golden("springs", picture(small(), some_values(), {}, tied())); }

// The middle plane of the bar as a surface, in the cage of its edges.
TEST(GoldenPicture, OfASurfaceInACage) {
  Staging staging = small();
  EmbeddedSurface& embedded = staging.embedded_surfaces.emplace_back();
  embedded.points.resize(16, 3);
  for (int k = 0; k < 8; ++k) {
    embedded.points.row(2 * k) << 0.07, 0.05, 0.1 * k;
    embedded.points.row(2 * k + 1) << 0.12, 0.25, 0.1 * k;
    if (k > 0) embedded.quads.push_back({2 * k - 2, 2 * k - 1, 2 * k + 1, 2 * k});
  }
  staging.width = 360;
  staging.height = 360;
  expect_golden("cage", picture(staging, some_values(), {}, loaded()));
}

TEST(GoldenPicture, OfSections) {
  SectionPage page;
  page.title = "twisted bar";
  page.remark = "t = 0.24 s";
  page.axis = 2;
  page.count = 5;
  page.width = kWidth;
  page.height = kHeight;
  expect_golden("sections", page.drawing(bar(), bent_bar(), some_values(), {}, bar().positions()));
}

// What these tests are there to find.
TEST(GoldenPicture, DiffersFromOneOfAnotherCamera) {
  Staging staging = small();
  const Vec3 towards = beside(2).towards;
  staging.viewpoint = Viewpoint{Eigen::AngleAxisd(0.05, Vec3::UnitY()) * towards, {}};
  EXPECT_GT(num_different(rendered(picture(staging)), golden("body")), 10 * kMaxDifferent);
}

/// Null where the machine has no EGL.
std::unique_ptr<Renderer> egl_renderer() {
  try {
    return load_renderer(Backend::kEgl);
  } catch (const RendererUnavailable&) {
    return nullptr;
  }
}

TEST(Backends, EglTakesThePlaceOfOsmesaWhereThatIsMissing) {
  if (!egl_renderer()) GTEST_SKIP() << "no EGL here";
  const Scratch directory;
  fs::create_symlink(fs::path(HEXAPLAST_RENDER_MODULES) / "hexaplast_render_egl.so",
                     directory / "hexaplast_render_egl.so");
  EXPECT_NO_THROW(load_renderer(directory.path()));
  EXPECT_THROW(load_renderer(directory.path(), Backend::kOsmesa), RendererUnavailable);
}

TEST(EveryBackend, DrawsTheSame) {
  const std::unique_ptr<Renderer> egl = egl_renderer();
  if (!egl) GTEST_SKIP() << "no EGL here";
  const Drawing drawing = picture({});
  EXPECT_LE(num_different(egl->render(drawing), load_renderer(Backend::kOsmesa)->render(drawing)), kMaxDifferent);
  EXPECT_EQ(egl->render(drawing).pixels, egl->render(drawing).pixels);
}

}  // namespace
}  // namespace hexaplast
