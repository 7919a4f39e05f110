# SPDX-License-Identifier: LGPL-2.1-or-later
"""Arrays on their way in (what is taken, what is refused and how) and out (no copies, and how long they live)."""
import gc

import numpy as np
import pytest

import hexaplast

POSITIONS, HEXAHEDRA = hexaplast.grid((2, 2, 3), (0, 0, 0), (0.2, 0.2, 0.3))
YIELDING = hexaplast.Material(yield_stress=50, flow_rate=4, hardening=0.2)


def stretched_simulation():
    body = hexaplast.Body(POSITIONS, HEXAHEDRA, YIELDING)
    simulation = hexaplast.Simulation(body)
    simulation.fix(POSITIONS[:, 2] == 0)
    forces = np.zeros_like(POSITIONS)
    forces[POSITIONS[:, 2] == 0.3] = (0, 0, 2)
    return simulation, forces


@pytest.mark.parametrize(
    "positions, hexahedra, kind, parts",
    [
        (POSITIONS[:, :2], HEXAHEDRA, ValueError, ["positions", "(36, 2)", "(n, 3)"]),
        (POSITIONS.ravel(), HEXAHEDRA, ValueError, ["positions", "(108,)", "(n, 3)"]),
        (POSITIONS + 1j, HEXAHEDRA, TypeError, ["positions", "complex128", "real numbers"]),
        ([["a", "b", "c"]], HEXAHEDRA, TypeError, ["positions", "real numbers"]),
        (None, HEXAHEDRA, TypeError, ["positions", "real numbers"]),
        (POSITIONS, HEXAHEDRA[:, :7], ValueError, ["hexahedra", "(12, 7)", "(m, 8)"]),
        (POSITIONS, HEXAHEDRA.astype(float), TypeError, ["hexahedra", "float64", "integers"]),
        (POSITIONS, HEXAHEDRA > 0, TypeError, ["hexahedra", "bool", "integers"]),
        (POSITIONS, HEXAHEDRA - 1, ValueError, ["hexahedra[0, 0] = -1"]),
        (POSITIONS, HEXAHEDRA.astype(np.int64) + 2**31, ValueError, ["hexahedra[0, 0] = 2147483648"]),
        (POSITIONS[:-1], HEXAHEDRA, ValueError, ["35"]),
        (np.where(POSITIONS == 0.3, np.nan, POSITIONS), HEXAHEDRA, ValueError, ["finite"]),
        (POSITIONS, HEXAHEDRA[:, [4, 5, 6, 7, 0, 1, 2, 3]], ValueError, ["0, 1, 2"]),  # inside out
    ],
)
def test_what_is_no_mesh_is_refused_with_the_reason(positions, hexahedra, kind, parts):
    with pytest.raises(kind) as caught:
        hexaplast.Body(positions, hexahedra)
    for part in parts:
        assert part in str(caught.value)


def test_lists_other_types_and_strides_mean_the_same_numbers():
    stretched = POSITIONS * [1, 1, 1.1]
    expected = hexaplast.Body(POSITIONS, HEXAHEDRA).energy(stretched)
    assert expected > 0
    strided = np.zeros((36, 6))
    strided[:, ::2] = POSITIONS
    for positions, hexahedra in [
        (POSITIONS.tolist(), HEXAHEDRA.tolist()),
        (np.asfortranarray(POSITIONS), HEXAHEDRA.astype(np.uint16)),
        (strided[:, ::2], np.asfortranarray(HEXAHEDRA.astype(np.int64))),
    ]:
        assert hexaplast.Body(positions, hexahedra).energy(stretched) == expected


# name of the argument, and the call with a wrong one
CALLS = {
    "energy": ("positions", lambda body, simulation, x: body.energy(x)),
    "volume": ("positions", lambda body, simulation, x: body.volume(x)),
    "fields": ("positions", lambda body, simulation, x: body.fields(x)),
    "force": ("positions", lambda body, simulation, x: body.force(x)),
    "product, positions": ("positions", lambda body, simulation, x: body.stiffness_product(x, POSITIONS)),
    "product, dx": ("dx", lambda body, simulation, x: body.stiffness_product(POSITIONS, x)),
    "flow": ("positions", lambda body, simulation, x: body.flow(x, 0.01)),
    "step": ("forces", lambda body, simulation, x: simulation.step(x)),
    "run": ("forces", lambda body, simulation, x: simulation.run(2, x)),
    "state, positions": ("positions", lambda body, simulation, x: simulation.set_state(x, POSITIONS)),
    "state, velocities": ("velocities", lambda body, simulation, x: simulation.set_state(POSITIONS, x)),
}


