# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bar of bar_stretch_high.scn in Python, for SOFA with SofaPython3, and what a script can do with it: it reads the
plastic strain after every step, and prints how long the bar would be without forces.

    runSofa -l SofaPython3,Hexaplast scenes/bar_stretch.py
"""
try:
    import Sofa
    Controller = Sofa.Core.Controller
except ImportError:  # the scene can be made without SOFA, to look at
    Controller = object

MODULES = ("AnimationLoop", "Constraint.Projective", "Engine.Select", "LinearSolver.Direct", "Mass", "MechanicalLoad",
           "ODESolver.Backward", "StateContainer", "Topology.Container.Grid")


class Observer(Controller):
    """Tells every half second what has become permanent."""

    def __init__(self, body, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.body = body
        self.steps = 0

    def onAnimateEndEvent(self, event):
        self.steps += 1
        if self.steps % 50:
            return
        strain = self.body.plasticStrain.value
        z = self.body.plasticRestPositions.value[:, 2]
        print(f"step {self.steps}: greatest plastic strain {max(strain):.3f}, length without forces "
              f"{z.max() - z.min():.4f} m")


def createScene(root):
    root.dt = 0.01
    root.gravity = [0, 0, 0]
    root.addObject("RequiredPlugin", pluginName="Hexaplast")
    for module in MODULES:
        root.addObject("RequiredPlugin", pluginName="Sofa.Component." + module)
    root.addObject("DefaultAnimationLoop")
    root.addObject("RunSettings", steps=500, outputEvery=25)

    bar = root.addChild("bar")
    bar.addObject("EulerImplicitSolver", rayleighMass=0.1, rayleighStiffness=0.1)
    bar.addObject("SparseLDLSolver", template="CompressedRowSparseMatrixMat3x3d")
    bar.addObject("RegularGridTopology", name="grid", n=[4, 4, 11], min=[-0.15, -0.15, -0.5], max=[0.15, 0.15, 0.5])
    bar.addObject("MechanicalObject", name="nodes", template="Vec3d")
    bar.addObject("DiagonalMass", massDensity=1000)
    body = bar.addObject("HexahedronElastoplasticFEMForceField", name="material", template="Vec3d",
                         bending="blended", volumetric="sample", recovery="none",
                         youngModulus=[5000], poissonRatio=[0.45], yieldNorm="frobenius", yieldStress=[300],
                         plasticFlowRate=4, hardening=0.2, restShape="joined", rotationPlasticity="none",
                         volumeRestitution=1)
    bar.addObject("BoxROI", name="middle", box=[-0.16, -0.16, -0.01, 0.16, 0.16, 0.01])
    bar.addObject("FixedProjectiveConstraint", indices="@middle.indices")
    for name, nodes, pull in (("pullUp", [165, 166, 169, 170], 22.5), ("pullDown", [5, 6, 9, 10], -22.5)):
        bar.addObject("LinearForceField", name=name, template="Vec3d", points=nodes,
                      times=[-0.01, 0.49, 1.994, 1.996], forces=[[0, 0, 0], [0, 0, pull], [0, 0, pull], [0, 0, 0]])
    if Controller is not object:
        root.addObject(Observer(body, name="observer"))
    return root
