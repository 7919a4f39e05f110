# SPDX-License-Identifier: LGPL-2.1-or-later
"""Simulations that are stepped together, against the same ones stepped alone."""
import gc
import multiprocessing
import pickle
import signal
import threading
import warnings

import numpy as np
import pytest

import hexaplast


def bars(count, cells=(2, 2, 4), **arguments):
    """Of 0.1 x 0.1 x 0.4 m along z, each of another stiffness, held at z = 0; they flow."""
    made = []
    for k in range(count):
        positions, hexahedra = hexaplast.grid(cells, (0, 0, 0), (0.1, 0.1, 0.4))
        material = hexaplast.Material(young_modulus=4000 + 100 * k, yield_stress=20, flow_rate=4)
        simulation = hexaplast.Simulation(hexaplast.Body(positions, hexahedra, material), gravity=(0, 0, 9), **arguments)
        simulation.fix(positions[:, 2] == 0)
        made.append(simulation)
    return made


def pull(simulation, velocity):
    """Moves the end at z = 0.4 m with a velocity [m/s]."""
    end = simulation.body.initial_positions[:, 2] == 0.4
    simulation.prescribe(end, simulation.positions[end] + simulation.dt * velocity)


VELOCITIES = np.random.default_rng(3).uniform(-0.2, 0.2, (5, 8, 3))  # of 5 steps and 8 simulations


@pytest.fixture
def threads():
    before = hexaplast.num_threads()
    yield hexaplast.set_num_threads
    hexaplast.set_num_threads(before)


@pytest.mark.parametrize("num_threads", [1, 2, 5])
@pytest.mark.parametrize("solver", ["direct", "cg"])
def test_a_batch_has_the_bits_of_one_simulation_after_the_other(threads, num_threads, solver):
    alone = bars(8, solver=solver)
    for velocities in VELOCITIES:
        for simulation, velocity in zip(alone, velocities):
            pull(simulation, velocity)
            report = simulation.step()
    assert report.flow.yielded > 0
    threads(num_threads)
    batch = hexaplast.Batch(bars(8, solver=solver))
    for velocities in VELOCITIES:
        reports = batch.step(velocities, pull)
    assert [s.state_hash() for s in batch.simulations] == [s.state_hash() for s in alone]
    assert len(batch) == len(reports) == 8 and reports[-1].flow.yielded == report.flow.yielded
    assert (batch.positions == [s.positions for s in alone]).all()
    assert (batch.velocities == [s.velocities for s in alone]).all()


def test_actions_are_forces_where_nothing_else_is_made_of_them():
    forces = np.random.default_rng(4).normal(0, 0.01, (3, 45, 3))
    batch, by_act, alone = hexaplast.Batch(bars(3)), hexaplast.Batch(bars(3)), bars(3)
    batch.step(forces)
    by_act.step([1, 2, 3], lambda simulation, k: forces[k - 1])
    for simulation, force in zip(alone, forces):
        simulation.step(force)
    batch.step()
    by_act.step([None, forces[1] * 0, None])
    for simulation, one, other in zip(alone, batch.simulations, by_act.simulations):
        simulation.step()
        assert simulation.state_hash() == one.state_hash() == other.state_hash()


def test_views_are_one_array_that_follows_and_outlives_the_batch():
    simulations = bars(3)
    batch = hexaplast.Batch(s for s in simulations)
    positions, velocities = batch.positions, batch.velocities
    assert positions.shape == velocities.shape == (3, 45, 3) and not positions.flags.writeable
    batch.step()
    assert np.shares_memory(positions, batch.positions), "the same memory, brought up to date"
    assert (positions[2] == simulations[2].positions).all()
    simulations[1].reset()  # by itself
    assert (batch.positions[1] == simulations[1].body.initial_positions).all() and (positions == batch.positions).all()
    last = positions.copy()
    del batch, simulations
    gc.collect()
    bars(20)  # others in its memory, if it were free
    assert (positions == last).all()


def test_simulations_of_unlike_meshes_step_together_but_have_no_common_array():
    unlike, alone = bars(2) + bars(1, cells=(1, 1, 3)), bars(2) + bars(1, cells=(1, 1, 3))
    batch = hexaplast.Batch(unlike)
    batch.step()
    for simulation, other in zip(unlike, alone):
        other.step()
        assert simulation.state_hash() == other.state_hash()
    with pytest.raises(ValueError, match=r"simulations\[0\] has 45 nodes, simulations\[2\] has 16"):
        batch.positions


@pytest.mark.parametrize("num_threads", [1, 2])
def test_what_fails_is_named_and_as_before_while_the_others_make_their_step(threads, num_threads):
    threads(num_threads)
    batch, alone = hexaplast.Batch(bars(8)), bars(8)
    forces = np.zeros((8, 45, 3))
    forces[[2, 5], 17, 1] = np.nan, 1e160  # before the solve, and in the flow
    before = [s.state_hash() for s in batch.simulations]
    with pytest.raises(ArithmeticError, match=r"simulations\[2\]: .*not finite.*\(and 1 others fail: 5\)"):
        batch.step(forces)
    for k, (simulation, other) in enumerate(zip(batch.simulations, alone)):
        other.step()
        fails = k in (2, 5)
        assert simulation.num_steps == (0 if fails else 1)
        assert simulation.state_hash() == (before[k] if fails else other.state_hash())
    batch.simulations[2].reset()
    assert np.isfinite(batch.positions).all()
    batch.step()


