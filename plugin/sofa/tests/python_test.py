# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scenes in Python, in a Python that has SofaPython3: python_test.py FOLDER_OF_THE_PLUGIN."""
import importlib.util
import pathlib
import sys
import unittest

import numpy as np
import Sofa
import SofaRuntime

SCENES = pathlib.Path(__file__).resolve().parents[3] / "scenes"


def made(name):
    spec = importlib.util.spec_from_file_location(name, SCENES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    root = Sofa.Core.Node("root")
    module.createScene(root)
    Sofa.Simulation.initRoot(root)
    Sofa.Simulation.reset(root)
    return module, root


def run(root, steps):
    for _ in range(steps):
        Sofa.Simulation.animate(root, root.dt.value)


class Scenes(unittest.TestCase):
    def test_bar_stays_stretched(self):
        _, root = made("bar_stretch")
        run(root, 300)
        body = root.bar.material
        self.assertGreater(max(body.plasticStrain.value), 0.1)
        self.assertGreater(np.ptp(body.plasticRestPositions.value[:, 2]), 1.05)

    def test_forceps_close_until_they_press_lift_and_open(self):
        module, root = made("forceps_fat")
        phases, heights = set(), []
        for _ in range(260):
            run(root, 1)
            phases.add(root.hand.forceps.phase)
            heights.append(root.strip.nodes.position.value[:, 1].max())
        self.assertEqual(phases, {"close", "lift", "open", "done"})
        pressures = root.hand.forceps.pressures
        self.assertGreater(max(pressures), module.PRESSURE)
        self.assertLess(max(pressures), 5 * module.PRESSURE)
        self.assertEqual(pressures[-1], 0)
        self.assertGreater(max(heights), 0.005 + 0.8 * module.LIFT)
        self.assertGreater(max(root.strip.fat.plasticStrain.value), 0.05)

    def test_a_state_brings_a_run_back_to_the_last_bit(self):
        _, root = made("bar_stretch")
        nodes, body = root.bar.nodes, root.bar.material
        run(root, 60)
        time, x, v, state = (root.time.value, nodes.position.value.copy(), nodes.velocity.value.copy(),
                             body.state.value)
        run(root, 20)
        end = nodes.position.value.copy()
        root.time.value = time
        nodes.position.value, nodes.velocity.value, body.state.value = x, v, state
        run(root, 20)
        np.testing.assert_array_equal(nodes.position.value, end)


SofaRuntime.PluginRepository.addFirstPath(sys.argv.pop(1))
unittest.main(verbosity=2)
