# SPDX-License-Identifier: LGPL-2.1-or-later
"""A body against hand values and difference quotients."""
import copy
import math
import pickle
import re

import numpy as np
import pytest

import hexaplast

POSITIONS, HEXAHEDRA = hexaplast.grid((2, 1, 2), (0, 0, 0), (0.2, 0.1, 0.2))
YOUNG, POISSON = 5000.0, 0.3
MU = YOUNG / (2 * (1 + POISSON))
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
VOLUME = 0.2 * 0.1 * 0.2
RANDOM = np.random.default_rng(31)


PUBLISHED = hexaplast.Settings(bending="blended", volumetric="sample", recovery="none", rest_shape="joined")


def elastic(settings=PUBLISHED):
    return hexaplast.Body(POSITIONS, HEXAHEDRA, hexaplast.Material(young_modulus=YOUNG, poisson_ratio=POISSON), settings)


def test_energy_of_a_stretched_and_turned_body_is_that_of_hand():
    stretch = np.array([1.2, 0.9, 1.05])
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    x = POSITIONS * stretch @ turn.T + [3, 2, 1]
    strain = stretch - 1
    expected = VOLUME * (MU * (strain**2).sum() + LAMBDA / 2 * strain.sum() ** 2)
    assert elastic().energy(x) == pytest.approx(expected, rel=1e-12)


def test_force_is_the_slope_of_the_energy_and_the_stiffness_product_that_of_the_force():
    body = elastic()
    x, dx = POSITIONS + RANDOM.uniform(-0.02, 0.02, POSITIONS.shape), RANDOM.uniform(-1, 1, POSITIONS.shape)
    h = 1e-7
    assert -(body.force(x) * dx).sum() == pytest.approx((body.energy(x + h * dx) - body.energy(x - h * dx)) / (2 * h), rel=1e-6)
    # at rest, where holding the rotations fixed drops nothing
    slope = (body.force(POSITIONS + h * dx) - body.force(POSITIONS - h * dx)) / (2 * h)
    assert body.stiffness_product(POSITIONS, dx) == pytest.approx(slope, rel=1e-5, abs=1e-6 * abs(slope).max())


@pytest.mark.parametrize("rest_shape, found_to", [("joined", 1e-9), ("isolated", 1e-6)])  # isolated ones by iterations
def test_flow_is_that_of_hand(rest_shape, found_to):
    # stretched along z at constant volume: the stress is 2 mu (D - 1) + lambda tr(D - 1), of which a share flows
    tau, rate, dt, s = 200.0, 4.0, 0.01, 1.3
    material = hexaplast.Material(
        young_modulus=YOUNG, poisson_ratio=POISSON, yield_stress=tau, flow_rate=rate, hardening=0.5
    )
    body = hexaplast.Body(POSITIONS, HEXAHEDRA, material, hexaplast.Settings(rest_shape=rest_shape))
    report = body.flow(POSITIONS * [s**-0.5, s**-0.5, s], dt)
    assert report.yielded == 4

    deviator = 2 * MU * (np.array([s**-0.5, s**-0.5, s]) - (2 * s**-0.5 + s) / 3)
    mises = math.sqrt(1.5 * (deviator**2).sum())
    share = rate * dt * (mises - tau) / mises
    strain = share * math.sqrt(2 / 3) * math.log(s) * math.sqrt(1.5)
    assert body.corner_plastic_strain == pytest.approx(np.full((4, 8), strain), rel=1e-12)
    assert body.corner_yield_stress == pytest.approx(np.full((4, 8), tau + 0.5 * share * mises), rel=1e-12)
    length = np.ptp(body.plastic_rest_positions[:, 2])
    assert length == pytest.approx(0.2 * s**share, rel=1e-6)
    assert body.volume(body.plastic_rest_positions) == pytest.approx(VOLUME, rel=found_to)
    assert body.dissipated_energy > 0

    fields = body.fields(POSITIONS)
    assert fields.plastic_strain == pytest.approx(np.full(4, strain), rel=1e-12)
    assert fields.yield_stress == pytest.approx(np.full(4, tau + 0.5 * share * mises), rel=1e-12)
    assert fields.volume_ratio == pytest.approx(np.ones(4), abs=1e-9)
    assert fields.strain == pytest.approx(np.full(4, 1 - s**-share), rel=1e-6)


