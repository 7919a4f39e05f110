# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scene files, against what the command makes of them."""
import gc
import json
import pickle

import numpy as np
import pytest

import hexaplast

from bars import STRETCHED as BAR, carry_out, copies_before_running_on


def test_a_scene_has_the_bits_of_the_command(tmp_path):
    final = tmp_path / "final.json"
    carry_out(BAR, "--steps", 40, "--final", final, "--set", "bar/material.yieldStress=250")
    state = json.loads(final.read_text())

    scene = hexaplast.run(BAR, steps=40, overrides={"bar/material.yieldStress": 250})
    assert scene.state_hash() == state["state_hash"]
    assert scene.positions.tolist() == state["positions"]
    assert scene.velocities.tolist() == state["velocities"]
    assert scene.body.plastic_rest_positions.tolist() == state["plastic_rest_positions"]
    assert scene.body.fields(scene.positions).volume_ratio.tolist() == state["volume_ratio"]
    assert scene.time == pytest.approx(0.4) and scene.num_steps == 40 and scene.dt == 0.01
    assert scene.planned_steps == 500


def test_joints_open_in_a_run_and_close_with_reset():
    scene = hexaplast.Scene(BAR)
    scene.run(20)
    before, once = scene.positions, scene.state_hash()
    kept = before.copy()
    scene.open(scene.body, range(0, len(scene.body.joints), 2))
    assert scene.positions.shape[0] == scene.body.positions.shape[0] > kept.shape[0]
    assert (before == kept).all(), "an array that was taken before keeps what it showed"
    assert (scene.positions[: len(kept)] == kept).all()

    other = scene.copy()
    for one in (scene, other):
        one.run(5)
    assert scene.state_hash() == other.state_hash()
    assert (before == kept).all()
    with pytest.raises(ValueError, match="another scene's"):
        scene.open(other.body, [0])
    with pytest.raises(ValueError, match="joints"):
        scene.open(scene.body, [-1])
    scene.reset()
    assert scene.positions.shape == kept.shape
    scene.run(20)
    assert scene.state_hash() == once


def test_the_same_bar_from_arrays_moves_alike():
    scene = hexaplast.Scene(BAR)
    positions, hexahedra = hexaplast.grid((3, 3, 10), (-0.15, -0.15, -0.5), (0.15, 0.15, 0.5))
    material = hexaplast.Material(young_modulus=5000, poisson_ratio=0.45, yield_stress=300, flow_rate=4, hardening=0.2)
    settings = hexaplast.Settings(bending="blended", volumetric="sample", recovery="none", yield_norm="frobenius",
                                  rest_shape="joined", rotation_plasticity="none")
    body = hexaplast.Body(positions, hexahedra, material, settings)
    simulation = hexaplast.Simulation(body, rayleigh_mass=0.1, rayleigh_stiffness=0.1, solver="direct")
    simulation.fix(abs(positions[:, 2]) < 0.01)
    forces = np.zeros_like(positions)
    for k in range(1, 31):
        forces[[165, 166, 169, 170], 2] = 22.5 * k / 50
        forces[[5, 6, 9, 10], 2] = -22.5 * k / 50
        simulation.step(forces)
        scene.step()
    assert simulation.positions == pytest.approx(scene.positions, abs=1e-10)
    assert body.corner_plastic_strain.max() > 0
    assert body.corner_plastic_strain == pytest.approx(scene.body.corner_plastic_strain, abs=1e-10)


def test_overrides_are_numbers_texts_truths_and_lists():
    overrides = {
        "bar/material.yieldStress": np.float64(280.1234567890123),
        "bar/material.yieldNorm": "vonMises",
        "bar/EulerImplicitSolver1.firstOrder": False,
        "bar/pullUp.points": np.array([165, 166]),
        "bar/pullUp.forces": [[0, 0, 0], (0, 0, 2.5), [0, 0, 2.5], [0, 0, 0]],
        ".dt": 0.005,
    }
    as_text = {
        "bar/material.yieldStress": "280.1234567890123",
        "bar/material.yieldNorm": "vonMises",
        "bar/EulerImplicitSolver1.firstOrder": "false",
        "bar/pullUp.points": "165 166",
        "bar/pullUp.forces": "0 0 0  0 0 2.5  0 0 2.5  0 0 0",
        ".dt": "0.005",
    }
    assert hexaplast.run(BAR, 5, overrides).state_hash() == hexaplast.run(BAR, 5, as_text).state_hash()
    with pytest.raises(TypeError, match="None"):
        hexaplast.Scene(BAR, {"bar/material.yieldStress": None})


