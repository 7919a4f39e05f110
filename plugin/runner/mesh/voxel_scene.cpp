// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/voxel_scene.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "formats/xml.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/quality.hpp"

namespace hexaplast::runner {
namespace {

using Box = Eigen::AlignedBox3d;

// Values to begin with: plausible for a parenchymatous organ, measured on nobody.
constexpr std::string_view kMaterial = "youngModulus=\"5000\" {}yieldStress=\"400\"";
constexpr double kHeld = 0.1;     // of the body's length, at least an edge
constexpr double kLifted = 0.2;   // of that length
constexpr double kPressed = 0.1;  // of the body's length, at most half of the ball's radius

std::optional<Box> box_in(const std::string& words) {
  std::istringstream in(words);
  Vec3 first, second;
  for (Vec3* corner : {&first, &second})
    for (double& number : *corner)
      if (!(in >> number) || !std::isfinite(number)) return std::nullopt;
  if (!(in >> std::ws).eof()) return std::nullopt;
  return Box(first.cwiseMin(second), first.cwiseMax(second));
}

std::string numbers(const Vec3& v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x(), v.y(), v.z()); }

/// What the scene holds, and the way out of the body on the other side.
struct Support {
  Box box;
  Vec3 away;
};

Support support_of(const std::string& hold, const Box& body, double edge) {
  Support found;
  int axis = 0;
  bool at_greater = true;
  if (const auto side = std::ranges::find(kSides, hold); side != kSides.end()) {
    const auto at = static_cast<int>(side - kSides.begin());
    axis = at / 2;
    at_greater = at % 2 == 0;
    const double depth = std::max(kHeld * body.sizes()[axis], edge / 2);  // one layer of nodes at least
    found.box = Box(body.min().array() - edge / 2, body.max().array() + edge / 2);
    (at_greater ? found.box.min() : found.box.max())[axis] =
        at_greater ? body.max()[axis] - depth : body.min()[axis] + depth;
  } else {
    found.box = box_in(hold).value();
    const Vec3 way = found.box.center() - body.center();
    way.cwiseAbs().maxCoeff(&axis);
    at_greater = way[axis] > 0;
  }
  found.away = Vec3::Unit(axis) * (at_greater ? -1 : 1);
  return found;
}

/// The outermost point along `away`, of those that lie nearest to the axis through the middle, give or take an edge.
Vec3 touched_point(const PointArray& x, const Vec3& middle, const Vec3& away, double edge) {
  const PointArray from_middle = x.rowwise() - middle.transpose();
  const Eigen::VectorXd along = from_middle * away;
  const Eigen::VectorXd beside = (from_middle - along * away.transpose()).rowwise().norm();
  const double near = beside.minCoeff() + edge;
  Eigen::Index outermost = -1;
  for (Eigen::Index n = 0; n < x.rows(); ++n)
    if (beside[n] <= near && (outermost < 0 || along[n] > along[outermost])) outermost = n;
  return x.row(outermost).transpose();
}

/// A component's name: letters, digits and underscores.
std::string identifier(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

}  // namespace

bool is_hold(const std::string& word) { return std::ranges::find(kSides, word) != kSides.end() || box_in(word); }

std::string scene_of_voxels(const VoxelScene& options, const VoxelMesh& made, const PointArray& surface) {
  std::string title = options.title;  // two hyphens end a comment
  for (std::size_t at; (at = title.find("--")) != std::string::npos;) title.replace(at, 2, "-");
  const PointArray& x = made.mesh.positions();
  const Box body(Vec3(x.colwise().minCoeff().transpose()), Vec3(x.colwise().maxCoeff().transpose()));
  const double edge = quality(made.mesh).longest_edge;
  const auto [held, away] = support_of(options.hold, body, edge);
  const auto num_held =
      std::ranges::count_if(x.rowwise(), [&held = held](const auto& p) { return held.contains(Vec3(p)); });
  if (num_held == 0 || num_held == x.rows())
    throw InputError(fmt::format("{} of {} nodes lie in the box {}, {} that is held: the body lies between {} and {}",
                                 num_held, x.rows(), numbers(held.min()), numbers(held.max()), numbers(body.min()),
                                 numbers(body.max())));

  const double length = std::abs(away.dot(body.sizes()));
  const double radius = std::max(1.5 * edge, kHeld * body.sizes().maxCoeff());
  const Vec3 at = touched_point(surface, body.center(), away, edge);
  const Vec3 outside = at + (1.5 * radius + 2 * kLifted * length) * away, lifted = at + kLifted * length * away,
             pressed = at + (radius - std::min(kPressed * length, radius / 2)) * away;

  std::map<int, int> count;
  for (const int label : made.labels) ++count[label];
  const int commonest = std::ranges::max_element(count, {}, [](const auto& each) { return each.second; })->first;
  constexpr std::array kSuffixes = {"", "_cells", "_strain"};  // of a region, its selection and its probe
  std::string regions, probes;
  std::set<std::string> taken = {"nodes", "material", "supports", "surface", "skin",
                                 "ball",  "forceps",  "loader",   "push",    "pull"};
  for (const auto& [label, hexahedra] : count) {
    const auto named = options.names.find(label);
    std::string name = named == options.names.end() ? "" : identifier(named->second);
    if (name.empty() || name.starts_with("label_") || name.starts_with("probe_") ||
        std::ranges::any_of(kSuffixes, [&](const char* suffix) { return taken.contains(name + suffix); }))
      name = fmt::format("label_{}", label);
    for (const char* suffix : kSuffixes) taken.insert(name + suffix);
    const std::string cells = name + "_cells";
    regions += fmt::format(
        "    <IndicesFromValues name=\"{}\" global=\"@loader.label\" values=\"{}\" recursiveSearch=\"true\"/>\n", cells,
        label);
    if (label != commonest)
      regions += fmt::format("    <MaterialRegion name=\"{}\" indices=\"@{}.indices\" {}/>\n", name, cells,
                             fmt::format(kMaterial, ""));
    probes += fmt::format("    <Probe name=\"{}_strain\" value=\"@material.plasticStrain\" indices=\"@{}.indices\"/>\n",
                          name, cells);
  }

  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<!--
  {title}

  A ball presses into the tissue and draws back; then forceps draw it out and let go. SI units; x to the left, y to the
  back, z to the head, where the image says so. Materials are values to begin with: replace them by your own.
-->
<Node name="root" dt="0.01" gravity="0 0 0">
  <RequiredPlugin pluginName="Hexaplast"/>
  <RequiredPlugin pluginName="Sofa.Component.AnimationLoop"/>
  <RequiredPlugin pluginName="Sofa.Component.Constraint.Projective"/>
  <RequiredPlugin pluginName="Sofa.Component.Engine.Select"/>
  <RequiredPlugin pluginName="Sofa.Component.IO.Mesh"/>
  <RequiredPlugin pluginName="Sofa.Component.Mapping.Linear"/>
  <RequiredPlugin pluginName="Sofa.Component.Mass"/>
  <RequiredPlugin pluginName="Sofa.Component.ODESolver.Backward"/>
  <RequiredPlugin pluginName="Sofa.Component.StateContainer"/>
  <RequiredPlugin pluginName="Sofa.Component.Topology.Container.Constant"/>
  <RequiredPlugin pluginName="Sofa.Component.Visual"/>
  <RequiredPlugin pluginName="Sofa.GL.Component.Rendering3D"/>
  <DefaultAnimationLoop/>
  <VisualStyle displayFlags="showVisualModels hideBehaviorModels"/>
  <RunSettings steps="350" outputEvery="25"/>

  <Node name="organ">
    <EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.02"/>
    <MultigridCGLinearSolver tolerance="0.01"/>
    <MeshVTKLoader name="loader" filename="{mesh}"/>
    <MeshTopology src="@loader"/>
    <MechanicalObject name="nodes" template="Vec3d"/>
    <DiagonalMass massDensity="1060"/>
    <HexahedronElastoplasticFEMForceField name="material" template="Vec3d" {material}
        plasticFlowRate="4" precision="mixed"/>

    <!-- The commonest label has the material above; what differs in the others is given here. -->
{regions}
    <!-- What is held. -->
    <BoxROI name="supports" box="{low}  {high}"/>
    <FixedProjectiveConstraint indices="@supports.indices"/>

    <!-- What is seen and touched. -->
    <MeshOBJLoader name="surface" filename="{surface}"/>
    <Node name="skin">
      <OglModel name="model" src="@../surface"/>
      <BarycentricMapping/>
    </Node>

    <!-- Half a second to the tissue, held until 1 s, and back. -->
    <InstrumentContactForceField name="ball" template="Vec3d" radius="{radius:.6g}" friction="0.2"
        embeddedPositions="@surface.position" embeddedTriangles="@surface.triangles"
        keyTimes="0 0.5 1 1.4" positions="{outside}  {pressed}  {pressed}  {outside}"/>

    <!-- They close at 1.5 s on what lies within the radius, and open at 2.6 s. -->
    <GraspForceField name="forceps" template="Vec3d" radius="{grip:.6g}" stiffness="500" graspTime="1.5" releaseTime="2.6"
        keyTimes="1.5 2.3" positions="{at}  {lifted}"/>

    <Probe name="push" value="@ball.force"/>
    <Probe name="pull" value="@forceps.force"/>
{probes}  </Node>
</Node>
)",
      fmt::arg("title", escaped(title)), fmt::arg("mesh", escaped(options.mesh_file)),
      fmt::arg("surface", escaped(options.surface_file)),
      fmt::arg("material", fmt::format(kMaterial, "poissonRatio=\"0.45\" ")), fmt::arg("regions", regions),
      fmt::arg("low", numbers(held.min())), fmt::arg("high", numbers(held.max())), fmt::arg("radius", radius),
      fmt::arg("outside", numbers(outside)), fmt::arg("pressed", numbers(pressed)), fmt::arg("at", numbers(at)),
      fmt::arg("lifted", numbers(lifted)), fmt::arg("grip", std::max(1.2 * edge, radius / 2)),
      fmt::arg("probes", probes));
}

}  // namespace hexaplast::runner
