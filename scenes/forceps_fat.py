# SPDX-License-Identifier: LGPL-2.1-or-later
"""The strip of fat of forceps_fat.scn in Python, for SOFA with SofaPython3, and forceps that a script drives by what they
feel: it closes them until they press by .15 N, lifts the fat by 15 mm, opens them, and prints the forces.

    runSofa -l SofaPython3,Hexaplast scenes/forceps_fat.py
"""
try:
    import Sofa
    Controller = Sofa.Core.Controller
except ImportError:  # the scene can be made without SOFA, to look at
    Controller = object

MODULES = ("AnimationLoop", "Constraint.Projective", "Engine.Select", "Mass", "ODESolver.Backward", "StateContainer",
           "Topology.Container.Grid", "Visual")

ALONG_X = [0, 0.70710678, 0, 0.70710678]  # turns the jaws, which are capsules along z
OPEN, LIFT = 0.012, 0.015  # [m] of a jaw from the middle; of both
SPEED = 0.0125  # [m/s] of a jaw that closes or opens
PRESSURE = 0.15  # [N] at which the forceps stop to close


class Forceps(Controller):
    """Moves the frames of two jaws: SOFA's step goes from position by velocity, as those of a haptic device would."""

    def __init__(self, frames, left, right, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.frames, self.left, self.right = frames, left, right
        self.half_gap, self.height, self.phase, self.steps = OPEN, 0.0, "close", 0
        self.pressures = []  # [N] after every step

    def onAnimateBeginEvent(self, event):
        dt = event["dt"]
        gap_speed = height_speed = 0.0
        if self.phase == "close":
            gap_speed = -SPEED
        elif self.phase == "lift":
            height_speed = LIFT / 0.7
        elif self.phase == "open":
            gap_speed = SPEED
        with self.frames.position.writeable() as x, self.frames.velocity.writeable() as v:
            for jaw, side in enumerate((1, -1)):
                x[jaw][:3] = [0, self.height, side * self.half_gap]
                v[jaw][:3] = [0, height_speed, side * gap_speed]
        self.half_gap += dt * gap_speed
        self.height += dt * height_speed

    def onAnimateEndEvent(self, event):
        self.steps += 1
        pressure = 0.5 * abs(self.left.force.value[2] - self.right.force.value[2])
        self.pressures.append(pressure)
        if self.phase == "close" and pressure >= PRESSURE:
            self.phase = "lift"
        elif self.phase == "lift" and self.height >= LIFT:
            self.phase = "open"
        elif self.phase == "open" and self.half_gap >= OPEN:
            self.phase = "done"
        if self.steps % 20 == 0:
            print(f"step {self.steps}: {self.phase}, jaws {2e3 * self.half_gap:.1f} mm apart and {1e3 * self.height:.1f} mm "
                  f"high, pressed by {pressure:.3f} N, {self.left.touching.value + self.right.touching.value} points touch")


def createScene(root):
    root.dt = 0.01
    root.gravity = [0, 0, 0]
    root.addObject("RequiredPlugin", pluginName="Hexaplast")
    for module in MODULES:
        root.addObject("RequiredPlugin", pluginName="Sofa.Component." + module)
    root.addObject("DefaultAnimationLoop")
    root.addObject("VisualStyle", displayFlags="showForceFields")
    jaws = root.addChild("jaws")
    frames = jaws.addObject("MechanicalObject", name="frames", template="Rigid3d",
                            position=[[0, 0, OPEN] + ALONG_X, [0, 0, -OPEN] + ALONG_X])

    strip = root.addChild("strip")
    strip.addObject("EulerImplicitSolver", rayleighMass=0.1, rayleighStiffness=0.02)
    strip.addObject("MultigridCGLinearSolver", tolerance=0.01)
    strip.addObject("RegularGridTopology", name="grid", n=[31, 6, 7], min=[-0.03, -0.005, -0.006],
                    max=[0.03, 0.005, 0.006])
    strip.addObject("MechanicalObject", name="nodes", template="Vec3d")
    strip.addObject("DiagonalMass", massDensity=920)
    strip.addObject("HexahedronElastoplasticFEMForceField", name="fat", template="Vec3d", youngModulus=[2000],
                    poissonRatio=[0.45], yieldStress=[160], plasticFlowRate=5, hardening=0.1)
    strip.addObject("BoxROI", name="ends",
                    box=[[-0.031, -0.01, -0.01, -0.029, 0.01, 0.01], [0.029, -0.01, -0.01, 0.031, 0.01, 0.01]])
    strip.addObject("FixedProjectiveConstraint", indices="@ends.indices")
    left, right = (strip.addObject("InstrumentContactForceField", name=name, shape="capsule", radius=0.003, length=0.01,
                                   friction=0.8, rigid="@/jaws/frames", rigidIndex=jaw)
                   for jaw, name in enumerate(("left", "right")))
    if Controller is not object:  # behind the strip, so that its steps have ended when the forceps feel
        root.addChild("hand").addObject(Forceps(frames, left, right, name="forceps"))
    return root