def test_what_the_command_refuses_is_refused_with_its_message(tmp_path):
    with pytest.raises(OSError, match="missing.scn"):
        hexaplast.Scene(tmp_path / "missing.scn")
    with pytest.raises(ValueError, match="bar/material.yieldStres"):
        hexaplast.Scene(BAR, {"bar/material.yieldStres": 250})

    wrong = tmp_path / "wrong.scn"
    wrong.write_text("<Node>\n  <RegularGridTopologie n='2 2 2'/>\n</Node>")
    with pytest.raises(ValueError, match="(?s)wrong.scn:2: error.*RegularGridTopology"):
        hexaplast.Scene(wrong)
    wrong.write_text("<Node>")
    with pytest.raises(ValueError, match="wrong.scn"):
        hexaplast.Scene(wrong)
    wrong.write_text("<Node/>")
    with pytest.raises(ValueError, match="no time integrator in the scene"):
        hexaplast.Scene(wrong)

    with pytest.raises(ImportError, match="Absent"):
        hexaplast.Scene(BAR, plugins=["Absent"], plugin_path=[tmp_path])
    with pytest.raises(ArithmeticError, match="step 2: the plastic history of hexahedron"):
        hexaplast.run(BAR, 5, {"bar/pullUp.forces": "0 0 0  0 0 1e308  0 0 1e308  0 0 0", "bar/pullUp.times": "0 0.02 1 2"})


def test_a_run_without_a_number_of_steps_takes_the_scene_s(tmp_path):
    scene = hexaplast.Scene(BAR, {"RunSettings1.steps": 3})
    scene.run()
    assert scene.num_steps == scene.planned_steps == 3
    scene.run()  # there already
    assert scene.num_steps == 3

    silent = tmp_path / "silent.scn"
    silent.write_text("\n".join(line for line in BAR.read_text().splitlines() if "<RunSettings" not in line))
    scene = hexaplast.Scene(silent)
    assert scene.planned_steps is None
    with pytest.raises(ValueError, match="number of steps"):
        scene.run()


def test_after_a_failed_step_only_reset_leads_on():
    overload = {"bar/pullUp.times": "0.015 0.025 1.9 2", "bar/pullUp.forces": "0 0 0  0 0 1e150  0 0 1e150  0 0 0"}
    scene = hexaplast.Scene(BAR, overload)
    scene.run(2)
    before = scene.state_hash(), scene.time, scene.positions.copy()
    with pytest.raises(ArithmeticError, match="step 3: "):
        scene.run(30)
    for call in scene.step, scene.run:
        assert scene.state_hash() == before[0] and scene.time == before[1] and scene.num_steps == 2
        assert (scene.positions == before[2]).all()
        with pytest.raises(ValueError, match=r"a step has failed.*reset"):
            call()
    scene.reset()
    scene.run(2)
    assert scene.state_hash() == before[0]


@pytest.mark.parametrize("steps", [0, -3])
def test_less_than_one_step_is_refused(steps):
    with pytest.raises(ValueError, match=f"steps = {steps} must be at least 1"):
        hexaplast.run(BAR, steps=steps)
    scene = hexaplast.Scene(BAR)
    with pytest.raises(ValueError, match=f"steps = {steps} must be at least 1"):
        scene.run(steps)
    assert scene.num_steps == 0


def test_remarks_of_a_run_that_fails_are_warnings(tmp_path):
    file = tmp_path / "warns.scn"
    file.write_text("""<Node dt="0.01" gravity="0 0 -9.81"><DefaultAnimationLoop/>
  <EulerImplicitSolver/><MultigridCGLinearSolver/>
  <AttributeChange component="@ball" attribute="active" keyTimes="0.02" values="1"/>
  <AttributeChange component="@body" attribute="plasticFlowRate" keyTimes="0.04" values="1000"/>
  <RegularGridTopology n="4 2 2" max="0.03 0.01 0.01"/><MechanicalObject/><DiagonalMass massDensity="1000"/>
  <HexahedronElastoplasticFEMForceField name="body" youngModulus="5000" yieldStress="1e9" plasticFlowRate="1"
      restShape="joined"/>
  <FixedProjectiveConstraint indices="0 4 8 12"/>
  <InstrumentContactForceField name="ball" active="0" radius="0.01" keyTimes="0" positions="0.03 0.005 0.012"/>
</Node>""")
    scene = hexaplast.Scene(file)
    with pytest.warns(UserWarning, match="becomes active"):
        with pytest.raises(ValueError, match="plasticFlowRate"):
            scene.run(40)