def test_a_warning_that_is_an_exception_does_not_hide_the_others():
    batch = hexaplast.Batch(bars(3))
    for k, simulation in enumerate(batch.simulations):
        simulation.add_grip((5 + k, 0, 0), radius=0.1).close()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        warnings.filterwarnings("error", message=r".*\(5, 0, 0\)")
        with pytest.raises(UserWarning, match="closes on nothing"):
            batch.step()
    assert ["(6, 0, 0)" in str(said[0].message), "(7, 0, 0)" in str(said[1].message), len(said)] == [True, True, 2]
    assert [s.num_steps for s in batch.simulations] == [1, 1, 1]


def test_actions_that_cannot_be_carried_out_step_nothing():
    batch = hexaplast.Batch(bars(3))
    before = [s.state_hash() for s in batch.simulations]

    def stumble(simulation, action):
        if action == 2:
            raise KeyError("mine")

    for call, error, message in [
        (lambda: batch.step(np.zeros((2, 45, 3))), ValueError, "actions: 2 are given, must be 3"),
        (lambda: batch.step(np.zeros((3, 44, 3))), ValueError, r"actions\[0\]: shape \(44, 3\), must be \(45, 3\)"),
        (lambda: batch.step([None, "x", None]), TypeError, r"actions\[1\]"),
        (lambda: batch.step([1, 2, 3], stumble), KeyError, "mine"),
        (lambda: batch.step([1, 2, 3], lambda s, a: np.zeros(a)), ValueError, r"forces by act\[0\]: shape \(1,\)"),
        (lambda: batch.step(3), TypeError, "iterable"),
    ]:
        with pytest.raises(error, match=message):
            call()
    assert [s.state_hash() for s in batch.simulations] == before


def test_what_is_no_batch_is_refused():
    one, two = bars(2)
    for simulations, error, message in [
        ([], ValueError, "at least one"),
        ([one, two, one], ValueError, r"simulations\[2\] is simulations\[0\]"),
        ([one, one.body], TypeError, r"simulations\[1\]: a .*Body is no Simulation"),
        (one, TypeError, "Iterable"),
    ]:
        with pytest.raises(error, match=message):
            hexaplast.Batch(simulations)


def test_one_and_the_same_simulation_goes_on_in_two_batches_and_alone():
    batch, alone = hexaplast.Batch(bars(2)), bars(2)
    other = hexaplast.Batch(batch.simulations[1:])
    batch.step()
    other.step()
    batch.simulations[1].step()
    alone[0].step()
    alone[1].run(3)
    assert [s.state_hash() for s in batch.simulations] == [s.state_hash() for s in alone]
    assert (other.positions[0] == batch.positions[1]).all()


def test_a_batch_is_copied_and_pickled_with_its_simulations():
    batch = hexaplast.Batch(bars(3))
    batch.step(VELOCITIES[0, :3], pull)
    copies = [batch.copy(), pickle.loads(pickle.dumps(batch))]
    batch.step()
    for made in copies:
        assert made.simulations[0] is not batch.simulations[0]
        made.step()
        assert (made.positions == batch.positions).all() and (made.velocities == batch.velocities).all()
    together = pickle.loads(pickle.dumps([batch, batch.simulations]))
    assert together[0].simulations[2] is together[1][2]


def _step_in_child(batch):
    batch.step()
    return [s.state_hash() for s in batch.simulations]


def test_a_batch_steps_in_a_process_that_was_forked_and_in_one_that_it_was_sent_to(threads):
    threads(2)
    batch = hexaplast.Batch(bars(4))
    batch.step()  # threads are there
    for start in ("fork", "spawn"):
        with multiprocessing.get_context(start).Pool(1) as pool:
            there = pool.apply_async(_step_in_child, [batch.copy()]).get(60)
        copied = batch.copy()
        assert there == _step_in_child(copied)


def test_a_batch_lets_other_threads_run_and_has_its_simulations_to_itself():
    simulations = bars(4, cells=(4, 4, 12))
    batch = hexaplast.Batch(simulations)
    refused = []
    thread = threading.Thread(target=lambda: [batch.step() for _ in range(5)])
    thread.start()
    while thread.is_alive():
        for call in (simulations[3].fields, lambda: batch.positions):
            try:
                call()
            except RuntimeError as error:
                assert "another thread" in str(error)
                refused.append(call)
                break
    thread.join()
    assert refused and simulations[0].num_steps == simulations[3].num_steps == 5
    assert np.isfinite(batch.positions).all()


def test_an_interrupt_ends_a_loop_between_two_steps_of_a_batch():
    batch = hexaplast.Batch(bars(4))
    timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            batch.step()
    timer.join()
    num_steps = {s.num_steps for s in batch.simulations}
    assert len(num_steps) == 1 and num_steps.pop() > 0
    batch.step()
