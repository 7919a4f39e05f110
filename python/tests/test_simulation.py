# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bodies in motion, against hand values."""
import concurrent.futures
import gc
import pickle
import threading
import time
import warnings

import numpy as np
import pytest

import hexaplast

from bars import STRETCHED


def bar(cells=(1, 1, 4), settings=hexaplast.Settings(), **material):
    """0.1 x 0.1 x 0.4 m along z."""
    positions, hexahedra = hexaplast.grid(cells, (0, 0, 0), (0.1, 0.1, 0.4))
    return hexaplast.Body(positions, hexahedra, hexaplast.Material(**material), settings)


def test_sizes_that_no_tissue_has_and_empty_selections_are_warned_of():
    positions, hexahedra = hexaplast.grid((1, 1, 1), (0, 0, 0), (60, 40, 30))  # millimetres
    body = hexaplast.Body(positions, hexahedra)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning, match="60 m long"):
            hexaplast.Simulation(body)
    with pytest.warns(UserWarning, match="60 m long"):
        simulation = hexaplast.Simulation(body)  # it has not been taken
    with pytest.warns(UserWarning, match="fix: no node"):
        simulation.fix(positions[:, 2] > 60)


def test_free_fall_is_that_of_implicit_euler():
    simulation = hexaplast.Simulation(bar(), density=700, dt=0.02, gravity=(0, 0, -10), solver="direct")
    simulation.run(10)
    fall = -10 * 0.02**2 * 55  # 1 + 2 + ... + 10
    assert simulation.positions[:, 2] == pytest.approx(simulation.body.initial_positions[:, 2] + fall, abs=1e-12)
    assert simulation.velocities[:, 2] == pytest.approx(np.full(20, -2.0), abs=1e-10)
    assert simulation.num_steps == 10 and simulation.time == pytest.approx(0.2) and simulation.dt == 0.02
    mass = 700 * 0.1 * 0.1 * 0.4
    assert simulation.masses.sum() == pytest.approx(mass, rel=1e-12)
    assert simulation.kinetic_energy == pytest.approx(mass * 2.0**2 / 2, rel=1e-9)
    assert simulation.elastic_energy == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("solver", ["direct", "cg"])
def test_a_bar_at_rest_under_a_pull_has_the_length_of_hand(solver):
    # without lateral contraction the axial stress is E (s - 1), also at large stretch: s = 1 + F / (E A)
    body = bar(young_modulus=5000, poisson_ratio=0)
    simulation = hexaplast.Simulation(body, rayleigh_mass=5, rayleigh_stiffness=0.1, solver=solver, tolerance=1e-10)
    z = body.initial_positions[:, 2]
    simulation.fix(z == 0)
    forces = np.zeros((20, 3))
    forces[z == 0.4, 2] = 10 / 4
    report = simulation.run(400, forces)
    assert report.converged and report.iterations >= 1
    assert report.preconditioner == {"direct": "factorisation", "cg": "diagonal"}[solver]
    stretch = 1 + 10 / (5000 * 0.1 * 0.1)
    assert simulation.positions[:, 2] == pytest.approx(z * stretch, abs=1e-7)
    # the elastic energy is half the work of a force that grows slowly
    assert simulation.elastic_energy == pytest.approx(10 * 0.4 * (stretch - 1) / 2, rel=1e-5)

    simulation.run(400)  # forces hold for the steps they are given to
    assert simulation.positions[:, 2] == pytest.approx(z, abs=1e-6)


def test_led_nodes_arrive_and_then_stand_still():
    body = bar(young_modulus=5000, poisson_ratio=0.3)
    simulation = hexaplast.Simulation(body, rayleigh_stiffness=0.05)
    z = body.initial_positions[:, 2]
    top = z == 0.4
    simulation.fix(z == 0)
    for k in range(1, 6):
        places = body.initial_positions[top] + [0, 0.002 * k, 0.004 * k]
        simulation.prescribe(top, places)
        simulation.step()
        assert simulation.positions[top] == pytest.approx(places, abs=1e-14)
    simulation.run(5)
    assert simulation.positions[top] == pytest.approx(places, abs=1e-14)
    simulation.release(top)
    simulation.run(5)
    assert (simulation.positions[top, 2] < places[:, 2]).all()


def test_runs_without_forces_go_on_where_nodes_split():
    made = []
    for _ in range(2):
        positions, hexahedra = hexaplast.grid((2, 2, 4), (0, 0, 0), (0.02, 0.02, 0.04))
        material = hexaplast.Material(young_modulus=5000, yield_stress=200, flow_rate=30, hardening=1, fracture_stress=240)
        body = hexaplast.Body(positions, hexahedra, material, hexaplast.Settings(fracture="face"))
        made.append(hexaplast.Simulation(body, gravity=(0, 0, -200)))
        made[-1].fix(positions[:, 2] == 0.04)
    made[0].run(25)
    for _ in range(25):
        made[1].step()
    assert made[0].body.num_nodes > 45
    assert (made[0].positions == made[1].positions).all()