def test_a_saved_body_goes_on_as_the_one_that_was_not():
    material = hexaplast.Material(yield_stress=50, flow_rate=4, hardening=0.3)
    straight_on = hexaplast.Body(POSITIONS, HEXAHEDRA, material)
    shapes = [POSITIONS + RANDOM.uniform(-0.02, 0.02, POSITIONS.shape) for _ in range(6)]
    for x in shapes[:3]:
        straight_on.flow(x, 0.01)
    saved = straight_on.save()
    other = hexaplast.Body(POSITIONS, HEXAHEDRA)  # its material comes with the history
    strain = other.corner_plastic_strain
    other.load(saved)
    assert strain.max() > 0 and (strain == straight_on.corner_plastic_strain).all()
    for x in shapes[3:]:
        straight_on.flow(x, 0.01), other.flow(x, 0.01)
    assert other.history_hash() == straight_on.history_hash()
    straight_on.reset()
    assert straight_on.history_hash() == hexaplast.Body(POSITIONS, HEXAHEDRA, material).history_hash()

    for again in pickle.loads(pickle.dumps(other)), copy.copy(other), copy.deepcopy(other):
        assert again.history_hash() == other.history_hash()
        again.flow(shapes[0], 0.01)
        assert again.history_hash() != other.history_hash()

    before = other.history_hash()
    for damaged in (saved[:-1], saved[:40] + bytes([saved[40] ^ 1]) + saved[41:], b""):
        with pytest.raises(ValueError):
            other.load(damaged)
    with pytest.raises(ValueError):
        hexaplast.Body(POSITIONS * 2, HEXAHEDRA, material).load(saved)
    assert other.history_hash() == before


def test_another_material_leaves_what_has_flowed():
    body = hexaplast.Body(POSITIONS, HEXAHEDRA, hexaplast.Material(yield_stress=50, flow_rate=4, hardening=0.5))
    body.flow(POSITIONS * [1, 1, 1.2], 0.01)
    shape, threshold = body.plastic_rest_positions.copy(), body.corner_yield_stress.copy()
    body.set_material(hexaplast.Material(yield_stress=80, flow_rate=4))
    assert (body.plastic_rest_positions == shape).all()
    assert body.corner_yield_stress == pytest.approx(threshold + 30, rel=1e-12)
    with pytest.raises(ValueError, match="3"):
        body.set_material([hexaplast.Material()] * 3)


def test_each_hexahedron_may_have_its_own_material():
    materials = [hexaplast.Material(yield_stress=tau, flow_rate=4) for tau in (10, math.inf, 20, math.inf)]
    body = hexaplast.Body(POSITIONS, HEXAHEDRA, materials)
    assert body.corner_yield_stress[:, 0].tolist() == [10, math.inf, 20, math.inf]
    report = body.flow(POSITIONS * [1, 1, 1.1], 0.01)
    assert report.yielded == 2
    assert (body.corner_plastic_strain > 0).all(axis=1).tolist() == [True, False, True, False]


def test_removed_hexahedra_carry_nothing():
    body = elastic()
    x = POSITIONS * [1, 1, 1.1]
    whole = body.energy(x)
    body.remove([3, 1])
    assert body.removed == [3, 1]
    assert body.alive.tolist() == [True, False, True, False]
    assert body.energy(x) == pytest.approx(whole / 2, rel=1e-12)
    assert body.initial_volume == pytest.approx(VOLUME / 2, rel=1e-12)


def test_a_device_computes_what_the_cpu_does():
    mixed = hexaplast.Settings(precision="mixed")
    cpu, device = elastic(mixed), elastic(mixed)
    device.device = "emulation"
    assert (cpu.device, device.device) == ("cpu", "emulation")
    x = POSITIONS + RANDOM.uniform(-0.02, 0.02, POSITIONS.shape)
    assert device.force(x) == pytest.approx(cpu.force(x), abs=1e-5 * np.abs(cpu.force(x)).max())
    with pytest.raises(ValueError, match="precision must be mixed"):
        elastic(hexaplast.Settings()).device = "emulation"


