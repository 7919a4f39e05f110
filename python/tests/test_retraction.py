# SPDX-License-Identifier: LGPL-2.1-or-later
"""The environment of python/examples/retraction.py: its interface, by a checker of ours and, where it is installed, by that of
gymnasium; and that a policy learns in it."""
import importlib.util
import pathlib
import sys

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "examples"))
import retraction  # noqa: E402


def check(environment, steps=5):
    """What gymnasium.Env promises: spaces hold what they are of, a seed decides an episode, step returns five values."""
    assert environment.metadata["render_modes"] == ["rgb_array"] and environment.render_mode in (None, "rgb_array")
    action_space, observation_space = environment.action_space, environment.observation_space
    actions = [action_space.sample() for _ in range(steps)]
    episodes = []
    for seed in (7, 7, 8):
        observation, info = environment.reset(seed=seed)
        assert observation_space.contains(observation) and isinstance(info, dict)
        episodes.append([observation])
        for action in actions:
            assert action_space.contains(action)
            observation, reward, terminated, truncated, info = environment.step(action)
            assert observation_space.contains(observation) and isinstance(info, dict)
            assert type(reward) is float and type(terminated) is type(truncated) is bool
            episodes[-1].append(observation.copy())
    first, same, other = np.array(episodes)
    assert (first == same).all() and not (first == other).all()
    assert not (environment.reset()[0] == environment.reset()[0]).all(), "without a seed, another episode each time"
    environment.close()


def test_the_environment_has_the_interface_of_gymnasium():
    environment = retraction.Retraction(render_mode="rgb_array")
    check(environment)
    environment.reset(seed=1)
    over = [environment.step([0, 0, 0])[3] for _ in range(retraction.STEPS)]
    assert over == [False] * (retraction.STEPS - 1) + [True]


if importlib.util.find_spec("gymnasium"):  # Debian 12 does not have it

    def test_the_checker_of_gymnasium_accepts_the_environment():
        from gymnasium.utils.env_checker import check_env

        check_env(retraction.Retraction(render_mode="rgb_array"))


def test_a_flap_is_drawn_with_its_deformation():
    environment = retraction.Retraction(render_mode="rgb_array")
    environment.reset(seed=1)
    flat = environment.render(mode="rgb_array")
    for _ in range(10):
        environment.step([-0.1, 0, 0.1])
    bent = environment.render()
    assert flat.shape == bent.shape == (360, 640, 3) and flat.dtype == np.uint8
    assert 0.01 < (flat != bent).any(axis=2).mean() < 0.5
    with pytest.raises(ValueError, match=r"width = 1 must lie in \[64, 4096\]"):
        environment.flap.batch.simulations[0].picture(width=1)


def test_forceps_move_as_they_are_told_and_uncover_what_the_flap_covered():
    flaps = retraction.Retractions(2)
    for k in range(2):
        flaps.reset(k, np.random.default_rng(k))
    assert flaps.uncovered() == pytest.approx([0, 0], abs=1e-12)
    start = flaps.observations()[:, -1]
    velocities = np.array([[-0.05, 0.01, 0.08], [-9, 0, 0]])  # the latter faster than they can
    for _ in range(10):
        rewards, _ = flaps.step(velocities)
    moved = flaps.observations()[:, -1] - start
    velocities[1, 0] = -retraction.FASTEST
    assert moved == pytest.approx(10 * retraction.DT * velocities, abs=1e-6)
    assert rewards[0] > 0.05 and flaps.uncovered()[0] == pytest.approx(rewards[0], abs=0.05)


def test_a_policy_learns_to_retract():
    untrained = retraction.evaluate(np.zeros((3, 4)))
    trained = retraction.evaluate(retraction.train(iterations=3, count=8))
    assert trained > untrained + 5, (untrained, trained)  # of 50 at most