def test_remarks_of_a_scene_are_warnings():
    with pytest.warns(UserWarning, match="(?s)bar_stretch_high.scn:.*warning"):
        hexaplast.Scene(BAR, {"bar/material.plasticFlowRate": 20})  # times dt above what is advised


def test_a_scene_of_masses_alone_has_no_body(tmp_path):
    file = tmp_path / "mass.scn"
    file.write_text(
        "<Node dt='0.1' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>"
        "<MechanicalObject position='0 0 1'/><UniformMass totalMass='2'/></Node>"
    )
    scene = hexaplast.run(file, steps=1)
    assert scene.body is None and scene.elastic_energy == 0
    assert scene.positions[0] == pytest.approx([0, 0, 0.9])
    assert scene.kinetic_energy == pytest.approx(2 * 1.0**2 / 2)


def bar(name, begin, young_modulus):
    return (f"<Node name='{name}'><RegularGridTopology n='3 3 4' min='{begin} 0 0' max='{begin + 0.02} 0.02 0.03'/>"
            "<MechanicalObject name='nodes'/><UniformMass totalMass='0.1'/><FixedProjectiveConstraint indices='0-8'/>"
            f"<HexahedronElastoplasticFEMForceField name='body' youngModulus='{young_modulus}' yieldStress='200' "
            "plasticFlowRate='5'/><ConstantForceField indices='27-35' totalForce='0 0 .5'/></Node>")


def test_a_scene_of_several_bodies(tmp_path):
    file = tmp_path / "two.scn"
    file.write_text("<Node dt='0.01' gravity='0 -1 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='1'/>"
                    "<SparseLDLSolver/>" + bar("liver", 0, 3000) + bar("sac", 0.05, 9000) + "</Node>")
    final = tmp_path / "final.json"
    carry_out(file, "--steps", 20, "--final", final)
    state = json.loads(final.read_text())

    scene = hexaplast.Scene(file)
    liver, sac = scene.bodies
    views = scene.positions, scene.velocities, liver.positions, sac.velocities
    assert (views[0][36:] == sac.initial_positions).all()
    assert scene.run(20).flow.yielded == 24
    assert [body.name for body in scene.bodies] == ["liver", "sac"]
    assert scene.state_hash() == state["state_hash"]
    assert views[0].tolist() == state["positions"] and views[1].tolist() == state["velocities"]
    assert (views[2] == views[0][:36]).all() and (views[3] == views[1][36:]).all()
    assert np.concatenate([liver.plastic_rest_positions, sac.plastic_rest_positions]).tolist() == (
        state["plastic_rest_positions"])
    assert scene.elastic_energy == pytest.approx(liver.energy(liver.positions) + sac.energy(sac.positions))
    with pytest.raises(ValueError, match=r"the scene has 2 bodies \(liver, sac\): use bodies"):
        scene.body
    scene.reset()
    assert (views[0][36:] == sac.initial_positions).all() and (views[1] == 0).all()
    assert (sac.corner_plastic_strain == 0).all()

    keeps, expected = sac.positions, sac.positions.copy()
    del scene, liver, sac, views
    gc.collect()
    assert (keeps == expected).all()


def test_the_bodies_of_a_scene_are_listed_also_where_there_is_one():
    scene = hexaplast.Scene(BAR)
    assert [body.name for body in scene.bodies] == ["bar"]
    assert scene.bodies[0] is scene.body
    assert (scene.body.positions == scene.positions).all()


