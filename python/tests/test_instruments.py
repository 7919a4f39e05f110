# SPDX-License-Identifier: LGPL-2.1-or-later
"""What touches and holds a body without a scene, against balances of hand, and against a scene."""
import pickle

import numpy as np
import pytest

import hexaplast

from bars import SCENES, copies_before_running_on


def block(cells=(4, 4, 2), fixed=True, material=None, **arguments):
    """0.2 x 0.2 x 0.1 m, 4 kg; held below; solved to rounding."""
    positions, hexahedra = hexaplast.grid(cells, (0, 0, 0), (0.2, 0.2, 0.1))
    body = hexaplast.Body(positions, hexahedra, material or hexaplast.Material(young_modulus=5000, poisson_ratio=0.3))
    simulation = hexaplast.Simulation(body, **{"solver": "direct", **arguments})
    if fixed:
        simulation.fix(positions[:, 2] == 0)
    return simulation


def momentum(simulation):
    return simulation.masses @ simulation.velocities


def test_in_equilibrium_supports_carry_what_presses_and_the_weight():
    simulation = block(reactions=True, gravity=(0, 0, -9.81), rayleigh_mass=20)
    assert (simulation.reactions == 0).all()
    ball = simulation.add_instrument("sphere", radius=0.05, pose=(0.08, 0.11, 0.16))
    ball.velocity = (0, 0, -0.1)
    simulation.run(40)  # 40 mm, 30 of them into the block as it was
    assert ball.pose == pytest.approx([0.08, 0.11, 0.12, 0, 0, 0, 1], abs=1e-12) and ball.num_touching > 0
    ball.velocity = (0, 0, 0)
    simulation.run(300)
    free = simulation.body.initial_positions[:, 2] > 0
    assert (simulation.reactions[free] == 0).all() and ball.force[2] > 0.5
    assert simulation.reactions.sum(axis=0) == pytest.approx(ball.force + [0, 0, 4 * 9.81], abs=1e-6)
    with pytest.raises(ValueError, match="reactions=True"):
        block().reactions


def test_what_an_instrument_takes_a_free_body_gains():
    simulation = block(fixed=False, rayleigh_stiffness=0.05)
    stick = simulation.add_instrument("capsule", radius=0.02, length=0.3, friction=0.4, damping=100,
                                      pose=(0.1, 0.1, 0.13, 0.70710678, 0, 0, 0.70710678))  # along y
    stick.velocity = (0.15, 0, -0.3)
    touched = 0
    for _ in range(30):
        before = momentum(simulation)
        simulation.step()
        assert (momentum(simulation) - before) / 0.01 == pytest.approx(-stick.force, abs=1e-8)
        touched += stick.num_touching > 0
    assert touched > 5 and momentum(simulation)[2] < 0 < momentum(simulation)[0]


def test_a_moved_instrument_computes_what_a_scene_with_its_path_does(tmp_path):
    file = tmp_path / "press.scn"
    file.write_text("""<Node dt="0.01" gravity="0 0 0"><DefaultAnimationLoop/>
<Node name="block"><EulerImplicitSolver rayleighMass="0.5" rayleighStiffness="0.02"/><SparseLDLSolver/>
<RegularGridTopology n="5 5 3" min="0 0 0" max="0.2 0.2 0.1"/><MechanicalObject/><DiagonalMass massDensity="1000"/>
<HexahedronElastoplasticFEMForceField youngModulus="5000" poissonRatio="0.3" yieldStress="300" plasticFlowRate="4"/>
<FixedProjectiveConstraint indices="0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24"/>
<InstrumentContactForceField name="tip" shape="box" size="0.06 0.04 0.05" friction="0.5" keyTimes="0 0.1 0.3"
 positions="0.1 0.1 0.13  0.1 0.1 0.11  0.13 0.1 0.11" orientations="0 0 0 1  0 0 0.1 0.99498744  0 0 0.1 0.99498744"/>
</Node></Node>""")
    scene = hexaplast.Scene(file)
    material = hexaplast.Material(young_modulus=5000, poisson_ratio=0.3, yield_stress=300, flow_rate=4)
    simulation = block(material=material, rayleigh_mass=0.5, rayleigh_stiffness=0.02)
    tip = simulation.add_instrument("box", size=(0.06, 0.04, 0.05), friction=0.5, pose=(0.1, 0.1, 0.13))
    path = scene.instrument("block/tip")
    for _ in range(30):
        scene.step()
        tip.pose = path.pose
        simulation.step()
    assert tip.force == pytest.approx(path.force, rel=1e-9) and tip.force[2] > 1 and abs(tip.force[0]) > 0.1
    assert simulation.body.corner_plastic_strain.max() > 0
    assert simulation.positions == pytest.approx(scene.positions, abs=1e-11)


