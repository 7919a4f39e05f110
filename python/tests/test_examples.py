# SPDX-License-Identifier: LGPL-2.1-or-later
"""The examples, run as their readers run them."""
import pathlib
import re
import subprocess
import sys

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"


def output(name, *arguments):
    run = subprocess.run([sys.executable, EXAMPLES / name, *arguments], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_stretch_keeps_what_the_scene_of_the_same_bar_keeps():
    permanent = float(re.search(r"permanent elongation: (\S+) %", output("stretch.py")).group(1))
    assert abs(permanent - 68.0) < 0.1  # bar_stretch_high
