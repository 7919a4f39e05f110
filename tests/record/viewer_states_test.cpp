// SPDX-License-Identifier: LGPL-2.1-or-later
// The states for the viewer of a report: as they were recorded, to what their few bits can tell.
#include "record/viewer_states.hpp"

#include <zlib.h>

#include <nlohmann/json.hpp>

#include "formats/base64.hpp"
#include "hexaplast/base/error.hpp"
#include "record/packed_numbers.hpp"
#include "support/output.hpp"

namespace hexaplast {
namespace {

using namespace support;

using output::ViewerStates;
using Json = nlohmann::json;

/// The numbers of an array, read by its description.
std::vector<std::uint32_t> unpacked(const Json& all, const std::string& name) {
  const std::string base64 = all.at("data");
  const std::string deflated = from_base64(base64).value();
  std::string bytes(std::size_t{1} << 22, '\0');
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(deflated.data()),
                       deflated.size()),
            Z_OK);
  std::size_t begin = 0;
  for (const Json& array : all.at("arrays")) {
    const std::size_t count = array.at("count"), width = array.at("bits").get<std::size_t>() / 8;
    const std::size_t stride = array.at("stride");
    if (array.at("name") == name) {
      std::vector<std::uint32_t> values;
      const std::uint64_t range = std::uint64_t{1} << (8 * width);
      for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t folded = 0;
        for (std::size_t byte = 0; byte < width; ++byte)
          folded |= std::uint64_t{static_cast<unsigned char>(bytes[begin + byte * count + i])} << (8 * byte);
        const std::uint64_t difference = folded % 2 == 0 ? folded / 2 : range - (folded + 1) / 2;
        const std::uint64_t before = i < stride ? 0 : values[i - stride];
        values.push_back(static_cast<std::uint32_t>((before + difference) % range));
      }
      return values;
    }
    begin += count * width;
  }
  ADD_FAILURE() << "no array " << name;
  return {};
}

TEST(PackedNumbers, HoldAnyNumbers) {
  const std::vector<std::uint8_t> bytes{0, 255, 1, 128, 127, 254};
  const std::vector<std::uint16_t> words{65535, 0, 32768, 32767, 1, 40000, 40001};
  const std::vector<std::uint32_t> numbers{4294967295u, 0, 2147483648u, 2147483647u, 7};
  output::PackedNumbers packed;
  packed.add("bytes", bytes, 1);
  packed.add("words", words, 3);
  packed.add("numbers", numbers, 2);
  Json all{{"data", packed.base64()}, {"arrays", Json::array()}};
  for (const auto& array : packed.arrays())
    all["arrays"].push_back(
        {{"name", array.name}, {"bits", array.bits}, {"count", array.count}, {"stride", array.stride}});
  EXPECT_EQ(unpacked(all, "bytes"), std::vector<std::uint32_t>(bytes.begin(), bytes.end()));
  EXPECT_EQ(unpacked(all, "words"), std::vector<std::uint32_t>(words.begin(), words.end()));
  EXPECT_EQ(unpacked(all, "numbers"), numbers);
}

/// A finished run of a body with two surfaces in it, as viewer.json has it.
struct Viewed {
  Viewed() : run(with_surfaces(), 6) {
    run.recorder.finish();
    all = Json::parse(run.read("viewer.json"));
  }

  static output::RunPlan with_surfaces() {
    output::RunPlan with = plan(6, 100);
    with.staging.embedded_surfaces = two_surfaces();
    return with;
  }

  Recorded run;
  Json all;
  const int num_nodes = run.body.mesh().num_nodes();
};