def test_what_the_library_refuses_is_a_value_error_with_its_message():
    with pytest.raises(ValueError, match=r"poisson.*0\.5"):
        hexaplast.Body(POSITIONS, HEXAHEDRA, hexaplast.Material(poisson_ratio=0.5))
    with pytest.raises(ValueError, match="3"):
        hexaplast.Body(POSITIONS, HEXAHEDRA, [hexaplast.Material()] * 3)
    with pytest.raises(ValueError, match="bending = 'vertices' must be one of blended, .*vertex, centre"):
        hexaplast.Settings(bending="vertices")
    with pytest.raises(ValueError, match="precision = 'half'"):
        hexaplast.Settings().precision = "half"
    with pytest.raises(TypeError):
        hexaplast.Material(5000)  # by name alone
    body = hexaplast.Body(POSITIONS, HEXAHEDRA, hexaplast.Material(yield_stress=50, flow_rate=4),
                          hexaplast.Settings(rest_shape="joined"))
    with pytest.raises(ValueError):
        body.flow(POSITIONS, 0.3)  # rate dt above 1
    before = body.history_hash()
    broken = np.array(POSITIONS)
    broken[7, 1] = math.nan
    with pytest.raises(ArithmeticError, match="7"):
        body.flow(broken, 0.01)
    assert body.history_hash() == before
    with pytest.raises(ValueError, match=r"positions: shape \(12, 3\), must be \(18, 3\)"):
        body.energy(POSITIONS[:12])


@pytest.mark.parametrize("options", [hexaplast.Material, hexaplast.Settings])
def test_members_are_keywords_of_the_constructor(options):
    keywords = re.findall(r"(\w+): (float|int|list\[float\]|Literal\[.*?\]) = ", options.__init__.__doc__)
    members = {name: of.__doc__ for name, of in vars(options).items() if isinstance(of, property)}
    assert [name for name, _ in keywords] == list(members)
    for name, kind in keywords:
        first = getattr(options(), name)
        words = re.findall(r'"(\w+)"', kind)
        is_list = kind == "list[float]"
        other = words[-1] if words else [0.5, 2] if is_list else first + 1 if kind == "int" else (
            7 if first == math.inf else first / 2 if first else 0.25)  # within every range
        for word in words:
            changed = options()
            setattr(changed, name, word)
            assert getattr(changed, name) == word and f"{name}='{word}'" in repr(changed)
        changed = options(**{name: other})
        assert getattr(changed, name) == other
        assert f"{name}={other!r}".removesuffix(".0") in repr(changed)
        assert isinstance(getattr(changed, name), str if words else list if is_list else int if kind == "int" else float)
        assert not {"yieldStress", "rotationYield", "plasticFlowRate"} & set(re.findall(r"\w+", vars(options)[name].__doc__))
        with pytest.raises(TypeError):
            setattr(changed, name, [first])
    with pytest.raises(TypeError, match="youngModulus"):
        options(youngModulus=1)


def test_hexahedra_on_the_same_nodes_are_named():
    positions, hexahedra = hexaplast.grid((2, 1, 1), (0, 0, 0), (2, 1, 1))
    with pytest.raises(ValueError, match="same eight nodes as another one: 2 as 1"):
        hexaplast.Body(positions, np.vstack((hexahedra, hexahedra[1:])), hexaplast.Material())


def test_a_member_out_of_its_range_is_refused_at_once():
    with pytest.raises(ValueError, match=re.escape("young_modulus = -1: must lie in (0, inf) Pa")):
        hexaplast.Material(young_modulus=-1)
    material, settings = hexaplast.Material(poisson_ratio=0.3), hexaplast.Settings()
    with pytest.raises(ValueError, match=re.escape("poisson_ratio = 0.5: must lie in [0, 0.5)")):
        material.poisson_ratio = 0.5
    with pytest.raises(ValueError, match="flow_rate = nan"):
        material.flow_rate = math.nan
    with pytest.raises(ValueError, match="averaging_steps = 0"):
        settings.averaging_steps = 0
    assert material.poisson_ratio == 0.3 and material.flow_rate == 0 and settings == hexaplast.Settings()


def test_settings_and_materials_are_plain_data():
    material = hexaplast.Material(yield_stress=7)
    material.flow_rate = 2
    assert "yield_stress=7" in repr(material) and "flow_rate=2" in repr(material)
    settings = hexaplast.Settings(rotation_plasticity="none")
    assert settings != hexaplast.Settings()
    settings.rotation_plasticity = "objective"
    assert settings == hexaplast.Settings()
    settings.relaxation = [0.5, 2]
    assert settings.relaxation == [0.5, 2] and "relaxation=[0.5, 2]" in repr(settings)
    for one in material, settings:
        assert repr(pickle.loads(pickle.dumps(one))) == repr(copy.deepcopy(one)) == repr(one)