def test_meshes_are_found_in_the_given_directories(tmp_path):
    (tmp_path / "far" / "mesh").mkdir(parents=True)
    (tmp_path / "far" / "mesh" / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    scene = tmp_path / "a.scn"
    scene.write_text(BAR.read_text().replace("</Node>", '<MeshOBJLoader filename="mesh/m.obj"/></Node>', 1))
    with pytest.raises(Exception, match="no such file"):
        hexaplast.Scene(scene)
    assert hexaplast.Scene(scene, mesh_path=[tmp_path / "far"]).dt > 0


# A strip that flows where a ball presses into it and drags it along. {} is what changes on the way.
TOUCHED = """<Node dt="0.02" gravity="0 0 0">{}
  <DefaultAnimationLoop/><EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.02"/><MultigridCGLinearSolver/>
  <Node name="strip">
    <RegularGridTopology name="grid" n="7 3 3" max="0.06 0.02 0.02"/><MechanicalObject name="nodes"/>
    <DiagonalMass massDensity="1000"/>
    <HexahedronElastoplasticFEMForceField name="material" youngModulus="2000" poissonRatio="0.4" yieldStress="60"
        plasticFlowRate="2"/>
    <FixedProjectiveConstraint indices="0-56-7 6-62-7"/>
    <InstrumentContactForceField name="tip" shape="sphere" radius="0.006" friction="0.5" keyTimes="0 0.2 0.6"
        positions="0.03 0.01 0.028  0.03 0.01 0.02  0.035 0.01 0.02"/>
    <GraspForceField name="grip" radius="0.01" keyTimes="0" positions="0.03 0.01 0"/>
    <Probe name="push" value="@tip.force" component="z"/>
  </Node>
</Node>"""


@pytest.fixture
def touched(tmp_path):
    file = tmp_path / "touched.scn"
    file.write_text(TOUCHED.format(""))
    return file


def test_a_saved_scene_goes_on_with_the_same_bits(touched, monkeypatch):
    monkeypatch.chdir(touched.parent)
    scene = hexaplast.Scene(touched.name, {"strip/material.hardening": 0.2})
    assert scene.run(12).flow.yielded > 0, "the ball touches"
    saved, hash_then = scene.save(), scene.state_hash()
    copies, once = copies_before_running_on(scene)
    for made in copies:
        assert made.state_hash() == hash_then and made.num_steps == 12 and made.time == pytest.approx(0.24)
        made.run(10)
        assert made.state_hash() == once

    positions = scene.positions
    for damaged in (saved[:-1], saved[:60] + bytes([saved[60] ^ 1]) + saved[61:], b""):
        with pytest.raises(ValueError, match="the saved state is (damaged|no checkpoint)"):
            scene.load(damaged)
    with pytest.raises(ValueError, match="of another scene"):
        hexaplast.Scene(touched).load(saved)
    assert scene.state_hash() == once
    scene.load(saved)
    assert scene.state_hash() == hash_then and (positions == scene.positions).all(), "views follow"
    scene.run(10)
    assert scene.state_hash() == once


def test_a_checkpoint_of_a_run_is_loaded(touched):
    carry_out(touched, "--steps", 12, "--checkpoint", "every=12", "--frames", 0, "--out", touched.parent / "run")
    scene = hexaplast.Scene(touched)
    scene.load((touched.parent / "run" / "checkpoint_000000012.hxc").read_bytes())
    assert scene.num_steps == 12
    scene.run(10)
    assert scene.state_hash() == hexaplast.run(touched, 22).state_hash()


# before the sixth and the tenth step
CHANGES = {
    5: {"strip/material.yieldStress": 30,
        "strip/tip.positions": [[0.03, 0.01, 0.028], [0.03, 0.012, 0.02], [0.04, 0.01, 0.02]]},
    9: {"strip/tip.friction": np.float64(0.1), "strip/tip.keyTimes": np.array([0, 0.2, 0.4]),
        "strip/material.plasticFlowRate": None, "strip/grip.maxForce": 0.05},
}


def as_text(value):
    return " " if value is None else " ".join(repr(float(number)) for number in np.ravel(value))


def test_a_scene_that_is_driven_has_the_bits_of_one_that_changes_by_itself(touched):
    changes = "".join(
        f"<AttributeChange component='@{path.split('.')[0]}' attribute='{path.split('.')[1]}' keyTimes='{step * 0.02}' "
        f"values='{as_text(value)}'/>" for step, of_step in CHANGES.items() for path, value in of_step.items())
    itself = touched.parent / "itself.scn"
    itself.write_text(TOUCHED.format(changes))
    unchanged = hexaplast.run(touched, 16).state_hash()

    scene = hexaplast.Scene(touched)
    before = scene.get("strip/tip.positions")
    for round in range(2):
        for step in range(16):
            for path, value in CHANGES.get(step, {}).items():
                scene.set(path, value)
                assert np.all(scene.get(path) == (0 if value is None else value))
            if step == 10:
                saved = scene.save()
            scene.step()
        once = scene.state_hash()
        assert once == hexaplast.run(itself, 16).state_hash() != unchanged
        scene.reset()
        assert (scene.get("strip/tip.positions") == before).all() and scene.get("strip/material.yieldStress") == [60]
    scene.run(16)
    assert scene.state_hash() == unchanged

    other = hexaplast.Scene(touched)
    other.set("strip/material.youngModulus", 9000)
    for loaded in other, scene:  # changes come with the state, and others go
        loaded.load(saved)
        assert loaded.get("strip/material.youngModulus") == [2000] and loaded.get("strip/tip.friction") == 0.1
        loaded.run(6)
        assert loaded.state_hash() == once
        loaded.reset()
        loaded.run(16)
        assert loaded.state_hash() == unchanged
    waits = scene.copy()
    for one in scene, waits:
        one.set("strip/material.yieldStress", 20)
    pickled = pickle.loads(pickle.dumps(scene))  # with a change that has not had its effect
    for one in scene, waits, pickled:
        one.run(3)
    assert scene.state_hash() == waits.state_hash() == pickled.state_hash()


@pytest.mark.parametrize("path, value, message", [
    ("strap/tip.friction", 1, "set strap/tip.friction: error: .*'strap'.*\n.*strip"),
    ("strip/tip.frictions", 1, "has no attribute 'frictions'.*\n.*did you mean 'friction'"),
    ("strip/tip", 1, "must be PATH.attribute"),
    ("strip/tip.friction", -1, "InstrumentContactForceField.friction: -1"),
    ("strip/tip.friction", "much", "'much' is not a number"),
    ("strip/tip.positions", [1, 2], "2 numbers given, must be groups of 3"),
    ("strip/tip.force", [1, 2, 3], "has no attribute 'force' that may change"),
    ("strip/material.precision", "mixed", "has no attribute 'precision' that may change"),
    ("strip/grid.max", [1, 1, 1], "RegularGridTopology 'grid' reads its attributes once, when the scene begins"),
    ("strip/nodes.position", [0, 0, 0], "MechanicalObject 'nodes' reads its attributes once"),
    (".dt", 0.1, "reads its attributes once"),
])
def test_what_cannot_change_is_refused_before_anything_happens(touched, path, value, message):
    scene = hexaplast.Scene(touched)
    with pytest.raises(ValueError, match=message):
        scene.set(path, value)
    assert scene.run(2).steps == 2


def test_what_a_component_refuses_in_a_step_is_taken_back(touched):
    scene = hexaplast.run(touched, 3)
    saved, hash_then = scene.save(), scene.state_hash()
    for lead_on in scene.reset, lambda: scene.load(saved):
        scene.set("strip/tip.keyTimes", [0, 0.5])  # of three positions
        with pytest.raises(ValueError, match="3 positions given for 2 times"):
            scene.step()
        with pytest.raises(ValueError, match="a step has failed"):
            scene.save()
        lead_on()
        assert scene.get("strip/tip.keyTimes").tolist() == [0, 0.2, 0.6]
    assert scene.state_hash() == hash_then
    scene.run(3)
    assert scene.state_hash() == hexaplast.run(touched, 6).state_hash()


def test_what_a_scene_shows_is_read(touched):
    scene = hexaplast.run(touched, 12)
    assert list(scene.probes) == ["push"] and scene.probes["push"] == scene.force("strip/tip")[2] > 0
    assert scene.get("strip/nodes.position").shape == (63, 3)
    assert (scene.get("strip/nodes.position") == scene.positions).all()
    assert scene.get("strip/tip.shape") == "sphere" and scene.get("strip/tip.active") is True
    assert scene.get(".dt") == 0.02 and scene.get("strip/grid.n").tolist() == [7, 3, 3]
    assert scene.get("strip/tip.length") is None and scene.get("strip/push.value") is not None
    assert scene.get("strip/material.plasticStrain").shape == (24,)
    with pytest.raises(ValueError, match="has no attribute 'force'"):
        scene.force("strip/material")
    with pytest.raises(ValueError, match="has no output 'force'"):
        scene.force("strip/nodes")
    with pytest.raises(ValueError, match="(?s)get strip/tip.forces.*did you mean 'force'"):
        scene.get("strip/tip.forces")
    with pytest.raises(TypeError, match="value: "):
        scene.set("strip/tip.friction", object())


def test_a_reaction_is_measured_from_when_it_is_asked_for(touched):
    scene, asked, probed = (hexaplast.Scene(touched) for _ in range(3))
    asked.get("strip/FixedProjectiveConstraint1.reaction")
    for one in (scene, asked):
        one.run(12)
    reaction = asked.get("strip/FixedProjectiveConstraint1.reaction")
    assert np.linalg.norm(reaction) > 0
    with pytest.raises(ValueError, match="is measured from the next step on"):
        scene.get("strip/FixedProjectiveConstraint1.reaction")
    before = scene.save()
    for state in (before, asked.save()):
        probed.load(state)
    assert (probed.get("strip/FixedProjectiveConstraint1.reaction") == reaction).all()
    for one in (scene, asked, probed, scene.copy()):
        one.step()
        hash_then = one.state_hash()
        assert hash_then == scene.state_hash()
    assert (scene.get("strip/FixedProjectiveConstraint1.reaction") ==
            probed.get("strip/FixedProjectiveConstraint1.reaction")).all()


def test_an_instrument_goes_where_its_pose_is_set(touched):
    alone = hexaplast.run(touched, 16)
    scene = hexaplast.Scene(touched)
    tip = scene.instrument("strip/tip")
    assert tip.pose.tolist() == [0.03, 0.01, 0.028, 0, 0, 0, 1]
    path = np.array([[0.03, 0.01, 0.028], [0.03, 0.01, 0.02], [0.035, 0.01, 0.02]])
    for step in range(1, 17):
        place = [np.interp(0.02 * step, [0, 0.2, 0.6], along) for along in path.T]
        tip.pose = place
        scene.step()
        assert tip.pose[:3].tolist() == place
    assert scene.positions == pytest.approx(alone.positions, abs=1e-12)
    assert tip.force == pytest.approx(alone.force("strip/tip"), rel=1e-6) and tip.force[2] > 0.001
    scene.step()
    assert tip.pose[:3].tolist() == place, "it stays"

    half = np.sqrt(0.5)
    motion = [[0, -1, 0, 0.03], [1, 0, 0, 0.01], [0, 0, 1, 0.021], [0, 0, 0, 1]]
    for pose in ([0.03, 0.01, 0.021, 0, 0, 2, 2], motion):
        tip.pose = [0.03, 0.01, 0.03, 0, 0, 0, 1]
        scene.step()
        tip.pose = pose
        scene.step()
        assert tip.pose == pytest.approx([0.03, 0.01, 0.021, 0, 0, half, half], abs=1e-15)
    for wrong in ([1, 2], np.eye(4) * 2, [0, 0, 0, 0, 0, 0, 0], [0, 0, np.nan]):
        with pytest.raises(ValueError, match="pose: "):
            tip.pose = wrong

    grip = scene.instrument("strip/grip")
    grip.pose = [0.03, 0.01, -0.002]
    scene.run(2)
    assert grip.force[2] < 0 and grip.pose.tolist() == [0.03, 0.01, -0.002, 0, 0, 0, 1]
    with pytest.raises(ValueError, match="GraspForceField has no orientation"):
        grip.pose = [0, 0, 0, 0, 0, 1, 1]
    with pytest.raises(ValueError, match="strip/nodes"):
        scene.instrument("strip/nodes")
    del scene
    gc.collect()
    assert tip.path == "strip/tip" and tip.pose.shape == (7,)


def test_a_scalpel_goes_where_its_pose_is_set(tmp_path):
    file = tmp_path / "cut.scn"
    file.write_text("""<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><Node name='strip'>
        <EulerImplicitSolver/><SparseLDLSolver/><RegularGridTopology n='5 2 3' max='.08 .02 .04'/><MechanicalObject/>
        <DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField/>
        <BladeController name='scalpel' points='0 -.1 0 0 .1 0' keyTimes='0' positions='.041 0 -.01'/></Node></Node>""")
    scene = hexaplast.Scene(file)
    scalpel = scene.instrument("strip/scalpel")
    across = [scene.body.joints.pairs.tolist().index(pair) for pair in ([1, 2], [5, 6])]
    for z, opened in ((0, []), (.02, across[:1]), (.02, across[:1]), (.05, across)):
        scalpel.pose = [.041, 0, z]
        scene.step()
        assert scene.body.opened == opened
    assert len(scene.positions) == 30 + 6
    with pytest.raises(ValueError, match="no attribute 'force'"):
        scalpel.force