def test_forceps_are_two_instruments_that_open_and_go_together():
    def pinched():
        simulation = block(rayleigh_stiffness=0.02)
        return simulation, [simulation.add_instrument("box", size=(1 / 32, 1 / 16, 1 / 16), friction=0.8,
                                                      pose=(x, 0.125, 0.125)) for x in (-1 / 16, 5 / 16)]

    by_hand, (left, right) = pinched()
    simulation, jaws = pinched()
    forceps = hexaplast.Forceps(*jaws, opening=11 / 32)  # between their faces
    assert forceps.opening == 11 / 32 and forceps.pose.tolist() == [0.125, 0.125, 0.125, 0, 0, 0, 1]
    for k in range(1, 31):
        gap, height = 11 / 32 - k / 128, 0.125 - k / 1024
        for jaw, x in ((left, 0.125 - (gap + 1 / 32) / 2), (right, 0.125 + (gap + 1 / 32) / 2)):
            jaw.pose = (x, 0.125, height)
        if k % 2:  # in either order
            forceps.pose, forceps.opening = (0.125, 0.125, height), gap
        else:
            forceps.opening, forceps.pose = gap, (0.125, 0.125, height)
        by_hand.step()
        simulation.step()
        assert forceps.opening == gap and forceps.pose[2] == height
    assert (simulation.positions == by_hand.positions).all() and (forceps.force == left.force + right.force).all()
    assert forceps.grip_force == (right.force[0] - left.force[0]) / 2 > 0.1
    for wrong, message in [((left, left), "both jaws are in one place"), ((left, jaws[0]), "of two simulations"),
                           ((*jaws, np.nan), "opening: nan, must be a finite number")]:
        with pytest.raises(ValueError, match=message):
            hexaplast.Forceps(*wrong)
    for name, value in [("opening", np.nan), ("opening", "wide"), ("opening", 10**400), ("pose", (0, 0, 0, 0, 0, 0, 0))]:
        with pytest.raises(ValueError, match=name):
            setattr(forceps, name, value)
    with pytest.raises(AttributeError):
        forceps.active = False


def test_forceps_know_nothing_of_what_was_taken_back():
    simulation = block(rayleigh_stiffness=0.02)
    scene = hexaplast.Scene(SCENES / "forceps_fat.scn")
    for moving, jaws in ((simulation, [simulation.add_instrument("box", size=(0.01, 0.02, 0.02), pose=(x, 0.1, 0.3))
                                       for x in (0.05, 0.15)]),
                         (scene, [scene.instrument(f"strip/{name}") for name in ("left", "right")])):
        forceps = hexaplast.Forceps(*jaws, opening=0.05)
        moving.step()
        saved = moving.save()
        for take_back in (lambda: moving.load(saved), moving.reset):
            forceps.pose = forceps.pose[:3] + [0, 0, 0.01]
            assert (jaws[0].target != jaws[0].pose).any()
            take_back()
            assert (jaws[0].target == jaws[0].pose).all()
            pose, opening = forceps.pose, forceps.opening
            forceps.opening -= 0.01
            moving.step()
            assert forceps.pose == pytest.approx(pose, abs=1e-15) and forceps.opening == pytest.approx(opening - 0.01)
    again = scene.instrument("strip/left")  # whoever asks knows of it, and so does a copy
    forceps.pose = forceps.pose[:3] + [0, 0, 0.01]
    copied = scene.copy()
    assert (again.target == jaws[0].target).all() and (copied.instrument("strip/left").target == jaws[0].target).all()
    hexaplast.Forceps(*(copied.instrument(jaw.path) for jaw in jaws), opening=forceps.opening).opening -= 0.001
    copied.step()
    assert copied.instrument("strip/left").pose[2] == pytest.approx(jaws[0].target[2], abs=2e-3)
    with pytest.raises(ValueError, match="must be an InstrumentContactForceField"):
        hexaplast.Forceps(jaws[0], hexaplast.Scene(SCENES / "fold.scn").instrument("sheet/forceps"))


