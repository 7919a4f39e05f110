// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "base/disjoint_sets.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "mesh/trilinear.hpp"
#include "support/golden.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using namespace support;

void expect_within_4_ulp(double value, double expected) {
  const double ulp = std::nextafter(std::abs(expected), std::numeric_limits<double>::infinity()) - std::abs(expected);
  EXPECT_NEAR(value, expected, 4 * ulp);
}

std::vector<double> volumes(const HexMesh& mesh) {
  std::vector<double> volumes;
  for (const Hexahedron& corners : mesh.hexahedra()) volumes.push_back(volume(gather(mesh.positions(), corners)));
  return volumes;
}

/// In one call.
std::vector<int> split(NodeCopies& copies, const HexMesh& mesh, const Joints& joints, const std::vector<int>& opened,
                       std::vector<unsigned char>& is_open, std::vector<Hexahedron>& hexahedra) {
  return copies.split(mesh, joints, opened, std::vector{static_cast<int>(opened.size())}, is_open, volumes(mesh),
                      hexahedra);
}

HexMesh some_of(const HexMesh& mesh, double fraction, Random& random) {
  std::vector<Hexahedron> kept;
  for (const Hexahedron& corners : mesh.hexahedra())
    if (random.uniform(0, 1) < fraction) kept.push_back(corners);
  return {mesh.positions(), kept};
}

/// tests/data/cutting/mesh_*.json: the conventions stand in its README.
class OpenedMesh : public testing::TestWithParam<std::string> {
 protected:
  const Json data = test_data("cutting", "mesh_" + GetParam());
  const HexMesh mesh{matrix(data["positions"]), hexahedra(data["hexahedra"])};
  const Joints joints{mesh};

  std::vector<int> numbers(const Json& open) const {
    std::vector<int> numbers;
    for (const Json& face : open["faces"]) numbers.push_back(joints.find(Joints::Face{face[0], face[1]}));
    for (const Json& hinge : open["hinges"]) numbers.push_back(joints.find(Joints::Hinge{hinge[0], hinge[1]}));
    return numbers;
  }
};

TEST_P(OpenedMesh, HasTheFacesAndHingesOfTheReference) {
  EXPECT_EQ(joints.num_faces(), data["num_faces_between"]);
  ASSERT_EQ(joints.num_hinges(), data["hinges"].size());
  for (int k = 0; k < joints.num_hinges(); ++k) {
    const Json& hinge = data["hinges"][k];
    EXPECT_EQ(joints.hinges()[k], (Joints::Hinge{hinge["hexahedra"][0], hinge["hexahedra"][1]}));
    const std::span<const int> nodes = joints.nodes(joints.num_faces() + k);
    EXPECT_EQ(std::vector<int>(nodes.begin(), nodes.end()), hinge["nodes"]);
  }
}