// To half a step of their 16 bits.
TEST(ViewerFile, HasThePositionsOfEveryStateAndWhatTheyCarry) {
  const Viewed viewed;
  const PointArray X = viewed.run.body.mesh().positions();
  const std::vector<double> box = viewed.all.at("box");
  const std::vector<std::uint32_t> numbers = unpacked(viewed.all, "positions");
  ASSERT_EQ(numbers.size(), 7u * 3 * viewed.num_nodes);
  PointArray x(viewed.num_nodes, 3);
  const Eigen::RowVector3d least(box[0], box[1], box[2]), size = Eigen::RowVector3d(box[3], box[4], box[5]) - least;
  const double half_a_step = 0.5 * size.maxCoeff() / 65535 + 1e-7;
  for (int step = 0; step <= 6; ++step) {
    for (int n = 0; n < x.size(); ++n) x(n / 3, n % 3) = numbers[step * x.size() + n] / 65535.0;
    x = (x * size.asDiagonal()).rowwise() + least;
    EXPECT_LT((x - stretched(X, 0.02 * step)).cwiseAbs().maxCoeff(), half_a_step) << step;
  }

  // an embedded point, by the weights of seven corners of its hexahedron
  const std::vector<std::uint32_t> hexahedra = unpacked(viewed.all, "hexahedra");
  for (int s = 0; s < 2; ++s) {
    const Json limits = viewed.all.at("embedded").at(s);
    const double min = limits.at("least"), max = limits.at("most");
    const auto carriers = unpacked(viewed.all, "carriers_" + std::to_string(s)),
               weights = unpacked(viewed.all, "weights_" + std::to_string(s));
    const PointArray expected = stretched(two_surfaces()[s].points, 0.12);
    for (int point = 0; point < expected.rows(); ++point) {
      const std::uint32_t* nodes = &hexahedra[8 * carriers[point]];
      Eigen::RowVector3d place = x.row(nodes[0]);
      for (int corner = 1; corner < kCorners; ++corner)
        place +=
            (min + (max - min) * weights[7 * point + corner - 1] / 65535) * (x.row(nodes[corner]) - x.row(nodes[0]));
      EXPECT_LT((place - expected.row(point)).norm(), 12 * half_a_step) << s << " " << point;
    }
  }
}

// The mesh is the last one: three hexahedra in a row, of which one comes off after each state.
TEST(ViewerFile, HasCopiesWhereTheirNodesWereBeforeTheySplit) {
  Body body(block({3, 1, 1}, 0.1), {Material()});
  const output::Bodies bodies(body);
  ViewerStates states(bodies, "cut", 2, 0.01, {});
  PointArray x = body.mesh().positions();
  std::vector<PointArray> recorded;
  for (int step = 0; step <= 2; ++step) {
    if (step > 0) append_rows(body.open(std::array{step - 1}), x);
    for (const int node : body.mesh().hexahedra()[2]) x(node, 2) += 0.03;
    recorded.push_back(x);
    states.add(step, 0.01 * step, x, PointArray::Zero(x.rows(), 3), {});
  }
  const Json all = Json::parse(states.json());
  ASSERT_EQ(all.at("nodes"), 24);
  const std::vector<double> box = all.at("box");
  const std::vector<std::uint32_t> numbers = unpacked(all, "positions");
  ASSERT_EQ(numbers.size(), 3u * 3 * 24);
  const std::vector<int>& initial = body.copies().initial();
  for (int step = 0; step <= 2; ++step)
    for (int n = 0; n < 24; ++n) {
      const auto height = [&](int node) {
        return box[2] + (box[5] - box[2]) * numbers[3 * (24 * step + node) + 2] / 65535.0;
      };
      if (n < recorded[step].rows()) {
        EXPECT_NEAR(height(n), recorded[step](n, 2), 1e-5);
      } else if (step == 0) {
        EXPECT_EQ(height(n), height(initial[n]));
      }
    }
}

