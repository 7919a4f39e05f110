# SPDX-License-Identifier: LGPL-2.1-or-later
"""The wheel of this build tree, in a virtual environment of its own, without a network."""
import os
import pathlib
import subprocess
import sys
import venv

import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TREE = pathlib.Path(os.environ["HEXAPLAST_COMMAND"]).parents[1]

STEP = """
import hexaplast
positions, hexahedra = hexaplast.grid((2, 2, 2), (0, 0, 0), (1, 1, 1))
simulation = hexaplast.Simulation(hexaplast.Body(positions, hexahedra), gravity=(0, 0, -10))
simulation.step()
scene = hexaplast.run("scenes/bar_stretch_high.scn", steps=1)
assert simulation.picture().shape == (360, 640, 3)
print(hexaplast.__file__, simulation.velocities[0, 2], scene.state_hash(), hexaplast.__version__, sep="\\n")
"""


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    place = tmp_path_factory.mktemp("wheel")
    venv.create(place / "env", system_site_packages=True)  # pip and numpy are the system's

    def run(program, *words):
        clean = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "HEXAPLAST"))}
        ended = subprocess.run([place / "env" / "bin" / program, *words], cwd=SOURCE, capture_output=True, text=True, env=clean)
        assert ended.returncode == 0, ended.stdout + ended.stderr
        return ended.stdout

    run("python", "-m", "pip", "wheel", "--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--wheel-dir", place,
        "--config-settings", f"build-dir={TREE}", SOURCE)
    wheels = list(place.glob("*.whl"))
    assert len(wheels) == 1
    run("python", "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", wheels[0])
    return place / "env", run


def test_module_and_scenes_run_from_the_wheel(environment):
    place, run = environment
    file, velocity, of_scene, version = run("python", "-c", STEP).split()
    assert pathlib.Path(file).is_relative_to(place)
    assert float(velocity) == pytest.approx(-0.1, rel=1e-12)
    here = subprocess.run([sys.executable, "-c", STEP], cwd=SOURCE, capture_output=True, text=True, check=True).stdout.split()
    assert here[2:] == [of_scene, version] and not pathlib.Path(here[0]).is_relative_to(place)


def test_the_command_and_studies_run_from_the_wheel(environment, tmp_path):
    place, run = environment
    _, _, of_scene, version = run("python", "-c", STEP).split()
    assert version in run("hexaplast", "--version")
    assert of_scene in run("hexaplast", "run", "scenes/bar_stretch_high.scn", "--steps", "1")
    assert "usage" in run("hexaplast-sweep", "--help").lower()
    linked = subprocess.run(["ldd", place / "bin" / "hexaplast"], capture_output=True, text=True, check=True).stdout
    ours = [line for line in linked.splitlines() if "libhexaplast" in line]
    assert ours and all(str(place) in line for line in ours), linked