TEST_P(OpenedMesh, HasTheNodesAndSharesOfTheReference) {
  NodeCopies copies(mesh.num_nodes());
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  std::vector<unsigned char> is_open(joints.count(), 0);
  std::vector<int> parents;
  for (const Json& call : data["calls"]) {
    const std::vector<int> opened = numbers(call["open"]);
    ASSERT_TRUE(std::ranges::find(opened, -1) == opened.end());
    const std::vector<double> share_before = copies.share();
    for (const int parent : split(copies, mesh, joints, opened, is_open, hexahedra)) parents.push_back(parent);

    const Json& after = call["after"];
    EXPECT_EQ(copies.num_nodes(), after["num_nodes"]);
    EXPECT_EQ(hexahedra, support::hexahedra(after["hexahedra"]));
    EXPECT_EQ(parents, after["parent"]);
    for (const Json& split : call["splits"])
      for (const Json& copy : split["copies"])
        expect_within_4_ulp(copies.share()[copy["copy"]] / share_before[split["node"]], copy["share"]);
    for (int n = 0; n < copies.num_nodes(); ++n) {
      const Json& initial_mass = data["before"]["uniform_masses"][copies.initial()[n]];
      expect_within_4_ulp(copies.share()[n] * initial_mass.get<double>(), after["uniform_masses"][n]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, OpenedMesh,
                         testing::Values("block_all", "block_plane", "block_random", "corner_contact", "crack",
                                         "edge_contact", "o_grid", "removed", "ring", "scrambled", "t_junction",
                                         "voxels_random"),
                         [](const auto& test) { return test.param; });

// The definition, over all corners at once: corners at one initial node are one present node if closed joints connect.
TEST(NodeCopies, OfRandomOpeningsAreTheConnectedCorners) {
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    const HexMesh mesh = some_of(block({4, 3, 3}, 0.1), 0.7, random);
    const Joints joints(mesh);
    NodeCopies copies(mesh.num_nodes());
    std::vector<Hexahedron> hexahedra = mesh.hexahedra();
    std::vector<unsigned char> is_open(joints.count(), 0);
    for (int call = 0; call < 3; ++call) {
      std::vector<int> opened;
      for (int j = 0; j < joints.count(); ++j)
        if (!is_open[j] && random.uniform(0, 1) < 0.3) opened.push_back(j);
      split(copies, mesh, joints, opened, is_open, hexahedra);
    }

    DisjointSets corners(8 * mesh.num_elements());
    const auto corner = [&](int e, int n) {
      return 8 * e + static_cast<int>(std::ranges::find(mesh.hexahedra()[e], n) - mesh.hexahedra()[e].begin());
    };
    for (int j = 0; j < joints.count(); ++j)
      for (const int n : joints.nodes(j))
        for (const int e : joints.hexahedra(j))
          if (!is_open[j]) corners.join(corner(joints.hexahedra(j).front(), n), corner(e, n));
    int groups = mesh.num_nodes();
    for (int n = 0; n < mesh.num_nodes(); ++n) {
      std::vector<int> roots;
      for (const auto& [e, a] : mesh.incident(n)) {
        roots.push_back(corners.root(8 * e + a));
        for (const auto& [f, b] : mesh.incident(n))
          EXPECT_EQ(hexahedra[e][a] == hexahedra[f][b], corners.root(8 * e + a) == corners.root(8 * f + b));
      }
      std::ranges::sort(roots);
      const int different = static_cast<int>(std::unique(roots.begin(), roots.end()) - roots.begin());
      groups += std::max(different - 1, 0);
    }
    EXPECT_EQ(copies.num_nodes(), groups);
    std::vector<double> shares(mesh.num_nodes(), 0.0);
    for (int n = 0; n < copies.num_nodes(); ++n) shares[copies.initial()[n]] += copies.share()[n];
    for (const double sum : shares) EXPECT_NEAR(sum, 1, 1e-15);

    // the surface is closed: its faces share each edge in pairs
    std::map<std::pair<int, int>, int> faces_at;
    for (const auto& face : HexMesh(mesh.positions()(copies.initial(), Eigen::all), hexahedra).boundary_faces())
      for (int k = 0; k < 4; ++k) ++faces_at[std::minmax(face[k], face[(k + 1) % 4])];
    for (const auto& [edge, count] : faces_at) EXPECT_EQ(count % 2, 0);
  }
}

TEST(Joints, TieTheHexahedraOfEveryNode) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const HexMesh mesh = some_of(block({3, 3, 3}, 0.1), 0.4, random);
    const Joints joints(mesh);
    NodeCopies copies(mesh.num_nodes());
    std::vector<Hexahedron> hexahedra = mesh.hexahedra();
    std::vector<int> all(joints.count());
    for (int j = 0; j < joints.count(); ++j) all[j] = j;
    std::vector<unsigned char> is_open(joints.count(), 0);
    EXPECT_TRUE(split(copies, mesh, joints, {}, is_open, hexahedra).empty());
    split(copies, mesh, joints, all, is_open, hexahedra);
    EXPECT_EQ(copies.num_nodes(), 8 * mesh.num_elements() + std::ranges::count_if(copies.initial(), [&](int n) {
                                    return mesh.incident(n).empty();
                                  }));
  }
}

}  // namespace
}  // namespace hexaplast