TEST(ViewerFile, HasStrainsBetweenThoseOfTheHexahedraAroundANode) {
  const Viewed viewed;
  const Json& fields = viewed.all.at("fields");
  const auto field = std::ranges::find_if(fields, [](const Json& one) { return one.at("word") == "plastic_strain"; });
  ASSERT_NE(field, fields.end());
  const double least = field->at("least"), step = (field->at("most").get<double>() - least) / 254;
  const std::vector<std::uint32_t> numbers = unpacked(viewed.all, "values_plastic_strain");
  const HexMesh& mesh = viewed.run.body.mesh();
  const std::vector<double> strain = viewed.run.body.fields(viewed.run.x).plastic_strain;
  std::vector<std::vector<double>> around(mesh.num_nodes());
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (const int node : mesh.hexahedra()[e]) around[node].push_back(strain[e]);
  for (int node = 0; node < mesh.num_nodes(); ++node) {
    const double value = least + step * numbers[6 * mesh.num_nodes() + node];
    EXPECT_GE(value, std::ranges::min(around[node]) - step) << node;
    EXPECT_LE(value, std::ranges::max(around[node]) + step) << node;
  }
}

TEST(ViewerFile, HasWhatHoldsAndLoadsTheBody) {
  const Viewed viewed;
  const Json& all = viewed.all;
  const int num_nodes = viewed.num_nodes;
  ASSERT_EQ(all.at("states").size(), 7u);
  const output::BoundaryConditions conditions = some_conditions(viewed.run.body);
  const Json& first = all.at("states").at(0);
  std::vector<int> fixed;
  for (int node = 0; node < num_nodes; ++node)
    if (conditions.fixed[node]) fixed.push_back(node);
  EXPECT_EQ(first.at("fixed").get<std::vector<int>>(), fixed);
  EXPECT_FALSE(all.at("states").at(1).contains("fixed"));  // as before
  const Vec3 pull = conditions.instruments.front().force();
  const std::vector<double> force = first.at("tools").at(0).at("force");
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(force[axis], pull[axis], 1e-6);
  ASSERT_FALSE(first.at("loads").empty());
  for (const Json& load : first.at("loads")) {
    const int node = load.at(0);
    EXPECT_NE(node, 4);  // what the instrument does is no load
    EXPECT_NE(node, 9);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(load.at(1 + axis), conditions.loads(node, axis), 1e-6);
  }
}

TEST(ViewerFile, NamesHexahedraThatGo) {
  TornPillar pillar;
  const output::Bodies bodies(pillar.body);
  ViewerStates states(bodies, "tear", 1, 0.01, {});
  const PointArray v = some_velocities(pillar.body);
  states.add(0, 0, pillar.x, v, {});
  pillar.tear();
  states.add(1, 0.01, pillar.x, v, {});
  const Json all = Json::parse(states.json());
  EXPECT_FALSE(all.at("states").at(0).contains("gone"));
  std::vector<int> gone(pillar.body.removed().begin(), pillar.body.removed().end());
  std::ranges::sort(gone);
  EXPECT_EQ(all.at("states").at(1).at("gone").get<std::vector<int>>(), gone);
}

TEST(ViewerFile, HasTheEndsOfSpringsAndWhichAreSlack) {
  const Body body(block({1, 2, 3}, 0.1), {Material{}});
  const output::Bodies bodies(body);
  ViewerStates states(bodies, "springs", 2, 0.01, {});
  const PointArray x = body.mesh().positions(), v = some_velocities(body);
  const std::vector<output::SpringLine> springs{{Vec3(.3, .1, -.2), Vec3(.5, .7, 0)},
                                                {Vec3(.4, .15, .25), Vec3(0, 0, .31), true}};
  states.add(0, 0, x, v, {});
  states.add(1, 0.01, x, v, {.fixed = {}, .instruments = {}, .springs = springs});
  const Json all = Json::parse(states.json());
  EXPECT_FALSE(all.at("states").at(0).contains("springs"));
  const Json& shown = all.at("states").at(1).at("springs");
  EXPECT_EQ(shown.at("first"), 0);
  EXPECT_EQ(shown.at("ends"), 4);
  EXPECT_EQ(shown.at("slack").get<std::vector<int>>(), std::vector<int>{1});
  const std::vector<double> box = all.at("springBox");
  const std::vector<std::uint32_t> numbers = unpacked(all, "springs");
  ASSERT_EQ(numbers.size(), 12u);
  for (std::size_t end = 0; end < 4; ++end)
    for (int axis = 0; axis < 3; ++axis) {
      const double span = box[3 + axis] - box[axis], place = box[axis] + span * numbers[3 * end + axis] / 65535;
      const auto& [from, to, is_slack] = springs[end / 2];
      EXPECT_NEAR(place, (end % 2 == 0 ? from : to)[axis], 1e-5) << end;
    }
}

