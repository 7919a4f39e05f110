// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string_view>

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
    Example{"EulerImplicitSolver", R"xml(<EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.05"/>)xml"},
    Example{"StaticSolver", R"xml(<StaticSolver newtonSolver="@newton"/>
<NewtonRaphsonSolver name="newton" maxNbIterationsNewton="50" absoluteResidualStoppingThreshold="1e-8"/>)xml"},
    Example{"NewtonRaphsonSolver", R"xml(<StaticSolver newtonSolver="@newton"/>
<NewtonRaphsonSolver name="newton" maxNbIterationsNewton="50" maxNbIterationsLineSearch="3"
    relativeSuccessiveStoppingThreshold="0" relativeInitialStoppingThreshold="1e-6"
    absoluteResidualStoppingThreshold="1e-8"/>)xml"},
    Example{"CGLinearSolver", R"xml(<CGLinearSolver iterations="200" tolerance="1e-9" threshold="1e-20"/>)xml"},
    Example{"PCGLinearSolver", R"xml(<PCGLinearSolver iterations="100" tolerance="1e-18"/>)xml"},
    Example{"MultigridCGLinearSolver", R"xml(<MultigridCGLinearSolver preconditioner="auto" tolerance="0.001"/>)xml"},
    Example{"SparseLDLSolver", R"xml(<SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>)xml"},
    Example{"RegularGridTopology",
            R"xml(<RegularGridTopology name="grid" n="5 5 17" min="0 0 0" max="0.1 0.1 0.4"/>)xml"},
    Example{"MechanicalObject", R"xml(<MechanicalObject name="nodes" template="Vec3d" scale3d="1 1 0.5"/>)xml"},
    Example{"UniformMass", R"xml(<UniformMass totalMass="4"/>)xml"},
    Example{"DiagonalMass", R"xml(<DiagonalMass massDensity="1050"/>)xml"},
    Example{"HexahedronElastoplasticFEMForceField",
            R"xml(<HexahedronElastoplasticFEMForceField name="material" youngModulus="5e4" poissonRatio="0.45"
    yieldStress="2000" plasticFlowRate="4" hardening="0.2" volumeRestitution="1"/>)xml"},
    Example{"ConstantForceField", R"xml(<BoxROI name="top" box="-0.01 -0.01 0.39  0.11 0.11 0.41"/>
<ConstantForceField indices="@top.indices" totalForce="0 0.5 0"/>)xml"},
    Example{"LinearForceField", R"xml(<BoxROI name="top" box="-0.01 -0.01 0.39  0.11 0.11 0.41"/>
<LinearForceField points="@top.indices" times="0 0.5 2 2.1" forces="0 0 0  0 0.1 0  0 0.1 0  0 0 0"/>)xml"},
    Example{"TangentialForceField", R"xml(<TangentialForceField indices="72 74 80 78" axis="0 0 1" centre="0.05 0.05 0"
    times="0 0.5 2 2.1" forces="0 0.5 0.5 0"/>)xml"},
    Example{"BoxROI", R"xml(<BoxROI name="shin" box="-0.01 -0.01 -0.01  0.11 0.11 0.06"/>)xml"},
    Example{"FixedProjectiveConstraint", R"xml(<FixedProjectiveConstraint indices="0-8"/>)xml"},
};

}  // namespace hexaplast::attributes