def test_set_state_replaces_positions_and_velocities():
    simulation = hexaplast.Simulation(bar(), gravity=(0, 0, 0))
    x = simulation.body.initial_positions + [1, 2, 3]
    simulation.set_state(x, np.tile([0.5, 0, 0], (20, 1)))
    simulation.step()
    assert simulation.positions == pytest.approx(x + [0.005, 0, 0], abs=1e-12)
    with pytest.raises(ValueError, match="finite"):
        simulation.set_state(x * np.inf, x)


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"density": -1}, "density = -1"),
        ({"solver": "magic"}, "solver = 'magic' must be one of cg, direct"),
        ({"solver": "cg", "tolerance": 0}, "tolerance = 0"),
        ({"solver": "cg", "iterations": 0}, "iterations = 0"),
    ],
)
def test_settings_out_of_range_are_refused(arguments, message):
    with pytest.raises(ValueError) as caught:
        hexaplast.Simulation(bar(), **arguments)
    assert message in str(caught.value)


def test_wrong_arguments_are_refused():
    with pytest.raises(TypeError):
        hexaplast.Simulation(None)
    body = bar()
    simulation = hexaplast.Simulation(body)
    assert simulation.body is body
    with pytest.raises(ValueError, match="in a simulation already"):
        hexaplast.Simulation(body)
    with pytest.raises(ValueError, match="steps = 0"):
        simulation.run(0)
    with pytest.raises(ValueError):
        hexaplast.set_num_threads(0)
    with pytest.raises(ValueError, match=r"forces: shape \(19, 3\), must be \(20, 3\)"):
        simulation.step(np.zeros((19, 3)))


def test_steps_let_other_threads_run_and_refuse_a_second_caller():
    simulation = hexaplast.Simulation(bar(cells=(6, 6, 18)))
    simulation.fix(simulation.body.initial_positions[:, 2] == 0)
    refused = 0
    thread = threading.Thread(target=simulation.step)
    thread.start()
    while thread.is_alive():
        # reached within the step, because the step does not keep Python's lock
        try:
            simulation.kinetic_energy
        except RuntimeError as error:
            assert "another thread" in str(error)
            refused += 1
        time.sleep(0.0005)
    thread.join()
    assert refused > 0
    assert simulation.num_steps == 1


@pytest.mark.parametrize("threads", [1, 2])
def test_many_simulations_stepped_by_an_executor_have_the_bits_that_they_have_alone(threads):
    """One of them diverges: it alone raises, and stays as it was before the step."""

    def simulations():
        for k in range(9):
            made = hexaplast.Simulation(bar(cells=(2, 2, 6), young_modulus=4000 + 100 * k, yield_stress=20, flow_rate=4),
                                        gravity=(0, 0, 9))
            made.fix(made.body.initial_positions[:, 2] == 0)
            yield made

    def run(of, steps, force=0.0):
        of.run(steps, np.full((63, 3), force))
        return of.state_hash()

    alone = [run(one, 12) for one in simulations()]
    before = hexaplast.num_threads()
    hexaplast.set_num_threads(threads)
    try:
        with concurrent.futures.ThreadPoolExecutor(3) as executor:
            many = list(simulations())
            half = list(executor.map(run, many, [6] * 9))
            failing = executor.submit(run, many[4], 1, 1e200)
            others = [executor.submit(run, one, 6) for k, one in enumerate(many) if k != 4]
            with pytest.raises(ArithmeticError, match="not finite"):
                failing.result()
            assert many[4].state_hash() == half[4] and many[4].num_steps == 6
            assert [future.result() for future in others] == alone[:4] + alone[5:]
            assert run(many[4], 6) == alone[4]
    finally:
        hexaplast.set_num_threads(before)


def test_scenes_stepped_by_an_executor_have_the_bits_that_they_have_alone():
    def run(stress):
        made = hexaplast.Scene(STRETCHED, overrides={"bar/material.yieldStress": stress})
        made.run(8)
        return made.state_hash()

    stresses = [100, 200, 300, 400]
    alone = [run(stress) for stress in stresses]
    with concurrent.futures.ThreadPoolExecutor(3) as executor:
        assert list(executor.map(run, stresses)) == alone
    assert len(set(alone)) == 4


def test_a_state_that_does_not_fit_tells_what_differs():
    saved = hexaplast.Simulation(bar((1, 1, 2)), dt=0.01, gravity=(0, 0, -9.81)).save()
    for given, told in (
        ({"dt": 0.02, "gravity": (0, 0, -9.81)}, "dt: 0.01, must be 0.02"),
        ({"dt": 0.01}, r"gravity\[2\]: -9.81, must be 0"),
    ):
        with pytest.raises(ValueError, match="the saved motion has another " + told):
            hexaplast.Simulation(bar((1, 1, 2)), **given).load(saved)
    for counts in (1, 1, 1), (1, 1, 9):
        with pytest.raises(ValueError, match="another mesh"):
            hexaplast.Simulation(bar(counts), dt=0.01, gravity=(0, 0, -9.81)).load(saved)