TEST(ViewerFile, HasRegionsWithTheirColours) {
  const Body body(block({1, 2, 3}, 0.1), {Material{}});
  const output::Bodies bodies(body);
  output::Staging staging;
  staging.regions = {{0, 2, 1, 1, 0, 2}, {"wall", "organ/tumour"}};
  ViewerStates states(bodies, "regions", 1, 0.01, staging);
  states.add(0, 0, body.mesh().positions(), some_velocities(body), {});
  const Json all = Json::parse(states.json());
  EXPECT_EQ(unpacked(all, "regions"), (std::vector<std::uint32_t>{0, 2, 1, 1, 0, 2}));
  std::vector<std::string> names;
  for (const Json& region : all.at("regions")) names.push_back(region.at("name"));
  EXPECT_EQ(names, (std::vector<std::string>{"in no region", "wall", "organ/tumour"}));
  EXPECT_NE(all.at("regions").at(1).at("colour"), all.at("regions").at(2).at("colour"));
}

TEST(ViewerFile, OfManyNodesHasFewerStatesAndSaysSo) {
  const auto steps_of = [](const std::array<int, 3>& n, bool& is_thinned) {
    const Body body(block(n, 0.1), {Material{}});
    const output::Bodies bodies(body);
    ViewerStates states(bodies, "block", 400, 0.01, {});
    std::vector<long> steps;
    const PointArray v = some_velocities(body);
    for (long step = 0; step <= 400; ++step) {
      if (!states.wants(step)) continue;
      steps.push_back(step);
      states.add(step, 0.01 * step, stretched(body.mesh().positions(), 1e-3 * step), v, {});
    }
    const std::string json = states.json();
    EXPECT_LT(json.size(), 512 * 1024 * body.mesh().num_nodes() / 1000) << "half a megabyte per thousand nodes";
    is_thinned = Json::parse(json).contains("thinned");
    return steps;
  };
  bool is_thinned = true;
  EXPECT_EQ(steps_of({9, 9, 9}, is_thinned).size(), 60u);
  EXPECT_FALSE(is_thinned);
  const std::vector<long> few = steps_of({19, 19, 39}, is_thinned);  // 16000 nodes of 12 bytes
  EXPECT_EQ(few.size(), 10u);
  EXPECT_EQ(few.front(), 0);
  EXPECT_EQ(few.back(), 400);
  EXPECT_TRUE(is_thinned);
}

TEST(ViewerFile, OfAStrangerIsWordsToThePage) {
  const Scratch scratch;
  EXPECT_FALSE(output::read_viewer_data(scratch / "."));
  put(scratch / "viewer.json", R"({"format":1,"title":"</script><script>alert(1)</script>&"})");
  const output::ViewerData data = output::read_viewer_data(scratch / ".").value();
  const std::string& markup = data.markup;
  EXPECT_FALSE(data.has_states);
  EXPECT_EQ(markup.find_first_of("<>&"), markup.npos);
  EXPECT_EQ(Json::parse(markup).at("title"), "</script><script>alert(1)</script>&");
  for (const char* other : {"", "{", "[]", R"({"format":2})", "alert(1)"}) {
    put(scratch / "viewer.json", other);
    EXPECT_THROW(output::read_viewer_data(scratch / "."), InputError) << other;
  }
}

}  // namespace
}  // namespace hexaplast