def test_forceps_of_a_scene_turn_about_their_middle():
    scene = hexaplast.Scene(SCENES / "forceps_fat.scn")
    jaws = [scene.instrument(f"strip/{name}") for name in ("left", "right")]
    forceps = hexaplast.Forceps(*jaws, opening=0.018)
    half = np.sqrt(0.5)
    forceps.opening = 0.012
    forceps.pose = (0.001, 0.002, 0, 0, half, 0, half)  # as they are, along x
    scene.step()
    assert jaws[0].pose == pytest.approx([0.001, 0.002, 0.009, 0, half, 0, half])
    forceps.pose = (0, 0.002, 0, 0, 0, 0, 1)  # a quarter turn back about y takes z to -x
    scene.step()
    assert [jaw.pose[:3] for jaw in jaws] == [pytest.approx([-0.009, 0.002, 0]), pytest.approx([0.009, 0.002, 0])]
    assert forceps.opening == pytest.approx(0.012)


def test_a_grip_holds_lets_go_and_holds_again():
    simulation = block(fixed=False, gravity=(0, 0, -9.81), rayleigh_mass=5)
    top = np.flatnonzero(simulation.body.initial_positions[:, 2] == 0.1)
    grip = simulation.add_grip((0.1, 0.1, 0.1), nodes=top, stiffness=2000, damping=20)
    assert not grip.closed and len(grip.nodes) == 0
    grip.close()
    simulation.run(300)
    assert (grip.nodes == top).all() and grip.force == pytest.approx([0, 0, 4 * 9.81], abs=1e-3)
    held = simulation.positions[top, 2].mean()
    assert held == pytest.approx(0.1 - 4 * 9.81 / 2000, abs=1e-5)
    grip.velocity = (0.1, 0, 0)
    simulation.run(100)
    grip.position = grip.position
    simulation.run(300)
    assert grip.position == pytest.approx([0.2, 0.1, 0.1], abs=1e-12)
    assert simulation.positions[:, 0].mean() == pytest.approx(0.2, abs=1e-4)

    grip.open()
    before = momentum(simulation)
    simulation.step()
    fall = momentum(simulation) - before
    assert len(grip.nodes) == 0 and (grip.force == 0).all() and fall[2] == pytest.approx(-4 * 9.81 * 0.01, rel=0.06)
    simulation.run(9)
    grip.close()  # where they are now: lower
    simulation.run(400)
    assert grip.closed and simulation.positions[top, 2].mean() < held - 0.02
    assert grip.force == pytest.approx([0, 0, 4 * 9.81], abs=1e-3)


@pytest.mark.parametrize("rayleigh_stiffness", [0, 0.1])
def test_what_a_grip_exerts_a_free_body_gains(rayleigh_stiffness):
    simulation = block(fixed=False, rayleigh_stiffness=rayleigh_stiffness)
    grip = simulation.add_grip((0.19, 0.1, 0.1), radius=0.08, stiffness=500, damping=30)
    grip.velocity = (0.3, -0.1, 0.2)
    grip.close()
    for _ in range(20):
        before = momentum(simulation)
        simulation.step()
        assert (momentum(simulation) - before) / 0.01 == pytest.approx(grip.force, abs=1e-8)
    assert 0 < len(grip.nodes) < 15 and momentum(simulation)[0] > 0.5


def gripped(**arguments):
    simulation = block(material=hexaplast.Material(young_modulus=5000, poisson_ratio=0.3, yield_stress=150, flow_rate=4),
                       gravity=(0, 0, -1), **arguments)
    ball = simulation.add_instrument("sphere", radius=0.04, friction=0.3, pose=(0.06, 0.1, 0.139))
    grip = simulation.add_grip((0.2, 0.1, 0.1), radius=0.06, stiffness=800, max_force=10, damping=5)
    ball.velocity, grip.velocity = (0.05, 0, -0.1), (0, 0.02, 0.1)
    grip.close()
    return simulation


