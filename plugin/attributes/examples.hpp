// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string_view>

#include "attributes/attribute.hpp"

/// Lines of XML that show each component in use: what the documentation prints, and the tests read.
namespace hexaplast::attributes {

/// A scene that runs, for the examples to stand in: they go into its node `body`.
inline constexpr std::string_view kExampleScene =
    R"xml(<Node name="root" dt="0.01" gravity="0 0 -9.81">
  <DefaultAnimationLoop/>
  <RunSettings steps="100" outputEvery="10"/>
  <Node name="body">
    <EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.1"/>
    <SparseLDLSolver/>
    <RegularGridTopology name="grid" n="3 3 9" min="0 0 0" max="0.1 0.1 0.4"/>
    <MechanicalObject name="nodes"/>
    <DiagonalMass massDensity="1000"/>
    <HexahedronElastoplasticFEMForceField name="material" youngModulus="5e4" poissonRatio="0.4"/>
    <BoxROI name="foot" box="-0.01 -0.01 -0.01  0.11 0.11 0.01"/>
    <FixedProjectiveConstraint indices="@foot.indices"/>
  </Node>
</Node>
)xml";

struct Example {
  std::string_view class_name = {};
  std::string_view lines = {};
};

/// Where none is listed, the component without attributes is the example.
inline constexpr std::array kExamples = {
    Example{"Node", R"xml(<Node name="load">
  <ConstantForceField indices="80" forces="0 0 -0.1"/>
</Node>)xml"},
    Example{"RequiredPlugin", R"xml(<RequiredPlugin name="Sofa.Component.Mass"/>)xml"},
    Example{"RunSettings", R"xml(<RunSettings steps="500" outputEvery="25"/>)xml"},
    Example{"AttributeChange", R"xml(<AttributeChange component="@material" attribute="youngModulus" keyTimes="0.2 0.6"
    values="2e4; 4e4"/>
<HexahedronElastoplasticFEMForceField name="material" youngModulus="5e4" poissonRatio="0.4"/>)xml"},
    Example{"EulerImplicitSolver", R"xml(<EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.05"/>)xml"},
    Example{"StaticSolver", R"xml(<StaticSolver newtonSolver="@newton"/>
<NewtonRaphsonSolver name="newton" maxNbIterationsNewton="50" absoluteResidualStoppingThreshold="1e-8"/>)xml"},
    Example{"NewtonRaphsonSolver", R"xml(<StaticSolver newtonSolver="@newton"/>
<NewtonRaphsonSolver name="newton" maxNbIterationsNewton="50" maxNbIterationsLineSearch="3"
    relativeSuccessiveStoppingThreshold="0" relativeInitialStoppingThreshold="1e-6"
    absoluteResidualStoppingThreshold="1e-8"/>)xml"},
    Example{"CGLinearSolver", R"xml(<CGLinearSolver iterations="200" tolerance="1e-9" threshold="0"/>)xml"},
    Example{"MultigridCGLinearSolver", R"xml(<MultigridCGLinearSolver preconditioner="auto" tolerance="0.001"/>)xml"},
    Example{"SparseLDLSolver", R"xml(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)xml"},
    Example{"RegularGridTopology",
            R"xml(<RegularGridTopology name="grid" n="5 5 17" min="0 0 0" max="0.1 0.1 0.4"/>)xml"},
    Example{"TubeGridTopology",
            R"xml(<TubeGridTopology name="grid" cells="2 16 12" innerRadius="0.03" outerRadius="0.05"
    centreline="0 0 0  0 0 0.1  0.05 0 0.2  0.15 0 0.3"/>)xml"},
    Example{"SheetGridTopology",
            R"xml(<SheetGridTopology name="grid" cells="8 8 2" size="0.1 0.1" thickness="0.01" curvature="3"/>)xml"},
    Example{"SpherePatchGridTopology", R"xml(<SpherePatchGridTopology name="grid" cells="6 6 2" innerRadius="0.1"
    outerRadius="0.12" angle="60"/>
<MechanicalObject name="nodes" translation="0 0 -0.1"/>)xml"},
    Example{"SparseGridTopology", R"xml(<SparseGridTopology name="cage" fileTopology="organ.obj" n="4 4 13"/>
<Node name="skin">
  <MeshOBJLoader name="loader" filename="organ.obj"/>
  <MechanicalObject position="@loader.position"/>
  <BarycentricMapping/>
</Node>)xml"},
    Example{"QuadSetTopologyContainer", R"xml(<Node name="skin">
  <QuadSetTopologyContainer name="quads" position="0 0 0  0.1 0 0  0.1 0.1 0  0 0.1 0" quads="0 1 2 3"/>
</Node>)xml"},
    Example{"TriangleSetTopologyContainer", R"xml(<Node name="skin">
  <TriangleSetTopologyContainer name="triangles" position="0 0 0  0.1 0 0  0 0.1 0" triangles="0 1 2"/>
</Node>)xml"},
    Example{"SpringForceField", R"xml(<SpringForceField spring="72 80 20 0.1 0.1  74 78 20 0.1 0.1"/>
<Node name="weight">
  <MechanicalObject name="points" position="0.15 0.1 0.4"/>
  <UniformMass totalMass="0.02"/>
</Node>
<SpringForceField object1="@nodes" object2="@weight/points" spring="80 0 20 0.1 0.05"/>)xml"},
    Example{"RestShapeSpringsForceField", R"xml(<RestShapeSpringsForceField points="72-80" stiffness="20"/>)xml"},
    Example{"MechanicalObject", R"xml(<MechanicalObject name="nodes" template="Vec3d" scale3d="1 1 0.5"/>)xml"},
    Example{"UniformMass", R"xml(<UniformMass totalMass="4"/>)xml"},
    Example{"DiagonalMass", R"xml(<DiagonalMass massDensity="1050"/>)xml"},
    Example{"HexahedronElastoplasticFEMForceField",
            R"xml(<HexahedronElastoplasticFEMForceField name="material" youngModulus="5e4" poissonRatio="0.45"
    yieldStress="2000" plasticFlowRate="4" hardening="0.2"/>)xml"},
    Example{"ConstantForceField", R"xml(<BoxROI name="top" box="-0.01 -0.01 0.39  0.11 0.11 0.41"/>
<ConstantForceField indices="@top.indices" totalForce="0 0.5 0"/>)xml"},
    Example{"LinearForceField", R"xml(<BoxROI name="top" box="-0.01 -0.01 0.39  0.11 0.11 0.41"/>
<LinearForceField points="@top.indices" times="0 0.5 2 2.1" forces="0 0 0  0 0.1 0  0 0.1 0  0 0 0"/>)xml"},
    Example{"TangentialForceField", R"xml(<TangentialForceField indices="72 74 80 78" axis="0 0 1" centre="0.05 0.05 0"
    times="0 0.5 2 2.1" forces="0 0.5 0.5 0"/>)xml"},
    Example{"GraspForceField", R"xml(<GraspForceField name="forceps" radius="0.06" graspTime="0.1" releaseTime="1.5"
    keyTimes="0.2 1 1.4" positions="0.05 0.05 0.4  0.05 0.1 0.45  0.08 0.1 0.45" stiffness="500" maxForce="2"/>)xml"},
    Example{"InstrumentContactForceField",
            R"xml(<InstrumentContactForceField name="probe" shape="capsule" radius="0.02" length="0.1" friction="0.2"
    keyTimes="0 1" positions="0.05 0.05 0.5  0.05 0.05 0.46"/>)xml"},
    Example{"Probe",
            R"xml(<Probe name="tip" value="@nodes.position" indices="72-80" component="z" change="true"/>)xml"},
    Example{"BoxROI", R"xml(<BoxROI name="shin" box="-0.01 -0.01 -0.01  0.11 0.11 0.06"/>)xml"},
    Example{"MaterialRegion", R"xml(<SphereROI name="tumour" centers="0.05 0.05 0.2" radii="0.06" strict="false"/>
<MaterialRegion name="hard" hexahedra="@tumour.hexahedraInROI" youngModulus="3e5" yieldStress="2e4"/>)xml"},
    Example{"BladeController", R"xml(<BladeController name="scalpel" points="0 -0.02 0  0 0.12 0" keyTimes="0.1 0.6"
    positions="-0.02 0 0.31  0.12 0 0.31"/>)xml"},
    Example{"PlaneROI", R"xml(<PlaneROI name="slice" plane="0 0 0.1  0.1 0 0.1  0.1 0.1 0.1  0.02"/>)xml"},
    Example{"MeshROI", R"xml(<MeshROI name="wedge" ROIposition="0 0 0  0.1 0 0  0 0.1 0  0 0 0.4"
    ROItriangles="0 2 1  0 1 3  1 2 3  0 3 2"/>)xml"},
    Example{"IndicesFromValues", R"xml(<IndicesFromValues name="tumour" global="1 1 2 2  1 1 2 2" values="2"
    recursiveSearch="true"/>
<MaterialRegion name="hard" indices="@tumour.indices" youngModulus="3e5"/>)xml"},
    Example{"IndexValueMapper", R"xml(<BoxROI name="shin" box="-0.01 -0.01 -0.01  0.11 0.11 0.11"/>
<IndexValueMapper name="moduli" inputValues="5e4 5e4 5e4 5e4  5e4 5e4 5e4 5e4" indices="@shin.hexahedronIndices"
    value="2e5"/>)xml"},
    Example{"FixedProjectiveConstraint", R"xml(<FixedProjectiveConstraint indices="0-8"/>)xml"},
    Example{"MeshTopology", R"xml(<MeshTopology name="grid" hexahedra="0-7"
    position="0 0 0  0.1 0 0  0.1 0.1 0  0 0.1 0  0 0 0.1  0.1 0 0.1  0.1 0.1 0.1  0 0.1 0.1"/>)xml"},
    Example{"HexahedronSetTopologyContainer", R"xml(<MeshVTKLoader name="loader" filename="block.vtk"/>
<HexahedronSetTopologyContainer name="grid" src="@loader"/>)xml"},
    Example{"MeshGmshLoader", R"xml(<MeshGmshLoader name="loader" filename="block.msh"/>
<MeshTopology name="grid" src="@loader"/>)xml"},
    Example{"MeshVTKLoader", R"xml(<MeshVTKLoader name="loader" filename="block.vtk" scale3d="1 1 2"/>
<MeshTopology name="grid" src="@loader"/>)xml"},
    Example{"MeshOBJLoader", R"xml(<MeshOBJLoader name="skin" filename="skin.obj" triangulate="true"/>)xml"},
    Example{"MeshSTLLoader", R"xml(<MeshSTLLoader name="skin" filename="skin.stl"/>)xml"},
    Example{"SphereROI", R"xml(<SphereROI name="ball" centers="0.05 0.05 0.2" radii="0.06"/>)xml"},
    Example{"PartialFixedProjectiveConstraint",
            R"xml(<PartialFixedProjectiveConstraint indices="72-80" fixedDirections="1 1 0"/>)xml"},
    Example{"LinearMovementProjectiveConstraint",
            R"xml(<BoxROI name="top" box="-0.01 -0.01 0.39  0.11 0.11 0.41"/>
<LinearMovementProjectiveConstraint indices="@top.indices" keyTimes="0 1 1000"
    movements="0 0 0  0 0 0.05  0 0 0.05"/>)xml"},
    Example{"PartialLinearMovementProjectiveConstraint",
            R"xml(<PartialLinearMovementProjectiveConstraint indices="72-80" keyTimes="0 1 1000"
    movements="0 0 0  0 0 0.05  0 0 0.05" movedDirections="0 0 1"/>)xml"},
    Example{"AttachProjectiveConstraint", R"xml(<Node name="weight">
  <MechanicalObject name="points" position="0.1 0.1 0.4"/>
  <UniformMass totalMass="0.02"/>
</Node>
<AttachProjectiveConstraint object1="@nodes" object2="@weight/points" indices1="80" indices2="0"/>)xml"},
    Example{"SurfacePressureForceField", R"xml(<SurfacePressureForceField pressure="-50"
    min="-0.01 -0.01 0.39" max="0.11 0.11 0.41"/>)xml"},
    Example{"PlaneForceField", R"xml(<PlaneForceField normal="0 0 -1" d="-0.41" stiffness="300" damping="2"/>)xml"},
    Example{"BarycentricMapping", R"xml(<Node name="skin">
  <MechanicalObject position="0.02 0.03 0.2  0.08 0.05 0.37"/>
  <BarycentricMapping input="@.." output="@."/>
  <ConstantForceField forces="0 0.1 0"/>
</Node>)xml"},
    Example{"IdentityMapping", R"xml(<Node name="copy">
  <MechanicalObject name="followers" position="@nodes.position"/>
  <IdentityMapping/>
</Node>)xml"},
};

}  // namespace hexaplast::attributes