def test_a_bar_that_is_cut_through_falls_apart_and_goes_on_from_what_was_saved():
    simulation = hexaplast.Simulation(bar((2, 2, 8), young_modulus=5000), gravity=(0, 0, -9.81), reactions=True)
    body = simulation.body
    simulation.fix(body.initial_positions[:, 2] == 0.4)
    simulation.run(2)
    positions, velocities = simulation.positions, simulation.velocities
    before = positions.copy()
    centres = body.initial_positions[body.hexahedra].mean(axis=1)[:, 2]
    pairs = body.joints.pairs
    cut = np.flatnonzero((centres[pairs[:, 0]] < 0.2) != (centres[pairs[:, 1]] < 0.2))
    with pytest.raises(ValueError, match="in a simulation"):
        body.open(cut)
    with pytest.raises(ValueError, match=f"joints.*{len(body.joints)}"):
        simulation.open([len(body.joints)])
    parents = simulation.open(cut)
    assert len(cut) == 4 and body.opened == list(cut) and len(parents) == 9
    assert (simulation.positions[81:] == before[parents]).all() and (body.initial_nodes[81:] == parents).all()
    assert simulation.masses.sum() == pytest.approx(1000 * 0.1 * 0.1 * 0.4, rel=1e-12)
    assert simulation.kinetic_energy > 0 and len(simulation.reactions) == 90
    saved, copy = simulation.save(), pickle.loads(pickle.dumps(simulation))
    simulation.run(20)
    lower = body.initial_positions[:, 2] < 0.2
    assert (simulation.positions[lower, 2] < body.initial_positions[lower, 2] - 0.1).all(), "it falls"
    assert (positions == before).all() and velocities.shape == (81, 3), "earlier arrays keep their nodes"
    with pytest.raises(ValueError, match="open joints"):
        body.reset()
    again = hexaplast.Simulation(bar((2, 2, 8), young_modulus=5000), gravity=(0, 0, -9.81), reactions=True)
    again.load(saved)
    for other in (copy, again):
        other.run(20)
        assert other.state_hash() == simulation.state_hash()
    with pytest.raises(ValueError, match="other open joints"):
        body.load(bar((2, 2, 8), young_modulus=5000).save())
    with pytest.raises(ValueError, match="other open joints"):  # of as many nodes
        other = bar((2, 2, 8), young_modulus=5000)
        other.open(np.flatnonzero((centres[pairs[:, 0]] < 0.3) != (centres[pairs[:, 1]] < 0.3)))
        body.load(other.save())
    held = simulation.velocities
    simulation.fix(np.arange(90))
    assert (held == 0).all() and simulation.kinetic_energy == 0
    batch = hexaplast.Batch([simulation, copy])
    with pytest.raises(ValueError, match="forces: of 90 nodes"):
        batch.step([None, None], act=lambda s, _: simulation.reset() if s is copy else None)
    assert len(batch.simulations) == 2
    simulation.step(np.zeros((81, 3)))
    simulation.reset()
    assert len(simulation.positions) == 81 and (simulation.positions == body.initial_positions).all()
    assert body.opened == [] and simulation.picture(64, 64).shape == (64, 64, 3)


def test_forces_that_are_no_numbers_are_refused_on_held_nodes_too():
    simulation = hexaplast.Simulation(bar(), reactions=True)
    simulation.fix([0])
    for bad in (np.nan, np.inf):
        forces = np.zeros((len(simulation.positions), 3))
        forces[0, 1] = bad
        with pytest.raises(ArithmeticError, match="forces are not finite"):
            simulation.step(forces)


def test_a_simulation_that_relaxes_tells_its_energy_at_once():
    settings = hexaplast.Settings(relaxation=[0.5, 0.1])
    simulation = hexaplast.Simulation(bar(settings=settings))
    assert simulation.elastic_energy == pytest.approx(0, abs=1e-12)
    simulation.set_state(1.1 * simulation.positions, simulation.velocities)
    for other in (simulation, pickle.loads(pickle.dumps(simulation)), simulation.copy()):
        assert other.elastic_energy == simulation.elastic_energy > 0
        assert other.body.energy(other.positions) == simulation.elastic_energy
    body = pickle.loads(pickle.dumps(simulation.body))
    assert body.energy(simulation.positions) == simulation.elastic_energy


def test_copies_are_on_the_device_of_the_original():
    simulation = hexaplast.Simulation(bar(settings=hexaplast.Settings(precision="mixed")), gravity=(0, 0, -1))
    simulation.body.device = "emulation"
    for other in (simulation.copy(), pickle.loads(pickle.dumps(simulation))):
        assert other.body.device == "emulation"
        other.run(2)
    simulation.run(2)
    assert other.state_hash() == simulation.state_hash()


def test_a_body_is_free_when_its_simulation_has_gone():
    body = bar()
    simulation = hexaplast.Simulation(body)
    simulation.step()
    with pytest.raises(ValueError, match="in a simulation already"):
        hexaplast.Simulation(body)
    del simulation
    gc.collect()
    body.open([0])
    assert hexaplast.Simulation(body).step().converged