@pytest.mark.parametrize("solver", ["direct", "cg"])
def test_a_simulation_is_saved_copied_and_reset_with_the_same_bits(solver):
    simulation = gripped(solver=solver, tolerance=1e-8, reactions=True)
    body, ball, grip = simulation.body, simulation.instruments[0], simulation.grips[0]
    assert simulation.run(12).flow.yielded > 0
    at_12 = simulation.state_hash()
    body.remove([2])
    simulation.step()
    simulation.prescribe([49], simulation.positions[[49]] + [0, 0, 0.01])
    saved, time_then, reactions = simulation.save(), simulation.time, simulation.reactions.copy()
    copies, once = copies_before_running_on(simulation)
    forces = [ball.force, grip.force]
    assert ball.num_touching > 0 and len(grip.nodes) > 0 and np.abs(reactions).max() > 0.1
    for made in copies:
        assert made.body is not body and made.time == time_then and made.body.removed == [2]
        assert (made.reactions == reactions).all()
        made.run(10)
        assert made.state_hash() == once
        assert (made.instruments[0].force == forces[0]).all() and (made.grips[0].force == forces[1]).all()
    positions = simulation.positions
    for damaged in (saved[:-3], saved[:60] + bytes([saved[60] ^ 1]) + saved[61:],
                    saved[:-20] + bytes([saved[-20] ^ 1]) + saved[-19:], b""):
        with pytest.raises(ValueError):
            simulation.load(damaged)
    for other, message in ((block(solver=solver), "instruments and grips"), (gripped(cells=(4, 4, 3)), "another")):
        with pytest.raises(ValueError, match=message):
            other.load(saved)
    assert simulation.state_hash() == once and (grip.force == forces[1]).all()
    simulation.load(saved)
    assert simulation.time == time_then and (simulation.reactions == reactions).all()
    simulation.run(10)
    assert simulation.state_hash() == once and (positions == simulation.positions).all(), "views stay"
    both = pickle.loads(pickle.dumps([simulation, body]))
    assert both[0].body is both[1]

    ball.active = False
    simulation.release([49])
    simulation.reset()
    assert (simulation.positions == body.initial_positions).all() and body.removed == []
    assert ball.pose[:3] == pytest.approx([0.06, 0.1, 0.139], abs=0)
    assert not grip.closed and (ball.velocity == 0).all() and ball.active
    ball.velocity, grip.velocity = (0.05, 0, -0.1), (0, 0.02, 0.1)
    grip.close()
    simulation.run(12)
    assert simulation.state_hash() == at_12


@pytest.mark.parametrize("add, message", [
    (lambda s: None, "the state has 1 instruments and grips, the simulation 0"),
    (lambda s: s.add_grip((0.1, 0.1, 0.16), radius=0.04), r"the state has instruments\[0\] where the simulation has grips\[0\]"),
    (lambda s: s.add_instrument("sphere", radius=0.05, pose=(0.1, 0.1, 0.16)),
     r"instruments\[0\]: the state is of one with radius = 0.04, this one has radius = 0.05"),
    (lambda s: s.add_instrument("sphere", radius=0.04, pose=(0.1, 0, 0.16)),
     r"with position = \[0.1, 0.1, 0.16\], this one has position = \[0.1, 0, 0.16\]"),
    (lambda s: s.add_instrument("sphere", radius=0.04, pose=(0.1, 0.1, 0.16), friction=0.1), "friction = 0, .* friction = 0.1"),
])
def test_a_state_of_other_instruments_is_refused_and_changes_nothing(add, message):
    simulation, other = block(), block()
    simulation.add_instrument("sphere", radius=0.04, pose=(0.1, 0.1, 0.16))
    add(other)
    other.run(3)
    before = other.save()
    with pytest.raises(ValueError, match=message):
        other.load(simulation.save())
    assert other.save() == before and other.num_steps == 3