@pytest.mark.parametrize("call", CALLS)
def test_fields_of_another_size_are_refused_and_those_with_gaps_mean_their_numbers(call):
    name, act = CALLS[call]
    simulation, _ = stretched_simulation()
    body = hexaplast.Body(POSITIONS, HEXAHEDRA, YIELDING)
    for rows in (0, 35, 37, 72):
        with pytest.raises(ValueError) as caught:
            act(body, simulation, np.zeros((rows, 3)))
        assert f"{name}: shape ({rows}, 3), must be (36, 3)" in str(caught.value)

    state = np.hstack([POSITIONS * [1, 1, 1.3], np.full((36, 3), 7.0)])  # positions and others side by side
    hashes = set()
    for given in (state[:, :3], state[:, :3].copy()):
        simulation, _ = stretched_simulation()
        body = hexaplast.Body(POSITIONS, HEXAHEDRA, YIELDING)
        result = act(body, simulation, given)
        numbers = np.asarray(result).tobytes() if isinstance(result, (float, np.ndarray)) else b""
        hashes.add((body.history_hash(), simulation.state_hash(), numbers))
    assert len(hashes) == 1


def test_nodes_are_numbers_or_a_mask():
    simulation, _ = stretched_simulation()
    with pytest.raises(ValueError, match=r"nodes\[1\] = 36 must lie in \[0, 36\)"):
        simulation.fix([0, 36])
    with pytest.raises(ValueError, match=r"nodes\[0\] = -1"):
        simulation.release([-1])
    with pytest.raises(ValueError, match=r"shape \(35,\).*\(36,\) for a mask"):
        simulation.fix(np.ones(35, dtype=bool))
    with pytest.raises(TypeError, match="float64"):
        simulation.fix([0.0])
    with pytest.raises(ValueError, match=r"positions: shape \(1, 3\), must be \(2, 3\)"):
        simulation.prescribe([0, 1], [[0, 0, 0]])
    simulation.fix([])

    by_mask, by_number = (hexaplast.Simulation(hexaplast.Body(POSITIONS, HEXAHEDRA), gravity=(0, 0, -10)) for _ in "ab")
    mask = POSITIONS[:, 2] == 0
    by_mask.fix(mask)
    by_number.fix(np.flatnonzero(mask))
    by_mask.run(3)
    by_number.run(3)
    assert by_mask.state_hash() == by_number.state_hash()
    assert (by_mask.positions[mask] == POSITIONS[mask]).all()
    assert (by_mask.positions[~mask, 2] < POSITIONS[~mask, 2]).all()


def test_views_are_read_only_and_follow_the_simulation_without_copies():
    simulation, forces = stretched_simulation()
    body = simulation.body
    live = {
        "positions": (simulation, simulation.positions),
        "velocities": (simulation, simulation.velocities),
        "plastic_rest_positions": (body, body.plastic_rest_positions),
        "corner_plastic_strain": (body, body.corner_plastic_strain),
        "corner_yield_stress": (body, body.corner_yield_stress),
        "alive": (body, body.alive),
    }
    before = {name: array.copy() for name, (_, array) in live.items()}
    simulation.run(20, forces)
    body.remove([0])
    for name, (owner, array) in live.items():
        assert (array != before[name]).any(), f"{name} stands still"
        assert np.shares_memory(array, getattr(owner, name)), f"{name} is a copy"
        assert not array.flags.writeable and not array.flags.owndata
        with pytest.raises(ValueError):
            array[0] = 1
        with pytest.raises(ValueError):
            array.setflags(write=True)
    simulation.reset()
    for name, (_, array) in live.items():
        assert (array == before[name]).all(), f"{name} does not come back"


def test_views_keep_what_they_show_alive():
    simulation, forces = stretched_simulation()
    simulation.run(10, forces)
    views = [simulation.positions, simulation.masses, simulation.body.corner_plastic_strain, simulation.fields().strain]
    expected = [view.copy() for view in views]
    del simulation
    gc.collect()
    clutter = [np.full_like(view, -1.0) for view in views for _ in range(50)]  # takes memory that was given back
    for view, values in zip(views, expected):
        assert (view == values).all()
    assert len(clutter) == 200


def test_mesh_files_and_grids_give_arrays(tmp_path):
    file = tmp_path / "cube.vtk"
    file.write_text(
        "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
        "0 0 0 2 0 0 2 1 0 0 1 0 0 0 1 2 0 1 2 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n"
    )
    positions, hexahedra = hexaplast.read_mesh(file)
    assert positions.shape == (8, 3) and positions[6].tolist() == [2, 1, 1]
    assert hexahedra.tolist() == [[0, 1, 2, 3, 4, 5, 6, 7]]
    with pytest.raises(OSError, match="missing.vtk"):
        hexaplast.read_mesh(tmp_path / "missing.vtk")

    assert POSITIONS.shape == (36, 3) and HEXAHEDRA.shape == (12, 8)
    assert POSITIONS[1].tolist() == [0.1, 0, 0]  # x fastest
    with pytest.raises(ValueError):
        hexaplast.grid((0, 1, 1), (0, 0, 0), (1, 1, 1))