def test_what_is_in_use_is_not_looked_at_to_add_something():
    simulation, refused = block(), []

    class Adding:
        def __array__(self, *_, **__):  # asked for while the simulation is in use
            for add in (lambda: simulation.add_grip((0, 0, 0)), lambda: simulation.add_instrument("sphere")):
                with pytest.raises(RuntimeError, match="in use"):
                    add()
                refused.append(add)
            return np.zeros((1, 3))

    simulation.prescribe([0], Adding())
    assert len(refused) == 2


def lead(simulation, velocities):
    simulation.instruments[0].velocity, simulation.grips[0].velocity = velocities


def test_a_batch_moves_instruments_as_each_simulation_alone():
    velocities = np.random.default_rng(2).uniform(-0.1, 0.1, (6, 4, 2, 3))
    batch, alone = hexaplast.Batch(gripped() for _ in range(4)), [gripped() for _ in range(4)]
    hexaplast.set_num_threads(2)
    try:
        for of_step in velocities:
            batch.step(of_step, lead)
    finally:
        hexaplast.set_num_threads(1)
    for k, simulation in enumerate(alone):
        for of_step in velocities:
            lead(simulation, of_step[k])
            simulation.step()
        assert simulation.state_hash() == batch.simulations[k].state_hash()
        assert (simulation.grips[0].force == batch.simulations[k].grips[0].force).all()


def test_what_an_instrument_refuses_in_a_step_names_the_simulation_of_a_batch():
    batch = hexaplast.Batch(gripped() for _ in range(3))
    batch.simulations[1].add_instrument("sphere", radius=0.02, pose=(0, 0, 1), damping=1e9)
    with pytest.raises(ValueError, match=r"simulations\[1\]: damping: is 1e\+09, must be at most"):
        batch.step()
    assert [s.num_steps for s in batch.simulations] == [1, 0, 1]
    batch.simulations[1].instruments[1].active = False
    batch.step()


def test_a_surface_of_triangles_touches_as_the_box_that_it_is():
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * [0.03, 0.02, 0.025]
    triangles = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
                 (1, 3, 5), (3, 7, 5)]
    forces = []
    for shape in ({"shape": "box", "size": (0.06, 0.04, 0.05)}, {"shape": "surface", "surface": (corners, triangles)}):
        simulation = block()
        tip = simulation.add_instrument(pose=(0.103, 0.098, 0.126), **shape)
        tip.velocity = (0, 0, -0.1)
        simulation.run(10)
        forces.append(tip.force)
    assert forces[0] == pytest.approx(forces[1], rel=1e-4, abs=1e-4) and forces[0][2] > 0.1


def test_instruments_and_grips_that_cannot_be_are_refused():
    simulation = block()
    for make, error, message in [
        (lambda: simulation.add_instrument("sphere"), ValueError, "radius: is not given: a sphere has one"),
        (lambda: simulation.add_instrument("cone", radius=1), ValueError, "cone"),
        (lambda: simulation.add_instrument("sphere", radius=-1), ValueError, "radius"),
        (lambda: simulation.add_instrument("sphere", radius=0.1, friction=-1), ValueError, "friction"),
        (lambda: simulation.add_instrument("sphere", radius=0.1, pose=(0, 0)), ValueError, r"pose: shape \(2,\)"),
        (lambda: simulation.add_instrument("surface", surface=([[0, 0, 0]], [(0, 0, 0)])), ValueError, "surface_triangles"),
        (lambda: simulation.add_grip((0, 0, 0)), ValueError, "radius: is not given"),
        (lambda: simulation.add_grip((0, 0, 0), nodes=[75]), ValueError, r"nodes\[0\] = 75"),
        (lambda: simulation.add_grip((0, np.nan, 0), radius=1), ValueError, "position: must be finite"),
        (lambda: simulation.add_grip((0, 0, 0), radius=1, stiffness=-1), ValueError, "stiffness"),
        (lambda: hexaplast.Simulation(block().body.__class__(*hexaplast.grid((1, 1, 1), (0, 0, 0), (1, 1, 1))), solver="cg",
                                      preconditioner="none"), ValueError, "preconditioner = 'none' must be one of auto"),
    ]:
        with pytest.raises(error, match=message):
            make()
    assert simulation.instruments == simulation.grips == ()
    grip = simulation.add_grip((5, 5, 5), radius=0.1)
    grip.close()
    with pytest.warns(UserWarning, match="radius: the grip closes on nothing"):
        simulation.step()
    with pytest.raises(ValueError, match="velocity: must be finite"):
        grip.velocity = (0, 0, np.inf)


def test_a_copy_has_the_arguments_that_the_original_was_made_with():
    simulation = block()
    size, mask = np.full(3, 0.05), simulation.body.initial_positions[:, 2] > 0.09
    simulation.add_instrument("box", size=size, pose=(0.1, 0.1, 0.2))
    grip = simulation.add_grip(simulation.positions[-1], nodes=mask, stiffness=500)  # a view that follows the motion
    start = grip.position.copy()
    size[:], mask[:] = 0.01, False
    grip.velocity = (0, 0, 0.05)
    grip.close()
    simulation.run(5)
    copy = simulation.copy()
    copy.reset()
    assert (copy.grips[0].position == start).all()
    copy.grips[0].close()
    copy.step()
    assert len(copy.grips[0].nodes) == 25
    for wrong in ({"size": (1, 2)}, {"surface": 5}, {"radius": "a"}):
        with pytest.raises((TypeError, ValueError), match=next(iter(wrong))):
            simulation.add_instrument("box", **wrong)


def test_pictures_show_instruments():
    simulation = block()
    before = simulation.picture()
    simulation.add_instrument("sphere", radius=0.05, pose=(0.1, 0.1, 0.16))
    untouched = simulation.picture()
    assert (before != untouched).any()
    simulation.instruments[0].pose = (0.1, 0.1, 0.14)
    simulation.add_grip((0, 0, 0.1), radius=0.06).close()
    simulation.grips[0].velocity = (0, 0, 0.1)
    simulation.run(2)
    assert (simulation.picture() == simulation.copy().picture()).all()


def test_pictures_of_a_simulation_and_of_a_scene_have_views_and_scales():
    scene = hexaplast.Scene(SCENES / "forceps_fat.scn")
    camera = ((0.03, 0.05, 0.11), (0, 0.007, 0), 19)
    for moving in (block(), scene):
        seen = [moving.picture(320, 180, **how) for how in ({}, {"view": "top"}, {"view": (1, 1, 0)}, {"camera": camera},
                                                           {"field": "speed"}, {"range": (0, 7)})]
        assert all(picture.shape == (180, 320, 3) for picture in seen)
        assert len({picture.tobytes() for picture in seen}) == 6
        assert (moving.picture(320, 180, camera=camera) == seen[3]).all()
        for how in ({"view": "above"}, {"view": (0, 0, 0)}, {"camera": (1, 2)}, {"camera": (camera[0], camera[0], 19)},
                    {"field": "colour"}, {"range": (1, 1)}, {"range": (0, np.inf)},
                    {"range": (-1e308, 1e308)}, {"view": (1e-320, 0, 0)}, {"field": "region"}, {"width": 1}):
            with pytest.raises((ValueError, TypeError), match=next(iter(how))):
                moving.picture(**how)
    scene.run(40)  # the jaws have moved: not the clock alone is another
    assert (scene.picture(320, 180, camera=camera)[40:140] != seen[3][40:140]).any()


def test_a_grip_that_is_added_after_a_cut_holds_all_copies_of_its_nodes():
    simulation = block((4, 2, 2), gravity=(0, 0, -1))
    simulation.open([j for j, (a, b) in enumerate(simulation.body.joints.pairs) if a % 4 == 1 and b % 4 == 2])
    initial = np.asarray(simulation.body.initial_nodes)
    copies = np.flatnonzero(np.bincount(initial)[initial] > 1)
    assert len(copies) == 18
    for nodes in ([copies[-1]], np.arange(len(initial)) == copies[-1], [initial[copies[-1]]]):
        grip = simulation.add_grip(simulation.positions[copies[-1]], nodes=nodes)
        grip.close()
        simulation.step()
        assert sorted(initial[list(grip.nodes)]) == [initial[copies[-1]]] * 2, "both copies"
    with pytest.raises(ValueError, match="nodes"):
        simulation.add_grip((0, 0, 0), nodes=[len(initial)])
    copy = simulation.copy()
    copy.run(3)
    simulation.run(3)
    assert copy.state_hash() == simulation.state_hash()
